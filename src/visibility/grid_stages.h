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

/* Projects all vertices; without branches, so that the compiler takes several at a time. */
static void project(const visibility_scene *scene, grid_scratch *g) {
    const float rim = 1 - CELL_MARGIN;
    for (size_t i = 0; i < scene->vertex_count; i++) {
        double x = g->x[i], y = g->y[i], z = g->z[i];
        double ax = fabs(x), ay = fabs(y), az = fabs(z);
        bool by_x = (ax >= ay) & (ax >= az), by_y = ay >= az;
        double major = by_x ? x : by_y ? y : z;
        double first = by_x ? y : by_y ? z : x;
        double second = by_x ? z : by_y ? x : y;
        double scale = 1 / fabs(major);
        float u = (float)(first * scale), v = (float)(second * scale);
        uint32_t face = by_x ? 0 : by_y ? 2 : 4;
        bool inner = (fabsf(u) < rim) & (fabsf(v) < rim);
        g->u[i] = u;
        g->v[i] = v;
        g->cube_face[i] = face + (major < 0 ? 1 : 0) + (inner ? 0 : RIM);
    }
}

/* Cuts each cube face into rows of about equally many vertices, by a histogram of v. */
static void cut_rows(grid_scratch *g) {
    memset(g->row_of_bin, 0, sizeof g->row_of_bin);
    for (size_t i = 0; i < g->used_count; i++) {
        uint32_t slot = g->used[i];
        g->row_of_bin[g->cube_face[slot] % RIM][bin_of(g->v[slot])]++;
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
        const uint32_t *rows = g->row_of_bin[g->cube_face[slot] % RIM];
        float v = g->v[slot], u = g->u[slot];
        c->u = u;
        c->face = g->cube_face[slot];
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
        g->place[slot] = cell_of(&g->rows[g->place[slot]], g->u[slot]);
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
    out[0] = sign * (g->y[a] * g->z[b] - g->z[a] * g->y[b]);
    out[1] = sign * (g->z[a] * g->x[b] - g->x[a] * g->z[b]);
    out[2] = sign * (g->x[a] * g->y[b] - g->y[a] * g->x[b]);
}

/* With the sign of the side D is positive, and so are the planes inside the cone. */
static void prepare(const grid_scratch *g, blocker *f) {
    double sign = f->side > 0 ? 1 : -1;
    const uint32_t *c = f->corner;
    cross(g, c[1], c[2], sign, f->w0);
    cross(g, c[2], c[0], sign, f->w1);
    cross(g, c[0], c[1], sign, f->w2);
    f->volume = f->w0[0] * g->x[c[0]] + f->w0[1] * g->y[c[0]] + f->w0[2] * g->z[c[0]];
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
    *sure = lanes_above(least, g->bound);
    *maybe = lanes_above(least, -g->bound);
}

/* The same for a face in whose plane p lies: off that plane it hides nothing. */
static inline uint64_t test_coplanar_lanes(const grid_scratch *g, const blocker *f, size_t i) {
    lanes x = lanes_load(g->sx + i), y = lanes_load(g->sy + i), z = lanes_load(g->sz + i);
    double e = g->bound;
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

static void widen(float u, float span[2]) {
    span[0] = u < span[0] ? u : span[0];
    span[1] = u > span[1] ? u : span[1];
}

/* Where one edge of a projected triangle lies within a row: its ends there, and where it enters
 * and leaves. The slack covers the rounding of the slope, which counts where an edge is nearly
 * level; the ends bound it. */
static void span_edge(const float from[2], const float to[2], float v_low, float v_high,
                      float span[2]) {
    float u_low = from[0] < to[0] ? from[0] : to[0], u_high = from[0] < to[0] ? to[0] : from[0];
    float slope = (to[0] - from[0]) / (to[1] - from[1]);
    float slack = (fabsf(slope) + 1) * CELL_MARGIN;
    if (from[1] >= v_low && from[1] <= v_high)
        widen(from[0], span);
    for (int side = 0; side < 2; side++) {
        float v = side ? v_high : v_low;
        if ((from[1] < v) == (to[1] < v))
            continue;
        float u = from[0] + (v - from[1]) * slope;
        widen(u - slack > u_low ? u - slack : u_low, span);
        widen(u + slack < u_high ? u + slack : u_high, span);
    }
}

/* A convex polygon on one cube face: a face, or the part of one that lies before the cube face. */
typedef struct cube_polygon {
    int count;
    float corner[8][2]; /* u, v */
} cube_polygon;

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
        polygon.corner[k][0] = g->u[f->corner[k]];
        polygon.corner[k][1] = g->v[f->corner[k]];
    }
    test_polygon(scene, p, g, f, &polygon, row, last_row);
}

/* Vectors from p with the cube face's axis first, then u and v. */
typedef struct cone_polygon {
    int count;
    double corner[8][3];
} cone_polygon;

/* The sides of a widened frustum, as planes through p: axis x SLACK - sign x coordinate k. */
static const double SLACK = 1 + 0x1p-18;

static double beyond_side(const double v[3], int plane) {
    return SLACK * v[0] - (plane % 2 ? -v[1 + plane / 2] : v[1 + plane / 2]);
}

/* Cuts off what lies outside one side. */
static void clip_cone(const cone_polygon *in, int plane, cone_polygon *out) {
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->corner[i], *b = in->corner[(i + 1) % in->count];
        double at_a = beyond_side(a, plane), at_b = beyond_side(b, plane);
        if (at_a >= 0)
            memcpy(out->corner[out->count++], a, sizeof out->corner[0]);
        if ((at_a >= 0) == (at_b >= 0))
            continue;
        double t = at_a / (at_a - at_b);
        for (int j = 0; j < 3; j++)
            out->corner[out->count][j] = a[j] + t * (b[j] - a[j]);
        out->count++;
    }
}

/* The part of a face in the frustum of a cube face: mostly nothing, which one side tells, or what
 * a single side cuts off. */
static void clip_to_frustum(cone_polygon *polygon) {
    cone_polygon clipped;
    bool cut[4];
    if (polygon->corner[0][0] <= 0 && polygon->corner[1][0] <= 0 && polygon->corner[2][0] <= 0) {
        polygon->count = 0;
        return;
    }
    for (int plane = 0; plane < 4; plane++) {
        int outside = 0;
        for (int i = 0; i < 3; i++)
            outside += beyond_side(polygon->corner[i], plane) < 0;
        if (outside == 3) {
            polygon->count = 0;
            return;
        }
        cut[plane] = outside > 0;
    }
    for (int plane = 0; plane < 4; plane++)
        if (cut[plane]) {
            clip_cone(polygon, plane, &clipped);
            *polygon = clipped;
        }
}

/* The same on the cube face. Corners that come so near to p that their direction is not known
 * within the margin are told by `whole`. */
static void clip_to_cube_face(const grid_scratch *g, const uint32_t *corner, uint32_t cube_face,
                              cube_polygon *polygon, bool *whole) {
    const double *const axis[3] = {g->x, g->y, g->z};
    uint32_t k = cube_face / 2;
    double sign = cube_face % 2 ? -1 : 1, size = 0;
    cone_polygon cone = {.count = 3};
    for (int i = 0; i < 3; i++) {
        cone.corner[i][0] = sign * axis[k][corner[i]];
        cone.corner[i][1] = axis[(k + 1) % 3][corner[i]];
        cone.corner[i][2] = axis[(k + 2) % 3][corner[i]];
        for (int j = 0; j < 3; j++)
            size = fabs(cone.corner[i][j]) > size ? fabs(cone.corner[i][j]) : size;
    }
    clip_to_frustum(&cone);
    polygon->count = cone.count;
    *whole = false;
    for (int i = 0; i < cone.count; i++) {
        *whole = *whole || !(cone.corner[i][0] > 0x1p-20 * size);
        polygon->corner[i][0] = (float)(cone.corner[i][1] / cone.corner[i][0]);
        polygon->corner[i][1] = (float)(cone.corner[i][2] / cone.corner[i][0]);
    }
}

/* A face that does not project into one cube face. */
static void test_clipped(const visibility_scene *scene, const double p[3], grid_scratch *g,
                         blocker *f) {
    for (uint32_t cube_face = 0; cube_face < CUBE_FACES; cube_face++) {
        const uint32_t *rows = g->row_of_bin[cube_face];
        cube_polygon polygon;
        bool whole;
        clip_to_cube_face(g, f->corner, cube_face, &polygon, &whole);
        if (polygon.count == 0)
            continue;
        if (whole) {
            test_rows(scene, p, g, f, rows[0], rows[BINS - 1], -1, 1);
            continue;
        }
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

static void test_faces(const visibility_scene *scene, const double p[3], const int8_t *side,
                       grid_scratch *g) {
    for (size_t i = 0; i < g->kept_count; i++) {
        size_t rank = g->kept[i];
        blocker f = {.rank = rank, .side = side[rank], .corner = scene->corners + 3 * rank};
        test_face(scene, p, g, &f);
    }
}

void GRID_RUN(const visibility_scene *scene, grid_scratch *g, const double p[3], const int8_t *side,
              uint8_t *visible) {
    make_relative(scene, p, g);
    keep_faces(scene, side, g);
    project(scene, g);
    sort_into_cells(scene, g);
    test_faces(scene, p, side, g);
    for (size_t i = 0; i < scene->vertex_count; i++)
        visible[i] = g->in_use[i] && !starg_bit_test(g->hidden, g->place[i]);
}
