/* SPDX-License-Identifier: Apache-2.0 */
/* What shows where a camera looks: the sides of its cone or pyramid, from the guard as far as its
 * range or, if that is far, a tenth of what is shown. */

#include "export/export.h"
#include "geometry/vec3.h"
#include "visibility/sensor.h"

static const double PI = 3.14159265358979323846, SHARE = 0.1;

size_t scene_view_sides(const scene_job *job) {
    const starg_guards *g = job->scene->guards;
    if (job->guards == 0 || g->directions == NULL)
        return 0;
    return g->options.visibility.fov[0] > 0 ? VIEW_FRAME : VIEW_SIDES;
}

static double length_of(const scene_job *job) {
    return fmin(job->scene->guards->options.visibility.range, SHARE * job->size);
}

/* Across and up, as parts of the way ahead, to corner k of a pyramid. */
static void frame_corner(const double fov[2], size_t k, double way[3]) {
    way[0] = tan(fov[0] * PI / 360) * (k == 0 || k == 3 ? -1 : 1);
    way[1] = tan(fov[1] * PI / 360) * (k < 2 ? -1 : 1);
    way[2] = 1;
}

/* The same on the rim of a cone. */
static void rim_corner(double cone, size_t k, double way[3]) {
    double half = cone * PI / 360, turn = 2 * PI * (double)k / VIEW_SIDES;
    way[0] = sin(half) * cos(turn);
    way[1] = sin(half) * sin(turn);
    way[2] = cos(half);
}

void scene_view_corner(const scene_job *job, size_t guard, size_t corner, double p[3]) {
    static const double Y[3] = {0, 1, 0};
    const starg_guards *g = job->scene->guards;
    const starg_visibility_options *o = &g->options.visibility;
    double frame[3][3], way[3];
    vec3_copy(g->positions + 3 * guard, p);
    if (corner == 0)
        return;
    sensor_frame(g->directions + 3 * guard, g->ups != NULL ? g->ups + 3 * guard : Y, frame);
    if (o->fov[0] > 0)
        frame_corner(o->fov, corner - 1, way);
    else
        rim_corner(o->cone, corner - 1, way);
    double scale = length_of(job) / vec3_length(way);
    for (int axis = 0; axis < 3; axis++)
        vec3_along(p, scale * way[axis], frame[axis], p);
}

void scene_view_face(const scene_job *job, size_t face, uint32_t corners[3]) {
    size_t sides = scene_view_sides(job), side = face % sides;
    uint32_t base = (uint32_t)(face / sides * (sides + 1));
    corners[0] = base;
    corners[1] = base + 1 + (uint32_t)side;
    corners[2] = base + 1 + (uint32_t)((side + 1) % sides);
}
