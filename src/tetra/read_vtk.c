/* SPDX-License-Identifier: Apache-2.0 */
/* Legacy VTK unstructured grids, text or binary (big endian), versions 1 to 5. Keywords are text in
 * both. Version 5.1 replaced the cell list (count, then indices, cell by cell) by offsets and
 * connectivity. Cell types come last, so tetrahedra are selected at the end. The first integer
 * array of the cells, if it follows at once, gives the regions; an array "ball" after it the images
 * of corners. */
#include <strings.h>

#include "core/memory.h"
#include "tetra/io.h"

static const char STAGE[] = STARG_MESH_FILE;

typedef struct vtk_reader {
    tet_builder *builder;
    tet_numbers numbers;
    STARG_ARRAY(int64_t) indices; /* of all cells */
    STARG_ARRAY(size_t) starts;   /* one per cell, and the end */
    STARG_ARRAY(size_t) cells;    /* those that are tetrahedra */
} vtk_reader;

/* Accepts blank lines before the magic. */
bool tet_vtk_matches(const starg_source *source) {
    static const char *const magic[] = {"#", "vtk", "DataFile"};
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    scan.comments = false;
    for (int i = 0; i < 3; i++)
        if (!starg_scan_word(&scan, &word) || !starg_word_is(word, magic[i]))
            return false;
    return true;
}

static const starg_source *source_of(const vtk_reader *vtk) {
    return vtk->builder->points.source;
}

static bool is(starg_word word, const char *text) {
    return word.length == strlen(text) && strncasecmp(word.text, text, word.length) == 0;
}

static starg_status expect(vtk_reader *vtk, const char *keyword) {
    starg_status status = STARG_OK;
    starg_word word;
    STARG_TRY(starg_scan_expect(&vtk->numbers.scan, keyword, &word));
    if (!is(word, keyword))
        return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                                 "found '%s' instead of %s", starg_word_excerpt(word).text,
                                 keyword);
done:
    return status;
}

static starg_status tick(vtk_reader *vtk) {
    return starg_builder_tick(&vtk->builder->points,
                              (size_t)(vtk->numbers.scan.at - source_of(vtk)->bytes));
}

/* Counts in keyword lines are text, in binary files too. */
static starg_status read_count(vtk_reader *vtk, const char *what, int64_t *count) {
    return starg_scan_integer(&vtk->numbers.scan, what, count);
}

/* Binary data begins after the line end, which is one byte. */
static void begin_data(vtk_reader *vtk) {
    starg_scan *scan = &vtk->numbers.scan;
    if (vtk->numbers.encoding != TET_TEXT)
        starg_scan_next_line(scan);
}

static starg_status read_header(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    starg_scan *scan = &vtk->numbers.scan;
    starg_word word;
    starg_scan_word(scan, &word);
    starg_scan_next_line(scan); /* the magic */
    starg_scan_next_line(scan); /* the title */
    STARG_TRY(starg_scan_expect(scan, "ASCII or BINARY", &word));
    if (is(word, "BINARY"))
        vtk->numbers.encoding = TET_BIG;
    else if (!is(word, "ASCII"))
        return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                                 "found '%s' instead of ASCII or BINARY",
                                 starg_word_excerpt(word).text);
    STARG_TRY(expect(vtk, "DATASET"));
    STARG_TRY(starg_scan_expect(scan, "a kind of data set", &word));
    if (!is(word, "UNSTRUCTURED_GRID"))
        return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                                 "the data set is %s; tetrahedra are read from UNSTRUCTURED_GRID "
                                 "only",
                                 starg_word_excerpt(word).text);
done:
    return status;
}

static starg_status read_type(vtk_reader *vtk, tet_type *type) {
    static const struct {
        const char *name;
        tet_type type;
    } known[] = {
        {"double", TET_FLOAT64},     {"float", TET_FLOAT32},      {"int", TET_INT32},
        {"unsigned_int", TET_INT32}, {"vtktypeint32", TET_INT32}, {"vtktypeint64", TET_INT64},
        {"vtkIdType", TET_INT64},    {"long", TET_INT64},         {"unsigned_char", TET_INT8},
        {"char", TET_INT8},          {"vtktypeint8", TET_INT8},   {"vtktypeuint8", TET_INT8}};
    starg_word word;
    starg_status status = starg_scan_expect(&vtk->numbers.scan, "a type of numbers", &word);
    if (status != STARG_OK)
        return status;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (is(word, known[i].name)) {
            *type = known[i].type;
            return STARG_OK;
        }
    return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                             "numbers of type '%s' are not read here",
                             starg_word_excerpt(word).text);
}

static bool is_real(tet_type type) {
    return type == TET_FLOAT32 || type == TET_FLOAT64;
}

static starg_status read_points(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    tet_type type;
    int64_t count;
    STARG_TRY(expect(vtk, "POINTS"));
    STARG_TRY(read_count(vtk, "the number of points", &count));
    STARG_TRY(read_type(vtk, &type));
    if (!is_real(type))
        return starg_source_fail(source_of(vtk), tet_place(&vtk->numbers),
                                 "the points must be of type double or float");
    begin_data(vtk);
    STARG_TRY(
        tet_check_count(&vtk->numbers, count, 3 * tet_least_bytes(&vtk->numbers, type), "points"));
    STARG_TRY(tet_builder_reserve(vtk->builder, (size_t)count, 0));
    for (int64_t i = 0; i < count; i++) {
        double point[3];
        for (int k = 0; k < 3; k++)
            STARG_TRY(tet_real(&vtk->numbers, type, "a coordinate of a point", &point[k]));
        STARG_TRY(starg_builder_vertex(&vtk->builder->points, point, tet_place(&vtk->numbers)));
        STARG_TRY(tick(vtk));
    }
done:
    return status;
}

/* ---- cells ---- */

static starg_status read_integers(vtk_reader *vtk, tet_type type, int64_t count, const char *what,
                                  int64_t *out) {
    starg_status status = STARG_OK;
    for (int64_t i = 0; i < count; i++) {
        STARG_TRY(tet_integer(&vtk->numbers, type, what, &out[i]));
        STARG_TRY(tick(vtk));
    }
done:
    return status;
}

static starg_status fail_sizes(vtk_reader *vtk) {
    return starg_source_fail(source_of(vtk), tet_place(&vtk->numbers),
                             "the sizes of the cells do not add up to the announced length of "
                             "their list");
}

/* Up to version 4: count, then indices, cell by cell; `size` numbers in all. */
static starg_status read_list(vtk_reader *vtk, int64_t cells, int64_t size) {
    starg_status status = STARG_OK;
    size_t bytes = tet_least_bytes(&vtk->numbers, TET_INT32);
    begin_data(vtk);
    STARG_TRY(tet_check_count(&vtk->numbers, size, bytes, "numbers of cells"));
    STARG_TRY(tet_check_count(&vtk->numbers, cells, bytes, "cells"));
    for (int64_t c = 0, used = 0; c < cells; c++) {
        int64_t corners;
        STARG_PUSH(source_of(vtk)->context, STAGE, &vtk->starts, vtk->indices.count);
        STARG_TRY(tet_integer(&vtk->numbers, TET_INT32, "the size of a cell", &corners));
        if (corners < 0 || corners > size - used - 1)
            return fail_sizes(vtk);
        used += 1 + corners;
        for (int64_t k = 0; k < corners; k++) {
            int64_t index;
            STARG_TRY(tet_integer(&vtk->numbers, TET_INT32, "a vertex index", &index));
            STARG_PUSH(source_of(vtk)->context, STAGE, &vtk->indices, index);
        }
        STARG_TRY(tick(vtk));
        if (c == cells - 1 && used != size)
            return fail_sizes(vtk);
    }
    STARG_PUSH(source_of(vtk)->context, STAGE, &vtk->starts, vtk->indices.count);
done:
    return status;
}

/* One array of version 5: its name, its type, its numbers. */
static starg_status read_array(vtk_reader *vtk, const char *name, int64_t count, int64_t **out) {
    starg_status status = STARG_OK;
    tet_type type;
    STARG_TRY(expect(vtk, name));
    STARG_TRY(read_type(vtk, &type));
    begin_data(vtk);
    STARG_TRY(tet_check_count(&vtk->numbers, count, tet_least_bytes(&vtk->numbers, type),
                              "numbers of cells"));
    STARG_NEW(source_of(vtk)->context, STAGE, *out, (size_t)count);
    STARG_TRY(read_integers(vtk, type, count, "a number of the cells", *out));
done:
    return status;
}

/* From version 5 on: offsets (one more than cells) and connectivity. */
static starg_status read_offsets(vtk_reader *vtk, int64_t offsets, int64_t size) {
    starg_status status = STARG_OK;
    int64_t *starts = NULL;
    STARG_TRY(read_array(vtk, "OFFSETS", offsets, &starts));
    STARG_TRY(read_array(vtk, "CONNECTIVITY", size, &vtk->indices.data));
    vtk->indices.count = vtk->indices.capacity = (size_t)size;
    for (int64_t i = 0; i < offsets; i++) {
        int64_t before = i == 0 ? 0 : starts[i - 1];
        if (starts[i] < before || starts[i] > size || (i == 0 && starts[i] != 0)) {
            status = fail_sizes(vtk);
            goto done;
        }
        STARG_PUSH(source_of(vtk)->context, STAGE, &vtk->starts, (size_t)starts[i]);
    }
done:
    starg_release(source_of(vtk)->context, starts);
    return status;
}

static starg_status read_cells(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    starg_word word;
    int64_t cells, size;
    STARG_TRY(expect(vtk, "CELLS"));
    STARG_TRY(read_count(vtk, "the number of cells", &cells));
    STARG_TRY(read_count(vtk, "the length of the list of cells", &size));
    starg_scan ahead = vtk->numbers.scan;
    bool offsets =
        starg_scan_next_line(&ahead) && starg_scan_word_here(&ahead, &word) && is(word, "OFFSETS");
    if (offsets)
        STARG_TRY(read_offsets(vtk, cells, size));
    else
        STARG_TRY(read_list(vtk, cells, size));
done:
    return status;
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
    starg_status status = STARG_OK;
    const size_t *start = vtk->starts.data + cell;
    if (is_flat(type))
        return STARG_OK;
    if (type != TETRAHEDRON || start[1] - start[0] != 4) {
        char what[48];
        snprintf(what, sizeof what, "a cell of type %lld with %zu corners", (long long)type,
                 start[1] - start[0]);
        return tet_builder_refuse(vtk->builder, what, tet_place(&vtk->numbers));
    }
    STARG_TRY(
        tet_builder_add(vtk->builder, vtk->indices.data + start[0], 0, tet_place(&vtk->numbers)));
    STARG_PUSH(source_of(vtk)->context, STAGE, &vtk->cells, cell);
done:
    return status;
}

static starg_status read_types(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    int64_t count, type;
    STARG_TRY(expect(vtk, "CELL_TYPES"));
    STARG_TRY(read_count(vtk, "the number of cell types", &count));
    size_t cells = vtk->starts.count > 0 ? vtk->starts.count - 1 : 0;
    if (count < 0 || (uint64_t)count != cells)
        return starg_source_fail(source_of(vtk), tet_place(&vtk->numbers),
                                 "%lld cell types are announced for %zu cells", (long long)count,
                                 cells);
    begin_data(vtk);
    for (size_t cell = 0; cell < cells; cell++) {
        STARG_TRY(tet_integer(&vtk->numbers, TET_INT32, "the type of a cell", &type));
        STARG_TRY(add_cell(vtk, cell, type));
        STARG_TRY(tick(vtk));
    }
done:
    return status;
}

/* Some writers omit types: cells of four corners are then tetrahedra. */
static starg_status guess_types(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    starg_log(source_of(vtk)->context, STARG_LOG_WARNING,
              "'%s' has no cell types; treating cells with four corners as tetrahedra",
              source_of(vtk)->name);
    for (size_t cell = 0; cell + 1 < vtk->starts.count; cell++) {
        size_t corners = vtk->starts.data[cell + 1] - vtk->starts.data[cell];
        STARG_TRY(add_cell(vtk, cell, corners < 4 ? POINT : TETRAHEDRON));
    }
done:
    return status;
}

static bool at_end(const vtk_reader *vtk) {
    starg_scan ahead = vtk->numbers.scan;
    starg_word word;
    return !starg_scan_word(&ahead, &word);
}

/* CELL_DATA n, SCALARS name type [1], LOOKUP_TABLE name: false if anything else follows. */
static bool begin_labels(vtk_reader *vtk, tet_type *type) {
    starg_scan *scan = &vtk->numbers.scan;
    starg_word word;
    int64_t count, components = 1;
    if (!starg_scan_word(scan, &word) || !is(word, "CELL_DATA") || !starg_scan_word(scan, &word) ||
        !starg_parse_integer(word.text, word.length, &count) || count < 0 ||
        (uint64_t)count + 1 != vtk->starts.count)
        return false;
    if (!starg_scan_word(scan, &word) || !is(word, "SCALARS") || !starg_scan_word(scan, &word) ||
        !starg_scan_word(scan, &word))
        return false;
    if (is(word, "int") || is(word, "vtktypeint32"))
        *type = TET_INT32;
    else if (is(word, "long") || is(word, "vtktypeint64") || is(word, "vtkIdType"))
        *type = TET_INT64;
    else if (is(word, "char") || is(word, "unsigned_char"))
        *type = TET_INT8;
    else
        return false;
    if (starg_scan_word_here(scan, &word))
        starg_parse_integer(word.text, word.length, &components);
    return components == 1 && starg_scan_word(scan, &word) && is(word, "LOOKUP_TABLE") &&
           starg_scan_word(scan, &word);
}

/* FIELD name 1, ball 12 n double: false when something else stands here. */
static bool begin_corners(vtk_reader *vtk) {
    starg_scan *scan = &vtk->numbers.scan;
    starg_word word;
    int64_t arrays, components, count;
    return starg_scan_word(scan, &word) && is(word, "FIELD") && starg_scan_word(scan, &word) &&
           starg_scan_word(scan, &word) && starg_parse_integer(word.text, word.length, &arrays) &&
           arrays == 1 && starg_scan_word(scan, &word) && is(word, "ball") &&
           starg_scan_word(scan, &word) &&
           starg_parse_integer(word.text, word.length, &components) && components == 12 &&
           starg_scan_word(scan, &word) && starg_parse_integer(word.text, word.length, &count) &&
           count >= 0 && (uint64_t)count == vtk->cells.count &&
           vtk->cells.count + 1 == vtk->starts.count && starg_scan_word(scan, &word) &&
           is(word, "double");
}

static starg_status read_corners(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    size_t count = vtk->cells.count;
    if (!begin_corners(vtk))
        return STARG_OK;
    begin_data(vtk);
    STARG_TRY(tet_check_count(&vtk->numbers, (int64_t)count,
                              12 * tet_least_bytes(&vtk->numbers, TET_FLOAT64), "images"));
    STARG_NEW(source_of(vtk)->context, STAGE, vtk->builder->corners, 12 * count);
    for (size_t i = 0; i < 12 * count; i++) {
        STARG_TRY(tet_real(&vtk->numbers, TET_FLOAT64, "a coordinate of an image",
                           &vtk->builder->corners[i]));
        STARG_TRY(tick(vtk));
    }
done:
    return status;
}

static starg_status read_labels(vtk_reader *vtk) {
    starg_status status = STARG_OK;
    tet_type type;
    if (!begin_labels(vtk, &type))
        return STARG_OK;
    begin_data(vtk);
    for (size_t cell = 0, t = 0; cell + 1 < vtk->starts.count; cell++) {
        int64_t label;
        STARG_TRY(tet_integer(&vtk->numbers, type, "the label of a cell", &label));
        if (t < vtk->cells.count && vtk->cells.data[t] == cell)
            vtk->builder->regions.data[t++] = (int32_t)(uint32_t)(uint64_t)label;
        STARG_TRY(tick(vtk));
    }
    vtk->builder->labelled = true;
    status = read_corners(vtk);
done:
    return status;
}

starg_status tet_vtk_read(tet_builder *builder) {
    starg_status status = STARG_OK;
    vtk_reader vtk = {.builder = builder,
                      .numbers = {.scan = starg_scan_make(builder->points.source)}};
    vtk.numbers.scan.comments = false;
    STARG_TRY(read_header(&vtk));
    STARG_TRY(read_points(&vtk));
    STARG_TRY(read_cells(&vtk));
    STARG_TRY(at_end(&vtk) ? guess_types(&vtk) : read_types(&vtk));
    STARG_TRY(read_labels(&vtk));
done:
    STARG_ARRAY_FREE(builder->points.source->context, &vtk.indices);
    STARG_ARRAY_FREE(builder->points.source->context, &vtk.starts);
    STARG_ARRAY_FREE(builder->points.source->context, &vtk.cells);
    return status;
}
