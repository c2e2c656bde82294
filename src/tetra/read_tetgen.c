/* SPDX-License-Identifier: Apache-2.0 */
/* TetGen's pair of text files: .node (points) and .ele (tetrahedra). Lines start with their number,
 * beginning at 0 or 1. The first attribute of a tetrahedron is its region. */
#include "tetra/io.h"

static starg_status read_points(tet_builder *builder, int64_t *first) {
    enum { LEAST_BYTES = 8 }; /* "1 0 0 0\n" */
    number_scan numbers = {.scan = starg_scan_make(builder->points.source)};
    starg_scan *scan = &numbers.scan;
    int64_t count, dimension, attributes, markers, number;
    double point[3], ignored;
    TRY(starg_scan_integer(scan, "the number of points", &count));
    TRY(starg_scan_integer(scan, "the dimension", &dimension));
    TRY(starg_scan_integer(scan, "the number of attributes", &attributes));
    TRY(starg_scan_integer(scan, "the number of markers", &markers));
    TRY(numbers_check_count(&numbers, count, LEAST_BYTES, "points"));
    if (dimension != 3 || attributes < 0 || markers < 0)
        return starg_source_fail(scan->source, numbers_place(&numbers),
                                 "the dimension must be 3, and counts must not be negative");
    TRY(tet_builder_reserve(builder, (size_t)count, 0));
    for (int64_t i = 0; i < count; i++) {
        TRY(starg_scan_integer(scan, "the number of a point", &number));
        if (i == 0)
            *first = number;
        if (number != *first + i || *first < 0 || *first > 1)
            return starg_source_fail(scan->source, numbers_place(&numbers),
                                     "points must be numbered in order, from 0 or 1");
        for (int k = 0; k < 3; k++)
            TRY(starg_scan_real(scan, "a coordinate of a point", &point[k]));
        TRY(starg_builder_vertex(&builder->points, point, numbers_place(&numbers)));
        for (int64_t k = 0; k < attributes + markers; k++)
            TRY(starg_scan_real(scan, "an attribute of a point", &ignored));
        TRY(starg_builder_tick(&builder->points, (size_t)(scan->at - scan->source->bytes)));
    }
    return STARG_OK;
}

static starg_status read_elements(tet_builder *builder, const starg_source *elements,
                                  int64_t first) {
    enum { LEAST_BYTES = 10 }; /* "1 1 2 3 4\n" */
    number_scan numbers = {.scan = starg_scan_make(elements)};
    starg_scan *scan = &numbers.scan;
    int64_t count, nodes, attributes, number, corner[4];
    TRY(starg_scan_integer(scan, "the number of tetrahedra", &count));
    TRY(starg_scan_integer(scan, "the nodes of a tetrahedron", &nodes));
    TRY(starg_scan_integer(scan, "the number of attributes", &attributes));
    TRY(numbers_check_count(&numbers, count, LEAST_BYTES, "tetrahedra"));
    if (nodes != 4 || attributes < 0)
        return starg_source_fail(elements, numbers_place(&numbers),
                                 "tetrahedra with %lld nodes are not supported; use four nodes",
                                 (long long)nodes);
    TRY(tet_builder_reserve(builder, 0, (size_t)count));
    for (int64_t i = 0; i < count; i++) {
        double region = 0, value;
        TRY(starg_scan_integer(scan, "the number of a tetrahedron", &number));
        for (int k = 0; k < 4; k++) {
            TRY(starg_scan_integer(scan, "the number of a point", &corner[k]));
            corner[k] -= first;
        }
        starg_place place = numbers_place(&numbers);
        for (int64_t k = 0; k < attributes; k++) {
            TRY(starg_scan_real(scan, "an attribute of a tetrahedron", &value));
            if (k == 0)
                region = value;
        }
        if (!(region > -1e9 && region < 1e9))
            region = 0; /* no label */
        TRY(tet_builder_add(builder, corner, (int64_t)region, place));
        TRY(starg_builder_tick(&builder->points, (size_t)(scan->at - elements->bytes)));
    }
    return STARG_OK;
}

starg_status tet_tetgen_read(tet_builder *builder, const starg_source *elements) {
    int64_t first = 0;
    starg_status status = read_points(builder, &first);
    return status == STARG_OK ? read_elements(builder, elements, first) : status;
}
