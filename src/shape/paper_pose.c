/* SPDX-License-Identifier: Apache-2.0 */
/* Pose of a descriptor: [YL11] compares coordinates but does not state the frame.
 *
 * Here: centre, size and principal axes of the boundary points that the guards see, each guard
 * weighted by the volume of its piece. Axes point to the side of positive third moment; the axis
 * with the smallest third moment makes the frame right-handed, so that a mirror-symmetric shape,
 * for which that moment is noise, still has a unique frame. Eigenvectors by Jacobi rotations, which
 * are stable for any symmetric matrix; if two moments are equal the axes are arbitrary, but a pure
 * function of the numbers.
 *
 * Cost: three passes over guards times directions. */
#include "shape/paper_pose.h"

#include <math.h>
#include <string.h>

#include "geometry/vec3.h"

enum { SWEEPS = 16 };

/* Sums over the points that guards see, relative to the first guard and to the diagonal. */
typedef struct moments {
    const starg_descriptor *d;
    double unit, largest, weight;
} moments;

static void seen_point(const moments *m, size_t guard, size_t i, double out[3]) {
    const starg_descriptor *d = m->d;
    double direction[3], step = d->distances[guard * d->direction_count + i] / m->unit;
    starg_descriptor_direction(d->direction_count, i, direction);
    for (int k = 0; k < 3; k++)
        out[k] = (d->guards[guard].position[k] - d->guards[0].position[k]) / m->unit +
                 step * direction[k];
}

/* Relative to the largest, to avoid overflow and underflow; equal if there is no volume. */
static double weigh(const moments *m, size_t guard) {
    return m->largest > 0 ? m->d->guards[guard].volume / m->largest : 1;
}

static void find_centre(moments *m, double centre[3]) {
    const starg_descriptor *d = m->d;
    memset(centre, 0, 3 * sizeof *centre);
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g), p[3];
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_along(centre, w, p, centre);
        }
        m->weight += w * (double)d->direction_count;
    }
    for (int k = 0; k < 3; k++)
        centre[k] /= m->weight;
}

static void find_spread(const moments *m, const double centre[3], double spread[3][3]) {
    const starg_descriptor *d = m->d;
    memset(spread, 0, 9 * sizeof(double));
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g) / m->weight, p[3];
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_subtract(p, centre, p);
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    spread[r][c] += w * p[r] * p[c];
        }
    }
}

/* One Jacobi rotation in the plane of axes p and q, which makes a[p][q] zero. */
static void rotate(double a[3][3], double axes[3][3], int p, int q) {
    if (a[p][q] == 0)
        return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + hypot(theta, 1));
    double c = 1 / hypot(t, 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
        double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        x = axes[p][k], y = axes[q][k];
        axes[p][k] = c * x - s * y;
        axes[q][k] = s * x + c * y;
    }
}

static void swap_rows(double a[3][3], double axes[3][3], int p, int q) {
    double value = a[p][p], row[3];
    a[p][p] = a[q][q];
    a[q][q] = value;
    vec3_copy(axes[p], row);
    vec3_copy(axes[q], axes[p]);
    vec3_copy(row, axes[q]);
}

/* Sorted by decreasing spread. */
static void find_axes(double a[3][3], double axes[3][3]) {
    memset(axes, 0, 9 * sizeof(double));
    for (int k = 0; k < 3; k++)
        axes[k][k] = 1;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        rotate(a, axes, 0, 1);
        rotate(a, axes, 0, 2);
        rotate(a, axes, 1, 2);
    }
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < 2; k++)
            if (a[k][k] < a[k + 1][k + 1])
                swap_rows(a, axes, k, k + 1);
}

static void turn_axes(const moments *m, const double centre[3], double axes[3][3]) {
    const starg_descriptor *d = m->d;
    double third[3] = {0, 0, 0}, p[3];
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g);
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_subtract(p, centre, p);
            for (int k = 0; k < 3; k++)
                third[k] += w * pow(vec3_dot(p, axes[k]), 3);
        }
    }
    int least = 0;
    for (int k = 0; k < 3; k++) {
        if (fabs(third[k]) < fabs(third[least]))
            least = k;
        for (int c = 0; third[k] < 0 && c < 3; c++)
            axes[k][c] = -axes[k][c];
    }
    vec3_cross(axes[(least + 1) % 3], axes[(least + 2) % 3], axes[least]);
}

paper_pose paper_pose_of(const starg_descriptor *descriptor) {
    paper_pose pose;
    double spread[3][3];
    moments m = {.d = descriptor, .unit = descriptor->diagonal};
    if (!(m.unit > 0))
        m.unit = 1;
    for (size_t i = 0; i < descriptor->guard_count; i++)
        m.largest = fmax(m.largest, descriptor->guards[i].volume);
    find_centre(&m, pose.centre);
    find_spread(&m, pose.centre, spread);
    pose.size = m.unit * sqrt(fmax(0, spread[0][0] + spread[1][1] + spread[2][2]));
    find_axes(spread, pose.axes);
    turn_axes(&m, pose.centre, pose.axes);
    for (int k = 0; k < 3; k++)
        pose.centre[k] = descriptor->guards[0].position[k] + m.unit * pose.centre[k];
    return pose;
}

void paper_pose_apply(const paper_pose *pose, const double p[3], double out[3]) {
    double q[3], unit = pose->size > 0 ? pose->size : 1;
    for (int k = 0; k < 3; k++)
        q[k] = (p[k] - pose->centre[k]) / unit;
    for (int k = 0; k < 3; k++)
        out[k] = vec3_dot(pose->axes[k], q);
}
