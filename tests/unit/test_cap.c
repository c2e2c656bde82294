/* SPDX-License-Identifier: Apache-2.0 */
/* Filling plane loops: areas, edges and orientation of the triangles against those of the loops,
 * for random rings with holes and islands, in random planes; and invalid loops. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "star/certified/partition.h"

enum { POINTS_MOST = 1200, LOOPS_MOST = 90 };

static const double TWO_PI = 6.283185307179586;

/* Loops in a plane: (u, v) along two directions orthogonal to the normal. */
typedef struct drawing {
    double normal[3], along[2][3], origin[3];
    double points[3 * POINTS_MOST];
    size_t point_count, loop_count, outlines;
    uint32_t corners[POINTS_MOST], starts[LOOPS_MOST + 1];
} drawing;

/* ---- planes ---- */

static void normalize(double a[3]) {
    double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int k = 0; k < 3; k++)
        a[k] /= length;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static drawing random_plane(starg_rng *rng) {
    drawing d = {.point_count = 0};
    double other[3];
    for (int k = 0; k < 3; k++) {
        d.normal[k] = 2 * starg_rng_unit(rng) - 1;
        other[k] = 2 * starg_rng_unit(rng) - 1;
        d.origin[k] = 2 * starg_rng_unit(rng) - 1;
    }
    normalize(d.normal);
    cross(d.normal, other, d.along[0]);
    normalize(d.along[0]);
    cross(d.normal, d.along[0], d.along[1]);
    return d;
}

/* One of the six sides of a cube: keeps coordinates exactly. */
static drawing straight_plane(int side) {
    drawing d = {.point_count = 0};
    int axis = side % 3;
    bool back = side >= 3;
    d.normal[axis] = back ? -1 : 1;
    d.along[0][(axis + (back ? 2 : 1)) % 3] = 1;
    d.along[1][(axis + (back ? 1 : 2)) % 3] = 1;
    d.origin[axis] = 5;
    return d;
}

/* ---- loops ---- */

static void add_point(drawing *d, double u, double v) {
    assert_true(d->point_count < POINTS_MOST);
    for (int k = 0; k < 3; k++)
        d->points[3 * d->point_count + (size_t)k] =
            d->origin[k] + u * d->along[0][k] + v * d->along[1][k];
    d->corners[d->point_count] = (uint32_t)d->point_count;
    d->point_count++;
}

/* Makes a loop of the points since the last one. */
static void end_loop(drawing *d, bool hole) {
    assert_true(d->loop_count < LOOPS_MOST);
    d->starts[++d->loop_count] = (uint32_t)d->point_count;
    d->outlines += !hole;
}

/* A loop around (u, v) between the radii 0.7 and 1 times `radius`. */
static void add_ring(drawing *d, starg_rng *rng, double u, double v, double radius, bool hole) {
    size_t count = 6 + (size_t)starg_rng_below(rng, 9);
    double phase = TWO_PI * starg_rng_unit(rng);
    for (size_t i = 0; i < count; i++) {
        double at = (double)i + 0.5 * (starg_rng_unit(rng) - 0.5);
        double angle = phase + (hole ? -1 : 1) * TWO_PI * at / (double)count;
        double r = radius * (0.7 + 0.3 * starg_rng_unit(rng));
        add_point(d, u + r * cos(angle), v + r * sin(angle));
    }
    end_loop(d, hole);
}

/* A ring, one to three rings of the opposite orientation in it, and so on. Corners of a ring are
 * less than 94 degrees apart, so it contains a disc of at least 0.7 cos 47 degrees of the
 * radius. */
static void add_nested(drawing *d, starg_rng *rng, double u, double v, double radius, int depth) {
    add_ring(d, rng, u, v, radius, depth % 2 == 1);
    if (depth == 3 || starg_rng_below(rng, 5) == 0)
        return;
    size_t count = 1 + (size_t)starg_rng_below(rng, 3);
    double inner = 0.47 * radius, phase = TWO_PI * starg_rng_unit(rng);
    if (count == 1) {
        add_nested(d, rng, u, v, 0.9 * inner, depth + 1);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        double angle = phase + TWO_PI * (double)i / (double)count;
        add_nested(d, rng, u + 0.54 * inner * cos(angle), v + 0.54 * inner * sin(angle),
                   0.44 * inner, depth + 1);
    }
}

/* The order of loops and their starts do not matter. */
static void shuffle_loops(drawing *d, starg_rng *rng) {
    drawing old = *d;
    size_t order[LOOPS_MOST];
    for (size_t i = 0; i < d->loop_count; i++) {
        size_t j = (size_t)starg_rng_below(rng, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    for (size_t i = 0; i < d->loop_count; i++) {
        uint32_t first = old.starts[order[i]], count = old.starts[order[i] + 1] - first;
        uint32_t shift = (uint32_t)starg_rng_below(rng, count);
        for (uint32_t k = 0; k < count; k++)
            d->corners[d->starts[i] + k] = old.corners[first + (k + shift) % count];
        d->starts[i + 1] = d->starts[i] + count;
    }
}

/* ---- requirements of a filling ---- */

/* Twice the area of a, b, c, seen against the normal. */
static long double area_of(const drawing *d, uint32_t a, uint32_t b, uint32_t c) {
    const double *p = d->points + 3 * a, *q = d->points + 3 * b, *r = d->points + 3 * c;
    long double sum = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        long double n = ((long double)q[u] - p[u]) * ((long double)r[v] - p[v]) -
                        ((long double)q[v] - p[v]) * ((long double)r[u] - p[u]);
        sum += d->normal[k] * n;
    }
    return sum;
}

static long double area_inside(const drawing *d) {
    long double sum = 0;
    for (size_t l = 0; l < d->loop_count; l++)
        for (uint32_t i = d->starts[l] + 1; i + 1 < d->starts[l + 1]; i++)
            sum += area_of(d, d->corners[d->starts[l]], d->corners[i], d->corners[i + 1]);
    return sum;
}

/* Every edge of a loop occurs once more in its direction than in the other; all other edges equally
 * often in both. `exactly`: no more than that. */
static void check_edges(const drawing *d, const cap_indices *triangles, bool exactly) {
    size_t n = d->point_count;
    uint8_t *edges = calloc(n * n + 1, sizeof *edges);
    int8_t *loops = calloc(n * n + 1, sizeof *loops);
    assert_non_null(edges);
    assert_non_null(loops);
    for (size_t i = 0; i < triangles->count; i++) {
        size_t a = triangles->data[i], b = triangles->data[i % 3 == 2 ? i - 2 : i + 1];
        edges[n * a + b]++;
    }
    for (size_t l = 0; l < d->loop_count; l++)
        for (uint32_t i = d->starts[l]; i < d->starts[l + 1]; i++) {
            size_t a = d->corners[i];
            size_t b = d->corners[i + 1 == d->starts[l + 1] ? d->starts[l] : i + 1];
            loops[n * a + b]++;
            loops[n * b + a]--;
        }
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++) {
            int there = edges[n * a + b], back = edges[n * b + a];
            assert_int_equal(there - back, loops[n * a + b]);
            if (exactly)
                assert_true(there <= 1);
        }
    free(edges);
    free(loops);
}

static int turn(const drawing *d, uint32_t a, uint32_t b, uint32_t c) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        axis = fabs(d->normal[k]) > fabs(d->normal[axis]) ? k : axis;
    int sign = oracle_orient2d(d->points + 3 * a, d->points + 3 * b, d->points + 3 * c,
                               (axis + 1) % 3, (axis + 2) % 3);
    return d->normal[axis] < 0 ? -sign : sign;
}

/* Positively oriented triangles with the loops as boundary fill the interior of the loops; the area
 * shows how often. */
static void check_filling(const drawing *d, const cap_indices *triangles) {
    long double sum = 0, inside = area_inside(d);
    assert_int_equal(triangles->count % 3, 0);
    assert_int_equal(triangles->count / 3,
                     d->point_count + 2 * (d->loop_count - d->outlines) - 2 * d->outlines);
    for (size_t i = 0; i < triangles->count; i += 3) {
        const uint32_t *t = triangles->data + i;
        assert_int_equal(turn(d, t[0], t[1], t[2]), 1);
        long double area = area_of(d, t[0], t[1], t[2]);
        assert_true(area > 0);
        sum += area;
    }
    assert_true(inside > 0);
    assert_true(fabsl(sum - inside) < 1e-12L * inside);
    check_edges(d, triangles, true);
}

static int by_ends(const void *x, const void *y) {
    const constrained_edge *a = x, *b = y;
    if (a->from != b->from)
        return a->from < b->from ? -1 : 1;
    return (a->to > b->to) - (a->to < b->to);
}

/* The edges of all loops, each once. */
static starg_status fill_loops(starg_context *context, const drawing *d, cap_indices *triangles,
                               bool *done) {
    static constrained_edge edges[POINTS_MOST];
    const cap_indices none = {0};
    size_t count = 0, kept = 0;
    for (size_t l = 0; l < d->loop_count; l++)
        for (uint32_t i = d->starts[l]; i < d->starts[l + 1]; i++) {
            uint32_t a = d->corners[i];
            uint32_t b = d->corners[i + 1 == d->starts[l + 1] ? d->starts[l] : i + 1];
            edges[count++] = a < b ? (constrained_edge){a, b, 1} : (constrained_edge){b, a, -1};
        }
    qsort(edges, count, sizeof *edges, by_ends);
    for (size_t i = 0; i < count; i++)
        if (kept > 0 && by_ends(&edges[kept - 1], &edges[i]) == 0)
            edges[kept - 1].turns += edges[i].turns;
        else
            edges[kept++] = edges[i];
    const cap_edges all = {.data = edges, .count = kept};
    return cap_fill(context, d->points, d->normal, &all, &none, triangles, done);
}

static bool fill(starg_context *context, const drawing *d, cap_indices *triangles) {
    bool done = false;
    test_ok(context, fill_loops(context, d, triangles, &done));
    return done;
}

static void check_drawing(starg_context *context, const drawing *d) {
    cap_indices triangles = {0};
    assert_true(fill(context, d, &triangles));
    check_filling(d, &triangles);
    STARG_ARRAY_FREE(context, &triangles);
}

/* ---- tests ---- */

static void test_rings(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t holes = 0, islands = 0;
    for (uint64_t seed = 0; seed < 200; seed++) {
        starg_rng rng = starg_rng_make(seed, 61, 0);
        drawing d = random_plane(&rng);
        size_t apart = 1 + (size_t)starg_rng_below(&rng, 2);
        for (size_t i = 0; i < apart; i++)
            add_nested(&d, &rng, 2.5 * (double)i, 0, 1, 0);
        shuffle_loops(&d, &rng);
        holes += d.loop_count - d.outlines;
        islands += d.outlines - apart;
        check_drawing(context, &d);
    }
    assert_true(holes > 300 && islands > 300);
    test_context_free(context);
}

static void add_steps(drawing *d, const int (*steps)[2], size_t count, bool hole) {
    for (size_t i = 0; i < count; i++)
        add_point(d, steps[i][0], steps[i][1]);
    end_loop(d, hole);
}

/* Teeth whose ends lie on two lines, above a bar with square holes and a square in one of them:
 * many exactly collinear corners. */
static void add_comb(drawing *d, int teeth, int hole_at) {
    static const int square[4][2] = {{0, 0}, {0, 4}, {4, 4}, {4, 0}};
    int width = 8 * teeth;
    add_point(d, 0, 0);
    add_point(d, width - 4, 0);
    for (int i = teeth - 1; i >= 0; i--) {
        add_point(d, 8 * i + 4, i == teeth - 1 ? 40 : 8);
        if (i < teeth - 1)
            add_point(d, 8 * i + 4, 40);
        add_point(d, 8 * i, 40);
        if (i > 0)
            add_point(d, 8 * i, 8);
    }
    end_loop(d, false);
    for (int h = 0; h + 1 < teeth; h += hole_at) {
        for (int i = 0; i < 4; i++)
            add_point(d, 8 * h + 2 + square[i][0], 2 + square[i][1]);
        end_loop(d, true);
    }
    for (int i = 3; i >= 0; i--)
        add_point(d, 3 + square[i][0] / 2, 3 + square[i][1] / 2);
    end_loop(d, false);
}

static void test_combs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int side = 0; side < 6; side++)
        for (int teeth = 2; teeth < 12; teeth++) {
            starg_rng rng = starg_rng_make((uint64_t)teeth, 62, 0);
            drawing d = straight_plane(side);
            add_comb(&d, teeth, 1 + teeth % 2);
            shuffle_loops(&d, &rng);
            check_drawing(context, &d);
        }
    test_context_free(context);
}

/* ---- walls ---- */

/* A hall of 40 x 40 with slits in its floor and free-standing thin walls. */
typedef struct hall {
    int slit_count, slits[10][2]; /* place, height */
    int wall_count, walls[12][4]; /* x, y, width, height */
} hall;

static bool is_apart(const int *a, const int *b) {
    return a[0] > b[0] + b[2] || b[0] > a[0] + a[2] || a[1] > b[1] + b[3] || b[1] > a[1] + a[3];
}

static void add_wall(hall *h, starg_rng *rng) {
    int *wall = h->walls[h->wall_count], length = 1 + (int)starg_rng_below(rng, 30);
    bool upright = starg_rng_below(rng, 2) == 0;
    wall[2] = upright ? 1 : length;
    wall[3] = upright ? length : 1;
    wall[0] = 1 + (int)starg_rng_below(rng, (uint64_t)(39 - wall[2]));
    wall[1] = 1 + (int)starg_rng_below(rng, (uint64_t)(39 - wall[3]));
    bool apart = true;
    for (int i = 0; i < h->wall_count; i++)
        apart = apart && is_apart(wall, h->walls[i]);
    for (int i = 0; i < h->slit_count; i++) {
        const int slit[4] = {h->slits[i][0], 0, 1, h->slits[i][1]};
        apart = apart && is_apart(wall, slit);
    }
    h->wall_count += apart;
}

static hall random_hall(starg_rng *rng) {
    hall h = {.slit_count = 0};
    for (int x = 2; x < 37 && h.slit_count < 10; x += 3 + (int)starg_rng_below(rng, 12)) {
        h.slits[h.slit_count][0] = x;
        h.slits[h.slit_count++][1] = 1 + (int)starg_rng_below(rng, 37);
    }
    for (int attempt = 0; attempt < 60 && h.wall_count < 12; attempt++)
        add_wall(&h, rng);
    return h;
}

static double shaken(starg_rng *rng, int at, double by) {
    return at + by * (starg_rng_unit(rng) - 0.5);
}

static void draw_hall(drawing *d, const hall *h, starg_rng *rng, double by) {
    static const int corner[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    add_point(d, 0, 0);
    for (int i = 0; i < h->slit_count; i++)
        for (int k = 0; k < 4; k++)
            add_point(d, shaken(rng, h->slits[i][0] + corner[k][0], by),
                      shaken(rng, h->slits[i][1] * corner[k][1], by));
    add_point(d, 40, 0);
    add_point(d, 40, 40);
    add_point(d, 0, 40);
    end_loop(d, false);
    for (int i = 0; i < h->wall_count; i++) {
        for (int k = 0; k < 4; k++)
            add_point(d, shaken(rng, h->walls[i][0] + h->walls[i][2] * corner[k][0], by),
                      shaken(rng, h->walls[i][1] + h->walls[i][3] * corner[k][1], by));
        end_loop(d, true);
    }
}

/* The nearest corners do not see one another there; many are collinear, or nearly so. */
static void test_halls(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t walls = 0;
    for (uint64_t seed = 0; seed < 300; seed++) {
        starg_rng rng = starg_rng_make(seed, 67, 0);
        drawing d = seed % 2 == 0 ? random_plane(&rng) : straight_plane((int)(seed / 2 % 6));
        hall h = random_hall(&rng);
        draw_hall(&d, &h, &rng, seed % 2 == 0 ? 0.5 : 0);
        shuffle_loops(&d, &rng);
        walls += (size_t)h.wall_count;
        check_drawing(context, &d);
    }
    assert_true(walls > 1000);
    test_context_free(context);
}

/* Corners in the middle of straight edges, as left by splits of facets. */
static void test_straight_corners(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int side = 0; side < 6; side++)
        for (int steps = 1; steps < 8; steps++) {
            starg_rng rng = starg_rng_make((uint64_t)steps, 63, 0);
            drawing d = straight_plane(side);
            for (int hole = 0; hole < 2; hole++) {
                static const int corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
                double size = hole == 1 ? 2 : 8;
                for (int i = 0; i < 4; i++)
                    for (int s = 0; s < steps; s++) {
                        const int *a = corner[hole ? 3 - i : i];
                        const int *b = corner[hole ? (6 - i) % 4 : (i + 1) % 4];
                        add_point(&d, size * (a[0] + (b[0] - a[0]) * s / (double)steps),
                                  size * (a[1] + (b[1] - a[1]) * s / (double)steps));
                    }
                end_loop(&d, hole == 1);
            }
            shuffle_loops(&d, &rng);
            check_drawing(context, &d);
        }
    test_context_free(context);
}

/* A square is cut along its shorter diagonal, wherever the loop starts; so is a thin kite. */
static void test_delaunay(void **state) {
    (void)state;
    static const int kite[4][2] = {{0, 0}, {10, -1}, {20, 0}, {10, 1}};
    starg_context *context = test_context(1);
    for (int side = 0; side < 6; side++)
        for (uint32_t shift = 0; shift < 4; shift++) {
            drawing d = straight_plane(side);
            cap_indices triangles = {0};
            add_steps(&d, kite, 4, false);
            for (uint32_t i = 0; i < 4; i++)
                d.corners[i] = (i + shift) % 4;
            assert_true(fill(context, &d, &triangles));
            check_filling(&d, &triangles);
            for (size_t t = 0; t < 2; t++) { /* both contain the ends of the short diagonal */
                const uint32_t *k = triangles.data + 3 * t;
                assert_true(k[0] == 1 || k[1] == 1 || k[2] == 1);
                assert_true(k[0] == 3 || k[1] == 3 || k[2] == 3);
            }
            STARG_ARRAY_FREE(context, &triangles);
        }
    test_context_free(context);
}

/* ---- any plane graph ---- */

enum { SIDE = 7, CELLS = 2 * (SIDE - 1) * (SIDE - 1) };

/* A square of lattice triangles, some of which are to be filled: all possible loops, holes,
 * islands, and loops that meet in vertices. */
typedef struct patchwork {
    drawing d;
    uint32_t cells[CELLS][3];
    bool full[CELLS];
    constrained_edge edges[3 * CELLS];
    uint32_t loose[SIDE * SIDE];
    cap_edges all;
    cap_indices lone;
} patchwork;

static void add_cell(patchwork *w, size_t number, uint32_t a, uint32_t b, uint32_t c, bool full) {
    w->cells[number][0] = a;
    w->cells[number][1] = b;
    w->cells[number][2] = c;
    w->full[number] = full;
}

/* Each edge of the lattice once, with the labels of its two cells. */
static void find_edges(patchwork *w, starg_rng *rng, double more) {
    static int32_t turns[SIDE * SIDE][SIDE * SIDE];
    static bool there[SIDE * SIDE][SIDE * SIDE];
    memset(turns, 0, sizeof turns);
    memset(there, 0, sizeof there);
    for (size_t i = 0; i < CELLS; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t a = w->cells[i][k], b = w->cells[i][(k + 1) % 3];
            uint32_t low = a < b ? a : b, high = a < b ? b : a;
            turns[low][high] += w->full[i] ? (a < b ? 1 : -1) : 0;
            there[low][high] = true;
        }
    w->all = (cap_edges){.data = w->edges};
    for (uint32_t a = 0; a < SIDE * SIDE; a++)
        for (uint32_t b = a; b < SIDE * SIDE; b++)
            if (there[a][b] && (turns[a][b] != 0 || starg_rng_unit(rng) < more))
                w->edges[w->all.count++] = (constrained_edge){a, b, turns[a][b]};
}

static void draw_patchwork(patchwork *w, starg_rng *rng, double by) {
    double density = starg_rng_unit(rng);
    for (int i = 0; i < SIDE * SIDE; i++)
        add_point(&w->d, shaken(rng, i % SIDE, by), shaken(rng, i / SIDE, by));
    for (uint32_t i = 0; i < CELLS / 2; i++) {
        uint32_t a = i / (SIDE - 1) * SIDE + i % (SIDE - 1), b = a + 1, c = b + SIDE, e = a + SIDE;
        add_cell(w, 2 * i, a, b, c, starg_rng_unit(rng) < density);
        add_cell(w, 2 * i + 1, a, c, e, starg_rng_unit(rng) < density);
    }
    find_edges(w, rng, 0.3 * starg_rng_unit(rng));
    w->lone = (cap_indices){.data = w->loose};
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        if (starg_rng_below(rng, 6) == 0)
            w->loose[w->lone.count++] = i;
}

static bool is_inside(const drawing *d, const uint32_t *t, uint32_t a, uint32_t b, uint32_t c) {
    double middle[3];
    drawing point = *d;
    uint32_t last = (uint32_t)d->point_count;
    for (int k = 0; k < 3; k++)
        middle[k] = (d->points[3 * a + (size_t)k] + d->points[3 * b + (size_t)k] +
                     d->points[3 * c + (size_t)k]) /
                    3;
    memcpy(point.points + 3 * last, middle, sizeof middle);
    return turn(&point, t[0], t[1], last) > 0 && turn(&point, t[1], t[2], last) > 0 &&
           turn(&point, t[2], t[0], last) > 0;
}

/* The centre of every filled cell lies in exactly one triangle, of the others in none; areas add
 * up; edges of the graph at filled cells are edges of triangles, and so are isolated vertices
 * inside. */
static void check_patchwork(const patchwork *w, const cap_indices *triangles) {
    static bool edge[SIDE * SIDE][SIDE * SIDE], corner[SIDE * SIDE];
    long double wanted = 0, sum = 0;
    memset(edge, 0, sizeof edge);
    memset(corner, 0, sizeof corner);
    for (size_t i = 0; i < triangles->count; i += 3) {
        const uint32_t *t = triangles->data + i;
        assert_int_equal(turn(&w->d, t[0], t[1], t[2]), 1);
        sum += area_of(&w->d, t[0], t[1], t[2]);
        for (int k = 0; k < 3; k++) {
            assert_false(edge[t[k]][t[(k + 1) % 3]]);
            edge[t[k]][t[(k + 1) % 3]] = corner[t[k]] = true;
        }
    }
    for (size_t i = 0; i < CELLS; i++) {
        const uint32_t *c = w->cells[i];
        size_t holders = 0;
        for (size_t n = 0; n < triangles->count; n += 3)
            holders += is_inside(&w->d, triangles->data + n, c[0], c[1], c[2]);
        assert_true(holders <= w->full[i]);
        if (w->full[i])
            wanted += area_of(&w->d, c[0], c[1], c[2]);
    }
    assert_true(fabsl(sum - wanted) <= 1e-12L * wanted);
    for (size_t i = 0; i < w->all.count; i++) {
        const constrained_edge *e = &w->edges[i];
        assert_int_equal(edge[e->from][e->to] - edge[e->to][e->from], e->turns);
    }
    for (size_t i = 0; i < CELLS; i++)
        for (int k = 0; w->full[i] && k < 3; k++) {
            uint32_t a = w->cells[i][k], b = w->cells[i][(k + 1) % 3];
            for (size_t n = 0; n < w->all.count; n++)
                if ((w->edges[n].from == a && w->edges[n].to == b) ||
                    (w->edges[n].from == b && w->edges[n].to == a))
                    assert_true(edge[a][b]);
            for (size_t n = 0; n < w->lone.count; n++)
                assert_true(w->loose[n] != a || corner[a]);
        }
}

static void test_plane_graphs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t filled = 0, rounds = test_rounds(200, 600);
    for (uint64_t seed = 0; seed < rounds; seed++) {
        starg_rng rng = starg_rng_make(seed, 68, 0);
        static patchwork w;
        cap_indices triangles = {0};
        bool done = false;
        w.d = seed % 2 == 0 ? random_plane(&rng) : straight_plane((int)(seed / 2 % 6));
        draw_patchwork(&w, &rng, seed % 2 == 0 ? 0.3 : 0);
        test_ok(context,
                cap_fill(context, w.d.points, w.d.normal, &w.all, &w.lone, &triangles, &done));
        assert_true(done);
        check_patchwork(&w, &triangles);
        filled += triangles.count;
        STARG_ARRAY_FREE(context, &triangles);
    }
    assert_true(filled > 16 * rounds);
    test_context_free(context);
}

/* ---- invalid loops ---- */

static void test_refused(void **state) {
    (void)state;
    static const int square[4][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    static const int hole[4][2] = {{1, 1}, {1, 2}, {2, 2}, {2, 1}};
    static const int away[4][2] = {{9, 1}, {9, 2}, {10, 2}, {10, 1}};
    static const int bow[4][2] = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
    starg_context *context = test_context(1);
    cap_indices triangles = {0};
    for (int side = 0; side < 6; side++)
        for (int kind = 0; kind < 4; kind++) {
            drawing d = straight_plane(side);
            if (kind == 0) /* a hole alone */
                add_steps(&d, hole, 4, true);
            if (kind == 1) { /* a hole outside everything */
                add_steps(&d, square, 4, false);
                add_steps(&d, away, 4, true);
            }
            if (kind == 2) /* edges cross */
                add_steps(&d, bow, 4, false);
            if (kind == 3) { /* all collinear */
                for (int i = 0; i < 4; i++)
                    add_point(&d, i, 0);
                end_loop(&d, false);
            }
            assert_false(fill(context, &d, &triangles));
        }
    /* an empty input has an empty filling */
    drawing none = straight_plane(0);
    triangles.count = 0;
    assert_true(fill(context, &none, &triangles));
    assert_int_equal(triangles.count, 0);
    STARG_ARRAY_FREE(context, &triangles);
    test_context_free(context);
}

/* Random corners in random order, some of them repeated, on or off a lattice: rejected, or filled
 * with triangles whose boundary is the loops. */
static void test_senseless(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t filled = 0, refused = 0;
    for (uint64_t seed = 0; seed < 3000; seed++) {
        starg_rng rng = starg_rng_make(seed, 64, 0);
        drawing d = seed % 2 == 0 ? random_plane(&rng) : straight_plane((int)(seed / 2 % 6));
        size_t loops = 1 + (size_t)starg_rng_below(&rng, 4);
        for (size_t l = 0; l < loops; l++) {
            size_t count = 3 + (size_t)starg_rng_below(&rng, 8);
            double size = 1 + (double)starg_rng_below(&rng, 4);
            for (size_t i = 0; i < count; i++)
                if (seed % 3 == 0)
                    add_point(&d, (double)starg_rng_below(&rng, 5),
                              (double)starg_rng_below(&rng, 5));
                else
                    add_point(&d, size * (starg_rng_unit(&rng) - 0.5),
                              size * (starg_rng_unit(&rng) - 0.5));
            end_loop(&d, false);
        }
        if (seed % 5 == 0) /* loops that meet in a vertex, or pass one twice */
            d.corners[starg_rng_below(&rng, d.point_count)] =
                (uint32_t)starg_rng_below(&rng, d.point_count);
        cap_indices triangles = {0};
        bool done = fill(context, &d, &triangles);
        assert_int_equal(triangles.count % 3, 0);
        for (size_t i = 0; i < triangles.count; i++)
            assert_true(triangles.data[i] < d.point_count);
        if (done)
            check_edges(&d, &triangles, false);
        filled += done;
        refused += !done;
        STARG_ARRAY_FREE(context, &triangles);
    }
    assert_true(filled > 30 && refused > 300);
    test_context_free(context);
}

/* Existing triangles stay. */
static void test_appends(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(1, 65, 0);
    drawing d = random_plane(&rng);
    cap_indices once = {0}, twice = {0};
    add_nested(&d, &rng, 0, 0, 1, 0);
    assert_true(fill(context, &d, &once));
    assert_true(fill(context, &d, &twice));
    assert_true(fill(context, &d, &twice));
    assert_int_equal(twice.count, 2 * once.count);
    for (size_t i = 0; i < 2; i++)
        assert_memory_equal(twice.data + i * once.count, once.data, once.count * sizeof *once.data);
    STARG_ARRAY_FREE(context, &once);
    STARG_ARRAY_FREE(context, &twice);
    test_context_free(context);
}

static void test_memory(void **state) {
    (void)state;
    starg_rng rng = starg_rng_make(3, 66, 0);
    drawing d = random_plane(&rng);
    bool done = false;
    size_t ration = 0;
    for (starg_status status = STARG_ERROR_MEMORY; status != STARG_OK; ration++) {
        size_t left = SIZE_MAX;
        cap_indices triangles = {0};
        starg_context *context = test_scarce_context(1, &left);
        d.point_count = d.loop_count = d.outlines = 0;
        rng = starg_rng_make(3, 66, 1);
        add_nested(&d, &rng, 0, 0, 1, 0);
        left = ration;
        status = fill_loops(context, &d, &triangles, &done);
        if (status != STARG_OK)
            assert_int_equal(status, STARG_ERROR_MEMORY);
        STARG_ARRAY_FREE(context, &triangles);
        test_context_free(context);
    }
    assert_true(done);
    assert_in_range(ration, 5, 200);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rings),    cmocka_unit_test(test_combs),
        cmocka_unit_test(test_halls),    cmocka_unit_test(test_straight_corners),
        cmocka_unit_test(test_delaunay), cmocka_unit_test(test_plane_graphs),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_senseless),
        cmocka_unit_test(test_appends),  cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
