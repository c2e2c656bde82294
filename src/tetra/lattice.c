/* SPDX-License-Identifier: Apache-2.0 */
/* Lattice of isosurface stuffing [LS07]: inside points, cuts, and the warp.
 *
 * A point is inside if its winding number is at least one, as for all solids, or above 1/2 for open
 * surfaces (generalized winding number). The former is exact; all points of a column share the
 * triangles that meet the vertical line through them. A cut is the first place on an edge, from its
 * inside end, where the winding number falls to zero; a rounded position is enough.
 *
 * Warp: a point with a cut closer than a fraction of the edge's length moves there, and all cuts of
 * its edges disappear. The remaining cuts are far enough from both ends that no tetrahedron made of
 * them is flat: the fractions of [LS07] bound the dihedral angles by 10.78 and 164.74 degrees.
 *
 * Invariants: points at the border of the lattice are outside; an edge between an inside and an
 * outside point has a live cut. Cost: O(points) for the inside test, O(surface / spacing^2) for the
 * rest. */
#include "tetra/generate.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "geometry/intersect.h"
#include "geometry/vec3.h"

static const char STAGE[] = TETRA_STAGE;

static const double WARP_LONG = 0.24999, WARP_SHORT = 0.41189;

enum { MARGIN = 2, MOST_WINDING = 100 }; /* cubes around the solid */

/* To the neighbours; the first LATTICE_OWNED lead along edges that a point owns, the others are
 * their opposites in the same order. Steps 0 to 2 of each half are long. */
static const int LATTICE_STEP[LATTICE_EDGES][3] = {
    {2, 0, 0},  {0, 2, 0},  {0, 0, 2},  {1, 1, 1},    {-1, 1, 1},  {1, -1, 1},  {-1, -1, 1},
    {-2, 0, 0}, {0, -2, 0}, {0, 0, -2}, {-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}};

static bool is_long(int step) {
    return step % LATTICE_OWNED < 3;
}

static lattice_point point_step(const lattice_point *p, int step) {
    lattice_point q = *p;
    for (int k = 0; k < 3; k++)
        q.x[k] += LATTICE_STEP[step][k];
    return q;
}

void lattice_position(const lattice *l, const lattice_point *p, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = l->origin[k] + l->half * (double)p->x[k];
}

/* Corners are numbered along z first, so that a column is a range; so are centres. */
size_t lattice_number(const lattice *l, const lattice_point *p) {
    int odd = (int)(p->x[0] & 1);
    size_t number = 0;
    for (int k = 0; k < 3; k++) {
        int64_t size = l->cubes[k] + !odd, at = (p->x[k] - odd) / 2;
        if (p->x[k] < odd || at >= size)
            return SIZE_MAX;
        number = number * (size_t)size + (size_t)at;
    }
    return odd ? l->corners + number : number;
}

/* ---- extent ---- */

static double count_points(const double extent[3], double spacing) {
    double corners = 1;
    for (int k = 0; k < 3; k++)
        corners *= ceil(extent[k] / spacing) + 2 * MARGIN + 1;
    return 2 * corners;
}

static void shape_extent(const tetra_shape *shape, double lower[3], double extent[3]) {
    double upper[3];
    starg_mesh_bounds(shape->mesh, lower, upper);
    vec3_subtract(upper, lower, extent);
}

double lattice_spacing(const tetra_shape *shape, double spacing) {
    double lower[3], extent[3];
    shape_extent(shape, lower, extent);
    while (count_points(extent, spacing) > (double)LATTICE_LIMIT)
        spacing *= 1.25;
    return spacing;
}

/* ---- insides ---- */

typedef struct column {
    starg_context *context;
    const bvh *tree;
    STARG_ARRAY(uint32_t) triangles;
    starg_status status;
} column;

static starg_status make_column(starg_context *context, void *shared, void **scratch) {
    const lattice *l = shared;
    column *c = NULL;
    NEW_ZERO(context, STAGE, c, 1);
    c->context = context;
    c->tree = l->shape->tree;
    *scratch = c;
    return STARG_OK;
}

static void free_column(starg_context *context, void *scratch) {
    (void)context;
    column *c = scratch;
    RELEASE(c->triangles.data, c);
}

/* Runs on any thread, so it records no error detail. */
static bool add_triangle(void *user, uint32_t triangle) {
    column *c = user;
    if (c->triangles.count == c->triangles.capacity) {
        size_t capacity = c->triangles.capacity ? 2 * c->triangles.capacity : 64;
        void *data = starg_reallocate(c->context, c->triangles.data, c->triangles.count, capacity,
                                      sizeof *c->triangles.data);
        if (data == NULL) {
            c->status = STARG_ERROR_MEMORY;
            return false;
        }
        c->triangles.data = data;
        c->triangles.capacity = capacity;
    }
    c->triangles.data[c->triangles.count++] = triangle;
    return true;
}

/* The first point of a column, and how many there are. */
static size_t column_start(const lattice *l, size_t item, lattice_point *first) {
    size_t corner_columns = (size_t)(l->cubes[0] + 1) * (size_t)(l->cubes[1] + 1);
    int64_t odd = item >= corner_columns;
    int64_t rows = l->cubes[1] + !odd, index = (int64_t)(odd ? item - corner_columns : item);
    *first = (lattice_point){{2 * (index / rows) + odd, 2 * (index % rows) + odd, odd}};
    return (size_t)(l->cubes[2] + !odd);
}

/* For an open mesh: is the generalized winding number above 1/2? */
static bool winds_around(const lattice *l, const double x[3]) {
    double sense = l->shape->volume < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x[k] < l->lower[k] || x[k] > l->upper[k])
            return false;
    return sense * winding_number(l->shape->field, x) > 0.5;
}

static starg_status classify_open_column(lattice *l, lattice_point p, size_t number, size_t count) {
    for (size_t i = 0; i < count; i++, p.x[2] += 2) {
        double x[3];
        lattice_position(l, &p, x);
        l->winding[number + i] = winds_around(l, x);
    }
    return STARG_OK;
}

static starg_status classify_column(starg_context *context, void *shared, void *scratch,
                                    size_t item) {
    lattice *l = shared;
    column *c = scratch;
    lattice_point p;
    double x[3];
    (void)context;
    size_t count = column_start(l, item, &p), number = lattice_number(l, &p);
    if (l->shape->field != NULL)
        return classify_open_column(l, p, number, count);
    lattice_position(l, &p, x);
    const bvh_box line = {{x[0], x[1], -INFINITY}, {x[0], x[1], INFINITY}};
    c->triangles.count = 0;
    c->status = STARG_OK;
    if (!bvh_query_box(c->tree, &line, add_triangle, c))
        return c->status;
    for (size_t i = 0; i < count && c->triangles.count > 0; i++, p.x[2] += 2) {
        int winding = 0;
        lattice_position(l, &p, x);
        for (size_t t = 0; t < c->triangles.count; t++)
            winding += bvh_crossing(c->tree, c->triangles.data[t], x);
        winding = winding > MOST_WINDING ? MOST_WINDING : winding;
        l->winding[number + i] = (int16_t)(winding < -MOST_WINDING ? -MOST_WINDING : winding);
    }
    return STARG_OK;
}

static starg_status find_insides(lattice *l) {
    size_t columns = (size_t)(l->cubes[0] + 1) * (size_t)(l->cubes[1] + 1) +
                     (size_t)l->cubes[0] * (size_t)l->cubes[1];
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = columns,
                                .shared = l,
                                .item = classify_column,
                                .make_scratch = make_column,
                                .free_scratch = free_column};
    TRY(starg_parallel_for(l->context, &loop));
    for (size_t i = 0; i < l->points; i++) {
        l->side[i] = l->winding[i] > 0 ? LATTICE_INSIDE : LATTICE_OUTSIDE;
        l->inside += l->winding[i] > 0;
    }
    return STARG_OK;
}

starg_status lattice_create(starg_context *context, const tetra_shape *shape, double spacing,
                            lattice *out) {
    double lower[3], extent[3];
    *out = (lattice){.context = context, .shape = shape, .half = 0.5 * spacing};
    shape_extent(shape, lower, extent);
    starg_mesh_bounds(shape->mesh, out->lower, out->upper);
    for (int k = 0; k < 3; k++) {
        out->cubes[k] = (int64_t)ceil(extent[k] / spacing) + 2 * MARGIN;
        out->origin[k] = lower[k] - 0.5 * ((double)out->cubes[k] * spacing - extent[k]);
    }
    out->corners =
        (size_t)(out->cubes[0] + 1) * (size_t)(out->cubes[1] + 1) * (size_t)(out->cubes[2] + 1);
    out->points =
        out->corners + (size_t)out->cubes[0] * (size_t)out->cubes[1] * (size_t)out->cubes[2];
    NEW_ZERO(context, STAGE, out->winding, out->points);
    NEW(context, STAGE, out->side, out->points);
    NEW(context, STAGE, out->node, out->points);
    memset(out->node, 0xff, out->points * sizeof *out->node);
    return find_insides(out);
}

void lattice_free(lattice *l) {
    RELEASE(l->winding, l->side, l->node, l->nodes.data);
    *l = (lattice){.context = l->context};
}

/* ---- cuts ---- */

/* Crossings of triangles with a segment from its inside end. */
typedef struct crossing {
    double t;
    int change; /* of the winding number */
} crossing;

enum { MOST_CROSSINGS = 64, HALVINGS = 24 };

typedef struct segment {
    const bvh *tree;
    double p[3], q[3];
    crossing crossings[MOST_CROSSINGS]; /* sorted by t; if there are more, those nearest to p */
    size_t count;
} segment;

static void insert_crossing(segment *s, crossing c) {
    size_t i = s->count;
    if (i == MOST_CROSSINGS && s->crossings[--i].t <= c.t)
        return;
    for (; i > 0 && s->crossings[i - 1].t > c.t; i--)
        s->crossings[i] = s->crossings[i - 1];
    s->crossings[i] = c;
    s->count += s->count < MOST_CROSSINGS;
}

static bool look_at_triangle(void *user, size_t rank) {
    segment *s = user;
    const uint32_t *face = s->tree->faces + 3 * (size_t)s->tree->order[rank];
    const double *a = s->tree->vertices + 3 * (size_t)face[0];
    const double *b = s->tree->vertices + 3 * (size_t)face[1];
    const double *c = s->tree->vertices + 3 * (size_t)face[2];
    double n[3], ap[3], d[3];
    if (!segment_meets_triangle(s->p, s->q, a, b, c))
        return true;
    vec3_triangle_normal(a, b, c, n);
    vec3_subtract(a, s->p, ap);
    vec3_subtract(s->q, s->p, d);
    double slope = vec3_dot(n, d), t = vec3_dot(n, ap) / slope;
    if (slope != 0 && isfinite(t))
        insert_crossing(s, (crossing){fmin(1, fmax(0, t)), slope > 0 ? -1 : 1});
    return true;
}

/* Where an edge leaves an open mesh through a hole, by bisection. */
static double find_gap(const lattice *l, const segment *s) {
    double inside = 0, outside = 1;
    for (int round = 0; round < HALVINGS; round++) {
        double d[3], x[3], t = 0.5 * (inside + outside);
        vec3_subtract(s->q, s->p, d);
        vec3_along(s->p, t, d, x);
        if (winds_around(l, x))
            inside = t;
        else
            outside = t;
    }
    return 0.5 * (inside + outside);
}

/* The first place on the way from the inside point p to q where the segment leaves the solid; the
 * midpoint if rounding hides it. */
static double find_cut(const lattice *l, size_t inside, const lattice_point *p,
                       const lattice_point *q) {
    segment s = {.tree = l->shape->tree};
    lattice_position(l, p, s.p);
    lattice_position(l, q, s.q);
    bvh_query_segment(s.tree, s.p, s.q, look_at_triangle, &s);
    int winding = l->winding[inside];
    for (size_t i = 0; i < s.count; i++) {
        winding += s.crossings[i].change;
        if (winding <= 0)
            return s.crossings[i].t;
    }
    if (s.count == 0 && l->shape->field != NULL)
        return find_gap(l, &s);
    return s.count > 0 ? s.crossings[s.count - 1].t : 0.5;
}

/* The node of a point, created on first use. */
static starg_status add_node(lattice *l, const lattice_point *p, size_t number, uint32_t *out) {
    if (l->node[number] == UINT32_MAX) {
        lattice_node fresh = {.point = *p};
        lattice_position(l, p, fresh.position);
        for (int i = 0; i < LATTICE_OWNED; i++)
            fresh.cuts[i].vertex = UINT32_MAX;
        l->node[number] = (uint32_t)l->nodes.count;
        PUSH(l->context, STAGE, &l->nodes, fresh);
    }
    *out = l->node[number];
    return STARG_OK;
}

static starg_status cut_edge(lattice *l, const lattice_point *p, size_t number, int step) {
    lattice_point q = point_step(p, step);
    size_t other = lattice_number(l, &q);
    uint32_t owner, end;
    if (other == SIZE_MAX || l->side[other] == l->side[number])
        return STARG_OK;
    TRY(add_node(l, p, number, &owner));
    TRY(add_node(l, &q, other, &end));
    bool inside = l->side[number] == LATTICE_INSIDE;
    double t = inside ? find_cut(l, number, p, &q) : 1 - find_cut(l, other, &q, p);
    const double *a = l->nodes.data[owner].position, *b = l->nodes.data[end].position;
    lattice_cut *cut = &l->nodes.data[owner].cuts[step];
    cut->alive = true;
    for (int k = 0; k < 3; k++)
        cut->position[k] = a[k] + t * (b[k] - a[k]);
    return STARG_OK;
}

static starg_status cut_column(lattice *l, size_t item) {
    lattice_point p;
    size_t count = column_start(l, item, &p), number = lattice_number(l, &p);
    for (size_t i = 0; i < count; i++, p.x[2] += 2)
        for (int step = 0; step < LATTICE_OWNED; step++)
            TRY(cut_edge(l, &p, number + i, step));
    return starg_check_cancel(l->context, STAGE);
}

starg_status lattice_cut_edges(lattice *l) {
    size_t columns = (size_t)(l->cubes[0] + 1) * (size_t)(l->cubes[1] + 1) +
                     (size_t)l->cubes[0] * (size_t)l->cubes[1];
    for (size_t item = 0; item < columns; item++)
        TRY(cut_column(l, item));
    return STARG_OK;
}

/* ---- warp ---- */

/* The live cut at a step from a node, or NULL. */
static lattice_cut *cut_at(const lattice *l, const lattice_node *n, int step) {
    const lattice_node *owner = n;
    if (step >= LATTICE_OWNED) {
        lattice_point q = point_step(&n->point, step);
        size_t number = lattice_number(l, &q);
        if (number == SIZE_MAX || l->node[number] == UINT32_MAX)
            return NULL;
        owner = &l->nodes.data[l->node[number]];
    }
    return &l->nodes.data[owner - l->nodes.data].cuts[step % LATTICE_OWNED];
}

/* The step to the closest cut that is too close; -1 if there is none. Distances are relative to the
 * limit of each edge. */
static int nearest_violation(const lattice *l, const lattice_node *n) {
    double best = 1;
    int found = -1;
    for (int step = 0; step < LATTICE_EDGES; step++) {
        const lattice_cut *cut = cut_at(l, n, step);
        if (cut == NULL || !cut->alive)
            continue;
        double length = is_long(step) ? 2 * l->half : sqrt(3) * l->half;
        double limit = (is_long(step) ? WARP_LONG : WARP_SHORT) * length;
        double share = vec3_distance(cut->position, n->position) / limit;
        if (share < best) {
            best = share;
            found = step;
        }
    }
    return found;
}

void lattice_warp(lattice *l) {
    for (size_t i = 0; i < l->nodes.count; i++) {
        lattice_node *n = &l->nodes.data[i];
        int step = nearest_violation(l, n);
        if (step < 0)
            continue;
        vec3_copy(cut_at(l, n, step)->position, n->position);
        l->side[lattice_number(l, &n->point)] = LATTICE_ON;
        for (int other = 0; other < LATTICE_EDGES; other++) {
            lattice_cut *cut = cut_at(l, n, other);
            if (cut != NULL)
                cut->alive = false;
        }
    }
}

lattice_cut *lattice_cut_between(const lattice *l, const lattice_point *p, const lattice_point *q) {
    size_t number = lattice_number(l, p);
    if (l->node[number] == UINT32_MAX)
        return NULL;
    for (int step = 0; step < LATTICE_EDGES; step++) {
        lattice_point r = point_step(p, step);
        if (r.x[0] == q->x[0] && r.x[1] == q->x[1] && r.x[2] == q->x[2])
            return cut_at(l, &l->nodes.data[l->node[number]], step);
    }
    return NULL;
}
