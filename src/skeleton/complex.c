/* SPDX-License-Identifier: Apache-2.0 */
/* Dual complex of the interior tetrahedra [DS06, section 3: the medial axis as Voronoi facets]. The
 * simplices whose cofaces are all inside form an open region, a union of open stars; the complex
 * dual to these simplices is homotopy equivalent to it.
 *
 * The combinatorics follow from the tetrahedra alone. Centres only give measures and positions, so
 * rounding cannot change the topology: a circumcentre outside the region (coarse samples) is
 * replaced by the centroid, that of a flat tetrahedron by a neighbour's.
 *
 * Cost: linear, and an inside test for most nodes. */
#include "skeleton/skeleton.h"

#include <stdlib.h>

#include "geometry/vec3.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "medial complex";

enum { MOST_STEPS = 1000 };

/* Threshold on six times the volume over the cubed longest edge. */
static const double FLAT = 1e-4;
/* Share of a ball's radius up to which its sphere passes through a point. */
static const double CLOSE = 1e-3;

typedef struct builder {
    starg_context *context;
    const starg_solid *solid;
    const double *points;
    const delaunay *tetrahedra;
    uint32_t *node_of;   /* per tetrahedron, or EDGE_NONE */
    uint32_t *centre_in; /* per tetrahedron: that which holds its centre, if known */
    bool *poor;          /* per node: its tetrahedron is flat */
    double limit;        /* upper bound on radii of interior balls */
    edge_table edges;
    medial_complex *complex;
} builder;

static starg_status take_nodes(builder *b, const bool *inside) {
    medial_complex *c = b->complex;
    NEW(b->context, STAGE, b->node_of, b->tetrahedra->count);
    for (size_t t = 0; t < b->tetrahedra->count; t++)
        b->node_of[t] = inside[t] ? (uint32_t)c->node_count++ : EDGE_NONE;
    c->tetrahedron_count = c->node_count;
    NEW(b->context, STAGE, c->node_of, c->node_count);
    for (uint32_t n = 0; n < c->node_count; n++)
        c->node_of[n] = n;
    NEW(b->context, STAGE, c->corners, c->node_count);
    NEW(b->context, STAGE, c->centres, c->node_count);
    NEW(b->context, STAGE, c->radii, c->node_count);
    NEW(b->context, STAGE, b->poor, c->node_count);
    NEW(b->context, STAGE, b->centre_in, b->tetrahedra->count);
    memset(b->centre_in, 0xff, b->tetrahedra->count * sizeof *b->centre_in);
    for (size_t t = 0; t < b->tetrahedra->count; t++)
        if (inside[t])
            memcpy(c->corners[b->node_of[t]], b->tetrahedra->tetrahedra[t], sizeof *c->corners);
    return STARG_OK;
}

static void get_corners(const builder *b, uint32_t t, const double *v[4]) {
    for (int k = 0; k < 4; k++)
        v[k] = b->points + 3 * (size_t)b->tetrahedra->tetrahedra[t][k];
}

/* The first face of a tetrahedron with p beyond it, other than that to `from`; 4 if there is none.
 * Rounded: it does not affect topology. */
static int face_towards(const builder *b, uint32_t t, uint32_t from, const double p[3]) {
    const double *v[4];
    get_corners(b, t, v);
    int k = 0;
    for (; k < 4; k++) {
        double normal[3], to_p[3];
        if (from != DELAUNAY_NONE && b->tetrahedra->neighbours[t][k] == from)
            continue;
        vec3_triangle_normal(v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4], normal);
        vec3_subtract(p, v[(k + 1) % 4], to_p);
        if (vec3_dot(normal, to_p) * (k % 2 == 0 ? 1 : -1) < 0)
            break;
    }
    return k;
}

/* Is the centre of the ball of a tetrahedron in the region? Walks there, from where the walk of a
 * neighbour ended. */
static bool is_in_region(builder *b, uint32_t t, const double p[3]) {
    uint32_t at = t, from = DELAUNAY_NONE;
    for (int k = 0; k < 4; k++) {
        uint32_t next = b->tetrahedra->neighbours[t][k];
        if (next != DELAUNAY_NONE && b->centre_in[next] != EDGE_NONE)
            at = b->centre_in[next];
    }
    for (int step = 0; step < MOST_STEPS; step++) {
        int k = face_towards(b, at, from, p);
        if (k == 4) {
            b->centre_in[t] = at;
            return b->node_of[at] != EDGE_NONE;
        }
        from = at;
        at = b->tetrahedra->neighbours[at][k];
        if (at == DELAUNAY_NONE)
            return false;
    }
    return starg_solid_contains(b->solid, p);
}

/* Flat: four nearly concyclic points, whose circumsphere is ill-conditioned. */
static bool is_flat(const double *const v[4]) {
    double u[3][3], longest = 0;
    for (int k = 0; k < 3; k++) {
        vec3_subtract(v[k], v[3], u[k]);
        longest = fmax(longest, vec3_length(u[k]));
    }
    return !(fabs(vec3_triple(u[0], u[1], u[2])) > FLAT * longest * longest * longest);
}

/* A ball inside has at most the volume of the solid. Otherwise spheres of nearly flat tetrahedra,
 * whose centres are far outside, would count as the thickest place. */
static double limit_of_radii(const starg_solid *solid) {
    const double pi = 3.14159265358979323846;
    return solid->check->embedded ? 1.01 * cbrt(0.75 / pi * solid->check->volume) : INFINITY;
}

/* From the planes of the faces of a tetrahedron; inside, no point of the surface is nearer. */
static double distance_from_faces(const double *const v[4], const double p[3]) {
    double least = INFINITY;
    for (int k = 0; k < 4; k++) {
        double normal[3], to_p[3];
        vec3_triangle_normal(v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4], normal);
        vec3_subtract(p, v[(k + 1) % 4], to_p);
        double length = vec3_length(normal);
        least = fmin(least, length > 0 ? fabs(vec3_dot(normal, to_p)) / length : 0);
    }
    return least;
}

static void place_node(builder *b, uint32_t t) {
    medial_complex *c = b->complex;
    uint32_t node = b->node_of[t];
    const double *v[4];
    get_corners(b, t, v);
    medial_ball ball;
    b->poor[node] = is_flat(v);
    if (b->poor[node] || !medial_circumscribe(v, &ball) || ball.radius > b->limit ||
        !is_in_region(b, t, ball.centre)) {
        for (int j = 0; j < 3; j++)
            ball.centre[j] = 0.25 * v[0][j] + 0.25 * v[1][j] + 0.25 * v[2][j] + 0.25 * v[3][j];
        ball.radius = distance_from_faces(v, ball.centre);
    }
    vec3_copy(ball.centre, c->centres[node]);
    c->radii[node] = ball.radius;
}

typedef struct flat_seed {
    double radius;
    uint32_t node;
} flat_seed;

static int compare_seeds(const void *left, const void *right) {
    const flat_seed *a = left, *b = right;
    if (a->radius != b->radius)
        return a->radius > b->radius ? -1 : 1;
    return (a->node > b->node) - (a->node < b->node);
}

/* Does the ball of `giver` pass through the corners of `node`? */
static bool passes_through(const builder *b, uint32_t giver, uint32_t node) {
    const medial_complex *c = b->complex;
    for (int k = 0; k < 4; k++) {
        double d = vec3_distance(c->centres[giver], b->points + 3 * (size_t)c->corners[node][k]);
        if (fabs(d - c->radii[giver]) > CLOSE * c->radii[giver])
            return false;
    }
    return true;
}

/* The places of flat tetrahedra. Between cells of many cocircular points there are layers of them;
 * a ball, the largest first, takes all that it passes through, so that the border between two cells
 * stays simple. Others get the largest ball of their neighbours, which passes through three of
 * their points. */
static starg_status place_flat_nodes(builder *b) {
    medial_complex *c = b->complex;
    SCOPED_BY(graph_free) curve_graph graph = {0};
    SCOPED flat_seed *seeds = NULL;
    SCOPED uint32_t *queue = NULL, *giver = NULL;
    size_t count = 0;
    NEW(b->context, STAGE, giver, c->node_count);
    NEW(b->context, STAGE, queue, c->node_count);
    NEW(b->context, STAGE, seeds, 2 * c->link_count);
    TRY(graph_create(b->context, c->node_count, c->links, NULL, c->link_count, &graph));
    for (uint32_t v = 0; v < c->node_count; v++) {
        giver[v] = EDGE_NONE;
        for (uint32_t j = graph.first[v]; !b->poor[v] && j < graph.first[v + 1]; j++)
            if (b->poor[graph.next[j]]) {
                seeds[count++] = (flat_seed){c->radii[v], v};
                break;
            }
    }
    qsort(seeds, count, sizeof *seeds, compare_seeds);
    for (int strict = 1; strict >= 0; strict--)
        for (size_t i = 0; i < count; i++) {
            size_t taken = 0;
            queue[taken++] = seeds[i].node;
            for (size_t at = 0; at < taken; at++)
                for (uint32_t j = graph.first[queue[at]]; j < graph.first[queue[at] + 1]; j++) {
                    uint32_t w = graph.next[j];
                    if (!b->poor[w] || giver[w] != EDGE_NONE ||
                        (strict && !passes_through(b, seeds[i].node, w)))
                        continue;
                    giver[w] = seeds[i].node;
                    if (strict)
                        queue[taken++] = w;
                }
        }
    for (size_t n = 0; n < c->node_count; n++)
        if (giver[n] != EDGE_NONE) {
            vec3_copy(c->centres[giver[n]], c->centres[n]);
            c->radii[n] = c->radii[giver[n]];
        }
    return STARG_OK;
}

/* Numbers the three edges of the triangle opposite corner k. */
static void number_triangle(builder *b, const uint32_t corners[4], int k, uint32_t edges[3]) {
    uint32_t v[3];
    for (int j = 0, n = 0; j < 4; j++)
        if (j != k)
            v[n++] = corners[j];
    for (int j = 0; j < 3; j++)
        edges[j] = edge_table_number(&b->edges, v[j], v[(j + 1) % 3]);
}

/* Makes links of triangles between two nodes; marks the edges and points of border triangles. */
static starg_status take_links(builder *b) {
    medial_complex *c = b->complex;
    TRY(edge_table_make(b->context, STAGE, 6 * c->node_count, &b->edges));
    NEW(b->context, STAGE, c->links, 2 * c->node_count);
    NEW(b->context, STAGE, c->link_edges, 2 * c->node_count);
    NEW(b->context, STAGE, c->sheet, 6 * c->node_count);
    NEW_ZERO(b->context, STAGE, c->buried, c->point_count);
    memset(c->sheet, true, 6 * c->node_count);
    for (size_t n = 0; n < c->node_count; n++)
        for (int k = 0; k < 4; k++)
            c->buried[c->corners[n][k]] = true;
    for (size_t t = 0; t < b->tetrahedra->count; t++) {
        uint32_t node = b->node_of[t], edges[3];
        for (int k = 0; k < 4 && node != EDGE_NONE; k++) {
            uint32_t next = b->tetrahedra->neighbours[t][k];
            uint32_t other = next == DELAUNAY_NONE ? EDGE_NONE : b->node_of[next];
            if (other < node)
                continue;
            number_triangle(b, c->corners[node], k, edges);
            if (other != EDGE_NONE) {
                c->links[c->link_count][0] = node;
                c->links[c->link_count][1] = other;
                memcpy(c->link_edges[c->link_count++], edges, sizeof edges);
                continue;
            }
            for (int j = 0; j < 3; j++)
                c->sheet[edges[j]] = false;
            for (int j = 0; j < 4; j++)
                if (j != k)
                    c->buried[c->corners[node][j]] = false;
        }
    }
    c->edge_count = b->edges.count;
    return STARG_OK;
}

static starg_status take_edges(builder *b) {
    medial_complex *c = b->complex;
    NEW(b->context, STAGE, c->ends, c->edge_count);
    NEW(b->context, STAGE, c->lengths, c->edge_count);
    for (size_t slot = 0; slot <= b->edges.mask; slot++) {
        if (b->edges.keys[slot] == 0)
            continue;
        uint32_t e = b->edges.numbers[slot];
        c->ends[e][0] = (uint32_t)(b->edges.keys[slot] >> 32);
        c->ends[e][1] = (uint32_t)(b->edges.keys[slot] & UINT32_MAX);
        c->lengths[e] = vec3_distance(b->points + 3 * (size_t)c->ends[e][0],
                                      b->points + 3 * (size_t)c->ends[e][1]);
    }
    return STARG_OK;
}

static starg_status invert_links(builder *b) {
    medial_complex *c = b->complex;
    NEW(b->context, STAGE, c->first_link, c->edge_count + 2);
    NEW(b->context, STAGE, c->edge_links, 3 * c->link_count);
    complex_invert(c);
    return STARG_OK;
}

void complex_invert(medial_complex *c) {
    uint32_t *next = c->first_link + 1; /* advances to its final value as the lists fill */
    memset(c->first_link, 0, (c->edge_count + 2) * sizeof *c->first_link);
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 3; k++)
            next[c->link_edges[l][k] + 1]++;
    for (size_t e = 0; e < c->edge_count; e++)
        next[e + 1] += next[e];
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 3; k++)
            c->edge_links[next[c->link_edges[l][k]]++] = (uint32_t)l;
}

starg_status complex_create(starg_context *context, const starg_solid *solid, const double *points,
                            size_t point_count, const delaunay *tetrahedra, const bool *inside,
                            medial_complex **out) {
    starg_status status = STARG_OK;
    medial_complex *complex = NULL;
    builder b = {.context = context,
                 .solid = solid,
                 .points = points,
                 .tetrahedra = tetrahedra,
                 .limit = limit_of_radii(solid)};
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, complex, 1);
    complex->context = context;
    complex->point_count = point_count;
    b.complex = complex;
    STARG_TRY(take_nodes(&b, inside));
    for (uint32_t t = 0; t < tetrahedra->count; t++)
        if (inside[t])
            place_node(&b, t);
    STARG_TRY(take_links(&b));
    STARG_TRY(place_flat_nodes(&b));
    STARG_TRY(take_edges(&b));
    STARG_TRY(invert_links(&b));
    *out = complex;
    complex = NULL;
done:
    RELEASE(b.node_of, b.centre_in, b.poor);
    edge_table_free(&b.edges);
    complex_free(complex);
    return status;
}

void complex_free(medial_complex *complex) {
    if (complex == NULL)
        return;
    RELEASE(complex->corners, complex->node_of, complex->centres, complex->radii, complex->links,
            complex->link_edges, complex->ends, complex->lengths, complex->sheet,
            complex->first_link, complex->edge_links, complex->buried, complex);
}
