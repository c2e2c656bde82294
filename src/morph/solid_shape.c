/* SPDX-License-Identifier: Apache-2.0 */
/* The surface of a solid on that of a ball or a cube.
 *
 * Its vertices go to their directions in a spherical embedding (sphere/sphere.h), all of whose
 * triangles are positive, or from there along rays to the cube. The cones from the origin stay
 * positive: a determinant of three rays is multiplied by positive numbers only. So the image bounds
 * a polyhedron that is star-shaped about the origin. */

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/solid.h"
#include "morph/solid_map.h"
#include "morph/surface_map.h"
#include "sphere/sphere.h"

static const char STAGE[] = "solid map";

static starg_status check_topology(starg_context *context, const starg_check *check) {
    if (check->components != 1)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "A's surface has %zu components; a ball or a cube has one",
                          check->components);
    if (check->genus != 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "A has genus %lld; a ball or a cube has genus 0",
                          (long long)check->genus);
    if (check->findings[STARG_FINDING_ISOLATED_VERTEX].count > 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "A has vertices without faces; remove them with 'starguard repair'");
    return STARG_OK;
}

static void project(const double direction[3], starg_solid_shape shape, double out[3]) {
    double length = vec3_length(direction);
    if (shape == STARG_SOLID_CUBE)
        length = fmax(fmax(fabs(direction[0]), fabs(direction[1])), fabs(direction[2]));
    for (int k = 0; k < 3; k++)
        out[k] = direction[k] / length;
}

/* Rounding can turn a sliver over. */
static starg_status check_positive(starg_context *context, const starg_mesh *mesh,
                                   const double *images) {
    static const double origin[3];
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *c = mesh->faces + 3 * f;
        uint64_t face = f;
        if (orient3d(images + 3 * (size_t)c[0], images + 3 * (size_t)c[1],
                     images + 3 * (size_t)c[2], origin) != 1)
            return starg_fail_at(context, STARG_ERROR_SOLVER, STAGE, STARG_ELEMENT_FACE, &face, 1,
                                 "face %zu of A is so thin on the sphere that rounding turns it "
                                 "over",
                                 f);
    }
    return STARG_OK;
}

starg_status solid_map_shape(starg_context *context, const starg_mesh *a, starg_solid_shape shape,
                             double **images) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *unit = NULL;
    SCOPED_BY(sphere_drop) sphere *s = NULL;
    TRY(solid_make_in_time(context, a, &solid));
    TRY(solid_must_not_share(context, solid, STAGE));
    TRY(check_topology(context, starg_solid_check(solid)));
    TRY(map_unit_copy(context, starg_solid_mesh(solid), &unit));
    TRY(sphere_create(context, unit, &s));
    NEW(context, STAGE, *images, 3 * unit->vertex_count);
    for (size_t v = 0; v < unit->vertex_count; v++)
        project(s->directions + 3 * v, shape, *images + 3 * v);
    return check_positive(context, unit, *images);
}
