/* SPDX-License-Identifier: Apache-2.0 */
/* Dual complex of the interior tetrahedra [DS06, section 3: the medial axis as Voronoi facets]. The
 * simplices whose cofaces are all inside form an open region, a union of open stars; the complex
 * dual to these simplices is homotopy equivalent to it.
 *
 * The combinatorics follow from the tetrahedra alone. Centres only give measures and positions, so
 * rounding cannot change the topology: a circumcentre outside the region (coarse samples) is
 * replaced by the centroid, that of a flat tetrahedron by a neighbour's.
 *
 * Cost: linear, and an inside test where a centre is replaced. */
#include "skeleton/complex.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec3.h"
#include "skeleton/edge_table.h"
#include "skeleton/medial.h"

static const char STAGE[] = "medial complex";

enum { BLOCK = 256 };

/* Threshold on six times the volume over the cubed longest edge. */
static const double FLAT = 1e-4;

typedef struct builder {
    starg_context *context;
    const starg_solid *solid;
    const double *points;
    const delaunay *tetrahedra;
    uint32_t *node_of; /* per tetrahedron, or EDGE_NONE */
    uint8_t *borders;  /* per node: bit k: the face opposite corner k bounds the region */
    bool *poor;        /* per node: its tetrahedron is flat */
    double limit;      /* upper bound on radii of interior balls */
    edge_table edges;
    medial_complex *complex;
} builder;

static starg_status take_nodes(builder *b, const bool *inside) {
    starg_status status = STARG_OK;
    medial_complex *c = b->complex;
    STARG_NEW(b->context, STAGE, b->node_of, b->tetrahedra->count);
    for (size_t t = 0; t < b->tetrahedra->count; t++)
        b->node_of[t] = inside[t] ? (uint32_t)c->node_count++ : EDGE_NONE;
    STARG_NEW(b->context, STAGE, c->corners, c->node_count);
    STARG_NEW(b->context, STAGE, c->centres, c->node_count);
    STARG_NEW(b->context, STAGE, c->radii, c->node_count);
    STARG_NEW_ZERO(b->context, STAGE, b->borders, c->node_count);
    STARG_NEW(b->context, STAGE, b->poor, c->node_count);
    for (size_t t = 0; t < b->tetrahedra->count; t++)
        if (inside[t])
            memcpy(c->corners[b->node_of[t]], b->tetrahedra->tetrahedra[t], sizeof *c->corners);
    for (size_t t = 0; t < b->tetrahedra->count; t++)
        for (int k = 0; inside[t] && k < 4; k++) {
            uint32_t next = b->tetrahedra->neighbours[t][k];
            if (next == DELAUNAY_NONE || !inside[next])
                b->borders[b->node_of[t]] |= (uint8_t)(1 << k);
        }
done:
    return status;
}

/* Is p beyond a face of the tetrahedron that bounds the region? Rounded: it does not affect
 * topology. */
static bool is_beyond_border(const builder *b, size_t node, const double *const v[4],
                             const double p[3]) {
    for (int k = 0; k < 4; k++) {
        if (!(b->borders[node] >> k & 1))
            continue;
        const double *const w[3] = {v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4]};
        double normal[3], to_p[3], to_corner[3];
        vec3_triangle_normal(w[0], w[1], w[2], normal);
        vec3_subtract(p, w[0], to_p);
        vec3_subtract(v[k], w[0], to_corner);
        if (!(vec3_dot(normal, to_p) * vec3_dot(normal, to_corner) > 0))
            return true;
    }
    return false;
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

static void place_node(const builder *b, size_t node) {
    medial_complex *c = b->complex;
    const double *v[4];
    for (int k = 0; k < 4; k++)
        v[k] = b->points + 3 * (size_t)c->corners[node][k];
    medial_ball ball;
    b->poor[node] = is_flat(v);
    if (b->poor[node] || !medial_circumscribe(v, &ball) || ball.radius > b->limit ||
        is_beyond_border(b, node, v, ball.centre)) {
        for (int j = 0; j < 3; j++)
            ball.centre[j] = 0.25 * v[0][j] + 0.25 * v[1][j] + 0.25 * v[2][j] + 0.25 * v[3][j];
        ball.radius = starg_solid_contains(b->solid, ball.centre)
                          ? starg_solid_distance(b->solid, ball.centre)
                          : 0;
    }
    vec3_copy(ball.centre, c->centres[node]);
    c->radii[node] = ball.radius;
}

/* A flat tetrahedron gets the largest ball of its neighbours: their spheres pass through three of
 * its points and close to the fourth. */
static void place_flat_nodes(const builder *b) {
    medial_complex *c = b->complex;
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 2; k++) {
            uint32_t flat = c->links[l][k], other = c->links[l][1 - k];
            if (b->poor[flat] && !b->poor[other] && c->radii[other] > c->radii[flat]) {
                vec3_copy(c->centres[other], c->centres[flat]);
                c->radii[flat] = c->radii[other];
            }
        }
}

static starg_status place_block(starg_context *context, void *shared, void *scratch, size_t item) {
    const builder *b = shared;
    (void)context;
    (void)scratch;
    for (size_t n = item * BLOCK; n < (item + 1) * BLOCK && n < b->complex->node_count; n++)
        place_node(b, n);
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
    starg_status status = STARG_OK;
    medial_complex *c = b->complex;
    STARG_TRY(edge_table_make(b->context, STAGE, 6 * c->node_count, &b->edges));
    STARG_NEW(b->context, STAGE, c->links, 2 * c->node_count);
    STARG_NEW(b->context, STAGE, c->link_edges, 2 * c->node_count);
    STARG_NEW(b->context, STAGE, c->sheet, 6 * c->node_count);
    STARG_NEW_ZERO(b->context, STAGE, c->buried, c->point_count);
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
done:
    return status;
}

static starg_status take_edges(builder *b) {
    starg_status status = STARG_OK;
    medial_complex *c = b->complex;
    STARG_NEW(b->context, STAGE, c->ends, c->edge_count);
    STARG_NEW(b->context, STAGE, c->lengths, c->edge_count);
    for (size_t slot = 0; slot <= b->edges.mask; slot++) {
        if (b->edges.keys[slot] == 0)
            continue;
        uint32_t e = b->edges.numbers[slot];
        c->ends[e][0] = (uint32_t)(b->edges.keys[slot] >> 32);
        c->ends[e][1] = (uint32_t)(b->edges.keys[slot] & UINT32_MAX);
        c->lengths[e] = vec3_distance(b->points + 3 * (size_t)c->ends[e][0],
                                      b->points + 3 * (size_t)c->ends[e][1]);
    }
done:
    return status;
}

/* The links of each edge, by counting sort. */
static starg_status invert_links(builder *b) {
    starg_status status = STARG_OK;
    medial_complex *c = b->complex;
    STARG_NEW_ZERO(b->context, STAGE, c->first_link, c->edge_count + 2);
    STARG_NEW(b->context, STAGE, c->edge_links, 3 * c->link_count);
    uint32_t *next = c->first_link + 1; /* advances to its final value as the lists fill */
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 3; k++)
            next[c->link_edges[l][k] + 1]++;
    for (size_t e = 0; e < c->edge_count; e++)
        next[e + 1] += next[e];
    for (size_t l = 0; l < c->link_count; l++)
        for (int k = 0; k < 3; k++)
            c->edge_links[next[c->link_edges[l][k]]++] = (uint32_t)l;
done:
    return status;
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
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = (complex->node_count + BLOCK - 1) / BLOCK,
                                .shared = &b,
                                .item = place_block};
    STARG_TRY(starg_parallel_for(context, &loop));
    STARG_TRY(take_links(&b));
    place_flat_nodes(&b);
    STARG_TRY(take_edges(&b));
    STARG_TRY(invert_links(&b));
    *out = complex;
    complex = NULL;
done:
    starg_release(context, b.node_of);
    starg_release(context, b.borders);
    starg_release(context, b.poor);
    edge_table_free(context, &b.edges);
    complex_free(complex);
    return status;
}

void complex_free(medial_complex *complex) {
    if (complex == NULL)
        return;
    starg_context *context = complex->context;
    starg_release(context, complex->corners);
    starg_release(context, complex->centres);
    starg_release(context, complex->radii);
    starg_release(context, complex->links);
    starg_release(context, complex->link_edges);
    starg_release(context, complex->ends);
    starg_release(context, complex->lengths);
    starg_release(context, complex->sheet);
    starg_release(context, complex->first_link);
    starg_release(context, complex->edge_links);
    starg_release(context, complex->buried);
    starg_release(context, complex);
}
