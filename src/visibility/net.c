#include "visibility/net.h"

#include "core/memory.h"
#include "mesh/topology.h"

static const char STAGE[] = "visibility";

/* The place in its fan of the face at `slot` that runs from `slot` to `next`. */
static uint32_t find_in_fan(const visibility_net *net, uint32_t slot, uint32_t next) {
    uint32_t i = net->fan_start[slot];
    while (net->neighbour[i] != next)
        i++;
    return i;
}

/* Files the faces under their three corners, by counting. */
static void fill_fans(const visibility_scene *scene, visibility_net *net) {
    uint32_t corners = (uint32_t)(3 * scene->face_count);
    for (uint32_t c = 0; c < corners; c++)
        net->fan_start[scene->corners[c]]++;
    for (size_t i = 1; i <= scene->vertex_count; i++)
        net->fan_start[i] += net->fan_start[i - 1];
    for (uint32_t c = corners; c-- > 0;) {
        uint32_t at = --net->fan_start[scene->corners[c]];
        net->neighbour[at] = scene->corners[corner_next(c)];
        net->fan_face[at] = c / 3;
    }
}

static uint32_t last_corner(const visibility_scene *scene, uint32_t rank, uint32_t slot) {
    const uint32_t *c = scene->corners + 3 * (size_t)rank;
    return c[0] == slot ? c[2] : c[1] == slot ? c[0] : c[1];
}

/* Turns about each slot: the face that follows starts where the one before ends. */
static void order_fans(const visibility_scene *scene, visibility_net *net) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++)
        for (uint32_t i = net->fan_start[slot]; i + 1 < net->fan_start[slot + 1]; i++) {
            uint32_t next = last_corner(scene, net->fan_face[i], slot);
            uint32_t j = find_in_fan(net, slot, next), face = net->fan_face[j];
            net->neighbour[j] = net->neighbour[i + 1];
            net->fan_face[j] = net->fan_face[i + 1];
            net->neighbour[i + 1] = next;
            net->fan_face[i + 1] = face;
        }
}

/* The face before a neighbour in the fan is on the other side of the edge to it. */
static void list_edges(const visibility_scene *scene, visibility_net *net) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        uint32_t before = net->fan_start[slot + 1] - 1;
        for (uint32_t i = net->fan_start[slot]; i < net->fan_start[slot + 1]; before = i++)
            if (slot < net->neighbour[i])
                net->edges[net->edge_count++] =
                    (net_edge){net->fan_face[i], net->fan_face[before], slot, net->neighbour[i]};
    }
}

/* Breadth first, so that paths are short. `place` is where each slot stands in the order. */
static void order_slots(const visibility_scene *scene, visibility_net *net, uint32_t *place) {
    uint32_t listed = 0, next = 0;
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++)
        place[slot] = SCENE_NONE;
    for (uint32_t root = 0; root < scene->vertex_count; root++) {
        if (place[root] != SCENE_NONE)
            continue;
        net->shell_start[net->shell_count++] = listed;
        place[root] = listed;
        net->order[listed++] = root;
        for (; next < listed; next++) {
            uint32_t slot = net->order[next];
            for (uint32_t i = net->fan_start[slot]; i < net->fan_start[slot + 1]; i++) {
                uint32_t neighbour = net->neighbour[i];
                if (place[neighbour] != SCENE_NONE)
                    continue;
                place[neighbour] = listed;
                net->order[listed++] = neighbour;
            }
        }
    }
    net->shell_start[net->shell_count] = listed;
}

static double square_distance(const visibility_scene *scene, uint32_t a, uint32_t b) {
    double x = scene->x[b] - scene->x[a], y = scene->y[b] - scene->y[a];
    double z = scene->z[b] - scene->z[a];
    return x * x + y * y + z * z;
}

/* The nearest of the neighbours that come before the slot. */
static void choose_parents_of(const visibility_scene *scene, visibility_net *net,
                              const uint32_t *place, uint32_t slot) {
    uint32_t *parents = net->parents + CHOICES * (size_t)slot;
    double distances[CHOICES];
    int count = 0;
    for (uint32_t i = net->fan_start[slot]; i < net->fan_start[slot + 1]; i++) {
        uint32_t other = net->neighbour[i];
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

static void choose_parents(const visibility_scene *scene, visibility_net *net,
                           const uint32_t *place) {
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        net->first_face[slot] = net->fan_face[net->fan_start[slot]];
        choose_parents_of(scene, net, place, slot);
    }
}

starg_status net_create(starg_context *context, const visibility_scene *scene,
                        visibility_net **out) {
    starg_status status = STARG_OK;
    visibility_net *net = NULL;
    uint32_t *place = NULL;
    size_t n = scene->vertex_count, corners = 3 * scene->face_count;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, net, 1);
    net->context = context;
    STARG_NEW(context, STAGE, net->edges, corners / 2);
    STARG_NEW_ZERO(context, STAGE, net->fan_start, n + 1);
    STARG_NEW_ZERO(context, STAGE, net->neighbour, corners + FAN);
    STARG_NEW_ZERO(context, STAGE, net->fan_face, corners + FAN);
    STARG_NEW(context, STAGE, net->parents, CHOICES * n);
    STARG_NEW(context, STAGE, net->first_face, n);
    STARG_NEW(context, STAGE, net->order, n);
    STARG_NEW(context, STAGE, net->shell_start, n + 1);
    STARG_NEW(context, STAGE, place, n);
    fill_fans(scene, net);
    order_fans(scene, net);
    list_edges(scene, net);
    order_slots(scene, net, place);
    choose_parents(scene, net, place);
    *out = net;
done:
    starg_release(context, place);
    if (status != STARG_OK)
        net_free(net);
    return status;
}

void net_free(visibility_net *net) {
    if (net == NULL)
        return;
    starg_context *context = net->context;
    starg_release(context, net->edges);
    starg_release(context, net->fan_start);
    starg_release(context, net->neighbour);
    starg_release(context, net->fan_face);
    starg_release(context, net->parents);
    starg_release(context, net->first_face);
    starg_release(context, net->order);
    starg_release(context, net->shell_start);
    starg_release(context, net);
}
