/* SPDX-License-Identifier: Apache-2.0 */
/* The paper's sweep [YL11, section 3.1], by longitude.
 *
 * Each vertex is a direction (longitude phi, latitude theta) from p, each face covers a range of
 * both. The sweep passes the vertices by phi; faces are active while phi lies in their range; the
 * segment test is made if theta also lies in the face's range, condition (1).
 *
 * As printed the method misses blockers; three corrections:
 * - the edges of a spherical triangle bulge poleward, so its latitudes exceed those of its
 *   vertices: the range includes the extremes of the edges' great circles;
 * - longitudes wrap at pi: a face across the seam is active at both ends of the sweep;
 * - a face whose cone contains a pole covers all longitudes: it is always active.
 * With longitude as the primary key, its range needs only vertices, wrap and poles. The paper's
 * counters (c = 1 at the first swept vertex of a face, removal after the third) amount to the same
 * activation, except for faces across the seam.
 *
 * Angles only select what is tested: ranges are widened by far more than the error of atan2, and
 * the test itself is exact. Cost O(n log n + n m) for m active faces. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

static const double PI = 3.14159265358979323846;
static const double MARGIN = 0x1p-40;

typedef struct direction {
    double phi, theta;
    uint32_t slot;
} direction;

typedef struct range {
    double phi_low, phi_high, theta_low, theta_high;
    uint32_t rank;
} range;

typedef struct sweep_scratch {
    direction *directions, *sorted; /* by slot; by phi, then theta */
    range *ranges;                  /* up to two per face, by phi_low */
    uint32_t *active;               /* indices into ranges */
} sweep_scratch;

static void free_scratch(const visibility_scene *scene, void *scratch) {
    (void)scene;
    sweep_scratch *s = scratch;
    if (s == NULL)
        return;
    RELEASE(s->directions, s->sorted, s->ranges, s->active, s);
}

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    starg_context *context = scene->context;
    sweep_scratch *s = starg_allocate_zero(context, 1, sizeof *s);
    *scratch = s;
    if (s == NULL)
        return STARG_ERROR_MEMORY;
    s->directions = starg_allocate(context, scene->vertex_count, sizeof *s->directions);
    s->sorted = starg_allocate(context, scene->vertex_count, sizeof *s->sorted);
    s->ranges = starg_allocate(context, 2 * scene->face_count, sizeof *s->ranges);
    s->active = starg_allocate(context, 2 * scene->face_count, sizeof *s->active);
    if (s->directions && s->sorted && s->ranges && s->active)
        return STARG_OK;
    free_scratch(scene, s);
    *scratch = NULL;
    return STARG_ERROR_MEMORY;
}

static int compare_directions(const void *left, const void *right) {
    const direction *a = left, *b = right;
    if (a->phi != b->phi)
        return a->phi < b->phi ? -1 : 1;
    if (a->theta != b->theta)
        return a->theta < b->theta ? -1 : 1;
    return (a->slot > b->slot) - (a->slot < b->slot);
}

static int compare_ranges(const void *left, const void *right) {
    const range *a = left, *b = right;
    if (a->phi_low != b->phi_low)
        return a->phi_low < b->phi_low ? -1 : 1;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

static void measure_directions(const visibility_scene *scene, const double p[3],
                               direction *directions) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        double x = scene->x[slot] - p[0], y = scene->y[slot] - p[1], z = scene->z[slot] - p[2];
        directions[slot] = (direction){atan2(y, x), atan2(z, hypot(x, y)), slot};
    }
}

/* Widens the latitudes by the extremes of the great circle of the edge from a to b, if the edge can
 * reach them: it rises at its start and falls at its end, or the reverse. */
static void include_bulge(const double a[3], const double b[3], range *r) {
    double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    double rise_a = n[0] * a[1] - n[1] * a[0], rise_b = n[0] * b[1] - n[1] * b[0];
    double length = fabs(n[0]) + fabs(n[1]) + fabs(n[2]);
    double slack_a = MARGIN * length * (fabs(a[0]) + fabs(a[1]) + fabs(a[2]));
    double slack_b = MARGIN * length * (fabs(b[0]) + fabs(b[1]) + fabs(b[2]));
    double extreme = atan2(hypot(n[0], n[1]), fabs(n[2]));
    if (rise_a >= -slack_a && rise_b <= slack_b)
        r->theta_high = fmax(r->theta_high, extreme);
    if (rise_a <= slack_a && rise_b >= -slack_b)
        r->theta_low = fmin(r->theta_low, -extreme);
}

/* Nearly parallel directions do not determine a great circle reliably. */
static bool nearly_parallel(const double a[3], const double b[3]) {
    double n = fabs(a[1] * b[2] - a[2] * b[1]) + fabs(a[2] * b[0] - a[0] * b[2]) +
               fabs(a[0] * b[1] - a[1] * b[0]);
    double size = (fabs(a[0]) + fabs(a[1]) + fabs(a[2])) * (fabs(b[0]) + fabs(b[1]) + fabs(b[2]));
    return !(n > 0x1p-20 * size);
}

static void measure_latitudes(double d[3][3], const direction *const v[3], range *r) {
    r->theta_low = fmin(v[0]->theta, fmin(v[1]->theta, v[2]->theta));
    r->theta_high = fmax(v[0]->theta, fmax(v[1]->theta, v[2]->theta));
    for (int k = 0; k < 3; k++) {
        const double *a = d[k], *b = d[(k + 1) % 3];
        if (!nearly_parallel(a, b)) {
            include_bulge(a, b, r);
        } else if (vec3_dot(a, b) > 0) {
            /* a short arc: it bulges by less than its length */
            r->theta_low -= 0x1p-18;
            r->theta_high += 0x1p-18;
        } else {
            r->theta_low = -PI;
            r->theta_high = PI;
        }
    }
}

/* Sorts three longitudes and measures the gaps between them around the circle. A gap larger than pi
 * lies outside the face, whose range is the rest; without one the cone contains a pole (or is too
 * close to tell). Adds one range, or two across the seam. */
static size_t measure_range(const visibility_scene *scene, const direction *directions,
                            const double p[3], uint32_t rank, range *out) {
    const direction *v[3];
    double d[3][3], phi[3];
    bool polar = false;
    for (int k = 0; k < 3; k++) {
        uint32_t slot = scene->corners[3 * (size_t)rank + (size_t)k];
        v[k] = &directions[slot];
        phi[k] = v[k]->phi;
        d[k][0] = scene->x[slot] - p[0];
        d[k][1] = scene->y[slot] - p[1];
        d[k][2] = scene->z[slot] - p[2];
        polar = polar || fabs(v[k]->theta) > PI / 2 - 0x1p-20;
    }
    range r = {.rank = rank};
    measure_latitudes(d, v, &r);
    r.theta_low -= MARGIN;
    r.theta_high += MARGIN;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (phi[j] > phi[j + 1]) {
                double swap = phi[j];
                phi[j] = phi[j + 1];
                phi[j + 1] = swap;
            }
    double gap[3] = {phi[1] - phi[0], phi[2] - phi[1], phi[0] + 2 * PI - phi[2]};
    int widest = gap[0] > gap[1] ? (gap[0] > gap[2] ? 0 : 2) : (gap[1] > gap[2] ? 1 : 2);
    if (polar || gap[widest] < PI + MARGIN) {
        out[0] = (range){-PI - 1, PI + 1, -PI, PI, rank};
        return 1;
    }
    if (widest == 2) {
        r.phi_low = phi[0] - MARGIN;
        r.phi_high = phi[2] + MARGIN;
        out[0] = r;
        return 1;
    }
    out[0] = out[1] = r;
    out[0].phi_low = -PI - 1;
    out[0].phi_high = phi[widest] + MARGIN;
    out[1].phi_low = phi[widest + 1] - MARGIN;
    out[1].phi_high = PI + 1;
    return 2;
}

static size_t measure_ranges(const visibility_scene *scene, const double p[3], const int8_t *side,
                             sweep_scratch *s) {
    size_t count = 0;
    for (size_t rank = 0; rank < scene->face_count; rank++)
        if (scene_may_block(scene, rank, side[rank]))
            count += measure_range(scene, s->directions, p, (uint32_t)rank, s->ranges + count);
    return count;
}

/* Tests one vertex against the active faces; drops faces whose range has passed. */
static bool sees(const visibility_scene *scene, sweep_scratch *s, size_t *active_count,
                 const double p[3], const int8_t *side, const direction *v) {
    size_t i = 0;
    while (i < *active_count) {
        const range *r = &s->ranges[s->active[i]];
        if (r->phi_high < v->phi) {
            s->active[i] = s->active[--*active_count];
            continue;
        }
        if (r->theta_low <= v->theta && v->theta <= r->theta_high &&
            scene_blocks(scene, r->rank, side[r->rank], p, v->slot))
            return false;
        i++;
    }
    return true;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible) {
    (void)view;
    sweep_scratch *s = scratch;
    measure_directions(scene, p, s->directions);
    size_t range_count = measure_ranges(scene, p, side, s), next = 0, active_count = 0;
    memcpy(s->sorted, s->directions, scene->vertex_count * sizeof *s->sorted);
    qsort(s->sorted, scene->vertex_count, sizeof *s->sorted, compare_directions);
    qsort(s->ranges, range_count, sizeof *s->ranges, compare_ranges);
    for (size_t i = 0; i < scene->vertex_count; i++) {
        const direction *v = &s->sorted[i];
        while (next < range_count && s->ranges[next].phi_low <= v->phi)
            s->active[active_count++] = (uint32_t)next++;
        visible[v->slot] = sees(scene, s, &active_count, p, side, v);
    }
}

const visibility_engine visibility_sweep = {make_scratch, free_scratch, find, NULL};
