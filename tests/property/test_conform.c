/* SPDX-License-Identifier: Apache-2.0 */
/* Conforming samples of surfaces with cracks, spikes and fins, against slow counts: the result is a
 * closed surface of the same topology, and exactly as many of its faces are lost as reported. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "mesh/solid.h"
#include "models.h"
#include "skeleton/skeleton.h"

typedef struct face_key {
    uint32_t v[3];
} face_key;

static int compare(const void *left, const void *right) {
    return memcmp(left, right, sizeof(face_key));
}

static face_key key_of(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    uint32_t least = c < low ? c : low, most = c > high ? c : high;
    return (face_key){{least, a ^ b ^ c ^ least ^ most, most}};
}

/* Every halfedge has exactly one opposite. */
static void check_closed(const surface_samples *s) {
    size_t count = 3 * s->face_count;
    face_key *halves = malloc(count * sizeof *halves);
    assert_non_null(halves);
    for (size_t h = 0; h < count; h++)
        halves[h] = (face_key){{s->faces[h], s->faces[h % 3 == 2 ? h - 2 : h + 1], 0}};
    qsort(halves, count, sizeof *halves, compare);
    for (size_t h = 0; h < count; h++) {
        const face_key back = {{halves[h].v[1], halves[h].v[0], 0}};
        assert_true(h == 0 || compare(&halves[h - 1], &halves[h]) != 0);
        assert_non_null(bsearch(&back, halves, count, sizeof back, compare));
    }
    free(halves);
}

static size_t count_lost(const conformed *result) {
    const delaunay *d = result->tetrahedra;
    const surface_samples *s = &result->samples;
    face_key *keys = malloc((4 * d->count + 1) * sizeof *keys);
    size_t lost = 0;
    assert_non_null(keys);
    for (size_t t = 0; t < d->count; t++)
        for (int k = 0; k < 4; k++) {
            const uint32_t *v = d->tetrahedra[t];
            keys[4 * t + (size_t)k] = key_of(v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4]);
        }
    qsort(keys, 4 * d->count, sizeof *keys, compare);
    for (size_t f = 0; f < s->face_count; f++) {
        const uint32_t *v = s->faces + 3 * f;
        const face_key key = key_of(v[0], v[1], v[2]);
        lost += bsearch(&key, keys, 4 * d->count, sizeof key, compare) == NULL;
    }
    free(keys);
    return lost;
}

/* Returns the number of results; *lost is the least number of lost faces. */
static size_t conform(const shape *s, size_t wanted, size_t *lost) {
    starg_context *context = test_context(1);
    starg_solid *solid = test_solid_of(context, s);
    surface_samples samples = {0};
    conformed results[CONFORM_RESULTS];
    size_t count;
    test_ok(context, samples_create(context, solid, wanted, false, &samples));
    size_t first = samples.point_count, faces = samples.face_count;
    double *points = malloc(3 * first * sizeof *points);
    assert_non_null(points);
    memcpy(points, samples.points, 3 * first * sizeof *points);
    test_ok(context, conform_samples(context, &samples, results, &count));
    assert_in_range(count, 1, CONFORM_RESULTS);
    *lost = results[0].lost;
    for (size_t i = 0; i < count; i++) {
        const conformed *r = &results[i];
        check_closed(&r->samples);
        assert_int_equal(r->samples.face_count - faces, 2 * (r->samples.point_count - first));
        assert_memory_equal(r->samples.points, points, 3 * first * sizeof *points);
        assert_int_equal(r->lost, count_lost(r));
        assert_true(i == 0 || (r->lost >= results[i - 1].lost && r->lost > 0));
    }
    for (size_t i = 0; i < CONFORM_RESULTS; i++)
        conformed_free(&results[i]);
    free(points);
    starg_solid_free(solid);
    test_context_free(context);
    return count;
}

/* Star-shaped about the origin, hence embedded, but full of spikes and clefts. */
static shape spiky(int levels, uint64_t seed, double spread) {
    shape s = shape_blob(levels, seed);
    starg_rng rng = starg_rng_make(11, 1, seed);
    for (size_t v = 0; v < s.vertex_count; v++) {
        double factor = exp(spread * (2 * starg_rng_unit(&rng) - 1));
        for (size_t k = 0; k < 3; k++)
            s.vertices[3 * v + k] *= factor;
    }
    return s;
}

static void test_spikes(void **state) {
    (void)state;
    size_t conforming = 0, cases = test_rounds(32, 200), several = 0;
    for (uint64_t seed = 0; seed < cases; seed++) {
        shape s = spiky(2 + (int)(seed % 2), seed, 0.4 * (double)(seed % 4));
        size_t lost;
        several += conform(&s, 300, &lost) > 1;
        conforming += lost == 0;
        shape_free(&s);
    }
    assert_true(2 * conforming >= cases);
    assert_true(several > 0);
}

/* Two boxes with almost no gap between them. */
static void test_cracks(void **state) {
    (void)state;
    for (int power = 1; power < 14; power++) {
        shape s = shape_cube(3), other = shape_cube(2);
        const double offset[3] = {0.25, 0.5, 3 + pow(10, -power)};
        size_t lost;
        shape_append(&s, &other, offset, 0);
        conform(&s, 500, &lost);
        assert_int_equal(lost, 0);
        shape_free(&other);
        shape_free(&s);
    }
}

/* Lattice faces are already Delaunay in their planes. */
static void test_cells(void **state) {
    (void)state;
    shape shapes[] = {shape_cube(1), shape_cube(4), shape_columns(), shape_cavity()};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        size_t lost;
        assert_int_equal(conform(&shapes[i], 300, &lost), 1);
        assert_int_equal(lost, 0);
        shape_free(&shapes[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_spikes), cmocka_unit_test(test_cracks),
                                       cmocka_unit_test(test_cells)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
