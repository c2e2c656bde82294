/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of the tetrahedra options, shared with the table of decompositions. */
#pragma once

#include "core/fields.h"
#include "tetra/tetmesh.h"

#define TETRA_PAPER_DENSITY 17.5 /* tetrahedra per surface vertex [YL11] */

extern const char *const tetra_generator_words[];

/* The last of TETRA_FIELDS: where tetgen is, and how long it may take. Files leave them out. */
enum { TETRA_MACHINE_FIELDS = 2 };

/* All but the density, for a struct T with the options at PREFIX. */
#define TETRA_FIELDS(T, PREFIX)                                                                    \
    {.key = "generator",                                                                           \
     .option = "generator",                                                                        \
     .group = "search",                                                                            \
     .kind = STARG_FIELD_CHOICE,                                                                   \
     FIELD_MEMBER(T, PREFIX generator),                                                            \
     .words = tetra_generator_words,                                                               \
     .value = "auto|tetgen|stuffing",                                                              \
     .help = "Tetrahedra generator: isosurface stuffing (auto: with a warning that it "            \
             "approximates the surface), or the program tetgen, which preserves it."},             \
        {.key = "target",                                                                          \
         .kind = STARG_FIELD_COUNT,                                                                \
         FIELD_MEMBER(T, PREFIX target),                                                           \
         .most = TETMESH_LIMIT,                                                                    \
         .value = "N",                                                                             \
         .help = "Target number of tetrahedra; above 0 it replaces the density."},                 \
        {.key = "tetgen",                                                                          \
         .kind = STARG_FIELD_TEXT,                                                                 \
         FIELD_MEMBER(T, PREFIX tetgen),                                                           \
         .value = "FILE",                                                                          \
         .help = "Path of the program tetgen.",                                                    \
         .default_text = "found on the search path"},                                              \
    {                                                                                              \
        .key = "tetgen_limit", .kind = STARG_FIELD_REAL, .flags = STARG_FIELD_ABOVE,               \
        FIELD_MEMBER(T, PREFIX tetgen_limit), .high = 1e100, .standard = 30, .value = "S",         \
        .help = "Limit of tetgen in seconds of processor time."                                    \
    }
