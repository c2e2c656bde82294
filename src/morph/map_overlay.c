/* SPDX-License-Identifier: Apache-2.0 */
/* The overlay of a map: cells of the two triangulations on the sphere (overlay.c), with room
 * between their corners (overlay_room.c), cut into triangles. */

#include "morph/surface_map.h"

static const char STAGE[] = "overlay";

void map_free_overlay(starg_overlay *overlay) {
    RELEASE(overlay->faces, overlay->own_faces, overlay->target_faces, overlay->own_coordinates,
            overlay->target_coordinates);
    *overlay = (starg_overlay){0};
}

void starg_overlay_positions(const starg_overlay *overlay, const starg_mesh *mesh, int end,
                             double *positions) {
    map_place(mesh, overlay->vertex_count, end == 0 ? overlay->own_faces : overlay->target_faces,
              end == 0 ? overlay->own_coordinates : overlay->target_coordinates, positions);
}

static starg_status allocate(starg_context *context, size_t vertices, size_t faces,
                             starg_overlay *out) {
    *out = (starg_overlay){.vertex_count = vertices, .face_count = faces};
    NEW(context, STAGE, out->faces, 3 * faces);
    NEW(context, STAGE, out->own_faces, vertices);
    NEW(context, STAGE, out->target_faces, vertices);
    NEW_ZERO(context, STAGE, out->own_coordinates, 3 * vertices);
    NEW_ZERO(context, STAGE, out->target_coordinates, 3 * vertices);
    return STARG_OK;
}

/* ---- the same faces ---- */

/* Each vertex at itself. */
static void place_at_vertices(const starg_mesh *mesh, uint32_t *faces, double *coordinates) {
    for (size_t i = 3 * mesh->face_count; i-- > 0;) {
        size_t v = mesh->faces[i];
        faces[v] = (uint32_t)(i / 3);
        for (size_t k = 0; k < 3; k++)
            coordinates[3 * v + k] = k == i % 3;
    }
}

static starg_status overlay_same(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                 starg_overlay *out) {
    TRY(allocate(context, a->vertex_count, a->face_count, out));
    memcpy(out->faces, a->faces, 3 * a->face_count * sizeof *out->faces);
    place_at_vertices(a, out->own_faces, out->own_coordinates);
    place_at_vertices(b, out->target_faces, out->target_coordinates);
    return STARG_OK;
}

static bool has_same_faces(const starg_mesh *a, const starg_mesh *b) {
    return a->vertex_count == b->vertex_count && a->face_count == b->face_count &&
           memcmp(a->faces, b->faces, 3 * a->face_count * sizeof *a->faces) == 0;
}

/* Does every vertex go to the vertex of its number? */
static bool keeps_vertices(const starg_map *map, const starg_mesh *b) {
    for (size_t v = 0; v < map->vertex_count; v++) {
        const double *w = map->coordinates + 3 * v;
        size_t k = w[0] == 1 ? 0 : w[1] == 1 ? 1 : 2;
        if (w[k] != 1 || b->faces[3 * (size_t)map->faces[v] + k] != v)
            return false;
    }
    return map->vertex_count == b->vertex_count;
}

/* ---- cells ---- */

/* Coordinates in the corner order of the mesh as given. */
static void write_place(const overlay_side *side, const overlay_place *place, uint32_t *face,
                        double *coordinates) {
    size_t first = 3 * (size_t)place->face;
    *face = place->face;
    for (size_t k = 0; k < 3; k++)
        for (size_t j = 0; j < 3; j++)
            if (side->faces[first + k] == side->mesh->faces[first + j])
                coordinates[j] = place->weight[k];
}

static starg_status write_overlay(const sphere_overlay *own, starg_overlay *out) {
    size_t triangles = 0, next = 0;
    const overlay_side *a = &own->side[0];
    bool turned = a->faces[1] != a->mesh->faces[1];
    for (size_t c = 0; c < own->cells.count; c++)
        triangles += own->cells.data[c].count - 2;
    TRY(allocate(own->context, own->nodes.count, triangles, out));
    for (size_t i = 0; i < own->nodes.count; i++) {
        const overlay_node *node = &own->nodes.data[i];
        write_place(a, &node->place[0], &out->own_faces[i], out->own_coordinates + 3 * i);
        write_place(&own->side[1], &node->place[1], &out->target_faces[i],
                    out->target_coordinates + 3 * i);
    }
    for (size_t c = 0; c < own->cells.count; c++) {
        const overlay_cell *cell = &own->cells.data[c];
        for (uint32_t i = 1; i + 1 < cell->count; i++) {
            out->faces[next++] = cell->corner[0];
            out->faces[next++] = cell->corner[turned ? i + 1 : i];
            out->faces[next++] = cell->corner[turned ? i : i + 1];
        }
    }
    return STARG_OK;
}

/* ---- the map ---- */

/* Marks the vertices of a mesh that nodes of the overlay are at. */
static starg_status check_vertices(const sphere_overlay *own, int s) {
    SCOPED uint8_t *found = NULL;
    const starg_mesh *mesh = own->side[s].mesh;
    NEW_ZERO(own->context, STAGE, found, mesh->vertex_count);
    for (size_t i = 0; i < own->nodes.count; i++) {
        uint64_t key = own->nodes.data[i].key[s];
        if (key != OVERLAY_NONE && key >= OVERLAY_VERTEX)
            found[key - OVERLAY_VERTEX]++;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const uint64_t element = v;
        if (found[v] != 1)
            return starg_fail_at(own->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_VERTEX,
                                 &element, 1,
                                 "the map's directions are not those of a bijection: the "
                                 "triangles do not cover vertex %zu of %c once",
                                 v, 'A' + s);
    }
    return STARG_OK;
}

/* A's vertices have the first places of the overlay that are theirs. */
static void move_images(const sphere_overlay *own, const starg_overlay *found, starg_map *map) {
    for (size_t i = 0; i < own->nodes.count; i++) {
        uint64_t key = own->nodes.data[i].key[0];
        if (key == OVERLAY_NONE || key < OVERLAY_VERTEX)
            continue;
        size_t v = (size_t)(key - OVERLAY_VERTEX);
        map->faces[v] = found->target_faces[i];
        memcpy(map->coordinates + 3 * v, found->target_coordinates + 3 * i,
               3 * sizeof *map->coordinates);
    }
}

static starg_status overlay_directions(starg_context *context, const starg_mesh *a,
                                       const starg_mesh *b, starg_map *map, starg_overlay *out,
                                       bool *moved) {
    const starg_mesh *const meshes[2] = {a, b};
    const double *const directions[2] = {map->directions, map->target_directions};
    SCOPED_BY(overlay_drop) sphere_overlay *own = NULL;
    TRY(overlay_create(context, meshes, directions, &own));
    for (int s = 0; s < 2; s++)
        TRY(check_vertices(own, s));
    TRY(overlay_make_room(own, moved));
    TRY(write_overlay(own, out));
    move_images(own, out, map);
    return STARG_OK;
}

starg_status map_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map, bool *moved) {
    SCOPED_BY(map_free_overlay) starg_overlay found = {0};
    *moved = false;
    bool same = keeps_vertices(map, b);
    if (same && has_same_faces(a, b)) {
        TRY(overlay_same(context, a, b, &found));
    } else {
        if (map->direction_count == 0 && same)
            TRY(map_share_directions(context, a, b, map));
        if (map->direction_count == 0)
            return starg_fail(context, STARG_ERROR_MESH, STAGE,
                              "the map says where vertices go, but not what lies between them; "
                              "an overlay needs its directions, which 'starguard map' writes");
        TRY(overlay_directions(context, a, b, map, &found, moved));
        TRY(map_measure(context, a, b, map));
    }
    map_free_overlay(&map->overlay);
    map->overlay = found;
    found = (starg_overlay){0};
    return STARG_OK;
}

starg_status starg_map_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                               starg_map *map) {
    bool moved;
    TIME_RULE(context, STARG_TIME_FAILS);
    return map_overlay(context, a, b, map, &moved);
}
