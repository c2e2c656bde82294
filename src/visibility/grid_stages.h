/* The stages of the direction grid (visibility/grid.c), written once and compiled for each
 * instruction set: the including file names the function and chooses the lanes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bits.h"
#include "visibility/grid.h"
#include "visibility/lanes.h"

/* Positions that are tested at once: what can be cut out of the bits of `hidden` in one piece. */
enum { RUN = 56 };

/* From so many rows on a face's edges are followed from row to row. */
enum { TALL = 6 };

/* Cuts each cube face into rows of about equally many vertices, by a histogram of v. */
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

/* Gives each row twice as many cells as it has vertices. Returns the number of cells. */
static uint32_t cut_cells(grid_scratch *g) {
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        cube_point *c = &g->cube[slot];
        const uint32_t *rows = g->row_of_bin[g->at.face[slot] % RIM];
        float v = g->at.v[slot], u = g->at.u[slot];
        c->u = u;
        c->face = g->at.face[slot];
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
        row->last_cell = (float)(row->cell_count - 1);
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

/* Near chunks of faces hide most: the far ones then find little left to test. */
static size_t order_chunks(const visibility_scene *scene, grid_scratch *g) {
    size_t count = (scene->face_count + CHUNK - 1) / CHUNK;
    for (size_t c = 0; c < count; c++) {
        uint32_t slot = scene->corners[3 * (c * CHUNK)];
        g->chunks[c].chunk = (uint32_t)c;
        g->chunks[c].distance = g->at.x[slot] * g->at.x[slot] + g->at.y[slot] * g->at.y[slot] +
                                g->at.z[slot] * g->at.z[slot];
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

/* A face as the inner loop needs it. */
typedef struct blocker {
    size_t rank;
    int side;
    const uint32_t *corner;
    bool prepared;
    double w0[3], w1[3], w2[3]; /* planes through p and an edge, positive inside the cone */
    double volume;              /* D */
} blocker;

static void cross(const grid_scratch *g, uint32_t a, uint32_t b, double sign, double out[3]) {
    out[0] = sign * (g->at.y[a] * g->at.z[b] - g->at.z[a] * g->at.y[b]);
    out[1] = sign * (g->at.z[a] * g->at.x[b] - g->at.x[a] * g->at.z[b]);
    out[2] = sign * (g->at.x[a] * g->at.y[b] - g->at.y[a] * g->at.x[b]);
}

/* With the sign of the side D is positive, and so are the planes inside the cone. */
static void prepare(const grid_scratch *g, blocker *f) {
    double sign = f->side > 0 ? 1 : -1;
    const uint32_t *c = f->corner;
    cross(g, c[1], c[2], sign, f->w0);
    cross(g, c[2], c[0], sign, f->w1);
    cross(g, c[0], c[1], sign, f->w2);
    f->volume = f->w0[0] * g->at.x[c[0]] + f->w0[1] * g->at.y[c[0]] + f->w0[2] * g->at.z[c[0]];
    f->prepared = true;
}

/* Which of LANES vertices from `i` on are certainly hidden, and which may be? */
static inline void test_lanes(const grid_scratch *g, const blocker *f, size_t i, uint64_t *sure,
                              uint64_t *maybe) {
    lanes x = lanes_load(g->sx + i), y = lanes_load(g->sy + i), z = lanes_load(g->sz + i);
    lanes w0 = lanes_dot(f->w0, x, y, z), w1 = lanes_dot(f->w1, x, y, z);
    lanes w2 = lanes_dot(f->w2, x, y, z);
    lanes beyond = lanes_beyond(w0, w1, w2, f->volume);
    lanes least = lanes_min(lanes_min(w0, w1), lanes_min(w2, beyond));
    *sure = lanes_above(least, g->at.bound);
    *maybe = lanes_above(least, -g->at.bound);
}

/* The same for a face in whose plane p lies: off that plane it hides nothing. */
static inline uint64_t test_coplanar_lanes(const grid_scratch *g, const blocker *f, size_t i) {
    lanes x = lanes_load(g->sx + i), y = lanes_load(g->sy + i), z = lanes_load(g->sz + i);
    double e = g->at.bound;
    return ~(lanes_beyond_either(lanes_dot(f->w0, x, y, z), e) |
             lanes_beyond_either(lanes_dot(f->w1, x, y, z), e) |
             lanes_beyond_either(lanes_dot(f->w2, x, y, z), e)) &
           ((UINT64_C(1) << LANES) - 1);
}

/* `count` <= RUN bits of the hidden ones from position `begin` on. */
static inline uint64_t hidden_bits(const grid_scratch *g, size_t begin) {
    uint64_t word;
    memcpy(&word, (const uint8_t *)g->hidden + begin / 8, sizeof word);
    return word >> (begin % 8);
}

static void decide_exactly(const visibility_scene *scene, const double p[3], grid_scratch *g,
                           const blocker *f, size_t begin, uint64_t maybe) {
    if (f->side != 0)
        for (int k = 0; k < 3; k++) {
            size_t own = g->place[f->corner[k]] - begin;
            if (own < RUN)
                maybe &= ~(UINT64_C(1) << own);
        }
    STARG_FOR_BITS (bit, maybe) {
        if (scene_blocks(scene, f->rank, f->side, p, g->slot[begin + bit]))
            starg_bit_set(g->hidden, begin + bit);
    }
}

static void test_run(const visibility_scene *scene, const double p[3], grid_scratch *g, blocker *f,
                     size_t begin, size_t count) {
    uint64_t live = ~hidden_bits(g, begin) & ((UINT64_C(1) << count) - 1), sure = 0, maybe = 0;
    if (live == 0)
        return;
    if (!f->prepared)
        prepare(g, f);
    for (size_t i = 0; i < count; i += LANES) {
        if ((live >> i & ((1 << LANES) - 1)) == 0)
            continue;
        uint64_t s = 0, m;
        if (f->side != 0)
            test_lanes(g, f, begin + i, &s, &m);
        else
            m = test_coplanar_lanes(g, f, begin + i);
        sure |= s << i;
        maybe |= m << i;
    }
    sure &= live;
    maybe &= live & ~sure;
    STARG_FOR_BITS (bit, sure) {
        starg_bit_set(g->hidden, begin + bit);
        g->hider[g->slot[begin + bit]] = (uint32_t)f->rank;
    }
    if (maybe != 0)
        decide_exactly(scene, p, g, f, begin, maybe);
}

static inline void test_cells(const visibility_scene *scene, const double p[3], grid_scratch *g,
                              blocker *f, const grid_row *row, float u_low, float u_high) {
    size_t begin = g->cell_start[cell_of(row, u_low - CELL_MARGIN)];
    size_t end = g->cell_start[cell_of(row, u_high + CELL_MARGIN) + 1];
    for (; begin < end; begin += RUN)
        test_run(scene, p, g, f, begin, end - begin < RUN ? end - begin : RUN);
}

/* Tests the cells between two values of u in some rows. */
static inline void test_rows(const visibility_scene *scene, const double p[3], grid_scratch *g,
                             blocker *f, uint32_t row, uint32_t last_row, float u_low,
                             float u_high) {
    for (; row <= last_row; row++)
        test_cells(scene, p, g, f, &g->rows[row], u_low, u_high);
}

/* In each row only the cells between the polygon's edges. */
static void test_polygon(const visibility_scene *scene, const double p[3], grid_scratch *g,
                         blocker *f, const cube_polygon *polygon, uint32_t row, uint32_t last_row) {
    for (; row <= last_row; row++) {
        const grid_row *r = &g->rows[row];
        float span[2] = {2, -2};
        for (int k = 0; k < polygon->count; k++)
            span_edge(polygon->corner[k], polygon->corner[(k + 1) % polygon->count],
                      r->v_low - CELL_MARGIN, r->v_high + CELL_MARGIN, span);
        if (span[0] <= span[1])
            test_cells(scene, p, g, f, r, span[0], span[1]);
    }
}

/* A tall face that projects into one cube face. */
static void test_tall(const visibility_scene *scene, const double p[3], grid_scratch *g, blocker *f,
                      uint32_t row, uint32_t last_row) {
    cube_polygon polygon = {.count = 3};
    for (int k = 0; k < 3; k++) {
        polygon.corner[k][0] = g->at.u[f->corner[k]];
        polygon.corner[k][1] = g->at.v[f->corner[k]];
    }
    test_polygon(scene, p, g, f, &polygon, row, last_row);
}

/* A face that does not project into one cube face. */
static void test_clipped(const visibility_scene *scene, const double p[3], grid_scratch *g,
                         blocker *f) {
    bool near = triangle_is_near(&g->at, f->corner);
    for (uint32_t cube_face = 0; cube_face < CUBE_FACES; cube_face++) {
        const uint32_t *rows = g->row_of_bin[cube_face];
        cube_polygon polygon;
        if (near) {
            test_rows(scene, p, g, f, rows[0], rows[BINS - 1], -2, 2);
            continue;
        }
        cube_clip_triangle(&g->at, f->corner, cube_face, &polygon);
        if (polygon.count == 0)
            continue;
        float low = 2, high = -2;
        for (int i = 0; i < polygon.count; i++) {
            float v = polygon.corner[i][1];
            low = v < low ? v : low;
            high = v > high ? v : high;
        }
        test_polygon(scene, p, g, f, &polygon, rows[bin_of(low - CELL_MARGIN)],
                     rows[bin_of(high + CELL_MARGIN)]);
    }
}

static float min3(float a, float b, float c) {
    float m = a < b ? a : b;
    return m < c ? m : c;
}

static float max3(float a, float b, float c) {
    float m = a > b ? a : b;
    return m > c ? m : c;
}

static uint32_t least_row(const cube_point *a, const cube_point *b, const cube_point *c) {
    uint32_t row = a->row_low < b->row_low ? a->row_low : b->row_low;
    return row < c->row_low ? row : c->row_low;
}

static uint32_t last_row(const cube_point *a, const cube_point *b, const cube_point *c) {
    uint32_t row = a->row_high > b->row_high ? a->row_high : b->row_high;
    return row > c->row_high ? row : c->row_high;
}

static void test_face(const visibility_scene *scene, const double p[3], grid_scratch *g,
                      blocker *f) {
    const cube_point *a = &g->cube[f->corner[0]], *b = &g->cube[f->corner[1]];
    const cube_point *c = &g->cube[f->corner[2]];
    if (a->face != b->face || b->face != c->face || a->face >= RIM) {
        test_clipped(scene, p, g, f);
        return;
    }
    uint32_t first = least_row(a, b, c), last = last_row(a, b, c);
    if (last - first < TALL)
        test_rows(scene, p, g, f, first, last, min3(a->u, b->u, c->u), max3(a->u, b->u, c->u));
    else
        test_tall(scene, p, g, f, first, last);
}

/* Does one face certainly hide all three corners, and so the whole face? */
static inline bool is_behind_one(const grid_scratch *g, const uint32_t corner[3]) {
    uint32_t hider = g->hider[corner[0]];
    return hider != SCENE_NONE && hider == g->hider[corner[1]] && hider == g->hider[corner[2]];
}

static void test_faces(const visibility_scene *scene, const double p[3], const int8_t *side,
                       grid_scratch *g) {
    for (size_t slot = 0; slot < scene->vertex_count; slot++)
        g->hider[slot] = SCENE_NONE;
    for (size_t i = 0; i < g->kept_count; i++) {
        size_t rank = g->kept[i];
        if (is_behind_one(g, scene->corners + 3 * rank))
            continue;
        blocker f = {.rank = rank, .side = side[rank], .corner = scene->corners + 3 * rank};
        test_face(scene, p, g, &f);
    }
}

void GRID_RUN(const visibility_scene *scene, grid_scratch *g, const double p[3], const int8_t *side,
              uint8_t *visible) {
    cube_make_relative(scene, p, &g->at);
    keep_faces(scene, side, g);
    cube_project(scene->vertex_count, &g->at);
    sort_into_cells(scene, g);
    test_faces(scene, p, side, g);
    for (size_t i = 0; i < scene->vertex_count; i++)
        visible[i] = g->in_use[i] && !starg_bit_test(g->hidden, g->place[i]);
}
