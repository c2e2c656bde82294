/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility on a grid of directions: all segments share the origin p, so a face hides exactly
 * those vertices behind it whose directions lie in its cone.
 *
 * Stages for a point p:
 *   1. select the front-facing faces, those with p on their inner side (all, if the boundary is not
 *      embedded; the proof is in scene.h); a vertex without a front-facing face is hidden;
 *   2. project the remaining vertices to the six faces of a cube around p, and counting-sort them
 *      into the cells of a grid there, row by row, so that the cells that a face touches in one row
 *      are one run of vertices;
 *   3. for each front-facing face, near chunks first (grid_faces.h): test the visible vertices in
 *      the cells of its bounding box against the planes through p and its edges, and its own. Faces
 *      entirely behind a single other one are skipped.
 *
 * Cells only select what is tested, with a margin above the rounding of the projection. With A, B,
 * C, V the corners and the vertex relative to p and D = det(A, B, C) > 0, V is hidden exactly if w0
 * = det(B, C, V), w1 = det(C, A, V), w2 = det(A, B, V) are >= 0 and w0 + w1 + w2 > D: the sum is
 * the normal of the face times V, larger than D if V lies beyond its plane. Signs within the static
 * error bound [She97] are decided by the exact segment test.
 *
 * What a face hides strictly, with all signs positive, is a convex set, so it contains a face if it
 * contains its corners. A face within it may be skipped: the first face on the segment from p to a
 * hidden vertex has a point there with nothing in front, and so is tested. Where limbs and folds
 * overlap, two thirds of the front-facing faces are skipped.
 *
 * Cost per point: O(n) for sorting plus the pairs of faces and vertices in common cells, about ten
 * a face. Memory per thread: about a hundred bytes a vertex. */
#include "visibility/grid.h"

#include <math.h>
#include <stdlib.h>

#include "core/bits.h"
#include "core/memory.h"

static void free_scratch(const visibility_scene *scene, void *scratch) {
    (void)scene;
    grid_scratch *g = scratch;
    if (g == NULL)
        return;
    cube_free(&g->at);
    RELEASE(g->rows, g->cell_start, g->in_use, g->used, g->front_facing, g->place, g->slot, g->sx,
            g->sy, g->sz, g->hider, g->hidden, g->chunks, g);
}

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    starg_context *context = scene->context;
    grid_scratch *g = starg_allocate_zero(context, 1, sizeof *g);
    *scratch = NULL;
    if (g == NULL)
        return STARG_ERROR_MEMORY;
    size_t n = scene->slot_count;
    g->row_limit = (size_t)(CUBE_FACES * (ROW_FACTOR * sqrt((double)n) + 2));
    g->rows = starg_allocate(context, g->row_limit, sizeof *g->rows);
    g->cell_start = starg_allocate(context, 2 * n + g->row_limit + 1, sizeof *g->cell_start);
    g->in_use = starg_allocate(context, n, sizeof *g->in_use);
    g->used = starg_allocate(context, n + 1, sizeof *g->used);
    g->front_facing = starg_allocate(context, scene->face_count + 1, sizeof *g->front_facing);
    g->place = starg_allocate(context, n, sizeof *g->place);
    g->slot = starg_allocate(context, n, sizeof *g->slot);
    g->sx = starg_allocate_zero(context, n + LANES, sizeof *g->sx);
    g->sy = starg_allocate_zero(context, n + LANES, sizeof *g->sy);
    g->sz = starg_allocate_zero(context, n + LANES, sizeof *g->sz);
    g->hider = starg_allocate(context, n, sizeof *g->hider);
    g->hidden = starg_allocate(context, starg_bit_words(n) + 1, sizeof *g->hidden);
    g->chunks = starg_allocate(context, scene->face_count / CHUNK + 1, sizeof *g->chunks);
    if (cube_make(context, n, &g->at) && g->rows && g->cell_start && g->in_use && g->used &&
        g->front_facing && g->place && g->slot && g->sx && g->sy && g->sz && g->hider &&
        g->hidden && g->chunks) {
        g->run = grid_choose_variant(ISA_WIDEST);
        *scratch = g;
        return STARG_OK;
    }
    free_scratch(scene, g);
    return STARG_ERROR_MEMORY;
}

grid_run *grid_choose_variant(visibility_isa wanted) {
    static grid_run *const variants[] = {
        grid_run_plain,
#if defined(__aarch64__)
        grid_run_neon,
#elif defined(__x86_64__)
        grid_run_avx2,
        grid_run_avx512,
#endif
    };
    wanted = isa_resolve(wanted);
    return isa_is_supported(wanted) ? variants[wanted] : NULL;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible) {
    grid_scratch *g = scratch;
    g->run(scene, g, p, side, view, visible);
}

const visibility_engine visibility_grid = {make_scratch, free_scratch, find, NULL};
