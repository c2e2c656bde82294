/* SPDX-License-Identifier: Apache-2.0 */
/* Zones of a result: is a place in the union of those in which guards may stand, and in none of the
 * others? Boxes and closed meshes, with their borders; the inside of a mesh is where its winding
 * number, by exact signs (verify/winding.c), is not zero. */
#include "core/memory.h"
#include "verify/facts.h"

static const char STAGE[] = "verify";

struct verify_zones {
    starg_context *context;
    size_t count;
    const starg_guard_zone *list;
    verify_surface **surfaces; /* by zone; NULL: it is its box */
    verify_tree **trees;
};

static starg_status add_mesh(verify_zones *zones, size_t index, const starg_mesh *mesh) {
    const starg_guard_zone *zone = &zones->list[index];
    if (mesh == NULL || starg_mesh_vertex_count(mesh) != zone->vertex_count ||
        starg_mesh_face_count(mesh) != zone->face_count)
        return starg_fail(zones->context, STARG_ERROR_MESH, STAGE,
                          "zone %zu of the result is a mesh with %zu vertices and %zu faces, and "
                          "another one is given",
                          index, zone->vertex_count, zone->face_count);
    starg_status status = verify_surface_create(zones->context, mesh, &zones->surfaces[index]);
    return status == STARG_OK ? verify_tree_create(zones->surfaces[index], &zones->trees[index])
                              : status;
}

starg_status verify_zones_create(starg_context *context, const starg_guards *guards,
                                 const starg_mesh *const *meshes, verify_zones **out) {
    SCOPED_BY(verify_zones_drop) verify_zones *zones = NULL;
    *out = NULL;
    if (guards->zone_count == 0)
        return STARG_OK;
    NEW_ZERO(context, STAGE, zones, 1);
    *zones = (verify_zones){.context = context, .list = guards->zones};
    NEW_ZERO(context, STAGE, zones->surfaces, guards->zone_count);
    NEW_ZERO(context, STAGE, zones->trees, guards->zone_count);
    zones->count = guards->zone_count;
    for (size_t i = 0; i < zones->count; i++)
        if (guards->zones[i].face_count > 0)
            TRY(add_mesh(zones, i, meshes != NULL ? meshes[i] : NULL));
    *out = zones;
    zones = NULL;
    return STARG_OK;
}

void verify_zones_free(verify_zones *zones) {
    if (zones == NULL)
        return;
    for (size_t i = 0; i < zones->count; i++) {
        verify_tree_free(zones->trees[i]);
        verify_surface_free(zones->surfaces[i]);
    }
    RELEASE(zones->trees, zones->surfaces, zones);
}

static bool is_in(const verify_zones *zones, size_t index, const double p[3]) {
    const double *box = zones->list[index].box;
    bool on_surface, in = true;
    if (zones->trees[index] != NULL)
        return verify_tree_winding(zones->trees[index], p, &on_surface) != 0 || on_surface;
    for (int k = 0; k < 3; k++)
        in = in && box[k] <= p[k] && p[k] <= box[k + 3];
    return in;
}

bool verify_zones_admit(const verify_zones *zones, const double p[3]) {
    size_t within = 0, wanted = 0;
    for (size_t i = 0; zones != NULL && i < zones->count; i++) {
        bool in = is_in(zones, i, p);
        if (zones->list[i].excludes && in)
            return false;
        wanted += !zones->list[i].excludes;
        within += !zones->list[i].excludes && in;
    }
    return wanted == 0 || within > 0;
}
