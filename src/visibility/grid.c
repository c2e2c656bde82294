/* Visibility on a grid of directions: all segments of a point share their origin, so that a face
 * hides exactly those vertices behind it whose directions lie in its cone.
 *
 * Stages for a point p:
 *   1. keep the faces that have p on their inner side (all, if the boundary is not embedded; the
 *      proof is in scene.h); a vertex without a kept face is hidden;
 *   2. project the remaining vertices to the six faces of a cube about p, and sort them by
 *      counting into the cells of a grid there, row by row, so that the cells that a face touches
 *      in one row are one run of vertices;
 *   3. for each kept face, near chunks first: the vertices in the cells of its bounding box that
 *      are not hidden yet are tested against the planes through p and its edges, and its own.
 *
 * Cells only choose what is tested; they are chosen with a margin above the rounding of the
 * projection. With A, B, C, V the corners and the vertex relative to p and D = det(A, B, C) > 0,
 * V is hidden exactly if w0 = det(B, C, V), w1 = det(C, A, V), w2 = det(A, B, V) are >= 0 and
 * w0 + w1 + w2 > D: the sum is the normal of the face times V, larger than D where V lies beyond
 * its plane. Signs within the static error bound [She97] are decided by the exact segment test.
 *
 * Cost per point: O(n) for sorting plus the pairs of faces and vertices in common cells, about
 * ten a face. Memory per thread: 60 bytes a vertex and the cells. */
#include "visibility/grid.h"

#include <math.h>
#include <stdlib.h>

#include "core/bits.h"
#include "core/memory.h"

/* Rows of a cube face with m vertices: this times sqrt(m). Flat long cells are best: a face then
 * touches few rows, and in each of them one run of vertices. */
static const double ROW_FACTOR = 0.2;

static void free_scratch(const visibility_scene *scene, void *scratch) {
    grid_scratch *g = scratch;
    if (g == NULL)
        return;
    starg_context *context = scene->context;
    starg_release(context, g->rows);
    starg_release(context, g->cell_start);
    starg_release(context, g->cube);
    starg_release(context, g->x);
    starg_release(context, g->y);
    starg_release(context, g->z);
    starg_release(context, g->v);
    starg_release(context, g->in_use);
    starg_release(context, g->used);
    starg_release(context, g->kept);
    starg_release(context, g->place);
    starg_release(context, g->slot);
    starg_release(context, g->sx);
    starg_release(context, g->sy);
    starg_release(context, g->sz);
    starg_release(context, g->hidden);
    starg_release(context, g->chunks);
    starg_release(context, g);
}

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    starg_context *context = scene->context;
    grid_scratch *g = starg_allocate_zero(context, 1, sizeof *g);
    *scratch = NULL;
    if (g == NULL)
        return STARG_ERROR_MEMORY;
    size_t n = scene->vertex_count;
    g->row_limit = (size_t)(CUBE_FACES * (ROW_FACTOR * sqrt((double)n) + 2));
    g->rows = starg_allocate(context, g->row_limit, sizeof *g->rows);
    g->cell_start = starg_allocate(context, 2 * n + g->row_limit + 1, sizeof *g->cell_start);
    g->cube = starg_allocate(context, n, sizeof *g->cube);
    g->x = starg_allocate(context, n, sizeof *g->x);
    g->y = starg_allocate(context, n, sizeof *g->y);
    g->z = starg_allocate(context, n, sizeof *g->z);
    g->v = starg_allocate(context, n, sizeof *g->v);
    g->in_use = starg_allocate(context, n, sizeof *g->in_use);
    g->used = starg_allocate(context, n + 1, sizeof *g->used);
    g->kept = starg_allocate(context, scene->face_count + 1, sizeof *g->kept);
    g->place = starg_allocate(context, n, sizeof *g->place);
    g->slot = starg_allocate(context, n, sizeof *g->slot);
    g->sx = starg_allocate_zero(context, n + LANES, sizeof *g->sx);
    g->sy = starg_allocate_zero(context, n + LANES, sizeof *g->sy);
    g->sz = starg_allocate_zero(context, n + LANES, sizeof *g->sz);
    g->hidden = starg_allocate(context, starg_bit_words(n) + 1, sizeof *g->hidden);
    g->chunks = starg_allocate(context, scene->face_count / CHUNK + 1, sizeof *g->chunks);
    if (g->rows && g->cell_start && g->cube && g->x && g->y && g->z && g->v && g->in_use &&
        g->used && g->kept && g->place && g->slot && g->sx && g->sy && g->sz && g->hidden &&
        g->chunks) {
        g->test_faces = grid_choose_form(GRID_WIDEST);
        *scratch = g;
        return STARG_OK;
    }
    free_scratch(scene, g);
    return STARG_ERROR_MEMORY;
}

static double larger(double a, double b) {
    return a > b ? a : b; /* unlike fmax, one instruction */
}

/* With |x| <= mx, |y| <= my, |z| <= mz a determinant of three differences has a permanent of at
 * most 6 mx my mz and an error of at most 8 roundings of it; the sum of three and D come to 30. */
static void make_relative(const visibility_scene *scene, const double p[3], grid_scratch *g) {
    double mx = 0, my = 0, mz = 0;
    for (size_t i = 0; i < scene->vertex_count; i++) {
        g->x[i] = scene->x[i] - p[0];
        g->y[i] = scene->y[i] - p[1];
        g->z[i] = scene->z[i] - p[2];
        mx = larger(mx, fabs(g->x[i]));
        my = larger(my, fabs(g->y[i]));
        mz = larger(mz, fabs(g->z[i]));
    }
    g->bound = 6 * 32 * 0x1p-53 * mx * my * mz;
    if (!(g->bound > 1e-200))
        g->bound = INFINITY;
}

/* Without branches: the largest coordinate changes unpredictably from vertex to vertex. */
static void project(grid_scratch *g, uint32_t slot) {
    double d[5] = {g->x[slot], g->y[slot], g->z[slot], g->x[slot], g->y[slot]};
    double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]);
    int k = (ax < ay) | (ax < az);
    k += k & (ay < az);
    double scale = 1 / fabs(d[k]);
    float u = (float)(d[k + 1] * scale), v = (float)(d[k + 2] * scale);
    bool rim = !(fabsf(u) < 1 - CELL_MARGIN) | !(fabsf(v) < 1 - CELL_MARGIN);
    g->cube[slot].u = u;
    g->cube[slot].face = 2 * (uint32_t)k + (d[k] < 0) + (rim ? RIM : 0);
    g->v[slot] = v;
}

/* Cuts each cube face into rows of about equally many vertices, by a histogram of v. */
static void cut_rows(grid_scratch *g) {
    memset(g->row_of_bin, 0, sizeof g->row_of_bin);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        project(g, slot);
        g->row_of_bin[g->cube[slot].face % RIM][bin_of(g->v[slot])]++;
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

/* Gives each row twice as many cells as it has vertices. Returns the number of cells. */
static uint32_t cut_cells(grid_scratch *g) {
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        cube_point *c = &g->cube[slot];
        const uint32_t *rows = g->row_of_bin[c->face % RIM];
        float v = g->v[slot], u = c->u;
        c->row_low = rows[bin_of(v - CELL_MARGIN)];
        c->row_high = rows[bin_of(v + CELL_MARGIN)];
        g->place[slot] = rows[bin_of(v)];
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
        float width = row->u_high - row->u_low;
        row->scale = width > 0 ? (float)row->cell_count / width : 0;
        cells += row->cell_count;
    }
    return cells;
}

/* Counting sort; cell_start[c] is first the end of cell c, and its start when all are placed. */
static void sort_into_cells(const visibility_scene *scene, grid_scratch *g) {
    memset(g->hidden, 0, (starg_bit_words(scene->vertex_count) + 1) * sizeof *g->hidden);
    cut_rows(g);
    uint32_t cells = cut_cells(g);
    memset(g->cell_start, 0, (cells + 1) * sizeof *g->cell_start);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        g->place[slot] = cell_of(&g->rows[g->place[slot]], g->cube[slot].u);
        g->cell_start[g->place[slot]]++;
    }
    uint32_t sum = 0;
    for (size_t c = 0; c <= cells; c++)
        sum = g->cell_start[c] += sum;
    for (size_t i = g->used_count; i-- > 0;) {
        uint32_t slot = g->used[i], position = --g->cell_start[g->place[slot]];
        g->place[slot] = position;
        g->slot[position] = slot;
        g->sx[position] = g->x[slot];
        g->sy[position] = g->y[slot];
        g->sz[position] = g->z[slot];
    }
}

static int compare_chunks(const void *left, const void *right) {
    const chunk_distance *a = left, *b = right;
    if (a->distance != b->distance)
        return a->distance < b->distance ? -1 : 1;
    return (a->chunk > b->chunk) - (a->chunk < b->chunk);
}

/* Near chunks of faces hide most: the far ones then find little left to test. */
static size_t order_chunks(const visibility_scene *scene, grid_scratch *g) {
    size_t count = (scene->face_count + CHUNK - 1) / CHUNK;
    for (size_t c = 0; c < count; c++) {
        uint32_t slot = scene->corners[3 * (c * CHUNK)];
        g->chunks[c].chunk = (uint32_t)c;
        g->chunks[c].distance =
            g->x[slot] * g->x[slot] + g->y[slot] * g->y[slot] + g->z[slot] * g->z[slot];
    }
    qsort(g->chunks, count, sizeof *g->chunks, compare_chunks);
    return count;
}

/* Stage 1: lists the faces that can block first, and the vertices that they use. */
static void keep_faces(const visibility_scene *scene, const int8_t *side, grid_scratch *g) {
    size_t chunk_count = order_chunks(scene, g);
    g->kept_count = g->used_count = 0;
    memset(g->in_use, 0, scene->vertex_count);
    for (size_t c = 0; c < chunk_count; c++) {
        size_t rank = (size_t)g->chunks[c].chunk * CHUNK, end = rank + CHUNK;
        for (; rank < end && rank < scene->face_count; rank++) {
            uint8_t keep = !scene->cull || side[rank] > 0;
            const uint32_t *corner = scene->corners + 3 * rank;
            g->kept[g->kept_count] = (uint32_t)rank;
            g->kept_count += keep;
            g->in_use[corner[0]] |= keep;
            g->in_use[corner[1]] |= keep;
            g->in_use[corner[2]] |= keep;
        }
    }
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        g->used[g->used_count] = slot;
        g->used_count += g->in_use[slot];
    }
}

static bool supports(grid_form form) {
#if defined(__x86_64__)
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    return form == GRID_PLAIN || (avx2 && (form == GRID_AVX2 || avx512));
#else
    return form == GRID_PLAIN;
#endif
}

/* All forms give the same bits: what floating point does not decide beyond its error bound is
 * decided exactly. */
grid_test_faces *grid_choose_form(grid_form wanted) {
    static grid_test_faces *const forms[] = {
        grid_test_faces_plain,
#if defined(__x86_64__)
        grid_test_faces_avx2,
        grid_test_faces_avx512,
#endif
    };
    if (wanted == GRID_WIDEST)
        wanted = supports(GRID_AVX512) ? GRID_AVX512 : supports(GRID_AVX2) ? GRID_AVX2 : GRID_PLAIN;
    return supports(wanted) ? forms[wanted] : NULL;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, uint8_t *visible) {
    grid_scratch *g = scratch;
    make_relative(scene, p, g);
    keep_faces(scene, side, g);
    sort_into_cells(scene, g);
    g->test_faces(scene, p, side, g);
    for (size_t i = 0; i < scene->vertex_count; i++)
        visible[i] = g->in_use[i] && !starg_bit_test(g->hidden, g->place[i]);
}

const visibility_engine visibility_grid = {make_scratch, free_scratch, find};
