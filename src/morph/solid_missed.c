/* SPDX-License-Identifier: Apache-2.0 */
/* How far the end of a map between solids is from B, where it ends at B in A's faces: bounds on
 * distances either way (star/deviation.c), and volumes. */
#include <math.h>

#include "star/decomposition.h"
#include "starguard/solidmap.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "solid map";
static const double STEP = 0.001; /* of distances, over the diagonal */

/* The surface of the tetrahedra at their end. */
static starg_status find_surface(starg_context *context, const starg_solid_map *map,
                                 starg_mesh **out) {
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *mesh = NULL;
    SCOPED double *vertices = NULL;
    SCOPED uint32_t *tetrahedra = NULL;
    NEW(context, STAGE, vertices, 3 * map->vertex_count);
    NEW(context, STAGE, tetrahedra, 4 * map->count);
    memcpy(vertices, map->images, 3 * map->vertex_count * sizeof *vertices);
    memcpy(tetrahedra, map->tetrahedra, 4 * map->count * sizeof *tetrahedra);
    TRY(tetmesh_adopt(context, vertices, map->vertex_count, tetrahedra, map->count, NULL, true,
                      &mesh));
    vertices = NULL;
    tetrahedra = NULL;
    return starg_tetmesh_surface(context, mesh, out, NULL);
}

static starg_status bound(starg_context *context, const starg_mesh *from, const starg_mesh *to,
                          double extent, double *out) {
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    TRY(bvh_create(context, to->vertices, to->faces, to->face_count, &tree));
    return deviation_bound(context, from, tree, extent, STEP * extent, out);
}

starg_status starg_solid_map_compare(starg_context *context, const starg_mesh *b,
                                     starg_solid_map *map) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *end = NULL;
    double extent = mesh_diagonal(b);
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(find_surface(context, map, &end));
    TRY(bound(context, end, b, extent, &map->distance));
    TRY(bound(context, b, end, extent, &map->distance_back));
    map->missing = fabs(starg_mesh_volume(b)) - starg_mesh_volume(end);
    map->compared = true;
    return STARG_OK;
}
