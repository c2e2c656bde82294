/* SPDX-License-Identifier: Apache-2.0 */
/* Every sample, every pose: a closed 2-manifold, outward, embedded, of the expected genus, close to
 * the wanted size. Checked with simple code independent of the library. */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/sample.h"
#include "starguard/space.h"

/* ---- closed 2-manifold ---- */

typedef struct directed_edge {
    uint32_t from, to, opposite;
} directed_edge;

static int compare_edges(const void *a, const void *b) {
    const directed_edge *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return x->to < y->to ? -1 : x->to > y->to;
}

static directed_edge *sorted_edges(const starg_mesh *mesh) {
    size_t count = 3 * starg_mesh_face_count(mesh);
    const uint32_t *faces = starg_mesh_faces(mesh);
    directed_edge *edges = malloc(count * sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < count; i++) {
        size_t f = i - i % 3;
        edges[i] = (directed_edge){faces[i], faces[f + (i + 1) % 3], faces[f + (i + 2) % 3]};
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    return edges;
}

static const directed_edge *find_edge(const directed_edge *edges, size_t count, uint32_t from,
                                      uint32_t to) {
    directed_edge key = {from, to, 0};
    return bsearch(&key, edges, count, sizeof *edges, compare_edges);
}

/* Every directed edge occurs once, and so does its opposite; every vertex has one closed fan. */
static void assert_manifold(const starg_mesh *mesh) {
    size_t count = 3 * starg_mesh_face_count(mesh), fans = 0, vertices = 0;
    directed_edge *edges = sorted_edges(mesh);
    for (size_t i = 0; i < count; i++) {
        assert_int_not_equal(edges[i].from, edges[i].to);
        if (i > 0)
            assert_true(compare_edges(&edges[i - 1], &edges[i]) < 0);
        assert_non_null(find_edge(edges, count, edges[i].to, edges[i].from));
    }
    for (size_t i = 0; i < count;) {
        /* walk around the vertex from its first edge and count the steps back to it */
        size_t begin = i, steps = 0;
        const directed_edge *e = &edges[begin];
        do {
            e = find_edge(edges, count, e->from, e->opposite);
            assert_non_null(e);
            steps++;
        } while (e != &edges[begin] && steps <= count);
        while (i < count && edges[i].from == edges[begin].from)
            i++;
        assert_int_equal(steps, i - begin);
        fans++;
    }
    vertices = starg_mesh_vertex_count(mesh);
    assert_int_equal(fans, vertices); /* no vertex is left out */
    free(edges);
}

static size_t root_of(size_t *parents, size_t v) {
    while (parents[v] != v)
        v = parents[v] = parents[parents[v]];
    return v;
}

static size_t count_components(const starg_mesh *mesh) {
    size_t n = starg_mesh_vertex_count(mesh), components = n;
    const uint32_t *faces = starg_mesh_faces(mesh);
    size_t *parents = malloc(n * sizeof *parents);
    assert_non_null(parents);
    for (size_t v = 0; v < n; v++)
        parents[v] = v;
    for (size_t i = 0; i < 3 * starg_mesh_face_count(mesh); i++) {
        size_t a = root_of(parents, faces[i]), b = root_of(parents, faces[i - i % 3]);
        if (a != b) {
            parents[a] = b;
            components--;
        }
    }
    free(parents);
    return components;
}

/* ---- geometry ---- */

static const double *corner(const starg_mesh *mesh, size_t face, size_t k) {
    return starg_mesh_vertices(mesh) + 3 * (size_t)starg_mesh_faces(mesh)[3 * face + k % 3];
}

static void minus(const double *a, const double *b, double *out) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static double determinant(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Six times the signed volume of a, b, c, d. */
static double volume6(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    minus(b, a, u);
    minus(c, a, v);
    minus(d, a, w);
    return determinant(u, v, w);
}

static double volume_of(const starg_mesh *mesh) {
    double sum = 0;
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++)
        sum += determinant(corner(mesh, f, 0), corner(mesh, f, 1), corner(mesh, f, 2));
    return sum / 6;
}

static double smallest_angle(const starg_mesh *mesh) {
    double smallest = 180;
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++)
        for (size_t k = 0; k < 3; k++) {
            double u[3], v[3], uu = 0, vv = 0, uv = 0;
            minus(corner(mesh, f, k + 1), corner(mesh, f, k), u);
            minus(corner(mesh, f, k + 2), corner(mesh, f, k), v);
            for (int c = 0; c < 3; c++) {
                uu += u[c] * u[c];
                vv += v[c] * v[c];
                uv += u[c] * v[c];
            }
            smallest = fmin(smallest, acos(uv / sqrt(uu * vv)) * 57.29577951308232);
        }
    return smallest;
}

/* ---- self-intersection ---- */

/* Does the segment p q pass through the triangle a b c? Contact alone and cases within rounding do
 * not count. */
static bool pierces(const double *p, const double *q, const double *a, const double *b,
                    const double *c) {
    double s = volume6(a, b, c, p), t = volume6(a, b, c, q);
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, fabs(q[k] - p[k]) + fabs(b[k] - a[k]) + fabs(c[k] - a[k]));
    double noise = 1e-14 * size * size * size;
    if (!((s > noise && t < -noise) || (s < -noise && t > noise)))
        return false;
    double u = volume6(p, q, a, b), v = volume6(p, q, b, c), w = volume6(p, q, c, a);
    return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

static bool faces_share_corner(const uint32_t *f, const uint32_t *g) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (f[i] == g[j])
                return true;
    return false;
}

/* An edge of one passes through the interior of the other; edges that end in the other face are
 * skipped because of common corners. */
static bool faces_cross(const starg_mesh *mesh, size_t f, size_t g) {
    const uint32_t *faces = starg_mesh_faces(mesh);
    for (int turn = 0; turn < 2; turn++) {
        size_t from = turn ? g : f, to = turn ? f : g;
        for (size_t k = 0; k < 3; k++) {
            uint32_t ends[3] = {faces[3 * from + k], faces[3 * from + (k + 1) % 3], 0};
            ends[2] = ends[0];
            if (faces_share_corner(ends, faces + 3 * to))
                continue;
            if (pierces(corner(mesh, from, k), corner(mesh, from, k + 1), corner(mesh, to, 0),
                        corner(mesh, to, 1), corner(mesh, to, 2)))
                return true;
        }
    }
    return false;
}

typedef struct face_box {
    double lower[3], upper[3];
    size_t face;
} face_box;

static int compare_boxes(const void *a, const void *b) {
    double x = ((const face_box *)a)->lower[0], y = ((const face_box *)b)->lower[0];
    return x < y ? -1 : x > y;
}

/* Sweeps along x over the boxes of all faces. */
static size_t count_crossings(const starg_mesh *mesh) {
    size_t n = starg_mesh_face_count(mesh), crossings = 0;
    face_box *boxes = malloc(n * sizeof *boxes);
    assert_non_null(boxes);
    for (size_t f = 0; f < n; f++) {
        boxes[f].face = f;
        for (int k = 0; k < 3; k++) {
            double a = corner(mesh, f, 0)[k], b = corner(mesh, f, 1)[k], c = corner(mesh, f, 2)[k];
            boxes[f].lower[k] = fmin(a, fmin(b, c));
            boxes[f].upper[k] = fmax(a, fmax(b, c));
        }
    }
    qsort(boxes, n, sizeof *boxes, compare_boxes);
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n && boxes[j].lower[0] <= boxes[i].upper[0]; j++) {
            const face_box *a = &boxes[i], *b = &boxes[j];
            if (a->lower[1] > b->upper[1] || b->lower[1] > a->upper[1] ||
                a->lower[2] > b->upper[2] || b->lower[2] > a->upper[2])
                continue;
            crossings += faces_cross(mesh, a->face, b->face);
        }
    free(boxes);
    return crossings;
}

/* ---- tests ---- */

static starg_mesh *make(starg_context *context, const char *name, int pose, size_t vertex_count) {
    starg_sample_options options;
    starg_sample_options_default(&options);
    options.pose = pose;
    options.vertex_count = vertex_count;
    starg_mesh *mesh = NULL;
    test_ok(context, starg_sample_create(context, name, &options, &mesh));
    assert_non_null(mesh);
    return mesh;
}

static long euler(const starg_mesh *mesh) {
    long faces = (long)starg_mesh_face_count(mesh);
    return (long)starg_mesh_vertex_count(mesh) - faces / 2;
}

/* The genus of each member of a family, as a digit; NULL for other samples. */
static const char *family_genera(const char *name) {
    static const struct {
        const char *name, *genera;
    } families[] = {{"vase", "0120120120"},
                    {"bust", "0000000000"},
                    {"bearing", "3546354635"},
                    {"table", "0020030020"},
                    {"tool", "0102010201"}};
    for (size_t i = 0; i < sizeof families / sizeof *families; i++)
        if (strcmp(families[i].name, name) == 0)
            return families[i].genera;
    return NULL;
}

/* Sum over the components of 2 - 2 genus. */
static long expected_euler(const char *name, int pose) {
    static const struct {
        const char *name;
        long value;
    } special[] = {{"torus", 0},  {"knot", 0},      {"plate", -10},
                   {"eight", -2}, {"gallery", -14}, {"shell", 4}};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        if (strcmp(special[i].name, name) == 0)
            return special[i].value;
    const char *genera = family_genera(name);
    return genera != NULL ? 2 - 2 * (genera[pose] - '0') : 2;
}

static void check_mesh(const starg_sample_info *info, int pose, const starg_mesh *mesh,
                       size_t vertex_count, double tolerance) {
    size_t crossings = count_crossings(mesh);
    double angle = smallest_angle(mesh);
    if (crossings != 0 || angle < 0.5)
        print_error("%s, pose %d, %zu vertices: %zu crossings, smallest angle %g\n", info->name,
                    pose, vertex_count, crossings, angle);
    assert_manifold(mesh);
    assert_int_equal(euler(mesh), expected_euler(info->name, pose));
    assert_int_equal(count_components(mesh), strcmp(info->name, "shell") == 0 ? 2 : 1);
    assert_true(volume_of(mesh) > 0);
    assert_int_equal(crossings, 0);
    assert_true(angle > 0.5);
    double count = (double)starg_mesh_vertex_count(mesh);
    assert_true(fabs(count - (double)vertex_count) <= tolerance * (double)vertex_count);
}

static bool is_of_cubes(const starg_sample_info *info) {
    return info->poses == 1000;
}

static void check_sample(starg_context *context, const starg_sample_info *info, int pose,
                         size_t vertex_count, double tolerance) {
    if (info->scene || is_of_cubes(info)) /* scenes_are_what_they_say, solids_of_cubes */
        return;
    starg_mesh *mesh = make(context, info->name, pose, vertex_count);
    check_mesh(info, pose, mesh, vertex_count, tolerance);
    starg_mesh_free(mesh);
}

static starg_solid *scene_of(starg_context *context, const char *name, size_t vertex_count,
                             const starg_space_options *options) {
    starg_mesh *mesh = make(context, name, 0, vertex_count);
    starg_solid *scene = NULL;
    double count = (double)starg_mesh_vertex_count(mesh);
    assert_true(count > 0.4 * (double)vertex_count && count < 2.5 * (double)vertex_count);
    test_ok(context, starg_space_create(context, mesh, NULL, 0, options, &scene));
    starg_mesh_free(mesh);
    return scene;
}

/* In an office one stands in the corridor, and not in the cabinet of its first room; a level is
 * open; a statue has an outside. */
static void scenes_are_what_they_say(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const double corridor[3] = {1, 1, 6.5}, cabinet[3] = {3.75, 1, 3.5}, beside[3] = {3.25, 1, 3.5};
    const double above[3] = {1, 1, 1}, far[3] = {0, 5, 0};
    for (size_t vertices = 1000; vertices <= 20000; vertices *= test_size(5, 20)) {
        starg_space_options options;
        starg_space_options_default(&options);
        options.orientation = STARG_ORIENTATION_KEEP;
        starg_solid *office = scene_of(context, "office", vertices, &options);
        assert_true(starg_space_admits(office, corridor));
        assert_true(starg_space_admits(office, beside));
        assert_false(starg_space_admits(office, cabinet));
        starg_solid_free(office);
        starg_space_options_default(&options);
        options.soup = true;
        starg_solid *level = scene_of(context, "level", vertices, &options), *closed;
        assert_true(starg_space_admits(level, above));
        starg_solid_free(level);
        starg_mesh *open = make(context, "level", 0, vertices);
        assert_int_equal(starg_solid_create(context, open, &closed), STARG_ERROR_MESH);
        starg_mesh_free(open);
        starg_space_options_default(&options);
        options.outside = true;
        starg_solid *statue = scene_of(context, "statue", vertices, &options);
        assert_true(starg_space_admits(statue, far));
        starg_solid_free(statue);
    }
    test_context_free(context);
}

/* Every sample in the rest pose and in poses `from` to `to`, as far as it has them. */
static void check_all(size_t vertex_count, double tolerance, int from, int to) {
    starg_context *context = test_context(2);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        const starg_sample_info *info = starg_sample_at(i);
        check_sample(context, info, 0, vertex_count, tolerance);
        for (int pose = from; pose <= to && pose < info->poses; pose++)
            check_sample(context, info, pose, vertex_count, tolerance);
    }
    test_context_free(context);
}

static void samples_of_500(void **state) {
    (void)state;
    check_all(500, 0.25, 3, 3); /* rigid polyhedra have coarse steps here */
}

static void samples_of_5000(void **state) {
    (void)state;
    check_all(5000, 0.05, 2, 2);
}

/* One pose of every sixth, to stay fast. */
static void samples_of_20000(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (size_t i = 0; i < starg_sample_count(); i += 2 * test_step()) {
        const starg_sample_info *info = starg_sample_at(i);
        check_sample(context, info, (int)(i % 5) % info->poses, 20000, 0.03);
    }
    test_context_free(context);
}

static void poses_share_connectivity_and_differ(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t articulated = 0;
    for (size_t i = 0; i < starg_sample_count(); i++) {
        const starg_sample_info *info = starg_sample_at(i);
        if (family_genera(info->name) != NULL || is_of_cubes(info)) /* members_differ */
            continue;
        articulated += info->poses >= 5;
        starg_mesh *rest = make(context, info->name, 0, test_size(500, 800));
        size_t n = starg_mesh_vertex_count(rest), faces = starg_mesh_face_count(rest);
        double lower[3], upper[3], size = 0;
        starg_mesh_bounds(rest, lower, upper);
        for (int k = 0; k < 3; k++)
            size = fmax(size, upper[k] - lower[k]);
        for (int pose = 1; pose < info->poses; pose += info->poses - 1) {
            starg_mesh *bent = make(context, info->name, pose, test_size(500, 800));
            assert_int_equal(starg_mesh_vertex_count(bent), n);
            assert_int_equal(starg_mesh_face_count(bent), faces);
            assert_memory_equal(starg_mesh_faces(bent), starg_mesh_faces(rest),
                                3 * faces * sizeof(uint32_t));
            double farthest = 0;
            for (size_t c = 0; c < 3 * n; c++)
                farthest = fmax(farthest,
                                fabs(starg_mesh_vertices(bent)[c] - starg_mesh_vertices(rest)[c]));
            assert_true(farthest > 0.08 * size);
            starg_mesh_free(bent);
        }
        starg_mesh_free(rest);
    }
    assert_true(articulated >= 6);
    test_context_free(context);
}

/* Volume over that of the bounding box, and its sides by the longest: what members differ by. */
static void proportions(const starg_mesh *mesh, double out[4]) {
    double lower[3], upper[3], longest = 0, box = 1;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        out[k] = upper[k] - lower[k];
        longest = fmax(longest, out[k]);
        box *= out[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] /= longest;
    out[3] = volume_of(mesh) / box;
}

/* No two members of a family are alike, and members are as every sample: of each family four and
 * two, or all. */
static void members_differ(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t families = 0;
    int step = (int)test_size(3, 1);
    for (size_t i = 0; i < starg_sample_count(); i++) {
        const starg_sample_info *info = starg_sample_at(i);
        double measures[10][4];
        if (family_genera(info->name) == NULL)
            continue;
        families++;
        assert_int_equal(info->poses, 10);
        for (int member = 0; member < info->poses; member += step) {
            starg_mesh *mesh = make(context, info->name, member, 500);
            if (step == 1 || member % 9 == 0)
                check_mesh(info, member, mesh, 500, 0.1);
            proportions(mesh, measures[member]);
            starg_mesh_free(mesh);
            for (int other = 0; other < member; other += step) {
                double most = 0;
                for (int k = 0; k < 4; k++)
                    most = fmax(most, fabs(measures[member][k] - measures[other][k]));
                if (most <= 0.003)
                    print_error("%s: members %d and %d are alike\n", info->name, other, member);
                assert_true(most > 0.003);
            }
        }
    }
    assert_int_equal(families, 5);
    test_context_free(context);
}

/* Closed, embedded, about as large as asked for; without spikes, of whole cubes. */
static void solids_of_cubes(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t kinds = 0;
    for (size_t i = 0; i < starg_sample_count(); i++) {
        const starg_sample_info *info = starg_sample_at(i);
        double before = 0;
        kinds += is_of_cubes(info);
        for (int member = 0; member < 20 && is_of_cubes(info); member++) {
            size_t wanted = (size_t[]){20, 60, 300, 2000}[member % 4];
            starg_mesh *mesh = make(context, info->name, member, wanted);
            double volume = volume_of(mesh), count = (double)starg_mesh_vertex_count(mesh);
            assert_manifold(mesh);
            assert_int_equal(count_crossings(mesh), 0);
            assert_true(count >= 0.4 * (double)wanted && count <= 1.6 * (double)wanted);
            if (strcmp(info->name, "spikes") != 0)
                assert_true(fabs(volume - round(volume)) < 1e-9);
            if (strcmp(info->name, "polycube") != 0) { /* which may have holes and cavities */
                assert_int_equal(count_components(mesh), 1);
                assert_int_equal(euler(mesh), 2);
            }
            assert_true(member == 0 || volume != before);
            before = volume;
            starg_mesh_free(mesh);
        }
    }
    assert_int_equal(kinds, 4);
    test_context_free(context);
}

static void same_bytes_for_any_thread_count(void **state) {
    (void)state;
    starg_context *one = test_context(1), *four = test_context(4);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        const starg_sample_info *info = starg_sample_at(i);
        starg_mesh *a = make(one, info->name, info->poses - 1, 3000);
        starg_mesh *b = make(four, info->name, info->poses - 1, 3000);
        size_t n = starg_mesh_vertex_count(a), faces = starg_mesh_face_count(a);
        assert_int_equal(starg_mesh_vertex_count(b), n);
        assert_int_equal(starg_mesh_face_count(b), faces);
        assert_memory_equal(starg_mesh_vertices(a), starg_mesh_vertices(b), 3 * n * sizeof(double));
        assert_memory_equal(starg_mesh_faces(a), starg_mesh_faces(b), 3 * faces * sizeof(uint32_t));
        starg_mesh_free(a);
        starg_mesh_free(b);
    }
    test_context_free(one);
    test_context_free(four);
}

/* Volumes known in closed form. */
static void volumes_are_right(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double volume, tolerance;
    } known[] = {{"sphere", 4.18879020, 0.002},
                 {"l-room", 1.1 * (4.0 * 1.5 + 1.5 * 2.0), 1e-12},
                 {"torus", 19.7392088 * 0.38 * 0.38, 0.01},
                 {"shell", 4.18879020 * (1 - 0.58 * 0.58 * 0.58), 0.002}};
    starg_context *context = test_context(2);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        /* bends and twists keep the volume */
        for (int pose = 0; pose < (strcmp(known[i].name, "torus") == 0 ? 3 : 1); pose++) {
            starg_mesh *mesh = make(context, known[i].name, pose, 20000);
            assert_true(fabs(volume_of(mesh) - known[i].volume) <=
                        known[i].tolerance * known[i].volume);
            starg_mesh_free(mesh);
        }
    }
    test_context_free(context);
}

static void bad_requests_are_explained(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const struct {
        const char *name;
        int pose;
        size_t vertex_count;
        const char *word;
    } bad[] = {{"unicorn", 0, 5000, "unicorn"},   {"", 0, 5000, "''"},
               {"horse", 5, 5000, "pose 5"},      {"horse", -1, 5000, "pose -1"},
               {"knot", 1, 5000, "pose 1"},       {"horse", 0, 499, "499"},
               {"star", 0, 10000001, "10000001"}, {"star", 0, SIZE_MAX, "vertex count"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        starg_sample_options options = {.pose = bad[i].pose, .vertex_count = bad[i].vertex_count};
        starg_mesh *mesh = (starg_mesh *)context;
        assert_int_equal(starg_sample_create(context, bad[i].name, &options, &mesh),
                         STARG_ERROR_ARGUMENT);
        assert_null(mesh);
        assert_non_null(strstr(starg_context_error(context)->message, bad[i].word));
    }
    assert_null(starg_sample_at(starg_sample_count()));
    assert_null(starg_sample_at(SIZE_MAX));
    test_context_free(context);
}

static void cancellation_stops_it(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (size_t i = 0; i < starg_sample_count(); i++) {
        starg_mesh *mesh = NULL;
        starg_context_cancel(context);
        const char *name = starg_sample_at(i)->name;
        starg_status status = starg_sample_create(context, name, NULL, &mesh);
        assert_int_equal(status, STARG_ERROR_CANCELLED);
        assert_null(mesh);
        starg_context_reset(context);
    }
    test_context_free(context);
}

/* ---- memory that runs out ---- */

static void memory_failures_leak_nothing(void **state) {
    (void)state;
    static const char *const names[] = {"octopus", "gallery", "knot", "shell", "star"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        starg_status status = STARG_ERROR_MEMORY;
        size_t failures = 0;
        for (size_t allowed = 1; status != STARG_OK; allowed += 1 + allowed / 8) {
            size_t left = allowed;
            starg_context *context = test_scarce_context(1, &left);
            starg_sample_options size = {.pose = 0, .vertex_count = 500};
            starg_mesh *mesh = NULL;
            status = starg_sample_create(context, names[i], &size, &mesh);
            assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
            assert_true((status == STARG_OK) == (mesh != NULL));
            failures += status != STARG_OK;
            starg_mesh_free(mesh);
            test_context_free(context);
        }
        assert_true(failures > 3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_of_500),
        cmocka_unit_test(samples_of_5000),
        cmocka_unit_test(samples_of_20000),
        cmocka_unit_test(scenes_are_what_they_say),
        cmocka_unit_test(poses_share_connectivity_and_differ),
        cmocka_unit_test(members_differ),
        cmocka_unit_test(solids_of_cubes),
        cmocka_unit_test(same_bytes_for_any_thread_count),
        cmocka_unit_test(volumes_are_right),
        cmocka_unit_test(bad_requests_are_explained),
        cmocka_unit_test(cancellation_stops_it),
        cmocka_unit_test(memory_failures_leak_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
