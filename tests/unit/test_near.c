/* SPDX-License-Identifier: Apache-2.0 */
/* What lies on what (mesh/union/near.c), against all pairs in integers: faces about hubs, some of
 * which are fans and some not, and others upon them, with corners on a grid. Half of the scenes are
 * flat, with a distance of some steps of the grid: then narrow faces of a fan have corners upon one
 * another. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "mesh/topology.h"
#include "mesh/union/union.h"

enum { MOST = 512, GRID = 1000 };

typedef struct scene {
    int64_t at[3 * MOST][3]; /* by vertex */
    uint32_t faces[3 * MOST];
    size_t vertices, count;
    double distance;
} scene;

static uint32_t add_vertex(scene *s, int64_t x, int64_t y, int64_t z) {
    for (uint32_t v = 0; v < s->vertices; v++)
        if (s->at[v][0] == x && s->at[v][1] == y && s->at[v][2] == z)
            return v;
    s->at[s->vertices][0] = x;
    s->at[s->vertices][1] = y;
    s->at[s->vertices][2] = z;
    return (uint32_t)s->vertices++;
}

/* ---- integers ---- */

typedef struct vector {
    int64_t x[3];
} vector;

static vector from_to(const scene *s, uint32_t a, uint32_t b) {
    return (vector){
        {s->at[b][0] - s->at[a][0], s->at[b][1] - s->at[a][1], s->at[b][2] - s->at[a][2]}};
}

static vector cross(vector a, vector b) {
    return (vector){{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
                     a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

static int64_t dot(vector a, vector b) {
    return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

static vector normal_of(const scene *s, const uint32_t *f) {
    return cross(from_to(s, f[0], f[1]), from_to(s, f[0], f[2]));
}

static bool is_on(const scene *s, uint32_t a, uint32_t b, uint32_t v) {
    vector u = from_to(s, a, b), w = from_to(s, a, v), c = cross(u, w);
    return (double)dot(c, c) <= s->distance * s->distance * (double)dot(u, u) && dot(u, w) > 0 &&
           dot(u, w) < dot(u, u);
}

static bool is_inside(const scene *s, const uint32_t *f, uint32_t v) {
    vector n = normal_of(s, f);
    bool inside = dot(n, from_to(s, f[0], v)) == 0;
    for (int k = 0; k < 3; k++)
        inside = inside && !is_on(s, f[k], f[(k + 1) % 3], v) &&
                 dot(n, cross(from_to(s, f[k], f[(k + 1) % 3]), from_to(s, f[k], v))) > 0;
    return inside;
}

static bool in_one_plane(const scene *s, const uint32_t *f, const uint32_t *g) {
    vector n = normal_of(s, f);
    for (int k = 0; k < 3; k++)
        if (dot(n, from_to(s, f[0], g[k])) != 0)
            return false;
    return true;
}

static int side(const scene *s, vector n, uint32_t a, uint32_t b, uint32_t v) {
    int64_t x = dot(n, cross(from_to(s, a, b), from_to(s, a, v)));
    return (x > 0) - (x < 0);
}

static bool do_cross(const scene *s, vector n, const uint32_t *a, const uint32_t *b) {
    return side(s, n, a[0], a[1], b[0]) * side(s, n, a[0], a[1], b[1]) < 0 &&
           side(s, n, b[0], b[1], a[0]) * side(s, n, b[0], b[1], a[1]) < 0 &&
           !is_on(s, a[0], a[1], b[0]) && !is_on(s, a[0], a[1], b[1]) &&
           !is_on(s, b[0], b[1], a[0]) && !is_on(s, b[0], b[1], a[1]);
}

static bool keeps_apart(const scene *s, const uint32_t *f, const uint32_t *g) {
    vector n = normal_of(s, f);
    for (int k = 0; k < 3; k++) {
        bool apart = true;
        vector u = from_to(s, f[k], f[(k + 1) % 3]), inwards = cross(n, u);
        double limit = s->distance * sqrt((double)dot(n, n) * (double)dot(u, u));
        for (int i = 0; i < 3; i++)
            apart = apart && (double)dot(inwards, from_to(s, f[k], g[i])) <= limit;
        if (apart)
            return true;
    }
    return false;
}

/* ---- scenes ---- */

static void add_face(scene *s, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t f[3] = {a, b, c};
    vector n = normal_of(s, f);
    if (dot(n, n) == 0 || s->count == MOST)
        return;
    for (int k = 0; k < 3; k++)
        s->faces[3 * s->count + (size_t)k] = f[k];
    s->count++;
}

static int64_t whole(starg_rng *rng, int64_t most) {
    return (int64_t)starg_rng_below(rng, (uint64_t)(2 * most + 1)) - most;
}

static int compare_angles(const void *left, const void *right) {
    const int64_t *a = left, *b = right;
    double x = atan2((double)a[1], (double)a[0]), y = atan2((double)b[1], (double)b[0]);
    return (x > y) - (x < y);
}

/* Faces about a hub: in the order of their directions (a fan, as a rule), or without order. Even
 * corners, so that spokes have grid points on them. */
static void add_hub(scene *s, starg_rng *rng, size_t count, bool sorted, int64_t height) {
    int64_t rim[128][2];
    uint32_t hub = add_vertex(s, 0, 0, height);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            rim[i][k] = 2 * whole(rng, GRID / 2);
    if (sorted)
        qsort(rim, count, sizeof *rim, compare_angles);
    for (size_t i = 0; i + (sorted ? starg_rng_below(rng, 2) : 1) < count; i++)
        add_face(s, hub, add_vertex(s, rim[i][0], rim[i][1], 0),
                 add_vertex(s, rim[(i + 1) % count][0], rim[(i + 1) % count][1], 0));
}

/* Faces with corners in the middle of edges, or anywhere in the plane or off it. */
static void add_others(scene *s, starg_rng *rng, size_t count, bool flat) {
    for (size_t i = 0; i < count; i++) {
        uint32_t corner[3];
        for (int k = 0; k < 3; k++) {
            size_t h = starg_rng_below(rng, 3 * s->count);
            const int64_t *a = s->at[s->faces[h]], *b = s->at[s->faces[h - h % 3 + (h + 1) % 3]];
            bool upon = starg_rng_below(rng, 2) == 0;
            corner[k] =
                upon ? add_vertex(s, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2)
                     : add_vertex(s, whole(rng, GRID), whole(rng, GRID),
                                  !flat && starg_rng_below(rng, 3) == 0 ? whole(rng, GRID) : 0);
        }
        add_face(s, corner[0], corner[1], corner[2]);
    }
}

/* ---- comparison ---- */

static bool has_crossing(const near_facts *found, uint32_t a, uint32_t b) {
    for (size_t i = 0; i < found->crossing.count; i++)
        if (found->crossing.data[i].edge[0] == (a < b ? a : b) &&
            found->crossing.data[i].edge[1] == (a < b ? b : a))
            return true;
    return false;
}

static void compare_vertices(const scene *s, const near_facts *found, size_t *facts) {
    size_t on = 0, in = 0;
    for (uint32_t v = 0; v < s->vertices; v++) {
        bool used = false;
        for (size_t i = 0; i < 3 * s->count; i++)
            used = used || s->faces[i] == v;
        for (size_t e = 0; used && e < found->edge_count; e++)
            on += is_on(s, found->ends[2 * e], found->ends[2 * e + 1], v);
        for (size_t f = 0; used && f < s->count; f++)
            in += is_inside(s, s->faces + 3 * f, v);
    }
    for (size_t i = 0; i < found->on.count; i++) {
        const near_on_edge *own = &found->on.data[i];
        assert_true(
            is_on(s, found->ends[2 * own->edge], found->ends[2 * own->edge + 1], own->vertex));
    }
    for (size_t i = 0; i < found->in.count; i++)
        assert_true(is_inside(s, s->faces + 3 * found->in.data[i].face, found->in.data[i].vertex));
    assert_int_equal(found->on.count, on);
    assert_int_equal(found->in.count, in);
    *facts += on + in;
}

static void compare_faces(const scene *s, const near_facts *found, size_t *facts) {
    uint32_t sheet[MOST];
    sets_make(sheet, s->count);
    for (uint32_t f = 0; f < s->count; f++)
        for (uint32_t g = f + 1; g < s->count; g++) {
            const uint32_t *a = s->faces + 3 * f, *b = s->faces + 3 * g;
            if (!in_one_plane(s, a, b))
                continue;
            int common = 0;
            for (int i = 0; i < 9; i++)
                common += a[i / 3] == b[i % 3];
            if (common < 3 && !keeps_apart(s, a, b) && !keeps_apart(s, b, a))
                sets_join(sheet, f, g);
            for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
                for (uint32_t k = 3 * g; k < 3 * g + 3; k++) {
                    uint32_t e = found->edge[h], d = found->edge[k];
                    bool meet = e != d && do_cross(s, normal_of(s, a), found->ends + 2 * e,
                                                   found->ends + 2 * d);
                    *facts += meet;
                    assert_int_equal(meet, has_crossing(found, e, d));
                }
        }
    for (uint32_t f = 0; f < s->count; f++)
        for (uint32_t g = 0; g < f; g++)
            assert_int_equal(sets_find(sheet, f) == sets_find(sheet, g),
                             sets_find(found->sheet, f) == sets_find(found->sheet, g));
}

static void test_hubs(void **state) {
    (void)state;
    size_t facts = 0;
    for (uint64_t seed = 0; seed < test_rounds(60, 600); seed++) {
        static scene s;
        starg_context *context = test_context(1);
        starg_rng rng = starg_rng_make(13, 1, seed);
        double place[9 * MOST];
        near_facts found;
        bool flat = seed % 2 == 0;
        s.vertices = s.count = 0;
        s.distance = flat ? 0.37 + (double)(seed % 16) : 0; /* no tie on the grid */
        add_hub(&s, &rng, 20 + starg_rng_below(&rng, 60), seed % 3 != 0, seed % 4 == 1 ? 300 : 0);
        add_others(&s, &rng, starg_rng_below(&rng, 12), flat);
        if (seed % 5 == 0)
            add_hub(&s, &rng, 40, true, 0);
        for (size_t i = 0; i < 3 * s.vertices; i++)
            place[i] = (double)s.at[i / 3][i % 3] / GRID;
        test_ok(context, near_find(context, place, s.faces, s.count, fmax(1e-12, s.distance / GRID),
                                   &found));
        assert_false(found.full);
        compare_vertices(&s, &found, &facts);
        compare_faces(&s, &found, &facts);
        near_free(&found);
        test_context_free(context);
    }
    assert_true(facts > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hubs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
