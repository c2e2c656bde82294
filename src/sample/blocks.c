/* SPDX-License-Identifier: Apache-2.0 */
/* Solids of unit cubes: instances of the art gallery problem, with as many members as there are
 * seeds.
 *
 * Cubes are added to a solid one by one as long as it keeps a boundary that is a 2-manifold: around
 * each corner of the new cube, in the block of eight there, the solid cubes stay connected by
 * faces, and so do the empty ones. A *polycube* takes any free place next to it at random; a *maze*
 * digs a random depth-first search through the places with even coordinates, so that it is a tree
 * of corridors; a *comb* is a slab with a tooth of random length on every other place of every
 * other row; a *spiked room* is a box with long thin pyramids on some squares of its walls, each
 * within the column of its square, no two of them next to each other.
 *
 * The wanted number of vertices decides when to stop. Cost: O(cubes). */
#include <string.h>

#include "core/rng.h"
#include "sample/solids.h"

static const char STAGE[] = "sample";

enum { RANDOM_STREAM = 83, MOST_SIDE = 256 };

typedef struct cube_place {
    int at[3];
} cube_place;

typedef struct blocks {
    starg_context *context;
    int side;       /* of the grid; a border of empty places is around it */
    uint8_t *solid; /* by place */
    size_t squares; /* of the boundary */
    starg_rng rng;
    STARG_ARRAY(cube_place) open; /* places to go on from */
} blocks;

static const int STEPS[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};

static size_t index_of(const blocks *b, const int at[3]) {
    return ((size_t)at[0] * (size_t)b->side + (size_t)at[1]) * (size_t)b->side + (size_t)at[2];
}

static cube_place beyond(const cube_place *from, int way, int distance) {
    cube_place to;
    for (int k = 0; k < 3; k++)
        to.at[k] = from->at[k] + distance * STEPS[way][k];
    return to;
}

static bool is_within(const blocks *b, const cube_place *place) {
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && place->at[k] >= 1 && place->at[k] < b->side - 1;
    return in;
}

/* ---- cubes ---- */

/* Are the members of a set among eight octants connected by faces? Bit i is octant i. */
static bool is_connected(unsigned set) {
    unsigned reached = set & -set, before = 0;
    while (reached != before) {
        before = reached;
        for (int i = 0; i < 8; i++)
            for (int k = 0; k < 3; k++)
                if ((before >> i & 1) && (set >> (i ^ 1 << k) & 1))
                    reached |= 1U << (i ^ 1 << k);
    }
    return reached == set;
}

/* Does the boundary stay a 2-manifold if this place is filled? */
static bool may_fill(const blocks *b, const cube_place *place) {
    if (!is_within(b, place) || b->solid[index_of(b, place->at)])
        return false;
    for (int corner = 0; corner < 8; corner++) {
        unsigned set = 0;
        for (int octant = 0; octant < 8; octant++) {
            int at[3];
            for (int k = 0; k < 3; k++)
                at[k] = place->at[k] - 1 + (corner >> k & 1) + (octant >> k & 1);
            bool own = memcmp(at, place->at, sizeof at) == 0;
            set |= (own || b->solid[index_of(b, at)] ? 1U : 0U) << octant;
        }
        if (!is_connected(set) || !is_connected(~set & 255))
            return false;
    }
    return true;
}

static void fill(blocks *b, const cube_place *place) {
    b->solid[index_of(b, place->at)] = 1;
    for (int way = 0; way < 6; way++) {
        const cube_place next = beyond(place, way, 1);
        b->squares += b->solid[index_of(b, next.at)] ? (size_t)-1 : 1;
    }
}

static cube_place middle_of(const blocks *b) {
    int half = b->side / 2;
    return (cube_place){{half, half, half}};
}

static starg_status grow_polycube(blocks *b, size_t squares) {
    cube_place place = middle_of(b);
    fill(b, &place);
    PUSH(b->context, STAGE, &b->open, place);
    for (size_t tries = 0; b->squares < squares && tries < 100 * squares; tries++) {
        size_t i = (size_t)starg_rng_below(&b->rng, b->open.count);
        place = beyond(&b->open.data[i], (int)starg_rng_below(&b->rng, 6), 1);
        if (!may_fill(b, &place))
            continue;
        fill(b, &place);
        PUSH(b->context, STAGE, &b->open, place);
    }
    return STARG_OK;
}

/* Two cubes on from the last place, or back where there is no way. */
static starg_status dig_maze(blocks *b, size_t squares) {
    cube_place place = middle_of(b);
    fill(b, &place);
    PUSH(b->context, STAGE, &b->open, place);
    while (b->squares < squares && b->open.count > 0) {
        const cube_place last = b->open.data[b->open.count - 1];
        int first = (int)starg_rng_below(&b->rng, 6), way = first;
        cube_place near, far;
        do {
            near = beyond(&last, way, 1);
            far = beyond(&last, way, 2);
            if (is_within(b, &far) && !b->solid[index_of(b, far.at)])
                break;
            way = (way + 1) % 6;
        } while (way != first);
        if (!is_within(b, &far) || b->solid[index_of(b, far.at)]) {
            b->open.count--;
            continue;
        }
        fill(b, &near);
        fill(b, &far);
        PUSH(b->context, STAGE, &b->open, far);
    }
    return STARG_OK;
}

/* A slab of 2 n - 1 times 2 n - 1 places, and n * n teeth of 1 to 5 cubes. */
static starg_status build_comb(blocks *b, size_t squares) {
    int n = 1;
    for (size_t next = 2; 2 * n + 3 < b->side; n++, next++) {
        size_t width = 2 * next - 1;
        if (2 * (2 * width * width + 4 * width + 12 * next * next) > 3 * squares)
            break;
    }
    for (int x = 1; x < 2 * n; x++)
        for (int z = 1; z < 2 * n; z++) {
            bool tooth = x % 2 == 1 && z % 2 == 1;
            int height = tooth ? 1 + (int)starg_rng_below(&b->rng, 5) : 0;
            for (int y = 1; y <= 1 + height && y < b->side - 1; y++)
                fill(b, &(cube_place){{x, y, z}});
        }
    return STARG_OK;
}

/* A box with random proportions. */
static starg_status build_room(blocks *b, size_t squares) {
    int size[3] = {2, 2, 2};
    for (bool grown = true; grown;) {
        int k = (int)starg_rng_below(&b->rng, 3);
        size[k]++;
        size_t now = 2 * (size_t)(size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
        grown = now <= squares && size[k] < b->side - 2;
        size[k] -= !grown;
    }
    for (int x = 1; x <= size[0]; x++)
        for (int y = 1; y <= size[1]; y++)
            for (int z = 1; z <= size[2]; z++)
                fill(b, &(cube_place){{x, y, z}});
    return STARG_OK;
}

/* ---- the mesh ---- */

static starg_status corner_vertex(mesh_builder *m, const int at[3], uint32_t *vertex) {
    uint64_t name = (uint64_t)at[0] << 40 | (uint64_t)at[1] << 20 | (uint64_t)at[2];
    const double p[3] = {at[0], at[1], at[2]};
    return builder_vertex(m, name, p, vertex);
}

/* The corners of a square, counterclockwise from outside. */
static void square_corners(const cube_place *place, int way, int corner[4][3]) {
    int k = way / 2, u = (k + 1) % 3, v = (k + 2) % 3;
    bool positive = way % 2 == 0;
    for (int i = 0; i < 4; i++) {
        int at_u = i == 1 || i == 2, at_v = i >= 2;
        corner[i][k] = place->at[k] + positive;
        corner[i][u] = place->at[u] + (positive ? at_u : at_v);
        corner[i][v] = place->at[v] + (positive ? at_v : at_u);
    }
}

/* Squares of one wall whose coordinates are both odd are no neighbours. */
static bool wants_spike(blocks *b, const cube_place *place, int way) {
    int k = way / 2;
    return place->at[(k + 1) % 3] % 2 == 1 && place->at[(k + 2) % 3] % 2 == 1 &&
           starg_rng_below(&b->rng, 2) == 0;
}

static starg_status add_spike(blocks *b, mesh_builder *m, const uint32_t corner[4],
                              const int at[4][3], int way) {
    int k = way / 2;
    double apex[3], height = 1 + 4 * starg_rng_unit(&b->rng);
    uint32_t tip;
    for (int j = 0; j < 3; j++)
        apex[j] = 0.5 * (at[0][j] + at[2][j]);
    for (int j = 0; j < 3; j++)
        apex[j] += j == k ? STEPS[way][k] * height : 0.8 * (starg_rng_unit(&b->rng) - 0.5);
    uint64_t name = UINT64_C(1) << 62 | (uint64_t)m->names.count;
    TRY(builder_vertex(m, name, apex, &tip));
    for (int i = 0; i < 4; i++)
        TRY(builder_triangle(m, corner[i], corner[(i + 1) % 4], tip));
    return STARG_OK;
}

static starg_status add_square(blocks *b, mesh_builder *m, const cube_place *place, int way,
                               bool spiked) {
    int at[4][3];
    uint32_t corner[4];
    square_corners(place, way, at);
    for (int i = 0; i < 4; i++)
        TRY(corner_vertex(m, at[i], &corner[i]));
    if (spiked && wants_spike(b, place, way))
        TRY(add_spike(b, m, corner, (const int(*)[3])at, way));
    else
        TRY(builder_quad(m, corner[0], corner[1], corner[2], corner[3]));
    return STARG_OK;
}

static starg_status make_mesh(blocks *b, bool spiked, starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder m = {.context = b->context};
    cube_place place;
    int *at = place.at;
    for (at[0] = 1; at[0] < b->side - 1; at[0]++)
        for (at[1] = 1; at[1] < b->side - 1; at[1]++)
            for (at[2] = 1; at[2] < b->side - 1; at[2]++)
                for (int way = 0; way < 6 && b->solid[index_of(b, at)]; way++) {
                    const cube_place next = beyond(&place, way, 1);
                    if (!b->solid[index_of(b, next.at)])
                        TRY(add_square(b, &m, &place, way, spiked));
                }
    return builder_finish(&m, out);
}

starg_status solid_blocks(starg_context *context, blocks_kind kind, int member, size_t vertex_count,
                          starg_mesh **out) {
    starg_status (*const build[])(blocks *, size_t) = {grow_polycube, dig_maze, build_comb,
                                                       build_room};
    starg_status status = STARG_OK;
    blocks b = {.context = context,
                .rng = starg_rng_make((uint64_t)member, RANDOM_STREAM, (uint64_t)kind)};
    size_t squares = vertex_count - 2; /* of a quad mesh of genus 0 */
    b.side = 8;
    while ((size_t)b.side * (size_t)b.side < squares && b.side < MOST_SIDE)
        b.side++;
    STARG_NEW_ZERO(context, STAGE, b.solid, (size_t)b.side * (size_t)b.side * (size_t)b.side);
    STARG_TRY(build[kind](&b, squares));
    STARG_TRY(make_mesh(&b, kind == BLOCKS_SPIKES, out));
done:
    RELEASE(b.solid, b.open.data);
    return status;
}
