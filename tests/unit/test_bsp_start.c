/* SPDX-License-Identifier: Apache-2.0 */
/* Solids cut by planes until every part is star-shaped, and pieces split into connected parts:
 * against the definitions, by brute force and in rationals (partition_oracle.h). */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "partition_oracle.h"
#include "star/certified/search.h"
#include "star/compatible/cone_builder.h"
#include "tetrahedra.h"

enum { EVALUATIONS = 1500 };

/* All pieces in one. */
static void join_everything(partition *p) {
    uint32_t *all = calloc(p->pieces.count, sizeof *all);
    assert_non_null(all);
    for (uint32_t i = 0; i < p->pieces.count; i++)
        all[i] = i;
    partition_join(p, all, p->pieces.count);
    p->pieces.count = 1;
    free(all);
    test_ok(p->context, partition_build_index(p));
}

static double volume_of_all(const partition *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        sum += partition_oracle_volume(p, i);
    return sum;
}

/* ---- parts ---- */

static bool share_edge(const facet *a, const facet *b) {
    int shared = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            shared += a->corners[i] == b->corners[k];
    return shared >= 2;
}

/* The lowest facet connected with each facet of a piece, by iterating over all pairs until nothing
 * changes. */
static uint32_t *find_parts(const partition *p) {
    uint32_t *part = calloc(p->facets.count, sizeof *part);
    bool changed = true;
    assert_non_null(part);
    for (size_t i = 0; i < p->facets.count; i++)
        part[i] = (uint32_t)i;
    while (changed) {
        changed = false;
        for (size_t i = 0; i < p->facets.count; i++)
            for (size_t k = 0; k < p->facets.count; k++)
                if (part[k] < part[i] && share_edge(&p->facets.data[i], &p->facets.data[k])) {
                    part[i] = part[k];
                    changed = true;
                }
    }
    return part;
}

/* Boxes of six tetrahedra each at given places of a grid, regular except for the width along x from
 * 1 to 2. */
static partition boxes(starg_context *context, const int (*places)[3], size_t count, double width) {
    static const int steps[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    enum { SIDE = 6, CUBES_MOST = 27 };
    static const uint32_t stride[3] = {1, SIDE, SIDE * SIDE};
    static double vertices[3 * SIDE * SIDE * SIDE];
    static const double guard[3] = {0, 0, 0};
    uint32_t tetrahedra[24 * CUBES_MOST], labels[6 * CUBES_MOST] = {0};
    starg_tetmesh *mesh = NULL;
    partition p;
    for (size_t v = 0; v < SIDE * SIDE * SIDE; v++) {
        for (size_t k = 0; k < 3; k++)
            vertices[3 * v + k] = (double)(v / stride[k] % SIDE);
        if (v % SIDE >= 2)
            vertices[3 * v] += width - 1;
    }
    for (size_t t = 0; t < 6 * count; t++) {
        const int *at = places[t / 6];
        uint32_t corner = 0;
        for (size_t k = 0; k < 3; k++)
            corner += (uint32_t)at[k] * stride[k];
        for (size_t k = 0; k < 4; k++) {
            tetrahedra[4 * t + k] = corner;
            corner += k < 3 ? stride[steps[t % 6][k]] : 0;
        }
    }
    test_ok(context, starg_tetmesh_create(context, vertices, SIDE * SIDE * SIDE, tetrahedra,
                                          6 * count, NULL, &mesh));
    test_ok(context, partition_create(context, mesh, labels, guard, 1, &p));
    starg_tetmesh_free(mesh);
    return p;
}

static partition cubes(starg_context *context, const int (*places)[3], size_t count) {
    return boxes(context, places, count, 1);
}

/* Random cubes of a grid: some touch in a vertex only, which does not connect them. */
static void test_parts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t several = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        starg_rng rng = starg_rng_make(seed, 76, 0);
        int places[20][3];
        size_t count = 0;
        for (int i = 0; i < 27; i++)
            if (count < 20 && starg_rng_below(&rng, 27) < 4 + seed) {
                const int at[3] = {2 * (i % 3) - (i % 3 == 2), i / 3 % 3, 2 * (i / 9) - (i > 17)};
                memcpy(places[count++], at, sizeof at);
            }
        if (count == 0)
            continue;
        partition p = cubes(context, (const int(*)[3])places, count);
        double whole = volume_of_all(&p);
        uint32_t *part = find_parts(&p);
        test_ok(context, partition_separate(&p, 0));
        partition_oracle_check(&p);
        assert_true(fabs(volume_of_all(&p) - whole) < 1e-13);
        for (size_t i = 0; i < p.facets.count; i++)
            for (size_t k = 0; k < i; k++)
                assert_int_equal(p.facets.data[i].side[0] == p.facets.data[k].side[0],
                                 part[i] == part[k]);
        several += p.pieces.count > 1;
        free(part);
        partition_free(&p);
    }
    assert_true(several > 3);
    test_context_free(context);
}

/* A cavity's surface is not a piece. */
static void test_cavity(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    int places[26][3];
    size_t count = 0, others = 0;
    for (int i = 0; i < 27; i++)
        if (i != 13) {
            const int at[3] = {i % 3, i / 3 % 3, i / 9};
            memcpy(places[count++], at, sizeof at);
        }
    partition p = cubes(context, (const int(*)[3])places, count);
    uint32_t *part = find_parts(&p);
    for (size_t i = 0; i < p.facets.count; i++)
        others += part[i] != part[0];
    assert_true(others > 0);
    test_ok(context, partition_separate(&p, 0));
    assert_int_equal(p.pieces.count, 1);
    free(part);
    partition_free(&p);
    test_context_free(context);
}

/* ---- cuts ---- */

/* Random cubes of a grid, which touch in edges and vertices. */
static partition random_cubes(starg_context *context, starg_rng *rng) {
    int places[27][3];
    size_t count = 0;
    for (int i = 0; i < 27; i++)
        if (starg_rng_below(rng, 2) == 0 || (i == 26 && count == 0)) {
            const int at[3] = {i % 3, i / 3 % 3, i / 9};
            memcpy(places[count++], at, sizeof at);
        }
    return cubes(context, (const int(*)[3])places, count);
}

/* A plane through a point of the grid, normal to a direction of small integers: through vertices,
 * along edges, through faces. */
static partition_plane random_grid_plane(const partition *p, starg_rng *rng) {
    partition_plane plane = {.normal = {0, 0, 0}};
    double point[3], unit[3], length = 0;
    while (length == 0)
        for (int k = 0; k < 3; k++) {
            plane.normal[k] = (double)starg_rng_below(rng, 3) - 1;
            length += plane.normal[k] * plane.normal[k];
        }
    for (int k = 0; k < 3; k++) {
        plane.normal[k] /= sqrt(length);
        point[k] = (double)starg_rng_below(rng, 4);
    }
    partition_to_unit(p, point, unit);
    for (int k = 0; k < 3; k++)
        plane.offset += plane.normal[k] * unit[k];
    return plane;
}

/* No facet of a part is beyond the plane, and one extends as far on its side as the piece did. */
static void check_sides(const partition *p, uint32_t high, const partition_plane *plane) {
    for (size_t i = 0; i < 2 * p->facets.count; i++)
        for (int k = 0; k < 3; k++) {
            const facet *f = &p->facets.data[i / 2];
            const double *v = partition_unit(p, f->corners[k]);
            double height = plane->normal[0] * v[0] + plane->normal[1] * v[1] +
                            plane->normal[2] * v[2] - plane->offset;
            if (f->side[i % 2] == 0)
                assert_true(height < SLICE_ON);
            if (f->side[i % 2] == high)
                assert_true(height > -SLICE_ON);
        }
}

static void test_cuts_of_cubes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t cut = 0;
    for (uint64_t seed = 0; seed < 60; seed++) {
        starg_rng rng = starg_rng_make(seed, 88, 0);
        partition p = random_cubes(context, &rng);
        double whole = volume_of_all(&p);
        for (int i = 0; i < 12; i++) {
            const partition_plane plane = random_grid_plane(&p, &rng);
            partition next = partition_oracle_copy(&p);
            uint32_t high = (uint32_t)next.pieces.count;
            const piece fresh = {.volume = 0};
            starg_status status = STARG_OK;
            bool done = false;
            STARG_PUSH(context, PARTITION_STAGE, &next.pieces, fresh);
        done:
            test_ok(context, status);
            test_ok(context, partition_slice(&next, 0, high, &plane, &done));
            if (!done) {
                partition_free(&next);
                continue;
            }
            test_ok(context, partition_build_index(&next));
            partition_oracle_check(&next);
            check_sides(&next, high, &plane);
            assert_true(partition_oracle_volume(&next, 0) > 1e-6);
            assert_true(partition_oracle_volume(&next, high) > 1e-6);
            assert_true(fabs(volume_of_all(&next) - whole) < 1e-12);
            partition_free(&p);
            p = next;
            cut++;
        }
        partition_free(&p);
    }
    assert_true(cut > 100);
    test_context_free(context);
}

static bool start_stream(partition *p, uint64_t stream, size_t budget, bool to_the_end) {
    const bsp_options options = {.stream = stream, .budget = budget, .to_the_end = to_the_end};
    bsp_report report;
    test_ok(p->context, bsp_start(p, &options, &report));
    return report.done;
}

static bool start(partition *p, size_t budget, bool to_the_end) {
    return start_stream(p, 0, budget, to_the_end);
}

static void check_bisected(const partition *first, const partition *p) {
    partition_oracle_check_guards(p);
    partition_oracle_check_surface(first, p);
    assert_true(fabs(volume_of_all(first) - volume_of_all(p)) < 1e-12);
}

/* Solids whose minimal number of pieces is known: the search finds it. */
static void test_cubes(void **state) {
    (void)state;
    static const int one[][3] = {{0, 0, 0}};
    static const int corner[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const int trough[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}};
    static const int apart[][3] = {{0, 0, 0}, {2, 0, 0}, {4, 4, 4}};
    static const int touch[][3] = {{0, 0, 0}, {1, 1, 1}}; /* at a vertex */
    static const int along[][3] = {{0, 0, 0}, {1, 1, 0}}; /* along an edge */
    static const int both[][3] = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 1}};
    static const int ring[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0},
                                  {2, 1, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}};
    static const struct {
        const int (*places)[3];
        size_t count, least, most;
    } solids[] = {{one, 1, 1, 1},   {corner, 4, 1, 1}, {trough, 5, 2, 2}, {apart, 3, 3, 3},
                  {touch, 2, 2, 2}, {ring, 8, 2, 4},   {along, 2, 2, 2},  {both, 5, 5, 8}};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof solids / sizeof *solids; i++) {
        partition first = cubes(context, solids[i].places, solids[i].count);
        partition p = partition_oracle_copy(&first);
        assert_true(start(&p, EVALUATIONS, false));
        check_bisected(&first, &p);
        assert_true(p.pieces.count >= solids[i].least && p.pieces.count <= solids[i].most);
        partition_free(&p);
        partition_free(&first);
    }
    test_context_free(context);
}

/* The sample as one piece, before and after; returns the number of regions that grow. */
static size_t bisect_sample(starg_context *context, const char *name, size_t target,
                            partition *first, partition *after) {
    *first = grown_sample(context, name, target);
    size_t regions = first->pieces.count;
    join_everything(first);
    *after = partition_oracle_copy(first);
    assert_true(start(after, EVALUATIONS, false));
    check_bisected(first, after);
    return regions;
}

static void check_sample(const char *name, size_t target, size_t *pieces, size_t *regions) {
    starg_context *one = test_context(1), *three = test_context(3);
    partition first, after, first_again, after_again;
    *regions += bisect_sample(one, name, target, &first, &after);
    *pieces += after.pieces.count;
    bisect_sample(three, name, target, &first_again, &after_again);
    assert_true(partition_oracle_same(&after, &after_again));
    partition_free(&first_again);
    partition_free(&after_again);
    partition_free(&first);
    partition_free(&after);
    test_context_free(three);
    test_context_free(one);
}

/* In all no more pieces than by region growing, and the same for any number of threads; some of the
 * lattice surfaces touch themselves. */
static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "torus", "gallery", "shell", "sphere"};
    size_t pieces = 0, regions = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        check_sample(names[i], 2000, &pieces, &regions);
    assert_true(pieces <= regions);
}

/* Random tetrahedra as one piece, including needles, holes, and edges and vertices where the
 * surface touches itself. Rounding may spoil one start, but not others. */
static void test_random_cells(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t spoilt = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        partition first = random_cells(context, seed, 6 + (size_t)seed / 2), p;
        join_everything(&first);
        for (uint64_t stream = 0;; stream++) {
            p = partition_oracle_copy(&first);
            if (start_stream(&p, stream, EVALUATIONS, true))
                break;
            partition_free(&p);
            spoilt++;
        }
        check_bisected(&first, &p);
        partition_free(&p);
        partition_free(&first);
    }
    assert_true(spoilt < 4);
    test_context_free(context);
}

static void check_certified(const partition *p) {
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        partition_triangles triangles = {0};
        test_ok(p->context, partition_gather(p, i, &triangles));
        assert_true(
            partition_certify(p, triangles.data, triangles.count / 3, p->pieces.data[i].guard));
        STARG_ARRAY_FREE(p->context, &triangles);
    }
}

/* A fin on a slab, also one thinner than the least room initially required for a guard; rounded
 * angles cannot be checked then. */
static void test_fins(void **state) {
    (void)state;
    static const int fin[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
    static const double widths[] = {1, 1e-6, 1e-9, 1e-10};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        partition first = boxes(context, fin, 4, widths[i]), p = partition_oracle_copy(&first);
        assert_true(start(&p, EVALUATIONS, true));
        check_certified(&p);
        partition_oracle_check(&p);
        if (widths[i] > 1e-8)
            check_bisected(&first, &p);
        assert_true(fabs(volume_of_all(&first) - volume_of_all(&p)) < 1e-12);
        partition_free(&p);
        partition_free(&first);
    }
    test_context_free(context);
}

/* So many facets that large pieces are examined by samples of them. */
static void test_large(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "torus", 15000);
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const kernel_faces surface = {starg_mesh_vertices(mesh), starg_mesh_faces(mesh),
                                  starg_mesh_face_count(mesh)};
    partition p;
    test_ok(context, partition_create_from_surface(context, &surface, NULL, &p));
    assert_true(surface.count > 25000);
    assert_true(start(&p, EVALUATIONS, false));
    assert_in_range(p.pieces.count, 2, 8);
    check_certified(&p);
    partition_free(&p);
    starg_solid_free(solid);
    test_context_free(context);
}

/* With too small a budget, or no time, there is no result, unless the call must finish. */
static void test_limits(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    partition all = grown_sample(context, "horse", 2000);
    join_everything(&all);
    for (int limited = 0; limited < 3; limited++)
        for (int to_the_end = 0; to_the_end < 2; to_the_end++) {
            partition p = partition_oracle_copy(&all);
            starg_context_set_time_limit(context, limited == 2 ? 1e-9 : 0);
            bool done = start(&p, limited == 1 ? 1 : EVALUATIONS, to_the_end == 1);
            assert_int_equal(done, limited == 0 || to_the_end == 1);
            if (done)
                check_bisected(&all, &p);
            partition_free(&p);
        }
    partition_free(&all);
    test_context_free(context);
}

/* No plane is found where all triangles are too thin to be any of the region's. */
static void test_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const double places[] = {0, 0, 0, 1, 1, 1, 2, 2, 2};
    static const uint32_t corners[] = {0, 1, 2, 2, 1, 0};
    const twin_frame frame = twin_frame_of(places, corners, 6);
    region_scratch scratch = {.context = context};
    region r = {.vertices = {0}};
    starg_rng rng = starg_rng_make(1, 2, 3);
    test_ok(context, twin_region(context, places, 3, corners, 6, &frame, &r));
    assert_int_equal(r.triangles.count, 0);
    for (int demand = SPLIT_PLANE_GAIN; demand <= SPLIT_PLANE_HALVE; demand++) {
        const split_plane_options options = {
            .margin = 1e-5, .effort = 1, .demand = (split_plane_demand)demand};
        partition_plane plane;
        bool found = true;
        test_ok(context, split_plane_find(&r, &options, &rng, &scratch, &plane, &found));
        assert_false(found);
    }
    region_free(&r);
    region_scratch_free(&scratch);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),         cmocka_unit_test(test_cavity),
        cmocka_unit_test(test_cuts_of_cubes), cmocka_unit_test(test_cubes),
        cmocka_unit_test(test_samples),       cmocka_unit_test(test_random_cells),
        cmocka_unit_test(test_fins),          cmocka_unit_test(test_large),
        cmocka_unit_test(test_limits),        cmocka_unit_test(test_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
