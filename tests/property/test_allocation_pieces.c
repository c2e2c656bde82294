/* SPDX-License-Identifier: Apache-2.0 */
/* Memory failures at every place in calls about tetrahedra, star decompositions and their
 * verification. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdlib.h>

static failing_inputs in;
static input_bytes tets_text, pieces_text, report_text;
static starg_certificate *why; /* that there is a piece */

/* ---- tetrahedra ---- */

/* A mesh, and the map of its vertices. */
static starg_status mesh_and_map(starg_context *context, starg_status status, starg_mesh *mesh,
                                 uint32_t *map) {
    failing_result(status, map);
    failing_result(status, mesh);
    starg_tetmesh_map_free(context, map);
    starg_mesh_free(mesh);
    return status;
}

static starg_status surface(starg_context *context) {
    starg_mesh *mesh = NULL;
    uint32_t *map = NULL;
    starg_status status = starg_tetmesh_surface(context, in.tetmesh, &mesh, &map);
    return mesh_and_map(context, status, mesh, map);
}

static const starg_tetra_options *filling(starg_tetra_generator generator) {
    static starg_tetra_options options;
    starg_tetra_options_default(&options);
    options.generator = generator;
    options.target = 20;
    return &options;
}

#define TETMESH(NAME, VARIANT, ...)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_tetmesh, starg_tetmesh_free(out), __VA_ARGS__)
#define FILL(NAME, VARIANT, GENERATOR)                                                             \
    TETMESH(NAME, VARIANT, in.simple, filling(STARG_TETRA_##GENERATOR), &report)

static starg_status tetrahedra(starg_context *context) {
    starg_tetra_report report;
    TETMESH(starg_tetmesh_create, "", starg_tetmesh_vertices(in.tetmesh),
            starg_tetmesh_vertex_count(in.tetmesh), starg_tetmesh_tetrahedra(in.tetmesh),
            starg_tetmesh_count(in.tetmesh), NULL);
    FAILING_BY(starg_tetmesh_surface, "", surface(context));
    FILL(starg_tetmesh_from_solid, "stuffing", STUFFING);
    TETMESH(starg_tetmesh_from_open_mesh, "", in.open, filling(STARG_TETRA_AUTO), NULL);
    TETMESH(starg_tetmesh_read, "medit", failing_input("tets.mesh"));
    TETMESH(starg_tetmesh_read, "gmsh", failing_input("tets.msh"));
    TETMESH(starg_tetmesh_read, "tetgen", failing_input("tets.node"));
    TETMESH(starg_tetmesh_read_memory, "vtk", tets_text.data, tets_text.size, "t");
    FAILING(starg_tetmesh_write, "", in.tetmesh, failing_output("t.vtk"), NULL);
    return STARG_OK;
}

static starg_status by_tetgen(starg_context *context) {
    starg_tetra_report report;
    FILL(starg_tetmesh_from_solid, "tetgen", TETGEN);
    return STARG_OK;
}

/* ---- decompositions ---- */

static starg_status surfaces(starg_context *context) {
    starg_mesh *mesh = NULL;
    uint32_t *first = NULL;
    starg_status status = starg_decomposition_surfaces(context, in.decomposition, &mesh, &first);
    return mesh_and_map(context, status, mesh, first);
}

#define DECOMPOSE(NAME, VARIANT, ...)                                                              \
    FAILING_MAKES(NAME, VARIANT, starg_decomposition, starg_decomposition_free(context, out),      \
                  __VA_ARGS__)

static starg_status decompose_crossed(starg_context *context,
                                      const starg_decompose_options *options) {
    starg_solid *solid = NULL;
    starg_decomposition *out = NULL;
    starg_status status = starg_solid_create(context, in.crossed, &solid);
    if (status == STARG_OK)
        status = starg_decompose(context, solid, options, &out);
    failing_result(status, out);
    starg_decomposition_free(context, out);
    starg_solid_free(solid);
    return status;
}

static starg_decompose_options proving(void) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.effort = 3;
    options.quality = options.prove = true;
    options.prove_work = 3000;
    return options;
}

static starg_status certified(starg_context *context) {
    const starg_decompose_options options = proving();
    starg_decomposition *out = NULL;
    char *text = NULL;
    size_t size = 0;
    starg_status status =
        starg_decompose_certified(context, in.solid, &options, &out, &text, &size);
    assert_true((status == STARG_OK) == (text != NULL) && (text != NULL) == (size > 0));
    failing_result(status, out);
    starg_text_free(context, text);
    starg_decomposition_free(context, out);
    return status;
}

static starg_status decompositions(starg_context *context) {
    starg_decompose_options strict, paper;
    starg_decompose_options_default(&strict);
    strict.tetra.generator = STARG_TETRA_STUFFING;
    strict.tetra.target = 20;
    strict.effort = 3;
    strict.fill = true;
    paper = strict;
    paper.mode = STARG_DECOMPOSE_PAPER;
    starg_decompose_options given = paper;
    given.guards = in.guards->positions;
    given.guard_count = in.guards->count;
    const starg_file_bytes pieces = {pieces_text.data, pieces_text.size, "pieces"},
                           report = {report_text.data, report_text.size, "report"};
    DECOMPOSE(starg_decompose, "strict", in.solid, &strict);
    FAILING_BY(starg_decompose, "strict, self-intersecting", decompose_crossed(context, &strict));
    FAILING_BY(starg_decompose_certified, "", certified(context));
    DECOMPOSE(starg_decompose, "paper", in.solid, &paper);
    DECOMPOSE(starg_decompose, "paper, given guards", in.solid, &given);
    starg_decompose_options even = strict;
    even.balls = STARG_BALLS_EVEN;
    DECOMPOSE(starg_decompose_tetmesh, "strict, balls", in.tetmesh, &even);
    DECOMPOSE(starg_decompose_open_mesh, "strict", in.open, &strict);
    FAILING_BY(starg_decomposition_surfaces, "", surfaces(context));
    FAILING(starg_decomposition_write_groups, "", in.decomposition, failing_output("p.obj"));
    FAILING(starg_decomposition_write, "", in.decomposition, failing_output("p.vtk"), true);
    FAILING(starg_decomposition_write_report, "", in.decomposition, "room.off",
            failing_output("p.json"));
    FAILING_TEXT(starg_decomposition_write_report_memory, "", in.decomposition, "room.off");
    DECOMPOSE(starg_decomposition_read, "", failing_input("pieces.vtk"),
              failing_input("pieces.json"));
    DECOMPOSE(starg_decomposition_read_memory, "", &pieces, &report);
    return STARG_OK;
}

/* ---- verification ---- */

#define VERDICT(NAME, VARIANT, ...)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_verdict, starg_verdict_free(context, out), __VA_ARGS__)
#define RESULT(NAME, VARIANT, FILE)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_result, starg_result_free(context, out), failing_input(FILE))

static starg_status verification(starg_context *context) {
    FAILING_MAKES(starg_pieces_mesh_read_memory, "", starg_pieces_mesh,
                  starg_pieces_mesh_free(context, out), pieces_text.data, pieces_text.size, "p");
    FAILING_MAKES(starg_pieces_report_read_memory, "", starg_pieces_report,
                  starg_pieces_report_free(context, out), report_text.data, report_text.size, "r");
    VERDICT(starg_verify_pieces, "", in.room, in.pieces, in.report);
    VERDICT(starg_verify_pieces_with, "", in.room, why, in.pieces, in.report);
    VERDICT(starg_verify_pieces_of_tetmesh, "", in.decomposition->mesh, in.pieces, NULL);
    RESULT(starg_result_read, "guards", "guards.json");
    RESULT(starg_result_read, "pieces", "pieces.vtk");
    RESULT(starg_result_read, "report", "pieces.json");
    return STARG_OK;
}

FAILING_TEST(tetrahedra)
FAILING_TEST(decompositions)
FAILING_TEST(verification)

static void test_tetgen(void **state) {
    (void)state;
    failing_run_with_tetgen(by_tetgen);
}

static int set_up(void **state) {
    (void)state;
    failing_inputs_make(&in);
    tets_text = failing_input_bytes("tets.vtk");
    pieces_text = failing_input_bytes("pieces.vtk");
    report_text = failing_input_bytes("pieces.json");
    const starg_decompose_options options = proving();
    starg_decomposition *pieces = NULL;
    char *text = NULL;
    size_t size = 0;
    test_ok(in.context,
            starg_decompose_certified(in.context, in.solid, &options, &pieces, &text, &size));
    test_ok(in.context, starg_certificate_read_memory(in.context, text, size, "c", &why));
    starg_text_free(in.context, text);
    starg_decomposition_free(in.context, pieces);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(tets_text.data);
    free(pieces_text.data);
    free(report_text.data);
    starg_certificate_free(why);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tetrahedra),
        cmocka_unit_test(test_tetgen),
        cmocka_unit_test(test_decompositions),
        cmocka_unit_test(test_verification),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
