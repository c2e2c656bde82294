/* SPDX-License-Identifier: Apache-2.0 */
/* Overlay of two triangulations of the sphere: their common refinement.
 *
 * Problem: the faces of two surfaces are positive spherical triangles that cover the sphere once.
 * Find the intersections of all pairs of triangles, with shared corners.
 *
 * Two triangles are convex cones, and their intersection is one. If it has an interior, its corners
 * are the corners of either triangle in the closed other one, and the points where edges cross
 * properly; every one of them is strictly convex, since corners of triangles are. So a point of the
 * overlay that lies on a cell's boundary is a corner of the cell, and cells fit together corner to
 * corner, also where vertices coincide, or lie on edges, or edges on one another. Corners and their
 * order follow from the signs of det(p, q, r) with vertices p, q, r of the input, which are exact;
 * no sign is asked of a point that was computed.
 *
 * Stages: orient both sides and check them; find one cell; spread across the edges of cells, which
 * says which faces come next. Points get weights in their faces by determinants (overlay_room.c
 * evens out what rounding spoils).
 * Cost: O(cells), and O(faces) for the first. */
#include "morph/surface_map.h"

#include <float.h>

#include "core/rng.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "overlay";
static const double ORIGIN[3];

/* ---- both sides ---- */

static const double *direction_at(const overlay_side *side, uint32_t corner) {
    return side->directions + 3 * (size_t)side->faces[corner];
}

static int face_sign(const overlay_side *side, uint32_t face) {
    return orient3d(direction_at(side, 3 * face), direction_at(side, 3 * face + 1),
                    direction_at(side, 3 * face + 2), ORIGIN);
}

static void reverse_faces(overlay_side *side) {
    for (size_t f = 0; f < side->mesh->face_count; f++) {
        uint32_t kept = side->faces[3 * f + 1];
        side->faces[3 * f + 1] = side->faces[3 * f + 2];
        side->faces[3 * f + 2] = kept;
    }
}

static starg_status check_side(starg_context *context, const overlay_side *side, int index) {
    for (uint32_t f = 0; f < side->mesh->face_count; f++) {
        const uint64_t element = f;
        if (face_sign(side, f) <= 0)
            return starg_fail_at(context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_FACE, &element, 1,
                                 "face %u of %c folds on the sphere: the map's directions are not "
                                 "those of a bijection of these models",
                                 f, 'A' + index);
        for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
            if (side->topology->twin[h] == TOPOLOGY_NONE)
                return starg_fail_at(context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_FACE, &element,
                                     1, "face %u of %c has an edge without a single neighbour", f,
                                     'A' + index);
    }
    return STARG_OK;
}

static starg_status make_side(starg_context *context, const starg_mesh *mesh,
                              const double *directions, int index, overlay_side *side) {
    size_t size = 3 * mesh->face_count;
    *side = (overlay_side){.mesh = mesh, .directions = directions};
    NEW(context, STAGE, side->faces, size);
    memcpy(side->faces, mesh->faces, size * sizeof *side->faces);
    if (face_sign(side, 0) < 0)
        reverse_faces(side);
    starg_mesh oriented = *mesh;
    oriented.faces = side->faces;
    TRY(topology_create(context, &oriented, &side->topology));
    return check_side(context, side, index);
}

/* ---- one pair of faces ---- */

/* A corner of the intersection: corners of either face (or -1), or a crossing of edges (likewise).
 * Bits of `lines`: edges 0 to 2 of A's face, 3 to 5 of B's, on which it lies. */
typedef struct meeting {
    int corner[2], edge[2];
    unsigned lines;
} meeting;

typedef struct pair_meeting {
    uint32_t face[2];
    int sign[2][3][3]; /* of the other side's corner (last) about the edge of one side */
    size_t count;
    meeting at[15];
} pair_meeting;

static int next3(int k) {
    return k == 2 ? 0 : k + 1;
}

static int before3(int k) {
    return k == 0 ? 2 : k - 1;
}

static void find_signs(const sphere_overlay *own, pair_meeting *pair) {
    for (int s = 0; s < 2; s++) {
        const overlay_side *side = &own->side[s], *other = &own->side[1 - s];
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                pair->sign[s][k][j] =
                    orient3d(direction_at(side, 3 * pair->face[s] + (uint32_t)k),
                             direction_at(side, 3 * pair->face[s] + (uint32_t)next3(k)),
                             direction_at(other, 3 * pair->face[1 - s] + (uint32_t)j), ORIGIN);
    }
}

/* The bit of an edge. */
static unsigned line_bit(int side, int edge) {
    return 1U << (3 * side + edge);
}

/* Adds corner k of one side if it is in the closed face of the other. Where both have a corner, the
 * first side's stands for both. */
static void add_corner(pair_meeting *pair, int s, int k) {
    meeting found = {.corner = {-1, -1}, .edge = {-1, -1}};
    found.corner[s] = k;
    found.lines = line_bit(s, k) | line_bit(s, before3(k));
    for (int j = 0; j < 3; j++) {
        if (pair->sign[1 - s][j][k] < 0)
            return;
        if (pair->sign[1 - s][j][k] == 0)
            found.lines |= line_bit(1 - s, j);
    }
    for (int j = 0; j < 3; j++) {
        unsigned both = line_bit(1 - s, j) | line_bit(1 - s, before3(j));
        if ((found.lines & both) == both)
            found.corner[1 - s] = j;
    }
    if (s == 0 || found.corner[0] < 0)
        pair->at[pair->count++] = found;
}

/* Adds the crossing of edges k and j if they cross properly. The last sign excludes edges that
 * cross each other's plane on opposite sides of the sphere. */
static void add_crossing(pair_meeting *pair, int k, int j) {
    const int *own = pair->sign[0][k];
    int from = pair->sign[1][j][k], to = pair->sign[1][j][next3(k)];
    if (own[j] * own[next3(j)] < 0 && from * to < 0 && from * own[j] < 0)
        pair->at[pair->count++] =
            (meeting){.corner = {-1, -1}, .edge = {k, j}, .lines = line_bit(0, k) | line_bit(1, j)};
}

static void find_meetings(const sphere_overlay *own, pair_meeting *pair) {
    pair->count = 0;
    find_signs(own, pair);
    for (int s = 0; s < 2; s++)
        for (int k = 0; k < 3; k++)
            add_corner(pair, s, k);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            add_crossing(pair, k, j);
}

/* Of two meetings on an edge of a face, is p the first one along it? */
static bool is_first(const pair_meeting *pair, int s, int edge, const meeting *p,
                     const meeting *q) {
    if (p->corner[s] == edge || q->corner[s] == next3(edge))
        return true;
    if (q->corner[s] == edge || p->corner[s] == next3(edge))
        return false;
    /* an edge crosses into the other face if it begins outside of it there */
    if (p->edge[1 - s] >= 0)
        return pair->sign[1 - s][p->edge[1 - s]][edge] < 0;
    if (q->edge[1 - s] >= 0)
        return pair->sign[1 - s][q->edge[1 - s]][edge] > 0;
    return q->corner[1 - s] == next3(p->corner[1 - s]);
}

/* Links each meeting to the next one around the intersection, and says on which edges of the faces
 * the way lies. */
static void link_meetings(const pair_meeting *pair, size_t next[15], unsigned along[15]) {
    for (size_t i = 0; i < pair->count; i++)
        along[i] = 0;
    for (int line = 0; line < 6; line++) {
        size_t ends[2], found = 0;
        for (size_t i = 0; i < pair->count && found < 2; i++)
            if (pair->at[i].lines >> line & 1)
                ends[found++] = i;
        if (found < 2)
            continue;
        size_t swap = !is_first(pair, line / 3, line % 3, &pair->at[ends[0]], &pair->at[ends[1]]);
        next[ends[swap]] = ends[1 - swap];
        along[ends[swap]] |= 1U << line;
    }
}

/* ---- nodes ---- */

typedef struct spreader {
    sphere_overlay *own;
    uint32_t *slots; /* of nodes: index + 1 */
    size_t slot_count;
    uint32_t *pair_slots; /* of pairs: index + 1 */
    size_t pair_slot_count;
    STARG_ARRAY(uint64_t) pairs; /* that were reached, in order */
} spreader;

static uint64_t hash_pair(uint64_t x, uint64_t y) {
    return starg_hash64(starg_hash64(x) + y);
}

/* The edge of a halfedge: the lower one of both. */
static uint32_t edge_name(const overlay_side *side, uint32_t halfedge) {
    uint32_t twin = side->topology->twin[halfedge];
    return twin < halfedge ? twin : halfedge;
}

/* The weight of a corner whose sign is known: rounding must not lose it. */
static double weight_of(double value, int sign) {
    return sign == 0 ? 0 : fmax(value, DBL_MIN);
}

static void normalize(double w[3]) {
    double sum = w[0] + w[1] + w[2];
    for (int k = 0; k < 3; k++)
        w[k] = w[k] > 0 ? fmax(w[k] / sum, DBL_EPSILON * DBL_EPSILON) : 0;
}

/* Where on side s is a corner of the other side? */
static void place_corner(const sphere_overlay *own, const pair_meeting *pair, int s, int corner,
                         overlay_place *place) {
    const overlay_side *side = &own->side[s], *other = &own->side[1 - s];
    const double *x = direction_at(other, 3 * pair->face[1 - s] + (uint32_t)corner);
    for (int k = 0; k < 3; k++) {
        int edge = next3(k); /* opposite to corner k */
        const double *p = direction_at(side, 3 * pair->face[s] + (uint32_t)edge);
        const double *q = direction_at(side, 3 * pair->face[s] + (uint32_t)next3(edge));
        place->weight[k] = weight_of(vec3_triple(p, q, x), pair->sign[s][edge][corner]);
    }
    normalize(place->weight);
}

/* Where on an edge of side s does an edge of the other side cross it? */
static void place_crossing(const sphere_overlay *own, const pair_meeting *pair, int s, int edge,
                           int other_edge, overlay_place *place) {
    const overlay_side *side = &own->side[s], *other = &own->side[1 - s];
    const double *p = direction_at(other, 3 * pair->face[1 - s] + (uint32_t)other_edge);
    const double *q = direction_at(other, 3 * pair->face[1 - s] + (uint32_t)next3(other_edge));
    const double *from = direction_at(side, 3 * pair->face[s] + (uint32_t)edge);
    const double *to = direction_at(side, 3 * pair->face[s] + (uint32_t)next3(edge));
    place->weight[edge] = weight_of(fabs(vec3_triple(p, q, to)), 1);
    place->weight[next3(edge)] = weight_of(fabs(vec3_triple(p, q, from)), 1);
    normalize(place->weight);
}

static overlay_node make_node(const sphere_overlay *own, const pair_meeting *pair,
                              const meeting *at) {
    overlay_node node = {.key = {OVERLAY_NONE, OVERLAY_NONE}};
    for (int s = 0; s < 2; s++) {
        const overlay_side *side = &own->side[s];
        overlay_place *place = &node.place[s];
        place->face = pair->face[s];
        uint32_t first = 3 * pair->face[s];
        if (at->corner[s] >= 0) {
            node.key[s] = OVERLAY_VERTEX | side->faces[first + (uint32_t)at->corner[s]];
            place->weight[at->corner[s]] = 1;
        } else if (at->edge[s] >= 0) {
            node.key[s] = edge_name(side, first + (uint32_t)at->edge[s]);
            place_crossing(own, pair, s, at->edge[s], at->edge[1 - s], place);
        } else {
            place_corner(own, pair, s, at->corner[1 - s], place);
        }
    }
    return node;
}

/* Doubles a hash table of indices + 1 and says whether it was needed. */
static bool is_crowded(size_t used, size_t slots) {
    return 2 * (used + 1) > slots;
}

static starg_status grow_slots(starg_context *context, uint32_t **slots, size_t *count) {
    uint32_t *fresh = NULL;
    size_t wanted = *count == 0 ? 1024 : 2 * *count;
    NEW_ZERO(context, STAGE, fresh, wanted);
    starg_release(context, *slots);
    *slots = fresh;
    *count = wanted;
    return STARG_OK;
}

/* The slot of a node, or the free one for it. A vertex has one place on the other side, so that the
 * key of its own side names it. */
static uint32_t *node_slot(const spreader *s, const uint64_t key[2]) {
    size_t mask = s->slot_count - 1;
    for (size_t i = (size_t)hash_pair(key[0], key[1]) & mask;; i = (i + 1) & mask) {
        uint32_t held = s->slots[i];
        if (held == 0)
            return &s->slots[i];
        const uint64_t *other = s->own->nodes.data[held - 1].key;
        if (other[0] == key[0] && other[1] == key[1])
            return &s->slots[i];
    }
}

static starg_status find_node(spreader *s, const overlay_node *node, uint32_t *index) {
    sphere_overlay *own = s->own;
    if (is_crowded(own->nodes.count, s->slot_count)) {
        TRY(grow_slots(own->context, &s->slots, &s->slot_count));
        for (uint32_t i = 0; i < own->nodes.count; i++)
            *node_slot(s, own->nodes.data[i].key) = i + 1;
    }
    uint32_t *slot = node_slot(s, node->key);
    if (*slot == 0) {
        PUSH(own->context, STAGE, &own->nodes, *node);
        *slot = (uint32_t)own->nodes.count;
    }
    *index = *slot - 1;
    return STARG_OK;
}

/* ---- spreading ---- */

static uint32_t *pair_slot(const spreader *s, uint64_t pair) {
    size_t mask = s->pair_slot_count - 1, i = (size_t)starg_hash64(pair + 1) & mask;
    while (s->pair_slots[i] != 0 && s->pairs.data[s->pair_slots[i] - 1] != pair)
        i = (i + 1) & mask;
    return &s->pair_slots[i];
}

static starg_status reach(spreader *s, uint32_t a, uint32_t b) {
    starg_context *context = s->own->context;
    uint64_t pair = (uint64_t)a << 32 | b;
    if (is_crowded(s->pairs.count, s->pair_slot_count)) {
        TRY(grow_slots(context, &s->pair_slots, &s->pair_slot_count));
        for (uint32_t i = 0; i < s->pairs.count; i++)
            *pair_slot(s, s->pairs.data[i]) = i + 1;
    }
    uint32_t *slot = pair_slot(s, pair);
    if (*slot != 0)
        return STARG_OK;
    PUSH(context, STAGE, &s->pairs, pair);
    *slot = (uint32_t)s->pairs.count;
    return STARG_OK;
}

/* The face of a side beyond the edges of a way; the face itself if none is of this side. */
static uint32_t face_beyond(const overlay_side *side, int s, uint32_t face, unsigned along) {
    for (int k = 0; k < 3; k++)
        if (along & line_bit(s, k))
            return side->topology->twin[3 * face + (uint32_t)k] / 3;
    return face;
}

/* Makes the cell of a pair, and reaches its neighbours. */
static starg_status make_cell(spreader *s, const pair_meeting *pair) {
    sphere_overlay *own = s->own;
    overlay_cell cell = {.face = {pair->face[0], pair->face[1]}};
    size_t next[15] = {0};
    unsigned along[15];
    link_meetings(pair, next, along);
    size_t at = 0;
    do {
        const overlay_node node = make_node(own, pair, &pair->at[at]);
        TRY(find_node(s, &node, &cell.corner[cell.count++]));
        TRY(reach(s, face_beyond(&own->side[0], 0, cell.face[0], along[at]),
                  face_beyond(&own->side[1], 1, cell.face[1], along[at])));
        at = next[at];
    } while (at != 0 && cell.count < OVERLAY_CORNERS);
    PUSH(own->context, STAGE, &own->cells, cell);
    return STARG_OK;
}

/* The first face of B that shares a part of face 0 of A with an interior. */
static starg_status begin(spreader *s) {
    size_t count = s->own->side[1].mesh->face_count;
    for (uint32_t f = 0; f < count; f++) {
        pair_meeting pair = {.face = {0, f}};
        find_meetings(s->own, &pair);
        if (pair.count >= 3)
            return reach(s, 0, f);
    }
    return starg_fail(s->own->context, STARG_ERROR_MESH, STAGE,
                      "the directions of B do not cover the sphere");
}

static starg_status spread(spreader *s) {
    TRY(begin(s));
    for (size_t i = 0; i < s->pairs.count; i++) {
        pair_meeting pair = {
            .face = {(uint32_t)(s->pairs.data[i] >> 32), (uint32_t)s->pairs.data[i]}};
        TRY(starg_check_cancel(s->own->context, STAGE));
        find_meetings(s->own, &pair);
        TRY(make_cell(s, &pair));
    }
    return STARG_OK;
}

starg_status overlay_create(starg_context *context, const starg_mesh *const meshes[2],
                            const double *const directions[2], sphere_overlay **out) {
    starg_status status = STARG_OK;
    sphere_overlay *own = NULL;
    spreader s = {0};
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, own, 1);
    own->context = context;
    for (int i = 0; i < 2; i++)
        STARG_TRY(make_side(context, meshes[i], directions[i], i, &own->side[i]));
    s.own = own;
    STARG_TRY(spread(&s));
    *out = own;
    own = NULL;
done:
    RELEASE(s.slots, s.pair_slots, s.pairs.data);
    overlay_free(own);
    return status;
}

void overlay_free(sphere_overlay *own) {
    if (own == NULL)
        return;
    for (int i = 0; i < 2; i++) {
        starg_release(own->context, own->side[i].faces);
        topology_free(own->side[i].topology);
    }
    RELEASE(own->nodes.data, own->cells.data, own);
}
