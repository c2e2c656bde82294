/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.json and reports of morphs as read for the verifier, and their claims. */
#pragma once

#include "verify/facts.h"

/* ---- MAP.json as read, and its claims (read_map.c, claim_sphere.c, claim_overlay.c) ---- */

/* Points of a surface: a face each, and three weights of its corners. */
typedef struct verify_places {
    uint32_t *faces;
    double *weights;
} verify_places;

struct starg_map_file {
    starg_context *context;
    bool same; /* it says that vertex i goes to vertex i */
    /* what it says of counts and distortion; not a number: nothing */
    double vertices, target_vertices, target_faces, landmarks, angles, areas;

    size_t point_count, pair_count, direction_count[2];
    verify_places points; /* on B, of A's vertices */
    uint32_t *pairs;      /* pair_count x 2 */
    double *directions[2];

    size_t overlay_points, overlay_faces; /* 0: none */
    verify_places overlay[2];             /* on A, on B */
    uint32_t *triangles;                  /* overlay_faces x 3 */
};

typedef struct verify_map {
    starg_context *context;
    const starg_map_file *file;
    const starg_mesh *mesh[2];
    verify_surface *surface[2]; /* outward; only with directions or an overlay */
    starg_verdict *verdict;
} verify_map;

/* Both surfaces cover the sphere once, and points are where directions say (claim_sphere.c).
 * Errors: MEMORY, CANCELLED. */
starg_status verify_claim_sphere(const verify_map *own);

/* The overlay fills both surfaces (claim_overlay.c). Errors: MEMORY, CANCELLED. */
starg_status verify_claim_overlay(const verify_map *own);

/* The weights of a face's corners at a place, in the surface's order of them; false if the place is
 * not in the closed face. */
bool verify_weights_in(const starg_mesh *mesh, const verify_places *places, size_t i,
                       const uint32_t corner[3], double w[3]);

/* ---- the report of a morph as read (read_morph.c) ---- */

typedef struct verify_frame {
    double t, volume, area, volume_drift, area_drift;
    size_t intersections;
} verify_frame;

struct starg_morph_report {
    starg_context *context;
    size_t frame_count;
    verify_frame *frames;
};
