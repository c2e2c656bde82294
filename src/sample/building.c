/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes to guard: an office with furniture, a level of a game, a statue on its plinth.
 *
 * Everything but the statue stands on a lattice of half metres, y is up, and every square of it is
 * cut into k x k quads. The more vertices are wanted, the larger and the finer a scene is: the
 * number of rooms grows as the root of that of vertices, and k follows from both.
 *   - Office: rooms on both sides of corridors, storeys one on the other, joined by a shaft at one
 * end of the corridors. Its air is one closed mesh; each piece of furniture is another one and
 * stands on the floor. All fronts are towards the air.
 *   - Level: cells of a maze, with a floor, with walls that are sheets without thickness, and with
 *     crates that have no bottom. Nothing is closed and nothing shares a vertex with what it
 * touches. Cost: that of the output. */

#include "core/rng.h"
#include "sample/solids.h"

enum { UNIT_STEPS = 64, MOST_PARTS = 40 };

static const double HALF = 0.5; /* metres */

/* ---- rectangles ---- */

typedef struct building {
    mesh_builder mesh;
    size_t parts;   /* quads along a lattice step */
    uint64_t piece; /* pieces share no vertices */
} building;

/* A vertex at a lattice point in units of 1 / parts steps. */
static starg_status vertex_at(building *b, const size_t at[3], uint32_t *vertex) {
    const double scale = HALF / (double)b->parts;
    const double p[3] = {scale * (double)at[0], scale * (double)at[1], scale * (double)at[2]};
    const uint64_t most = (uint64_t)1 << 15;
    uint64_t key = ((b->piece * most + at[0]) * most + at[1]) * most + at[2];
    return builder_vertex(&b->mesh, key, p, vertex);
}

/* A rectangle of lattice squares across `axis`, from the point `from`, `size` squares along the
 * next two axes; its front is towards the positive axis, or the negative one. */
static starg_status add_rectangle(building *b, int axis, const size_t from[3], const size_t size[2],
                                  bool positive) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    size_t n = b->parts;
    for (size_t i = 0; i < size[0] * n; i++)
        for (size_t j = 0; j < size[1] * n; j++) {
            uint32_t q[4];
            for (size_t k = 0; k < 4; k++) {
                size_t at[3] = {from[0] * n, from[1] * n, from[2] * n};
                at[u] += i + (k == 1 || k == 2);
                at[v] += j + (k >= 2);
                TRY(vertex_at(b, at, &q[k]));
            }
            TRY(positive ? builder_quad(&b->mesh, q[0], q[1], q[2], q[3])
                         : builder_quad(&b->mesh, q[3], q[2], q[1], q[0]));
        }
    return STARG_OK;
}

/* A box with its fronts outside; `floor`: with its bottom. */
static starg_status add_box(building *b, const size_t from[3], const size_t size[3], bool floor) {
    b->piece++;
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            size_t at[3] = {from[0], from[1], from[2]};
            const size_t extent[2] = {size[(axis + 1) % 3], size[(axis + 2) % 3]};
            at[axis] += side * size[axis];
            if (floor || axis != 1 || side == 1)
                TRY(add_rectangle(b, axis, at, extent, side == 1));
        }
    return STARG_OK;
}

/* ---- the office ---- */

enum {
    ROOM_WIDTH = 8, /* along the corridor, in half metres */
    ROOM_DEPTH = 10,
    WALL = 1,
    CORRIDOR = 4,
    STOREY = 6, /* of air; a slab of WALL is between two */
    DOOR = 2,
    DOOR_HEIGHT = 4,
    SHAFT = 5, /* along the corridor, at its end */
    DEPTH = 2 * (ROOM_DEPTH + WALL) + CORRIDOR
};

typedef struct office {
    size_t rooms, storeys; /* rooms of a side of a storey */
} office;

static size_t length_of(const office *o) {
    return o->rooms * (ROOM_WIDTH + WALL) + SHAFT;
}

/* Is the lattice cell air? */
static bool is_air(const office *o, size_t x, size_t y, size_t z) {
    size_t length = length_of(o), level = y % (STOREY + WALL);
    if (x >= length || z >= DEPTH || y >= o->storeys * (STOREY + WALL) - WALL)
        return false;
    bool corridor = z >= ROOM_DEPTH + WALL && z < ROOM_DEPTH + WALL + CORRIDOR;
    bool shaft = x >= length - SHAFT + 1;
    if (level >= STOREY) /* a slab, open in the shaft */
        return corridor && shaft;
    if (corridor)
        return true;
    size_t along = x % (ROOM_WIDTH + WALL);
    if (x >= length - SHAFT || along >= ROOM_WIDTH)
        return false;
    bool wall = z == ROOM_DEPTH || z == ROOM_DEPTH + WALL + CORRIDOR;
    return !wall || (along >= 1 && along < 1 + DOOR && level < DOOR_HEIGHT);
}

/* The squares between air and matter, with their fronts to the air. */
static starg_status add_air(building *b, const office *o) {
    const size_t size[3] = {length_of(o), o->storeys * (STOREY + WALL), DEPTH}, one[2] = {1, 1};
    for (size_t x = 0; x < size[0]; x++)
        for (size_t y = 0; y < size[1]; y++)
            for (size_t z = 0; z < size[2]; z++) {
                if (!is_air(o, x, y, z))
                    continue;
                for (int axis = 0; axis < 3; axis++)
                    for (size_t side = 0; side < 2; side++) {
                        size_t next[3] = {x, y, z}, at[3] = {x, y, z};
                        next[axis] += side == 1 ? 1 : SIZE_MAX; /* below 0 wraps around */
                        at[axis] += side;
                        if (!is_air(o, next[0], next[1], next[2]))
                            TRY(add_rectangle(b, axis, at, one, side == 0));
                    }
            }
    return STARG_OK;
}

/* A desk, a chair and a cabinet; chance moves them. */
static starg_status furnish(building *b, size_t x, size_t y, size_t z, starg_rng *rng) {
    size_t desk = x + 3 + starg_rng_below(rng, 2), deep = z + 2 + starg_rng_below(rng, 3);
    TRY(add_box(b, (const size_t[]){desk, y, deep}, (const size_t[]){3, 2, 2}, true));
    TRY(add_box(b, (const size_t[]){desk + 1, y, deep + 3}, (const size_t[]){1, 1, 1}, true));
    return add_box(b, (const size_t[]){x + ROOM_WIDTH - 1, y, z + 6}, (const size_t[]){1, 4, 2},
                   true);
}

static starg_status build_office(building *b, const office *o) {
    TRY(add_air(b, o));
    for (size_t room = 0; room < 2 * o->rooms * o->storeys; room++) {
        starg_rng rng = starg_rng_make(1, 6, room);
        size_t side = room % 2, along = room / 2 % o->rooms, storey = room / 2 / o->rooms;
        TRY(starg_check_cancel(b->mesh.context, "sample"));
        TRY(furnish(b, along * (ROOM_WIDTH + WALL), storey * (STOREY + WALL),
                    side * (ROOM_DEPTH + 2 * WALL + CORRIDOR), &rng));
    }
    return STARG_OK;
}

/* ---- the level ---- */

enum { CELL = 8, LEVEL_WALL = 5 };

static starg_status build_level(building *b, size_t cells) {
    const size_t floor[2] = {CELL, CELL};
    for (size_t i = 0; i < cells * cells; i++) {
        starg_rng rng = starg_rng_make(1, 7, i);
        size_t x = i % cells * CELL, z = i / cells * CELL;
        TRY(starg_check_cancel(b->mesh.context, "sample"));
        b->piece++;
        TRY(add_rectangle(b, 1, (const size_t[]){x, 0, z}, floor, true));
        /* a maze: each cell has a wall towards one of two sides, with a gap; the border is closed
         */
        bool across = starg_rng_below(&rng, 2) == 0;
        const size_t gap = 2 + starg_rng_below(&rng, 3);
        b->piece++;
        if (x == 0 || across)
            TRY(add_rectangle(b, 0, (const size_t[]){x, 0, z},
                              (const size_t[]){LEVEL_WALL, x == 0 ? CELL : CELL - gap}, true));
        b->piece++;
        if (z == 0 || !across)
            TRY(add_rectangle(b, 2, (const size_t[]){x, 0, z},
                              (const size_t[]){z == 0 ? CELL : CELL - gap, LEVEL_WALL}, true));
        b->piece++;
        if (x + CELL == cells * CELL)
            TRY(add_rectangle(b, 0, (const size_t[]){x + CELL, 0, z},
                              (const size_t[]){LEVEL_WALL, CELL}, false));
        b->piece++;
        if (z + CELL == cells * CELL)
            TRY(add_rectangle(b, 2, (const size_t[]){x, 0, z + CELL},
                              (const size_t[]){CELL, LEVEL_WALL}, false));
        size_t tall = 1 + starg_rng_below(&rng, 3);
        TRY(add_box(b, (const size_t[]){x + 3, 0, z + 3 + starg_rng_below(&rng, 2)},
                    (const size_t[]){2, tall, 2}, false));
    }
    return STARG_OK;
}

/* ---- sizes ---- */

static size_t root_of(double x) {
    return (size_t)fmax(1, floor(sqrt(x) + 0.5));
}

/* How many quads a lattice step is cut into, where a room has about so many squares. */
static size_t parts_for(size_t vertex_count, double squares) {
    double rooms = fmax(2, 0.1 * sqrt((double)vertex_count));
    size_t parts = root_of((double)vertex_count / (squares * rooms));
    return parts < MOST_PARTS ? parts : MOST_PARTS;
}

static size_t rooms_for(size_t vertex_count, double squares, size_t parts) {
    return (size_t)fmax(1, floor((double)vertex_count / (squares * (double)(parts * parts)) + 0.5));
}

starg_status solid_office(starg_context *context, size_t vertex_count, starg_mesh **out) {
    starg_status status = STARG_OK;
    building b = {.mesh = {.context = context}};
    const double squares = 560; /* with its part of the corridor, and furniture */
    b.parts = parts_for(vertex_count, squares);
    size_t rooms = rooms_for(vertex_count, squares, b.parts);
    office o = {.storeys = 1 + (rooms >= 16) + rooms / 60};
    o.rooms = rooms / (2 * o.storeys) > 0 ? rooms / (2 * o.storeys) : 1;
    STARG_TRY(build_office(&b, &o));
    STARG_TRY(builder_finish(&b.mesh, out));
done:
    builder_free(&b.mesh);
    return status;
}

starg_status solid_level(starg_context *context, size_t vertex_count, starg_mesh **out) {
    starg_status status = STARG_OK;
    building b = {.mesh = {.context = context}};
    const double squares = 140;
    b.parts = parts_for(vertex_count, squares);
    STARG_TRY(build_level(&b, root_of((double)rooms_for(vertex_count, squares, b.parts))));
    STARG_TRY(builder_finish(&b.mesh, out));
done:
    builder_free(&b.mesh);
    return status;
}

/* ---- the statue ---- */

/* A box with quads of about the size, which may overlap what is there. */
static starg_status append_box(mesh_builder *mesh, const double lower[3], const double upper[3],
                               double size) {
    size_t steps[3];
    for (int k = 0; k < 3; k++)
        steps[k] = (size_t)fmin(UNIT_STEPS, fmax(1, floor((upper[k] - lower[k]) / size + 0.5)));
    for (int axis = 0; axis < 3; axis++)
        for (size_t side = 0; side < 2; side++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (size_t i = 0; i < steps[u] * steps[v]; i++) {
                uint32_t q[4];
                for (size_t k = 0; k < 4; k++) {
                    size_t at[3];
                    double p[3];
                    at[axis] = side * steps[axis];
                    at[u] = i % steps[u] + (k == 1 || k == 2);
                    at[v] = i / steps[u] + (k >= 2);
                    for (int d = 0; d < 3; d++)
                        p[d] = at[d] == steps[d] ? upper[d]
                                                 : lower[d] + (upper[d] - lower[d]) *
                                                                  (double)at[d] / (double)steps[d];
                    uint64_t key = (uint64_t)1 << 40 | at[0] << 20 | at[1] << 10 | at[2];
                    TRY(builder_vertex(mesh, key, p, &q[k]));
                }
                TRY(side == 1 ? builder_quad(mesh, q[0], q[1], q[2], q[3])
                              : builder_quad(mesh, q[3], q[2], q[1], q[0]));
            }
        }
    return STARG_OK;
}

static starg_status copy_mesh(mesh_builder *to, const starg_mesh *from) {
    uint32_t vertex;
    for (size_t v = 0; v < from->vertex_count; v++)
        TRY(builder_vertex(to, v, from->vertices + 3 * v, &vertex));
    for (size_t f = 0; f < from->face_count; f++)
        TRY(builder_triangle(to, from->faces[3 * f], from->faces[3 * f + 1],
                             from->faces[3 * f + 2]));
    return STARG_OK;
}

/* A person whose feet are sunk into the top of a plinth. */
starg_status solid_statue(starg_context *context, size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder mesh = {.context = context};
    SCOPED_BY(starg_mesh_drop) starg_mesh *person = NULL;
    double lower[3], upper[3], height;
    size_t of_figure = vertex_count * 9 / 10;
    TRY(solid_figure(context, FIGURE_HUMAN, 0, of_figure < 450 ? 450 : of_figure, &person));
    TRY(copy_mesh(&mesh, person));
    starg_mesh_bounds(person, lower, upper);
    height = upper[1] - lower[1];
    for (int k = 0; k < 3; k += 2) {
        double middle = 0.5 * (lower[k] + upper[k]);
        lower[k] = middle - 0.3 * height;
        upper[k] = middle + 0.3 * height;
    }
    upper[1] = lower[1] + 0.01 * height;
    lower[1] -= 0.3 * height;
    TRY(append_box(&mesh, lower, upper, height * sqrt(1.5 / (0.1 * (double)vertex_count))));
    return builder_finish(&mesh, out);
}
