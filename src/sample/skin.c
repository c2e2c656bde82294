/* SPDX-License-Identifier: Apache-2.0 */
/* Linear blend skinning.
 *
 * A vertex follows the joint with the nearest part, and near the border between two joints both:
 * weights fall smoothly to 0 as the other joint's distance exceeds the nearest by the width of
 * their border, which is proportional to the thinner limb at its start. Weights depend only on the
 * place in the rest pose, so meshes of any resolution bend alike. Joint rotations are moderate, so
 * blending matrices loses little volume. Cost: O(vertices x parts). */
#include "sample/solids.h"

#include "core/parallel.h"
#include "geometry/vec3.h"

static const char STAGE[] = "sample";
static const double DEGREE = 0.01745329251994329577;

/* Width of the border between two joints, in radii of the thinner limb. */
static const double SOFTNESS = 1.5;

enum { BLOCK = 1024 };

/* p -> matrix p + shift */
typedef struct motion {
    double matrix[3][3], shift[3];
} motion;

static void apply(const motion *m, const double p[3], double out[3]) {
    double q[3];
    for (int k = 0; k < 3; k++)
        q[k] = vec3_dot(m->matrix[k], p) + m->shift[k];
    vec3_copy(q, out);
}

/* first `inner`, then `outer` */
static motion compose(const motion *outer, const motion *inner) {
    motion m;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            m.matrix[i][j] = 0;
            for (int k = 0; k < 3; k++)
                m.matrix[i][j] += outer->matrix[i][k] * inner->matrix[k][j];
        }
    apply(outer, inner->shift, m.shift);
    return m;
}

static motion identity(void) {
    return (motion){.matrix = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/* Rodrigues' formula. */
static motion turn_about_pivot(const double pivot[3], const double degrees[3]) {
    motion m = identity();
    double length = vec3_length(degrees), axis[3], moved[3];
    if (length == 0)
        return m;
    for (int k = 0; k < 3; k++)
        axis[k] = degrees[k] / length;
    double c = cos(DEGREE * length), s = sin(DEGREE * length);
    for (int i = 0; i < 3; i++) {
        int u = (i + 1) % 3, v = (i + 2) % 3;
        m.matrix[i][i] = c + (1 - c) * axis[i] * axis[i];
        m.matrix[i][u] = (1 - c) * axis[i] * axis[u] - s * axis[v];
        m.matrix[i][v] = (1 - c) * axis[i] * axis[v] + s * axis[u];
    }
    apply(&m, pivot, moved);
    vec3_subtract(pivot, moved, m.shift);
    return m;
}

/* The motion of every joint, its parents' included. */
static void pose_joints(const figure *f, int pose, motion *joints) {
    for (int j = 0; j < f->joint_count; j++) {
        joints[j] = f->parents[j] < 0 ? identity() : joints[f->parents[j]];
        for (size_t i = 0; i < f->turn_count; i++) {
            if (f->turns[i].pose != pose || f->turns[i].joint != j)
                continue;
            motion turn = turn_about_pivot(f->pivots[j], f->turns[i].degrees);
            joints[j] = compose(&joints[j], &turn);
        }
    }
}

typedef struct skin_job {
    const figure *f;
    motion joints[FIGURE_MAX_JOINTS];
    double limbs[FIGURE_MAX_JOINTS]; /* radius of each joint's limb at its start */
    double *vertices;
    size_t count;
} skin_job;

/* Distance of p to the parts of each joint, and the radius of the joint's nearest part; infinite
 * for a joint without parts. */
static void joint_distances(const figure *f, const double p[3], double *distances, double *radii) {
    for (int j = 0; j < f->joint_count; j++) {
        distances[j] = INFINITY;
        radii[j] = 0;
    }
    for (size_t i = 0; i < f->field.count; i++) {
        double radius, value = implicit_part_value(&f->field.parts[i], p, NULL, &radius);
        int joint = f->owners[i];
        if (value < distances[joint]) {
            distances[joint] = value;
            radii[joint] = radius;
        }
    }
}

static void measure_limbs(const figure *f, double *limbs) {
    double distances[FIGURE_MAX_JOINTS], radii[FIGURE_MAX_JOINTS];
    for (int j = 0; j < f->joint_count; j++) {
        joint_distances(f, f->pivots[j], distances, radii);
        limbs[j] = radii[j];
    }
}

static void bend_vertex(const skin_job *job, double *p) {
    double distances[FIGURE_MAX_JOINTS], radii[FIGURE_MAX_JOINTS], sum = 0, out[3] = {0, 0, 0};
    int nearest = 0;
    joint_distances(job->f, p, distances, radii);
    for (int j = 1; j < job->f->joint_count; j++)
        if (distances[j] < distances[nearest])
            nearest = j;
    for (int j = 0; j < job->f->joint_count; j++) {
        double border = SOFTNESS * fmin(job->limbs[j], job->limbs[nearest]);
        double excess = (distances[j] - distances[nearest]) / border;
        if (!(excess < 1))
            continue;
        double weight = (1 - excess) * (1 - excess) * (1 + 2 * excess), moved[3];
        apply(&job->joints[j], p, moved);
        vec3_along(out, weight, moved, out);
        sum += weight;
    }
    for (int k = 0; k < 3; k++)
        p[k] = out[k] / sum;
}

static starg_status bend_block(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)context;
    (void)scratch;
    const skin_job *job = shared;
    size_t end = (item + 1) * BLOCK < job->count ? (item + 1) * BLOCK : job->count;
    for (size_t v = item * BLOCK; v < end; v++)
        bend_vertex(job, job->vertices + 3 * v);
    return STARG_OK;
}

starg_status skin_pose(starg_context *context, const figure *f, int pose, double *vertices,
                       size_t count) {
    skin_job job = {.f = f, .vertices = vertices, .count = count};
    pose_joints(f, pose, job.joints);
    measure_limbs(f, job.limbs);
    starg_parallel_loop loop = {
        .stage = STAGE, .count = (count + BLOCK - 1) / BLOCK, .shared = &job, .item = bend_block};
    return starg_parallel_for(context, &loop);
}
