/* SPDX-License-Identifier: Apache-2.0 */
/* Guards first, then borders: borders between random triangles by definition, crossings of cones
 * against edges that meet faces, and cuts of samples, checked by brute force and in rationals
 * (partition_oracle.h). */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "partition_oracle.h"
#include "star/certified/search.h"

enum { TRIANGLES = 12 };

static const double GAP = 1e-5;

/* Triangles in space that share vertices now and then, and guards. */
typedef struct scene {
    region r;
    double guards[3][3];
    separator_task task;
} scene;

static void random_point(starg_rng *rng, const double about[3], double size, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = about[k] + size * (starg_rng_unit(rng) - 0.5);
}

static void add_vertex(starg_context *context, region *r, const double at[3]) {
    starg_status status = STARG_OK;
    for (int k = 0; k < 3; k++)
        STARG_PUSH(context, "test", &r->vertices, at[k]);
done:
    test_ok(context, status);
}

/* The second guard is a unit away from the first, and its triangles are more often beyond. */
static scene random_scene(starg_context *context, uint64_t seed, size_t guards, double apart) {
    starg_status status = STARG_OK;
    starg_rng rng = starg_rng_make(seed, 94, 0);
    scene s = {.r = {.vertices = {0}}};
    s.task = (separator_task){.guard_count = guards, .gap = GAP};
    for (size_t i = 0; i < 3; i++) {
        const double about[3] = {i == 0 ? 0 : 0.4 + apart, 0, 0};
        random_point(&rng, about, 0.2, s.guards[i]);
    }
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        bool own = i % 2 == 0;
        const double about[3] = {own ? 0 : 0.4 + apart, 0, 0};
        double center[3], corner[3];
        region_triangle t = {.row = 0};
        random_point(&rng, about, 1, center);
        for (int k = 0; k < 3; k++) {
            random_point(&rng, center, 0.2, corner);
            t.corners[k] = (uint32_t)(s.r.vertices.count / 3);
            if (k == 0 && t.corners[0] > 0 && starg_rng_below(&rng, 3) == 0)
                t.corners[0] = (uint32_t)starg_rng_below(&rng, t.corners[0]);
            else
                add_vertex(context, &s.r, corner);
        }
        STARG_PUSH(context, "test", &s.r.triangles, t);
        STARG_PUSH(context, "test", own ? &s.task.own : &s.task.others, i);
    }
done:
    test_ok(context, status);
    return s;
}

static void scene_free(starg_context *context, scene *s) {
    STARG_ARRAY_FREE(context, &s->task.own);
    STARG_ARRAY_FREE(context, &s->task.others);
    region_free(&s->r);
}

static const double *corner_of(const region *r, uint32_t triangle, int k) {
    return r->vertices.data + 3 * (size_t)r->triangles.data[triangle].corners[k];
}

/* ---- borders ---- */

static double height(const partition_plane *plane, const double at[3]) {
    return plane->normal[0] * at[0] + plane->normal[1] * at[1] + plane->normal[2] * at[2] -
           plane->offset;
}

/* All of a triangle, but for vertices in the plane. */
static bool is_on_side(const region *r, const partition_plane *plane, uint32_t triangle,
                       double sign) {
    bool on = true, proper = false;
    for (int k = 0; k < 3; k++) {
        double at = sign * height(plane, corner_of(r, triangle, k));
        on = on && at > -1e-12;
        proper = proper || at > 0.9 * GAP;
    }
    return on && proper;
}

/* Own triangles are in a term, the others above a plane of each, guards on their sides of all. */
static void check_border(const scene *s, const cut_plan *plan) {
    bool in_term[TRIANGLES] = {false};
    assert_true(plan->count > 0 && plan->ends[plan->count - 1] == CUT_ENDS_PART);
    for (int first = 0; first < plan->count;) {
        int end = first;
        while (plan->ends[end] == CUT_GOES_ON)
            end++;
        assert_true(end + 1 == plan->count || plan->ends[end] == CUT_ENDS_TERM);
        for (uint32_t t = 0; t < TRIANGLES; t++) {
            bool below = true, above = false;
            for (int i = first; i <= end; i++) {
                below = below && is_on_side(&s->r, &plan->planes[i], t, -1);
                above = above || is_on_side(&s->r, &plan->planes[i], t, 1);
            }
            in_term[t] = in_term[t] || below;
            if (t % 2 == 1)
                assert_true(above);
        }
        first = end + 1;
    }
    for (uint32_t t = 0; t < TRIANGLES; t += 2)
        assert_true(in_term[t]);
    for (int i = 0; i < plan->count; i++)
        for (size_t g = 0; g < s->task.guard_count; g++)
            assert_true((g == 0 ? -1 : 1) * height(&plan->planes[i], s->guards[g]) > 0.9 * GAP);
}

static void test_borders(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    size_t found_count = 0, with_more = 0, failed = 0;
    for (uint64_t seed = 0; seed < 400; seed++) {
        starg_rng rng = starg_rng_make(seed, 95, 0);
        scene s = random_scene(context, seed, 2 + seed % 2, 0.2 * (double)(seed % 5));
        cut_plan plan = {.count = 0};
        size_t crossings;
        bool found;
        s.task.r = &s.r;
        s.task.guards = (const double(*)[3])s.guards;
        test_ok(context, crossings_count(&s.task, 1000, &scratch, &crossings));
        test_ok(context, separator_find(&s.task, &rng, &scratch, &plan, &found));
        if (found) {
            check_border(&s, &plan);
            assert_int_equal(crossings, 0);
            for (uint32_t t = 1; t < TRIANGLES; t += 2)
                assert_false(separator_holds(&s.r, &plan, t));
        } else {
            assert_int_equal(plan.count, 0);
        }
        found_count += found;
        with_more += found && plan.count > 1;
        failed += !found;
        scene_free(context, &s);
    }
    print_message("%zu borders, %zu of several planes, %zu times none\n", found_count, with_more,
                  failed);
    assert_true(with_more > 20 && failed > 50 && found_count > 100);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* ---- crossings ---- */

static double side(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = d[k] - a[k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static bool edge_meets_face(const double *p, const double *q, const double *a, const double *b,
                            const double *c) {
    double u = side(p, q, a, b), v = side(p, q, b, c), w = side(p, q, c, a);
    return side(a, b, c, p) * side(a, b, c, q) < 0 &&
           ((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0));
}

static bool holds_point(const double *const t[4], const double *x) {
    for (int i = 0; i < 4; i++) {
        const double *a = t[(i + 1) % 4], *b = t[(i + 2) % 4], *c = t[(i + 3) % 4];
        if (side(a, b, c, x) * side(a, b, c, t[i]) < 0)
            return false;
    }
    return true;
}

/* Do two tetrahedra in general position meet? */
static bool meet(const double *const a[4], const double *const b[4]) {
    static const int edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    bool found = holds_point(a, b[0]) || holds_point(b, a[0]);
    for (int e = 0; e < 6 && !found; e++)
        for (int f = 0; f < 4 && !found; f++)
            found = edge_meets_face(a[edges[e][0]], a[edges[e][1]], b[f], b[(f + 1) % 4],
                                    b[(f + 2) % 4]) ||
                    edge_meets_face(b[edges[e][0]], b[edges[e][1]], a[f], a[(f + 1) % 4],
                                    a[(f + 2) % 4]);
    return found;
}

static bool share_vertex(const region *r, uint32_t a, uint32_t b) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (r->triangles.data[a].corners[i] == r->triangles.data[b].corners[k])
                return true;
    return false;
}

/* One pair after the other. No crossing is missed; cones that nearly meet may count as if they did.
 */
static void test_crossings(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    size_t met = 0, apart = 0, wrong = 0;
    for (uint64_t seed = 0; seed < 60; seed++) {
        scene s = random_scene(context, seed, 2, 0.2 * (double)(seed % 5));
        for (uint32_t i = 0; i < TRIANGLES; i += 2)
            for (uint32_t n = 1; n < TRIANGLES; n += 2) {
                const separator_task one = {.r = &s.r,
                                            .guards = (const double(*)[3])s.guards,
                                            .guard_count = 2,
                                            .own = {.data = &i, .count = 1},
                                            .others = {.data = &n, .count = 1},
                                            .gap = 1e-9};
                const double *a[4] = {s.guards[0]}, *b[4] = {s.guards[1]};
                size_t crossings;
                for (int k = 0; k < 3; k++) {
                    a[k + 1] = corner_of(&s.r, i, k);
                    b[k + 1] = corner_of(&s.r, n, k);
                }
                if (share_vertex(&s.r, i, n))
                    continue;
                test_ok(context, crossings_count(&one, 10, &scratch, &crossings));
                bool truly = meet(a, b);
                assert_true(crossings == 1 || !truly);
                met += truly;
                apart += !truly;
                wrong += crossings == 1 && !truly;
            }
        scene_free(context, &s);
    }
    print_message("%zu pairs of cones meet, %zu do not, %zu of them too near\n", met, apart, wrong);
    assert_true(met > 100 && apart > 100 && 100 * wrong < apart);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* ---- cuts ---- */

/* A random piece and random pieces beyond facets of what is chosen; 0 if there are not so many. */
static size_t choose(const partition *p, starg_rng *rng, size_t wanted, uint32_t *out) {
    size_t count = 1;
    out[0] = (uint32_t)starg_rng_below(rng, p->pieces.count);
    for (int attempt = 0; attempt < 200 && count < wanted; attempt++) {
        uint32_t from = out[starg_rng_below(rng, count)], first = p->start.data[from];
        uint32_t facets = p->start.data[from + 1] - first;
        uint32_t entry = p->index.data[first + starg_rng_below(rng, facets)];
        uint32_t next = p->facets.data[entry / 2].side[1 - entry % 2];
        bool known = next == PARTITION_OUTSIDE;
        for (size_t i = 0; i < count; i++)
            known = known || out[i] == next;
        if (!known)
            out[count++] = next;
    }
    return count == wanted ? count : 0;
}

/* A first term that holds nothing changes nothing. */
static void check_empty_term(const partition *before, const uint32_t *pieces, size_t count,
                             const cut_plan *plan, bool done, region_scratch *scratch) {
    cut_plan longer = {
        .count = plan->count + 1, .planes = {plan->planes[0]}, .ends = {CUT_ENDS_TERM}};
    apply_effect effect;
    if (plan->count == CUT_PLANES_MOST)
        return;
    partition p = partition_oracle_copy(before);
    longer.planes[0].offset = -8;
    memcpy(longer.planes + 1, plan->planes, (size_t)plan->count * sizeof *plan->planes);
    memcpy(longer.ends + 1, plan->ends, (size_t)plan->count * sizeof *plan->ends);
    test_ok(p.context, apply_cuts(&p, pieces, count, &longer, 4e-6, NULL, scratch, &effect));
    assert_int_equal(effect.done, done);
    partition_free(&p);
}

static size_t cut_some(partition *p, size_t wanted, uint64_t seed, int *planes) {
    region_scratch scratch = {.context = p->context};
    partition first = partition_oracle_copy(p);
    region r = {.vertices = {0}};
    size_t done = 0;
    for (uint64_t trial = 0; trial < 100; trial++) {
        starg_rng rng = starg_rng_make(seed, 96, trial);
        uint32_t pieces[APPLY_MOST];
        double starts[APPLY_MOST][3];
        cut_plan plan;
        apply_effect effect;
        bool found;
        size_t count = choose(p, &rng, wanted, pieces);
        if (count == 0)
            continue;
        for (size_t i = 0; i < count; i++)
            partition_to_unit(p, p->pieces.data[pieces[i]].guard, starts[i]);
        const guard_split_options options = {1e-5, (const double(*)[3])starts, count};
        test_ok(p->context, region_gather(p, pieces, count, &scratch, &r));
        test_ok(p->context,
                guard_split_find(&r, count - 1, &options, &rng, &scratch, &plan, &found));
        if (!found)
            continue;
        partition before = partition_oracle_copy(p);
        test_ok(p->context, apply_cuts(p, pieces, count, &plan, 1, NULL, &scratch, &effect));
        assert_true(!effect.done && partition_oracle_same(p, &before));
        test_ok(p->context, apply_cuts(p, pieces, count, &plan, 4e-6, NULL, &scratch, &effect));
        if (effect.done)
            assert_int_equal(p->pieces.count + 1, before.pieces.count);
        else
            assert_true(partition_oracle_same(p, &before));
        check_empty_term(&before, pieces, count, &plan, effect.done, &scratch);
        done += effect.done;
        *planes += effect.done ? plan.count : 0;
        partition_free(&before);
    }
    partition_oracle_check(p);
    partition_oracle_check_guards(p);
    partition_oracle_check_surface(&first, p);
    partition_free(&first);
    region_free(&r);
    region_scratch_free(&scratch);
    return done;
}

static void test_cuts(void **state) {
    (void)state;
    static const char *const names[3] = {"torus", "horse", "knot"};
    starg_context *context = test_context(1);
    size_t done[2] = {0};
    int planes = 0;
    for (int n = 0; n < 3; n++)
        for (size_t wanted = 3; wanted <= 4; wanted++) {
            partition p = grown_sample(context, names[n], 1000);
            done[wanted - 3] += cut_some(&p, wanted, wanted, &planes);
            partition_free(&p);
        }
    print_message("3 pieces made 2: %zu times, 4 made 3: %zu times, by %d planes\n", done[0],
                  done[1], planes);
    assert_true(done[0] > 2 && done[1] > 2 && planes > (int)(done[0] + 2 * done[1]));
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_borders),
        cmocka_unit_test(test_crossings),
        cmocka_unit_test(test_cuts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
