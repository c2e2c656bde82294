/* SPDX-License-Identifier: Apache-2.0 */
/* Distances between shapes by their guards: invariances, bounds, and graphs of every size. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/descriptor.h"
#include "starguard/simplify.h"

/* The layouts of docs/formats.md. */
enum {
    STAR_SPECTRUM = 40,
    STAR_VIEWS = 128,
    STAR_WKS = 192,
    STAR = 360,
    PAPER_HEAD = 2,
    PAPER_GUARD = 68
};

static starg_signature *signature_of(starg_context *context, const starg_mesh *mesh,
                                     starg_signature_kind kind) {
    starg_signature *s = NULL;
    test_ok(context, starg_signature_create(context, mesh, kind, &s));
    return s;
}

static double distance(starg_context *context, const starg_signature *a, const starg_signature *b) {
    double there, back;
    test_ok(context, starg_signature_distance(context, a, b, &there));
    test_ok(context, starg_signature_distance(context, b, a, &back));
    assert_true(there == back && there >= 0 && isfinite(there));
    return there;
}

/* ---- star ---- */

/* From the definition in docs/retrieval.md. */
static double star_by_definition(const starg_signature *a, const starg_signature *b) {
    double sum = 0;
    for (int i = 0; i < STAR; i++) {
        double difference = fabs(a->numbers[i] - b->numbers[i]);
        if (i < STAR_SPECTRUM)
            sum += difference / (i + 1) / (0.078 * STAR_SPECTRUM);
        else if (i < STAR_SPECTRUM + STAR_VIEWS)
            sum += difference / (0.041 * STAR_VIEWS);
        else
            sum += difference / (0.18 * STAR_WKS);
    }
    return sum / 3;
}

/* The same figure in another pose is closer than a figure of another kind. */
/* Models of two tests, in their first pose, and their signatures: made once. */
enum { CLASSES = 3 };
static const char *const names[CLASSES] = {"human", "giraffe", "bird"};
static starg_context *context_of_originals;
static starg_mesh *meshes[CLASSES];
static starg_signature *originals[CLASSES];

static void need_originals(void) {
    if (context_of_originals != NULL)
        return;
    context_of_originals = test_context(2);
    for (size_t i = 0; i < CLASSES; i++) {
        meshes[i] = test_pose(context_of_originals, names[i], 0, 2000);
        originals[i] = signature_of(context_of_originals, meshes[i], STARG_SIGNATURE_STAR);
    }
}

static int free_originals(void **state) {
    (void)state;
    if (context_of_originals == NULL)
        return 0;
    for (size_t i = 0; i < CLASSES; i++) {
        starg_signature_free(context_of_originals, originals[i]);
        starg_mesh_free(meshes[i]);
    }
    test_context_free(context_of_originals);
    return 0;
}

static void poses_are_nearer_than_classes(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_signature *s[6];
    need_originals();
    for (size_t i = 0; i < CLASSES; i++) {
        starg_mesh *mesh = test_pose(context, names[i], 1, 2000);
        s[2 * i] = originals[i];
        s[2 * i + 1] = signature_of(context, mesh, STARG_SIGNATURE_STAR);
        starg_mesh_free(mesh);
    }
    for (size_t i = 0; i < 6; i++) {
        double own = distance(context, s[i], s[i ^ 1]);
        assert_int_equal(s[i]->count, STAR);
        assert_true(distance(context, s[i], s[i]) == 0);
        for (size_t j = 0; j < 6; j++) {
            double other = distance(context, s[i], s[j]);
            assert_true(fabs(other - star_by_definition(s[i], s[j])) < 1e-12);
            if (j / 2 != i / 2)
                assert_true(other > own);
        }
    }
    for (size_t i = 0; i < CLASSES; i++)
        starg_signature_free(context, s[2 * i + 1]);
    test_context_free(context);
}

/* ---- copies ---- */

/* Moves every coordinate at random by up to half a percent of the diagonal. */
static starg_mesh *shaken(starg_context *context, const starg_mesh *mesh) {
    double lower[3], upper[3], diagonal = 0;
    starg_rng rng = starg_rng_make(16, 0, 0);
    starg_mesh *out = NULL;
    size_t count = 3 * starg_mesh_vertex_count(mesh);
    double *moved = malloc(count * sizeof *moved);
    assert_non_null(moved);
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        diagonal += pow(upper[k] - lower[k], 2);
    for (size_t i = 0; i < count; i++)
        moved[i] =
            starg_mesh_vertices(mesh)[i] + 0.01 * sqrt(diagonal) * (starg_rng_unit(&rng) - 0.5);
    test_ok(context, starg_mesh_create(context, moved, count / 3, starg_mesh_faces(mesh),
                                       starg_mesh_face_count(mesh), &out));
    free(moved);
    return out;
}

/* Noise and resolution matter less than the figure. */
static void copies_find_their_original(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    need_originals();
    for (size_t i = 0; i < 3; i++) {
        starg_mesh *copy = NULL;
        if (i < 2)
            copy = shaken(context, meshes[i]);
        else
            test_ok(context, starg_mesh_simplify(context, meshes[i], 1000, NULL, NULL, &copy));
        starg_signature *s = signature_of(context, copy, STARG_SIGNATURE_STAR);
        double own = distance(context, s, originals[i]);
        for (size_t k = 0; k < 3; k++)
            assert_true(k == i || distance(context, s, originals[k]) > 2 * own);
        starg_signature_free(context, s);
        starg_mesh_free(copy);
    }
    test_context_free(context);
}

/* ---- transformed descriptors ---- */

/* Rotated about an axis of the sphere's directions, translated, scaled, with guards reordered. A
 * rotated descriptor has other directions: distances are those of the nearest. */
static starg_descriptor disguise(const starg_descriptor *d, double angle, double scale) {
    starg_descriptor out = *d;
    size_t n = d->guard_count, width = d->direction_count;
    double c = cos(angle), s = sin(angle);
    out.diagonal *= scale;
    out.guards = calloc(n, sizeof *out.guards);
    out.edges = calloc(d->edge_count + 1, sizeof *out.edges);
    out.distances = calloc(n * width, sizeof *out.distances);
    assert_true(out.guards != NULL && out.edges != NULL && out.distances != NULL);
    for (size_t i = 0; i < STAR_VIEWS; i++)
        (&out.views[0][0])[i] *= scale;
    for (size_t i = 0; i < n; i++) {
        const double *p = d->guards[n - 1 - i].position;
        out.guards[i].position[0] = scale * (c * p[0] - s * p[1] + 3);
        out.guards[i].position[1] = scale * (s * p[0] + c * p[1] - 4);
        out.guards[i].position[2] = scale * (p[2] + 5);
        out.guards[i].volume = scale * scale * scale * d->guards[n - 1 - i].volume;
    }
    for (size_t k = 0; k < width; k++) {
        double u[3], v[3], best = -2;
        size_t nearest = 0;
        starg_descriptor_direction(width, k, u);
        for (size_t m = 0; m < width; m++) {
            starg_descriptor_direction(width, m, v);
            double cosine =
                u[0] * (c * v[0] - s * v[1]) + u[1] * (s * v[0] + c * v[1]) + u[2] * v[2];
            if (cosine > best) {
                best = cosine;
                nearest = m;
            }
        }
        for (size_t i = 0; i < n; i++)
            out.distances[i * width + k] = scale * d->distances[(n - 1 - i) * width + nearest];
    }
    for (size_t e = 0; e < d->edge_count; e++) {
        out.edges[e] = d->edges[e];
        out.edges[e].first = (uint32_t)n - 1 - d->edges[e].second;
        out.edges[e].second = (uint32_t)n - 1 - d->edges[e].first;
    }
    return out;
}

static void motions_hardly_count(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const starg_signature_kind kinds[] = {STARG_SIGNATURE_STAR, STARG_SIGNATURE_PAPER};
    starg_mesh *mesh = test_pose(context, "horse", 0, 2000),
               *other = test_pose(context, "human", 0, 2000);
    starg_descriptor *d = NULL, *unlike = NULL;
    test_ok(context, starg_descriptor_create(context, mesh, NULL, &d));
    test_ok(context, starg_descriptor_create(context, other, NULL, &unlike));
    const double scales[] = {1, 1e-30, 1e30};
    for (size_t i = 0; i < 6; i++) {
        starg_descriptor moved = disguise(d, 0.9 * (double)i, scales[i % 3]);
        for (size_t k = 0; k < 2; k++) {
            starg_signature *s[3] = {NULL};
            test_ok(context, starg_signature_of_descriptor(context, d, kinds[k], &s[0]));
            test_ok(context, starg_signature_of_descriptor(context, &moved, kinds[k], &s[1]));
            test_ok(context, starg_signature_of_descriptor(context, unlike, kinds[k], &s[2]));
            double far = distance(context, s[0], s[2]), near = distance(context, s[0], s[1]);
            if (i == 0) /* not rotated: up to rounding */
                assert_true(near < 1e-9);
            assert_true(2 * near < far);
            for (size_t j = 0; j < 3; j++)
                starg_signature_free(context, s[j]);
        }
        free(moved.guards);
        free(moved.edges);
        free(moved.distances);
    }
    starg_descriptor_free(context, d);
    starg_descriptor_free(context, unlike);
    starg_mesh_free(mesh);
    starg_mesh_free(other);
    test_context_free(context);
}

/* A file may hold any finite numbers: what cannot be compared is rejected. */
static void absurd_descriptors(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double sizes[] = {0, 1e-320, 1e-200, 1, 1e99, 3e100};
    for (size_t round = 0; round < 216; round++) {
        double distances[24];
        starg_descriptor_guard guards[2] = {{{0, 0, 0}, sizes[round % 6]},
                                            {{1e99, 0, -1e99}, sizes[round / 6 % 6]}};
        for (size_t i = 0; i < 24; i++)
            distances[i] = sizes[(round / 36 + i * (round % 7)) % 6];
        starg_descriptor d = {.views = {{sizes[round % 5], sizes[round % 6]}},
                              .surface_spectrum = {sizes[round / 2 % 6], sizes[round / 3 % 6]},
                              .diagonal = sizes[(round + round / 6) % 6],
                              .guard_count = 2,
                              .guards = guards,
                              .direction_count = 12,
                              .distances = distances};
        for (int k = STARG_SIGNATURE_STAR; k <= STARG_SIGNATURE_PAPER; k++) {
            starg_signature *s = NULL;
            starg_status status =
                starg_signature_of_descriptor(context, &d, (starg_signature_kind)k, &s);
            assert_true(status == STARG_OK || status == STARG_ERROR_FORMAT);
            assert_int_equal(status == STARG_OK, s != NULL);
            if (s != NULL)
                assert_true(distance(context, s, s) == 0);
            starg_signature_free(context, s);
        }
    }
    test_context_free(context);
}

/* ---- the paper's distance of synthetic graphs ---- */

typedef struct made_up {
    size_t guards, edges;
    double *numbers;
} made_up;

/* Guards at the first three coordinates without histograms; fills in valences and edges. */
static made_up make_graph(size_t guards, size_t edges) {
    made_up g = {.guards = guards, .edges = edges};
    g.numbers = calloc(PAPER_HEAD + PAPER_GUARD * guards + 2 * edges, sizeof *g.numbers);
    assert_non_null(g.numbers);
    g.numbers[0] = (double)guards;
    g.numbers[1] = (double)edges;
    return g;
}

static double *guard_of(const made_up *g, size_t i) {
    return g->numbers + PAPER_HEAD + PAPER_GUARD * i;
}

static void join(const made_up *g, size_t edge, size_t a, size_t b) {
    double *ends = g->numbers + PAPER_HEAD + PAPER_GUARD * g->guards + 2 * edge;
    ends[0] = (double)a;
    ends[1] = (double)b;
    guard_of(g, a)[3] += 0.1;
    guard_of(g, b)[3] += 0.1;
}

/* Numbers as a signature of the present version. */
static starg_status restore(starg_context *context, starg_signature_kind kind,
                            const double *numbers, size_t count, starg_signature **out) {
    return starg_signature_restore(context, kind, starg_signature_version(kind), numbers, count,
                                   out);
}

static starg_signature *paper_of(starg_context *context, const made_up *g) {
    starg_signature *s = NULL;
    test_ok(context, restore(context, STARG_SIGNATURE_PAPER, g->numbers,
                             PAPER_HEAD + PAPER_GUARD * g->guards + 2 * g->edges, &s));
    return s;
}

static double paper_distance(starg_context *context, const made_up *a, const made_up *b) {
    starg_signature *s = paper_of(context, a), *t = paper_of(context, b);
    assert_true(distance(context, s, s) == 0);
    double d = distance(context, s, t);
    starg_signature_free(context, s);
    starg_signature_free(context, t);
    return d;
}

/* 0.1 times the mean squared distance to the nearest: the energy without deformation. */
static double energy_at_rest(const made_up *a, const made_up *b) {
    const made_up *both[2] = {a, b};
    double sum = 0;
    for (size_t way = 0; way < 2; way++)
        for (size_t i = 0; i < both[way]->guards; i++) {
            double least = INFINITY;
            for (size_t j = 0; j < both[1 - way]->guards; j++) {
                double squares = 0;
                for (int k = 0; k < 4; k++)
                    squares += pow(guard_of(both[way], i)[k] - guard_of(both[1 - way], j)[k], 2);
                least = fmin(least, squares);
            }
            sum += 0.5 * 0.1 * least / (double)both[way]->guards;
        }
    return sum;
}

/* A tree with some more edges, or only its first `joined` guards in one component. */
static made_up random_graph(starg_rng *rng, size_t guards, size_t joined) {
    size_t edges = joined > 0 ? joined - 1 : 0;
    made_up g = make_graph(guards, edges);
    for (size_t i = 0; i < guards; i++)
        for (int k = 0; k < 3; k++)
            guard_of(&g, i)[k] = 2 * starg_rng_unit(rng) - 1;
    for (size_t i = 1; i <= edges; i++)
        join(&g, i - 1, starg_rng_below(rng, i), i);
    return g;
}

static void deforming_never_costs_more_than_resting(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const size_t sizes[] = {1, 2, 3, 10, 60, 200};
    for (uint64_t round = 0; round < 36; round++) {
        starg_rng rng = starg_rng_make(11, 0, round);
        size_t n = sizes[round % 6], m = sizes[round / 6];
        made_up a = random_graph(&rng, n, round % 2 == 0 ? n : n / 2);
        made_up b = random_graph(&rng, m, m);
        double rest = energy_at_rest(&a, &b), d = paper_distance(context, &a, &b);
        assert_true(d <= rest + 1e-12);
        free(a.numbers);
        free(b.numbers);
    }
    test_context_free(context);
}

/* Isolated guards reach their targets; only differences of valence remain, which no map changes. */
static void alone_guards_reach_their_counterparts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(12, 0, 0);
    made_up a = random_graph(&rng, 1, 1), b = random_graph(&rng, 1, 1);
    guard_of(&a, 0)[3] = 0.5;
    assert_true(energy_at_rest(&a, &b) > 0.03);
    assert_true(fabs(paper_distance(context, &a, &b) - 0.1 * 0.25) < 1e-9);
    guard_of(&a, 0)[3] = 0;
    for (int k = 0; k < 64; k++)
        guard_of(&a, 0)[4 + k] = 3; /* plus 0.5 times the difference of histograms */
    assert_true(fabs(paper_distance(context, &a, &b) - 0.5 * 3) < 1e-9);
    free(a.numbers);
    free(b.numbers);
    test_context_free(context);
}

/* A graph transformed as a whole needs one map for all of its guards: almost no energy is left. */
static void moving_as_a_whole_is_nearly_free(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < 8; round++) {
        starg_rng rng = starg_rng_make(13, 0, round);
        made_up a = make_graph(12, 11);
        for (size_t i = 0; i < 12; i++) { /* far apart, so that the nearest are the right ones */
            guard_of(&a, i)[0] = (double)i;
            guard_of(&a, i)[1] = starg_rng_unit(&rng);
            if (i > 0)
                join(&a, i - 1, i - 1, i);
        }
        made_up b = make_graph(12, 11);
        memcpy(b.numbers, a.numbers, (PAPER_HEAD + PAPER_GUARD * 12 + 22) * sizeof *a.numbers);
        for (size_t i = 0; i < 12; i++)
            guard_of(&b, i)[2] += 0.4;
        assert_true(paper_distance(context, &a, &b) < 0.1 * energy_at_rest(&a, &b));
        free(a.numbers);
        free(b.numbers);
    }
    test_context_free(context);
}

/* ---- corrupted numbers ---- */

static void damaged_numbers_are_refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(14, 0, 0);
    made_up g = random_graph(&rng, 5, 5);
    size_t count = PAPER_HEAD + PAPER_GUARD * 5 + 8;
    const struct {
        size_t place;
        double value;
    } damages[] = {{0, 0},    {0, 4},         {0, 5.5},        {0, NAN},         {0, 1e300},
                   {1, -1},   {1, 3},         {1, NAN},        {2, NAN},         {3, INFINITY},
                   {40, 1e9}, {count - 1, 5}, {count - 1, -1}, {count - 2, 0.5}, {count - 2, NAN}};
    starg_signature *s = NULL;
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        double kept = g.numbers[damages[i].place];
        g.numbers[damages[i].place] = damages[i].value;
        assert_int_equal(restore(context, STARG_SIGNATURE_PAPER, g.numbers, count, &s),
                         STARG_ERROR_FORMAT);
        g.numbers[damages[i].place] = kept;
    }
    for (size_t cut = 0; cut < count; cut += 7)
        assert_int_equal(restore(context, STARG_SIGNATURE_PAPER, g.numbers, cut, &s),
                         STARG_ERROR_FORMAT);
    double star[STAR + 1] = {0};
    for (size_t cut = 0; cut <= STAR; cut++)
        assert_int_equal(
            restore(context, STARG_SIGNATURE_STAR, star, cut < STAR ? cut : STAR + 1, &s),
            STARG_ERROR_FORMAT);
    const struct {
        size_t place;
        double value;
    } star_damages[] = {{0, -1},     {3, 1},     {38, NAN},     {39, INFINITY}, {39, 1e101},
                        {40, 1e101}, {167, NAN}, {168, -1e101}, {359, INFINITY}};
    for (size_t i = 0; i < sizeof star_damages / sizeof *star_damages; i++) {
        star[star_damages[i].place] = star_damages[i].value;
        assert_int_equal(restore(context, STARG_SIGNATURE_STAR, star, STAR, &s),
                         STARG_ERROR_FORMAT);
        star[star_damages[i].place] = 0;
    }
    assert_null(s);
    const int former = starg_signature_version(STARG_SIGNATURE_STAR) - 1;
    test_ok(context, restore(context, STARG_SIGNATURE_STAR, star, STAR, &s));
    starg_signature_free(context, s);
    assert_int_equal(starg_signature_restore(context, STARG_SIGNATURE_STAR, former, star, STAR, &s),
                     STARG_ERROR_FORMAT);
    free(g.numbers);
    test_context_free(context);
}

static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX, failures = 0;
    starg_context *context = test_scarce_context(1, &left);
    starg_rng rng = starg_rng_make(15, 0, 0);
    made_up a = random_graph(&rng, 9, 9), b = random_graph(&rng, 7, 7);
    starg_signature *s = paper_of(context, &a), *t = paper_of(context, &b);
    size_t before = starg_context_live_blocks(context);
    double d;
    for (starg_status status = STARG_ERROR_MEMORY; status != STARG_OK; failures++) {
        left = failures;
        status = starg_signature_distance(context, s, t, &d);
        left = SIZE_MAX;
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(failures > 20);
    starg_signature_free(context, s);
    starg_signature_free(context, t);
    free(a.numbers);
    free(b.numbers);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_are_nearer_than_classes),
        cmocka_unit_test(copies_find_their_original),
        cmocka_unit_test(motions_hardly_count),
        cmocka_unit_test(absurd_descriptors),
        cmocka_unit_test(deforming_never_costs_more_than_resting),
        cmocka_unit_test(alone_guards_reach_their_counterparts),
        cmocka_unit_test(moving_as_a_whole_is_nearly_free),
        cmocka_unit_test(damaged_numbers_are_refused),
        cmocka_unit_test(memory_may_give_out),
    };
    return cmocka_run_group_tests(tests, NULL, free_originals);
}
