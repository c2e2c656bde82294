/* SPDX-License-Identifier: Apache-2.0 */
/* Stages after the search. Room for guards: partitions stay partitions with as many pieces
 * (partition_oracle.h, in rationals), and what margins and angles lack in all, by definition, does
 * not grow. Refined caps: likewise, with the same guards and outer facets, and fewer small angles.
 * Tetrahedra made less flat: likewise, with the surface of the model and room for guards. */
#include "support.h"

#include <math.h>
#include <string.h>

#include "models.h"
#include "partition_oracle.h"
#include "star/certified/search.h"

static const uint64_t WORK = 40000000;

/* In degrees, by the angle between the parts of two edges that are normal to a third. */
static double dihedral_angle(const double *a, const double *b, const double *c, const double *d) {
    double along[3], part[2][3], length = 0, norm[2] = {0, 0}, dot = 0;
    for (int k = 0; k < 3; k++) {
        along[k] = b[k] - a[k];
        length += along[k] * along[k];
    }
    for (int i = 0; i < 2; i++) {
        const double *to = i == 0 ? c : d;
        double share = 0;
        for (int k = 0; k < 3; k++)
            share += (to[k] - a[k]) * along[k] / length;
        for (int k = 0; k < 3; k++) {
            part[i][k] = to[k] - a[k] - share * along[k];
            norm[i] += part[i][k] * part[i][k];
        }
    }
    for (int k = 0; k < 3; k++)
        dot += part[0][k] * part[1][k] / sqrt(norm[0] * norm[1]);
    return acos(fmax(-1, fmin(1, dot))) * 57.29577951308232;
}

static double smallest_angle_of(const double *const corners[4]) {
    double least = 180;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++) {
            int k = 0, l = 3;
            while (k == i || k == j)
                k++;
            while (l == i || l == j)
                l--;
            least = fmin(least, dihedral_angle(corners[i], corners[j], corners[k], corners[l]));
        }
    return least;
}

/* The radius by the diagonal of a piece, by brute force. */
static double margin_of(const partition *p, uint32_t number) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    double squared = 0;
    for (size_t f = 0; f < p->facets.count; f++)
        for (int c = 0; c < 6; c++) {
            const double *at = partition_unit(p, p->facets.data[f].corners[c % 3]);
            for (int k = 0; k < 3 && p->facets.data[f].side[c / 3] == number; k++) {
                lower[k] = fmin(lower[k], at[k]);
                upper[k] = fmax(upper[k], at[k]);
            }
        }
    for (int k = 0; k < 3; k++)
        squared += (upper[k] - lower[k]) * (upper[k] - lower[k]);
    return p->pieces.data[number].radius / sqrt(squared);
}

static double smallest_margin(const partition *p) {
    double least = INFINITY;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        least = fmin(least, margin_of(p, i));
    return least;
}

/* On a side of a facet. */
static double angle_of(const partition *p, const facet *f, int side) {
    const double *const corners[4] = {
        partition_point(p, f->corners[0]), partition_point(p, f->corners[1]),
        partition_point(p, f->corners[2]), p->pieces.data[f->side[side]].guard};
    return smallest_angle_of(corners);
}

/* What the angles of a piece lack, by definition. */
static double lack_of_angles(const partition *p, uint32_t number) {
    double sum = 0;
    for (size_t i = 0; i < p->facets.count; i++)
        for (int side = 0; side < 2; side++)
            if (p->facets.data[i].side[side] == number)
                sum += pow(fmax(0, 1 - angle_of(p, &p->facets.data[i], side) / 0.2), 2);
    return sum;
}

/* The margin likewise: ten times ten angles. */
static double lack_of(const partition *p, uint32_t number) {
    return 100 * fmax(0, 1 - margin_of(p, number) / 2e-3) + lack_of_angles(p, number);
}

static double lack_of_all(const partition *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        double lack = lack_of(p, i);
        assert_true(fabs(lack - flatness_of_piece(p, i)) < 1e-6 * (1 + lack));
        sum += lack;
    }
    assert_true(fabs(sum - flatness_of_first(p, p->pieces.count)) < 1e-6 * (1 + sum));
    return sum;
}

/* `first` (may be NULL) gets it as it was before the search. */
static partition searched_sample(starg_context *context, const char *name, partition *first) {
    partition p = grown_sample(context, name, 3000);
    const improve_options options = {.trials = 200, .work = UINT64_MAX, .enough = 1};
    improve_report report;
    if (first != NULL)
        *first = partition_oracle_copy(&p);
    test_ok(context, improve(&p, &options, &report));
    return p;
}

static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "gallery", "labyrinth", "knot", "star"};
    size_t wider = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_context *context = test_context(2);
        partition first, p = searched_sample(context, names[i], &first);
        size_t count = p.pieces.count;
        double margin = smallest_margin(&p), lacked = lack_of_all(&p), lack = lacked;
        for (double before = lack; before >= 0; before = lack < before - 1e-6 ? lack : -1) {
            test_ok(context, widen(&p, WORK));
            lack = lack_of_all(&p);
            assert_true(lack <= before + 1e-6);
        }
        partition_oracle_check(&p);
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        assert_int_equal(p.pieces.count, count);
        print_message("%s: %zu pieces, smallest margin %.2g, then %.2g; lack %.3g, then %.3g\n",
                      names[i], count, margin, smallest_margin(&p), lacked, lack);
        wider += smallest_margin(&p) > 1.2 * margin;
        partition_free(&first);
        partition_free(&p);
        test_context_free(context);
    }
    assert_true(wider >= 2);
}

/* Whatever the number of threads; and nothing without work. */
static void test_same(void **state) {
    (void)state;
    starg_context *one = test_context(1), *five = test_context(5);
    partition a = searched_sample(one, "gallery", NULL), b = searched_sample(five, "gallery", NULL);
    partition still = partition_oracle_copy(&a);
    test_ok(one, widen(&still, 0));
    assert_true(partition_oracle_same(&a, &still));
    test_ok(one, widen(&a, WORK));
    test_ok(five, widen(&b, WORK));
    assert_true(partition_oracle_same(&a, &b));
    assert_false(partition_oracle_same(&a, &still));
    partition_free(&a);
    partition_free(&b);
    partition_free(&still);
    test_context_free(one);
    test_context_free(five);
}

/* ---- caps ---- */

/* Tetrahedra on facets between pieces with an angle of less than a fifth of a degree; outer facets.
 */
static size_t count_small(const partition *p, size_t *outer) {
    size_t count = 0;
    *outer = 0;
    for (size_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        *outer += f->side[FACET_OUTER] == PARTITION_OUTSIDE;
        for (int side = 0; side < 2 && f->side[FACET_OUTER] != PARTITION_OUTSIDE; side++) {
            count += angle_of(p, f, side) < 0.2;
        }
    }
    return count;
}

/* Cut by planes, with guards in the middle. */
static partition cut_sample(starg_context *context, const char *name, partition *first) {
    starg_solid *solid = test_sample(context, name, 2000);
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const kernel_faces surface = {starg_mesh_vertices(mesh), starg_mesh_faces(mesh),
                                  starg_mesh_face_count(mesh)};
    const bsp_options options = {.to_the_end = true};
    bsp_report report;
    partition p;
    test_ok(context, partition_create_from_surface(context, &surface, NULL, &p));
    *first = partition_oracle_copy(&p);
    test_ok(context, bsp_start(&p, &options, &report));
    assert_true(report.done);
    starg_solid_free(solid);
    return p;
}

static void test_caps(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "dinosaur", "octopus"};
    size_t sum[2] = {0, 0}, outer[2];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_context *context = test_context(1);
        partition first, p = cut_sample(context, names[i], &first);
        partition before = partition_oracle_copy(&p);
        test_ok(context, refine_caps(&p));
        partition_oracle_check(&p);
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        assert_int_equal(p.pieces.count, before.pieces.count);
        assert_memory_equal(p.pieces.data, before.pieces.data,
                            p.pieces.count * sizeof *p.pieces.data);
        size_t had = count_small(&before, &outer[0]), has = count_small(&p, &outer[1]);
        print_message("%s: %zu tetrahedra with small angles, then %zu; %zu facets, then %zu\n",
                      names[i], had, has, before.facets.count, p.facets.count);
        assert_int_equal(outer[0], outer[1]);
        assert_true(has <= had);
        sum[0] += had;
        sum[1] += has;
        partition_free(&first);
        partition_free(&before);
        partition_free(&p);
        test_context_free(context);
    }
    assert_true(sum[0] >= 4 && 2 * sum[1] <= sum[0]);
}

/* ---- less flat tetrahedra ---- */

static double lack_of_all_angles(const partition *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        sum += lack_of_angles(p, i);
    return sum;
}

static double smallest_angle(const partition *p) {
    double least = 180;
    for (size_t i = 0; i < p->facets.count; i++)
        for (int side = 0; side < 2; side++)
            if (p->facets.data[i].side[side] != PARTITION_OUTSIDE)
                least = fmin(least, angle_of(p, &p->facets.data[i], side));
    return least;
}

static void check_room(const partition *before, const partition *p) {
    for (uint32_t i = 0; i < p->pieces.count; i++)
        assert_true(margin_of(p, i) > 1e-3 ||
                    p->pieces.data[i].radius > 0.999 * before->pieces.data[i].radius);
}

static void test_reshape(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "dinosaur", "octopus", "gallery", "bust"};
    double sum[2] = {0, 0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_context *context = test_context(1);
        partition first, p = cut_sample(context, names[i], &first);
        partition before = partition_oracle_copy(&p);
        const double had = lack_of_all_angles(&p), angle = smallest_angle(&p);
        test_ok(context, reshape(&p, UINT64_MAX));
        const double has = lack_of_all_angles(&p);
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        assert_int_equal(p.pieces.count, before.pieces.count);
        check_room(&before, &p);
        print_message("%s: %zu pieces, angles lack %.3g, then %.3g, the smallest %.2g, then %.2g; "
                      "%zu facets, then %zu\n",
                      names[i], p.pieces.count, had, has, angle, smallest_angle(&p),
                      before.facets.count, p.facets.count);
        assert_true(has <= had);
        assert_true(smallest_angle(&p) >= angle * 0.999);
        sum[0] += had;
        sum[1] += has;
        partition_free(&first);
        partition_free(&before);
        partition_free(&p);
        test_context_free(context);
    }
    assert_true(sum[0] > 10 && 3 * sum[1] < sum[0]);
}

/* Delaunay tetrahedra, each a piece of its own: many are flat, and edges have many facets. All
 * vertices may move. */
static void test_reshape_cells(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double sum[2] = {0, 0};
    for (uint64_t seed = 0; seed < 40; seed++) {
        partition p = random_cells(context, seed, 10 + 2 * (size_t)seed);
        p.first_points = 0;
        partition first = partition_oracle_copy(&p);
        sum[0] += lack_of_all_angles(&p);
        test_ok(context, reshape(&p, UINT64_MAX));
        sum[1] += lack_of_all_angles(&p);
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        assert_int_equal(p.pieces.count, first.pieces.count);
        partition_free(&p);
        partition_free(&first);
    }
    print_message("cells: angles lack %.3g, then %.3g\n", sum[0], sum[1]);
    assert_true(sum[1] < sum[0]);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_samples), cmocka_unit_test(test_same),
                                       cmocka_unit_test(test_caps), cmocka_unit_test(test_reshape),
                                       cmocka_unit_test(test_reshape_cells)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
