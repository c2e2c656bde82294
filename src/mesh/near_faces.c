/* SPDX-License-Identifier: Apache-2.0 */
/* Guards that are bound to faces of the model: straight above some of them (floors), or no farther
 * than a distance from some (ceilings, masts).
 *
 * Each list has a tree of its own. A place is above a face if the segment from it straight down, as
 * long as the height, meets the face: exact for the end of the segment as it is rounded. Distances
 * are rounded, as clearances are. Cost of a question: typically O(log n). */
#include "mesh/solid.h"

#include "geometry/intersect.h"
#include "geometry/vec3.h"

static const char STAGE[] = "scene";

static starg_status check_list(starg_context *context, const char *what, const uint32_t *list,
                               size_t count, size_t faces) {
    for (size_t i = 0; i < count; i++)
        if (list[i] >= faces || (i > 0 && list[i] <= list[i - 1]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "number %zu of the faces %s guards stand is %lu; they must be "
                              "ascending, and the model has %zu",
                              i, what, (unsigned long)list[i], faces);
    return STARG_OK;
}

static bool is_length(double x) {
    return x > 0 && x < 1e100;
}

starg_status near_faces_check(starg_context *context, const starg_space_options *o, size_t faces) {
    TRY(check_list(context, "over which", o->over, o->over_count, faces));
    TRY(check_list(context, "near which", o->mount, o->mount_count, faces));
    TRY(check_list(context, "through which views go, where", o->clear, o->clear_count, faces));
    if (o->over_count > 0 && !is_length(o->height))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "guards stand up to %g above faces; the height must be above zero",
                          o->height);
    if (o->mount_count > 0 && !is_length(o->mount_distance))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "guards stand up to %g from faces; the distance must be above zero",
                          o->mount_distance);
    for (int k = 0; k < 3; k++)
        if (!(fabs(o->up[k]) < 1e100))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "what is up is not finite");
    return STARG_OK;
}

starg_status near_faces_make(starg_context *context, const starg_mesh *model,
                             const double *vertices, const uint32_t *list, size_t count,
                             near_faces *out) {
    if (count == 0)
        return STARG_OK;
    NEW(context, STAGE, out->list, count);
    NEW(context, STAGE, out->corners, 3 * count);
    for (size_t i = 0; i < count; i++) {
        out->list[i] = list[i];
        memcpy(out->corners + 3 * i, model->faces + 3 * (size_t)list[i], 3 * sizeof *out->corners);
    }
    out->count = count;
    return bvh_create(context, vertices, out->corners, count, &out->tree);
}

void near_faces_free(near_faces *faces) {
    bvh_free(faces->tree);
    RELEASE(faces->list, faces->corners);
    *faces = (near_faces){0};
}

void near_faces_up(const starg_space_options *options, double up[3]) {
    const double *given = options->up;
    double most = fmax(fabs(given[0]), fmax(fabs(given[1]), fabs(given[2]))), length = 0;
    for (int k = 0; k < 3; k++)
        up[k] = most > 0 ? given[k] / most : k == 1;
    length = vec3_length(up);
    for (int k = 0; k < 3; k++)
        up[k] /= length;
}

/* ---- straight above ---- */

typedef struct plumb {
    const near_faces *faces;
    double p[3], foot[3];
} plumb;

static bool is_missed(void *user, size_t rank) {
    const plumb *own = user;
    const uint32_t *c = own->faces->corners + 3 * (size_t)own->faces->tree->order[rank];
    const double *v = own->faces->tree->vertices;
    return !segment_meets_triangle(own->p, own->foot, v + 3 * (size_t)c[0], v + 3 * (size_t)c[1],
                                   v + 3 * (size_t)c[2]);
}

static bool stands_over(const near_faces *over, const starg_space_options *o, const double p[3]) {
    plumb own = {.faces = over};
    double up[3];
    near_faces_up(o, up);
    vec3_copy(p, own.p);
    vec3_along(p, -o->height, up, own.foot);
    return !bvh_query_segment(over->tree, own.p, own.foot, is_missed, &own);
}

bool near_faces_admit(const near_faces *over, const near_faces *mount, const starg_space_options *o,
                      const double p[3]) {
    if (mount->count > 0 && !(bvh_distance(mount->tree, p) <= o->mount_distance))
        return false;
    return over->count == 0 || stands_over(over, o, p);
}

/* ---- boxes ---- */

/* The box, and what lies straight below it: with a margin for rounding. */
static bvh_box drop(const bvh_box *box, const starg_space_options *o) {
    bvh_box all = *box;
    double up[3];
    near_faces_up(o, up);
    for (int k = 0; k < 3; k++) {
        double margin = 1e-9 * (o->height + fabs(box->lower[k]) + fabs(box->upper[k]));
        all.lower[k] -= fmax(o->height * up[k], 0) + margin;
        all.upper[k] -= fmin(o->height * up[k], 0) - margin;
    }
    return all;
}

static bool end_visit(void *user, uint32_t triangle) {
    (void)user;
    (void)triangle;
    return false;
}

bool near_faces_bar(const near_faces *over, const near_faces *mount, const starg_space_options *o,
                    const bvh_box *box) {
    if (over->count > 0) {
        bvh_box below = drop(box, o);
        if (bvh_query_box(over->tree, &below, end_visit, NULL))
            return true;
    }
    if (mount->count == 0)
        return false;
    bvh_box around = *box;
    for (int k = 0; k < 3; k++) {
        double margin = 1e-9 * (o->mount_distance + fabs(box->lower[k]) + fabs(box->upper[k]));
        around.lower[k] -= o->mount_distance + margin;
        around.upper[k] += o->mount_distance + margin;
    }
    return bvh_query_box(mount->tree, &around, end_visit, NULL);
}

bool near_faces_box(const near_faces *over, const near_faces *mount, const starg_space_options *o,
                    bvh_box *out) {
    double up[3];
    near_faces_up(o, up);
    for (int k = 0; k < 3; k++) {
        out->lower[k] = -INFINITY;
        out->upper[k] = INFINITY;
        if (over->count > 0) {
            const bvh_box *floor = &over->tree->nodes[0].box;
            out->lower[k] = floor->lower[k] + fmin(o->height * up[k], 0);
            out->upper[k] = floor->upper[k] + fmax(o->height * up[k], 0);
        }
        if (mount->count > 0) {
            const bvh_box *near = &mount->tree->nodes[0].box;
            out->lower[k] = fmax(out->lower[k], near->lower[k] - o->mount_distance);
            out->upper[k] = fmin(out->upper[k], near->upper[k] + o->mount_distance);
        }
    }
    return over->count > 0 || mount->count > 0;
}
