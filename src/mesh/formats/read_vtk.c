/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces in legacy VTK files: polydata with polygons and strips of triangles, and unstructured
 * grids of flat cells. Points, lines and data of points are passed over. */
#include "mesh/formats/vtk.h"

bool starg_vtk_matches(const starg_source *source) {
    return vtk_matches(source);
}

static starg_status add_polygon(vtk_file *vtk, size_t cell) {
    const size_t *start = vtk->starts.data + cell;
    starg_place place = numbers_place(&vtk->numbers);
    for (size_t i = start[0]; i < start[1]; i++)
        TRY(starg_builder_corner(vtk->points, vtk->indices.data[i], place));
    return starg_builder_face(vtk->points, place);
}

/* Every other triangle of a strip is turned around. */
static starg_status add_strip(vtk_file *vtk, size_t cell) {
    const size_t *start = vtk->starts.data + cell;
    starg_place place = numbers_place(&vtk->numbers);
    for (size_t i = start[0]; i + 2 < start[1]; i++) {
        size_t odd = (i - start[0]) % 2;
        const size_t order[3] = {i, i + 1 + odd, i + 2 - odd};
        for (int k = 0; k < 3; k++)
            TRY(starg_builder_corner(vtk->points, vtk->indices.data[order[k]], place));
        TRY(starg_builder_face(vtk->points, place));
    }
    return STARG_OK;
}

static starg_status add_all(vtk_file *vtk, starg_status (*add)(vtk_file *, size_t)) {
    for (size_t cell = 0; cell + 1 < vtk->starts.count; cell++) {
        TRY(add(vtk, cell));
        TRY(vtk_tick(vtk));
    }
    return STARG_OK;
}

/* The next keyword; false at the end, or where data begin. */
static bool next_keyword(vtk_file *vtk, starg_word *word) {
    vtk_skip_metadata(vtk);
    return starg_scan_word(&vtk->numbers.scan, word) && !vtk_is(*word, "POINT_DATA") &&
           !vtk_is(*word, "CELL_DATA");
}

static starg_status read_polydata(vtk_file *vtk) {
    starg_word word;
    TRY(vtk_read_points(vtk));
    while (next_keyword(vtk, &word)) {
        bool polygons = vtk_is(word, "POLYGONS"), strips = vtk_is(word, "TRIANGLE_STRIPS");
        if (!polygons && !strips && !vtk_is(word, "VERTICES") && !vtk_is(word, "LINES"))
            return starg_source_fail(vtk->points->source, starg_at_line(word.line),
                                     "found '%s' instead of POLYGONS or another list of cells",
                                     starg_word_excerpt(word).text);
        TRY(vtk_read_cells(vtk));
        if (polygons || strips)
            TRY(add_all(vtk, polygons ? add_polygon : add_strip));
    }
    return STARG_OK;
}

enum { VERTEX = 1, POLY_LINE = 4, TRIANGLE = 5, STRIP = 6, POLYGON = 7, QUAD = 9 };

static starg_status read_grid(vtk_file *vtk) {
    starg_word word;
    int64_t count, type;
    TRY(vtk_read_points(vtk));
    bool found = next_keyword(vtk, &word);
    if (!found || !vtk_is(word, "CELLS"))
        return starg_source_fail(vtk->points->source, numbers_place(&vtk->numbers),
                                 "the grid has no CELLS");
    TRY(vtk_read_cells(vtk));
    TRY(vtk_expect(vtk, "CELL_TYPES"));
    TRY(vtk_count(vtk, "the number of cell types", &count));
    if (count < 0 || (uint64_t)count + 1 != vtk->starts.count)
        return starg_source_fail(vtk->points->source, numbers_place(&vtk->numbers),
                                 "there are not as many cell types as cells");
    vtk_begin_data(vtk);
    for (size_t cell = 0; cell < (size_t)count; cell++) {
        TRY(numbers_integer(&vtk->numbers, NUMBER_INT32, "the type of a cell", &type));
        if (type == STRIP)
            TRY(add_strip(vtk, cell));
        else if (type == TRIANGLE || type == POLYGON || type == QUAD)
            TRY(add_polygon(vtk, cell));
        else if (type < VERTEX || type > POLY_LINE)
            return starg_source_fail(vtk->points->source, numbers_place(&vtk->numbers),
                                     "a cell of type %lld is no flat one; tetrahedral meshes go to "
                                     "'decompose'",
                                     (long long)type);
        TRY(vtk_tick(vtk));
    }
    return STARG_OK;
}

starg_status starg_vtk_read(starg_mesh_builder *builder) {
    SCOPED_BY(vtk_free) vtk_file vtk = vtk_open(builder);
    starg_word dataset;
    TRY(vtk_read_header(&vtk, &dataset));
    if (vtk_is(dataset, "POLYDATA"))
        return read_polydata(&vtk);
    if (vtk_is(dataset, "UNSTRUCTURED_GRID"))
        return read_grid(&vtk);
    return starg_source_fail(builder->source, starg_at_line(dataset.line),
                             "the data set is %s; surfaces are read from POLYDATA, or from "
                             "UNSTRUCTURED_GRID with flat cells",
                             starg_word_excerpt(dataset).text);
}
