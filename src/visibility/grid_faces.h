/* Stage 3 of the direction grid, written once over LANES doubles at a time and compiled for each
 * instruction set: the including file names the function and chooses the lanes. */
#include <math.h>
#include <string.h>

#include "core/bits.h"
#include "visibility/grid.h"
#include "visibility/lanes.h"

/* Positions that are tested at once: what can be cut out of the bits of `hidden` in one piece. */
enum { RUN = 56 };

/* From so many rows on a face's edges are followed from row to row. */
enum { TALL = 3 };

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
        polygon.corner[k][0] = g->cube[f->corner[k]].u;
        polygon.corner[k][1] = g->v[f->corner[k]];
    }
    test_polygon(scene, p, g, f, &polygon, row, last_row);
}

/* Vectors from p with the cube face's axis first, then u and v. */
typedef struct cone_polygon {
    int count;
    double corner[8][3];
} cone_polygon;

/* What lies on the near side of a plane through p: axis x SLACK >= sign x coordinate k. */
static void clip_cone(const cone_polygon *in, int k, double sign, cone_polygon *out) {
    static const double SLACK = 1 + 0x1p-18;
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->corner[i], *b = in->corner[(i + 1) % in->count];
        double at_a = SLACK * a[0] - sign * a[k], at_b = SLACK * b[0] - sign * b[k];
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

/* The part of a face in the frustum of a cube face, which is a little widened. Corners that come
 * so near to p that their direction is not known within the margin are told by `whole`. */
static void clip_to_cube_face(const grid_scratch *g, const uint32_t *corner, uint32_t cube_face,
                              cube_polygon *polygon, bool *whole) {
    const double *const axis[3] = {g->x, g->y, g->z};
    uint32_t k = cube_face / 2;
    double sign = cube_face % 2 ? -1 : 1, size = 0;
    cone_polygon a = {.count = 3}, b;
    for (int i = 0; i < 3; i++) {
        a.corner[i][0] = sign * axis[k][corner[i]];
        a.corner[i][1] = axis[(k + 1) % 3][corner[i]];
        a.corner[i][2] = axis[(k + 2) % 3][corner[i]];
        for (int j = 0; j < 3; j++)
            size = fabs(a.corner[i][j]) > size ? fabs(a.corner[i][j]) : size;
    }
    clip_cone(&a, 1, 1, &b);
    clip_cone(&b, 1, -1, &a);
    clip_cone(&a, 2, 1, &b);
    clip_cone(&b, 2, -1, &a);
    polygon->count = a.count;
    *whole = false;
    for (int i = 0; i < a.count; i++) {
        *whole = *whole || !(a.corner[i][0] > 0x1p-20 * size);
        polygon->corner[i][0] = (float)(a.corner[i][1] / a.corner[i][0]);
        polygon->corner[i][1] = (float)(a.corner[i][2] / a.corner[i][0]);
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

void GRID_TEST_FACES(const visibility_scene *scene, const double p[3], const int8_t *side,
                     grid_scratch *g) {
    for (size_t i = 0; i < g->kept_count; i++) {
        size_t rank = g->kept[i];
        blocker f = {.rank = rank, .side = side[rank], .corner = scene->corners + 3 * rank};
        test_face(scene, p, g, &f);
    }
}
