/* SPDX-License-Identifier: Apache-2.0 */
/* Star-shaped solids: filled by cones from a point of each kernel.
 *
 * Problem: two solids have the same faces, and each has a point that sees all of its own strictly.
 * Fill both with the same tetrahedra, positive in both.
 *
 * Method: a tetrahedron for each face, with the point as its last corner. That it is positive is
 * what the kernel says, so that nothing is left to descent. Where the faces of both are seen in the
 * same directions (starg_map_options.solid), a corner at p = g + r u in A and q = h + s u in B is
 * on the straight way from p to q at distance (1 - t) r + t s in direction u from the point that
 * moves from g to h: determinants of three directions are multiplied by positive numbers only, so
 * no tetrahedron is inverted at any time.
 *
 * Invariant: all signs are exact. Cost: a linear program and two passes over the faces. */
#include "morph/solid_map.h"

#include "core/rng.h"
#include "core/streams.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/kernel.h"

static const char STAGE[] = "stars";
static const double COARSE = 0.25; /* step of a center's coordinates, over its distance to planes */

/* ---- kernels ---- */

/* To multiples of a power of two, about a quarter of the room there is. */
static void simplify(const kernel_faces *faces, double radius, double center[3]) {
    double simple[3];
    int exponent;
    if (!(radius > 0))
        return;
    frexp(COARSE * radius, &exponent);
    for (int k = 0; k < 3; k++)
        simple[k] = ldexp(rint(ldexp(center[k], 1 - exponent)), exponent - 1);
    if (kernel_sees_all(faces, simple))
        vec3_copy(simple, center);
}

/* Moves it within half of the room. */
static void shake(starg_context *context, const kernel_faces *faces, double radius,
                  uint64_t attempt, double center[3]) {
    starg_rng rng = starg_rng_make(context->seed, STREAM_SOLID_STARS, attempt);
    double way[3], moved[3];
    starg_rng_direction(&rng, way);
    vec3_along(center, 0.5 * radius, way, moved);
    if (kernel_sees_all(faces, moved))
        vec3_copy(moved, center);
}

static starg_status find_center(starg_context *context, const kernel_faces *faces, uint64_t attempt,
                                double center[3], bool *found) {
    starg_kernel_result result;
    starg_status status = kernel_find(context, faces, &result);
    *found = status == STARG_OK && result.verdict == STARG_KERNEL_INTERIOR;
    if (!*found)
        return status;
    vec3_copy(result.guard, center);
    if (attempt == 0)
        simplify(faces, result.radius, center);
    else
        shake(context, faces, result.radius, attempt, center);
    return status;
}

/* The faces, outward. */
static starg_status orient(starg_context *context, const starg_mesh *mesh, uint32_t **out) {
    size_t size = 3 * mesh->face_count;
    bool inward = starg_mesh_volume(mesh) < 0;
    NEW(context, STAGE, *out, size);
    for (size_t i = 0; i < size; i++)
        (*out)[i] = mesh->faces[inward ? i / 3 * 3 + 2 - i % 3 : i];
    return STARG_OK;
}

starg_status stars_center(starg_context *context, const starg_mesh *mesh, uint64_t attempt,
                          double center[3], bool *found) {
    SCOPED uint32_t *faces = NULL;
    *found = false;
    TRY(orient(context, mesh, &faces));
    const kernel_faces surface = {mesh->vertices, faces, mesh->face_count};
    return find_center(context, &surface, attempt, center, found);
}

/* ---- cones ---- */

static starg_status add_cones(const kernel_faces ends[2], const double centers[2][3],
                              const uint32_t *own, deform_mesh *c) {
    for (size_t i = 0; i <= c->fixed; i++)
        for (size_t k = 0; k < 3; k++) {
            size_t v = i < c->fixed ? 3 * (size_t)c->surface[i] + k : 0;
            PUSH(c->context, STAGE, &c->rest, i < c->fixed ? ends[0].vertices[v] : centers[0][k]);
            PUSH(c->context, STAGE, &c->now, i < c->fixed ? ends[1].vertices[v] : centers[1][k]);
        }
    for (size_t f = 0; f < ends[0].count; f++) {
        const uint32_t *corner = ends[0].faces + 3 * f;
        const uint32_t cone[4] = {own[corner[0]], own[corner[2]], own[corner[1]],
                                  (uint32_t)c->fixed};
        for (int k = 0; k < 4; k++)
            PUSH(c->context, STAGE, &c->tetrahedra, cone[k]);
    }
    return STARG_OK;
}

static starg_status find_centers(starg_context *context, const kernel_faces ends[2],
                                 const double *given, double centers[2][3], bool *found) {
    *found = given != NULL;
    for (size_t end = 0; end < 2 && *found; end++) {
        vec3_copy(given + 3 * end, centers[end]);
        *found = kernel_sees_all(&ends[end], centers[end]) &&
                 kernel_winding(&ends[end], centers[end]) == 1;
    }
    if (*found)
        return STARG_OK;
    TRY(find_center(context, &ends[0], 0, centers[0], found));
    if (*found)
        TRY(find_center(context, &ends[1], 0, centers[1], found));
    return STARG_OK;
}

starg_status stars_fill(const starg_mesh *a, const double *images, const double *centers,
                        deform_mesh *c, uint32_t **surface, bool *found) {
    SCOPED uint32_t *faces = NULL, *own = NULL;
    double places[2][3];
    *found = false;
    TRY(orient(c->context, a, &faces));
    const kernel_faces ends[2] = {{a->vertices, faces, a->face_count},
                                  {images, faces, a->face_count}};
    TRY(find_centers(c->context, ends, centers, places, found));
    if (!*found)
        return STARG_OK;
    TRY(solids_list_surface(a, c, surface));
    NEW(c->context, STAGE, own, a->vertex_count);
    for (uint32_t v = 0; v < c->fixed; v++)
        own[c->surface[v]] = v;
    return add_cones(ends, (const double(*)[3])places, own, c);
}
