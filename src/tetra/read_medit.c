/* SPDX-License-Identifier: Apache-2.0 */
/* MEDIT .mesh, INRIA's text format: keywords, each with a count and that many entries. Vertices and
 * tetrahedra carry a reference, which is the region. Other sections are numbers up to the next
 * keyword and are skipped. */
#include "tetra/io.h"

bool tet_medit_matches(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    return starg_scan_word(&scan, &word) && (starg_word_is(word, "MeshVersionFormatted") ||
                                             starg_word_is(word, "MeshVersionUnformatted"));
}

static starg_status read_header(number_scan *numbers) {
    starg_word word;
    int64_t version;
    TRY(starg_scan_expect(&numbers->scan, "MeshVersionFormatted", &word));
    if (!starg_word_is(word, "MeshVersionFormatted"))
        return starg_source_fail(
            numbers->scan.source, starg_at_line(word.line),
            "found '%s' instead of MeshVersionFormatted; only MEDIT's text format is supported",
            starg_word_excerpt(word).text);
    return starg_scan_integer(&numbers->scan, "the version", &version);
}

static starg_status read_dimension(number_scan *numbers) {
    int64_t dimension;
    TRY(starg_scan_integer(&numbers->scan, "the dimension", &dimension));
    if (dimension != 3)
        return starg_source_fail(numbers->scan.source, numbers_place(numbers),
                                 "the dimension is %lld; it must be 3", (long long)dimension);
    return STARG_OK;
}

static starg_status read_vertices(tet_builder *builder, number_scan *numbers) {
    enum { LEAST_BYTES = 8 }; /* "0 0 0 0\n" */
    starg_scan *scan = &numbers->scan;
    int64_t count;
    TRY(starg_scan_integer(scan, "the vertex count", &count));
    TRY(numbers_check_count(numbers, count, LEAST_BYTES, "vertices"));
    TRY(tet_builder_reserve(builder, starg_builder_vertex_count(&builder->points) + (size_t)count,
                            0));
    for (int64_t i = 0; i < count; i++) {
        double point[3], reference;
        for (int k = 0; k < 3; k++)
            TRY(starg_scan_real(scan, "a coordinate of a vertex", &point[k]));
        TRY(starg_builder_vertex(&builder->points, point, numbers_place(numbers)));
        TRY(starg_scan_real(scan, "the reference of a vertex", &reference));
        TRY(starg_builder_tick(&builder->points, (size_t)(scan->at - scan->source->bytes)));
    }
    return STARG_OK;
}

static starg_status read_tetrahedra(tet_builder *builder, number_scan *numbers) {
    enum { LEAST_BYTES = 10 }; /* "1 2 3 4 0\n" */
    starg_scan *scan = &numbers->scan;
    int64_t count;
    TRY(starg_scan_integer(scan, "the number of tetrahedra", &count));
    TRY(numbers_check_count(numbers, count, LEAST_BYTES, "tetrahedra"));
    TRY(tet_builder_reserve(builder, 0, tet_builder_count(builder) + (size_t)count));
    for (int64_t i = 0; i < count; i++) {
        int64_t corner[4], reference;
        for (int k = 0; k < 4; k++) {
            TRY(starg_scan_integer(scan, "a vertex index", &corner[k]));
            corner[k]--;
        }
        TRY(starg_scan_integer(scan, "the reference of a tetrahedron", &reference));
        TRY(tet_builder_add(builder, corner, reference, numbers_place(numbers)));
        TRY(starg_builder_tick(&builder->points, (size_t)(scan->at - scan->source->bytes)));
    }
    return STARG_OK;
}

static bool is_keyword(starg_word word) {
    char c = word.text[0];
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/* Sections of other solid cells are accepted only if empty. */
static starg_status check_cells(tet_builder *builder, number_scan *numbers, starg_word keyword) {
    static const char *const cells[][2] = {{"Hexahedra", "a hexahedron"},
                                           {"Prisms", "a prism"},
                                           {"Pyramids", "a pyramid"},
                                           {"TetrahedraP2", "a tetrahedron of second order"},
                                           {"Pentahedra", "a prism"},
                                           {"Hexaedra", "a hexahedron"},
                                           {"TetrahedraP3", "a curved tetrahedron"},
                                           {"HexahedraQ2", "a curved hexahedron"}};
    int64_t count;
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        if (!starg_word_is(keyword, cells[i][0]))
            continue;
        TRY(starg_scan_integer(&numbers->scan, "a count", &count));
        if (count != 0)
            return tet_builder_refuse(builder, cells[i][1], starg_at_line(keyword.line));
    }
    return STARG_OK;
}

static starg_status read_section(tet_builder *builder, number_scan *numbers, starg_word keyword) {
    if (starg_word_is(keyword, "Dimension"))
        return read_dimension(numbers);
    if (starg_word_is(keyword, "Vertices"))
        return read_vertices(builder, numbers);
    if (starg_word_is(keyword, "Tetrahedra"))
        return read_tetrahedra(builder, numbers);
    return check_cells(builder, numbers, keyword);
}

starg_status tet_medit_read(tet_builder *builder) {
    number_scan numbers = {.scan = starg_scan_make(builder->points.source)};
    starg_word word;
    TRY(read_header(&numbers));
    while (starg_scan_word(&numbers.scan, &word) && !starg_word_is(word, "End")) {
        if (is_keyword(word))
            TRY(read_section(builder, &numbers, word));
        TRY(starg_builder_tick(&builder->points,
                               (size_t)(numbers.scan.at - numbers.scan.source->bytes)));
    }
    return STARG_OK;
}
