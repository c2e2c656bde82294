/* SPDX-License-Identifier: Apache-2.0 */
/* Zones: boxes and closed meshes in which guards may stand, or may not. None of them blocks a view.
 *
 * A guard may stand in the union of the zones of the first kind, if there are any, but in none of
 * the second. All of them are closed: their borders belong to them. A place is in a mesh if it is
 * on its surface or its winding number is not zero, by exact signs.
 *
 * Of a box of places it is certain that none is allowed if it meets no zone of the first kind, or
 * lies in one of the second. It meets the surface of a mesh only if that is no farther from its
 * centre than half its diagonal; else all of it is where its centre is. Distances are rounded, for
 * which a millionth is more than enough. Cost: typically O(log n) for each mesh. */
#include "mesh/solid.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/vec3.h"

static const char STAGE[] = "scene";

static starg_status check_box(starg_context *context, const double box[6], size_t index) {
    for (int k = 0; k < 3; k++)
        if (!(fabs(box[k]) < 1e100 && fabs(box[k + 3]) < 1e100 && box[k] < box[k + 3]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "the box of zone %zu reaches from %g to %g along %c; both must be "
                              "finite, and the first below the second",
                              index, box[k], box[k + 3], "xyz"[k]);
    return STARG_OK;
}

/* An open mesh has no inside. */
static starg_status take_mesh(starg_context *context, const starg_mesh *mesh, size_t index,
                              zone *out) {
    starg_status status = solid_make(context, mesh, &out->solid);
    if (status == STARG_ERROR_MESH || status == STARG_ERROR_RANGE)
        return starg_fail(
            context, STARG_ERROR_MESH, STAGE,
            "the mesh of zone %zu is not closed, so that it has no inside; repair it, "
            "or give a box",
            index);
    return status;
}

static void widen(bvh_box *all, const bvh_box *by, bool first) {
    for (int k = 0; k < 3; k++) {
        all->lower[k] = first ? by->lower[k] : fmin(all->lower[k], by->lower[k]);
        all->upper[k] = first ? by->upper[k] : fmax(all->upper[k], by->upper[k]);
    }
}

starg_status zones_make(starg_context *context, const starg_zone *list, size_t count, zones *out) {
    *out = (zones){0};
    if (count == 0)
        return STARG_OK;
    NEW_ZERO(context, STAGE, out->list, count);
    out->count = count;
    for (size_t i = 0; i < count; i++) {
        zone *own = &out->list[i];
        const starg_zone *given = &list[i];
        own->excludes = given->excludes;
        if (given->mesh != NULL) {
            own->vertices = given->mesh->vertex_count;
            own->faces = given->mesh->face_count;
            TRY(take_mesh(context, given->mesh, i, own));
            own->box = own->solid->tree->nodes[0].box;
        } else {
            TRY(check_box(context, given->box, i));
            vec3_copy(given->box, own->box.lower);
            vec3_copy(given->box + 3, own->box.upper);
        }
        if (!own->excludes) {
            widen(&out->all, &own->box, !out->limits);
            out->limits = true;
        }
    }
    return STARG_OK;
}

void zones_free(zones *all) {
    for (size_t i = 0; all->list != NULL && i < all->count; i++)
        starg_solid_free(all->list[i].solid);
    RELEASE(all->list);
    *all = (zones){0};
}

static bool is_in(const zone *own, const double p[3]) {
    bool in = true, on_surface;
    for (int k = 0; k < 3; k++)
        in = in && p[k] >= own->box.lower[k] && p[k] <= own->box.upper[k];
    if (!in || own->solid == NULL)
        return in;
    int winding = bvh_winding(own->solid->tree, p, &on_surface);
    return on_surface || winding != 0;
}

bool zones_admit(const zones *all, const double p[3]) {
    bool in = !all->limits;
    for (size_t i = 0; i < all->count; i++) {
        if (all->list[i].excludes && is_in(&all->list[i], p))
            return false;
        in = in || (!all->list[i].excludes && is_in(&all->list[i], p));
    }
    return in;
}

typedef enum zone_side { OUT, ACROSS, IN } zone_side;

/* How much of a box of places is certain to be in the zone? */
static zone_side side_of(const zone *own, const bvh_box *box) {
    double centre[3], largest = 0, reach = 0.5 * vec3_distance(box->lower, box->upper);
    bool in = true;
    for (int k = 0; k < 3; k++) {
        if (box->lower[k] > own->box.upper[k] || box->upper[k] < own->box.lower[k])
            return OUT;
        in = in && box->lower[k] >= own->box.lower[k] && box->upper[k] <= own->box.upper[k];
        centre[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
        largest = fmax(largest, fmax(fabs(box->lower[k]), fabs(box->upper[k])));
    }
    if (own->solid == NULL)
        return in ? IN : ACROSS;
    double distance = bvh_distance(own->solid->tree, centre);
    if (!(distance > reach * (1 + 1e-6)) || largest > 1e6 * distance)
        return ACROSS;
    return is_in(own, centre) ? IN : OUT;
}

bool zones_bar(const zones *all, const bvh_box *box) {
    bool out = all->limits;
    for (size_t i = 0; i < all->count; i++) {
        zone_side side = side_of(&all->list[i], box);
        if (all->list[i].excludes && side == IN)
            return true;
        out = out && (all->list[i].excludes || side == OUT);
    }
    return out;
}
