/* SPDX-License-Identifier: Apache-2.0 */
/* How fine are the parts in which faces are seen?
 *
 * Where views are limited, or the free space is that of a building, a wall of two triangles is seen
 * by several guards, a part by each. The edges of parts are then at most a share of the diagonal,
 * of the range, and of how wide a view is at that distance; twice as long, as often as it takes, if
 * that would be too many parts. A surface that is finer stays as it is. */
#include "guard/stages.h"

#include <math.h>

#include "visibility/sensor.h"

static const double OF_DIAGONAL = 1.0 / 24, OF_VIEW = 1.0 / 8;

enum { MOST_CHOSEN = 20000 };

static bool wants_patches(const starg_solid *solid, const starg_visibility_options *view) {
    return sensor_is_directed(view) || view->range < 1e100 || view->incidence > 0 ||
           (solid->scene && (solid->space.soup || solid->mount.count > 0));
}

/* How wide the view is at this distance. */
static double width_of(const starg_visibility_options *view, double distance) {
    double degrees = view->fov[0] > 0 ? fmin(view->fov[0], view->fov[1]) : view->cone;
    return degrees < 170 ? 2 * distance * tan(degrees * (3.14159265358979323846 / 360)) : INFINITY;
}

static double choose_length(const starg_solid *solid, const starg_visibility_options *view) {
    double diagonal = solid->check->diagonal;
    double range = fmin(view->range, starg_density_depth(view, 0));
    double length = fmin(OF_DIAGONAL * diagonal,
                         OF_VIEW * fmin(range, width_of(view, fmin(range, 0.5 * diagonal))));
    size_t faces = starg_space_model_faces(solid);
    size_t most = solid->mesh->face_count + faces / 10 + MOST_CHOSEN;
    while (patches_count(solid->mesh, faces, length, most) > most)
        length *= 2;
    return length;
}

starg_status patched_solid_make(starg_context *context, const starg_solid *solid,
                                starg_visibility_options *view, patched_solid *out) {
    bool chosen = view->patch == STARG_PATCH_AUTO;
    *out = (patched_solid){.solid = *solid};
    if (view->target != STARG_TARGET_FACES || (chosen && !wants_patches(solid, view)))
        view->patch = STARG_PATCH_OFF;
    else if (chosen)
        view->patch = choose_length(solid, view);
    if (view->patch == STARG_PATCH_OFF)
        return STARG_OK;
    TRY(patches_divide(context, solid->mesh, starg_space_model_faces(solid), view->patch,
                       solid_is_two_sided(solid) ? solid->other_side : NULL, &out->patches));
    out->solid.patches = out->patches;
    if (chosen && out->patches == NULL)
        view->patch = STARG_PATCH_OFF;
    return STARG_OK;
}

void patched_solid_free(patched_solid *patched) {
    patches_free(patched->patches);
    *patched = (patched_solid){0};
}
