/* SPDX-License-Identifier: Apache-2.0 */
/* Unions of intersecting surfaces: inside tests before and after and intersections, by rationals;
 * preserved faces. Volumes of unions of boxes are counted cell by cell. */
#include "starguard/repair.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "mesh/solid.h"
#include "models.h"
#include "starguard/check.h"
#include "support.h"

enum { POINTS = 60, PAIRS_LIMIT = 400, MOST_FACES = 6000 };

/* ---- a union and its properties ---- */

typedef struct united {
    starg_context *context;
    starg_solid *input; /* the given mesh, with oriented shells */
    starg_mesh *mesh;
    starg_repair_report report;
} united;

static size_t count_of(const starg_check *check, starg_finding_kind kind) {
    return check->findings[kind].count;
}

static starg_status unite(starg_context *context, const starg_mesh *mesh, starg_mesh **out,
                          starg_repair_report *report) {
    starg_repair_options options;
    starg_repair_options_default(&options);
    options.unite = true;
    return starg_mesh_repair(context, mesh, &options, out, report);
}

static int winding(const starg_mesh *mesh, const double p[3], bool *on_surface) {
    return oracle_winding(starg_mesh_vertices(mesh), starg_mesh_faces(mesh),
                          starg_mesh_face_count(mesh), p, on_surface);
}

static const double *corner_of(const starg_mesh *mesh, size_t face, size_t k) {
    return starg_mesh_vertices(mesh) + 3 * (size_t)starg_mesh_faces(mesh)[3 * face + k];
}

/* Anywhere in the bounds, or close to a face of the input. */
static void pick_point(const starg_mesh *mesh, starg_rng *rng, double p[3]) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    size_t face = (size_t)starg_rng_below(rng, starg_mesh_face_count(mesh));
    double near = starg_rng_below(rng, 2) == 0 ? 1 : 0.01 * starg_rng_unit(rng);
    for (int k = 0; k < 3; k++) {
        double center = (corner_of(mesh, face, 0)[k] + corner_of(mesh, face, 1)[k] +
                         corner_of(mesh, face, 2)[k]) /
                        3;
        double any = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(rng);
        p[k] = center + near * (any - center);
    }
}

/* Winding number at least 1 before exactly where it is 1 after, and elsewhere 0 after. */
static void expect_same_inside(const united *u, const char *name) {
    const starg_mesh *before = starg_solid_mesh(u->input);
    starg_rng rng = starg_rng_make(1, starg_mesh_face_count(before), 0);
    size_t points = POINTS * 1000 / (1000 + starg_mesh_face_count(before));
    for (size_t i = 0; i < points; i++) {
        double p[3];
        bool on_before, on_after;
        pick_point(before, &rng, p);
        int old = winding(before, p, &on_before), new = winding(u->mesh, p, &on_after);
        if (on_before || on_after)
            continue;
        if (new != (old >= 1))
            fail_msg("%s: (%.17g, %.17g, %.17g) is wound about %d times, by the union %d times",
                     name, p[0], p[1], p[2], old, new);
    }
}

/* The corners of two faces, common ones first; returns their number. */
static int align(const starg_mesh *mesh, size_t a, size_t b, const double *s[3],
                 const double *t[3]) {
    int shared = 0;
    for (size_t k = 0; k < 3; k++) {
        s[k] = corner_of(mesh, a, k);
        t[k] = corner_of(mesh, b, k);
    }
    for (int i = 0; i < 3; i++)
        for (int j = shared; j < 3; j++) {
            if (memcmp(s[i], t[j], 3 * sizeof(double)) != 0)
                continue;
            const double *swap = s[i];
            s[i] = s[shared];
            s[shared] = swap;
            swap = t[j];
            t[j] = t[shared];
            t[shared++] = swap;
            break;
        }
    return shared;
}

static bool boxes_apart(const double *const s[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        double low = fmin(s[0][k], fmin(s[1][k], s[2][k]));
        double high = fmax(s[0][k], fmax(s[1][k], s[2][k]));
        if (high < fmin(t[0][k], fmin(t[1][k], t[2][k])) ||
            low > fmax(t[0][k], fmax(t[1][k], t[2][k])))
            return true;
    }
    return false;
}

/* Does a face meet another one away from coincident corners? Duplicates do. */
static bool meets(const starg_mesh *mesh, size_t a, size_t b) {
    const double *s[3], *t[3];
    int shared = align(mesh, a, b, s, t);
    return !boxes_apart(s, t) && (shared == 3 || oracle_triangles_contact(s, t, shared));
}

static bool meets_any(const starg_mesh *mesh, size_t face) {
    for (size_t other = 0; other < starg_mesh_face_count(mesh); other++)
        if (other != face && meets(mesh, face, other))
            return true;
    return false;
}

/* Is this face in the mesh, starting at any corner, bit by bit? */
static bool has_face(const starg_mesh *mesh, const double *const corner[3]) {
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++)
        for (size_t turn = 0; turn < 3; turn++) {
            bool same = true;
            for (size_t k = 0; k < 3 && same; k++)
                same =
                    memcmp(corner_of(mesh, f, (k + turn) % 3), corner[k], 3 * sizeof(double)) == 0;
            if (same)
                return true;
        }
    return false;
}

/* No two faces meet; input faces that meet no other are preserved, or lie inside. */
static void expect_faces(const united *u, const char *name) {
    const starg_mesh *before = starg_solid_mesh(u->input);
    size_t kept = 0, old = starg_mesh_face_count(before), new = starg_mesh_face_count(u->mesh);
    for (size_t a = 0; a < new &&new <= PAIRS_LIMIT; a++)
        if (meets_any(u->mesh, a))
            fail_msg("%s: face %zu of the union meets another one", name, a);
    for (size_t f = 0; f < old && old <= PAIRS_LIMIT; f++) {
        const double *corner[3] = {corner_of(before, f, 0), corner_of(before, f, 1),
                                   corner_of(before, f, 2)};
        bool there = has_face(u->mesh, corner), within;
        kept += there;
        if (there || meets_any(before, f))
            continue;
        double center[3];
        for (int k = 0; k < 3; k++)
            center[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
        int about = winding(u->mesh, center, &within);
        if (about != 1 && !within)
            fail_msg("%s: face %zu meets no other, and is not there", name, f);
    }
    size_t reported = u->report.faces_dropped > old ? 0 : old - u->report.faces_dropped;
    if (old <= PAIRS_LIMIT && reported > kept)
        fail_msg("%s: %zu faces are told to stay, and %zu do", name, reported, kept);
}

static void expect_solid(const united *u, const char *name) {
    starg_check *check;
    test_ok(u->context, starg_mesh_check(u->context, u->mesh, &check));
    if (!check->usable || count_of(check, STARG_FINDING_SELF_INTERSECTION) > 0 ||
        count_of(check, STARG_FINDING_DEGENERATE_FACE) > 0 ||
        count_of(check, STARG_FINDING_INWARD_COMPONENT) > 0)
        fail_msg("%s: the union is no solid, or intersects itself", name);
    starg_check_free(u->context, check);
}

/* Unites a mesh (freed), and asserts all of the above. */
static united unite_facing(starg_context *context, starg_mesh *mesh, shell_facing facing,
                           const char *name) {
    united u = {.context = context};
    test_ok(context, solid_make_facing(context, mesh, facing, &u.input));
    test_ok(context, unite(context, mesh, &u.mesh, &u.report));
    starg_mesh_free(mesh);
    assert_true(u.report.rounding < 1e-12);
    expect_solid(&u, name);
    expect_same_inside(&u, name);
    expect_faces(&u, name);
    return u;
}

static united unite_mesh(starg_context *context, starg_mesh *mesh, const char *name) {
    return unite_facing(context, mesh, SHELLS_NESTED, name);
}

static united unite_shape(starg_context *context, shape *s, const char *name) {
    starg_mesh *mesh = test_mesh_of(context, s);
    shape_free(s);
    return unite_mesh(context, mesh, name);
}

static void united_free(united *u) {
    starg_solid_free(u->input);
    starg_mesh_free(u->mesh);
}

/* ---- boxes ---- */

enum { SIDE = 6 };

static shape box_of(const int low[3], const int high[3]) {
    shape s = shape_cube(1);
    for (size_t v = 0; v < s.vertex_count; v++)
        for (size_t k = 0; k < 3; k++)
            s.vertices[3 * v + k] = s.vertices[3 * v + k] > 0 ? high[k] : low[k];
    return s;
}

static void random_box(starg_rng *rng, int low[3], int high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = (int)starg_rng_below(rng, SIDE);
        high[k] = low[k] + 1 + (int)starg_rng_below(rng, (uint64_t)(SIDE - low[k]));
    }
}

/* Cells with a winding number of 1 or more. Boxes within others that they do not meet are cavities,
 * or solid again within those: the solid has reversed their shells. */
static double count_volume(const united *u) {
    const starg_mesh *mesh = starg_solid_mesh(u->input);
    double volume = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double p[3] = {i % SIDE + 0.5, i / SIDE % SIDE + 0.5, i / SIDE / SIDE + 0.5};
        bool on_surface;
        volume += winding(mesh, p, &on_surface) >= 1;
    }
    return volume;
}

static void volumes_of_boxes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t rounds = test_rounds(3, 1000);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(2, 0, round);
        size_t count = 2 + (size_t)starg_rng_below(&rng, 5);
        const double nowhere[3] = {0, 0, 0};
        shape all = {0};
        char name[64];
        snprintf(name, sizeof name, "%zu boxes, round %d", count, (int)round);
        for (size_t i = 0; i < count; i++) {
            int low[3], high[3];
            random_box(&rng, low, high);
            shape box = box_of(low, high);
            shape_append(&all, &box, nowhere, 0);
            shape_free(&box);
        }
        starg_mesh *mesh = test_mesh_of(context, &all);
        shape_free(&all);
        /* a box within another one is swallowed */
        united u = unite_facing(context, mesh, SHELLS_AS_GIVEN, name);
        double volume = starg_mesh_volume(u.mesh), counted = count_volume(&u);
        if (fabs(volume - counted) > 1e-9)
            fail_msg("%s: volume %g instead of %g", name, volume, counted);
        united_free(&u);
    }
    test_context_free(context);
}

/* Inclusion and exclusion for two boxes that cross. */
static void volume_of_two_boxes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < test_size(10, 20); round++) {
        starg_rng rng = starg_rng_make(3, 0, round);
        shape all = shape_cube(1), other = shape_cube(1);
        double offset[3], common = 1;
        for (int k = 0; k < 3; k++) {
            offset[k] = 1.8 * starg_rng_unit(&rng) - 0.9;
            common *= 1 - fabs(offset[k]);
        }
        shape_append(&all, &other, offset, 0);
        shape_free(&other);
        united u = unite_shape(context, &all, "two boxes");
        assert_true(fabs(starg_mesh_volume(u.mesh) - (2 - common)) < 1e-12);
        assert_int_equal(u.report.union_rounds, 1);
        united_free(&u);
    }
    test_context_free(context);
}

/* ---- other soups ---- */

static void rotate(shape *s, starg_rng *rng, double scale) {
    double axis[3], angle = 6 * starg_rng_unit(rng), length = 0;
    for (int k = 0; k < 3; k++) {
        axis[k] = 2 * starg_rng_unit(rng) - 1;
        length += axis[k] * axis[k];
    }
    for (int k = 0; k < 3; k++)
        axis[k] /= sqrt(length);
    for (size_t v = 0; v < s->vertex_count; v++) {
        double *p = s->vertices + 3 * v, q[3], dot = 0;
        for (int k = 0; k < 3; k++)
            dot += axis[k] * p[k];
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            q[k] = cos(angle) * p[k] + sin(angle) * (axis[i] * p[j] - axis[j] * p[i]) +
                   (1 - cos(angle)) * dot * axis[k];
        }
        for (int k = 0; k < 3; k++)
            p[k] = scale * q[k];
    }
}

static shape random_solid(starg_rng *rng) {
    switch (starg_rng_below(rng, 4)) {
    case 0:
        return shape_tetrahedron();
    case 1:
        return shape_cube(1);
    case 2:
        return shape_room();
    default:
        return shape_blob(1, starg_rng_next(rng));
    }
}

/* Solids in random orientation; some of them twice at one place, some reversed. */
static void random_soups(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t rounds = test_rounds(3, 1000);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(4, 0, round);
        size_t count = 2 + (size_t)starg_rng_below(&rng, 4);
        shape all = {0};
        char name[64];
        snprintf(name, sizeof name, "soup %d of %zu solids", (int)round, count);
        for (size_t i = 0; i < count; i++) {
            shape own = random_solid(&rng);
            double offset[3];
            rotate(&own, &rng, 1 + starg_rng_unit(&rng));
            for (int k = 0; k < 3; k++)
                offset[k] = starg_rng_unit(&rng);
            for (uint64_t copies = starg_rng_below(&rng, 6) == 0 ? 2 : 1; copies > 0; copies--)
                shape_append(&all, &own, offset, starg_rng_below(&rng, 5) == 0);
            shape_free(&own);
        }
        united u = unite_shape(context, &all, name);
        united_free(&u);
    }
    test_context_free(context);
}

/* Corners on a small lattice: edges through vertices and along edges, coplanar faces. */
static void lattice_soups(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t rounds = test_rounds(10, 3000), done = 0;
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(5, 0, round);
        size_t count = 2 + (size_t)starg_rng_below(&rng, 4);
        const double nowhere[3] = {0, 0, 0};
        shape all = {0};
        char name[64];
        snprintf(name, sizeof name, "lattice soup %d", (int)round);
        for (size_t i = 0; i < count; i++) {
            shape own = shape_tetrahedron();
            double *v = own.vertices;
            do
                for (size_t k = 0; k < 12; k++)
                    v[k] = (double)starg_rng_below(&rng, 4);
            while (oracle_orient3d(v, v + 3, v + 6, v + 9) == 0);
            shape_append(&all, &own, nowhere, 0);
            shape_free(&own);
        }
        starg_mesh *mesh = test_mesh_of(context, &all);
        starg_solid *solid = NULL;
        if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
            united u = unite_shape(context, &all, name);
            united_free(&u);
            done++;
        } else {
            shape_free(&all); /* shells that cancel out */
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    assert_true(10 * done > 9 * rounds);
    test_context_free(context);
}

/* A tube along a lemniscate, which intersects itself in the middle. */
static shape make_tube(void) {
    enum { LENGTH = 40, ROUND = 7 };
    shape s = {.vertex_count = LENGTH * ROUND, .face_count = 2 * LENGTH * ROUND};
    s.vertices = malloc(3 * s.vertex_count * sizeof *s.vertices);
    s.faces = malloc(3 * s.face_count * sizeof *s.faces);
    uint32_t *face = s.faces;
    for (uint32_t i = 0; i < LENGTH; i++)
        for (uint32_t j = 0; j < ROUND; j++) {
            double t = 2 * 3.14159265358979 * i / LENGTH, a = 2 * 3.14159265358979 * j / ROUND;
            double dx = cos(t), dy = 2 * cos(2 * t), length = hypot(dx, dy);
            double *p = s.vertices + 3 * (ROUND * (size_t)i + j);
            p[0] = sin(t) - 0.2 * cos(a) * dy / length;
            p[1] = sin(2 * t) + 0.2 * cos(a) * dx / length;
            p[2] = 0.2 * sin(a);
            uint32_t here = ROUND * i + j, on = ROUND * ((i + 1) % LENGTH) + j;
            uint32_t beside = ROUND * i + (j + 1) % ROUND;
            uint32_t across = ROUND * ((i + 1) % LENGTH) + (j + 1) % ROUND;
            const uint32_t own[6] = {here, on, across, here, across, beside};
            memcpy(face, own, sizeof own);
            face += 6;
        }
    return s;
}

static void tube_through_itself(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = make_tube();
    united u = unite_shape(context, &s, "tube");
    starg_check *check;
    test_ok(context, starg_mesh_check(context, u.mesh, &check));
    assert_true(u.report.union_rounds > 0);
    assert_true(check->embedded);
    assert_int_equal(check->genus, 2);
    starg_check_free(context, check);
    united_free(&u);
    test_context_free(context);
}

/* ---- touching ---- */

static united two_cubes(starg_context *context, double x, double y, double z, const char *name) {
    const double offset[3] = {x, y, z};
    shape s = shape_cube(1), other = shape_cube(1);
    shape_append(&s, &other, offset, 0);
    shape_free(&other);
    return unite_shape(context, &s, name);
}

static void expect_touching(const united *u, size_t components, double volume) {
    starg_check *check;
    test_ok(u->context, starg_mesh_check(u->context, u->mesh, &check));
    assert_int_equal(check->components, components);
    assert_true(fabs(starg_mesh_volume(u->mesh) - volume) < 1e-12);
    starg_check_free(u->context, check);
}

/* A common wall is removed; boxes that touch along an edge or in a point stay separate. */
static void touching_boxes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const struct {
        double offset[3], volume;
        size_t components;
    } cases[] = {{{1, 0, 0}, 2, 1},    {{1, 0.5, 0.25}, 2, 1}, {{1, 1, 0}, 2, 2},
                 {{1, 1, 0.5}, 2, 2},  {{1, 1, 1}, 2, 2},      {{0, 0, 0}, 1, 1},
                 {{0.5, 0, 0}, 1.5, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *o = cases[i].offset;
        char name[64];
        snprintf(name, sizeof name, "cubes at %g %g %g", o[0], o[1], o[2]);
        united u = two_cubes(context, o[0], o[1], o[2], name);
        expect_touching(&u, cases[i].components, cases[i].volume);
        united_free(&u);
    }
    test_context_free(context);
}

/* A prism about the z axis from 0 to 1; the fans of its ends begin at corner `first`. */
static shape prism(size_t sides, size_t first) {
    shape s = {.vertex_count = 2 * sides, .face_count = 4 * sides - 4};
    s.vertices = malloc(3 * s.vertex_count * sizeof *s.vertices);
    s.faces = malloc(3 * s.face_count * sizeof *s.faces);
    uint32_t *face = s.faces;
    for (size_t i = 0; i < sides; i++) {
        const double angle = 6.283185307179586 * (double)i / (double)sides;
        const uint32_t a = (uint32_t)i, b = (uint32_t)((i + 1) % sides), n = (uint32_t)sides;
        for (size_t z = 0; z < 2; z++) {
            double *v = s.vertices + 3 * (i + z * sides);
            v[0] = cos(angle);
            v[1] = sin(angle);
            v[2] = (double)z;
        }
        const uint32_t walls[6] = {a, b, b + n, a, b + n, a + n};
        memcpy(face, walls, sizeof walls);
        face += 6;
    }
    for (size_t i = 1; i + 1 < sides; i++) {
        const uint32_t f = (uint32_t)first, n = (uint32_t)sides,
                       a = (uint32_t)((first + i) % sides), b = (uint32_t)((first + i + 1) % sides);
        const uint32_t ends[6] = {f, b, a, f + n, a + n, b + n};
        memcpy(face, ends, sizeof ends);
        face += 6;
    }
    return s;
}

/* Prisms that stand upon one another, turned and far away: their ends, fans from different corners
 * that are flat only up to rounding, disappear without a trace. */
static void flush_prisms(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const size_t sides[] = {3, 7, 48, 64, 100};
    for (size_t i = 0; i < 3 * sizeof sides / sizeof *sides; i++) {
        const size_t n = sides[i / 3];
        starg_rng rng = starg_rng_make(4, 0, i);
        const double upon[3] = {0, 0, 1}, far = i % 3 == 2 ? 0 : 1e7 * starg_rng_unit(&rng);
        shape all = prism(n, 0), other = prism(n, i % 3 == 0 ? 0 : n / 2);
        const double volume = 2 * starg_rng_unit(&rng), scale = cbrt(volume);
        shape_append(&all, &other, upon, 0);
        shape_free(&other);
        rotate(&all, &rng, scale);
        for (size_t k = 0; k < 3 * all.vertex_count; k++)
            all.vertices[k] += far;
        starg_mesh *mesh = test_mesh_of(context, &all), *out;
        starg_repair_report report;
        shape_free(&all);
        test_ok(context, unite(context, mesh, &out, &report));
        const double expected =
            volume * (double)n * sin(6.283185307179586 / (double)n); /* twice that of one */
        if (starg_mesh_face_count(out) != 6 * n - 4 || report.union_rounds > 1 ||
            !(fabs(starg_mesh_volume(out) - expected) < 1e-12 * (1e5 + 100 * far)))
            fail_msg("%zu sides: %zu faces, %zu rounds, volume %.17g, not %.17g", n,
                     starg_mesh_face_count(out), report.union_rounds, starg_mesh_volume(out),
                     expected);
        starg_mesh_free(mesh);
        starg_mesh_free(out);
    }
    test_context_free(context);
}

/* A double pyramid whose middle lies in the top of a box: each pair of faces only touches there. */
static void touching_faces_that_cross(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = {.vertex_count = 6, .face_count = 8};
    const double vertices[18] = {1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    const uint32_t faces[24] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4,
                                1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5};
    const double offset[3] = {0, 0, 0};
    const int low[3] = {-3, -3, -3}, high[3] = {9, 3, 0};
    shape box = box_of(low, high);
    s.vertices = malloc(sizeof vertices);
    s.faces = malloc(sizeof faces);
    memcpy(s.vertices, vertices, sizeof vertices);
    memcpy(s.faces, faces, sizeof faces);
    shape_append(&s, &box, offset, 0);
    shape_free(&box);
    starg_mesh *mesh = test_mesh_of(context, &s), *mesh_united;
    starg_check *check;
    starg_repair_report report;
    test_ok(context, starg_mesh_check(context, mesh, &check));
    assert_int_equal(count_of(check, STARG_FINDING_SELF_INTERSECTION), 0);
    test_ok(context, unite(context, mesh, &mesh_united, &report));
    double bound = starg_mesh_volume(mesh_united);
    if (fabs(bound - (12 * 6 * 3 + 2.0 / 3)) > 1e-12)
        fail_msg("volume %.17g", bound);
    starg_check_free(context, check);
    starg_mesh_free(mesh);
    starg_mesh_free(mesh_united);
    shape_free(&s);
    test_context_free(context);
}

/* ---- samples ---- */

static void samples(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const char *const names[] = {"torus", "star", "knot", "plate"};
    for (size_t i = 0; i + 1 < sizeof names / sizeof *names; i++) {
        starg_mesh *a = test_sample_mesh(context, names[i], 500);
        starg_mesh *b = test_sample_mesh(context, names[i + 1], 500);
        shape all = {0}, other;
        const double nowhere[3] = {0, 0, 0}, offset[3] = {0.21, 0.13, 0.08};
        starg_mesh *both[2] = {a, b};
        for (int k = 0; k < 2; k++) {
            other = (shape){starg_mesh_vertex_count(both[k]), starg_mesh_face_count(both[k]),
                            malloc(3 * starg_mesh_vertex_count(both[k]) * sizeof(double)),
                            malloc(3 * starg_mesh_face_count(both[k]) * sizeof(uint32_t))};
            memcpy(other.vertices, starg_mesh_vertices(both[k]),
                   3 * other.vertex_count * sizeof(double));
            memcpy(other.faces, starg_mesh_faces(both[k]), 3 * other.face_count * sizeof(uint32_t));
            shape_append(&all, &other, k == 0 ? nowhere : offset, 0);
            shape_free(&other);
        }
        united u = unite_shape(context, &all, names[i]);
        assert_true(starg_mesh_volume(u.mesh) < starg_mesh_volume(a) + starg_mesh_volume(b) + 1e-9);
        united_free(&u);
        starg_mesh_free(a);
        starg_mesh_free(b);
    }
    test_context_free(context);
}

/* The union of a union is the same, and so is that of a mesh that needs none; threads do not
 * matter. */
static void once_is_enough(void **state) {
    (void)state;
    starg_context *context = test_context(1), *other = test_context(3);
    shape s = make_tube();
    starg_mesh *mesh = test_mesh_of(context, &s), *first, *second, *third;
    starg_repair_report report;
    test_ok(context, unite(context, mesh, &first, &report));
    test_ok(context, unite(context, first, &second, &report));
    assert_int_equal(report.union_rounds, 0);
    test_ok(other, unite(other, mesh, &third, &report));
    assert_true(test_same_mesh(first, second));
    assert_true(test_same_mesh(first, third));
    starg_mesh_free(mesh);
    starg_mesh_free(first);
    starg_mesh_free(second);
    starg_mesh_free(third);
    shape_free(&s);
    test_context_free(context);
    test_context_free(other);
}

/* ---- messages ---- */

static void coordinates_too_wide(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double offset[3] = {0.5, 0.5, 1e-200};
    shape s = shape_cube(1), other = shape_cube(1);
    shape_append(&s, &other, offset, 0);
    s.vertices[0] = 1e-200;
    starg_mesh *mesh = test_mesh_of(context, &s), *out;
    starg_repair_report report;
    assert_int_equal(unite(context, mesh, &out, &report), STARG_ERROR_RANGE);
    assert_null(out);
    assert_non_null(strstr(starg_context_error(context)->message, "bits"));
    starg_mesh_free(mesh);
    shape_free(&s);
    shape_free(&other);
    test_context_free(context);
}

/* ---- the shared data ---- */

static void shared_models(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    FILE *readme = test_tables(data);
    test_row row = {0};
    starg_context *context = test_context(1);
    size_t done = 0;
    while (test_next_row(readme, data, &row)) {
        starg_mesh *mesh = NULL;
        starg_check *check = NULL;
        if (starg_mesh_read(context, row.path, &mesh) != STARG_OK)
            continue;
        bool small = starg_mesh_face_count(mesh) <= test_size(MOST_FACES / 4, MOST_FACES);
        if (small)
            test_ok(context, starg_mesh_check(context, mesh, &check));
        if (small && check->usable && count_of(check, STARG_FINDING_SELF_INTERSECTION) > 0) {
            united u = unite_mesh(context, mesh, row.file);
            united_free(&u);
            done++;
        } else {
            starg_mesh_free(mesh);
        }
        starg_check_free(context, check);
    }
    fclose(readme);
    test_context_free(context);
    assert_true(done >= test_size(2, 5));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_of_boxes),
        cmocka_unit_test(volume_of_two_boxes),
        cmocka_unit_test(random_soups),
        cmocka_unit_test(lattice_soups),
        cmocka_unit_test(tube_through_itself),
        cmocka_unit_test(touching_boxes),
        cmocka_unit_test(flush_prisms),
        cmocka_unit_test(touching_faces_that_cross),
        cmocka_unit_test(samples),
        cmocka_unit_test(once_is_enough),
        cmocka_unit_test(coordinates_too_wide),
        cmocka_unit_test(shared_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
