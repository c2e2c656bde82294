/* The working surface of the simplification.
 *
 * A collapse removes the two faces of an edge; of the two remaining edges of each, one goes and
 * the halfedges outside become twins. Nothing is renumbered, so that a collapse costs O(degree of
 * the vertex that goes). */
#include "mesh/surface.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/vec3.h"

static starg_status fail_edge(starg_context *context, uint32_t a, uint32_t b, const char *what) {
    const uint64_t ends[2] = {a, b};
    return starg_fail_at(context, STARG_ERROR_MESH, "simplify", STARG_ELEMENT_EDGE, ends, 2,
                         "the edge from vertex %u to vertex %u %s; only closed, oriented "
                         "2-manifolds can be simplified, 'starguard repair' may make one",
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
            return fail_edge(context, a, b, "has faces that run along it the same way");
    }
    return STARG_OK;
}

/* Every corner must be met on the way about its vertex. */
static starg_status check_fans(const mesh_surface *s) {
    size_t met = 0;
    for (size_t v = 0; v < s->vertex_count; v++) {
        uint32_t h = s->outgoing[v];
        if (h == TOPOLOGY_NONE)
            continue;
        do {
            met++;
            h = surface_turn(s, h);
        } while (h != s->outgoing[v]);
    }
    if (met == 3 * s->face_count)
        return STARG_OK;
    return starg_fail(s->context, STARG_ERROR_MESH, "simplify",
                      "some vertices have faces in more than one fan; only closed, oriented "
                      "2-manifolds can be simplified, 'starguard repair' may make one");
}

static void number_edges(mesh_surface *s) {
    uint32_t edge = 0;
    for (uint32_t h = 0; h < 3 * s->face_count; h++) {
        if (h > s->twin[h])
            continue;
        s->edge[h] = s->edge[s->twin[h]] = edge;
        s->halfedge[edge++] = h;
    }
}

static void find_outgoing(mesh_surface *s) {
    for (size_t v = 0; v < s->vertex_count; v++)
        s->outgoing[v] = s->merged[v] = TOPOLOGY_NONE;
    for (size_t h = 3 * s->face_count; h-- > 0;)
        s->outgoing[s->faces[h]] = (uint32_t)h;
    for (size_t v = 0; v < s->vertex_count; v++) {
        if (s->outgoing[v] == TOPOLOGY_NONE)
            continue;
        s->merged[v] = (uint32_t)v;
        s->vertices_left++;
    }
}

/* About a corner of each component, so that small ones far away keep their digits. */
static starg_status measure_volumes(mesh_surface *s) {
    starg_status status = STARG_OK;
    uint32_t *origin = NULL;
    STARG_NEW(s->context, "simplify", origin, s->component_count);
    memset(origin, 0xff, s->component_count * sizeof *origin);
    for (size_t f = 0; f < s->face_count; f++) {
        const uint32_t *corner = s->faces + 3 * f, c = s->component[f];
        double p[3][3];
        if (origin[c] == TOPOLOGY_NONE)
            origin[c] = corner[0];
        for (int k = 0; k < 3; k++)
            surface_difference(s, surface_at(s, corner[k]), surface_at(s, origin[c]), p[k]);
        s->volume[c] += vec3_triple(p[0], p[1], p[2]);
    }
done:
    starg_release(s->context, origin);
    return status;
}

/* Within the range in which the scale and its inverse are finite. */
static double scale_of(const starg_mesh *mesh) {
    int exponent = starg_mesh_exponent(mesh);
    return ldexp(1, -(exponent < -1000 ? -1000 : exponent));
}

/* The tables of the topology are taken over. */
static starg_status fill(mesh_surface *s, const starg_mesh *mesh, mesh_topology *topology) {
    starg_status status = STARG_OK;
    starg_context *context = s->context;
    s->vertex_count = mesh->vertex_count;
    s->face_count = s->faces_left = mesh->face_count;
    s->edge_count = topology->edge_count;
    s->component_count = topology->component_count;
    s->scale = scale_of(mesh);
    STARG_NEW(context, "simplify", s->vertices, 3 * s->vertex_count);
    STARG_NEW(context, "simplify", s->faces, 3 * s->face_count);
    STARG_NEW(context, "simplify", s->edge, 3 * s->face_count);
    STARG_NEW(context, "simplify", s->halfedge, s->edge_count);
    STARG_NEW(context, "simplify", s->outgoing, s->vertex_count);
    STARG_NEW(context, "simplify", s->merged, s->vertex_count);
    STARG_NEW_ZERO(context, "simplify", s->volume, s->component_count);
    memcpy(s->vertices, mesh->vertices, 3 * s->vertex_count * sizeof *s->vertices);
    memcpy(s->faces, mesh->faces, 3 * s->face_count * sizeof *s->faces);
    s->twin = topology->twin;
    s->component = topology->component;
    topology->twin = topology->component = NULL;
    number_edges(s);
    find_outgoing(s);
    STARG_TRY(check_fans(s));
    STARG_TRY(measure_volumes(s));
done:
    return status;
}

starg_status surface_create(starg_context *context, const starg_mesh *mesh, mesh_surface **out) {
    starg_status status = STARG_OK;
    mesh_surface *surface = NULL;
    mesh_topology *topology = NULL;
    *out = NULL;
    STARG_TRY(topology_create(context, mesh, &topology));
    STARG_TRY(check_edges(context, mesh, topology));
    STARG_NEW_ZERO(context, "simplify", surface, 1);
    surface->context = context;
    STARG_TRY(fill(surface, mesh, topology));
    *out = surface;
    surface = NULL;
done:
    topology_free(topology);
    surface_free(surface);
    return status;
}

void surface_free(mesh_surface *surface) {
    if (surface == NULL)
        return;
    starg_release(surface->context, surface->vertices);
    starg_release(surface->context, surface->faces);
    starg_release(surface->context, surface->twin);
    starg_release(surface->context, surface->edge);
    starg_release(surface->context, surface->halfedge);
    starg_release(surface->context, surface->outgoing);
    starg_release(surface->context, surface->merged);
    starg_release(surface->context, surface->component);
    starg_release(surface->context, surface->volume);
    starg_release(surface->context, surface);
}

/* What a collapse does to the volume: the star of either end, seen from the new position. */
static void update_volume(mesh_surface *s, uint32_t halfedge, const double position[3]) {
    uint32_t a = s->faces[halfedge], b = surface_end(s, halfedge);
    double lost = 0;
    for (int end = 0; end < 2; end++) {
        uint32_t first = end ? s->twin[halfedge] : halfedge, h = first;
        do {
            const uint32_t *corner = s->faces + 3 * (size_t)(h / 3);
            bool both = (corner[0] == a || corner[1] == a || corner[2] == a) &&
                        (corner[0] == b || corner[1] == b || corner[2] == b);
            double p[3][3];
            for (int k = 0; k < 3; k++)
                surface_difference(s, surface_at(s, corner[k]), position, p[k]);
            if (end == 0 || !both)
                lost += vec3_triple(p[0], p[1], p[2]);
            h = surface_turn(s, h);
        } while (h != first);
    }
    s->volume[s->component[halfedge / 3]] -= lost;
}

/* Takes a face out whose corner at `halfedge` has been merged with the next one: the edges of its
 * other two sides become one, with the number of `kept`. */
static void close_face(mesh_surface *s, uint32_t gone, uint32_t kept) {
    uint32_t outer_gone = s->twin[gone], outer_kept = s->twin[kept];
    s->halfedge[s->edge[gone]] = TOPOLOGY_NONE;
    s->edge[outer_gone] = s->edge[kept];
    s->halfedge[s->edge[kept]] = outer_kept;
    s->twin[outer_gone] = outer_kept;
    s->twin[outer_kept] = outer_gone;
    s->outgoing[s->faces[outer_gone]] = outer_gone;
    s->outgoing[s->faces[outer_kept]] = outer_kept;
    memset(s->twin + 3 * (size_t)(gone / 3), 0xff, 3 * sizeof *s->twin);
}

void surface_collapse(mesh_surface *s, uint32_t halfedge, const double position[3]) {
    uint32_t twin = s->twin[halfedge], a = s->faces[halfedge], b = s->faces[twin], h = twin;
    update_volume(s, halfedge, position);
    do { /* the corners keep their halfedges: turning does not look at them */
        s->faces[h] = a;
        h = surface_turn(s, h);
    } while (h != twin);
    s->halfedge[s->edge[halfedge]] = TOPOLOGY_NONE;
    close_face(s, corner_next(halfedge), corner_previous(halfedge));
    close_face(s, corner_previous(twin), corner_next(twin));
    s->outgoing[b] = TOPOLOGY_NONE;
    s->merged[b] = a;
    vec3_copy(position, s->vertices + 3 * (size_t)a);
    s->vertices_left--;
    s->faces_left -= 2;
}
