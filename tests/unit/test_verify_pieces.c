/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier of star decompositions: decompositions built by hand pass, and with one error they
 * fail the right claim. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "cut.h"
#include "support.h"
#include "visibility_oracle.h"

/* ---- claims ---- */

static starg_mesh *make_mesh(starg_context *context, const shape *s) {
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, s->vertices, s->vertex_count, s->faces,
                                       s->face_count, &mesh));
    return mesh;
}

static void expect_consistent(const starg_verdict *verdict) {
    bool all = true;
    for (size_t i = 0; i < verdict->count; i++) {
        assert_true(strlen(verdict->claims[i].text) > 10);
        all = all && verdict->claims[i].holds;
    }
    assert_int_equal(verdict->passed, all);
}

static starg_verdict *verify(starg_context *context, const shape *model, const cut *c) {
    starg_verdict *verdict = NULL;
    starg_mesh *mesh = make_mesh(context, model);
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict));
    starg_mesh_free(mesh);
    expect_consistent(verdict);
    return verdict;
}

static void expect_pass(starg_context *context, const shape *model, const cut *c) {
    starg_verdict *verdict = verify(context, model, c);
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            fail_msg("%s", verdict->claims[i].text);
    assert_true(verdict->count >= 14);
    starg_verdict_free(context, verdict);
}

/* A claim with this text fails, and with `alone` no other one. */
static void expect_failure(starg_context *context, const shape *model, const cut *c,
                           const char *says, bool alone) {
    starg_verdict *verdict = verify(context, model, c);
    bool found = false;
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        bool meant = strstr(claim->text, says) != NULL;
        found = found || (meant && !claim->holds);
        if (alone && !meant && !claim->holds)
            fail_msg("wrong is \"%s\", but what fails is \"%s\"", says, claim->text);
    }
    for (size_t i = 0; i < verdict->count && !found; i++)
        print_error("%d %s\n", verdict->claims[i].holds, verdict->claims[i].text);
    if (!found)
        fail_msg("\"%s\" does not fail", says);
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
}

static const grid *const GRIDS[] = {&GRID_HALVES, &GRID_CORNER, &GRID_BEND, &GRID_RING,
                                    &GRID_CAVITY};
enum { GRID_COUNT = sizeof GRIDS / sizeof *GRIDS };

static void test_true_decompositions_pass(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int i = 0; i < GRID_COUNT; i++) {
        shape model = grid_model(GRIDS[i]);
        cut *c = cut_new(GRIDS[i]);
        expect_pass(context, &model, c);
        c->report.mode = STARG_DECOMPOSE_PAPER;
        expect_pass(context, &model, c);
        shape_free(&model);
        free(c);
    }
    test_context_free(context);
}

/* Far from the origin, huge, tiny and stretched: everything without tolerance stays exact. */
static void test_scales(void **state) {
    (void)state;
    static const struct {
        double scale, offset;
    } places[] = {{1e90, 0}, {1e-90, 0}, {1e-110, 0}, {1, 1048576}, {0.1, 1000.1}, {3e-7, -0.3}};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        shape model = grid_model(&GRID_CAVITY);
        cut *c = cut_new(&GRID_CAVITY);
        shape_place(&model, places[i].scale, places[i].offset);
        for (size_t k = 0; k < 3 * c->mesh.vertex_count; k++)
            c->vertices[k] = places[i].scale * c->vertices[k] + places[i].offset;
        for (size_t p = 0; p < c->report.piece_count; p++)
            for (int k = 0; k < 3; k++)
                c->pieces[p].guard[k] = places[i].scale * c->pieces[p].guard[k] + places[i].offset;
        cut_recount(c);
        expect_pass(context, &model, c);
        shape_free(&model);
        free(c);
    }
    test_context_free(context);
}

/* ---- falsified decompositions ---- */

static void swap_label(cut *c) { /* the tetrahedron of a towards b becomes one of b */
    for (size_t t = 0; t < c->mesh.count; t++)
        if (c->labels[t] == 0) {
            c->labels[t] = 1;
            break;
        }
}

static void swap_label_and_recount(cut *c) {
    swap_label(c);
    cut_recount(c);
}

static void move_guard_out(cut *c) {
    c->pieces[0].guard[1] = nextafter(1, 2); /* the walls of a end at y = 1 */
}

static void move_guard_to_plane(cut *c) {
    c->pieces[0].guard[1] = 1;
}

static void move_guard_to_corner(cut *c) {
    memset(c->pieces[2].guard, 0, sizeof c->pieces[2].guard);
}

static void remove_tetrahedron(cut *c) {
    c->mesh.count--;
    cut_recount(c);
}

static void double_tetrahedron(cut *c) {
    const uint32_t *v = c->tetrahedra + 4;
    cut_add_tetrahedron(c, v[0], v[1], v[2], v[3], c->labels[1]);
    cut_recount(c);
}

static void add_third(cut *c) { /* on the outer side of an inner face: a third one there */
    const double far[3] = {-1, -1, -1};
    const uint32_t *v = c->tetrahedra;
    cut_add_tetrahedron(c, v[0], v[2], v[3], cut_add_vertex(c, far), c->labels[0]);
    cut_recount(c);
}

static void invert_tetrahedron(cut *c) {
    uint32_t *v = c->tetrahedra + 8, first = v[0];
    v[0] = v[1];
    v[1] = first;
}

static void flatten_tetrahedron(cut *c) {
    uint32_t *v = c->tetrahedra + 8;
    memcpy(c->vertices + 3 * (size_t)v[3], cut_point(c, v[0]), 3 * sizeof(double));
}

static void repeat_corner(cut *c) {
    c->tetrahedra[9] = c->tetrahedra[8];
}

static void move_outer_vertex(cut *c) {
    const double corner[3] = {0, 0, 0};
    c->vertices[3 * (size_t)cut_add_vertex(c, corner)] -= 1e-7;
    cut_recount(c);
}

static void push_inner_vertex_out(cut *c) {
    const double guard[3] = {0.5, 0.5, 0.5};
    c->vertices[3 * (size_t)cut_add_vertex(c, guard) + 2] = 7;
}

static void hang_vertex(cut *c) { /* on an inner edge, split in one tetrahedron only */
    static const double a[3] = {0, 1, 0}, b[3] = {1, 1, 1};
    cut_split_middle(c, a, b, CUT_FIRST);
}

static void hang_face_vertex(cut *c) { /* split on one side of the contact of a and b only */
    static const double a[3] = {2, 1, 0}, b[3] = {3, 1, 1};
    cut_split_middle(c, a, b, 0);
}

static void part_piece(cut *c) { /* b and d, on opposite sides of the ring, become one */
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] = c->labels[t] == 3 ? 1 : c->labels[t];
    c->report.piece_count = c->report.strictly_star = 3;
    cut_recount(c);
}

static void add_empty_piece(cut *c) {
    c->pieces[c->report.piece_count++] = c->pieces[0];
}

static void skip_label(cut *c) {
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] += c->labels[t] == 3;
    c->report.piece_count++;
    cut_recount(c);
}

static void exceed_labels(cut *c) {
    c->labels[5] = 4;
}

static void lower_label(cut *c) {
    c->labels[5] = -1;
}

static void raise_label(cut *c) {
    c->labels[5] = INT32_MAX;
}

static void raise_volume(cut *c) {
    c->pieces[1].volume *= 1 + 1e-8;
}

static void lose_volume(cut *c) {
    c->pieces[1].volume = NAN;
}

static void raise_area(cut *c) {
    c->contacts[2].area *= 1 + 1e-8;
}

static void lose_contact(cut *c) {
    c->report.contact_count--;
}

static void repeat_contact(cut *c) {
    c->contacts[c->report.contact_count++] = c->contacts[0];
}

static void invent_contact(cut *c) {
    c->contacts[c->report.contact_count++] = (starg_piece_contact){0, 2, 0};
}

static void turn_contact(cut *c) {
    c->contacts[0] = (starg_piece_contact){1, 0, c->contacts[0].area};
}

static void miscall_contact(cut *c) {
    c->contacts[0].second = 77;
}

static void miscount(cut *c) {
    c->pieces[1].tetrahedra++;
    c->pieces[2].tetrahedra--;
}

static void miscount_all(cut *c) {
    c->report.tetrahedra++;
}

static void lower_star(cut *c) {
    c->report.strictly_star--;
}

static void deny_star(cut *c) {
    c->pieces[1].star = false;
    c->report.strictly_star--;
}

static void lower_seen(cut *c) {
    c->report.visible_vertices = 1 - 1e-6;
}

static void lose_seen(cut *c) {
    c->report.visible_vertices = NAN;
}

static void admit_failure(cut *c) { /* true, but violates strict mode */
    move_guard_to_plane(c);
    c->pieces[0].star = false;
    c->report.strictly_star--;
}

static void fill_hole(cut *c) {
    static const grid filled = {"Aaa"
                                "DEB"
                                "Ccc",
                                {3, 3, 1}};
    cut *whole = cut_new(&filled);
    cut_assign(c, whole);
    free(whole);
}

static void drop_piece(cut *c) { /* the last tetrahedra are those of c */
    size_t left = 0;
    for (size_t t = 0; t < c->mesh.count; t++)
        if (c->labels[t] != 3) {
            memcpy(c->tetrahedra + 4 * left, c->tetrahedra + 4 * t, 4 * sizeof(uint32_t));
            c->labels[left++] = c->labels[t];
        }
    c->mesh.count = left;
    c->report.piece_count = c->report.strictly_star = 3;
    cut_recount(c);
}

typedef struct falsification {
    void (*apply)(cut *c);
    const char *claim; /* part of the text of the claim that must fail */
    bool alone;        /* only this one fails */
} falsification;

static const falsification FALSIFICATIONS[] = {
    {swap_label, "star-shaped", false},
    {swap_label, "as many tetrahedra as claimed: 2 have not, first piece 0", false},
    {swap_label, "the volume that is claimed: 2 have not, first piece 0", false},
    {swap_label_and_recount, "each piece is connected through faces: piece 1 falls apart", false},
    {move_guard_out, "first piece 0, whose guard is not strictly on the inner side of face", false},
    {move_guard_out, "4 pieces are strictly star-shaped (called so: 4, found: 3)", false},
    {move_guard_to_plane, "first piece 0, whose guard is not strictly on the inner side", false},
    {move_guard_to_corner, "first piece 2, whose guard is not strictly on the inner side", false},
    {remove_tetrahedron, "on the model's surface and looks its way: 3 of", false},
    {remove_tetrahedron, "the volume of the model", false},
    {double_tetrahedron, "each triangle has one tetrahedron, or two on opposite sides", false},
    {double_tetrahedron, "of tetrahedron", false},
    {add_third, "1 have more, first face", false},
    {invert_tetrahedron, "1 are inverted or flat, first tetrahedron 2 of piece 0", false},
    {invert_tetrahedron, "have two on one side, first face", false},
    {flatten_tetrahedron, "inverted or flat", false},
    {repeat_corner, "1 are inverted or flat, first tetrahedron 2", false},
    {move_outer_vertex, "the boundary lies on the model's surface", false},
    {push_inner_vertex_out, "inverted or flat", false},
    {hang_vertex, "faces lie elsewhere", false},
    {hang_face_vertex, "faces lie elsewhere", false},
    {part_piece, "piece 1 falls apart, tetrahedra", false},
    {add_empty_piece, "1 are empty, first piece 4", true},
    {skip_label, "1 are empty, first piece 3", true},
    {exceed_labels, "tetrahedron 5 has label 4", true},
    {lower_label, "tetrahedron 5 has label -1", true},
    {raise_label, "tetrahedron 5 has label 2147483647", true},
    {raise_volume, "the volume that is claimed: 1 have not, first piece 1", true},
    {lose_volume, "the volume that is claimed: 1 have not, first piece 1", true},
    {raise_area, "contacts of pieces and their areas are right: 1", true},
    {lose_contact, "contacts of pieces and their areas are right: 1", true},
    {repeat_contact, "contacts of pieces and their areas are right: 1", true},
    {invent_contact, "missing, first 0-2", true},
    {turn_contact, "contacts of pieces and their areas are right: 2", true},
    {miscall_contact, "missing, first 0-77", true},
    {miscount, "as many tetrahedra as claimed: 2 have not, first piece 1", true},
    {miscount_all, "tetrahedra (the file holds", true},
    {lower_star, "3 pieces are strictly star-shaped (called so: 4, found: 4)", true},
    {deny_star, "3 pieces are strictly star-shaped (called so: 3, found: 4)", true},
    {lower_seen, "of their pieces' vertices (found: 1; 0 of", true},
    {lose_seen, "of their pieces' vertices", true},
    {admit_failure, "in strict mode all 4 pieces are star-shaped (found: 3)", false},
    {fill_hole, "faces lie elsewhere", false},
    {fill_hole, "shells once: not so for 1", false},
    {drop_piece, "faces lie elsewhere", false},
    {drop_piece, "shells once: not so for 1", false},
};

static void test_each_falsification_fails(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_RING);
    cut *truth = cut_new(&GRID_RING);
    expect_pass(context, &model, truth);
    for (size_t i = 0; i < sizeof FALSIFICATIONS / sizeof *FALSIFICATIONS; i++) {
        cut *c = cut_copy(truth);
        FALSIFICATIONS[i].apply(c);
        expect_failure(context, &model, c, FALSIFICATIONS[i].claim, FALSIFICATIONS[i].alone);
        free(c);
    }
    free(truth);
    shape_free(&model);
    test_context_free(context);
}

/* The plane of a wall is x = 2: the last double before it passes, 2 and the next one do not. */
static void test_guard_at_a_plane(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_HALVES);
    cut *c = cut_new(&GRID_HALVES);
    c->pieces[0].guard[0] = nextafter(2, 0);
    expect_pass(context, &model, c);
    c->pieces[0].guard[0] = 2;
    expect_failure(context, &model, c, "first piece 0, whose guard is not", false);
    c->pieces[0].guard[0] = nextafter(2, 3);
    expect_failure(context, &model, c, "first piece 0, whose guard is not", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* ---- boundaries ---- */

/* Edges of the surface and of contacts split, where rounding leaves the plane and where it does
 * not. */
static void test_subdivided(void **state) {
    (void)state;
    static const double a[3] = {0, 1, 0}, b[3] = {1, 1, 1}, o[3] = {0, 0, 0}, x[3] = {1, 0, 0};
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_RING);
    cut *c = cut_new(&GRID_RING);
    cut_split_middle(c, o, x, CUT_ALL);
    cut_split_middle(c, a, b, CUT_ALL);
    expect_pass(context, &model, c);
    starg_verdict *verdict = verify(context, &model, c);
    bool told = false;
    for (size_t i = 0; i < verdict->count; i++)
        told = told || strstr(verdict->claims[i].text, "faces of the model, 4 parts") != NULL;
    assert_true(told);
    starg_verdict_free(context, verdict);

    static const double near[3] = {0.5, 1e-11, -1e-11}, away[3] = {0.5, 1e-7, 0};
    const double middle[3] = {0.5, 0, 0};
    double *moved = c->vertices + 3 * (size_t)cut_add_vertex(c, middle);
    memcpy(moved, near, sizeof near);
    cut_recount(c);
    expect_pass(context, &model, c);
    memcpy(moved, away, sizeof away);
    cut_recount(c);
    expect_failure(context, &model, c, "faces lie elsewhere", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* An isolated vertex very far away does not affect tolerances. */
static void test_far_vertex(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_RING);
    cut *c = cut_new(&GRID_RING);
    const double far[3] = {1e50, 0, 0};
    model.vertices = realloc(model.vertices, 3 * (model.vertex_count + 1) * sizeof(double));
    memcpy(model.vertices + 3 * model.vertex_count++, far, sizeof far);
    cut_add_vertex(c, far);
    expect_pass(context, &model, c);
    move_outer_vertex(c);
    expect_failure(context, &model, c, "faces lie elsewhere", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* A ring around an axis, traversed twice: all tetrahedra positive, all faces on the model with the
 * right side, and the guard behind none; but everything is covered twice. */
static void test_double_winding(void **state) {
    (void)state;
    static const double ring[4][3] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    static const double top[3] = {0, 0, 1}, bottom[3] = {0, 0, -1}, middle[3] = {0, 0, 0};
    static const grid none = {"", {0, 0, 0}};
    starg_context *context = test_context(1);
    shape model = shape_blob(0, 1);
    cut *c = cut_new(&none);
    uint32_t t = cut_add_vertex(c, top), s = cut_add_vertex(c, bottom),
             g = cut_add_vertex(c, middle), r[8];
    for (int i = 0; i < 8; i++) { /* coincident points stay separate */
        r[i] = (uint32_t)c->mesh.vertex_count++;
        memcpy(c->vertices + 3 * (size_t)r[i], ring[i % 4], 3 * sizeof(double));
    }
    for (int i = 0; i < 8; i++) {
        cut_add_tetrahedron(c, t, r[(i + 1) % 8], r[i], g, 0);
        cut_add_tetrahedron(c, s, r[i], r[(i + 1) % 8], g, 0);
    }
    for (size_t i = 0; i < model.vertex_count; i++) /* the octahedron again */
        for (int k = 0; k < 3; k++) {
            double x = model.vertices[3 * i + (size_t)k];
            model.vertices[3 * i + (size_t)k] = (x > 0) - (x < 0);
        }
    c->report.piece_count = c->report.strictly_star = 1;
    c->pieces[0].star = true;
    const double guard[3] = {0.1, 0.2, 0.05};
    memcpy(c->pieces[0].guard, guard, sizeof guard);
    c->report.visible_vertices = 1;
    cut_recount(c);
    expect_failure(context, &model, c, "whose boundary winds 2 times around its guard", false);
    expect_failure(context, &model, c, "shells once: not so for 1", false);
    expect_failure(context, &model, c, "the volume of the model", false);
    c->report.approximated = true;
    c->report.distance = c->report.distance_back = 1e-9;
    expect_failure(context, &model, c,
                   "no two faces of the boundary pass through one another: ", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* Two cells that touch in a corner: one of them twice, the other missing. Area, volume and faces
 * equal the model's. */
static void test_one_shell_for_another(void **state) {
    (void)state;
    static const grid cell = {"A", {1, 1, 1}};
    starg_context *context = test_context(1);
    shape model = shape_cells("#......#", 2, 2, 2);
    cut *c = cut_new(&cell);
    uint32_t base = (uint32_t)c->mesh.vertex_count;
    memcpy(c->vertices + 3 * (size_t)base, c->vertices, 3 * base * sizeof(double));
    c->mesh.vertex_count *= 2;
    for (size_t t = 0; t < 12; t++) {
        const uint32_t *v = c->tetrahedra + 4 * t;
        cut_add_tetrahedron(c, base + v[0], base + v[1], base + v[2], base + v[3], 1);
    }
    c->report.piece_count = c->report.strictly_star = 2;
    c->pieces[1] = c->pieces[0];
    cut_recount(c);
    expect_failure(context, &model, c, "shells once: not so for 2", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

static void test_model_turned_inside_out(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_CAVITY), turned = {0};
    const double nowhere[3] = {0, 0, 0};
    shape_append(&turned, &model, nowhere, 1);
    cut *c = cut_new(&GRID_CAVITY);
    expect_pass(context, &turned, c); /* shells are reoriented */
    shape_free(&model);
    model = shape_cube(3); /* without the cavity */
    expect_failure(context, &model, c, "faces lie elsewhere", false);
    shape_free(&model);
    shape_free(&turned);
    free(c);
    test_context_free(context);
}

static void test_approximated(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_RING);
    cut *c = cut_new(&GRID_RING);
    shape_place(&model, 1, 0.0625);
    c->report.approximated = true;
    c->report.distance = c->report.distance_back = 0.0625 * sqrt(3);
    expect_pass(context, &model, c);
    model.face_count -= 2; /* an open model has no inside, but a surface */
    expect_failure(context, &model, c, "the boundary is at most", true);
    c->report.distance = 0.3;
    expect_pass(context, &model, c);
    c->report.distance = 0.0624;
    expect_failure(context, &model, c, "the boundary is at most", true);
    c->report.distance = NAN;
    expect_failure(context, &model, c, "the boundary is at most", true);
    c->report.distance = 0.3;
    c->report.distance_back = 0.0624;
    expect_failure(context, &model, c, "the model's surface is at most", true);
    c->report.distance_back = INFINITY; /* not given */
    expect_pass(context, &model, c);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* Two nested pieces, each valid alone. */
static void test_overlap_of_shells(void **state) {
    (void)state;
    static const grid small = {"A", {1, 1, 1}};
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_HALVES), *inner = cut_new(&small);
    shape model = grid_model(&GRID_HALVES);
    uint32_t base = (uint32_t)c->mesh.vertex_count;
    for (size_t v = 0; v < inner->mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            c->vertices[3 * c->mesh.vertex_count + 3 * v + (size_t)k] =
                0.5 * inner->vertices[3 * v + (size_t)k] + 0.25;
    c->mesh.vertex_count += inner->mesh.vertex_count;
    for (size_t t = 0; t < inner->mesh.count; t++) {
        const uint32_t *v = inner->tetrahedra + 4 * t;
        cut_add_tetrahedron(c, base + v[0], base + v[1], base + v[2], base + v[3], 2);
    }
    c->report.piece_count = c->report.strictly_star = 3;
    c->pieces[2] = inner->pieces[0];
    cut_recount(c);
    c->report.approximated = true;
    c->report.distance = c->report.distance_back = 1;
    expect_failure(context, &model, c, "winds once around the inside of its 2 shells: not so for 1",
                   true);
    free(c);
    free(inner);
    shape_free(&model);
    test_context_free(context);
}

static void test_tetmesh_model(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = cut_new(&GRID_CAVITY);
    starg_tetmesh *tetmesh = NULL;
    starg_verdict *verdict = NULL;
    test_ok(context, starg_tetmesh_create(context, c->vertices, c->mesh.vertex_count, c->tetrahedra,
                                          c->mesh.count, NULL, &tetmesh));
    test_ok(context,
            starg_verify_pieces_of_tetmesh(context, tetmesh, &c->mesh, &c->report, &verdict));
    expect_consistent(verdict);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    move_outer_vertex(c);
    test_ok(context,
            starg_verify_pieces_of_tetmesh(context, tetmesh, &c->mesh, &c->report, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    starg_tetmesh_free(tetmesh);
    free(c);
    test_context_free(context);
}

/* ---- vertices seen ---- */

/* The fraction by the definition: every segment against every outer face. */
static double fraction_seen(const cut *c) {
    size_t outer = 0, pairs = 0, seen = 0;
    uint32_t *faces = calloc(12 * c->mesh.count, sizeof *faces);
    bool *visible = calloc(c->mesh.vertex_count, sizeof *visible);
    for (size_t s = 0; s < c->mesh.count; s++)
        for (int i = 0; i < 4; i++) {
            bool alone = true;
            uint32_t a[3], b[3];
            cut_side(c, s, i, a);
            for (size_t t = 0; t < 4 * c->mesh.count && alone; t++) {
                cut_side(c, t / 4, (int)(t % 4), b);
                alone = !cut_opposite(a, b);
            }
            if (alone)
                memcpy(faces + 3 * outer++, a, sizeof a);
        }
    for (size_t p = 0; p < c->report.piece_count; p++) {
        visibility_oracle_vertices(c->vertices, c->mesh.vertex_count, faces, outer,
                                   c->pieces[p].guard, visible);
        for (uint32_t v = 0; v < c->mesh.vertex_count; v++) {
            bool own = false;
            for (size_t t = 0; t < 4 * c->mesh.count && !own; t++)
                own = c->labels[t / 4] == (int32_t)p && c->tetrahedra[t] == v;
            pairs += own;
            seen += own && visible[v];
        }
    }
    free(faces);
    free(visible);
    return (double)seen / (double)pairs;
}

/* Guards anywhere, in the mode that allows it; also outside and on the surface. */
static void test_visible_vertices(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_CAVITY);
    size_t partial = 0;
    for (uint64_t round = 0; round < 12; round++) {
        cut *c = cut_new(&GRID_CAVITY);
        starg_rng rng = starg_rng_make(23, round, 0);
        c->report.mode = STARG_DECOMPOSE_PAPER;
        for (size_t p = 0; p < 3; p++) {
            for (int k = 0; k < 3; k++)
                c->pieces[p].guard[k] = round % 2 ? 3 * starg_rng_unit(&rng)
                                                  : (double)starg_rng_below(&rng, 9) / 2 - 0.5;
            c->pieces[p].star = false;
        }
        c->report.strictly_star -= 3;
        for (size_t p = 0; p < 3; p++) { /* it may happen to be in the kernel, a box */
            const double *g = c->pieces[p].guard;
            static const double box[3][6] = {
                {0, 0, 0, 3, 3, 1}, {0, 0, 1, 3, 1, 2}, {0, 1, 1, 1, 2, 2}};
            c->pieces[p].star = g[0] > box[p][0] && g[1] > box[p][1] && g[2] > box[p][2] &&
                                g[0] < box[p][3] && g[1] < box[p][4] && g[2] < box[p][5];
            c->report.strictly_star += c->pieces[p].star;
        }
        c->report.visible_vertices = fraction_seen(c);
        partial += c->report.visible_vertices < 1;
        expect_pass(context, &model, c);
        c->report.visible_vertices += 1e-4;
        expect_failure(context, &model, c, "of their pieces' vertices", true);
        free(c);
    }
    assert_true(partial > 6);
    shape_free(&model);
    test_context_free(context);
}

/* An L of cells, each coned from its centre, seen from one end: more vertices than segments tested.
 * The outer parts of the arms are x >= SIDE and y >= SIDE. */
enum { SIDE = 14, CELLS = 5 * SIDE * SIDE * SIDE };

static bool in_bend(int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < 3 * SIDE && y < 3 * SIDE && z < SIDE &&
           (x < SIDE || y < SIDE);
}

/* Is a point of the bend visible from p at the end along x? Only the inner corner hides. */
static bool in_sight(const double p[3], const double q[3]) {
    double turn = (q[0] - p[0]) * (SIDE - p[1]) - (q[1] - p[1]) * (SIDE - p[0]);
    return q[1] <= SIDE || turn < 0;
}

typedef struct bend {
    size_t vertex_count, count, seen;
    double *vertices;
    uint32_t *tetrahedra;
    uint32_t *numbers; /* of the lattice's vertices, plus 1 */
} bend;

static uint32_t bend_vertex(bend *b, const double at[3], const double p[3]) {
    memcpy(b->vertices + 3 * b->vertex_count, at, 3 * sizeof *at);
    b->seen += in_sight(p, at);
    return (uint32_t)b->vertex_count++;
}

static uint32_t lattice_vertex(bend *b, const int at[3], const double p[3]) {
    enum { WIDTH = 3 * SIDE + 1 };
    uint32_t *number = &b->numbers[at[0] + WIDTH * (at[1] + WIDTH * at[2])];
    const double q[3] = {at[0], at[1], at[2]};
    if (*number == 0)
        *number = bend_vertex(b, q, p) + 1;
    return *number - 1;
}

static void add_cell(bend *b, const int cell[3], const double p[3]) {
    const double center[3] = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
    uint32_t middle = bend_vertex(b, center, p), corner[4];
    for (int side = 0; side < 6; side++) {
        int axis = side / 2;
        for (int i = 0; i < 4; i++) {
            int at[3] = {cell[0], cell[1], cell[2]};
            at[axis] += side % 2;
            at[(axis + 1) % 3] += i == 1 || i == 2;
            at[(axis + 2) % 3] += i >= 2;
            corner[i] = lattice_vertex(b, at, p);
        }
        for (int half = 1; half < 3; half++) {
            const uint32_t v[4] = {corner[0], corner[side % 2 ? half + 1 : half],
                                   corner[side % 2 ? half : half + 1], middle};
            memcpy(b->tetrahedra + 4 * b->count++, v, sizeof v);
        }
    }
}

static bend make_bend(const double p[3]) {
    bend b = {.vertices = malloc((size_t)CELLS * 9 * sizeof(double)),
              .tetrahedra = malloc((size_t)CELLS * 48 * sizeof(uint32_t)),
              .numbers =
                  calloc((size_t)(3 * SIDE + 1) * (3 * SIDE + 1) * (SIDE + 1), sizeof(uint32_t))};
    for (int i = 0; i < 9 * SIDE * SIDE * SIDE; i++) {
        const int cell[3] = {i % (3 * SIDE), i / (3 * SIDE) % (3 * SIDE), i / (9 * SIDE * SIDE)};
        if (in_bend(cell[0], cell[1], cell[2]))
            add_cell(&b, cell, p);
    }
    return b;
}

static void expect_seen(starg_context *context, const starg_tetmesh *model, const bend *b,
                        const double p[3], double claimed, bool holds) {
    starg_verdict *verdict = NULL;
    starg_piece piece = {
        .guard = {p[0], p[1], p[2]}, .radius = NAN, .tetrahedra = b->count, .volume = CELLS};
    int32_t *labels = calloc(b->count, sizeof *labels);
    const starg_pieces_mesh mesh = {.vertex_count = b->vertex_count,
                                    .count = b->count,
                                    .vertices = b->vertices,
                                    .tetrahedra = b->tetrahedra,
                                    .labels = labels};
    const starg_pieces_report report = {.mode = STARG_DECOMPOSE_PAPER,
                                        .tetrahedra = b->count,
                                        .piece_count = 1,
                                        .pieces = &piece,
                                        .visible_vertices = claimed};
    test_ok(context, starg_verify_pieces_of_tetmesh(context, model, &mesh, &report, &verdict));
    expect_consistent(verdict);
    for (size_t i = 0; i < verdict->count; i++)
        if (strstr(verdict->claims[i].text, "20000 of") != NULL)
            assert_int_equal(verdict->claims[i].holds, holds);
        else
            assert_true(verdict->claims[i].holds);
    assert_int_equal(verdict->passed, holds);
    starg_verdict_free(context, verdict);
    free(labels);
}

static void test_lines_drawn_at_random(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double p[3] = {2.9 * SIDE, 0.45 * SIDE, 0.3 * SIDE};
    bend b = make_bend(p);
    starg_tetmesh *model = NULL;
    double truth = (double)b.seen / (double)b.vertex_count;
    assert_true(b.vertex_count > 20000 && truth > 0.5 && truth < 0.9);
    test_ok(context, starg_tetmesh_create(context, b.vertices, b.vertex_count, b.tetrahedra,
                                          b.count, NULL, &model));
    expect_seen(context, model, &b, p, truth, true);
    expect_seen(context, model, &b, p, truth + 0.03, false);
    expect_seen(context, model, &b, p, truth - 0.03, false);
    expect_seen(context, model, &b, p, 1 + 1e-3, false);
    starg_tetmesh_free(model);
    free(b.vertices);
    free(b.tetrahedra);
    free(b.numbers);
    test_context_free(context);
}

/* ---- arrays, no report, no memory ---- */

static void test_bad_arrays(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_HALVES);
    starg_mesh *mesh = make_mesh(context, &model);
    cut *c = cut_new(&GRID_HALVES);
    starg_verdict *verdict;
    c->tetrahedra[7] = (uint32_t)c->mesh.vertex_count;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_ARGUMENT);
    c->tetrahedra[7] = 0;
    c->vertices[4] = INFINITY;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_RANGE);
    c->vertices[4] = 0;
    c->pieces[1].guard[2] = NAN;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_RANGE);
    c->mesh.count = 0;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_ARGUMENT);
    assert_null(verdict);
    starg_mesh_free(mesh);
    shape_free(&model);
    free(c);
    test_context_free(context);
}

static void test_without_report(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = grid_model(&GRID_RING);
    starg_mesh *mesh = make_mesh(context, &model);
    cut *c = cut_new(&GRID_RING);
    starg_verdict *verdict;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    expect_consistent(verdict);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    c->labels[0] = 9;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] = -2;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    starg_mesh_free(mesh);
    shape_free(&model);
    free(c);
    test_context_free(context);
}

/* Memory that runs out after a number of blocks. */
typedef struct purse {
    long left;
} purse;

static void *spend(void *user, size_t size) {
    purse *own = user;
    return own->left-- > 0 ? malloc(size) : NULL;
}

static void give_back(void *user, void *block) {
    (void)user;
    free(block);
}

/* Reads both files and verifies, in paper mode with visibility tests, or near the model. */
static starg_status read_and_verify(starg_context *context, const starg_mesh *mesh, cut_file vtk,
                                    cut_file json) {
    starg_pieces_mesh *pieces = NULL;
    starg_pieces_report *report = NULL;
    starg_verdict *verdict = NULL;
    starg_status status = starg_pieces_mesh_read_memory(context, vtk.bytes, vtk.size, "p", &pieces);
    if (status == STARG_OK)
        status = starg_pieces_report_read_memory(context, json.bytes, json.size, "r", &report);
    if (status == STARG_OK)
        status = starg_verify_pieces(context, mesh, pieces, report, &verdict);
    starg_pieces_mesh_free(context, pieces);
    starg_pieces_report_free(context, report);
    starg_verdict_free(context, verdict);
    return status;
}

static void test_out_of_memory(void **state) {
    (void)state;
    shape model = grid_model(&GRID_RING);
    cut *c = cut_new(&GRID_RING);
    purse own = {1000000};
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = 1;
    options.allocator = (starg_allocator){spend, give_back, &own};
    starg_context *context;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    starg_mesh *mesh = make_mesh(context, &model);
    size_t before = starg_context_live_blocks(context);
    c->report.mode = STARG_DECOMPOSE_PAPER;
    c->pieces[0].guard[1] = 1;
    for (int near = 0; near < 2; near++) {
        c->report.approximated = near;
        cut_file vtk = cut_write_vtk(&c->mesh, TEXT), json = cut_write_report(&c->report);
        starg_status status = STARG_ERROR_MEMORY;
        long blocks = 0;
        for (; status != STARG_OK; blocks++) {
            own.left = blocks;
            status = read_and_verify(context, mesh, vtk, json);
            assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
            assert_int_equal(starg_context_live_blocks(context), before);
        }
        assert_true(blocks > 30);
        own.left = 1000000;
        free(vtk.bytes);
        free(json.bytes);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(&model);
    free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_true_decompositions_pass),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_each_falsification_fails),
        cmocka_unit_test(test_guard_at_a_plane),
        cmocka_unit_test(test_subdivided),
        cmocka_unit_test(test_far_vertex),
        cmocka_unit_test(test_double_winding),
        cmocka_unit_test(test_one_shell_for_another),
        cmocka_unit_test(test_model_turned_inside_out),
        cmocka_unit_test(test_approximated),
        cmocka_unit_test(test_overlap_of_shells),
        cmocka_unit_test(test_tetmesh_model),
        cmocka_unit_test(test_visible_vertices),
        cmocka_unit_test(test_lines_drawn_at_random),
        cmocka_unit_test(test_bad_arrays),
        cmocka_unit_test(test_without_report),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
