/* SPDX-License-Identifier: Apache-2.0 */
/* The curve skeleton of a solid: from samples of its surface by Delaunay tetrahedra to the medial
 * axis, from there by erosion to a graph, and to branches (skeleton.c has the stages). */
#pragma once

#include "core/context.h"
#include "geometry/delaunay.h"
#include "mesh/halfedges.h"
#include "mesh/solid.h"
#include "starguard/skeleton.h"

#include <stddef.h>

STARG_DROP_RESULT(starg_skeleton)

/* ---- samples: a subdivision of the mesh, dense enough for the Voronoi diagram (samples.c) ---- */

/* A closed mesh on the solid's faces. Its first points are the vertices of the solid. */
typedef struct surface_samples {
    size_t point_count, face_count;
    double *points;
    uint32_t *faces;
} surface_samples;

/* Subdivides until no edge is much longer than with at least `wanted` points evenly on the surface.
 * If `moved`, they are a little off the surface, so that no five are cospherical. Errors: MEMORY,
 * CANCELLED. */
starg_status samples_create(starg_context *context, const starg_solid *solid, size_t wanted,
                            bool moved, surface_samples *samples);
void samples_free(surface_samples *samples);

/* ---- samples as a changing mesh: halfedges with the attributes of samples (sample_mesh.c) ---- */

typedef struct sample_mesh {
    starg_context *context;
    mesh_halfedges net;
    STARG_ARRAY(double) points; /* x, y, z of each */
    STARG_ARRAY(uint8_t) depth; /* per point: how often its edge or face was cut */
    STARG_ARRAY(bool) dirty;    /* per point: have its faces changed? */
} sample_mesh;

static inline size_t sample_mesh_points(const sample_mesh *m) {
    return m->points.count / 3;
}

static inline const double *sample_mesh_at(const sample_mesh *m, uint32_t v) {
    return m->points.data + 3 * (size_t)v;
}

/* Takes ownership of the samples; all points are dirty. Errors: MEMORY. */
starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m);
/* Returns the points and faces. */
void sample_mesh_give(sample_mesh *m, surface_samples *samples);
/* `copy` must be empty or freed. Errors: MEMORY. */
starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy);
void sample_mesh_free(sample_mesh *m);

/* As halfedges_flip. */
void sample_mesh_flip(sample_mesh *m, uint32_t h);
/* Inserts a point into an edge or a face, unless that was cut MAX_DEPTH times before. Errors:
 * MEMORY. */
starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]);
starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]);

/* The greatest depth of a face's corners. */
uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f);

/* ---- samples whose faces are faces of their Delaunay tetrahedra (conform.c) ---- */

/* Modified samples and their tetrahedra. */
typedef struct conformed {
    surface_samples samples;
    delaunay *tetrahedra;
    size_t lost; /* faces of the samples that are not faces of tetrahedra */
} conformed;

/* One per strategy of inserting points, and one without points. */
enum { CONFORM_RESULTS = 5 };

/* Modifies the samples, a closed manifold mesh, until each face is a face of the Delaunay
 * tetrahedra of its points or the work limit is reached. Tries strategies until no face is lost;
 * sorts the results by lost faces, fewest first. Takes ownership of the samples. All results must
 * be freed, after errors too. Errors: MEMORY, CANCELLED. */
starg_status conform_samples(starg_context *context, surface_samples *samples,
                             conformed results[CONFORM_RESULTS], size_t *count);
void conformed_free(conformed *result);

/* ---- labels: which Delaunay tetrahedra of samples lie inside the solid (label.c) ---- */

typedef struct inside_labels {
    bool *inside;      /* per tetrahedron */
    bool *found;       /* per face of the samples: is it a face of tetrahedra? */
    size_t lost_count; /* faces that are not */
} inside_labels;

/* If no face is lost, the inside tetrahedra fill exactly what the samples bound. Otherwise the two
 * sides meet in the narrowest triangles of the gaps. Errors: MEMORY. */
starg_status labels_create(starg_context *context, const starg_solid *solid,
                           const surface_samples *samples, const delaunay *tetrahedra,
                           inside_labels *labels);
void labels_free(inside_labels *labels);

/* ---- medial axis as maximal balls: Voronoi vertices of the surface's vertices (medial.c) ---- */

typedef struct medial_ball {
    double centre[3];
    double radius; /* distance to its four vertices */
} medial_ball;

/* The circumsphere of four points; false if they are flat or it is too large for doubles. */
bool medial_circumscribe(const double *const v[4], medial_ball *ball);

/* All balls whose centre lies strictly inside the solid, at least `clearance` from its boundary;
 * the order depends on the input and the seed only. Free with starg_release. Errors: MEMORY,
 * CANCELLED. */
starg_status medial_balls(starg_context *context, const starg_solid *solid, double clearance,
                          medial_ball **balls, size_t *count);

/* Moves a well spread subset of at most `wanted` balls to the front of the array; *chosen: their
 * number. Errors: CANCELLED, TIME. */
starg_status medial_thin(starg_context *context, medial_ball *balls, size_t count, size_t wanted,
                         double *scratch, size_t *chosen);

/* ---- medial axis as a cell complex, dual to the inside tetrahedra (complex.c) ---- */

/* Interior Delaunay tetrahedra, interior triangles and interior edges are dual to Voronoi vertices,
 * edges and facets. Names here: a node is a tetrahedron, or several whose centres coincide, a link
 * a triangle between two nodes, a sheet an interior edge. */
typedef struct medial_complex {
    starg_context *context;
    size_t tetrahedron_count, node_count, link_count, edge_count;
    uint32_t (*corners)[4]; /* sample points of each tetrahedron */
    uint32_t *node_of;      /* per tetrahedron */
    double (*centres)[3];   /* of nodes: circumcentre if inside, else a point of the tetrahedron */
    double
        *radii; /* distance from the centre to the surface; 0 if rounding put the centre outside */
    uint32_t (*links)[2];      /* the two nodes of a link */
    uint32_t (*link_edges)[3]; /* the edges of its triangle */
    uint32_t (*ends)[2];       /* sample points of each edge */
    double *lengths;           /* of edges */
    bool *sheet;               /* is the edge interior? Otherwise it bounds the complex */
    uint32_t *first_link;      /* links of edge e: edge_links[first_link[e] .. first_link[e + 1]) */
    uint32_t *edge_links;
    size_t point_count;
    bool *buried; /* sample points without a border triangle: dual to 3-cells */
} medial_complex;

/* Makes the complex of the interior tetrahedra. Errors: MEMORY, CANCELLED. */
starg_status complex_create(starg_context *context, const starg_solid *solid, const double *points,
                            size_t point_count, const delaunay *tetrahedra, const bool *inside,
                            medial_complex **out);
/* Makes the lists of links of edges anew, after links have been removed. */
void complex_invert(medial_complex *complex);
void complex_free(medial_complex *complex);

/* ---- one node of those whose centres coincide (contract.c) ---- */

/* Keeps the homotopy type. Nodes may be joined by several links afterwards. Errors: MEMORY. */
starg_status contract_complex(starg_context *context, medial_complex *complex);

/* ---- erosion of the complex to a graph (erosion.c) ---- */

typedef struct erosion {
    bool *link_left;  /* per link: is it in the remaining graph? */
    double *values;   /* per edge: its medial geodesic function */
    size_t cut_count; /* sheets cut because no collapse was possible */
} erosion;

/* Errors: MEMORY, CANCELLED. */
starg_status erosion_run(starg_context *context, const medial_complex *complex, erosion *result);
void erosion_free(erosion *result);

/* ---- loops and parts of an eroded graph that the solid does not have (graph_repair.c) ---- */

/* Cuts the shortest loops (in links) one by one, until `excess` are cut or none is left. Errors:
 * MEMORY, CANCELLED. */
starg_status graph_repair_loops(starg_context *context, const medial_complex *complex,
                                bool *link_left, size_t excess);

/* Keeps the `wanted` largest components and marks their nodes. Errors: MEMORY. */
starg_status graph_repair_parts(starg_context *context, const medial_complex *complex,
                                bool *link_left, bool *node_left, size_t wanted);

/* ---- undirected graphs as adjacency lists (graph.c) ---- */

typedef struct curve_graph {
    size_t node_count;
    uint32_t *first; /* neighbours of v: next[first[v] .. first[v + 1]) */
    uint32_t *next;
} curve_graph;

/* The graph of the marked pairs, or of all if `marked` is NULL. Errors: MEMORY. */
starg_status graph_create(starg_context *context, size_t node_count, uint32_t (*links)[2],
                          const bool *marked, size_t link_count, curve_graph *graph);
void graph_free(curve_graph *graph);

/* ---- pruning: which branches of the graph are features (prune.c) ---- */

typedef struct pruned_graph {
    bool *kept;
    uint32_t *owner; /* the kept node that represents each node; itself if kept */
} pruned_graph;

/* `values`: the medial geodesic function of the complex's edges. Keeps all loops, and branches that
 * leave their joint's ball as limbs do, by at least `reach` - 1 half widths of the solid at the
 * joint and some `spacing`s of the samples. Every component keeps a node, except components of
 * nodes that are not left, which are dropped. Errors: MEMORY. */
starg_status prune_graph(starg_context *context, const starg_solid *solid,
                         const medial_complex *complex, const curve_graph *graph,
                         const bool *node_left, const double *values, double reach, double spacing,
                         pruned_graph *pruned);
void prune_free(pruned_graph *pruned);

/* ---- ends: where those of a curve lie (ends.c) ---- */

/* The direction, of any length, in which a curve through three points runs `ahead` beyond the last
 * one if it bends on. `before` may equal `back`: then it runs straight. */
void ends_direction(const double before[3], const double back[3], const double at[3], double ahead,
                    double way[3]);

/* Moves the end of a curve, points[last], on to its last ball. The curve's points are last, last +
 * step, ..., `count` of them, inside of the solid as the end is before and after. */
void ends_advance(const starg_solid *solid, double (*points)[3], size_t last, ptrdiff_t step,
                  size_t count);

/* ---- the pruned graph as evenly spaced nodes on smooth branches (curve.c) ---- */

/* Fills positions, radii, edges and vertex_nodes with their counts.
 * Errors: MESH (no double strictly inside), MEMORY, CANCELLED. */
starg_status curve_create(starg_context *context, const starg_solid *solid,
                          const medial_complex *complex, const curve_graph *graph,
                          const pruned_graph *pruned, size_t wanted, starg_skeleton *skeleton);
