/* SPDX-License-Identifier: Apache-2.0 */
/* Working surface of the simplification: applies a collapse to positions, edge numbers and
 * component volumes. Cost: O(degree of the removed vertex). */
#include "mesh/levels/levels.h"

#include "geometry/vec3.h"

static starg_status fail_edge(starg_context *context, uint32_t a, uint32_t b, const char *what) {
    const uint64_t ends[2] = {a, b};
    return starg_fail_at(context, STARG_ERROR_MESH, "simplify", STARG_ELEMENT_EDGE, ends, 2,
                         "the edge from vertex %u to vertex %u %s; only closed, oriented "
                         "2-manifolds can be simplified; try 'starguard repair'",
                         a, b, what);
}

static starg_status check_edges(starg_context *context, const starg_mesh *mesh,
                                const mesh_topology *topology) {
    const uint32_t *faces = mesh->faces;
    if (mesh->face_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, "simplify", "the mesh has no faces");
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        uint32_t a = faces[h], b = faces[corner_next(h)];
        if (a == b)
            return fail_edge(context, a, b, "joins a vertex to itself");
        if (topology->twin[h] == TOPOLOGY_NONE)
            return fail_edge(context, a, b, "does not have two faces");
        if (faces[topology->twin[h]] != b)
            return fail_edge(context, a, b, "has faces that traverse it in the same direction");
    }
    return STARG_OK;
}

/* Every corner must be reached by walking around its vertex. */
static starg_status check_fans(const mesh_surface *s) {
    size_t met = 0;
    for (size_t v = 0; v < s->vertex_count; v++) {
        uint32_t first = s->mesh.leaving.data[v], h = first;
        if (h == TOPOLOGY_NONE)
            continue;
        do {
            met++;
            h = halfedges_turn(&s->mesh, h);
        } while (h != first);
    }
    if (met == 3 * s->face_count)
        return STARG_OK;
    return starg_fail(s->context, STARG_ERROR_MESH, "simplify",
                      "some vertices have faces in more than one fan; only closed, oriented "
                      "2-manifolds can be simplified; try 'starguard repair'");
}

static void number_edges(mesh_surface *s) {
    uint32_t edge = 0;
    for (uint32_t h = 0; h < 3 * s->face_count; h++) {
        if (h > halfedges_twin(&s->mesh, h))
            continue;
        s->edge[h] = s->edge[halfedges_twin(&s->mesh, h)] = edge;
        s->halfedge[edge++] = h;
    }
}

static void find_used(mesh_surface *s) {
    for (size_t v = 0; v < s->vertex_count; v++) {
        bool used = s->mesh.leaving.data[v] != TOPOLOGY_NONE;
        s->merged[v] = used ? (uint32_t)v : TOPOLOGY_NONE;
        s->vertices_left += used;
    }
}

/* Measured from a corner of each component, so that small distant ones do not lose digits. */
static starg_status measure_volumes(mesh_surface *s) {
    SCOPED uint32_t *origin = NULL;
    NEW(s->context, "simplify", origin, s->component_count);
    memset(origin, 0xff, s->component_count * sizeof *origin);
    for (size_t f = 0; f < s->face_count; f++) {
        const uint32_t *corner = surface_face(s, f), c = s->component[f];
        double p[3][3];
        if (origin[c] == TOPOLOGY_NONE)
            origin[c] = corner[0];
        for (int k = 0; k < 3; k++)
            surface_difference(s, surface_at(s, corner[k]), surface_at(s, origin[c]), p[k]);
        s->volume[c] += vec3_triple(p[0], p[1], p[2]);
    }
    return STARG_OK;
}

/* Limited so that the scale and its inverse are finite. */
static double scale_of(const starg_mesh *mesh) {
    int exponent = starg_mesh_exponent(mesh);
    return ldexp(1, -(exponent < -1000 ? -1000 : exponent));
}

/* Takes the components from the topology. */
static starg_status fill(mesh_surface *s, const starg_mesh *mesh, mesh_topology *topology) {
    starg_context *context = s->context;
    s->vertex_count = mesh->vertex_count;
    s->face_count = s->faces_left = mesh->face_count;
    s->edge_count = 3 * mesh->face_count / 2; /* two of an edge that four faces share */
    s->component_count = topology->component_count;
    s->scale = scale_of(mesh);
    NEW(context, "simplify", s->vertices, 3 * s->vertex_count);
    TRY(halfedges_create(topology, mesh, "simplify", &s->mesh));
    NEW(context, "simplify", s->edge, 3 * s->face_count);
    NEW(context, "simplify", s->halfedge, s->edge_count);
    NEW(context, "simplify", s->merged, s->vertex_count);
    NEW_ZERO(context, "simplify", s->volume, s->component_count);
    memcpy(s->vertices, mesh->vertices, 3 * s->vertex_count * sizeof *s->vertices);
    s->component = topology->component;
    topology->component = NULL;
    number_edges(s);
    find_used(s);
    TRY(check_fans(s));
    return measure_volumes(s);
}

starg_status surface_create(starg_context *context, const starg_mesh *mesh, mesh_surface **out) {
    SCOPED_BY(surface_drop) mesh_surface *surface = NULL;
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    *out = NULL;
    TRY(wings_create(context, mesh, &topology));
    TRY(check_edges(context, mesh, topology));
    NEW_ZERO(context, "simplify", surface, 1);
    surface->context = context;
    TRY(fill(surface, mesh, topology));
    *out = surface;
    surface = NULL;
    return STARG_OK;
}

void surface_free(mesh_surface *surface) {
    if (surface == NULL)
        return;
    starg_release(surface->context, surface->vertices);
    halfedges_free(&surface->mesh);
    RELEASE(surface->edge, surface->halfedge, surface->merged, surface->component, surface->volume,
            surface);
}

/* Change of the volume in a collapse: the star of either end, as seen from the new position. */
static void update_volume(mesh_surface *s, uint32_t halfedge, const double position[3]) {
    uint32_t a = halfedges_start(&s->mesh, halfedge), b = halfedges_end(&s->mesh, halfedge);
    double lost = 0;
    for (int end = 0; end < 2; end++) {
        uint32_t first = end ? halfedges_twin(&s->mesh, halfedge) : halfedge, h = first;
        do {
            const uint32_t *corner = surface_face(s, h / 3);
            bool both = (corner[0] == a || corner[1] == a || corner[2] == a) &&
                        (corner[0] == b || corner[1] == b || corner[2] == b);
            double p[3][3];
            for (int k = 0; k < 3; k++)
                surface_difference(s, surface_at(s, corner[k]), position, p[k]);
            if (end == 0 || !both)
                lost += vec3_triple(p[0], p[1], p[2]);
            h = halfedges_turn(&s->mesh, h);
        } while (h != first);
    }
    s->volume[s->component[halfedge / 3]] -= lost;
}

/* In a face of a collapsed edge the other two sides become one edge, numbered as that of `kept`. */
static void merge_edges(mesh_surface *s, uint32_t gone, uint32_t kept) {
    uint32_t outer_gone = halfedges_twin(&s->mesh, gone);
    s->halfedge[s->edge[gone]] = TOPOLOGY_NONE;
    s->edge[outer_gone] = s->edge[kept];
    s->halfedge[s->edge[kept]] = halfedges_twin(&s->mesh, kept);
}

void surface_collapse(mesh_surface *s, uint32_t halfedge, const double position[3]) {
    uint32_t twin = halfedges_twin(&s->mesh, halfedge);
    uint32_t a = halfedges_start(&s->mesh, halfedge), b = halfedges_end(&s->mesh, halfedge);
    update_volume(s, halfedge, position);
    s->halfedge[s->edge[halfedge]] = TOPOLOGY_NONE;
    merge_edges(s, corner_next(halfedge), corner_previous(halfedge));
    merge_edges(s, corner_previous(twin), corner_next(twin));
    halfedges_collapse(&s->mesh, halfedge);
    s->merged[b] = a;
    vec3_copy(position, s->vertices + 3 * (size_t)a);
    s->vertices_left--;
    s->faces_left -= 2;
}
