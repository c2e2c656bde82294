/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of compose.c: a map between two embedded surfaces under optimization. */
#pragma once

#include "morph/align.h"
#include "morph/walk.h"

typedef struct composition {
    sphere *from;
    const locator *to;
    uint8_t *kept;         /* per vertex: a fixed landmark */
    surface_point *points; /* per vertex its image on the second surface */
    double *images;        /* per vertex its place there, scaled to equal areas */
    double scale;          /* of the second surface */
    double floor;          /* added to squared edges to limit the influence of needles; per level */
} composition;

/* The first fundamental form of a triangle with edges u, w from its apex. */
typedef struct triangle_form {
    double u[3], w[3];
    double e, f, g, area; /* twice the area, squared */
} triangle_form;

triangle_form triangle_form_of(const double apex[3], const double p[3], const double q[3],
                               double floor);

/* A place for a vertex, and the energy of its triangles there. */
typedef struct trial {
    surface_point point;
    double image[3], direction[3];
    double energy;
    double slope[3],
        spherical_slope[3]; /* gradients with respect to the image and to the direction */
} trial;

/* The vertex in place; the vertex moved to a point of the second surface. Energy not computed
 * yet. */
void trial_here(const composition *c, uint32_t v, trial *t);
void trial_at(const composition *c, const surface_point *point, trial *t);
/* Computes the energy, and on request the slopes. */
void trial_measure(const composition *c, uint32_t v, bool with_slopes, trial *t);
/* Is every spherical triangle at the vertex positive? Exact. */
bool trial_is_valid(const composition *c, uint32_t v, const trial *t);
/* The worst roundness of the spherical triangles at the vertex: 1 for equilateral ones. */
double trial_roundness(const composition *c, uint32_t v, const trial *t);
/* Moves the vertex there. */
void trial_accept(composition *c, uint32_t v, const trial *t);

/* Locates the images of all present vertices; of one, starting from a nearby face. */
void composition_locate_all(composition *c);
void composition_locate(composition *c, uint32_t v, uint32_t start);
/* Distance from a vertex's image to the nearest one of its neighbours. */
double composition_nearest(const composition *c, uint32_t v);
/* The sum of all triangles' energies. */
double composition_energy(const composition *c);

/* Moves each vertex downhill, `sweeps` times (descend.c). Errors: CANCELLED. */
starg_status composition_descend(composition *c, int sweeps);

/* Moves all vertices together, as rigidly as possible, `steps` times, each followed by some descent
 * (flow.c). Errors: SOLVER, MEMORY, CANCELLED. */
starg_status composition_flow(composition *c, int steps);
