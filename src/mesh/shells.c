/* SPDX-License-Identifier: Apache-2.0 */
/* The depth of a shell is the number of other shells with nonzero winding number about one of its
 * corners, counted along a vertical line: usually O(log n) per shell. */
#include "mesh/shells.h"

#include <math.h>

#include "core/memory.h"
#include "geometry/vec3.h"

/* Windings are zero between queries; each query resets the shells that it touched. */
typedef struct line_query {
    const bvh *tree;
    const mesh_topology *topology;
    const double *p;
    int *winding;      /* per shell */
    uint32_t *touched; /* shells, one entry per crossing */
    size_t touched_count;
} line_query;

static bool count_crossing(void *user, uint32_t triangle) {
    line_query *query = user;
    int crossing = bvh_crossing(query->tree, triangle, query->p);
    if (crossing != 0) {
        query->winding[query->topology->component[triangle]] += crossing;
        query->touched[query->touched_count++] = query->topology->component[triangle];
    }
    return true;
}

/* Number of other shells that contain p, and their total winding number about it. */
static size_t nesting_depth(line_query *query, const double *p, uint32_t own, int *around) {
    bvh_box line = {{p[0], p[1], p[2]}, {p[0], p[1], INFINITY}};
    size_t depth = 0;
    *around = 0;
    query->p = p;
    query->touched_count = 0;
    bvh_query_box(query->tree, &line, count_crossing, query);
    for (size_t i = 0; i < query->touched_count; i++) {
        uint32_t touched = query->touched[i];
        depth += touched != own && query->winding[touched] != 0;
        *around += touched != own ? query->winding[touched] : 0;
        query->winding[touched] = 0;
    }
    return depth;
}

/* The innermost shell around a point in an odd number of them: of those that contain it, the only
 * one that is no cavity and lies in no other that is none. They are nested in each other, so it is
 * the deepest one. */
static uint32_t innermost(line_query *query, const double *p, uint32_t own, const size_t *depths) {
    bvh_box line = {{p[0], p[1], p[2]}, {p[0], p[1], INFINITY}};
    uint32_t best = UINT32_MAX;
    query->p = p;
    query->touched_count = 0;
    bvh_query_box(query->tree, &line, count_crossing, query);
    for (size_t i = 0; i < query->touched_count; i++) {
        uint32_t c = query->touched[i];
        if (c != own && query->winding[c] != 0 && (best == UINT32_MAX || depths[c] > depths[best]))
            best = c;
        query->winding[c] = 0;
    }
    return best;
}

static void sum_volumes(const starg_mesh *mesh, const mesh_topology *topology, mesh_shell *shells) {
    int exponent = starg_mesh_exponent(mesh);
    for (size_t f = mesh->face_count; f-- > 0;) {
        mesh_shell *own = &shells[topology->component[f]];
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            starg_mesh_scaled_corner(mesh, f, k, exponent, p[k]);
        own->volume += vec3_triple(p[0], p[1], p[2]) / 6;
        own->first_face = (uint32_t)f;
    }
}

starg_status shells_classify(starg_context *context, const starg_mesh *mesh,
                             const mesh_topology *topology, const bvh *tree, mesh_shell *shells) {
    starg_status status = STARG_OK;
    line_query query = {.tree = tree, .topology = topology};
    size_t *depths = NULL;
    STARG_NEW_ZERO(context, "check", query.winding, topology->component_count);
    STARG_NEW_ZERO(context, "check", depths, topology->component_count);
    STARG_NEW(context, "check", query.touched, mesh->face_count);
    sum_volumes(mesh, topology, shells);
    for (size_t c = 0; c < topology->component_count; c++) {
        mesh_shell *own = &shells[c];
        const double *p = mesh->vertices + 3 * (size_t)mesh->faces[3 * (size_t)own->first_face];
        if (!own->crossed)
            depths[c] = nesting_depth(&query, p, (uint32_t)c, &own->around);
        own->cavity = depths[c] % 2 == 1;
        own->turn = own->cavity ? own->volume > 0 : own->volume < 0;
    }
    for (size_t c = 0; c < topology->component_count; c++) {
        mesh_shell *own = &shells[c];
        const double *p = mesh->vertices + 3 * (size_t)mesh->faces[3 * (size_t)own->first_face];
        own->within = own->cavity ? innermost(&query, p, (uint32_t)c, depths) : UINT32_MAX;
    }
done:
    starg_release(context, depths);
    starg_release(context, query.winding);
    starg_release(context, query.touched);
    return status;
}
