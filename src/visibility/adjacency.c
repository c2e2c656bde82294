/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/scene.h"

#include "core/memory.h"
#include "mesh/topology.h"

static const char STAGE[] = "visibility";

/* Position in the fan of `slot` of the face that runs from `slot` to `next`. */
static uint32_t find_in_fan(const visibility_adjacency *adjacency, uint32_t slot, uint32_t next) {
    uint32_t i = adjacency->fan_start[slot];
    while (adjacency->neighbour[i] != next)
        i++;
    return i;
}

/* Lists the faces at their three corners, by counting sort. */
static void fill_fans(const visibility_scene *scene, visibility_adjacency *adjacency) {
    uint32_t corners = (uint32_t)(3 * scene->face_count);
    for (uint32_t c = 0; c < corners; c++)
        adjacency->fan_start[scene->corners[c]]++;
    for (size_t i = 1; i <= scene->vertex_count; i++)
        adjacency->fan_start[i] += adjacency->fan_start[i - 1];
    for (uint32_t c = corners; c-- > 0;) {
        uint32_t at = --adjacency->fan_start[scene->corners[c]];
        adjacency->neighbour[at] = scene->corners[corner_next(c)];
        adjacency->fan_face[at] = c / 3;
    }
}

static uint32_t last_corner(const visibility_scene *scene, uint32_t rank, uint32_t slot) {
    const uint32_t *c = scene->corners + 3 * (size_t)rank;
    return c[0] == slot ? c[2] : c[1] == slot ? c[0] : c[1];
}

/* Sorts the faces around each slot: a face starts where the previous one ends. */
static void order_fans(const visibility_scene *scene, visibility_adjacency *adjacency) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++)
        for (uint32_t i = adjacency->fan_start[slot]; i + 1 < adjacency->fan_start[slot + 1]; i++) {
            uint32_t next = last_corner(scene, adjacency->fan_face[i], slot);
            uint32_t j = find_in_fan(adjacency, slot, next), face = adjacency->fan_face[j];
            adjacency->neighbour[j] = adjacency->neighbour[i + 1];
            adjacency->fan_face[j] = adjacency->fan_face[i + 1];
            adjacency->neighbour[i + 1] = next;
            adjacency->fan_face[i + 1] = face;
        }
}

/* The face before a neighbour in the fan is across the edge to it. */
static void list_edges(const visibility_scene *scene, visibility_adjacency *adjacency) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        uint32_t before = adjacency->fan_start[slot + 1] - 1;
        for (uint32_t i = adjacency->fan_start[slot]; i < adjacency->fan_start[slot + 1];
             before = i++)
            if (slot < adjacency->neighbour[i])
                adjacency->edges[adjacency->edge_count++] =
                    (adjacency_edge){adjacency->fan_face[i], adjacency->fan_face[before], slot,
                                     adjacency->neighbour[i]};
    }
}

/* Breadth first, so that paths are short. `place` is the position of each slot in the order. */
static void order_slots(const visibility_scene *scene, visibility_adjacency *adjacency,
                        uint32_t *place) {
    uint32_t listed = 0, next = 0;
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++)
        place[slot] = SCENE_NONE;
    for (uint32_t root = 0; root < scene->vertex_count; root++) {
        if (place[root] != SCENE_NONE)
            continue;
        adjacency->shell_start[adjacency->shell_count++] = listed;
        place[root] = listed;
        adjacency->order[listed++] = root;
        for (; next < listed; next++) {
            uint32_t slot = adjacency->order[next];
            for (uint32_t i = adjacency->fan_start[slot]; i < adjacency->fan_start[slot + 1]; i++) {
                uint32_t neighbour = adjacency->neighbour[i];
                if (place[neighbour] != SCENE_NONE)
                    continue;
                place[neighbour] = listed;
                adjacency->order[listed++] = neighbour;
            }
        }
    }
    adjacency->shell_start[adjacency->shell_count] = listed;
}

static double square_distance(const visibility_scene *scene, uint32_t a, uint32_t b) {
    double x = scene->x[b] - scene->x[a], y = scene->y[b] - scene->y[a];
    double z = scene->z[b] - scene->z[a];
    return x * x + y * y + z * z;
}

/* The nearest neighbours that come before the slot. */
static void choose_parents_of(const visibility_scene *scene, visibility_adjacency *adjacency,
                              const uint32_t *place, uint32_t slot) {
    uint32_t *parents = adjacency->parents + CHOICES * (size_t)slot;
    double distances[CHOICES];
    int count = 0;
    for (uint32_t i = adjacency->fan_start[slot]; i < adjacency->fan_start[slot + 1]; i++) {
        uint32_t other = adjacency->neighbour[i];
        if (place[other] > place[slot])
            continue;
        double distance = square_distance(scene, slot, other);
        int k = count < CHOICES ? count++ : CHOICES;
        for (; k > 0 && distance < distances[k - 1]; k--)
            if (k < CHOICES) {
                distances[k] = distances[k - 1];
                parents[k] = parents[k - 1];
            }
        if (k < CHOICES) {
            distances[k] = distance;
            parents[k] = other;
        }
    }
    if (count == 0)
        parents[count++] = slot;
    for (; count < CHOICES; count++)
        parents[count] = parents[count - 1];
}

static void choose_parents(const visibility_scene *scene, visibility_adjacency *adjacency,
                           const uint32_t *place) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        adjacency->first_face[slot] = adjacency->fan_face[adjacency->fan_start[slot]];
        choose_parents_of(scene, adjacency, place, slot);
    }
}

starg_status adjacency_create(starg_context *context, const visibility_scene *scene,
                              visibility_adjacency **out) {
    SCOPED_BY(adjacency_drop) visibility_adjacency *adjacency = NULL;
    SCOPED uint32_t *place = NULL;
    size_t n = scene->vertex_count, corners = 3 * scene->face_count;
    *out = NULL;
    NEW_ZERO(context, STAGE, adjacency, 1);
    adjacency->context = context;
    NEW(context, STAGE, adjacency->edges, corners / 2);
    NEW_ZERO(context, STAGE, adjacency->fan_start, n + 1);
    NEW_ZERO(context, STAGE, adjacency->neighbour, corners + FAN);
    NEW_ZERO(context, STAGE, adjacency->fan_face, corners + FAN);
    NEW(context, STAGE, adjacency->parents, CHOICES * n);
    NEW(context, STAGE, adjacency->first_face, n);
    NEW(context, STAGE, adjacency->order, n);
    NEW(context, STAGE, adjacency->shell_start, n + 1);
    NEW(context, STAGE, place, n);
    fill_fans(scene, adjacency);
    order_fans(scene, adjacency);
    list_edges(scene, adjacency);
    order_slots(scene, adjacency, place);
    choose_parents(scene, adjacency, place);
    *out = adjacency;
    adjacency = NULL;
    return STARG_OK;
}

void adjacency_free(visibility_adjacency *adjacency) {
    if (adjacency == NULL)
        return;
    RELEASE(adjacency->edges, adjacency->fan_start, adjacency->neighbour, adjacency->fan_face,
            adjacency->parents, adjacency->first_face, adjacency->order, adjacency->shell_start,
            adjacency);
}
