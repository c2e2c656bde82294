/* SPDX-License-Identifier: Apache-2.0 */
/* Aligns two spherical embeddings by a rotation of the sphere.
 *
 * Stages: principal axes of both surfaces in space; the 24 proper ways to map the axes of one to
 * those of the other (with three or more landmarks, only the rotation that fits them best); for
 * each, every sample of the first surface is paired with the nearest sample of the second in space,
 * and the rotation of the sphere that best aligns the paired directions is computed [Kabsch 1976];
 * landmarks count as much as all samples. The winning rotation minimizes the mean squared distance
 * in space of points that coincide on the sphere.
 *
 * Without landmarks, extremities (extremities.c) that are mutually nearest in space under the
 * winning rotation are reported as pairs.
 *
 * Cost: 24 x SAMPLES^2 distances and 24 x SAMPLES locations. */
#include "morph/surface_map.h"

#include "geometry/vec3.h"
#include "morph/morph.h"

static const char STAGE[] = "align";
enum { SAMPLES = 600, WAYS = 24 };
static const double NEAR =
    1.3; /* relative to the surface's size: largest distance of paired extremities */

typedef struct axes {
    double center[3], frame[9]; /* columns: principal axes */
    double size;                /* root mean square distance from the center */
} axes;

/* Weighted by the vertices' shares of the area. */
static void add_moments(const starg_mesh *mesh, const double center[3], double moments[9],
                        double mean[3], double *total) {
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *c = mesh->faces + 3 * f;
        const double *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->vertices + 3 * (size_t)c[k];
        double area = vec3_triangle_area(p[0], p[1], p[2]);
        for (int k = 0; k < 3; k++) {
            double d[3];
            vec3_subtract(p[k], center, d);
            vec3_along(mean, area / 3, d, mean);
            for (int i = 0; i < 9; i++)
                moments[i] += area / 3 * d[i / 3] * d[i % 3];
        }
        *total += area;
    }
}

static axes principal_axes(const starg_mesh *mesh) {
    axes a = {0};
    double moments[9] = {0}, mean[3] = {0}, values[3], total = 0;
    add_moments(mesh, a.center, moments, mean, &total);
    for (int k = 0; k < 3; k++)
        a.center[k] = mean[k] / total;
    memset(moments, 0, sizeof moments);
    add_moments(mesh, a.center, moments, mean, &total);
    symmetric_eigen(moments, values, a.frame);
    a.size = sqrt(2 * (values[0] + values[1] + values[2]) / total);
    return a;
}

/* Number `way` of the 24 proper rotations that permute the axes and flip signs. */
static void signed_permutation(int way, double out[9]) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                     {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    const int *order = orders[way / 4];
    double odd = way / 4 < 3 ? 1 : -1, first = way & 1 ? -1 : 1, second = way & 2 ? -1 : 1;
    const double signs[3] = {first, second, odd * first * second};
    memset(out, 0, 9 * sizeof *out);
    for (int i = 0; i < 3; i++)
        out[3 * i + order[i]] = signs[i];
}

/* In space, from the first surface to the second. */
typedef struct motion {
    double rotation[9], scale;
    const axes *from, *to;
} motion;

static void move(const motion *m, const double p[3], double out[3]) {
    double d[3];
    vec3_subtract(p, m->from->center, d);
    matrix_apply(m->rotation, d, d);
    vec3_along(m->to->center, m->scale, d, out);
}

static void motion_of_way(const axes *from, const axes *to, int way, motion *m) {
    double turn[9], right[9], transposed[9];
    signed_permutation(way, turn);
    for (int i = 0; i < 9; i++)
        transposed[i] = from->frame[3 * (i % 3) + i / 3];
    matrix_multiply(turn, transposed, right);
    matrix_multiply(to->frame, right, m->rotation);
    m->scale = from->size > 0 ? to->size / from->size : 1;
    m->from = from;
    m->to = to;
}

/* The rotation in space that best fits the landmarks, about the surfaces' centers. */
static void motion_of_landmarks(const sphere *from, const sphere *to, const landmark_list *marks,
                                motion *m) {
    double sum[9] = {0};
    for (size_t i = 0; i < marks->count; i++) {
        double p[3], q[3];
        vec3_subtract(from->mesh->vertices + 3 * (size_t)marks->from[i], m->from->center, p);
        vec3_subtract(to->mesh->vertices + 3 * (size_t)marks->to[i], m->to->center, q);
        for (int k = 0; k < 9; k++)
            sum[k] += q[k / 3] * p[k % 3];
    }
    polar_rotation(sum, m->rotation);
}

typedef struct aligner {
    sphere *from;
    const locator *to;
    const landmark_list *landmarks;
} aligner;

static size_t stride_of(const sphere *s) {
    return s->mesh->vertex_count / SAMPLES + 1;
}

static size_t nearest_sample(const sphere *s, const double p[3]) {
    size_t best = 0;
    double least = INFINITY;
    for (size_t v = 0; v < s->mesh->vertex_count; v += stride_of(s)) {
        double d = vec3_distance_squared(p, s->mesh->vertices + 3 * v);
        if (d < least) {
            least = d;
            best = v;
        }
    }
    return best;
}

static void add_pair(const double x[3], const double y[3], double weight, double sum[9]) {
    for (int k = 0; k < 9; k++)
        sum[k] += weight * y[k / 3] * x[k % 3];
}

static void rotation_for(const aligner *a, const motion *m, double rotation[9]) {
    const sphere *from = a->from, *to = a->to->sphere;
    double sum[9] = {0};
    for (size_t v = 0; v < from->mesh->vertex_count; v += stride_of(from)) {
        double p[3];
        move(m, from->mesh->vertices + 3 * v, p);
        add_pair(from->directions + 3 * v, to->directions + 3 * nearest_sample(to, p), 1, sum);
    }
    for (size_t i = 0; i < a->landmarks->count; i++)
        add_pair(from->directions + 3 * (size_t)a->landmarks->from[i],
                 to->directions + 3 * (size_t)a->landmarks->to[i],
                 (double)SAMPLES / (double)a->landmarks->count, sum);
    polar_rotation(sum, rotation);
}

static void map_point(const locator *to, uint32_t face, const double coordinates[3],
                      double out[3]) {
    const starg_mesh *mesh = to->sphere->mesh;
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < 3; k++)
        vec3_along(out, coordinates[k],
                   mesh->vertices + 3 * (size_t)mesh->faces[3 * (size_t)face + k], out);
}

static double misfit(const aligner *a, const motion *m, const double rotation[9]) {
    const sphere *from = a->from;
    double sum = 0, coordinates[3];
    uint32_t face = 0;
    for (size_t v = 0; v < from->mesh->vertex_count; v += stride_of(from)) {
        double x[3], p[3], q[3];
        matrix_apply(rotation, from->directions + 3 * v, x);
        face = locate(a->to, x, face, coordinates);
        map_point(a->to, face, coordinates, q);
        move(m, from->mesh->vertices + 3 * v, p);
        sum += vec3_distance_squared(p, q);
    }
    return sum;
}

/* Rounding can flip a nearly flat triangle: the surface then stays unchanged. */
static starg_status turn(sphere *s, const double rotation[9]) {
    SCOPED double *before = NULL;
    size_t size = 3 * s->mesh->vertex_count;
    NEW(s->context, STAGE, before, size);
    memcpy(before, s->directions, size * sizeof *before);
    for (size_t v = 0; v < s->mesh->vertex_count; v++)
        matrix_apply(rotation, before + 3 * v, s->directions + 3 * v);
    if (!sphere_is_positive(s))
        memcpy(s->directions, before, size * sizeof *before);
    return STARG_OK;
}

/* Removes the closest pair from two lists of places; false if its distance exceeds `far`. */
static bool take_nearest(double (*from)[3], size_t from_count, double (*to)[3], size_t to_count,
                         double far, size_t pair[2]) {
    double least = far;
    bool found = false;
    for (size_t i = 0; i < from_count; i++)
        for (size_t j = 0; j < to_count; j++) {
            double d = vec3_distance(from[i], to[j]);
            if (!(d < least))
                continue;
            least = d;
            pair[0] = i;
            pair[1] = j;
            found = true;
        }
    if (found)
        from[pair[0]][0] = to[pair[1]][0] = NAN; /* nearest to nothing from now on */
    return found;
}

/* Pairs extremities that are close in space after the motion, nearest first. */
static starg_status pair_extremities(const aligner *a, const motion *m, feature_pairs *out) {
    extremity_list from, to;
    double moved[EXTREMITIES_MOST][3], places[EXTREMITIES_MOST][3];
    size_t pair[2] = {0, 0};
    TRY(extremities_find(a->from, &from));
    TRY(extremities_find(a->to->sphere, &to));
    for (size_t i = 0; i < from.count; i++)
        move(m, a->from->mesh->vertices + 3 * (size_t)from.vertices[i], moved[i]);
    for (size_t i = 0; i < to.count; i++)
        vec3_copy(a->to->sphere->mesh->vertices + 3 * (size_t)to.vertices[i], places[i]);
    while (take_nearest(moved, from.count, places, to.count, NEAR * m->to->size, pair)) {
        out->from[out->count] = from.vertices[pair[0]];
        out->to[out->count++] = to.vertices[pair[1]];
    }
    return STARG_OK;
}

starg_status align_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                           feature_pairs *features) {
    const aligner a = {from, to, landmarks};
    const axes axes_from = principal_axes(from->mesh), axes_to = principal_axes(to->sphere->mesh);
    double best[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, least = INFINITY;
    bool guided = landmarks->count >= 3;
    motion best_motion = {0};
    *features = (feature_pairs){0};
    for (int way = 0; way < (guided ? 1 : WAYS); way++) {
        motion m;
        double rotation[9];
        TRY(starg_check_cancel(from->context, STAGE));
        motion_of_way(&axes_from, &axes_to, way, &m);
        if (guided)
            motion_of_landmarks(from, to->sphere, landmarks, &m);
        rotation_for(&a, &m, rotation);
        double own = misfit(&a, &m, rotation);
        if (own < least) {
            least = own;
            best_motion = m;
            memcpy(best, rotation, sizeof best);
        }
    }
    if (landmarks->count == 0 && least < INFINITY) {
        TRY(pair_extremities(&a, &best_motion, features));
        const landmark_list pairs = {features->from, features->to, features->count};
        const aligner by_extremities = {from, to, &pairs};
        rotation_for(&by_extremities, &best_motion, best);
    }
    return turn(from, best);
}
