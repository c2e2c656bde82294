/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier's check of reasons why something is hidden from a box: reasons of the box engine are
 * accepted; accepted ones among arbitrary reasons, most of them wrong, are tested at points of the
 * box, none of which may see the target. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "core/bits.h"
#include "models.h"
#include "starguard/visibility.h"
#include "verify/everywhere.h"
#include "visibility/box.h"

enum { POINTS = 12 };

typedef struct setting {
    starg_context *context;
    starg_mesh *mesh;
    starg_solid *solid;
    box_scene *boxes;
    box_worker *worker;
    verify_surface *surface;
    verify_tree *tree;
    verify_scene *scene; /* must not move: the watch points to it */
    verify_watch *watch;
    double range;
} setting;

static setting setting_of(starg_context *context, starg_mesh *mesh) {
    setting s = {.context = context, .mesh = mesh, .range = INFINITY};
    test_ok(context, starg_solid_create(context, mesh, &s.solid));
    test_ok(context, box_scene_create(context, s.solid, &s.boxes));
    test_ok(context, box_worker_create(s.boxes, &s.worker));
    test_ok(context, verify_surface_create(context, mesh, &s.surface));
    test_ok(context, verify_tree_create(s.surface, &s.tree));
    s.scene = calloc(1, sizeof *s.scene);
    assert_non_null(s.scene);
    test_ok(context, verify_scene_create(s.surface, s.tree, true, s.scene));
    test_ok(context, verify_watch_create(s.scene, &s.watch));
    assert_true(s.scene->embedded == starg_solid_check(s.solid)->embedded);
    return s;
}

static setting setting_of_shape(shape made) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_mesh_of(context, &made);
    shape_free(&made);
    return setting_of(context, mesh);
}

static void setting_free(setting *s) {
    verify_watch_free(s->watch);
    verify_scene_free(s->scene);
    free(s->scene);
    verify_tree_free(s->tree);
    verify_surface_free(s->surface);
    box_worker_free(s->worker);
    box_scene_free(s->boxes);
    starg_solid_free(s->solid);
    starg_mesh_free(s->mesh);
    test_context_free(s->context);
}

static size_t targets_of(const setting *s, starg_target kind) {
    return kind == STARG_TARGET_FACES ? starg_mesh_face_count(s->mesh)
                                      : starg_mesh_vertex_count(s->mesh);
}

static void begin_box(const setting *s, const bvh_box *box) {
    verify_box same;
    for (int k = 0; k < 3; k++) {
        same.lower[k] = box->lower[k];
        same.upper[k] = box->upper[k];
    }
    verify_watch_box(s->watch, &same);
}

/* ---- reasons of the engine ---- */

typedef struct agreement {
    size_t reasons, outside;
} agreement;

static void check_engine(const setting *s, starg_target kind, const bvh_box *box, agreement *sum) {
    size_t count = targets_of(s, kind);
    uint64_t *open = calloc(starg_bit_words(count), sizeof *open);
    box_reason *reasons = calloc(count, sizeof *reasons);
    assert_true(open != NULL && reasons != NULL);
    const box_question q = {.box = *box, .target = kind, .count = count, .range = s->range};
    box_look(s->worker, &q, open, reasons);
    begin_box(s, box);
    for (size_t j = 0; j < count; j++) {
        const box_reason *r = &reasons[j];
        const verify_reason same = {.vertex = r->vertex,
                                    .seed = r->seed,
                                    .kind = "??rnspfe"[r->kind],
                                    .clipped = r->clipped};
        if (r->kind == BOX_OUTSIDE && r->vertex == BOX_NONE) {
            assert_true(verify_box_outside(s->watch));
            sum->outside++;
        } else if (r->kind > BOX_OUTSIDE) {
            if (!verify_box_hides(s->watch, kind, (uint32_t)j, s->range, &same))
                fail_msg("box (%a, %a, %a) to (%a, %a, %a): reason %c%s, vertex %u, seed %u, of "
                         "target %zu is refused",
                         box->lower[0], box->lower[1], box->lower[2], box->upper[0], box->upper[1],
                         box->upper[2], same.kind, same.clipped ? " (clipped)" : "", same.vertex,
                         same.seed, j);
            sum->reasons++;
        }
    }
    free(open);
    free(reasons);
}

/* ---- arbitrary reasons ---- */

typedef struct tally {
    size_t tried, accepted[6], outside;
} tally;

static verify_reason random_reason(const setting *s, starg_target kind, uint32_t target,
                                   starg_rng *rng) {
    const uint32_t *corners = s->surface->faces + 3 * (size_t)target;
    return (verify_reason){
        .vertex = kind == STARG_TARGET_VERTICES ? target : corners[starg_rng_below(rng, 3)],
        .seed = (uint32_t)starg_rng_below(rng, s->surface->face_count),
        .kind = "nrspfe"[starg_rng_below(rng, 6)],
        .clipped = starg_rng_below(rng, 2) != 0};
}

/* A face that may meet the segment from the vertex to the centre of the box: random ones hardly
 * ever do. */
typedef struct pick {
    starg_rng *rng;
    uint32_t count, face;
} pick;

static bool pick_face(void *data, uint32_t face) {
    pick *own = data;
    if (starg_rng_below(own->rng, ++own->count) == 0)
        own->face = face;
    return true;
}

static void choose_seed(const setting *s, const bvh_box *box, starg_rng *rng,
                        verify_reason *reason) {
    double middle[3];
    pick own = {rng, 0, reason->seed};
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
    verify_tree_follow(s->tree, middle, s->surface->vertices + 3 * (size_t)reason->vertex,
                       pick_face, &own);
    reason->seed = own.face;
}

static void check_any(const setting *s, starg_target kind, const bvh_box *box, starg_rng *rng,
                      const double *points, const starg_bits *seen, tally *sum) {
    begin_box(s, box);
    bool outside = verify_box_outside(s->watch);
    sum->outside += outside;
    for (size_t j = 0; j < targets_of(s, kind); j++) {
        verify_reason reason = random_reason(s, kind, (uint32_t)j, rng);
        choose_seed(s, box, rng, &reason);
        sum->tried++;
        if (!outside && !verify_box_hides(s->watch, kind, (uint32_t)j, s->range, &reason))
            continue;
        sum->accepted[strchr("nrspfe", reason.kind) - "nrspfe"]++;
        for (size_t i = 0; i < seen->rows; i++)
            if (starg_bits_test(seen, i, j))
                fail_msg("box (%a, %a, %a) to (%a, %a, %a): (%a, %a, %a) sees target %zu, which "
                         "reason %c%s, vertex %u, seed %u, is taken to hide",
                         box->lower[0], box->lower[1], box->lower[2], box->upper[0], box->upper[1],
                         box->upper[2], points[3 * i], points[3 * i + 1], points[3 * i + 2], j,
                         reason.kind, reason.clipped ? " (clipped)" : "", reason.vertex,
                         reason.seed);
    }
}

/* ---- solids ---- */

/* Corners on the lattice of the solid's own corners, or halfway between. */
static bvh_box lattice_box(const setting *s, starg_rng *rng) {
    bvh_box box;
    double lower[3], upper[3];
    starg_mesh_bounds(s->mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        box.lower[k] = lower[k] + 0.5 * (double)starg_rng_below(rng, (uint64_t)(2 * upper[k]) + 1);
        box.upper[k] = box.lower[k] + 0.5 * (double)starg_rng_below(rng, 4);
    }
    return box;
}

static void check_setting(setting *s, const char *name, size_t boxes, bool lattice) {
    agreement said = {0};
    tally sum = {0};
    double points[3 * POINTS];
    for (size_t i = 0; i < boxes; i++) {
        starg_rng rng = starg_rng_make(17, 6, i);
        bvh_box box =
            lattice && i % 4 < 2 ? lattice_box(s, &rng) : box_about(s->solid, &rng, i / 4);
        starg_target kind = i % 2 == 0 ? STARG_TARGET_FACES : STARG_TARGET_VERTICES;
        starg_visibility_options view;
        starg_bits *seen = NULL;
        s->range = i % 16 >= 14 ? 1.5 : INFINITY;
        check_engine(s, kind, &box, &said);
        size_t count = box_points(s->solid, &box, &rng, POINTS, points);
        if (count == 0)
            continue;
        starg_visibility_options_default(&view);
        view.engine = STARG_VISIBILITY_BVH;
        view.target = kind;
        view.range = s->range;
        test_ok(s->context, starg_visibility(s->context, s->solid, points, count, &view, &seen));
        check_any(s, kind, &box, &rng, points, seen, &sum);
        starg_bits_free(seen);
    }
    print_message("%s: %zu reasons of the engine; of %zu others accepted", name, said.reasons,
                  sum.tried);
    for (int i = 0; i < 6; i++)
        print_message(" %c %zu", "nrspfe"[i], sum.accepted[i]);
    print_message("\n");
    assert_true(said.reasons > 0 && sum.tried > 0);
    setting_free(s);
}

static void test_lattices(void **state) {
    (void)state;
    size_t boxes = test_rounds(200, 8000);
    setting room = setting_of_shape(shape_room()), cavity = setting_of_shape(shape_cavity());
    setting columns = setting_of_shape(shape_columns());
    check_setting(&room, "room", boxes, true);
    check_setting(&cavity, "cavity", boxes, true);
    check_setting(&columns, "columns", boxes / 2, true);
}

static void test_curved(void **state) {
    (void)state;
    size_t boxes = test_rounds(50, 4000);
    setting blob = setting_of_shape(shape_blob(2, 5));
    check_setting(&blob, "blob", 2 * boxes, false);
    const char *const names[] = {"gallery", "horse", "octopus"};
    for (int i = 0; i < 3; i++) {
        starg_context *context = test_context(1);
        setting s = setting_of(context, test_sample_mesh(context, names[i], 500));
        check_setting(&s, names[i], boxes, false);
    }
}

/* Near the intersections, and where one shell lies within the other, the start of a segment or the
 * entry into a surface proves nothing. */
static void test_not_embedded(void **state) {
    (void)state;
    for (int i = 0; i < OVERLAPS; i++) {
        setting s = setting_of_shape(shape_overlap(i));
        assert_false(s.scene->embedded);
        check_setting(&s, "intersecting shells", test_rounds(50, 2000), false);
    }
}

/* The same solid, very large, very small, and far from the origin. */
static void test_scales(void **state) {
    (void)state;
    static const double scales[3] = {1e90, 1e-40, 1}, offsets[3] = {0, 0, 1e6};
    for (int i = 0; i < 3; i++) {
        shape made = shape_columns();
        shape_place(&made, scales[i], offsets[i]);
        setting s = setting_of_shape(made);
        check_setting(&s, "columns, scaled", test_rounds(20, 800), false);
    }
}

/* Shells that touch in a point, along an edge, or in a face. */
static void test_contacts(void **state) {
    (void)state;
    static const double offsets[4][3] = {{1, 1, 1}, {1, 1, 0}, {1, 0.5, 0.25}, {2, 0, 0}};
    for (int i = 0; i < 4; i++) {
        shape both = shape_cube(1), other = shape_cube(1);
        shape_append(&both, &other, offsets[i], 0);
        shape_free(&other);
        setting s = setting_of_shape(both);
        assert_true(s.scene->embedded == (i == 3));
        setting_free(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattices),     cmocka_unit_test(test_curved),
        cmocka_unit_test(test_not_embedded), cmocka_unit_test(test_scales),
        cmocka_unit_test(test_contacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
