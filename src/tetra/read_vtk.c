/* SPDX-License-Identifier: Apache-2.0 */
/* Legacy VTK unstructured grids (mesh/formats/vtk.h). Cell types come last, so tetrahedra are
 * selected at the end. The first integer array of the cells, if it follows at once, gives the
 * regions; an array "ball" after it the images of corners. */
#include "mesh/formats/vtk.h"
#include "tetra/io.h"

static const char STAGE[] = STARG_MESH_FILE;

typedef struct vtk_reader {
    tet_builder *builder;
    vtk_file file;
    STARG_ARRAY(size_t) cells; /* those that are tetrahedra */
} vtk_reader;

bool tet_vtk_matches(const starg_source *source) {
    return vtk_matches(source);
}

bool tet_vtk_is_surface(const starg_source *source) {
    starg_mesh_builder points = {.source = source};
    vtk_file vtk = vtk_open(&points);
    starg_word word;
    while (vtk_matches(source) && starg_scan_word(&vtk.numbers.scan, &word))
        if (vtk_is(word, "DATASET"))
            return starg_scan_word(&vtk.numbers.scan, &word) && vtk_is(word, "POLYDATA");
    return false;
}

static const starg_source *source_of(const vtk_reader *vtk) {
    return vtk->builder->points.source;
}

static starg_status begin(vtk_reader *vtk) {
    starg_word dataset;
    TRY(vtk_read_header(&vtk->file, &dataset));
    if (!vtk_is(dataset, "UNSTRUCTURED_GRID"))
        return starg_source_fail(source_of(vtk), starg_at_line(dataset.line),
                                 "the data set is %s; tetrahedra are read from UNSTRUCTURED_GRID "
                                 "only",
                                 starg_word_excerpt(dataset).text);
    TRY(vtk_read_points(&vtk->file));
    TRY(vtk_expect(&vtk->file, "CELLS"));
    return vtk_read_cells(&vtk->file);
}

enum { POINT = 1, TETRAHEDRON = 10 };

/* Skipped types: points, lines, triangles, polygons, quadrilaterals of all orders. */
static bool is_flat(int64_t type) {
    static const uint8_t flat[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 30, 34, 35, 36};
    for (size_t i = 0; i < sizeof flat; i++)
        if (flat[i] == type)
            return true;
    return false;
}

static starg_status add_cell(vtk_reader *vtk, size_t cell, int64_t type) {
    const size_t *start = vtk->file.starts.data + cell;
    if (is_flat(type))
        return STARG_OK;
    if (type != TETRAHEDRON || start[1] - start[0] != 4) {
        char what[48];
        snprintf(what, sizeof what, "a cell of type %lld with %zu corners", (long long)type,
                 start[1] - start[0]);
        return tet_builder_refuse(vtk->builder, what, numbers_place(&vtk->file.numbers));
    }
    TRY(tet_builder_add(vtk->builder, vtk->file.indices.data + start[0], 0,
                        numbers_place(&vtk->file.numbers)));
    PUSH(source_of(vtk)->context, STAGE, &vtk->cells, cell);
    return STARG_OK;
}

static starg_status read_types(vtk_reader *vtk) {
    int64_t count, type;
    TRY(vtk_expect(&vtk->file, "CELL_TYPES"));
    TRY(vtk_count(&vtk->file, "the number of cell types", &count));
    size_t cells = vtk->file.starts.count > 0 ? vtk->file.starts.count - 1 : 0;
    if (count < 0 || (uint64_t)count != cells)
        return starg_source_fail(source_of(vtk), numbers_place(&vtk->file.numbers),
                                 "%lld cell types are announced for %zu cells", (long long)count,
                                 cells);
    vtk_begin_data(&vtk->file);
    for (size_t cell = 0; cell < cells; cell++) {
        TRY(numbers_integer(&vtk->file.numbers, NUMBER_INT32, "the type of a cell", &type));
        TRY(add_cell(vtk, cell, type));
        TRY(vtk_tick(&vtk->file));
    }
    return STARG_OK;
}

/* Some writers omit types: cells of four corners are then tetrahedra. */
static starg_status guess_types(vtk_reader *vtk) {
    starg_log(source_of(vtk)->context, STARG_LOG_WARNING,
              "'%s' has no cell types; treating cells with four corners as tetrahedra",
              source_of(vtk)->name);
    for (size_t cell = 0; cell + 1 < vtk->file.starts.count; cell++) {
        size_t corners = vtk->file.starts.data[cell + 1] - vtk->file.starts.data[cell];
        TRY(add_cell(vtk, cell, corners < 4 ? POINT : TETRAHEDRON));
    }
    return STARG_OK;
}

static bool at_end(const vtk_reader *vtk) {
    starg_scan ahead = vtk->file.numbers.scan;
    starg_word word;
    return !starg_scan_word(&ahead, &word);
}

/* CELL_DATA n, SCALARS name type [1], LOOKUP_TABLE name: false if anything else follows. */
static bool begin_labels(vtk_reader *vtk, number_type *type) {
    starg_scan *scan = &vtk->file.numbers.scan;
    starg_word word;
    int64_t count, components = 1;
    if (!starg_scan_word(scan, &word) || !vtk_is(word, "CELL_DATA") ||
        !starg_scan_word(scan, &word) || !starg_parse_integer(word.text, word.length, &count) ||
        count < 0 || (uint64_t)count + 1 != vtk->file.starts.count)
        return false;
    if (!starg_scan_word(scan, &word) || !vtk_is(word, "SCALARS") ||
        !starg_scan_word(scan, &word) || !starg_scan_word(scan, &word))
        return false;
    if (vtk_is(word, "int") || vtk_is(word, "vtktypeint32"))
        *type = NUMBER_INT32;
    else if (vtk_is(word, "long") || vtk_is(word, "vtktypeint64") || vtk_is(word, "vtkIdType"))
        *type = NUMBER_INT64;
    else if (vtk_is(word, "char") || vtk_is(word, "unsigned_char"))
        *type = NUMBER_INT8;
    else
        return false;
    if (starg_scan_word_here(scan, &word))
        starg_parse_integer(word.text, word.length, &components);
    return components == 1 && starg_scan_word(scan, &word) && vtk_is(word, "LOOKUP_TABLE") &&
           starg_scan_word(scan, &word);
}

/* FIELD name 1, ball 12 n double: false when something else stands here. */
static bool begin_corners(vtk_reader *vtk) {
    starg_scan *scan = &vtk->file.numbers.scan;
    starg_word word;
    int64_t arrays, components, count;
    return starg_scan_word(scan, &word) && vtk_is(word, "FIELD") && starg_scan_word(scan, &word) &&
           starg_scan_word(scan, &word) && starg_parse_integer(word.text, word.length, &arrays) &&
           arrays == 1 && starg_scan_word(scan, &word) && vtk_is(word, "ball") &&
           starg_scan_word(scan, &word) &&
           starg_parse_integer(word.text, word.length, &components) && components == 12 &&
           starg_scan_word(scan, &word) && starg_parse_integer(word.text, word.length, &count) &&
           count >= 0 && (uint64_t)count == vtk->cells.count &&
           vtk->cells.count + 1 == vtk->file.starts.count && starg_scan_word(scan, &word) &&
           vtk_is(word, "double");
}

static starg_status read_corners(vtk_reader *vtk) {
    size_t count = vtk->cells.count;
    if (!begin_corners(vtk))
        return STARG_OK;
    vtk_begin_data(&vtk->file);
    TRY(numbers_check_count(&vtk->file.numbers, (int64_t)count,
                            12 * numbers_least_bytes(&vtk->file.numbers, NUMBER_FLOAT64),
                            "images"));
    NEW(source_of(vtk)->context, STAGE, vtk->builder->corners, 12 * count);
    for (size_t i = 0; i < 12 * count; i++) {
        TRY(numbers_real(&vtk->file.numbers, NUMBER_FLOAT64, "a coordinate of an image",
                         &vtk->builder->corners[i]));
        TRY(vtk_tick(&vtk->file));
    }
    return STARG_OK;
}

static starg_status read_labels(vtk_reader *vtk) {
    number_type type;
    if (!begin_labels(vtk, &type))
        return STARG_OK;
    vtk_begin_data(&vtk->file);
    for (size_t cell = 0, t = 0; cell + 1 < vtk->file.starts.count; cell++) {
        int64_t label;
        TRY(numbers_integer(&vtk->file.numbers, type, "the label of a cell", &label));
        if (t < vtk->cells.count && vtk->cells.data[t] == cell)
            vtk->builder->regions.data[t++] = (int32_t)(uint32_t)(uint64_t)label;
        TRY(vtk_tick(&vtk->file));
    }
    vtk->builder->labelled = true;
    return read_corners(vtk);
}

starg_status tet_vtk_read(tet_builder *builder) {
    starg_status status = STARG_OK;
    vtk_reader vtk = {.builder = builder, .file = vtk_open(&builder->points)};
    STARG_TRY(begin(&vtk));
    STARG_TRY(at_end(&vtk) ? guess_types(&vtk) : read_types(&vtk));
    STARG_TRY(read_labels(&vtk));
done:
    vtk_free(&vtk.file);
    RELEASE(vtk.cells.data);
    return status;
}
