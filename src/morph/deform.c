/* SPDX-License-Identifier: Apache-2.0 */
/* Mesh deformation: tetrahedra of A that follow a morph to B.
 *
 * Problem: A's surface moves to B's along a given path; find positions of the interior vertices
 * such that every tetrahedron is positive at the end. The tetrahedra then fill B, because their
 * boundary is its surface.
 *
 * Stages of a time step: the surface moves; interior vertices are displaced by the discrete
 * harmonic extension of the surface's displacement (one sparse factor for all steps); then the
 * vertices of inverted or thin tetrahedra are moved one by one to the point farthest from the
 * planes of the surrounding faces, a linear program [Freitag, Plassmann 2000], until none is
 * inverted. If some stay inverted, the step is halved; short steps may also move all vertices
 * together (unfold.c); below a minimal step the deformation fails. On a path a step must in
 * addition keep every tetrahedron positive at every moment (stays_positive).
 *
 * Before the first step (deform_free_surface), interior edges with both ends on the surface are
 * split (split.c), because they leave no freedom where the surface bends, and so are tetrahedra
 * that have all corners on it. This has always sufficed if the surface did not intersect itself on
 * the way.
 *
 * Invariant: after each step all tetrahedra are positive, exactly. Cost: per step one frame, three
 * solves and some sweeps over the tetrahedra. */
#include "morph/solid_map.h"

#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "morph/morph.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "deform tetrahedra";

enum {
    SWEEPS = 40,  /* per step, over affected vertices */
    PATIENCE = 4, /* sweeps without fewer inverted tetrahedra */
    UNFOLD_STEPS = 800,
    ROW = 5 /* of a linear program: normal, factor of room, offset */
};
static const double LONGEST_STEP = 0x1p-3, SHORTEST_STEP = 0x1p-8;
static const double LONGEST_PROVEN = 0x1p-5; /* on a path */
static const double SHORT_STEP = 0x1p-6;     /* from here all vertices are moved together */
static const double THIN =
    0.03; /* lower bound of least height over longest edge for tetrahedra left alone */
static const double FAR = 4; /* largest move of a vertex, relative to its neighbourhood */

/* Data of a step. */
typedef struct walk {
    const starg_morph *m;
    deform_mesh *c;
    deform_path *path;       /* or NULL */
    size_t inner;            /* vertices after the fixed ones */
    uint32_t *first, *about; /* tetrahedra at inner vertex i: about[first[i]] and on */
    sparse_factors *system;
    double *frame;   /* the morph's */
    double *next;    /* x 3 per vertex: positions after the step */
    double *sides;   /* inner + inner: a right-hand side and work space */
    uint8_t *marked; /* per inner vertex */
    STARG_ARRAY(double) rows;
    STARG_ARRAY(uint32_t) order;
} walk;

static void walk_free(walk *w) {
    starg_context *context = w->c->context;
    void *const blocks[] = {w->first, w->about,  w->frame,     w->next,
                            w->sides, w->marked, w->rows.data, w->order.data};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(context, blocks[i]);
    sparse_free(w->system);
}

/* ---- tetrahedra ---- */

static size_t tetrahedron_count(const deform_mesh *c) {
    return c->tetrahedra.count / 4;
}

static const double *corner_of(const deform_mesh *c, const double *places, size_t t, int k) {
    return places + 3 * (size_t)c->tetrahedra.data[4 * t + (size_t)k];
}

static bool is_positive(const deform_mesh *c, const double *places, size_t t) {
    return orient3d(corner_of(c, places, t, 0), corner_of(c, places, t, 1),
                    corner_of(c, places, t, 2), corner_of(c, places, t, 3)) < 0;
}

/* Is the least height of a positive tetrahedron over its longest edge small? */
static bool is_thin(const deform_mesh *c, const double *places, size_t t) {
    double longest = 0, widest = 0, e[3][3];
    for (int i = 0; i < 6; i++)
        longest = fmax(longest, vec3_distance_squared(corner_of(c, places, t, DEFORM_EDGES[i][0]),
                                                      corner_of(c, places, t, DEFORM_EDGES[i][1])));
    for (int k = 0; k < 4; k++)
        widest = fmax(widest, vec3_triangle_area(corner_of(c, places, t, TETMESH_FACE[k][0]),
                                                 corner_of(c, places, t, TETMESH_FACE[k][1]),
                                                 corner_of(c, places, t, TETMESH_FACE[k][2])));
    for (int k = 0; k < 3; k++)
        vec3_subtract(corner_of(c, places, t, k + 1), corner_of(c, places, t, 0), e[k]);
    return vec3_triple(e[0], e[1], e[2]) < 2 * widest * THIN * sqrt(longest);
}

static starg_status list_about(walk *w) {
    const deform_mesh *c = w->c;
    NEW_ZERO(c->context, STAGE, w->first, w->inner + 2);
    NEW(c->context, STAGE, w->about, c->tetrahedra.count);
    for (size_t i = 0; i < c->tetrahedra.count; i++)
        if (c->tetrahedra.data[i] >= c->fixed)
            w->first[c->tetrahedra.data[i] - c->fixed + 2]++;
    for (size_t v = 0; v < w->inner; v++)
        w->first[v + 2] += w->first[v + 1];
    for (size_t i = 0; i < c->tetrahedra.count; i++)
        if (c->tetrahedra.data[i] >= c->fixed)
            w->about[w->first[c->tetrahedra.data[i] - c->fixed + 1]++] = (uint32_t)(i / 4);
    return STARG_OK;
}

/* ---- displacement ---- */

/* Graph Laplacian: an edge counts once per tetrahedron. */
static starg_status make_system(walk *w) {
    const deform_mesh *c = w->c;
    size_t count = 0;
    SCOPED triplet *triplets = NULL;
    NEW(c->context, STAGE, triplets, 24 * tetrahedron_count(c) + w->inner);
    for (size_t t = 0; t < tetrahedron_count(c); t++)
        for (int e = 0; e < 12; e++) {
            size_t a = c->tetrahedra.data[4 * t + (size_t)DEFORM_EDGES[e / 2][e % 2]];
            size_t b = c->tetrahedra.data[4 * t + (size_t)DEFORM_EDGES[e / 2][1 - e % 2]];
            if (a < c->fixed)
                continue;
            uint32_t row = (uint32_t)(a - c->fixed);
            triplets[count++] = (triplet){row, row, 1};
            if (b >= c->fixed)
                triplets[count++] = (triplet){row, (uint32_t)(b - c->fixed), -1};
        }
    for (uint32_t v = 0; v < w->inner; v++) /* vertices of no tetrahedron stay */
        if (w->first[v] == w->first[v + 1])
            triplets[count++] = (triplet){v, v, 1};
    return triplets_factorise(c->context, w->inner, triplets, count, &w->system);
}

static starg_status prepare(walk *w) {
    const deform_mesh *c = w->c;
    w->inner = c->rest.count / 3 - c->fixed;
    NEW(c->context, STAGE, w->frame, 3 * w->m->mesh->vertex_count);
    NEW(c->context, STAGE, w->next, c->rest.count);
    NEW(c->context, STAGE, w->sides, 2 * w->inner);
    NEW(c->context, STAGE, w->marked, w->inner);
    TRY(list_about(w));
    if (w->inner > 0)
        TRY(make_system(w));
    return STARG_OK;
}

static void displace(walk *w, size_t axis) {
    const deform_mesh *c = w->c;
    const double *now = c->now.data;
    memset(w->sides, 0, w->inner * sizeof *w->sides);
    for (size_t i = 0; i < 12 * tetrahedron_count(c); i++) {
        size_t t = i / 12, e = i % 12;
        size_t a = c->tetrahedra.data[4 * t + (size_t)DEFORM_EDGES[e / 2][e % 2]];
        size_t b = c->tetrahedra.data[4 * t + (size_t)DEFORM_EDGES[e / 2][1 - e % 2]];
        if (a >= c->fixed && b < c->fixed)
            w->sides[a - c->fixed] += w->next[3 * b + axis] - now[3 * b + axis];
    }
    sparse_solve(w->system, w->sides, w->sides + w->inner);
    for (size_t v = 0; v < w->inner; v++)
        w->next[3 * (c->fixed + v) + axis] = now[3 * (c->fixed + v) + axis] + w->sides[v];
}

static starg_status predict(walk *w, double t) {
    const deform_mesh *c = w->c;
    TRY(starg_morph_frame(w->m, t, w->frame));
    for (size_t v = 0; v < c->fixed; v++)
        vec3_copy(w->frame + 3 * (size_t)c->surface[v], w->next + 3 * v);
    for (size_t axis = 0; axis < 3 && w->inner > 0; axis++)
        displace(w, axis);
    return STARG_OK;
}

/* ---- untangling ---- */

/* The face opposite vertex v of tetrahedron t, seen from v, as a row of the program, in units of
 * `unit`. A zero-area face only bounds the room. */
static void make_row(const walk *w, uint32_t v, size_t t, double unit, double row[ROW]) {
    const deform_mesh *c = w->c;
    int own = 0;
    double normal[3], offset[3];
    while (c->tetrahedra.data[4 * t + (size_t)own] != v)
        own++;
    const int *k = TETMESH_FACE[own];
    const double *p = corner_of(c, w->next, t, k[0]);
    vec3_triangle_normal(p, corner_of(c, w->next, t, k[1]), corner_of(c, w->next, t, k[2]), normal);
    double length = vec3_length(normal);
    vec3_subtract(p, w->next + 3 * (size_t)v, offset);
    for (int i = 0; i < 3; i++)
        row[i] = length > 0 ? normal[i] / length : 0;
    row[3] = 1;
    row[4] = length > 0 ? vec3_dot(row, offset) / unit : FAR;
}

static double longest_about(const walk *w, uint32_t v) {
    double longest = 0;
    size_t i = v - w->c->fixed;
    for (uint32_t j = w->first[i]; j < w->first[i + 1]; j++)
        for (int k = 0; k < 4; k++)
            longest = fmax(longest, vec3_distance_squared(corner_of(w->c, w->next, w->about[j], k),
                                                          w->next + 3 * (size_t)v));
    return sqrt(longest);
}

/* Moves a vertex to the point farthest from all surrounding planes, if that is better. */
static starg_status relocate(walk *w, uint32_t v) {
    size_t i = v - w->c->fixed, count = w->first[i + 1] - w->first[i];
    double unit = longest_about(w, v), before = INFINITY;
    linear_solution best;
    w->rows.count = w->order.count = 0;
    if (!(unit > 0))
        return STARG_OK;
    for (size_t j = 0; j < count; j++) {
        double row[ROW];
        make_row(w, v, w->about[w->first[i] + j], unit, row);
        before = fmin(before, row[4]);
        for (int k = 0; k < ROW; k++)
            PUSH(w->c->context, STAGE, &w->rows, row[k]);
        PUSH(w->c->context, STAGE, &w->order, 0);
    }
    const linear_program program = {.dimension = 4,
                                    .rows = w->rows.data,
                                    .count = count,
                                    .objective = {0, 0, 0, 1},
                                    .radius = FAR,
                                    .seed = v};
    linear_program_solve(&program, w->order.data, NULL, &best);
    if (best.feasible && best.point[3] > before)
        vec3_along(w->next + 3 * (size_t)v, unit, best.point, w->next + 3 * (size_t)v);
    return STARG_OK;
}

/* Marks the inner vertices of inverted or thin tetrahedra; returns the number of inverted ones. */
static size_t examine(walk *w) {
    const deform_mesh *c = w->c;
    size_t inverted = 0;
    memset(w->marked, 0, w->inner);
    for (size_t t = 0; t < tetrahedron_count(c); t++) {
        bool positive = is_positive(c, w->next, t);
        inverted += !positive;
        if (positive && !is_thin(c, w->next, t))
            continue;
        for (size_t k = 0; k < 4; k++)
            if (c->tetrahedra.data[4 * t + k] >= c->fixed)
                w->marked[c->tetrahedra.data[4 * t + k] - c->fixed] = 1;
    }
    return inverted;
}

static starg_status untangle(walk *w, size_t *inverted) {
    size_t least = SIZE_MAX;
    int idle = 0;
    *inverted = examine(w);
    for (int sweep = 0; sweep < SWEEPS && idle < PATIENCE; sweep++) {
        TRY(starg_check_cancel(w->c->context, STAGE));
        for (size_t v = 0; v < w->inner; v++)
            if (w->marked[v])
                TRY(relocate(w, (uint32_t)(w->c->fixed + v)));
        *inverted = examine(w);
        if (*inverted == 0)
            break;
        idle = *inverted < least ? 0 : idle + 1;
        least = *inverted < least ? *inverted : least;
    }
    return STARG_OK;
}

/* ---- chords ---- */

typedef STARG_ARRAY(deform_edge) edge_list;

static starg_status find_surface_edges(const walk *w, edge_list *out) {
    const starg_mesh *mesh = w->m->mesh;
    /* numbers of the mesh's vertices here */
    SCOPED uint32_t *own = NULL;
    NEW_ZERO(w->c->context, STAGE, own, mesh->vertex_count);
    for (uint32_t v = 0; v < w->c->fixed; v++)
        own[w->c->surface[v]] = v;
    for (size_t f = 0; f < mesh->face_count; f++)
        for (size_t k = 0; k < 3; k++)
            PUSH(
                w->c->context, STAGE, out,
                deform_edge_of(own[mesh->faces[3 * f + k]], own[mesh->faces[3 * f + (k + 1) % 3]]));
    deform_edges_sort(out->data, &out->count);
    return STARG_OK;
}

/* Interior edges with both ends on the surface. */
static starg_status find_chords(const walk *w, const edge_list *surface, edge_list *out) {
    const deform_mesh *c = w->c;
    for (size_t i = 0; i < 6 * tetrahedron_count(c); i++) {
        uint32_t a = c->tetrahedra.data[4 * (i / 6) + (size_t)DEFORM_EDGES[i % 6][0]];
        uint32_t b = c->tetrahedra.data[4 * (i / 6) + (size_t)DEFORM_EDGES[i % 6][1]];
        deform_edge edge = deform_edge_of(a, b);
        if (a < c->fixed && b < c->fixed && !deform_edge_in(surface->data, surface->count, edge))
            PUSH(c->context, STAGE, out, edge);
    }
    deform_edges_sort(out->data, &out->count);
    return STARG_OK;
}

starg_status deform_free_surface(const starg_morph *m, deform_mesh *c) {
    const walk w = {.m = m, .c = c};
    SCOPED edge_list surface = {0}, chords = {0};
    TRY(find_surface_edges(&w, &surface));
    TRY(find_chords(&w, &surface, &chords));
    TRY(deform_split(c, chords.data, chords.count));
    return deform_fill_flat(c);
}

/* ---- harmonic extension ---- */

starg_status deform_harmonic(const starg_morph *m, deform_mesh *c) {
    SCOPED_BY(walk_free) walk w = {.m = m, .c = c};
    TRY(prepare(&w));
    TRY(predict(&w, 1));
    memcpy(c->now.data, w.next, c->now.count * sizeof *w.next);
    return STARG_OK;
}

/* ---- time steps ---- */

/* Number of tetrahedra that are not proven to be positive on the whole way to their next place. */
static size_t count_unproven(const walk *w) {
    const deform_mesh *c = w->c;
    size_t count = 0;
    for (size_t t = 0; t < tetrahedron_count(c); t++) {
        const double *from[4], *to[4];
        for (int k = 0; k < 4; k++) {
            from[k] = corner_of(c, c->now.data, t, k);
            to[k] = corner_of(c, w->next, t, k);
        }
        count += !stays_positive(from, to);
    }
    return count;
}

/* Moves inner vertices where single ones cannot be untangled. */
static starg_status unfold_step(walk *w, size_t *inverted) {
    const unfold_problem p = {.context = w->c->context,
                              .vertex_count = w->c->rest.count / 3,
                              .fixed = w->c->fixed,
                              .count = tetrahedron_count(w->c),
                              .tetrahedra = w->c->tetrahedra.data,
                              .rest = w->c->rest.data,
                              .now = w->next};
    return unfold(&p, UNFOLD_STEPS, inverted);
}

static starg_status try_step(walk *w, double to, double step, size_t *inverted) {
    TRY(predict(w, to));
    TRY(untangle(w, inverted));
    if (*inverted > 0 && step <= SHORT_STEP)
        TRY(unfold_step(w, inverted));
    if (*inverted == 0 && w->path != NULL)
        *inverted = count_unproven(w);
    return STARG_OK;
}

static starg_status take_step(walk *w, double to) {
    starg_context *context = w->c->context;
    memcpy(w->c->now.data, w->next, w->c->now.count * sizeof *w->next);
    if (w->path == NULL)
        return STARG_OK;
    PUSH(context, STAGE, &w->path->times, to);
    for (size_t i = 0; i < w->c->now.count; i++)
        PUSH(context, STAGE, &w->path->places, w->next[i]);
    return STARG_OK;
}

starg_status deform(const starg_morph *m, deform_mesh *c, deform_path *path, size_t *inverted,
                    double *reached) {
    SCOPED_BY(walk_free) walk w = {.m = m, .c = c, .path = path};
    double longest = path != NULL ? LONGEST_PROVEN : LONGEST_STEP, step = longest;
    *reached = 0;
    TRY(prepare(&w));
    while (*reached < 1 && step >= SHORTEST_STEP) {
        double to = fmin(1, *reached + step);
        TRY(try_step(&w, to, step, inverted));
        if (*inverted > 0) {
            step /= 2;
            continue;
        }
        TRY(take_step(&w, to));
        *reached = to;
        step = fmin(longest, 2 * step);
    }
    return STARG_OK;
}
