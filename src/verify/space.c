/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes, put together anew: the faces of the model, reversed where guards are outside of it, then
 * those of closed obstacles, reversed, then every face of the open ones twice, once for each side.
 * Free is where the winding number, plus 1 where guards are outside, is at least 1.
 *
 * Cost: that of the surfaces. */
#include "verify/sight.h"

static const char STAGE[] = "verify";

typedef struct gathering {
    starg_context *context;
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) faces;
    size_t backs; /* of a soup: the other side of its first face */
} gathering;

static starg_status add_vertices(gathering *g, const verify_surface *surface, uint32_t *first) {
    *first = (uint32_t)(g->vertices.count / 3);
    for (size_t i = 0; i < 3 * surface->vertex_count; i++)
        PUSH(g->context, STAGE, &g->vertices, surface->vertices[i]);
    return STARG_OK;
}

static starg_status add_faces(gathering *g, const uint32_t *faces, size_t count, uint32_t first,
                              bool reversed) {
    for (size_t f = 0; f < count; f++)
        for (size_t k = 0; k < 3; k++)
            PUSH(g->context, STAGE, &g->faces, faces[3 * f + (reversed ? (3 - k) % 3 : k)] + first);
    return STARG_OK;
}

/* One side of each face of a mesh of any kind. */
typedef enum sheet_side { FRONT, BACK } sheet_side;

static starg_status add_sheet(gathering *g, const starg_mesh *mesh, sheet_side side) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    uint32_t first;
    TRY(verify_surface_welded(g->context, mesh, &surface));
    TRY(add_vertices(g, surface, &first));
    return add_faces(g, surface->faces, surface->face_count, first, side == BACK);
}

static int volume_sign(const verify_surface *surface) {
    exact_sum sum;
    exact_sum_clear(&sum);
    for (size_t f = 0; f < surface->face_count; f++) {
        const double *t[3];
        verify_corners(surface, f, t);
        exact_sum_add_determinant(&sum, t[0], t[1], t[2]);
    }
    return exact_sum_sign(&sum);
}

static starg_status add_model(gathering *g, const starg_mesh *mesh, const starg_guards *guards) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    uint32_t first;
    bool keeps = guards->space.orientation == STARG_ORIENTATION_KEEP;
    if (guards->space.soup)
        return add_sheet(g, mesh, BACK); /* what faces out of the free space */
    TRY(verify_surface_facing(g->context, mesh,
                              keeps                   ? VERIFY_AS_GIVEN
                              : guards->space.outside ? VERIFY_OUTWARD
                                                      : VERIFY_NESTED,
                              &surface));
    bool inward = keeps && volume_sign(surface) < 0;
    TRY(add_vertices(g, surface, &first));
    return add_faces(g, surface->faces, surface->face_count, first,
                     inward != guards->space.outside);
}

/* Is it closed? Then its faces are added, reversed. */
static starg_status add_closed(gathering *g, const starg_mesh *mesh, bool *closed) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    uint32_t first;
    starg_status status = verify_surface_create(g->context, mesh, &surface);
    *closed = status != STARG_ERROR_MESH;
    if (!*closed)
        return STARG_OK;
    TRY(status);
    TRY(add_vertices(g, surface, &first));
    return add_faces(g, surface->faces, surface->face_count, first, true);
}

/* Those that are closed, then the fronts of the others, then the backs of these and of a soup. */
static starg_status add_obstacles(gathering *g, const starg_mesh *model, bool soup,
                                  const starg_mesh *const *obstacles, size_t count) {
    SCOPED bool *closed = NULL;
    NEW_ZERO(g->context, STAGE, closed, count);
    for (size_t i = 0; i < count; i++)
        TRY(add_closed(g, obstacles[i], &closed[i]));
    for (size_t i = 0; i < count; i++)
        if (!closed[i])
            TRY(add_sheet(g, obstacles[i], FRONT));
    g->backs = g->faces.count / 3;
    if (soup)
        TRY(add_sheet(g, model, FRONT));
    for (size_t i = 0; i < count; i++)
        if (!closed[i])
            TRY(add_sheet(g, obstacles[i], BACK));
    return STARG_OK;
}

static starg_status check_obstacles(starg_context *context, const starg_mesh *const *obstacles,
                                    size_t count, const starg_guards *guards) {
    if (count != guards->obstacle_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the result is of %zu obstacles, and %zu are given",
                          guards->obstacle_count, count);
    for (size_t i = 0; i < count; i++) {
        const starg_guard_obstacle *o = &guards->obstacles[i];
        size_t vertices = starg_mesh_vertex_count(obstacles[i]);
        size_t faces = starg_mesh_face_count(obstacles[i]);
        if (o->vertex_count != vertices || o->face_count != faces)
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "obstacle %zu has %zu vertices and %zu faces; the result is of one "
                              "with %zu and %zu",
                              i, vertices, faces, o->vertex_count, o->face_count);
    }
    return STARG_OK;
}

/* How much each face counts; obstacles not at all. */
static starg_status weigh(starg_context *context, const starg_mesh *mesh,
                          const starg_guards *guards, size_t backs, verify_surface *surface) {
    size_t faces = starg_mesh_face_count(mesh);
    NEW_ZERO(context, STAGE, surface->importance, surface->face_count);
    for (size_t f = 0; f < faces && guards->targets == NULL; f++)
        surface->importance[f] = 1;
    for (size_t i = 0; guards->targets != NULL && i < guards->target_count; i++)
        if (guards->targets[i] < faces)
            surface->importance[guards->targets[i]] = guards->importance[i];
    if (guards->space.clear_count > 0)
        NEW_ZERO(context, STAGE, surface->clear, surface->face_count);
    for (size_t i = 0; i < guards->space.clear_count; i++) {
        size_t face = guards->space.clear[i];
        if (face >= faces)
            continue;
        surface->clear[face] = 1;
        surface->importance[face] = 0;
        if (guards->space.soup && backs + face < surface->face_count)
            surface->clear[backs + face] = 1;
    }
    return STARG_OK;
}

starg_status verify_space_create(starg_context *context, const starg_mesh *mesh,
                                 const starg_mesh *const *obstacles, size_t obstacle_count,
                                 const starg_guards *guards, verify_surface **out) {
    starg_status status = STARG_OK;
    gathering g = {.context = context};
    verify_surface *surface = NULL;
    *out = NULL;
    STARG_TRY(check_obstacles(context, obstacles, obstacle_count, guards));
    STARG_TRY(add_model(&g, mesh, guards));
    STARG_TRY(add_obstacles(&g, mesh, guards->space.soup, obstacles, obstacle_count));
    uint32_t *faces = g.faces.data;
    g.faces.data = NULL;
    STARG_TRY(verify_surface_wrap(context, g.vertices.data, g.vertices.count / 3, faces,
                                  g.faces.count / 3, &surface));
    surface->own_vertices = g.vertices.data;
    g.vertices.data = NULL;
    surface->model_vertices = starg_mesh_vertex_count(mesh);
    surface->model_faces = starg_mesh_face_count(mesh);
    surface->backs = guards->space.two_sided ? g.backs : 0;
    surface->ambient = guards->space.outside || guards->space.soup ? 1 : 0;
    STARG_TRY(weigh(context, mesh, guards, g.backs, surface));
    *out = surface;
    surface = NULL;
done:
    RELEASE(g.vertices.data, g.faces.data);
    verify_surface_free(surface);
    return status;
}
