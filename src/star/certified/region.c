/* SPDX-License-Identifier: Apache-2.0 */
/* Star-shaped parts of a union of pieces, without modifying it.
 *
 * Problem: along a direction n, what is the highest plane {n . x = s} such that the part of a
 * region below it is still strictly star-shaped? The part below is bounded by the plane and by the
 * triangles of the surface that have a vertex below; so its kernel is the set of points inside the
 * plane and inside the planes of these triangles ("rows"). A row is active above the height of its
 * lowest vertex.
 *
 * Method: a cutting-plane loop. A linear program over a few rows finds the centre of the largest
 * ball; of all rows active below the bound on s (initially unbounded), the one that the centre
 * violates most is added. If the program leaves less room than the margin, its tight rows alone
 * allow no more: the highest of them cannot be active, so the bound falls to where it starts, and
 * the row is removed. The plane itself is one of the rows and moves with the bound. At the end the
 * centre is inside all rows that are active below the bound.
 *
 * Invariants: everything is rounded; results are proven later on the cut mesh. Heights never exceed
 * what the tight rows allow, so the answer is the highest s, except for rounding and for sides
 * whose kernel is empty at the highest s only.
 *
 * Cost: linear in the rows for each round of the loop; 5 to 20 rounds as a rule. */
#include "star/certified/partition.h"

#include <math.h>

#include "core/compiler.h"
#include "geometry/linear_program.h"
#include "geometry/vec3.h"

enum { ROUNDS_MOST = 500, ROW = 4 };

void region_scratch_free(region_scratch *scratch) {
    RELEASE(scratch->vertex_of.data, scratch->row_of.data, scratch->piece_of.data,
            scratch->heights.data, scratch->lowest.data, scratch->lowest_back.data);
}

starg_status region_make_scratch(starg_context *context, void *shared, void **out) {
    starg_status status = STARG_OK;
    region_scratch *scratch = NULL;
    (void)shared;
    STARG_NEW_ZERO(context, PARTITION_STAGE, scratch, 1);
    scratch->context = context;
done:
    *out = scratch;
    return status;
}

void region_free_scratch(starg_context *context, void *scratch) {
    if (scratch != NULL)
        region_scratch_free(scratch);
    starg_release(context, scratch);
}

void region_free(region *r) {
    RELEASE(r->vertices.data, r->triangles.data, r->rows.data, r->blocks.data);
    *r = (region){.vertices = {0}};
}

/* ---- gathering ---- */

static starg_status grow_zero(starg_context *context, uint32_t **data, size_t *count,
                              size_t *capacity, size_t needed) {
    if (*capacity < needed) {
        starg_release(context, *data);
        *data = NULL;
        *capacity = *count = 0;
        NEW_ZERO(context, PARTITION_STAGE, *data, needed + needed / 4);
        *capacity = needed + needed / 4;
    }
    *count = needed;
    return STARG_OK;
}

starg_status region_scratch_fit(region_scratch *scratch, const partition *p) {
    TRY(grow_zero(p->context, &scratch->vertex_of.data, &scratch->vertex_of.count,
                  &scratch->vertex_of.capacity, p->points.count / 3));
    TRY(grow_zero(p->context, &scratch->row_of.data, &scratch->row_of.count,
                  &scratch->row_of.capacity, 2 * p->planes.count));
    return grow_zero(p->context, &scratch->piece_of.data, &scratch->piece_of.count,
                     &scratch->piece_of.capacity, p->pieces.count);
}

static starg_status gather_vertex(const partition *p, uint32_t vertex, region_scratch *scratch,
                                  region *out, uint32_t *number) {
    uint32_t *slot = &scratch->vertex_of.data[vertex];
    if (*slot == 0) {
        for (int k = 0; k < 3; k++)
            PUSH(p->context, PARTITION_STAGE, &out->vertices, partition_unit(p, vertex)[k]);
        *slot = (uint32_t)(out->vertices.count / 3);
    }
    *number = *slot - 1;
    return STARG_OK;
}

static starg_status gather_row(const partition *p, uint32_t plane, int side,
                               region_scratch *scratch, region *out, uint32_t *number) {
    uint32_t *slot = &scratch->row_of.data[2 * (size_t)plane + (size_t)side];
    if (*slot == 0) {
        const partition_plane *from = &p->planes.data[plane];
        double sign = side == FACET_INNER ? 1 : -1;
        for (int k = 0; k < 3; k++)
            PUSH(p->context, PARTITION_STAGE, &out->rows, sign * from->normal[k]);
        PUSH(p->context, PARTITION_STAGE, &out->rows, sign * from->offset);
        *slot = (uint32_t)(out->rows.count / ROW);
    }
    *number = *slot - 1;
    return STARG_OK;
}

static starg_status gather_facet(const partition *p, uint32_t entry, region_scratch *scratch,
                                 region *out) {
    const facet *f = &p->facets.data[entry / 2];
    region_triangle fresh;
    uint32_t corners[3];
    facet_outward(f, (int)(entry % 2), corners);
    for (int k = 0; k < 3; k++)
        TRY(gather_vertex(p, corners[k], scratch, out, &fresh.corners[k]));
    TRY(gather_row(p, f->plane, (int)(entry % 2), scratch, out, &fresh.row));
    PUSH(p->context, PARTITION_STAGE, &out->triangles, fresh);
    return STARG_OK;
}

/* The stride between the visited facets of a piece. */
static uint32_t stride_of(const partition *p, uint32_t number, uint32_t most) {
    uint32_t facets = p->start.data[number + 1] - p->start.data[number];
    return facets > most ? facets / most : 1;
}

/* The tables are all zero between calls. */
static void forget(const partition *p, const uint32_t *pieces, size_t count, uint32_t most,
                   region_scratch *scratch) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = p->start.data[pieces[i]]; k < p->start.data[pieces[i] + 1];
             k += stride_of(p, pieces[i], most)) {
            const facet *f = &p->facets.data[p->index.data[k] / 2];
            for (int c = 0; c < 3; c++)
                scratch->vertex_of.data[f->corners[c]] = 0;
            scratch->row_of.data[2 * (size_t)f->plane] = 0;
            scratch->row_of.data[2 * (size_t)f->plane + 1] = 0;
        }
}

/* The last block is padded with rows that nothing violates. */
starg_status region_make_blocks(starg_context *context, region *r) {
    size_t rows = r->rows.count / ROW, blocks = (rows + SCAN_BLOCK - 1) / SCAN_BLOCK;
    r->blocks.count = 0;
    for (size_t i = 0; i < blocks * SCAN_SIZE; i++)
        PUSH(context, PARTITION_STAGE, &r->blocks, i % SCAN_SIZE < 3 * SCAN_BLOCK ? 0 : 16);
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < ROW; k++)
            r->blocks.data[i / SCAN_BLOCK * SCAN_SIZE + k * SCAN_BLOCK + i % SCAN_BLOCK] =
                r->rows.data[ROW * i + k];
    return STARG_OK;
}

starg_status region_gather_some(const partition *p, const uint32_t *pieces, size_t count,
                                uint32_t most, region_scratch *scratch, region *out) {
    out->vertices.count = out->triangles.count = out->rows.count = 0;
    TRY(region_scratch_fit(scratch, p));
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = p->start.data[pieces[i]]; k < p->start.data[pieces[i] + 1];
             k += stride_of(p, pieces[i], most)) {
            uint32_t entry = p->index.data[k];
            if (!partition_lists(pieces, count, p->facets.data[entry / 2].side[1 - entry % 2]))
                TRY(gather_facet(p, entry, scratch, out));
            if (i == 0)
                out->first_rows = out->rows.count / ROW;
        }
    scratch->work += 4 * out->triangles.count;
    forget(p, pieces, count, most, scratch);
    return region_make_blocks(p->context, out);
}

starg_status region_gather(const partition *p, const uint32_t *pieces, size_t count,
                           region_scratch *scratch, region *out) {
    return region_gather_some(p, pieces, count, UINT32_MAX, scratch, out);
}

double region_diagonal(const region *r) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < r->vertices.count; i++) {
        lower[i % 3] = fmin(lower[i % 3], r->vertices.data[i]);
        upper[i % 3] = fmax(upper[i % 3], r->vertices.data[i]);
    }
    return vec3_distance(lower, upper);
}

/* ---- clipping ---- */

typedef struct clipper {
    starg_context *context;
    const region *from;
    region *out;
    const double *normal;
    double height;
    uint32_t cap;
} clipper;

static double above(const clipper *c, uint32_t vertex) {
    return vec3_dot(c->normal, c->from->vertices.data + 3 * (size_t)vertex) - c->height;
}

/* A polygon of up to four corners: the part of a triangle above the plane. */
typedef struct clipped {
    double corners[4][3];
    bool cut[4]; /* on the plane */
    int count;
} clipped;

static void clip_triangle(const clipper *c, const region_triangle *t, clipped *out) {
    out->count = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t a = t->corners[k], b = t->corners[(k + 1) % 3];
        const double *p = c->from->vertices.data + 3 * (size_t)a;
        const double *q = c->from->vertices.data + 3 * (size_t)b;
        double ha = above(c, a), hb = above(c, b);
        if (ha > 0) {
            out->cut[out->count] = false;
            vec3_copy(p, out->corners[out->count++]);
        }
        if ((ha > 0) == (hb > 0))
            continue;
        double d[3];
        vec3_subtract(q, p, d);
        out->cut[out->count] = true;
        vec3_along(p, ha / (ha - hb), d, out->corners[out->count++]);
    }
}

static starg_status add_vertex(const clipper *c, const double at[3], uint32_t *number) {
    *number = (uint32_t)(c->out->vertices.count / 3);
    for (int k = 0; k < 3; k++)
        PUSH(c->context, PARTITION_STAGE, &c->out->vertices, at[k]);
    return STARG_OK;
}

static starg_status add_clipped(const clipper *c, const clipped *polygon, uint32_t row) {
    uint32_t number[4], on_plane[2] = {0, 0};
    int cuts = 0;
    for (int k = 0; k < polygon->count; k++) {
        TRY(add_vertex(c, polygon->corners[k], &number[k]));
        if (polygon->cut[k] && cuts < 2)
            on_plane[cuts++] = number[k];
    }
    for (int k = 2; k < polygon->count; k++) {
        const region_triangle t = {{number[0], number[k - 1], number[k]}, row};
        PUSH(c->context, PARTITION_STAGE, &c->out->triangles, t);
    }
    if (cuts == 2) {
        const region_triangle segment = {{on_plane[0], on_plane[1], on_plane[1]}, c->cap};
        PUSH(c->context, PARTITION_STAGE, &c->out->triangles, segment);
    }
    return STARG_OK;
}

double region_volume_above(const region *part, const double normal[3], double height) {
    double sum = 0, origin[3];
    for (int k = 0; k < 3; k++)
        origin[k] = height * normal[k];
    for (size_t i = 0; i < part->triangles.count; i++) {
        double corner[3][3];
        for (int k = 0; k < 3; k++)
            vec3_subtract(part->vertices.data + 3 * (size_t)part->triangles.data[i].corners[k],
                          origin, corner[k]);
        sum += vec3_triple(corner[0], corner[1], corner[2]);
    }
    return sum / 6;
}

starg_status region_clip(starg_context *context, const region *from, const double normal[3],
                         double height, region *out) {
    clipper c = {.context = context,
                 .from = from,
                 .out = out,
                 .normal = normal,
                 .height = height,
                 .cap = (uint32_t)(from->rows.count / ROW)};
    out->vertices.count = out->triangles.count = out->rows.count = 0;
    for (size_t i = 0; i < from->rows.count; i++)
        PUSH(context, PARTITION_STAGE, &out->rows, from->rows.data[i]);
    for (int k = 0; k < 3; k++)
        PUSH(context, PARTITION_STAGE, &out->rows, -normal[k]);
    PUSH(context, PARTITION_STAGE, &out->rows, -height);
    for (size_t i = 0; i < from->triangles.count; i++) {
        clipped polygon;
        clip_triangle(&c, &from->triangles.data[i], &polygon);
        TRY(add_clipped(&c, &polygon, from->triangles.data[i].row));
    }
    return region_make_blocks(context, out);
}

/* ---- rows along a direction ---- */

/* `count` values, each infinite. */
static starg_status reset(starg_context *context, region_values *out, size_t count) {
    if (out->capacity < count) {
        starg_release(context, out->data);
        *out = (region_values){.capacity = 0};
        NEW(context, PARTITION_STAGE, out->data, 2 * count);
        out->capacity = 2 * count;
    }
    for (size_t i = 0; i < count; i++)
        out->data[i] = INFINITY;
    out->count = count;
    return STARG_OK;
}

static starg_status find_heights(const region *r, const double normal[3], region_scratch *scratch) {
    size_t vertices = r->vertices.count / 3, padded = r->blocks.count / 4;
    scratch->work += vertices + r->triangles.count;
    TRY(reset(scratch->context, &scratch->heights, vertices));
    TRY(reset(scratch->context, &scratch->lowest, padded));
    TRY(reset(scratch->context, &scratch->lowest_back, padded));
    double *height = scratch->heights.data;
    for (size_t i = 0; i < vertices; i++)
        height[i] = vec3_dot(normal, r->vertices.data + 3 * i);
    for (size_t i = 0; i < r->triangles.count; i++) {
        const region_triangle *t = &r->triangles.data[i];
        double a = height[t->corners[0]], b = height[t->corners[1]], c = height[t->corners[2]];
        double low = a < b ? a : b, high = a < b ? b : a;
        double *lowest = &scratch->lowest.data[t->row], *back = &scratch->lowest_back.data[t->row];
        low = low < c ? low : c;
        high = high < c ? c : high;
        *lowest = low < *lowest ? low : *lowest;
        *back = -high < *back ? -high : *back;
    }
    return STARG_OK;
}

/* ---- the worst of many rows ---- */

enum { LANES = 8 };

/* The loop that the search for cuts spends its time in: written so that compilers make vector code
 * of it (core/compiler.h). */
STARG_SEVERAL_VERSIONS
static size_t scan(const double *block, const double *lowest, double bound, const double point[3],
                   double room) {
    const double *nx = block, *ny = nx + SCAN_BLOCK, *nz = ny + SCAN_BLOCK, *b = nz + SCAN_BLOCK;
    const double x = point[0], y = point[1], z = point[2];
    double inside[SCAN_BLOCK], least[LANES];
    for (int i = 0; i < SCAN_BLOCK; i++)
        inside[i] = b[i] - (nx[i] * x + ny[i] * y + nz[i] * z);
    for (int i = 0; i < SCAN_BLOCK; i++)
        inside[i] = lowest[i] < bound ? inside[i] : INFINITY;
    for (int k = 0; k < LANES; k++)
        least[k] = inside[k];
    for (int i = LANES; i < SCAN_BLOCK; i += LANES)
        for (int k = 0; k < LANES; k++)
            least[k] = inside[i + k] < least[k] ? inside[i + k] : least[k];
    double worst = least[0];
    for (int k = 1; k < LANES; k++)
        worst = least[k] < worst ? least[k] : worst;
    if (!(worst < room))
        return SCAN_BLOCK;
    size_t at = 0;
    while (inside[at] != worst)
        at++;
    return at;
}

size_t scan_block(const double *block, const double *lowest, double bound, const double point[3],
                  double room) {
    return scan(block, lowest, bound, point, room);
}

/* ---- the loop ---- */

static const uint32_t THE_PLANE = UINT32_MAX - 1;

/* The search for a ball among the rows that are active below the bound. */
typedef struct ball_search {
    const region *r;
    const double *normal; /* of the plane; NULL: none */
    const double *lowest; /* of rows along it */
    double bound;
    largest_ball ball;
    size_t at; /* first entry of the block of the last violated row */
    uint64_t *work;
} ball_search;

/* A row whose plane is closer to the ball's centre than `room`, or violated: the worst of the first
 * block that has one, starting from the last one found. False if there is none. */
static bool find_violated(ball_search *w, double room, uint32_t *worst) {
    size_t blocks = w->r->blocks.count / SCAN_SIZE;
    for (size_t seen = 0; seen < blocks; seen++) {
        size_t found = scan_block(w->r->blocks.data + SCAN_SIZE * w->at,
                                  w->lowest + SCAN_BLOCK * w->at, w->bound, w->ball.center, room);
        *w->work += SCAN_BLOCK;
        if (found < SCAN_BLOCK) {
            *worst = (uint32_t)(SCAN_BLOCK * w->at + found);
            return true;
        }
        w->at = w->at + 1 < blocks ? w->at + 1 : 0;
    }
    return false;
}

static bool plane_is_violated(const ball_search *w, double room) {
    return w->normal != NULL && w->bound < INFINITY &&
           w->bound - vec3_dot(w->normal, w->ball.center) < room;
}

/* Adds the row that the ball violates by `room`: 1 if there was one, 0 if not, -1 on failure. */
static int add_violated(ball_search *w, double room) {
    if (plane_is_violated(w, room))
        return largest_ball_add(&w->ball, w->normal, w->bound, THE_PLANE) ? 1 : -1;
    uint32_t worst = 0;
    if (!find_violated(w, room, &worst))
        return 0;
    const double *row = w->r->rows.data + ROW * (size_t)worst;
    return largest_ball_add(&w->ball, row, row[3], worst) ? 1 : -1;
}

/* The start of the highest row that confines the ball. */
static double highest_tight(const ball_search *w) {
    double highest = -INFINITY;
    for (int k = 0; k < 4; k++)
        if (w->ball.names[k] < THE_PLANE && w->ball.weights[k] > 1e-12)
            highest = fmax(highest, w->lowest[w->ball.names[k]]);
    return highest;
}

/* Removes rows that are no longer active, and moves the plane to the bound. */
static void lower_bound_to(ball_search *w, double bound) {
    w->bound = bound;
    for (int k = 0; k < 4; k++) {
        uint32_t name = w->ball.names[k];
        if (name == THE_PLANE)
            largest_ball_move(&w->ball, k, bound, THE_PLANE);
        else if (name != LARGEST_BALL_FAR && w->lowest[name] >= bound)
            largest_ball_move(&w->ball, k, LARGEST_BALL_DISTANCE, LARGEST_BALL_FAR);
    }
}

static void find_reach(ball_search *w, double margin, region_reach *out) {
    *out = (region_reach){.height = -INFINITY};
    largest_ball_start(&w->ball);
    for (int round = 0; round < ROUNDS_MOST; round++) {
        if (w->ball.radius < margin) {
            double bound = highest_tight(w);
            if (bound == -INFINITY)
                return;
            lower_bound_to(w, bound);
            continue;
        }
        int added = add_violated(w, 0.5 * margin); /* the ball itself is rounded */
        if (added < 0)
            return;
        if (added == 0) {
            out->height = w->bound;
            vec3_copy(w->ball.center, out->guard);
            return;
        }
    }
}

starg_status region_find_reach(const region *r, const double normal[3], double margin,
                               region_scratch *scratch, region_reach *up, region_reach *down) {
    double back[3] = {-normal[0], -normal[1], -normal[2]};
    TRY(find_heights(r, normal, scratch));
    ball_search w = {.r = r,
                     .work = &scratch->work,
                     .normal = normal,
                     .lowest = scratch->lowest.data,
                     .bound = INFINITY};
    find_reach(&w, margin, up);
    if (down == NULL || up->height == -INFINITY)
        return STARG_OK;
    w = (ball_search){.r = r,
                      .work = &scratch->work,
                      .normal = back,
                      .lowest = scratch->lowest_back.data,
                      .bound = INFINITY};
    find_reach(&w, margin, down);
    return STARG_OK;
}

/* Distances of vertices from a point, in place of heights. */
static starg_status find_distances(const region *r, const double center[3],
                                   region_scratch *scratch) {
    size_t vertices = r->vertices.count / 3, padded = r->blocks.count / 4;
    scratch->work += vertices + r->triangles.count;
    TRY(reset(scratch->context, &scratch->heights, vertices));
    TRY(reset(scratch->context, &scratch->lowest, padded));
    double *distance = scratch->heights.data;
    for (size_t i = 0; i < vertices; i++)
        distance[i] = vec3_distance_squared(center, r->vertices.data + 3 * i);
    for (size_t i = 0; i < r->triangles.count; i++) {
        const region_triangle *t = &r->triangles.data[i];
        double *lowest = &scratch->lowest.data[t->row];
        for (int k = 0; k < 3; k++)
            if (distance[t->corners[k]] < *lowest)
                *lowest = distance[t->corners[k]];
    }
    return STARG_OK;
}

/* By the distances found, with some set to -INFINITY. */
static void find_reach_near(const region *r, double margin, region_scratch *scratch,
                            region_reach *out) {
    ball_search w = {
        .r = r, .work = &scratch->work, .lowest = scratch->lowest.data, .bound = INFINITY};
    find_reach(&w, margin, out);
}

starg_status region_find_reach_about(const region *r, const double center[3], double margin,
                                     region_scratch *scratch, region_reach *out) {
    TRY(find_distances(r, center, scratch));
    find_reach_near(r, margin, scratch, out);
    return STARG_OK;
}

starg_status region_find_reach_beyond(const region *r, const double center[3], double margin,
                                      region_scratch *scratch, region_reach *out) {
    TRY(find_distances(r, center, scratch));
    for (size_t i = 0; i < r->first_rows; i++)
        scratch->lowest.data[i] = -INFINITY;
    find_reach_near(r, margin, scratch, out);
    return STARG_OK;
}

starg_status region_find_reach_for(const region *r, const double center[3], const double other[3],
                                   double margin, region_scratch *scratch, region_reach *out) {
    TRY(find_distances(r, center, scratch));
    for (size_t i = 0; i < r->rows.count / ROW; i++) {
        const double *row = r->rows.data + ROW * i;
        if (row[3] - vec3_dot(row, other) < margin)
            scratch->lowest.data[i] = -INFINITY;
    }
    find_reach_near(r, margin, scratch, out);
    return STARG_OK;
}

starg_status region_find_center(const region *r, const double *normal, double height,
                                region_scratch *scratch, double center[3], double *radius) {
    static const double anywhere[3] = {0, 0, 0};
    *radius = -1;
    TRY(find_heights(r, normal == NULL ? anywhere : normal, scratch));
    ball_search w = {.r = r,
                     .work = &scratch->work,
                     .normal = normal,
                     .lowest = scratch->lowest.data,
                     .bound = normal == NULL ? INFINITY : height};
    largest_ball_start(&w.ball);
    for (int round = 0; round < 4 * ROUNDS_MOST && w.ball.radius > 0; round++) {
        int added = add_violated(&w, w.ball.radius - 1e-9);
        if (added < 0)
            return STARG_OK;
        if (added == 0) {
            vec3_copy(w.ball.center, center);
            *radius = w.ball.radius - 1e-9;
            return STARG_OK;
        }
    }
    return STARG_OK;
}
