/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the direction grid (visibility/grid.c): its tables, and the stages compiled per
 * instruction set. */
#ifndef STARG_VISIBILITY_GRID_H
#define STARG_VISIBILITY_GRID_H

#include "visibility/cube.h"
#include "visibility/scene.h"

enum { CHUNK = SCENE_CHUNK, LANES = 8 };

/* Rows of a cube face with m vertices: this times sqrt(m). Wide flat cells are best: a face then
 * touches few rows, and in each of them one run of vertices. */
static const double ROW_FACTOR = 0.2;

/* A row of cells: vertices of nearly the same v, divided evenly between their extremes of u. */
typedef struct grid_row {
    float u_low, u_high, v_low, v_high, scale, last_cell;
    uint32_t first_cell, cell_count, vertices;
} grid_row;

typedef struct chunk_distance {
    double distance;
    uint32_t chunk;
} chunk_distance;

struct grid_scratch;

/* All stages for one point: visible[slot] = 1 if p sees the vertex, otherwise 0. */
typedef void grid_run(const visibility_scene *scene, struct grid_scratch *g, const double p[3],
                      const int8_t *side, const scene_view *view, uint8_t *visible);

typedef struct grid_scratch {
    grid_run *run;
    uint32_t row_count;
    uint32_t row_of_bin[CUBE_FACES][BINS];
    grid_row *rows; /* row_limit at most */
    size_t row_limit;
    uint32_t *cell_start; /* two cells per vertex and one per row, and the end */
    cube_directions at;
    uint8_t *in_use; /* slot has a front-facing face */
    uint32_t *used;  /* the slots in use */
    size_t used_count;
    uint32_t *front_facing; /* ranks of the front-facing faces, by chunks, near ones first */
    size_t front_facing_count;
    /* Vertices in use, by cell. */
    uint32_t *place;      /* slot -> position; undefined for others */
    uint32_t *slot;       /* position -> slot */
    double *sx, *sy, *sz; /* with LANES extra undefined entries */
    uint32_t *hider;      /* slot -> rank of a face that certainly hides it, or SCENE_NONE */
    uint64_t *hidden;     /* bits by position, with one extra word */
    chunk_distance *chunks;
} grid_scratch;

static inline uint32_t cell_of(const grid_row *row, float u) {
    return row->first_cell + part_of(u - row->u_low, row->scale, row->last_cell);
}

/* The stages for each instruction set. */
grid_run grid_run_plain;
#if defined(__aarch64__)
grid_run grid_run_neon;
#elif defined(__x86_64__)
grid_run grid_run_avx2, grid_run_avx512;
#endif

/* NULL if the processor lacks what the variant needs. */
grid_run *grid_choose_variant(visibility_isa wanted);

#endif
