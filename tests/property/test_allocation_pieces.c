/* Memory that fails at every place of the calls about tetrahedra, star decompositions and what
 * verifies them. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static failing_inputs in;
static input_bytes tets_text, pieces_text, report_text;

/* ---- tetrahedra ---- */

static starg_status tetmesh_result(starg_status status, starg_tetmesh *mesh) {
    failing_result(status, mesh);
    starg_tetmesh_free(mesh);
    return status;
}

static starg_status tetmesh_create(starg_context *context) {
    starg_tetmesh *mesh = NULL;
    starg_status status = starg_tetmesh_create(
        context, starg_tetmesh_vertices(in.tetmesh), starg_tetmesh_vertex_count(in.tetmesh),
        starg_tetmesh_tetrahedra(in.tetmesh), starg_tetmesh_count(in.tetmesh), NULL, &mesh);
    return tetmesh_result(status, mesh);
}

static starg_status tetmesh_surface(starg_context *context) {
    starg_mesh *mesh = NULL;
    uint32_t *map = NULL;
    starg_status status = starg_tetmesh_surface(context, in.tetmesh, &mesh, &map);
    failing_result(status, map);
    failing_result(status, mesh);
    starg_tetmesh_map_free(context, map);
    starg_mesh_free(mesh);
    return status;
}

static starg_status fill(starg_context *context, starg_tetra_generator generator,
                         const char *program) {
    starg_tetra_options options;
    starg_tetra_report report;
    starg_tetmesh *mesh = NULL;
    starg_tetra_options_default(&options);
    options.generator = generator;
    options.target = 20;
    options.tetgen = program;
    starg_status status = starg_tetmesh_from_solid(context, in.simple, &options, &report, &mesh);
    return tetmesh_result(status, mesh);
}

static starg_status fill_by_stuffing(starg_context *context) {
    return fill(context, STARG_TETRA_STUFFING, NULL);
}

static starg_status fill_by_tetgen(starg_context *context) {
    return fill(context, STARG_TETRA_TETGEN, NULL);
}

/* A program that is not there: files are written, then stuffing takes over. */
static starg_status fill_without_tetgen(starg_context *context) {
    return fill(context, STARG_TETRA_AUTO, "/nowhere/tetgen");
}

static starg_status fill_open_mesh(starg_context *context) {
    starg_tetra_options options;
    starg_tetmesh *mesh = NULL;
    starg_tetra_options_default(&options);
    options.target = 20;
    starg_status status = starg_tetmesh_from_open_mesh(context, in.open, &options, NULL, &mesh);
    return tetmesh_result(status, mesh);
}

static starg_status read_named(starg_context *context, const char *name) {
    starg_tetmesh *mesh = NULL;
    starg_status status = starg_tetmesh_read(context, failing_input(name), &mesh);
    return tetmesh_result(status, mesh);
}

static starg_status read_medit(starg_context *context) {
    return read_named(context, "tets.mesh");
}

static starg_status read_gmsh(starg_context *context) {
    return read_named(context, "tets.msh");
}

static starg_status read_tetgen(starg_context *context) {
    return read_named(context, "tets.node");
}

static starg_status read_memory(starg_context *context) {
    starg_tetmesh *mesh = NULL;
    starg_status status =
        starg_tetmesh_read_memory(context, tets_text.data, tets_text.size, "t", &mesh);
    return tetmesh_result(status, mesh);
}

static starg_status tetmesh_write(starg_context *context) {
    return starg_tetmesh_write(context, in.tetmesh, failing_output("t.vtk"), NULL);
}

/* ---- decompositions ---- */

static starg_decompose_options little_effort(starg_decompose_mode mode) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.mode = mode;
    options.tetra.generator = STARG_TETRA_STUFFING;
    options.tetra.target = 20;
    options.effort = 3;
    return options;
}

static starg_status decomposition_result(starg_context *context, starg_status status,
                                         starg_decomposition *decomposition) {
    failing_result(status, decomposition);
    starg_decomposition_free(context, decomposition);
    return status;
}

static starg_status decompose_strict(starg_context *context) {
    const starg_decompose_options options = little_effort(STARG_DECOMPOSE_STRICT);
    starg_decomposition *d = NULL;
    starg_status status = starg_decompose(context, in.solid, &options, &d);
    return decomposition_result(context, status, d);
}

static starg_status decompose_paper(starg_context *context) {
    const starg_decompose_options options = little_effort(STARG_DECOMPOSE_PAPER);
    starg_decomposition *d = NULL;
    starg_status status = starg_decompose(context, in.solid, &options, &d);
    return decomposition_result(context, status, d);
}

static starg_status decompose_given_guards(starg_context *context) {
    starg_decompose_options options = little_effort(STARG_DECOMPOSE_PAPER);
    starg_decomposition *d = NULL;
    options.guards = in.guards->positions;
    options.guard_count = in.guards->count;
    starg_status status = starg_decompose(context, in.solid, &options, &d);
    return decomposition_result(context, status, d);
}

static starg_status decompose_tetmesh(starg_context *context) {
    const starg_decompose_options options = little_effort(STARG_DECOMPOSE_STRICT);
    starg_decomposition *d = NULL;
    starg_status status = starg_decompose_tetmesh(context, in.tetmesh, &options, &d);
    return decomposition_result(context, status, d);
}

static starg_status decompose_open_mesh(starg_context *context) {
    const starg_decompose_options options = little_effort(STARG_DECOMPOSE_STRICT);
    starg_decomposition *d = NULL;
    starg_status status = starg_decompose_open_mesh(context, in.open, &options, &d);
    return decomposition_result(context, status, d);
}

static starg_status surfaces(starg_context *context) {
    starg_mesh *mesh = NULL;
    uint32_t *first = NULL;
    starg_status status = starg_decomposition_surfaces(context, in.decomposition, &mesh, &first);
    failing_result(status, first);
    failing_result(status, mesh);
    starg_tetmesh_map_free(context, first);
    starg_mesh_free(mesh);
    return status;
}

static starg_status write_groups(starg_context *context) {
    return starg_decomposition_write_groups(context, in.decomposition, failing_output("p.obj"));
}

static starg_status write_pieces(starg_context *context) {
    return starg_decomposition_write(context, in.decomposition, failing_output("p.vtk"), true);
}

static starg_status write_report(starg_context *context) {
    return starg_decomposition_write_report(context, in.decomposition, "room.off",
                                            failing_output("p.json"));
}

static starg_status write_report_memory(starg_context *context) {
    char *text;
    size_t size;
    starg_status status = starg_decomposition_write_report_memory(context, in.decomposition,
                                                                  "room.off", &text, &size);
    failing_result(status, text);
    starg_text_free(context, text);
    return status;
}

static starg_status decomposition_read(starg_context *context) {
    starg_decomposition *d = NULL;
    starg_status status = starg_decomposition_read(context, failing_input("pieces.vtk"),
                                                   failing_input("pieces.json"), &d);
    failing_result(status, d);
    starg_decomposition_free(context, d);
    return status;
}

static starg_status decomposition_read_memory(starg_context *context) {
    starg_decomposition *d = NULL;
    const starg_file_bytes pieces = {pieces_text.data, pieces_text.size, "pieces"},
                           report = {report_text.data, report_text.size, "report"};
    starg_status status = starg_decomposition_read_memory(context, &pieces, &report, &d);
    failing_result(status, d);
    starg_decomposition_free(context, d);
    return status;
}

/* ---- verification ---- */

static starg_status verdict_result(starg_context *context, starg_status status,
                                   starg_verdict *verdict) {
    failing_result(status, verdict);
    starg_verdict_free(context, verdict);
    return status;
}

static starg_status pieces_mesh_read(starg_context *context) {
    starg_pieces_mesh *mesh = NULL;
    starg_status status =
        starg_pieces_mesh_read_memory(context, pieces_text.data, pieces_text.size, "p", &mesh);
    failing_result(status, mesh);
    starg_pieces_mesh_free(context, mesh);
    return status;
}

static starg_status pieces_report_read(starg_context *context) {
    starg_pieces_report *report = NULL;
    starg_status status =
        starg_pieces_report_read_memory(context, report_text.data, report_text.size, "r", &report);
    failing_result(status, report);
    starg_pieces_report_free(context, report);
    return status;
}

static starg_status verify_pieces(starg_context *context) {
    starg_verdict *verdict = NULL;
    starg_status status = starg_verify_pieces(context, in.room, in.pieces, in.report, &verdict);
    return verdict_result(context, status, verdict);
}

static starg_status verify_pieces_of_tetmesh(starg_context *context) {
    starg_verdict *verdict = NULL;
    starg_status status =
        starg_verify_pieces_of_tetmesh(context, in.decomposition->mesh, in.pieces, NULL, &verdict);
    return verdict_result(context, status, verdict);
}

static starg_status result_of(starg_context *context, const char *name) {
    starg_result *result = NULL;
    starg_status status = starg_result_read(context, failing_input(name), &result);
    failing_result(status, result);
    starg_result_free(context, result);
    return status;
}

static starg_status result_guards(starg_context *context) {
    return result_of(context, "guards.json");
}

static starg_status result_pieces(starg_context *context) {
    return result_of(context, "pieces.vtk");
}

static starg_status result_report(starg_context *context) {
    return result_of(context, "pieces.json");
}

/* ---- the tables ---- */

static const failing_call tetrahedra[] = {
    {"starg_tetmesh_create", "", tetmesh_create, NULL},
    {"starg_tetmesh_surface", "", tetmesh_surface, NULL},
    {"starg_tetmesh_from_solid", "stuffing", fill_by_stuffing, NULL},
    {"starg_tetmesh_from_solid", "no tetgen, stuffing", fill_without_tetgen, NULL},
    {"starg_tetmesh_from_open_mesh", "", fill_open_mesh, NULL},
    {"starg_tetmesh_read", "medit", read_medit, NULL},
    {"starg_tetmesh_read", "gmsh", read_gmsh, NULL},
    {"starg_tetmesh_read", "tetgen", read_tetgen, NULL},
    {"starg_tetmesh_read_memory", "vtk", read_memory, NULL},
    {"starg_tetmesh_write", "", tetmesh_write, NULL},
};

static const failing_call by_tetgen[] = {
    {"starg_tetmesh_from_solid", "tetgen", fill_by_tetgen, NULL},
};

static const failing_call decompositions[] = {
    {"starg_decompose", "strict", decompose_strict, NULL},
    {"starg_decompose", "paper", decompose_paper, NULL},
    {"starg_decompose", "paper, given guards", decompose_given_guards, NULL},
    {"starg_decompose_tetmesh", "strict", decompose_tetmesh, NULL},
    {"starg_decompose_open_mesh", "strict", decompose_open_mesh, NULL},
    {"starg_decomposition_surfaces", "", surfaces, NULL},
    {"starg_decomposition_write_groups", "", write_groups, NULL},
    {"starg_decomposition_write", "", write_pieces, NULL},
    {"starg_decomposition_write_report", "", write_report, NULL},
    {"starg_decomposition_write_report_memory", "", write_report_memory, NULL},
    {"starg_decomposition_read", "", decomposition_read, NULL},
    {"starg_decomposition_read_memory", "", decomposition_read_memory, NULL},
};

static const failing_call verification[] = {
    {"starg_pieces_mesh_read_memory", "", pieces_mesh_read, NULL},
    {"starg_pieces_report_read_memory", "", pieces_report_read, NULL},
    {"starg_verify_pieces", "", verify_pieces, NULL},
    {"starg_verify_pieces_of_tetmesh", "", verify_pieces_of_tetmesh, NULL},
    {"starg_result_read", "guards", result_guards, NULL},
    {"starg_result_read", "pieces", result_pieces, NULL},
    {"starg_result_read", "report", result_report, NULL},
};

static void test_tetrahedra(void **state) {
    (void)state;
    FAILING_RUN(tetrahedra);
}

static void test_tetgen(void **state) {
    (void)state;
    starg_status status = fill_by_tetgen(in.context);
    if (status == STARG_ERROR_SOLVER) {
        printf("skipped: %s\n", starg_context_error(in.context)->message);
        skip();
    }
    test_ok(in.context, status);
    FAILING_RUN(by_tetgen);
}

static void test_decompositions(void **state) {
    (void)state;
    FAILING_RUN(decompositions);
}

static void test_verification(void **state) {
    (void)state;
    FAILING_RUN(verification);
}

static int set_up(void **state) {
    (void)state;
    failing_inputs_make(&in);
    tets_text = failing_input_bytes("tets.vtk");
    pieces_text = failing_input_bytes("pieces.vtk");
    report_text = failing_input_bytes("pieces.json");
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(tets_text.data);
    free(pieces_text.data);
    free(report_text.data);
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
