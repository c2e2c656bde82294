/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of the tetrahedra options, which the table of decompositions shares. */
#ifndef STARG_TETRA_FIELDS_H
#define STARG_TETRA_FIELDS_H

#include "core/fields.h"
#include "starguard/tetra.h"
#include "tetra/tetmesh.h"

#define TETRA_PAPER_DENSITY 17.5 /* tetrahedra per surface vertex [YL11] */

extern const char *const tetra_generator_words[];

/* All but the density, for a struct T that has the options as PREFIX. */
#define TETRA_FIELDS(T, PREFIX)                                                                    \
    {.key = "generator",                                                                           \
     .kind = STARG_FIELD_CHOICE,                                                                   \
     FIELD_MEMBER(T, PREFIX generator),                                                            \
     .words = tetra_generator_words,                                                               \
     .value = "auto|tetgen|stuffing",                                                              \
     .help = "How tetrahedra are made: by the program tetgen, which keeps the surface, by "        \
             "isosurface stuffing, or by the one that can."},                                      \
        {.key = "target",                                                                          \
         .kind = STARG_FIELD_COUNT,                                                                \
         FIELD_MEMBER(T, PREFIX target),                                                           \
         .most = TETMESH_LIMIT,                                                                    \
         .value = "N",                                                                             \
         .help = "Tetrahedra that are aimed at; above 0 it stands in for the density."},           \
        {.key = "tetgen",                                                                          \
         .kind = STARG_FIELD_TEXT,                                                                 \
         FIELD_MEMBER(T, PREFIX tetgen),                                                           \
         .value = "FILE",                                                                          \
         .help = "The program tetgen.",                                                            \
         .default_text = "that of the search path"},                                               \
    {                                                                                              \
        .key = "tetgen_limit", .kind = STARG_FIELD_REAL, .flags = STARG_FIELD_ABOVE,               \
        FIELD_MEMBER(T, PREFIX tetgen_limit), .high = 1e100, .standard = 30, .value = "S",         \
        .help = "Seconds that tetgen may take."                                                    \
    }

#endif
