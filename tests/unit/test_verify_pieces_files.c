/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier's readers of PIECES.vtk and PIECES.json: written files read back, and any invalid
 * file is rejected with a message. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "cut.h"
#include "support.h"

static void expect_same_mesh(const starg_pieces_mesh *a, const starg_pieces_mesh *b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->vertices, b->vertices, 3 * a->vertex_count * sizeof(double));
    assert_memory_equal(a->tetrahedra, b->tetrahedra, 4 * a->count * sizeof(uint32_t));
    assert_memory_equal(a->labels, b->labels, a->count * sizeof(int32_t));
}

static void test_files_give_back_what_was_written(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_CAVITY);
    for (coding code = TEXT; code < CODINGS; code++) {
        cut_file vtk = cut_write_vtk(&c->mesh, code);
        starg_pieces_mesh *mesh = NULL;
        test_ok(context, starg_pieces_mesh_read_memory(context, vtk.bytes, vtk.size, "p", &mesh));
        expect_same_mesh(mesh, &c->mesh);
        starg_pieces_mesh_free(context, mesh);
        free(vtk.bytes);
    }
    c->report.mode = STARG_DECOMPOSE_PAPER;
    c->report.approximated = true;
    cut_file json = cut_write_report(&c->report);
    starg_pieces_report *report = NULL;
    test_ok(context, starg_pieces_report_read_memory(context, json.bytes, json.size, "r", &report));
    assert_int_equal(report->mode, STARG_DECOMPOSE_PAPER);
    assert_int_equal(report->tetrahedra, c->report.tetrahedra);
    assert_int_equal(report->piece_count, c->report.piece_count);
    assert_int_equal(report->contact_count, c->report.contact_count);
    assert_int_equal(report->strictly_star, c->report.strictly_star);
    assert_true(report->visible_vertices == 1 && report->approximated);
    assert_true(report->distance == 0.25 && report->distance_back == 0.5);
    for (size_t p = 0; p < report->piece_count; p++) {
        assert_memory_equal(report->pieces[p].guard, c->pieces[p].guard, 3 * sizeof(double));
        assert_true(report->pieces[p].volume == c->pieces[p].volume && report->pieces[p].star);
        assert_int_equal(report->pieces[p].tetrahedra, c->pieces[p].tetrahedra);
    }
    assert_memory_equal(report->contacts, c->contacts, report->contact_count * sizeof *c->contacts);
    starg_pieces_report_free(context, report);
    free(json.bytes);
    free(c);
    test_context_free(context);
}

/* Reads bytes of either kind; whatever cannot be read is rejected with a message. */
static starg_status read_any(starg_context *context, bool json, const char *bytes, size_t size) {
    starg_pieces_mesh *mesh = NULL;
    starg_pieces_report *report = NULL;
    char *exact = malloc(size + 1); /* detects reads beyond the end */
    memcpy(exact, bytes, size);
    exact = realloc(exact, size > 0 ? size : 1);
    starg_status status =
        json ? starg_pieces_report_read_memory(context, exact, size, "file", &report)
             : starg_pieces_mesh_read_memory(context, exact, size, "file", &mesh);
    free(exact);
    if (status == STARG_OK) {
        starg_pieces_mesh_free(context, mesh);
        starg_pieces_report_free(context, report);
    } else {
        assert_null(mesh);
        assert_null(report);
        assert_true(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE);
        assert_non_null(strstr(starg_context_error(context)->message, "file"));
    }
    return status;
}

static void test_truncated_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_HALVES);
    for (int kind = 0; kind < 3; kind++) {
        cut_file whole =
            kind < 2 ? cut_write_vtk(&c->mesh, (coding)kind) : cut_write_report(&c->report);
        for (size_t size = 0; size <= whole.size; size++) {
            bool good = size >= whole.size - (kind != DOUBLES); /* the last line end is optional */
            assert_int_equal(read_any(context, kind == 2, whole.bytes, size) == STARG_OK, good);
        }
        free(whole.bytes);
    }
    free(c);
    test_context_free(context);
}

/* Bytes changed at random: read or rejected, no leaks. */
static void test_mutilated_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_BEND);
    size_t read = 0, refused = 0;
    for (int kind = 0; kind < 3; kind++) {
        cut_file whole =
            kind < 2 ? cut_write_vtk(&c->mesh, (coding)kind) : cut_write_report(&c->report);
        for (uint64_t round = 0; round < 3000; round++) {
            starg_rng rng = starg_rng_make(29, (uint64_t)kind, round);
            char *bytes = malloc(whole.size);
            memcpy(bytes, whole.bytes, whole.size);
            for (uint64_t i = starg_rng_below(&rng, 3) + 1; i > 0; i--)
                bytes[starg_rng_below(&rng, whole.size)] =
                    starg_rng_below(&rng, 2) ? (char)starg_rng_below(&rng, 256)
                                             : " 0123456789-.e\n"[starg_rng_below(&rng, 15)];
            if (read_any(context, kind == 2, bytes, whole.size) == STARG_OK)
                read++;
            else
                refused++;
            free(bytes);
        }
        free(whole.bytes);
    }
    assert_true(read > 300 && refused > 300);
    free(c);
    test_context_free(context);
}

/* Replaces the first `old` by `new`, and reads. */
static void expect_refusal(starg_context *context, bool json, cut_file whole, const char *old,
                           const char *new, const char *says) {
    char *at = strstr(whole.bytes, old);
    if (at == NULL)
        fail_msg("there is no '%s' in %s", old, whole.bytes);
    size_t head = (size_t)(at - whole.bytes), tail = whole.size - head - strlen(old);
    char *bytes = malloc(head + strlen(new) + tail);
    memcpy(bytes, whole.bytes, head);
    memcpy(bytes + head, new, strlen(new));
    memcpy(bytes + head + strlen(new), at + strlen(old), tail);
    if (read_any(context, json, bytes, head + strlen(new) + tail) == STARG_OK)
        fail_msg("'%s' for '%s' is read", new, old);
    if (strstr(starg_context_error(context)->message, says) == NULL)
        fail_msg("'%s' for '%s': %s", new, old, starg_context_error(context)->message);
    free(bytes);
}

typedef struct refusal {
    const char *old, *new, *says;
} refusal;

static void test_bad_files(void **state) {
    (void)state;
    static const refusal texts[] = {
        {"# vtk", "# vtx", "this is no legacy VTK file"},
        {"ASCII", "ASCIL", "ASCII or BINARY"},
        {"UNSTRUCTURED_GRID", "POLYDATA",
         ", line 4: the data set is POLYDATA; tetrahedra are read from UNSTRUCTURED_GRID only"},
        {"double", "int", ", line 5: the points must be of type double or float"},
        {"POINTS 45", "POINTS 44", ", line 138: found '4' instead of CELLS"},
        {"POINTS 45", "POINTS 100000000000",
         ", line 5: the file declares 100000000000 points, too many for the 2046 bytes that "
         "follow; the count is wrong or the file is truncated"},
        {"POINTS 45", "POINTS -1",
         ", line 5: the file declares -1 points, too many for the 2046 bytes that follow; the "
         "count is wrong or the file is truncated"},
        {"POINTS 45", "POINTS 9999999999999999999",
         ", line 5: '9999999999999999999' is not a whole number; expected the number of points"},
        {"\n0.5\n", "\nnan\n",
         "line 8: coordinate x of vertex 0 is nan; coordinates must be finite and below 1e100 in "
         "magnitude"},
        {"\n0.5\n", "\n-inf\n",
         "line 8: coordinate x of vertex 0 is -inf; coordinates must be finite and below 1e100 in "
         "magnitude"},
        {"\n0.5\n", "\n1e100\n",
         "line 8: coordinate x of vertex 0 is 1e+100; coordinates must be finite and below 1e100 "
         "in magnitude"},
        {"\n0.5\n", "\n0x1p1\n",
         "line 6: '0x1p1' is not a number; expected a coordinate of a point"},
        {"\n0.5\n", "\n0.5.5\n",
         "line 6: '0.5.5' is not a number; expected a coordinate of a point"},
        {"CELLS 96", "CELLS 100000000", "line 142: the file declares 100000000 cells"},
        {"CELLS 96", "CELLS 0", "line 143: found '4' instead of CELL_TYPES"},
        {"CELLS 96 480", "CELLS 96 481",
         "line 238: the sizes of the cells do not add up to the announced length of their list"},
        {"480\n4 ", "480\n5 ",
         "line 241: the cells include a cell of type 10 with 5 corners; only four-vertex "
         "tetrahedra are supported, so split other cells"},
        {"\n4 5 3 4 0", "\n4 5 3 4 45",
         "tetrahedron 0 refers to vertex 45, but there are only 45 (counted from 0)"},
        {"\n4 5 3 4 0", "\n4 5 -3 4 0",
         "line 241: tetrahedron 0 has the impossible vertex -3 (both counted from 0)"},
        {"\n4 5 3 4 0", "\n4 5 3 4 0.5",
         "line 143: '0.5' is not a whole number; expected a vertex index"},
        {"CELL_TYPES 96", "CELL_TYPES 95", "line 240: 95 cell types are announced for 96 cells"},
        {"CELL_TYPES 96\n10", "CELL_TYPES 96\n12",
         "line 241: the cells include a cell of type 12 with 4 corners; only four-vertex "
         "tetrahedra are supported, so split other cells"},
        {"CELL_DATA 96", "CELL_DATA 97", "the cells have no labels: whole numbers \"piece\""},
        {"CELL_DATA", "POINT_DATA", "the cells have no labels: whole numbers \"piece\""},
        {"piece int", "piece float", "the cells have no labels: whole numbers \"piece\""},
        {"default\n0", "default\nx",
         "line 341: 'x' is not a whole number; expected the label of a cell"},
    };
    static const refusal reports[] = {
        {"starguard-pieces", "starguard-guards", "\"format\" must be"},
        {"\"version\": 1", "\"version\": 2", "\"version\" must be 1"},
        {"strict", "strange", "\"mode\" must be one of strict, paper"},
        {"\"tetrahedra\": 96", "\"tetrahedra\": -1", "\"tetrahedra\" must be"},
        {"\"tetrahedra\": 48", "\"tetrahedra\": 48.5",
         "\"tetrahedra\" in entry 0 of \"pieces\" must be 1 or more"},
        {"\"guard\": [", "\"guard\": [1,",
         "\"guard\" in entry 0 of \"pieces\" must be an array of three numbers below 1e100"},
        {"\"guard\": [0.5", "\"guard\": [1e100",
         "\"guard\" in entry 0 of \"pieces\" must be an array of three numbers below 1e100"},
        {"\"guard\"", "\"guards\"", "key \"guard\" in entry 0 of \"pieces\" is missing"},
        {"\"star\": true", "\"star\": 1",
         "\"star\" in entry 0 of \"pieces\" must be true or false"},
        {"\"volume\": ", "\"volume\": null, \"v\": ",
         "\"volume\" in entry 0 of \"pieces\" must be a number"},
        {"\"pieces\": [", "\"pieces\": {}, \"p\": [", "\"pieces\" must be an array"},
        {"\"adjacency\": [[0", "\"adjacency\": [[-1", "\"adjacency\" must be"},
        {"\"adjacency\": [[0,", "\"adjacency\": [[", "\"adjacency\" must be"},
        {"\"adjacency\"", "\"contacts\"", "key \"adjacency\" is missing"},
        {"]}", "], \"surface\": \"near\"}", "\"surface\" must be"},
        {"]}", "], \"surface\": \"approximated\"}", "key \"distance\" is missing"},
        {"]}",
         "], \"surface\": \"approximated\", \"distance\": 1,"
         "\"distance_back\": null}",
         "\"distance_back\" must be"},
        {"]}", "]", "line"},
    };
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_HALVES);
    cut_file vtk = cut_write_vtk(&c->mesh, TEXT), json = cut_write_report(&c->report);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        expect_refusal(context, false, vtk, texts[i].old, texts[i].new, texts[i].says);
    for (size_t i = 0; i < sizeof reports / sizeof *reports; i++)
        expect_refusal(context, true, json, reports[i].old, reports[i].new, reports[i].says);
    free(vtk.bytes);
    free(json.bytes);
    free(c);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files_give_back_what_was_written),
        cmocka_unit_test(test_truncated_files),
        cmocka_unit_test(test_mutilated_files),
        cmocka_unit_test(test_bad_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
