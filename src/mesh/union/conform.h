/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces whose faces meet in common corners and edges wherever they meet within rounding. */
#pragma once

#include "mesh/union/union.h"

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

/* Gives flat patches of faces that have one outline, up to the distance, the same triangles
 * (flush.c). Adds to *moved how far the surface may move. Errors: MEMORY. */
starg_status surface_match_flush(union_surface *surface, double distance, double *moved);

/* Has the mesh no open edge then? `merge` as above. Errors: MEMORY, CANCELLED, TIME. */
starg_status conform_closes(starg_context *context, const starg_mesh *mesh, double merge,
                            bool *closed);

/* place[v] is v, or the earlier vertex that it joins: the nearest of those kept that lie within the
 * distance, so that nothing moves farther. Errors: MEMORY. */
starg_status near_weld(starg_context *context, const double *vertices, size_t count,
                       double distance, uint32_t *place);

/* ---- what lies on what ---- */

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

/* ---- faces that cannot lie on one another ---- */

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
