/* SPDX-License-Identifier: Apache-2.0 */
/* Queries of the search for cuts about a union of pieces, against linear programs over all relevant
 * rows, rebuilt for every relevant height. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/linear_program.h"
#include "partition_oracle.h"
#include "star/certified/partition.h"

enum { UNION_MOST = 5, TURNS = 20 };

typedef struct setting {
    starg_context *context;
    region_scratch scratch;
    region r;
    partition p;
    uint32_t pieces[UNION_MOST];
    size_t count;
} setting;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const double *vertex_of(const region *r, const region_triangle *t, int k) {
    return r->vertices.data + 3 * (size_t)t->corners[k];
}

static void random_direction(starg_rng *rng, double out[3]) {
    double length = 0;
    for (int k = 0; k < 3; k++) {
        out[k] = 2 * starg_rng_unit(rng) - 1;
        length += out[k] * out[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] /= sqrt(length);
}

static bool is_in(const setting *s, uint32_t number) {
    for (size_t i = 0; i < s->count; i++)
        if (s->pieces[i] == number)
            return true;
    return false;
}

/* Some pieces, adjacent or not. */
static void choose_union(setting *s, starg_rng *rng) {
    size_t wanted = 1 + (size_t)starg_rng_below(rng, UNION_MOST);
    s->count = 0;
    s->pieces[s->count++] = (uint32_t)starg_rng_below(rng, s->p.pieces.count);
    for (int attempt = 0; attempt < 300 && s->count < wanted; attempt++) {
        const facet *f = &s->p.facets.data[starg_rng_below(rng, s->p.facets.count)];
        int side = (int)starg_rng_below(rng, 2);
        uint32_t other = f->side[1 - side];
        if (is_in(s, f->side[side]) && other != PARTITION_OUTSIDE && !is_in(s, other))
            s->pieces[s->count++] = other;
    }
    test_ok(s->context, region_gather(&s->p, s->pieces, s->count, &s->scratch, &s->r));
}

static setting make(uint64_t seed) {
    setting s = {.context = test_context(1)};
    s.scratch.context = s.context;
    static const char *const names[] = {"human", "gallery", "knot"};
    if (seed % 4 == 3)
        s.p = grown_sample(s.context, names[seed / 4 % 3], 1500);
    else
        s.p = random_cells(s.context, seed, 30);
    return s;
}

static void release(setting *s) {
    region_free(&s->r);
    region_scratch_free(&s->scratch);
    partition_free(&s->p);
    test_context_free(s->context);
}

/* A check of s->r; counts the cases that must occur. */
typedef size_t union_check(setting *s, starg_rng *rng);

/* The sum over some unions of each of some partitions. */
static size_t for_unions(uint64_t seeds, uint64_t stage, union_check *check) {
    size_t sum = 0;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        setting s = make(seed);
        starg_rng rng = starg_rng_make(seed, stage, 0);
        for (int turn = 0; turn < TURNS; turn++) {
            choose_union(&s, &rng);
            sum += check(&s, &rng);
        }
        release(&s);
    }
    return sum;
}

/* ---- the scan ---- */

static void test_scan(void **state) {
    (void)state;
    size_t found = 0, none = 0;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        starg_rng rng = starg_rng_make(seed, 81, 0);
        double block[SCAN_SIZE], lowest[SCAN_BLOCK], point[3], worst = INFINITY;
        double bound = seed % 5 == 0 ? INFINITY : starg_rng_unit(&rng) - 0.5;
        double room = seed % 3 == 0 ? 0 : 2 * starg_rng_unit(&rng) - 1.9;
        size_t expected = SCAN_BLOCK;
        for (int i = 0; i < SCAN_SIZE; i++)
            block[i] = i < 3 * SCAN_BLOCK ? starg_rng_unit(&rng) - 0.5 : starg_rng_unit(&rng);
        for (int k = 0; k < 3; k++)
            point[k] = 2 * starg_rng_unit(&rng) - 1;
        for (int i = 0; i < SCAN_BLOCK; i++) {
            lowest[i] = starg_rng_below(&rng, 8) == 0 ? INFINITY : starg_rng_unit(&rng) - 0.5;
            const double normal[3] = {block[i], block[i + SCAN_BLOCK], block[i + 2 * SCAN_BLOCK]};
            double inside = block[i + 3 * SCAN_BLOCK] - dot(normal, point);
            if (lowest[i] < bound && inside < worst) {
                worst = inside;
                expected = (size_t)i;
            }
        }
        if (worst >= room)
            expected = SCAN_BLOCK;
        assert_int_equal(scan_block(block, lowest, bound, point, room), expected);
        found += expected < SCAN_BLOCK;
        none += expected == SCAN_BLOCK;
    }
    assert_true(found > 500 && none > 500);
}

/* ---- gathering ---- */

/* A row for each plane and side that bounds the union, all distinct. */
static void check_rows(const setting *s) {
    const partition *p = &s->p;
    size_t triangles = 0, rows = 0;
    bool *met = calloc(2 * p->planes.count, sizeof *met);
    assert_non_null(met);
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        const facet *f = &p->facets.data[i / 2];
        size_t entry = 2 * (size_t)f->plane + i % 2;
        if (!is_in(s, f->side[i % 2]) || is_in(s, f->side[1 - i % 2]))
            continue;
        triangles++;
        rows += !met[entry];
        met[entry] = true;
    }
    free(met);
    assert_int_equal(s->r.triangles.count, triangles);
    assert_int_equal(s->r.rows.count, 4 * rows);
}

/* Every triangle lies in its row's plane and is counter-clockwise seen from where the row points;
 * the triangles enclose the pieces' volume. */
static void check_triangles(const setting *s) {
    const region *r = &s->r;
    double volume = 0, up[3] = {0, 0, 1};
    for (size_t i = 0; i < r->triangles.count; i++) {
        const region_triangle *t = &r->triangles.data[i];
        const double *row = r->rows.data + 4 * (size_t)t->row;
        const double *a = vertex_of(r, t, 0), *b = vertex_of(r, t, 1), *c = vertex_of(r, t, 2);
        double n[3];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            n[k] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
            assert_true(fabs(dot(row, vertex_of(r, t, k)) - row[3]) < 1e-12);
        }
        assert_true(dot(n, row) > 0);
        assert_true(fabs(dot(row, row) - 1) < 1e-12);
    }
    for (size_t i = 0; i < s->count; i++)
        volume += partition_oracle_volume(&s->p, s->pieces[i]);
    assert_true(fabs(region_volume_above(r, up, 0.25) - volume) < 1e-13);
}

static size_t check_gathered(setting *s, starg_rng *rng) {
    (void)rng;
    check_rows(s);
    check_triangles(s);
    return s->r.triangles.count > 0;
}

static void test_gather(void **state) {
    (void)state;
    assert_int_equal(for_unions(6, 82, check_gathered), 6 * TURNS);
}

/* ---- slow answers ---- */

/* Where a row becomes active along a direction. */
static double lowest_of(const region *r, const double *normal, size_t row) {
    double lowest = INFINITY;
    for (size_t i = 0; i < r->triangles.count; i++)
        for (int k = 0; k < 3 && r->triangles.data[i].row == row; k++)
            lowest = fmin(lowest, dot(normal, vertex_of(r, &r->triangles.data[i], k)));
    return lowest;
}

static void find_lowest(const region *r, const double *normal, double *lowest) {
    for (size_t row = 0; row < r->rows.count / 4; row++)
        lowest[row] = lowest_of(r, normal, row);
}

static void add_program_row(linear_program *program, double *rows, const double *normal,
                            double offset) {
    double *row = rows + 5 * program->count++;
    for (int k = 0; k < 5; k++)
        row[k] = (k < 3 ? normal[k] : k == 3 ? 1 : offset) / sqrt(2);
}

/* Radius of the largest ball in the rows active below a height and the plane there (INFINITY: no
 * plane, all rows with triangles); at most about 4. */
static double radius_below(const region *r, const double *normal, const double *lowest,
                           double height) {
    size_t count = r->rows.count / 4;
    double *rows = malloc(5 * (count + 1) * sizeof *rows);
    uint32_t *order = malloc((count + 1) * sizeof *order);
    linear_program program = {.dimension = 4, .rows = rows, .objective = {0, 0, 0, 1}, .radius = 8};
    linear_solution solution;
    assert_non_null(rows);
    assert_non_null(order);
    for (size_t i = 0; i < count; i++)
        if (lowest[i] < height)
            add_program_row(&program, rows, r->rows.data + 4 * i, r->rows.data[4 * i + 3]);
    if (height < INFINITY)
        add_program_row(&program, rows, normal, height);
    linear_program_solve(&program, order, NULL, &solution);
    free(rows);
    free(order);
    assert_true(solution.feasible);
    return solution.point[3];
}

/* ---- reaches ---- */

/* Between two heights at which rows become active only the plane moves, away from the guard: so the
 * highest place is one of them, or there is none. */
static void check_reach(const region *r, const double normal[3], double margin,
                        const region_reach *reach) {
    size_t count = r->rows.count / 4;
    double *lowest = malloc((count + 1) * sizeof *lowest);
    bool known = reach->height == INFINITY;
    assert_non_null(lowest);
    find_lowest(r, normal, lowest);
    assert_true(reach->height > -INFINITY); /* with nothing below it the plane is alone */
    for (size_t i = 0; i < count; i++) {
        const double *row = r->rows.data + 4 * i;
        known = known || fabs(lowest[i] - reach->height) < 1e-12;
        if (lowest[i] > reach->height + 1e-12) /* just above, and all the way up */
            assert_true(radius_below(r, normal, lowest, lowest[i]) < margin + 1e-9);
        if (lowest[i] < reach->height - 1e-12)
            assert_true(row[3] - dot(row, reach->guard) > 0.5 * margin - 1e-12);
    }
    assert_true(known);
    if (reach->height < INFINITY) {
        assert_true(radius_below(r, normal, lowest, INFINITY) < margin + 1e-9);
        assert_true(reach->height - dot(normal, reach->guard) > 0.5 * margin - 1e-12);
    }
    assert_true(radius_below(r, normal, lowest, reach->height) > 0.5 * margin - 1e-9);
    free(lowest);
}

static void test_reach(void **state) {
    (void)state;
    static const double margins[] = {1e-5, 1e-3, 2e-2};
    size_t whole = 0, part = 0;
    for (uint64_t seed = 0; seed < 12; seed++) {
        setting s = make(seed);
        starg_rng rng = starg_rng_make(seed, 83, 0);
        for (int turn = 0; turn < (seed % 4 == 3 ? 4 : 20); turn++) {
            double normal[3], back[3], margin = margins[turn % 3];
            region_reach up, down, alone;
            choose_union(&s, &rng);
            random_direction(&rng, normal);
            for (int k = 0; k < 3; k++)
                back[k] = -normal[k];
            test_ok(s.context, region_find_reach(&s.r, normal, margin, &s.scratch, &up, &down));
            check_reach(&s.r, normal, margin, &up);
            check_reach(&s.r, back, margin, &down);
            test_ok(s.context, region_find_reach(&s.r, normal, margin, &s.scratch, &alone, NULL));
            assert_memory_equal(&alone, &up, sizeof up);
            whole += up.height == INFINITY;
            part += up.height < INFINITY;
        }
        release(&s);
    }
    assert_true(whole > 20 && part > 20);
}

/* Squared distance from a place to the nearest triangle corner of a row. */
static void find_nearest(const region *r, const double center[3], double *nearest) {
    for (size_t i = 0; i < r->rows.count / 4; i++)
        nearest[i] = INFINITY;
    for (size_t i = 0; i < r->triangles.count; i++)
        for (int k = 0; k < 3; k++) {
            const double *v = vertex_of(r, &r->triangles.data[i], k);
            double squared = 0;
            for (int c = 0; c < 3; c++)
                squared += (v[c] - center[c]) * (v[c] - center[c]);
            nearest[r->triangles.data[i].row] = fmin(nearest[r->triangles.data[i].row], squared);
        }
}

/* All rows closer than the distance found contain the guard, and those that `other`, unless NULL,
 * is not inside of; with the next rows there would be no room. */
static void check_reach_about(const region *r, const double center[3], const double *other,
                              double margin, const region_reach *reach) {
    size_t count = r->rows.count / 4;
    double *nearest = malloc((count + 1) * sizeof *nearest), next = INFINITY;
    double *scaled = malloc((count + 1) * sizeof *scaled);
    assert_non_null(nearest);
    assert_non_null(scaled);
    find_nearest(r, center, nearest);
    for (size_t i = 0; i < count && other != NULL; i++)
        if (r->rows.data[4 * i + 3] - dot(r->rows.data + 4 * i, other) < margin)
            nearest[i] = -INFINITY;
    assert_true(other != NULL || reach->height > -INFINITY);
    for (size_t i = 0; i < count; i++) {
        const double *row = r->rows.data + 4 * i;
        if (nearest[i] < reach->height - 1e-12)
            assert_true(row[3] - dot(row, reach->guard) > 0.5 * margin - 1e-12);
        else if (nearest[i] < INFINITY)
            next = fmin(next, nearest[i]);
    }
    assert_true(reach->height > -INFINITY || next == -INFINITY);
    for (size_t i = 0; i < count; i++)
        scaled[i] = nearest[i] <= next + 1e-12 ? 0 : 2;
    static const double away[3] = {1, 0, 0};
    /* a plane far away, so that only the rows marked with 0 count */
    if (reach->height < INFINITY)
        assert_true(radius_below(r, away, scaled, 1) < margin + 1e-9);
    free(nearest);
    free(scaled);
}

static void test_reach_about(void **state) {
    (void)state;
    static const double margins[] = {1e-5, 1e-3, 2e-2};
    size_t whole = 0, part = 0, none = 0, some = 0;
    for (uint64_t seed = 0; seed < 8; seed++) {
        setting s = make(seed);
        starg_rng rng = starg_rng_make(seed, 84, 0);
        for (int turn = 0; turn < (seed % 4 == 3 ? 4 : 20); turn++) {
            double margin = margins[turn % 3], center[3];
            region_reach reach;
            choose_union(&s, &rng);
            const region_triangle *t =
                &s.r.triangles.data[starg_rng_below(&rng, s.r.triangles.count)];
            for (int k = 0; k < 3; k++)
                center[k] = vertex_of(&s.r, t, 0)[k] + 0.1 * (starg_rng_unit(&rng) - 0.5);
            test_ok(s.context, region_find_reach_about(&s.r, center, margin, &s.scratch, &reach));
            check_reach_about(&s.r, center, NULL, margin, &reach);
            whole += reach.height == INFINITY;
            part += reach.height < INFINITY;
            double other[3];
            for (int k = 0; k < 3; k++)
                other[k] = reach.guard[k] + starg_rng_unit(&rng) - 0.5;
            test_ok(s.context,
                    region_find_reach_for(&s.r, center, other, margin, &s.scratch, &reach));
            check_reach_about(&s.r, center, other, margin, &reach);
            none += reach.height == -INFINITY;
            some += fabs(reach.height) < INFINITY;
        }
        release(&s);
    }
    print_message("for another: %zu none, %zu some\n", none, some);
    assert_true(whole > 20 && part > 10 && none > 0 && some > 5);
}

/* ---- centres ---- */

/* Is it empty? */
static bool check_center(const setting *s, const double *normal, double height) {
    static const double anywhere[3] = {0, 0, 0};
    const region *r = &s->r;
    size_t count = r->rows.count / 4;
    double *lowest = malloc((count + 1) * sizeof *lowest), center[3], radius;
    region_scratch scratch = {.context = s->context};
    assert_non_null(lowest);
    test_ok(s->context, region_find_center(r, normal, height, &scratch, center, &radius));
    find_lowest(r, normal == NULL ? anywhere : normal, lowest);
    double slow = radius_below(r, normal, lowest, normal == NULL ? INFINITY : height);
    if (slow > 1e-8 && slow < 3)
        assert_true(fabs(radius - slow) < 3e-9);
    else
        assert_true(slow < 3 ? radius < 1.1e-8 : radius > 2);
    for (size_t i = 0; i < count && radius > 0; i++)
        if (lowest[i] < (normal == NULL ? INFINITY : height))
            assert_true(r->rows.data[4 * i + 3] - dot(r->rows.data + 4 * i, center) >
                        radius - 1e-9);
    if (normal != NULL && radius > 0)
        assert_true(height - dot(normal, center) > radius - 1e-9);
    region_scratch_free(&scratch);
    free(lowest);
    return radius <= 0;
}

static size_t check_centers(setting *s, starg_rng *rng) {
    double normal[3];
    random_direction(rng, normal);
    const region_triangle *t = &s->r.triangles.data[starg_rng_below(rng, s->r.triangles.count)];
    double height = dot(normal, vertex_of(&s->r, t, 0)) + 0.01 * starg_rng_unit(rng);
    return (size_t)check_center(s, NULL, 0) + check_center(s, normal, height);
}

static void test_center(void **state) {
    (void)state;
    size_t empty = for_unions(12, 84, check_centers), all = 2 * 12 * TURNS;
    assert_true(empty > 20 && all - empty > 20);
}

/* ---- some facets ---- */

static bool has_row(const region *r, const double *row) {
    for (size_t i = 0; i < r->rows.count; i += 4)
        if (memcmp(r->rows.data + i, row, 4 * sizeof *row) == 0)
            return true;
    return false;
}

/* A subset of facets has no rows beyond those of all facets, and leaves no state that affects
 * another gathering. */
static size_t check_some(setting *s, starg_rng *rng) {
    uint32_t most = 1 + (uint32_t)starg_rng_below(rng, 40);
    bool fewer = s->r.triangles.count > 2 * s->count * most;
    region part = {.vertices = {0}};
    double center[3], whole_radius, part_radius;
    test_ok(s->context, region_gather_some(&s->p, s->pieces, s->count, most, &s->scratch, &part));
    assert_true(part.triangles.count < 2 * s->count * most);
    for (size_t i = 0; i < part.rows.count; i += 4)
        assert_true(has_row(&s->r, part.rows.data + i));
    test_ok(s->context, region_find_center(&part, NULL, 0, &s->scratch, center, &part_radius));
    test_ok(s->context, region_find_center(&s->r, NULL, 0, &s->scratch, center, &whole_radius));
    assert_true(part_radius > whole_radius - 1e-8);
    test_ok(s->context, region_gather(&s->p, s->pieces, s->count, &s->scratch, &s->r));
    check_rows(s);
    region_free(&part);
    return fewer;
}

static void test_some(void **state) {
    (void)state;
    assert_true(for_unions(12, 85, check_some) > 40);
}

/* ---- clipping ---- */

/* The part above a plane: its volume is that of the piece that a slice cuts off, and its kernel
 * that of the region's far side. */
static size_t check_clip(setting *s, starg_rng *rng) {
    const partition_plane cut = random_plane_across(&s->p, s->pieces[0], rng), *plane = &cut;
    region above = {.vertices = {0}};
    double back[3], radius[2], center[3];
    for (int k = 0; k < 3; k++)
        back[k] = -plane->normal[k];
    test_ok(s->context, region_clip(s->context, &s->r, plane->normal, plane->offset, &above));
    for (size_t i = 0; i < above.triangles.count; i++) {
        const region_triangle *t = &above.triangles.data[i];
        const double *row = above.rows.data + 4 * (size_t)t->row;
        for (int k = 0; k < 3; k++) {
            assert_true(dot(plane->normal, vertex_of(&above, t, k)) > plane->offset - 1e-12);
            assert_true(fabs(dot(row, vertex_of(&above, t, k)) - row[3]) < 1e-12);
        }
    }
    test_ok(s->context, region_find_center(&above, NULL, 0, &s->scratch, center, &radius[0]));
    test_ok(s->context,
            region_find_center(&s->r, back, -plane->offset, &s->scratch, center, &radius[1]));
    assert_true(fabs(fmax(radius[0], 0) - fmax(radius[1], 0)) < 1e-8);

    bool sliced = false;
    piece fresh = {.volume = 0};
    starg_status status = STARG_OK;
    partition copy = partition_oracle_copy(&s->p);
    partition_join(&copy, s->pieces, s->count);
    uint32_t high = (uint32_t)copy.pieces.count;
    STARG_PUSH(s->context, PARTITION_STAGE, &copy.pieces, fresh);
    STARG_TRY(partition_slice(&copy, s->pieces[0], high, plane, &sliced));
    if (sliced) {
        double volume = region_volume_above(&above, plane->normal, plane->offset);
        assert_true(volume > 0);
        assert_true(fabs(volume - partition_oracle_volume(&copy, high)) < 1e-12);
    }
done:
    test_ok(s->context, status);
    partition_free(&copy);
    region_free(&above);
    return sliced;
}

static void test_clip(void **state) {
    (void)state;
    assert_true(for_unions(8, 85, check_clip) > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scan),   cmocka_unit_test(test_gather),
        cmocka_unit_test(test_reach),  cmocka_unit_test(test_reach_about),
        cmocka_unit_test(test_center), cmocka_unit_test(test_some),
        cmocka_unit_test(test_clip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
