/* SPDX-License-Identifier: Apache-2.0 */
/* Legacy VTK files: what readers of surfaces and of tetrahedra share. Errors of all: FORMAT, RANGE,
 * MEMORY, CANCELLED. */
#pragma once

#include "mesh/formats/numbers.h"

typedef struct vtk_file {
    starg_mesh_builder *points;
    number_scan numbers;
    STARG_ARRAY(int64_t) indices; /* of all cells of the list read last */
    STARG_ARRAY(size_t) starts;   /* one per cell, and the end */
} vtk_file;

bool vtk_matches(const starg_source *source);
vtk_file vtk_open(starg_mesh_builder *points);
void vtk_free(vtk_file *vtk);

/* Is it that keyword, in any case? */
bool vtk_is(starg_word word, const char *text);
starg_status vtk_expect(vtk_file *vtk, const char *keyword);

/* Passes over blocks of METADATA, each of which an empty line ends. */
void vtk_skip_metadata(vtk_file *vtk);

/* Up to the kind of data set. */
starg_status vtk_read_header(vtk_file *vtk, starg_word *dataset);

/* Counts in keyword lines are text, in binary files too. */
starg_status vtk_count(vtk_file *vtk, const char *what, int64_t *count);

/* Binary data begins after the line end, which is one byte. */
void vtk_begin_data(vtk_file *vtk);
starg_status vtk_tick(vtk_file *vtk);

/* POINTS, with the keyword; and a list of cells, after its keyword. */
starg_status vtk_read_points(vtk_file *vtk);
starg_status vtk_read_cells(vtk_file *vtk);
