/* SPDX-License-Identifier: Apache-2.0 */
/* Legacy VTK files, text or binary (big endian), versions 1 to 5: header, points and lists of
 * cells, for the readers of surfaces and of tetrahedra. Keywords are text in both. Version 5.1
 * replaced the list of cells (count, then indices, cell by cell) by offsets and connectivity. */
#include "mesh/formats/vtk.h"

#include <strings.h>

static const char STAGE[] = STARG_MESH_FILE;

/* Accepts blank lines before the magic. */
bool vtk_matches(const starg_source *source) {
    static const char *const magic[] = {"#", "vtk", "DataFile"};
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    scan.comments = false;
    for (int i = 0; i < 3; i++)
        if (!starg_scan_word(&scan, &word) || !starg_word_is(word, magic[i]))
            return false;
    return true;
}

vtk_file vtk_open(starg_mesh_builder *points) {
    vtk_file vtk = {.points = points, .numbers = {.scan = starg_scan_make(points->source)}};
    vtk.numbers.scan.comments = false;
    return vtk;
}

static const starg_source *source_of(const vtk_file *vtk) {
    return vtk->points->source;
}

bool vtk_is(starg_word word, const char *text) {
    return word.length == strlen(text) && strncasecmp(word.text, text, word.length) == 0;
}

void vtk_skip_metadata(vtk_file *vtk) {
    starg_word word;
    starg_scan ahead = vtk->numbers.scan;
    while (starg_scan_word(&ahead, &word) && vtk_is(word, "METADATA")) {
        starg_scan_next_line(&ahead);
        while (starg_scan_word_here(&ahead, &word))
            starg_scan_next_line(&ahead);
        vtk->numbers.scan = ahead;
    }
}

starg_status vtk_expect(vtk_file *vtk, const char *keyword) {
    starg_word word;
    vtk_skip_metadata(vtk);
    TRY(starg_scan_expect(&vtk->numbers.scan, keyword, &word));
    if (!vtk_is(word, keyword))
        return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                                 "found '%s' instead of %s", starg_word_excerpt(word).text,
                                 keyword);
    return STARG_OK;
}

starg_status vtk_tick(vtk_file *vtk) {
    return starg_builder_tick(vtk->points, (size_t)(vtk->numbers.scan.at - source_of(vtk)->bytes));
}

/* Counts in keyword lines are text, in binary files too. */
starg_status vtk_count(vtk_file *vtk, const char *what, int64_t *count) {
    return starg_scan_integer(&vtk->numbers.scan, what, count);
}

/* Binary data begins after the line end, which is one byte. */
void vtk_begin_data(vtk_file *vtk) {
    starg_scan *scan = &vtk->numbers.scan;
    if (vtk->numbers.encoding != NUMBERS_TEXT)
        starg_scan_next_line(scan);
}

starg_status vtk_read_header(vtk_file *vtk, starg_word *dataset) {
    starg_scan *scan = &vtk->numbers.scan;
    starg_word word;
    starg_scan_word(scan, &word);
    starg_scan_next_line(scan); /* the magic */
    starg_scan_next_line(scan); /* the title */
    TRY(starg_scan_expect(scan, "ASCII or BINARY", &word));
    if (vtk_is(word, "BINARY"))
        vtk->numbers.encoding = NUMBERS_BIG;
    else if (!vtk_is(word, "ASCII"))
        return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                                 "found '%s' instead of ASCII or BINARY",
                                 starg_word_excerpt(word).text);
    TRY(vtk_expect(vtk, "DATASET"));
    return starg_scan_expect(scan, "a kind of data set", dataset);
}

static starg_status read_type(vtk_file *vtk, number_type *type) {
    static const struct {
        const char *name;
        number_type type;
    } known[] = {{"double", NUMBER_FLOAT64},     {"float", NUMBER_FLOAT32},
                 {"int", NUMBER_INT32},          {"unsigned_int", NUMBER_INT32},
                 {"vtktypeint32", NUMBER_INT32}, {"vtktypeint64", NUMBER_INT64},
                 {"vtkIdType", NUMBER_INT64},    {"long", NUMBER_INT64},
                 {"unsigned_char", NUMBER_INT8}, {"char", NUMBER_INT8},
                 {"vtktypeint8", NUMBER_INT8},   {"vtktypeuint8", NUMBER_INT8},
                 {"short", NUMBER_INT16},        {"unsigned_short", NUMBER_UINT16},
                 {"unsigned_long", NUMBER_INT64}};
    starg_word word;
    TRY(starg_scan_expect(&vtk->numbers.scan, "a type of numbers", &word));
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (vtk_is(word, known[i].name)) {
            *type = known[i].type;
            return STARG_OK;
        }
    return starg_source_fail(source_of(vtk), starg_at_line(word.line),
                             "numbers of type '%s' are not read here",
                             starg_word_excerpt(word).text);
}

static bool is_real(number_type type) {
    return type == NUMBER_FLOAT32 || type == NUMBER_FLOAT64;
}

/* FIELD name n, then n arrays, each with its name, components, tuples, type and numbers: they
 * belong to the file, as times do. */
static starg_status skip_fields(vtk_file *vtk) {
    starg_scan *scan = &vtk->numbers.scan, ahead = *scan;
    starg_word word;
    int64_t arrays, components, tuples;
    if (!starg_scan_word(&ahead, &word) || !vtk_is(word, "FIELD"))
        return STARG_OK;
    TRY(vtk_expect(vtk, "FIELD"));
    TRY(starg_scan_expect(scan, "the name of a field", &word));
    TRY(vtk_count(vtk, "the number of arrays", &arrays));
    for (int64_t i = 0; i < arrays; i++) {
        number_type type;
        vtk_skip_metadata(vtk);
        TRY(starg_scan_expect(scan, "the name of an array", &word));
        TRY(vtk_count(vtk, "the number of components", &components));
        TRY(vtk_count(vtk, "the number of tuples", &tuples));
        TRY(read_type(vtk, &type));
        vtk_begin_data(vtk);
        for (int64_t t = 0; t < tuples; t++)
            for (int64_t k = 0; k < components; k++) {
                double ignored;
                TRY(numbers_real(&vtk->numbers, type, "a number of a field", &ignored));
                TRY(vtk_tick(vtk));
            }
    }
    return STARG_OK;
}

starg_status vtk_read_points(vtk_file *vtk) {
    number_type type;
    int64_t count;
    TRY(skip_fields(vtk));
    TRY(vtk_expect(vtk, "POINTS"));
    TRY(vtk_count(vtk, "the number of points", &count));
    TRY(read_type(vtk, &type));
    if (!is_real(type))
        return starg_source_fail(source_of(vtk), numbers_place(&vtk->numbers),
                                 "the points must be of type double or float");
    vtk_begin_data(vtk);
    TRY(numbers_check_count(&vtk->numbers, count, 3 * numbers_least_bytes(&vtk->numbers, type),
                            "points"));
    TRY(starg_builder_reserve(vtk->points, (size_t)count, 0));
    for (int64_t i = 0; i < count; i++) {
        double point[3];
        for (int k = 0; k < 3; k++)
            TRY(numbers_real(&vtk->numbers, type, "a coordinate of a point", &point[k]));
        TRY(starg_builder_vertex(vtk->points, point, numbers_place(&vtk->numbers)));
        TRY(vtk_tick(vtk));
    }
    return STARG_OK;
}

/* ---- cells ---- */

static starg_status read_integers(vtk_file *vtk, number_type type, int64_t count, const char *what,
                                  int64_t *out) {
    for (int64_t i = 0; i < count; i++) {
        TRY(numbers_integer(&vtk->numbers, type, what, &out[i]));
        TRY(vtk_tick(vtk));
    }
    return STARG_OK;
}

static starg_status fail_sizes(vtk_file *vtk) {
    return starg_source_fail(source_of(vtk), numbers_place(&vtk->numbers),
                             "the sizes of the cells do not add up to the announced length of "
                             "their list");
}

/* Up to version 4: count, then indices, cell by cell; `size` numbers in all. */
static starg_status read_list(vtk_file *vtk, int64_t cells, int64_t size) {
    size_t bytes = numbers_least_bytes(&vtk->numbers, NUMBER_INT32);
    vtk_begin_data(vtk);
    TRY(numbers_check_count(&vtk->numbers, size, bytes, "numbers of cells"));
    TRY(numbers_check_count(&vtk->numbers, cells, bytes, "cells"));
    for (int64_t c = 0, used = 0; c < cells; c++) {
        int64_t corners;
        PUSH(source_of(vtk)->context, STAGE, &vtk->starts, vtk->indices.count);
        TRY(numbers_integer(&vtk->numbers, NUMBER_INT32, "the size of a cell", &corners));
        if (corners < 0 || corners > size - used - 1)
            return fail_sizes(vtk);
        used += 1 + corners;
        for (int64_t k = 0; k < corners; k++) {
            int64_t index;
            TRY(numbers_integer(&vtk->numbers, NUMBER_INT32, "a vertex index", &index));
            PUSH(source_of(vtk)->context, STAGE, &vtk->indices, index);
        }
        TRY(vtk_tick(vtk));
        if (c == cells - 1 && used != size)
            return fail_sizes(vtk);
    }
    PUSH(source_of(vtk)->context, STAGE, &vtk->starts, vtk->indices.count);
    return STARG_OK;
}

/* One array of version 5: its name, its type, its numbers. */
static starg_status read_array(vtk_file *vtk, const char *name, int64_t count, int64_t **out) {
    number_type type;
    TRY(vtk_expect(vtk, name));
    TRY(read_type(vtk, &type));
    vtk_begin_data(vtk);
    TRY(numbers_check_count(&vtk->numbers, count, numbers_least_bytes(&vtk->numbers, type),
                            "numbers of cells"));
    starg_release(source_of(vtk)->context, *out);
    *out = NULL;
    NEW(source_of(vtk)->context, STAGE, *out, (size_t)count);
    return read_integers(vtk, type, count, "a number of the cells", *out);
}

/* From version 5 on: offsets (one more than cells) and connectivity. */
static starg_status read_offsets(vtk_file *vtk, int64_t offsets, int64_t size) {
    SCOPED int64_t *starts = NULL;
    TRY(read_array(vtk, "OFFSETS", offsets, &starts));
    TRY(read_array(vtk, "CONNECTIVITY", size, &vtk->indices.data));
    vtk->indices.count = vtk->indices.capacity = (size_t)size;
    for (int64_t i = 0; i < offsets; i++) {
        int64_t before = i == 0 ? 0 : starts[i - 1];
        if (starts[i] < before || starts[i] > size || (i == 0 && starts[i] != 0))
            return fail_sizes(vtk);
        PUSH(source_of(vtk)->context, STAGE, &vtk->starts, (size_t)starts[i]);
    }
    return STARG_OK;
}

starg_status vtk_read_cells(vtk_file *vtk) {
    starg_word word;
    int64_t cells, size;
    vtk->indices.count = vtk->starts.count = 0;
    TRY(vtk_count(vtk, "the number of cells", &cells));
    TRY(vtk_count(vtk, "the length of the list of cells", &size));
    starg_scan ahead = vtk->numbers.scan;
    bool offsets = starg_scan_next_line(&ahead) && starg_scan_word_here(&ahead, &word) &&
                   vtk_is(word, "OFFSETS");
    return offsets ? read_offsets(vtk, cells, size) : read_list(vtk, cells, size);
}

void vtk_free(vtk_file *vtk) {
    RELEASE(vtk->indices.data, vtk->starts.data);
}
