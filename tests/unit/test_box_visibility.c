/* SPDX-License-Identifier: Apache-2.0 */
/* What is hidden from a box: definitions, reasons, and small solids on and off lattices, checked at
 * points of the boxes by rational arithmetic. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "core/bits.h"
#include "models.h"
#include "visibility/box.h"
#include "visibility/box_parts.h"
#include "visibility_oracle.h"

typedef struct setting {
    starg_context *context;
    starg_solid *solid;
    const starg_mesh *mesh;
    box_scene *scene;
    box_worker *worker;
} setting;

static setting setting_of(starg_solid *solid, starg_context *context) {
    setting s = {.context = context, .solid = solid, .mesh = starg_solid_mesh(solid)};
    test_ok(context, box_scene_create(context, solid, &s.scene));
    test_ok(context, box_worker_create(s.scene, &s.worker));
    return s;
}

static setting setting_of_shape(shape made) {
    starg_context *context = test_context(1);
    setting s = setting_of(test_solid_of(context, &made), context);
    shape_free(&made);
    return s;
}

static void setting_free(setting *s) {
    box_worker_free(s->worker);
    box_scene_free(s->scene);
    starg_solid_free(s->solid);
    test_context_free(s->context);
}

static box_question question(const setting *s, starg_target target, bvh_box box) {
    return (box_question){.box = box,
                          .target = target,
                          .count = target == STARG_TARGET_FACES ? starg_mesh_face_count(s->mesh)
                                                                : starg_mesh_vertex_count(s->mesh),
                          .range = INFINITY};
}

/* Bits and reasons of all targets; the caller frees them. */
typedef struct answer {
    size_t count;
    uint64_t *open;
    box_reason *reasons;
} answer;

static answer ask(const setting *s, const box_question *q) {
    answer a = {q->count, calloc(starg_bit_words(q->count) + 1, sizeof(uint64_t)),
                calloc(q->count + 1, sizeof(box_reason))};
    assert_true(a.open != NULL && a.reasons != NULL);
    box_look(s->worker, q, a.open, a.reasons);
    return a;
}

static void answer_free(answer *a) {
    free(a->open);
    free(a->reasons);
}

static size_t count_kind(const answer *a, box_reason_kind kind) {
    size_t count = 0;
    for (size_t i = 0; i < a->count; i++)
        count += a->reasons[i].kind == kind;
    return count;
}

/* ---- definitions ---- */

static void test_all_is_open_in_a_cube(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_cube(2));
    for (int target = 0; target < 2; target++) {
        box_question q =
            question(&s, (starg_target)target, (bvh_box){{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}});
        answer a = ask(&s, &q);
        assert_int_equal(count_kind(&a, BOX_OPEN), a.count);
        answer_free(&a);
    }
    setting_free(&s);
}

static void test_outside_sees_nothing(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_room());
    /* in the corner outside the L; far away */
    const bvh_box boxes[] = {{{1.5, 1.5, 0.25}, {3.5, 3.5, 0.75}}, {{9, 9, 9}, {10, 10, 10}}};
    for (int i = 0; i < 2; i++) {
        box_question q = question(&s, STARG_TARGET_FACES, boxes[i]);
        answer a = ask(&s, &q);
        assert_int_equal(count_kind(&a, BOX_OUTSIDE), a.count);
        answer_free(&a);
    }
    setting_free(&s);
}

/* From the end of one arm of the L the end of the other is hidden by the corner between them. */
static void test_round_the_corner(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_room());
    const double *v = starg_mesh_vertices(s.mesh);
    box_question q =
        question(&s, STARG_TARGET_VERTICES, (bvh_box){{3, 0.25, 0.25}, {3.75, 0.75, 0.75}});
    answer a = ask(&s, &q);
    size_t far = 0;
    for (size_t i = 0; i < a.count; i++)
        if (v[3 * i] == 1 && v[3 * i + 1] >= 2) {
            assert_int_not_equal(a.reasons[i].kind, BOX_OPEN);
            far++;
        }
    assert_true(far > 3);
    assert_true(count_kind(&a, BOX_OPEN) > 10);
    answer_free(&a);
    setting_free(&s);
}

static void test_range(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_cube(3));
    const double *v = starg_mesh_vertices(s.mesh);
    box_question q = question(&s, STARG_TARGET_VERTICES, (bvh_box){{1, 1, 1}, {2, 2, 2}});
    q.range = sqrt(2);
    answer a = ask(&s, &q);
    for (size_t i = 0; i < a.count; i++) {
        bool corner = true;
        for (size_t k = 0; k < 3; k++)
            corner = corner && (v[3 * i + k] == 0 || v[3 * i + k] == 3);
        assert_int_equal(a.reasons[i].kind, corner ? BOX_FAR : BOX_OPEN);
    }
    answer_free(&a);
    setting_free(&s);
}

static void test_every_reason_occurs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    setting s = setting_of(test_sample(context, "horse", 500), context);
    size_t kinds[BOX_KINDS] = {0};
    for (size_t i = 0; i < 200; i++) {
        starg_rng rng = starg_rng_make(3, 1, i);
        box_question q = question(&s, STARG_TARGET_FACES, box_about(s.solid, &rng, i % 2 ? 0 : 2));
        answer a = ask(&s, &q);
        for (size_t j = 0; j < a.count; j++) {
            const box_reason *r = &a.reasons[j];
            kinds[r->kind]++;
            assert_int_equal(r->kind != BOX_OPEN, !starg_bit_test(a.open, j));
            assert_true(r->seed == BOX_NONE ? r->kind != BOX_PATCH
                                            : r->kind == BOX_PATCH || r->kind == BOX_FOLD);
        }
        answer_free(&a);
    }
    for (int kind = 0; kind < BOX_KINDS; kind++)
        if (kind != BOX_FAR && kind != BOX_OUTSIDE)
            assert_true(kinds[kind] > 0);
    setting_free(&s);
}

static void test_among_and_known(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_columns());
    box_question q = question(&s, STARG_TARGET_FACES, (bvh_box){{0, 0, 0}, {1, 2, 1}});
    answer around = ask(&s, &q);
    q.box.upper[1] = 1;
    answer alone = ask(&s, &q);
    q.among = around.open;
    answer among = ask(&s, &q);
    size_t fewer = 0;
    for (size_t i = 0; i < q.count; i++) {
        assert_int_equal(starg_bit_test(among.open, i),
                         starg_bit_test(around.open, i) && starg_bit_test(alone.open, i));
        fewer += !starg_bit_test(among.open, i);
    }
    assert_true(fewer > 0);
    q.known = around.open;
    answer known = ask(&s, &q);
    assert_memory_equal(known.open, around.open, starg_bit_words(q.count) * sizeof(uint64_t));
    answer_free(&around);
    answer_free(&alone);
    answer_free(&among);
    answer_free(&known);
    setting_free(&s);
}

/* Earlier queries of a worker, and whether reasons are wanted, make no difference. */
static void test_no_memory_of_earlier_boxes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    setting s = setting_of(test_sample(context, "horse", 600), context);
    for (size_t i = 0; i < 60; i++) {
        starg_rng rng = starg_rng_make(5, 2, i);
        box_question q = question(&s, (starg_target)(i % 2), box_about(s.solid, &rng, i));
        answer a = ask(&s, &q), b = ask(&s, &q);
        box_look(s.worker, &q, b.open, NULL);
        assert_memory_equal(a.open, b.open, starg_bit_words(q.count) * sizeof(uint64_t));
        box_worker *fresh = NULL;
        test_ok(context, box_worker_create(s.scene, &fresh));
        box_look(fresh, &q, b.open, b.reasons);
        assert_memory_equal(a.open, b.open, starg_bit_words(q.count) * sizeof(uint64_t));
        for (size_t j = 0; j < q.count; j++)
            assert_true(a.reasons[j].kind == b.reasons[j].kind &&
                        a.reasons[j].seed == b.reasons[j].seed);
        box_worker_free(fresh);
        answer_free(&a);
        answer_free(&b);
    }
    setting_free(&s);
}

/* ---- shafts ---- */

/* Does the ray from v through x contain a point of the box at or behind x? All coordinates are
 * small multiples of 1/16, so only the bounds of the parameter could be rounded; those are compared
 * as fractions. */
static bool in_shaft(const double v[3], const bvh_box *box, const double x[3]) {
    double low_n = 1, low_d = 1, high_n = 1, high_d = 0; /* 1 to infinity */
    for (int k = 0; k < 3; k++) {
        double d = x[k] - v[k], low = box->lower[k] - v[k], high = box->upper[k] - v[k];
        if (d == 0) {
            if (low > 0 || high < 0)
                return false;
            continue;
        }
        double near = d > 0 ? low : -high, far = d > 0 ? high : -low, size = fabs(d);
        if (near * low_d > low_n * size) {
            low_n = near;
            low_d = size;
        }
        if (far * high_d < high_n * size) {
            high_n = far;
            high_d = size;
        }
    }
    return low_n * high_d <= high_n * low_d;
}

static void random_place(starg_rng *rng, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = (double)starg_rng_below(rng, 7);
}

static void test_segments_in_shafts_meet_them(void **state) {
    (void)state;
    size_t meeting = 0, missing = 0, told = 0;
    for (uint64_t i = 0; i < 300000; i++) {
        starg_rng rng = starg_rng_make(7, 3, i);
        double v[3], a[3], b[3], c[3], d[3];
        box_shaft shaft;
        bvh_box box;
        random_place(&rng, v);
        random_place(&rng, a);
        random_place(&rng, b);
        random_place(&rng, c);
        random_place(&rng, d);
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            box.lower[k] = fmin(c[k], d[k]);
            box.upper[k] = fmax(c[k], d[k]);
            inside = inside && v[k] >= box.lower[k] && v[k] <= box.upper[k];
        }
        if (inside)
            continue;
        shaft_make(&shaft, v, 0, &box);
        bool meets = false;
        for (int j = 0; j <= 16 && !meets; j++) {
            double x[3];
            for (int k = 0; k < 3; k++)
                x[k] = a[k] + (b[k] - a[k]) * j / 16;
            meets = in_shaft(v, &box, x);
        }
        bool may = shaft_may_meet(&shaft, a, shaft_code(&shaft, a), b, shaft_code(&shaft, b));
        if (meets && !may)
            fail_msg("case %zu: the segment meets the shaft", (size_t)i);
        meeting += meets;
        missing += !meets;
        told += !may;
    }
    print_message("%zu segments meet, %zu miss, of which %zu are told\n", meeting, missing, told);
    assert_true(meeting > 10000 && told > missing / 2);
}

/* ---- against points of the box ---- */

typedef struct tally {
    size_t pairs, hidden, unseen;
} tally;

/* No point of the box may see what is hidden from it. */
static void check_box(const setting *s, const char *name, starg_target target, const bvh_box *box,
                      const double *points, size_t count, tally *sum) {
    const double *v = starg_mesh_vertices(s->mesh);
    const uint32_t *f = starg_mesh_faces(s->mesh);
    size_t n = starg_mesh_vertex_count(s->mesh), m = starg_mesh_face_count(s->mesh);
    box_question q = question(s, target, *box);
    answer a = ask(s, &q);
    bool *seen = calloc(n + m, sizeof *seen), *once = calloc(n + m, sizeof *once);
    assert_true(seen != NULL && once != NULL);
    for (size_t i = 0; i < count; i++) {
        const double *p = points + 3 * i;
        if (target == STARG_TARGET_FACES)
            visibility_oracle_faces(v, n, f, m, p, false, seen);
        else
            visibility_oracle_vertices(v, n, f, m, p, seen);
        for (size_t j = 0; j < q.count; j++) {
            once[j] = once[j] || seen[j];
            if (seen[j] && !starg_bit_test(a.open, j))
                fail_msg("%s, box (%a, %a, %a) to (%a, %a, %a): (%a, %a, %a) sees %s %zu, which "
                         "is hidden for reason %d",
                         name, box->lower[0], box->lower[1], box->lower[2], box->upper[0],
                         box->upper[1], box->upper[2], p[0], p[1], p[2],
                         target == STARG_TARGET_FACES ? "face" : "vertex", j,
                         (int)a.reasons[j].kind);
        }
    }
    sum->pairs += q.count;
    for (size_t j = 0; j < q.count; j++) {
        sum->hidden += !starg_bit_test(a.open, j);
        sum->unseen += !once[j];
    }
    free(seen);
    free(once);
    answer_free(&a);
}

static void tell(const char *name, const tally *sum) {
    print_message("%s: %zu pairs, %.1f %% of those that no point sees are told to be hidden\n",
                  name, sum->pairs, 100 * (double)sum->hidden / (double)sum->unseen);
}

static void check_solid(setting *s, const char *name, size_t boxes) {
    tally sum = {0};
    double points[3 * 12];
    for (size_t i = 0; i < boxes; i++) {
        starg_rng rng = starg_rng_make(11, 4, i);
        bvh_box box = box_about(s->solid, &rng, i / 2);
        size_t count = box_points(s->solid, &box, &rng, 12, points);
        check_box(s, name, (starg_target)(i % 2), &box, points, count, &sum);
    }
    tell(name, &sum);
    assert_true(sum.hidden > 0);
    setting_free(s);
}

/* Boxes whose corners are lattice points or halves of them, and points of the same kind. */
static void check_lattice(setting *s, const char *name, size_t boxes) {
    double lower[3], upper[3], points[3 * 12];
    tally sum = {0};
    starg_mesh_bounds(s->mesh, lower, upper);
    for (size_t i = 0; i < boxes; i++) {
        starg_rng rng = starg_rng_make(13, 5, i);
        bvh_box box;
        for (int k = 0; k < 3; k++) {
            double a = 0.5 * (double)starg_rng_below(&rng, (uint64_t)(2 * upper[k]) + 1);
            double b = 0.5 * (double)starg_rng_below(&rng, 4);
            box.lower[k] = a;
            box.upper[k] = a + b;
        }
        size_t count = 0;
        for (int attempt = 0; attempt < 100 && count < 12; attempt++) {
            double *p = points + 3 * count;
            for (int k = 0; k < 3; k++)
                p[k] = box.lower[k] +
                       (box.upper[k] - box.lower[k]) * (double)starg_rng_below(&rng, 9) / 8;
            count += starg_solid_contains(s->solid, p);
        }
        check_box(s, name, (starg_target)(i % 2), &box, points, count, &sum);
    }
    tell(name, &sum);
    setting_free(s);
}

static void test_lattices(void **state) {
    (void)state;
    size_t boxes = test_rounds(30, 3000);
    setting room = setting_of_shape(shape_room()), cavity = setting_of_shape(shape_cavity());
    setting columns = setting_of_shape(shape_columns());
    check_lattice(&room, "room", boxes);
    check_lattice(&cavity, "cavity", boxes);
    check_lattice(&columns, "columns", boxes / 3);
}

static void test_small_solids(void **state) {
    (void)state;
    size_t boxes = test_rounds(25, 4000);
    setting room = setting_of_shape(shape_room()), cavity = setting_of_shape(shape_cavity());
    setting columns = setting_of_shape(shape_columns());
    check_solid(&room, "room", boxes);
    check_solid(&cavity, "cavity", boxes);
    check_solid(&columns, "columns", boxes / 2);
    starg_context *context = test_context(1);
    setting blob = setting_of_shape(shape_blob(2, 5));
    check_solid(&blob, "blob", boxes);
    setting gallery = setting_of(test_sample(context, "gallery", 500), context);
    check_solid(&gallery, "gallery", boxes / 8);
}

/* How often each reason is given in random boxes. */
static void count_kinds(const setting *s, size_t boxes, size_t kinds[BOX_KINDS]) {
    for (size_t i = 0; i < boxes; i++) {
        starg_rng rng = starg_rng_make(17, 6, i);
        box_question q = question(s, STARG_TARGET_FACES, box_about(s->solid, &rng, i));
        answer a = ask(s, &q);
        for (int kind = 0; kind < BOX_KINDS; kind++)
            kinds[kind] += count_kind(&a, (box_reason_kind)kind);
        answer_free(&a);
    }
}

/* Overlapping shells, of which parts lie within the other one: only away from these and from the
 * intersections the start of a segment or the entry into a surface proves something. */
static void test_intersecting_shells(void **state) {
    (void)state;
    size_t kinds[BOX_KINDS] = {0}, boxes = test_rounds(20, 2000);
    for (int i = 0; i < OVERLAPS; i++) {
        setting s = setting_of_shape(shape_overlap(i));
        assert_false(starg_solid_check(s.solid)->embedded);
        count_kinds(&s, boxes, kinds);
        check_solid(&s, "intersecting shells", boxes);
    }
    assert_true(kinds[BOX_START] > 0 && kinds[BOX_FOLD] > 0 && kinds[BOX_ENTRY] > 0);
}

/* Of two cubes that overlap at a corner. */
static void test_sound_faces(void **state) {
    (void)state;
    shape both = shape_cube(2), other = shape_cube(2);
    shape_append(&both, &other, (const double[3]){1, 1, 1}, 0);
    shape_free(&other);
    setting s = setting_of_shape(both);
    const double *v = starg_mesh_vertices(s.mesh);
    /* only faces of the three sides at the far corners, away from the other cube, are sound */
    size_t sound = 0;
    for (size_t rank = 0; rank < s.scene->face_count; rank++) {
        const box_triangle *t = &s.scene->triangles[rank];
        double least = INFINITY, most = 0;
        for (int i = 0; i < 3; i++)
            for (size_t k = 0; k < 3; k++) {
                least = fmin(least, v[3 * (size_t)t->corner[i] + k]);
                most = fmax(most, v[3 * (size_t)t->corner[i] + k]);
            }
        if (s.scene->sound[rank])
            assert_true(least == 0 || most == 3); /* not inside the other cube */
        sound += s.scene->sound[rank] != 0;
    }
    assert_true(sound > 10 && sound < s.scene->face_count);
    setting_free(&s);
}

/* The same solid, very large, very small, and far from the origin. */
static void test_scales(void **state) {
    (void)state;
    static const double scales[3] = {1e90, 1e-40, 1}, offsets[3] = {0, 0, 1e6};
    for (int i = 0; i < 3; i++) {
        shape made = shape_columns();
        shape_place(&made, scales[i], offsets[i]);
        setting s = setting_of_shape(made);
        check_solid(&s, "columns, scaled", test_rounds(6, 500));
    }
}

/* ---- trimming ---- */

/* Cuts follow from the box, each part that goes is outside, and all points inside stay. */
static void check_trimmed(const setting *s, const bvh_box *box, starg_rng *rng, double *cut_off) {
    bvh_box left = *box, rest = *box;
    box_cut cuts[BOX_CUTS];
    double points[60 * 3], share = 1;
    int count = box_trim(s->worker, &left, cuts);
    assert_in_range(count, 0, BOX_CUTS);
    for (int i = 0; i < count; i++) {
        int k = cuts[i].axis;
        double *end = cuts[i].above ? &rest.upper[k] : &rest.lower[k];
        assert_true(cuts[i].at > rest.lower[k] && cuts[i].at < rest.upper[k]);
        *end = cuts[i].at;
    }
    assert_memory_equal(&rest, &left, sizeof left);
    size_t inside = box_points(s->solid, box, rng, 60, points);
    for (size_t i = 0; i < inside; i++)
        for (int k = 0; k < 3; k++)
            assert_true(points[3 * i + k] >= left.lower[k] && points[3 * i + k] <= left.upper[k]);
    for (int k = 0; k < 3 && count > 0; k++)
        if (left.upper[k] < box->upper[k] || left.lower[k] > box->lower[k])
            share *= (left.upper[k] - left.lower[k]) / (box->upper[k] - box->lower[k]);
    *cut_off += 1 - share;
}

static void test_trim(void **state) {
    (void)state;
    setting settings[] = {setting_of_shape(shape_room()), setting_of_shape(shape_cavity()),
                          setting_of_shape(shape_columns()), setting_of_shape(shape_blob(2, 5))};
    double cut_off = 0;
    size_t rounds = test_rounds(200, 20000);
    for (size_t i = 0; i < 4; i++) {
        for (size_t item = 0; item < rounds; item++) {
            starg_rng rng = starg_rng_make(41, i, item);
            bvh_box box = box_about(settings[i].solid, &rng, item);
            check_trimmed(&settings[i], &box, &rng, &cut_off);
        }
        setting_free(&settings[i]);
    }
    print_message("%.1f %% of the boxes were cut off\n", 100 * cut_off / (double)(4 * rounds));
    assert_true(cut_off > 0.02 * (double)(4 * rounds));
}

/* Of a box with a thin slice of a cube at one side the slice stays. */
static void test_trim_slice(void **state) {
    (void)state;
    setting s = setting_of_shape(shape_cube(2));
    bvh_box box = {{1.9375, 0.25, 0.25}, {3.9375, 0.75, 0.75}};
    box_cut cuts[BOX_CUTS];
    assert_int_equal(box_trim(s.worker, &box, cuts), 1);
    assert_true(cuts[0].axis == 0 && cuts[0].above && cuts[0].at == box.upper[0]);
    assert_true(box.upper[0] > 2 && box.upper[0] < 2.25);
    setting_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_is_open_in_a_cube),
        cmocka_unit_test(test_outside_sees_nothing),
        cmocka_unit_test(test_round_the_corner),
        cmocka_unit_test(test_range),
        cmocka_unit_test(test_every_reason_occurs),
        cmocka_unit_test(test_among_and_known),
        cmocka_unit_test(test_no_memory_of_earlier_boxes),
        cmocka_unit_test(test_segments_in_shafts_meet_them),
        cmocka_unit_test(test_lattices),
        cmocka_unit_test(test_small_solids),
        cmocka_unit_test(test_intersecting_shells),
        cmocka_unit_test(test_sound_faces),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_trim),
        cmocka_unit_test(test_trim_slice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
