/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of the direction grid (visibility/grid.c), written once and compiled per instruction set:
 * the including file names the function and selects the lanes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bits.h"
#include "visibility/grid.h"
#include "visibility/lanes.h"

/* Divides each cube face into rows of about equally many vertices, by a histogram of v. */
static void cut_rows(grid_scratch *g) {
    memset(g->row_of_bin, 0, sizeof g->row_of_bin);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        g->row_of_bin[g->at.face[slot] % RIM][bin_of(g->at.v[slot])]++;
    }
    g->row_count = 0;
    for (int face = 0; face < CUBE_FACES; face++) {
        uint32_t total = 0, sum = 0, last = 0;
        for (int bin = 0; bin < BINS; bin++)
            total += g->row_of_bin[face][bin];
        double rows_per_vertex = total ? ROW_FACTOR / sqrt((double)total) : 0;
        for (int bin = 0; bin < BINS; bin++) {
            uint32_t count = g->row_of_bin[face][bin];
            last = (uint32_t)((sum + 0.5 * count) * rows_per_vertex);
            g->row_of_bin[face][bin] = g->row_count + last;
            sum += count;
        }
        g->row_count += last + 1;
    }
    for (uint32_t r = 0; r < g->row_count; r++)
        g->rows[r] = (grid_row){.u_low = 1, .u_high = -1, .v_low = 1, .v_high = -1};
}

/* Gives each row twice as many cells as vertices. Returns the number of cells. */
static uint32_t cut_cells(grid_scratch *g) {
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        float v = g->at.v[slot], u = g->at.u[slot];
        g->place[slot] = g->row_of_bin[g->at.face[slot] % RIM][bin_of(v)];
        grid_row *row = &g->rows[g->place[slot]];
        row->u_low = u < row->u_low ? u : row->u_low;
        row->u_high = u > row->u_high ? u : row->u_high;
        row->v_low = v < row->v_low ? v : row->v_low;
        row->v_high = v > row->v_high ? v : row->v_high;
        row->vertices++;
    }
    uint32_t cells = 0;
    for (uint32_t r = 0; r < g->row_count; r++) {
        grid_row *row = &g->rows[r];
        row->first_cell = cells;
        row->cell_count = 2 * row->vertices + 1;
        row->last_cell = (float)(row->cell_count - 1);
        float width = row->u_high - row->u_low;
        row->scale = width > 0 ? (float)row->cell_count / width : 0;
        cells += row->cell_count;
    }
    return cells;
}

/* Counting sort; cell_start[c] is first the end of cell c, and its start once all are placed. */
static void sort_into_cells(const visibility_scene *scene, grid_scratch *g) {
    memset(g->hidden, 0, (starg_bit_words(scene->slot_count) + 1) * sizeof *g->hidden);
    cut_rows(g);
    uint32_t cells = cut_cells(g);
    memset(g->cell_start, 0, (cells + 1) * sizeof *g->cell_start);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        g->place[slot] = cell_of(&g->rows[g->place[slot]], g->at.u[slot]);
        g->cell_start[g->place[slot]]++;
    }
    uint32_t sum = 0;
    for (size_t c = 0; c <= cells; c++)
        sum = g->cell_start[c] += sum;
    for (size_t i = g->used_count; i-- > 0;) {
        uint32_t slot = g->used[i], position = --g->cell_start[g->place[slot]];
        g->place[slot] = position;
        g->slot[position] = slot;
        g->sx[position] = g->at.x[slot];
        g->sy[position] = g->at.y[slot];
        g->sz[position] = g->at.z[slot];
    }
}

static int compare_chunks(const void *left, const void *right) {
    const chunk_distance *a = left, *b = right;
    if (a->distance != b->distance)
        return a->distance < b->distance ? -1 : 1;
    return (a->chunk > b->chunk) - (a->chunk < b->chunk);
}

/* Near chunks of faces hide most, which leaves little to test for far ones. */
static size_t order_chunks(const visibility_scene *scene, const double p[3], const scene_view *view,
                           grid_scratch *g) {
    size_t count = 0;
    for (size_t c = 0; c * CHUNK < scene->face_count; c++) {
        uint32_t slot = scene->corners[3 * (c * CHUNK)];
        const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
        if (!scene_is_beyond(scene, c, p, view))
            g->chunks[count++] = (chunk_distance){vec3_distance_squared(p, q), (uint32_t)c};
    }
    qsort(g->chunks, count, sizeof *g->chunks, compare_chunks);
    return count;
}

/* Corners of the patches of a kept face are looked at, too. */
static void keep_patches(const visibility_scene *scene, size_t rank, uint8_t keep,
                         grid_scratch *g) {
    const mesh_patches *patches = scene->solid->patches;
    const size_t *first = patches->first + scene->face_of[rank];
    for (size_t i = patches->corners * first[0]; keep && i < patches->corners * first[1]; i++)
        g->in_use[scene->patch_corners[i]] = 1;
}

/* Stage 1: lists the faces that can block first, and the vertices that they use; others are not
 * seen, or out of range. */
static void keep_faces(const visibility_scene *scene, const double p[3], const int8_t *side,
                       const scene_view *view, grid_scratch *g) {
    size_t chunk_count = order_chunks(scene, p, view, g);
    g->front_facing_count = g->used_count = 0;
    memset(g->in_use, 0, scene->slot_count);
    for (size_t c = 0; c < chunk_count; c++) {
        size_t rank = (size_t)g->chunks[c].chunk * CHUNK, end = rank + CHUNK;
        for (; rank < end && rank < scene->face_count; rank++) {
            uint8_t keep = scene_may_block(scene, rank, side[rank]);
            const uint32_t *corner = scene->corners + 3 * rank;
            g->front_facing[g->front_facing_count] = (uint32_t)rank;
            g->front_facing_count += keep;
            g->in_use[corner[0]] |= keep;
            g->in_use[corner[1]] |= keep;
            g->in_use[corner[2]] |= keep;
            if (scene->patch_corners != NULL)
                keep_patches(scene, rank, keep, g);
        }
    }
    for (size_t slot, end = 0; next_run(g->in_use, scene->slot_count, &slot, &end);)
        for (; slot < end; slot++) {
            g->used[g->used_count] = (uint32_t)slot;
            g->used_count += g->in_use[slot];
        }
}

#include "visibility/grid_faces.h"

void GRID_RUN(const visibility_scene *scene, grid_scratch *g, const double p[3], const int8_t *side,
              const scene_view *view, uint8_t *visible) {
    keep_faces(scene, p, side, view, g);
    cube_make_relative(scene, p, g->in_use, &g->at);
    cube_project(scene->slot_count, g->in_use, &g->at);
    sort_into_cells(scene, g);
    test_faces(scene, p, side, g);
    memset(visible, 0, scene->slot_count);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        visible[slot] = !starg_bit_test(g->hidden, g->place[slot]);
    }
}
