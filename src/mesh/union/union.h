/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary of what a closed surface that intersects itself encloses. */
#pragma once

#include "mesh/mesh.h"

/* ---- the surface, and the flow (union.c) ---- */

#define UNION_STAGE "union"

/* What a face of a union is. */
enum {
    UNION_PART = 1, /* part of a face of the mesh       */
    UNION_FRESH = 2 /* made in the last round           */
};

/* Triangles that bound something: around every point off them the winding number is defined.
 * Edges may have any number of them. */
typedef struct union_surface {
    starg_context *context;
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(uint32_t) origin; /* per face: the one of the mesh that it is (a part of) */
    STARG_ARRAY(uint8_t) flags;   /* per face                                             */
} union_surface;

static inline size_t union_face_count(const union_surface *surface) {
    return surface->origin.count;
}

static inline const double *union_corner(const union_surface *surface, uint32_t face, int k) {
    return surface->vertices.data + 3 * (size_t)surface->faces.data[3 * (size_t)face + (size_t)k];
}

typedef struct union_report {
    size_t pairs;          /* of faces that meet away from common corners, at the start    */
    size_t rounds;         /* of arrangement and rounding                                  */
    double moved;          /* how far a new point is at most from where exact points lie   */
    size_t contacts, grew; /* of the last round; how often there were more than before */
    bool chosen;           /* winding numbers have been counted                            */
    size_t most;           /* faces that a surface had in the first rounds, at most */
} union_report;

/* Makes the boundary of the region where the winding number of `mesh` is positive: a surface whose
 * faces meet in common corners and edges only. The mesh's vertices come first, some of them
 * unused; its faces that meet no others stay. Errors: MESH (rounding makes new intersections each
 * time), RANGE (the coordinates are too wide for exact points), MEMORY, CANCELLED, TIME. */
starg_status union_of_mesh(starg_context *context, const starg_mesh *mesh, double merge,
                           union_surface *out, union_report *report);

/* The faces of a mesh. Errors: MEMORY. */
starg_status union_surface_make(starg_context *context, const starg_mesh *mesh, union_surface *out);
void union_surface_free(union_surface *surface);

/* ---- faces that meet in common corners and edges, within rounding (conform.c) ---- */

typedef struct conform_report {
    size_t merged; /* vertices, as given, that became an earlier one */
    size_t added;  /* vertices where edges meet           */
    size_t rounds; /* that changed something              */
    double moved;  /* no point of the surface moved farther */
    bool left;     /* the last round allowed still changed something */
} conform_report;

/* The distance below which things count as one: a few units in the last place of the largest
 * coordinate, or the fraction `merge` of the diagonal if that is more. Where all coordinates are in
 * single precision the units are those, but no more than a quarter of the shortest edge. */
double conform_distance(const union_surface *surface, double merge);

/* Makes shared what lies within the distance: vertices, vertices on edges and in faces, edges that
 * meet. Faces with a common area in one plane are divided alike. Vertices keep their places and
 * numbers, new ones follow; merged ones are left without faces. Divided faces become parts
 * (UNION_PART | UNION_FRESH); what shrinks to a line disappears. Errors: MEMORY, CANCELLED, TIME.
 */
starg_status surface_conform(union_surface *surface, double distance, conform_report *report);

/* Has the mesh no open edge then? `merge` as above. Errors: MEMORY, CANCELLED, TIME. */
starg_status conform_closes(starg_context *context, const starg_mesh *mesh, double merge,
                            bool *closed);

/* ---- flat patches of one outline (flush.c) ---- */

/* Gives flat patches of faces that have one outline, up to the distance, the same triangles.
 * Adds to *moved how far the surface may move. Errors: MEMORY. */
starg_status surface_match_flush(union_surface *surface, double distance, double *moved);

/* ---- vertices within a distance (near_weld.c) ---- */

/* place[v] is v, or the earlier vertex that it joins: the nearest of those kept that lie within the
 * distance, so that nothing moves farther. Errors: MEMORY. */
starg_status near_weld(starg_context *context, const double *vertices, size_t count,
                       double distance, uint32_t *place);

/* ---- what lies on what (near.c) ---- */

typedef struct near_on_edge {
    uint32_t edge, vertex;
    double at; /* from the lower end (0) to the higher one (1) */
} near_on_edge;

typedef struct near_in_face {
    uint32_t face, vertex;
} near_in_face;

typedef struct near_crossing {
    uint32_t edge[2];
    double at[2], point[3];
} near_crossing;

/* Of a surface without faces that repeat a corner. */
typedef struct near_facts {
    starg_context *context;
    size_t face_count, edge_count;
    uint32_t *edge;                      /* per halfedge: its edge                             */
    uint32_t *ends;                      /* per edge: lower and higher vertex                  */
    uint32_t *owner;                     /* per edge: its lowest halfedge                      */
    uint32_t *sheet;                     /* per face: sets of faces with a common area         */
    STARG_ARRAY(near_on_edge) on;        /* by edge, then along it         */
    STARG_ARRAY(near_in_face) in;        /* by face                        */
    STARG_ARRAY(near_crossing) crossing; /* of edges in one plane          */
    bool sheets;                         /* some set has more than one face */
    double farthest;                     /* distance of what is joined     */
    bool full; /* more crossings than are worth finding: the facts are not complete */
} near_facts;

/* `place` are the vertices, in units that give them about unit size. Errors: MEMORY, CANCELLED,
 * TIME. */
starg_status near_find(starg_context *context, const double *place, const uint32_t *faces,
                       size_t face_count, double distance, near_facts *out);
/* Sorts all and drops repetitions. */
void near_sort(near_facts *facts);
void near_free(near_facts *facts);

/* ---- faces that cannot lie on one another (near_fans.c) ---- */

typedef struct near_fans {
    size_t count;
    uint32_t *of;    /* per face: its fan, from 1 on; 0: none */
    size_t *start;   /* faces of fan k, 0 for those of none: faces[start[k]] up to start[k + 1] */
    uint32_t *faces; /* ascending in each */
} near_fans;

/* Faces of a fan have no common area, and no edges that cross. No face repeats a corner. Errors:
 * MEMORY. */
starg_status near_fans_find(starg_context *context, const double *place, const uint32_t *faces,
                            size_t face_count, near_fans *out);
void near_fans_free(near_fans *fans);
