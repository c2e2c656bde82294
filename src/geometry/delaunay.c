/* SPDX-License-Identifier: Apache-2.0 */
/* Incremental Delaunay tetrahedralization [Bowyer 1981, Watson 1981] with exact predicates.
 *
 * Points are inserted in a biased randomized order (rounds of doubling size, each along a Hilbert
 * curve) [Amenta, Choi, Rote 2003], which keeps walks short and memory access local.
 *
 * Ghost tetrahedra with the vertex GHOST close the hull. A tetrahedron conflicts with a point p
 * strictly inside its circumsphere; a ghost conflicts if p lies strictly beyond its hull face, or
 * in the face's plane and in conflict with the tetrahedron behind it. The conflict zone is
 * connected and star-shaped about p; each face of its border is joined to p. This holds for
 * cospherical points too, because "on the sphere" always counts as outside: a border facet coplanar
 * with p would put p strictly inside the facet's circle and so inside both spheres through it.
 *
 * Expected cost O(n log n) for points on surfaces in practice; O(n^2) in the worst case. */
#include "geometry/delaunay.h"

#include <stdlib.h>

#include "core/rng.h"
#include "core/streams.h"
#include "geometry/predicates.h"

static const uint32_t GHOST = UINT32_MAX;
static const uint32_t NOWHERE = UINT32_MAX;

typedef struct cell {
    uint32_t vertex[4];
    uint32_t neighbour[4]; /* across the face opposite each vertex */
    uint32_t mark;         /* stamp of the insertion that tested it, times two; plus 1: conflict */
    uint32_t next_free;
} cell;

/* Face `side` of `cell`, on the border of the conflict zone. */
typedef struct border_face {
    uint32_t cell, side;
} border_face;

/* A border edge waiting for its second new cell. */
typedef struct open_edge {
    uint64_t key;
    uint32_t cell, side;
    uint32_t stamp;
} open_edge;

typedef struct delaunay_builder {
    starg_context *context;
    const double *points;
    size_t count;       /* points inserted or skipped */
    uint32_t *incident; /* a cell at each point, or NOWHERE */
    bool *changed;      /* per point: since the caller last asked */
    STARG_ARRAY(cell) cells;
    uint32_t free_cells;
    uint32_t last; /* start of the next walk */
    uint32_t stamp;
    STARG_ARRAY(uint32_t) zone;
    STARG_ARRAY(border_face) border;
    open_edge *edges;
    size_t edge_capacity; /* a power of two */
    starg_rng rng;
    STARG_ARRAY(uint32_t) star;
    uint32_t star_of; /* the point whose star was returned last, or NOWHERE */
    size_t star_count;
    uint32_t (*corners)[3]; /* of the star, as returned */
    size_t corner_capacity;
} builder;

typedef struct sort_key {
    uint64_t key;
    uint32_t point;
} sort_key;

/* Position along a Hilbert curve through 2^20 cells per axis [Skilling 2004]. */
static uint64_t hilbert_index(const uint32_t position[3]) {
    enum { BITS = 20 };
    uint32_t x[3] = {position[0], position[1], position[2]}, t;
    for (uint32_t q = UINT32_C(1) << (BITS - 1); q > 1; q >>= 1)
        for (int i = 0; i < 3; i++) {
            if (x[i] & q) {
                x[0] ^= q - 1;
            } else {
                t = (x[0] ^ x[i]) & (q - 1);
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    x[1] ^= x[0];
    x[2] ^= x[1];
    t = 0;
    for (uint32_t q = UINT32_C(1) << (BITS - 1); q > 1; q >>= 1)
        if (x[2] & q)
            t ^= q - 1;
    uint64_t index = 0;
    for (int bit = BITS - 1; bit >= 0; bit--)
        for (int i = 0; i < 3; i++)
            index = index << 1 | ((x[i] ^ t) >> bit & 1);
    return index;
}

static int compare_keys(const void *left, const void *right) {
    const sort_key *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return (a->point > b->point) - (a->point < b->point);
}

/* Rounds: a point is in the last round with probability 1/2, in the one before with 1/4, ... */
static void order_points(const double *points, size_t begin, size_t count, uint64_t seed,
                         sort_key *order) {
    double lower[3], scale[3];
    points += 3 * begin;
    for (int k = 0; k < 3; k++) {
        double upper = lower[k] = points[k];
        for (size_t i = 1; i < count; i++) {
            double x = points[3 * i + (size_t)k];
            lower[k] = x < lower[k] ? x : lower[k];
            upper = x > upper ? x : upper;
        }
        scale[k] = upper > lower[k] ? 0xfffff / (upper - lower[k]) : 0;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t position[3];
        for (size_t k = 0; k < 3; k++)
            position[k] = (uint32_t)((points[3 * i + k] - lower[k]) * scale[k]);
        starg_rng rng = starg_rng_make(seed, STREAM_DELAUNAY_POINTS, begin + i);
        uint64_t draw = starg_rng_next(&rng) | 1;
        uint64_t round = (uint64_t)__builtin_clzll(draw);
        round = round > 14 ? 0 : 15 - round;
        order[i] = (sort_key){round << 60 | hilbert_index(position), (uint32_t)(begin + i)};
    }
    qsort(order, count, sizeof *order, compare_keys);
}

static const double *point(const builder *b, uint32_t vertex) {
    return b->points + 3 * (size_t)vertex;
}

static int ghost_side(const cell *c) {
    for (int k = 0; k < 4; k++)
        if (c->vertex[k] == GHOST)
            return k;
    return -1;
}

/* Sign of the volume of the cell with corner `side` moved to p. */
static int orient_with(const builder *b, const cell *c, int side, const double p[3]) {
    const double *q[4];
    for (int k = 0; k < 4; k++)
        q[k] = k == side ? p : point(b, c->vertex[k]);
    return orient3d(q[0], q[1], q[2], q[3]);
}

static bool in_sphere(const builder *b, const cell *c, const double p[3]) {
    return insphere(point(b, c->vertex[0]), point(b, c->vertex[1]), point(b, c->vertex[2]),
                    point(b, c->vertex[3]), p) > 0;
}

static bool in_conflict(const builder *b, const cell *c, const double p[3]) {
    int ghost = ghost_side(c);
    if (ghost < 0)
        return in_sphere(b, c, p);
    int side = orient_with(b, c, ghost, p);
    return side > 0 || (side == 0 && in_sphere(b, &b->cells.data[c->neighbour[ghost]], p));
}

/* Walks to the cell that contains p, or to a ghost whose face separates p from the hull. Faces are
 * tested from a random one on, which rules out cycles. */
static uint32_t locate(builder *b, const double p[3]) {
    uint32_t at = b->last;
    int ghost = ghost_side(&b->cells.data[at]);
    if (ghost >= 0)
        at = b->cells.data[at].neighbour[ghost];
    for (;;) {
        const cell *c = &b->cells.data[at];
        if (ghost_side(c) >= 0)
            return at;
        int first = (int)(starg_rng_next(&b->rng) & 3), leave = -1;
        for (int k = 0; k < 4 && leave < 0; k++)
            if (orient_with(b, c, (first + k) & 3, p) < 0)
                leave = (first + k) & 3;
        if (leave < 0)
            return at;
        at = c->neighbour[leave];
    }
}

static bool is_corner(const builder *b, const cell *c, const double p[3]) {
    for (int k = 0; k < 4; k++) {
        if (c->vertex[k] == GHOST)
            continue;
        const double *q = point(b, c->vertex[k]);
        if (q[0] == p[0] && q[1] == p[1] && q[2] == p[2])
            return true;
    }
    return false;
}

static starg_status new_cell(builder *b, uint32_t *index) {
    if (b->free_cells != NOWHERE) {
        *index = b->free_cells;
        b->free_cells = b->cells.data[*index].next_free;
        return STARG_OK;
    }
    *index = (uint32_t)b->cells.count;
    PUSH(b->context, "delaunay", &b->cells, ((cell){.mark = 0}));
    return STARG_OK;
}

/* Collects the cells in conflict with p, starting from `start`, and their border faces. */
static starg_status find_zone(builder *b, uint32_t start, const double p[3]) {
    b->stamp += 2;
    b->zone.count = b->border.count = 0;
    b->cells.data[start].mark = b->stamp + 1;
    PUSH(b->context, "delaunay", &b->zone, start);
    for (size_t i = 0; i < b->zone.count; i++) {
        uint32_t at = b->zone.data[i];
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t other = b->cells.data[at].neighbour[k];
            cell *c = &b->cells.data[other];
            if (c->mark < b->stamp) {
                bool conflict = in_conflict(b, c, p);
                c->mark = b->stamp + conflict;
                if (conflict)
                    PUSH(b->context, "delaunay", &b->zone, other);
            }
            if (b->cells.data[other].mark == b->stamp)
                PUSH(b->context, "delaunay", &b->border, ((border_face){at, k}));
        }
    }
    return STARG_OK;
}

static uint64_t edge_key(uint32_t u, uint32_t v) {
    return u < v ? (uint64_t)u << 32 | v : (uint64_t)v << 32 | u;
}

/* Three edges per two border faces fill the table at most half. */
static starg_status reserve_edges(builder *b) {
    size_t wanted = 4 * b->border.count;
    if (wanted <= b->edge_capacity)
        return STARG_OK;
    size_t capacity = b->edge_capacity ? b->edge_capacity : 256;
    while (capacity < wanted)
        capacity *= 2;
    starg_release(b->context, b->edges);
    b->edges = NULL;
    b->edge_capacity = 0;
    NEW_ZERO(b->context, "delaunay", b->edges, capacity);
    b->edge_capacity = capacity;
    return STARG_OK;
}

/* Joins face `side` of `index` with the new cell that has the same border edge, once it exists. */
static void join_across(builder *b, uint32_t index, uint32_t side, uint64_t key) {
    size_t slot = starg_hash64(key) & (b->edge_capacity - 1);
    for (;; slot = (slot + 1) & (b->edge_capacity - 1)) {
        open_edge *edge = &b->edges[slot];
        if (edge->stamp != b->stamp) {
            *edge = (open_edge){key, index, side, b->stamp};
            return;
        }
        if (edge->key == key) {
            b->cells.data[index].neighbour[side] = edge->cell;
            b->cells.data[edge->cell].neighbour[edge->side] = index;
            return;
        }
    }
}

static void note_change(builder *b, const uint32_t vertex[4], uint32_t index) {
    for (int k = 0; k < 4; k++)
        if (vertex[k] != GHOST) {
            b->incident[vertex[k]] = index;
            b->changed[vertex[k]] = true;
        }
}

/* Makes the new cell on a border face: the old cell with its corner in the zone replaced by p. */
static starg_status fill_face(builder *b, border_face face, uint32_t vertex) {
    uint32_t index;
    TRY(new_cell(b, &index));
    cell *c = &b->cells.data[index];
    const cell *old = &b->cells.data[face.cell];
    uint32_t outside = old->neighbour[face.side];
    memcpy(c->vertex, old->vertex, sizeof c->vertex);
    c->vertex[face.side] = vertex;
    c->neighbour[face.side] = outside;
    c->mark = b->stamp;
    note_change(b, c->vertex, index);
    cell *beyond = &b->cells.data[outside];
    for (int k = 0; k < 4; k++)
        if (beyond->neighbour[k] == face.cell)
            beyond->neighbour[k] = index;
    for (uint32_t k = 0; k < 4; k++) {
        if (k == face.side)
            continue;
        uint32_t ends[2], count = 0;
        for (uint32_t j = 0; j < 4; j++)
            if (j != k && j != face.side)
                ends[count++] = c->vertex[j];
        join_across(b, index, k, edge_key(ends[0], ends[1]));
    }
    b->last = index;
    return STARG_OK;
}

static starg_status insert(builder *b, uint32_t vertex) {
    const double *p = point(b, vertex);
    uint32_t start = locate(b, p);
    if (is_corner(b, &b->cells.data[start], p))
        return STARG_OK;
    TRY(find_zone(b, start, p));
    TRY(reserve_edges(b));
    for (size_t i = 0; i < b->border.count; i++)
        TRY(fill_face(b, b->border.data[i], vertex));
    for (size_t i = 0; i < b->zone.count; i++) {
        cell *c = &b->cells.data[b->zone.data[i]];
        c->vertex[0] = c->vertex[1] = NOWHERE; /* two ghosts: no cell */
        c->next_free = b->free_cells;
        b->free_cells = b->zone.data[i];
    }
    return STARG_OK;
}

/* Finds four points, early in the order, that span a tetrahedron, and moves them to the front. */
static bool find_first_four(const builder *b, sort_key *order, size_t count) {
    size_t found = 0;
    for (size_t i = 0; i < count && found < 4; i++) {
        const double *p = point(b, order[i].point);
        const double *q[3];
        for (size_t k = 0; k < found && k < 3; k++)
            q[k] = point(b, order[k].point);
        bool apart = found == 0 ||
                     (found == 1 && (p[0] != q[0][0] || p[1] != q[0][1] || p[2] != q[0][2])) ||
                     (found == 2 && !collinear(q[0], q[1], p)) ||
                     (found == 3 && orient3d(q[0], q[1], q[2], p) != 0);
        if (!apart)
            continue;
        sort_key swap = order[i];
        memmove(order + found + 1, order + found, (i - found) * sizeof *order);
        order[found++] = swap;
    }
    return found == 4;
}

/* Makes one tetrahedron and its four ghosts. Ghost k replaces corner k by GHOST and swaps two other
 * corners to stay positively oriented. */
static starg_status make_first(builder *b, const sort_key *order) {
    uint32_t v[4], index;
    for (int k = 0; k < 4; k++)
        v[k] = order[k].point;
    if (orient3d(point(b, v[0]), point(b, v[1]), point(b, v[2]), point(b, v[3])) < 0) {
        uint32_t swap = v[0];
        v[0] = v[1];
        v[1] = swap;
    }
    for (int i = 0; i < 5; i++) {
        TRY(new_cell(b, &index));
    }
    cell *first = b->cells.data;
    memcpy(first->vertex, v, sizeof v);
    for (uint32_t k = 0; k < 4; k++) {
        cell *ghost = &b->cells.data[1 + k];
        uint32_t i = (k + 1) % 4, j = (k + 2) % 4;
        memcpy(ghost->vertex, v, sizeof v);
        ghost->vertex[k] = GHOST;
        ghost->vertex[i] = v[j];
        ghost->vertex[j] = v[i];
        for (uint32_t m = 0; m < 4; m++)
            ghost->neighbour[m] = 1 + m; /* ghost m lies opposite corner m ... */
        ghost->neighbour[i] = 1 + j;     /* ... whose corner was swapped */
        ghost->neighbour[j] = 1 + i;
        ghost->neighbour[k] = 0;
        first->neighbour[k] = 1 + k;
    }
    for (int k = 0; k < 4; k++) {
        b->incident[v[k]] = 0;
        b->changed[v[k]] = true;
    }
    b->last = 0;
    return STARG_OK;
}

static starg_status insert_all(builder *b, const sort_key *order, size_t first, size_t count) {
    starg_status status = STARG_OK;
    starg_progress_begin(b->context, "delaunay");
    for (size_t i = first; i < count && status == STARG_OK; i++) {
        if (i % 1024 == 0) {
            starg_progress_step(b->context, i, count);
            status = starg_check_cancel(b->context, "delaunay");
        }
        if (status == STARG_OK)
            status = insert(b, order[i].point);
    }
    starg_progress_end(b->context);
    return status;
}

/* Numbers the finite cells in the order of the pool; `mark` receives the number. */
static size_t number_cells(builder *b) {
    size_t count = 0;
    for (size_t i = 0; i < b->cells.count; i++) {
        cell *c = &b->cells.data[i];
        c->mark = ghost_side(c) < 0 ? (uint32_t)count++ : DELAUNAY_NONE;
    }
    return count;
}

static starg_status collect(builder *b, delaunay *result) {
    size_t count = number_cells(b);
    NEW(b->context, "delaunay", result->tetrahedra, count);
    NEW(b->context, "delaunay", result->neighbours, count);
    result->count = count;
    for (size_t i = 0; i < b->cells.count; i++) {
        const cell *c = &b->cells.data[i];
        if (c->mark == DELAUNAY_NONE)
            continue;
        memcpy(result->tetrahedra[c->mark], c->vertex, sizeof *result->tetrahedra);
        for (int k = 0; k < 4; k++)
            result->neighbours[c->mark][k] = b->cells.data[c->neighbour[k]].mark;
    }
    return STARG_OK;
}

/* Makes room for the data of each point. */
static starg_status reserve_points(builder *b, size_t count) {
    starg_status status = STARG_OK;
    uint32_t *incident =
        starg_reallocate(b->context, b->incident, b->count, count, sizeof *b->incident);
    if (incident == NULL)
        return starg_fail_memory(b->context, "delaunay");
    b->incident = incident;
    bool *changed = starg_reallocate(b->context, b->changed, b->count, count, sizeof *b->changed);
    if (changed == NULL)
        return starg_fail_memory(b->context, "delaunay");
    b->changed = changed;
    for (size_t i = b->count; i < count; i++) {
        b->incident[i] = NOWHERE;
        b->changed[i] = true;
    }
    return status;
}

/* While all points are coplanar there are no cells; skipped points are never inserted. */
starg_status delaunay_extend(delaunay_builder *b, const double *points, size_t count) {
    SCOPED sort_key *order = NULL;
    size_t added = count - b->count, first = 0;
    b->points = points;
    b->star_of = NOWHERE;
    TRY(reserve_points(b, count));
    NEW(b->context, "delaunay", order, added);
    if (added > 0)
        order_points(points, b->count, added, b->context->seed, order);
    b->count = count;
    if (b->cells.count == 0) {
        if (!find_first_four(b, order, added))
            return STARG_OK;
        TRY(make_first(b, order));
        first = 4;
    }
    return insert_all(b, order, first, added);
}

starg_status delaunay_begin(starg_context *context, const double *points, size_t count,
                            delaunay_builder **out) {
    SCOPED_BY(delaunay_builder_drop) builder *b = NULL;
    *out = NULL;
    NEW_ZERO(context, "delaunay", b, 1);
    b->context = context;
    b->free_cells = NOWHERE;
    b->rng = starg_rng_make(context->seed, STREAM_DELAUNAY_ORDER, 0);
    TRY(delaunay_extend(b, points, count));
    *out = b;
    b = NULL;
    return STARG_OK;
}

starg_status delaunay_copy(const delaunay_builder *b, delaunay_builder **out) {
    starg_context *context = b->context;
    SCOPED_BY(delaunay_builder_drop) builder *copy = NULL;
    *out = NULL;
    NEW_ZERO(context, "delaunay", copy, 1);
    *copy = (builder){.context = context,
                      .count = b->count,
                      .free_cells = b->free_cells,
                      .last = b->last,
                      .stamp = b->stamp,
                      .rng = b->rng,
                      .star_of = NOWHERE};
    NEW(context, "delaunay", copy->incident, b->count);
    NEW(context, "delaunay", copy->changed, b->count);
    NEW(context, "delaunay", copy->cells.data, b->cells.capacity);
    copy->cells.count = b->cells.count;
    copy->cells.capacity = b->cells.capacity;
    if (b->count > 0) {
        memcpy(copy->incident, b->incident, b->count * sizeof *b->incident);
        memcpy(copy->changed, b->changed, b->count * sizeof *b->changed);
    }
    if (b->cells.count > 0)
        memcpy(copy->cells.data, b->cells.data, b->cells.count * sizeof *b->cells.data);
    *out = copy;
    copy = NULL;
    return STARG_OK;
}

void delaunay_builder_free(delaunay_builder *b) {
    if (b == NULL)
        return;
    RELEASE(b->cells.data, b->zone.data, b->border.data, b->star.data, b->edges, b->incident,
            b->changed, b->corners, b);
}

bool delaunay_has_changed(const delaunay_builder *b, uint32_t point_index) {
    return b->changed[point_index];
}

bool delaunay_take_change(delaunay_builder *b, uint32_t point_index) {
    bool changed = b->changed[point_index];
    b->changed[point_index] = false;
    return changed;
}

/* Makes room for the corners of all cells of the star. */
static starg_status reserve_corners(builder *b) {
    starg_status status = STARG_OK;
    uint32_t(*corners)[3] = NULL;
    if (b->star.count <= b->corner_capacity)
        return STARG_OK;
    corners =
        starg_reallocate(b->context, b->corners, b->star_count, b->star.capacity, sizeof *corners);
    if (corners == NULL)
        return starg_fail_memory(b->context, "delaunay");
    b->corners = corners;
    b->corner_capacity = b->star.capacity;
    return status;
}

/* Appends the other corners of a cell at a vertex, and adds its neighbours there to the star. */
static starg_status leave_by_faces(builder *b, uint32_t index, uint32_t vertex) {
    const cell *c = &b->cells.data[index];
    uint32_t *out = b->corners[b->star_count];
    bool ghost = false;
    for (int k = 0; k < 4; k++) {
        if (c->vertex[k] == vertex)
            continue;
        *out++ = c->vertex[k];
        ghost = ghost || c->vertex[k] == GHOST;
        cell *next = &b->cells.data[c->neighbour[k]];
        if (next->mark == b->stamp)
            continue;
        next->mark = b->stamp;
        PUSH(b->context, "delaunay", &b->star, c->neighbour[k]);
    }
    b->star_count += !ghost;
    return STARG_OK;
}

/* Collects all cells at a vertex, ghosts included, by walking across the faces at the vertex. */
static starg_status find_star(builder *b, uint32_t vertex) {
    b->star.count = b->star_count = 0;
    b->stamp += 2;
    if (b->incident[vertex] == NOWHERE)
        return STARG_OK;
    b->cells.data[b->incident[vertex]].mark = b->stamp;
    PUSH(b->context, "delaunay", &b->star, b->incident[vertex]);
    for (size_t i = 0; i < b->star.count; i++) {
        TRY(reserve_corners(b));
        TRY(leave_by_faces(b, b->star.data[i], vertex));
    }
    return STARG_OK;
}

starg_status delaunay_star(delaunay_builder *b, uint32_t point_index, uint32_t (**corners)[3],
                           size_t *count) {
    starg_status status = STARG_OK;
    if (b->star_of != point_index) {
        b->star_of = NOWHERE;
        STARG_TRY(find_star(b, point_index));
        b->star_of = point_index;
    }
done:
    *corners = b->corners;
    *count = b->star_of == point_index ? b->star_count : 0;
    return status;
}

starg_status delaunay_finish(delaunay_builder *b, delaunay **out) {
    SCOPED_BY(delaunay_drop) delaunay *result = NULL;
    *out = NULL;
    NEW_ZERO(b->context, "delaunay", result, 1);
    result->context = b->context;
    TRY(collect(b, result));
    *out = result;
    result = NULL;
    return STARG_OK;
}

starg_status delaunay_create(starg_context *context, const double *points, size_t count,
                             delaunay **out) {
    SCOPED_BY(delaunay_builder_drop) delaunay_builder *b = NULL;
    *out = NULL;
    TRY(delaunay_begin(context, points, count, &b));
    return delaunay_finish(b, out);
}

void delaunay_free(delaunay *tetrahedra) {
    if (tetrahedra == NULL)
        return;
    RELEASE(tetrahedra->tetrahedra, tetrahedra->neighbours, tetrahedra);
}
