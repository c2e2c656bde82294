/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices within matter, against tetrahedra with small whole coordinates, in which integers decide
 * what is inside of what. */
#include "core/rng.h"
#include "mesh/solid.h"
#include "starguard/space.h"
#include "starguard/visibility.h"
#include "support.h"

enum { MOST = 4, ROUNDS = 1500 };

typedef struct crowd {
    int count;
    int64_t corners[MOST][4][3]; /* positively oriented */
} crowd;

/* Sign of the volume of a, b, c, d. */
static int side(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d) {
    int64_t m[3][3];
    for (int k = 0; k < 3; k++) {
        m[0][k] = b[k] - a[k];
        m[1][k] = c[k] - a[k];
        m[2][k] = d[k] - a[k];
    }
    int64_t volume = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                     m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                     m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    return (volume > 0) - (volume < 0);
}

/* 1 inside, 0 on the boundary, -1 outside. */
static int place_of(const int64_t *p, const int64_t t[4][3]) {
    const int least[4] = {side(p, t[1], t[2], t[3]), side(t[0], p, t[2], t[3]),
                          side(t[0], t[1], p, t[3]), side(t[0], t[1], t[2], p)};
    int place = 1;
    for (int k = 0; k < 4; k++)
        place = least[k] < place ? least[k] : place;
    return place;
}

static void make_crowd(starg_rng *rng, uint64_t width, crowd *c) {
    c->count = 2 + (int)starg_rng_below(rng, MOST - 1);
    for (int i = 0; i < c->count; i++) {
        int turn;
        do {
            for (int k = 0; k < 12; k++)
                c->corners[i][k / 3][k % 3] = (int64_t)starg_rng_below(rng, width);
            turn = side(c->corners[i][0], c->corners[i][1], c->corners[i][2], c->corners[i][3]);
        } while (turn == 0);
        for (int k = 0; k < 3 && turn < 0; k++) {
            int64_t swap = c->corners[i][0][k];
            c->corners[i][0][k] = c->corners[i][1][k];
            c->corners[i][1][k] = swap;
        }
    }
}

static starg_mesh *mesh_of(starg_context *context, const crowd *c, int first, int last) {
    static const uint32_t sides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    double vertices[12 * MOST];
    uint32_t faces[12 * MOST];
    starg_mesh *mesh = NULL;
    for (int i = first; i < last; i++)
        for (int k = 0; k < 12; k++) {
            vertices[12 * (i - first) + k] = (double)c->corners[i][k / 3][k % 3];
            faces[12 * (i - first) + k] = (uint32_t)(4 * (i - first)) + sides[k / 3][k % 3];
        }
    test_ok(context, starg_mesh_create(context, vertices, 4 * (size_t)(last - first), faces,
                                       4 * (size_t)(last - first), &mesh));
    return mesh;
}

/* Compares each vertex; in a room the first tetrahedron holds air, the others are matter in it. */
static void compare(const crowd *c, const starg_solid *scene, bool room, size_t counts[2]) {
    for (int i = 0; i < c->count; i++)
        for (int k = 0; k < 4; k++) {
            bool buried = false, touched = false;
            for (int j = 0; j < c->count; j++) {
                int place = j == i ? -1 : place_of(c->corners[i][k], c->corners[j]);
                touched |= place == 0;
                buried |= j != i && (room && j == 0 ? place < 0 : place > 0);
            }
            bool found = solid_buries(scene, (uint32_t)(4 * i + k));
            assert_true(!found || buried);
            assert_true(found || !buried || touched);
            counts[found]++;
        }
}

/* No face that is called hidden is seen whole from any of many places around it. */
static size_t look_around(starg_context *context, const starg_solid *scene, starg_rng *rng,
                          double width) {
    enum { PLACES = 60 };
    double places[3 * PLACES];
    size_t count = 0, hidden = 0;
    starg_bits *seen = NULL;
    starg_visibility_options whole;
    starg_visibility_options_default(&whole);
    whole.face_rule = STARG_FACES_WHOLE;
    for (int i = 0; i < PLACES; i++) {
        double *p = places + 3 * count;
        for (int k = 0; k < 3; k++)
            p[k] = width * (1.6 * starg_rng_unit(rng) - 0.3);
        count += starg_space_admits(scene, p);
    }
    if (count > 0)
        test_ok(context, starg_visibility(context, scene, places, count, &whole, &seen));
    for (uint32_t f = 0; f < starg_space_model_faces(scene); f++) {
        if (!solid_hides(scene, f))
            continue;
        hidden++;
        for (size_t i = 0; i < count; i++)
            assert_false(starg_bits_test(seen, i, f));
    }
    starg_bits_free(seen);
    return hidden;
}

static void vertices_in_matter(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(29, 0, 0);
    size_t counts[2][2] = {{0}}, hidden = 0;
    for (int round = 0; round < ROUNDS; round++) {
        crowd c;
        starg_space_options options;
        starg_solid *scene = NULL;
        bool room = round % 2 == 1;
        make_crowd(&rng, round % 4 < 2 ? 5 : 40, &c);
        starg_mesh *model = mesh_of(context, &c, 0, room ? 1 : c.count), *others[MOST] = {NULL};
        for (int i = 1; i < c.count && room; i++)
            others[i - 1] = mesh_of(context, &c, i, i + 1);
        starg_space_options_default(&options);
        options.orientation = STARG_ORIENTATION_KEEP;
        options.outside = !room;
        options.standoff_most = room ? 0 : 10;
        starg_status status = starg_space_create(context, model, (const starg_mesh *const *)others,
                                                 room ? (size_t)c.count - 1 : 0, &options, &scene);
        if (status == STARG_OK) {
            compare(&c, scene, room, counts[room]);
            hidden += look_around(context, scene, &rng, round % 4 < 2 ? 5 : 40);
        } else
            assert_true(room && status == STARG_ERROR_ARGUMENT); /* obstacles beyond the room */
        starg_solid_free(scene);
        starg_mesh_free(model);
        for (int i = 0; i < MOST; i++)
            starg_mesh_free(others[i]);
    }
    assert_true(hidden > 100);
    for (int i = 0; i < 4; i++)
        assert_true(counts[i / 2][i % 2] > 50);
    test_context_free(context);
}

/* Where a fold of a vertex's own faces, or nothing, surrounds it, nothing is claimed. */
static void plain_solids_bury_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    crowd c;
    starg_rng rng = starg_rng_make(30, 0, 0);
    for (int round = 0; round < 100; round++) {
        starg_solid *solid = NULL;
        make_crowd(&rng, 9, &c);
        starg_mesh *mesh = mesh_of(context, &c, 0, c.count);
        test_ok(context, starg_solid_create(context, mesh, &solid));
        for (uint32_t v = 0; v < 4 * (uint32_t)c.count; v++)
            assert_false(solid_buries(solid, v));
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(vertices_in_matter),
                                       cmocka_unit_test(plain_solids_bury_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
