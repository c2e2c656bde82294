/* SPDX-License-Identifier: Apache-2.0 */
/* Maps of tetrahedra without inversions [Garanzha, Kaporin, Kudryavtseva, Protais, Desobry,
 * Sokolov: Foldover-free maps in 50 lines of code, 2021], and with little distortion.
 *
 * Problem: the vertices of a boundary are given; place the others such that every tetrahedron is
 * positive, and the maps from its rest place distort little.
 *
 * Method: with J the Jacobian of a tetrahedron's map and D its determinant, minimise the sum over
 * tetrahedra (relaxation: weighted by rest volume) of
 *
 *     tr(J^T J) / X(D)^(2/3) + THETA (D^2 + 1) / X(D),    X(D) = (D + sqrt(e^2 + D^2)) / 2,
 *
 * by limited-memory BFGS. For e = 0 this is an elastic energy that is infinite at inversions; e > 0
 * makes it finite there, and is lowered by the rule of the paper, after which the number of
 * inversions becomes zero in finitely many rounds if descent makes progress. Rest places are scaled
 * by how much the surface grows nearby, so that tetrahedra are small where there is little room.
 *
 * Vertices of the boundary may be drawn by springs instead, whose energy is added: then the
 * boundary gives way where tetrahedra are inverted.
 *
 * Stages: unfold: rounds of descent with falling e, until no tetrahedron is inverted.
 * unfold_relax: descent with e = 0, in which steps to places with an inverted tetrahedron are
 * halved.
 *
 * Invariant of relaxation: all tetrahedra are positive by exact signs, after every step. Cost: a
 * step is a few passes over the tetrahedra. */
#include "morph/solid_map.h"

#include <float.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "unfold";

enum {
    MEMORY = 8, /* pairs of the approximation to the Hessian */
    ROUND = 40, /* steps with one e */
    GROWTH_SWEEPS = 200,
    BLOCK = 256,             /* tetrahedra whose energy is an item of work */
    HALVINGS = 30,           /* of a step, at most */
    ROUNDS_IDLE = 12,        /* with no fewer inversions, until it is given up, */
    ROUNDS_IDLE_SPRINGS = 40 /* and where the surface gives way */
};
/* By how much the regularized determinant falls from round to round, at least. A surface that gives
 * way is not stuck, so that it may fall faster. */
static const double LEAST_SHARE = 0.1, LEAST_SHARE_SPRINGS = 0.3;
static const double THETA = 1.0 / 128;
static const double ARMIJO = 1e-4;
static const double LEAST_GAIN = 1e-7; /* of a round of relaxation, relative to its energy */
static const double FIRST_MOVE = 0.1;  /* the first step's largest move, relative to the extent */

typedef double matrix[3][3];

/* The energy of a tetrahedron, and its derivatives by the places of its corners. */
typedef struct energy_part {
    double energy, determinant, slopes[4][3];
} energy_part;

typedef struct descent {
    const unfold_problem *p;
    double epsilon;
    bool by_volume;    /* weights are shares of the rest volume; else all are the same */
    matrix *gradients; /* of the barycentric coordinates of corners 1 to 3 */
    double *weights;
    double extent;
    energy_part *parts;           /* per tetrahedron */
    const double *places;         /* where the parts are evaluated */
    double lowest;                /* the least determinant at the last evaluation */
    size_t size;                  /* unknowns */
    bool sloped;                  /* slopes of the parts are wanted */
    double *trial;                /* vertex_count x 3 */
    double *slope, *former, *way; /* by unknown; `former` at the last place, or at the next one */
    double *moves[MEMORY], *bends[MEMORY], scales[MEMORY];
    size_t pairs; /* made so far */
} descent;

static void descent_free(descent *d) {
    starg_context *context = d->p->context;
    void *const blocks[] = {d->gradients, d->weights, d->parts, d->trial,
                            d->slope,     d->former,  d->way};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(context, blocks[i]);
    for (int i = 0; i < MEMORY; i++) {
        RELEASE(d->moves[i], d->bends[i]);
    }
}

static const double *corner(const unfold_problem *p, const double *places, size_t t, size_t k) {
    return places + 3 * (size_t)p->tetrahedra[4 * t + k];
}

static bool is_positive(const unfold_problem *p, const double *places, size_t t) {
    return orient3d(corner(p, places, t, 0), corner(p, places, t, 1), corner(p, places, t, 2),
                    corner(p, places, t, 3)) < 0;
}

static size_t count_inverted(const unfold_problem *p, const double *places) {
    size_t inverted = 0;
    for (size_t t = 0; t < p->count; t++)
        inverted += !is_positive(p, places, t);
    return inverted;
}

bool unfold_is_positive(const unfold_problem *p, size_t tetrahedron) {
    return is_positive(p, p->now, tetrahedron);
}

/* ---- preparation ---- */

static void edges_of(const unfold_problem *p, const double *places, size_t t, matrix out) {
    for (size_t k = 0; k < 3; k++)
        vec3_subtract(corner(p, places, t, k + 1), corner(p, places, t, 0), out[k]);
}

/* The volume enclosed by the tetrahedra: that of their boundary, wherever inner vertices are. */
static double volume_of(const unfold_problem *p, const double *places) {
    double sum = 0;
    for (size_t t = 0; t < p->count; t++) {
        matrix e;
        edges_of(p, places, t, e);
        sum += vec3_triple(e[0], e[1], e[2]) / 6;
    }
    return sum;
}

static double extent_of(const unfold_problem *p) {
    double extent = 0;
    for (size_t k = 0; k < 3; k++) {
        double lower = p->now[k], upper = p->now[k];
        for (size_t v = 1; v < p->vertex_count; v++) {
            lower = fmin(lower, p->now[3 * v + k]);
            upper = fmax(upper, p->now[3 * v + k]);
        }
        extent = fmax(extent, upper - lower);
    }
    return extent;
}

/* Vertices of the surface, which come first: fixed, or drawn by springs. */
static size_t surface_of(const unfold_problem *p) {
    return p->springs.count > 0 ? p->springs.count : p->fixed;
}

/* The logarithm of how much the surface grows about each of its vertices, in length. */
static starg_status find_growth_outside(const unfold_problem *p, double *growth) {
    SCOPED double *block = NULL;
    size_t surface = surface_of(p);
    const double *places[2] = {p->rest, p->springs.count > 0 ? p->springs.targets : p->now};
    NEW_ZERO(p->context, STAGE, block, 2 * p->vertex_count);
    double *areas[2] = {block, block + p->vertex_count};
    for (size_t i = 0; i < 4 * p->count; i++) {
        const uint32_t *corners = p->tetrahedra + i / 4 * 4;
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++)
            v[k] = corners[(i + k + 1) % 4];
        if (v[0] >= surface || v[1] >= surface || v[2] >= surface)
            continue;
        for (int end = 0; end < 2; end++) {
            const double *at = places[end];
            double area = vec3_triangle_area(at + 3 * (size_t)v[0], at + 3 * (size_t)v[1],
                                             at + 3 * (size_t)v[2]);
            for (int k = 0; k < 3; k++)
                areas[end][v[k]] += area;
        }
    }
    for (size_t v = 0; v < surface; v++)
        if (areas[0][v] > 0 && areas[1][v] > 0)
            growth[v] = log(areas[1][v] / areas[0][v]) / 2;
    return STARG_OK;
}

/* Extends it to the inside: each vertex takes the mean over its tetrahedra. */
static starg_status find_growth(const unfold_problem *p, double **out) {
    SCOPED double *sums = NULL;
    double *growth = NULL;
    SCOPED uint32_t *counts = NULL;
    NEW_ZERO(p->context, STAGE, *out, p->vertex_count);
    growth = *out;
    NEW(p->context, STAGE, sums, p->vertex_count);
    NEW(p->context, STAGE, counts, p->vertex_count);
    TRY(find_growth_outside(p, growth));
    for (int sweep = 0; sweep < GROWTH_SWEEPS; sweep++) {
        memset(sums, 0, p->vertex_count * sizeof *sums);
        memset(counts, 0, p->vertex_count * sizeof *counts);
        for (size_t i = 0; i < 4 * p->count; i++) {
            const uint32_t *corners = p->tetrahedra + i / 4 * 4;
            for (size_t k = 0; k < 4; k++)
                sums[corners[i % 4]] += growth[corners[k]];
            counts[corners[i % 4]] += 4;
        }
        for (size_t v = surface_of(p); v < p->vertex_count; v++)
            if (counts[v] > 0)
                growth[v] = sums[v] / counts[v];
    }
    return STARG_OK;
}

/* Rest places are scaled by the growth, so that determinants are about 1. */
static starg_status prepare_tetrahedra(descent *d) {
    const unfold_problem *p = d->p;
    double rest = volume_of(p, p->rest);
    SCOPED double *growth = NULL;
    TRY(find_growth(p, &growth));
    for (size_t t = 0; t < p->count; t++) {
        const uint32_t *corners = p->tetrahedra + 4 * t;
        matrix e;
        edges_of(p, p->rest, t, e);
        double six = vec3_triple(e[0], e[1], e[2]);
        double scale = exp(
            -(growth[corners[0]] + growth[corners[1]] + growth[corners[2]] + growth[corners[3]]) /
            4);
        for (int k = 0; k < 3; k++) {
            vec3_cross(e[(k + 1) % 3], e[(k + 2) % 3], d->gradients[t][k]);
            for (int i = 0; i < 3; i++)
                d->gradients[t][k][i] *= scale / six;
        }
        d->weights[t] = d->by_volume ? six / 6 / rest : 1 / (double)p->count;
    }
    return STARG_OK;
}

static starg_status prepare(descent *d) {
    const unfold_problem *p = d->p;
    d->size = 3 * (p->vertex_count - p->fixed);
    d->extent = extent_of(p);
    NEW(p->context, STAGE, d->gradients, p->count);
    NEW(p->context, STAGE, d->weights, p->count);
    NEW(p->context, STAGE, d->parts, p->count);
    NEW(p->context, STAGE, d->trial, 3 * p->vertex_count);
    NEW(p->context, STAGE, d->slope, d->size);
    NEW(p->context, STAGE, d->former, d->size);
    NEW(p->context, STAGE, d->way, d->size);
    for (int i = 0; i < MEMORY; i++) {
        NEW(p->context, STAGE, d->moves[i], d->size);
        NEW(p->context, STAGE, d->bends[i], d->size);
    }
    TRY(prepare_tetrahedra(d));
    memcpy(d->trial, p->now, 3 * p->vertex_count * sizeof *d->trial);
    return STARG_OK;
}

/* ---- energy ---- */

/* The Jacobian's columns: images of the axes. */
static void jacobian_of(const descent *d, const double *places, size_t t, matrix out) {
    matrix e;
    edges_of(d->p, places, t, e);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++)
            out[axis][i] = e[0][i] * d->gradients[t][0][axis] + e[1][i] * d->gradients[t][1][axis] +
                           e[2][i] * d->gradients[t][2][axis];
}

static void find_energy(const descent *d, size_t t, energy_part *out) {
    matrix j, cofactor;
    jacobian_of(d, d->places, t, j);
    for (int k = 0; k < 3; k++)
        vec3_cross(j[(k + 1) % 3], j[(k + 2) % 3], cofactor[k]);
    double D = vec3_dot(j[0], cofactor[0]), root = sqrt(d->epsilon * d->epsilon + D * D);
    double x = (D + root) / 2, part = root > 0 ? (1 + D / root) / 2 : 0;
    *out = (energy_part){.energy = INFINITY, .determinant = D};
    if (D < 0) { /* without cancellation */
        x = d->epsilon * d->epsilon / (2 * (root - D));
        part = root > 0 ? x / root : 0;
    }
    if (!(x > 0))
        return;
    double third = cbrt(x), square = third * third;
    double trace = vec3_dot(j[0], j[0]) + vec3_dot(j[1], j[1]) + vec3_dot(j[2], j[2]);
    double shape = trace / square, size = (D * D + 1) / x;
    out->energy = d->weights[t] * (shape + THETA * size);
    if (!d->sloped)
        return;
    double along = -2.0 / 3 * shape / x * part + THETA * (2 * D - size * part) / x;
    for (size_t k = 0; k < 3; k++) {
        double *g = out->slopes[k + 1];
        const double *b = d->gradients[t][k];
        for (int i = 0; i < 3; i++) {
            for (int axis = 0; axis < 3; axis++)
                g[i] += b[axis] * (2 / square * j[axis][i] + along * cofactor[axis][i]);
            g[i] *= d->weights[t];
            out->slopes[0][i] -= g[i];
        }
    }
}

static starg_status find_energies(starg_context *context, void *shared, void *scratch,
                                  size_t item) {
    const descent *d = shared;
    (void)context, (void)scratch;
    for (size_t t = BLOCK * item; t < BLOCK * (item + 1) && t < d->p->count; t++)
        find_energy(d, t, &d->parts[t]);
    return STARG_OK;
}

/* The energy of the springs; adds its derivatives to `slope`, if that is not NULL. */
static double energy_of_springs(const unfold_problem *p, const double *places, double *slope) {
    const unfold_springs *s = &p->springs;
    double sum = 0, unit = s->strength / ((double)s->count * s->length * s->length);
    for (size_t i = 0; i < 3 * s->count; i++) {
        double off = places[i] - s->targets[i];
        sum += unit * off * off;
        if (slope != NULL)
            slope[i] += 2 * unit * off;
    }
    return sum;
}

/* The energy of all, and its slope by unknown, if that is not NULL. */
static starg_status evaluate(descent *d, const double *places, double *slope, double *energy) {
    const unfold_problem *p = d->p;
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = (p->count + BLOCK - 1) / BLOCK,
                                      .shared = d,
                                      .item = find_energies,
                                      .silent = true};
    d->places = places;
    d->sloped = slope != NULL;
    TRY(starg_parallel_for(p->context, &loop));
    d->lowest = INFINITY;
    *energy = 0;
    for (size_t t = 0; t < p->count; t++) {
        *energy += d->parts[t].energy;
        d->lowest = fmin(d->lowest, d->parts[t].determinant);
    }
    if (slope != NULL)
        memset(slope, 0, d->size * sizeof *slope);
    for (size_t i = 0; i < 4 * p->count && slope != NULL; i++) {
        size_t v = p->tetrahedra[i];
        double *own = slope + 3 * (v - p->fixed);
        if (v >= p->fixed)
            vec3_along(own, 1, d->parts[i / 4].slopes[i % 4], own);
    }
    if (p->springs.count > 0)
        *energy += energy_of_springs(p, places, slope);
    return STARG_OK;
}

/* ---- descent ---- */

static double dot(const double *a, const double *b, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

static void add(double *a, double factor, const double *b, size_t count) {
    for (size_t i = 0; i < count; i++)
        a[i] += factor * b[i];
}

/* The direction of limited-memory BFGS. */
static void choose_way(descent *d) {
    double factors[MEMORY];
    size_t kept = d->pairs < MEMORY ? d->pairs : MEMORY;
    for (size_t i = 0; i < d->size; i++)
        d->way[i] = -d->slope[i];
    for (size_t i = 0; i < kept; i++) {
        size_t at = (d->pairs - 1 - i) % MEMORY;
        factors[at] = d->scales[at] * dot(d->moves[at], d->way, d->size);
        add(d->way, -factors[at], d->bends[at], d->size);
    }
    if (kept > 0) {
        size_t at = (d->pairs - 1) % MEMORY;
        double unit = 1 / (d->scales[at] * dot(d->bends[at], d->bends[at], d->size));
        for (size_t i = 0; i < d->size; i++)
            d->way[i] *= unit;
    }
    for (size_t i = kept; i-- > 0;) {
        size_t at = (d->pairs - 1 - i) % MEMORY;
        double back = d->scales[at] * dot(d->bends[at], d->way, d->size);
        add(d->way, factors[at] - back, d->moves[at], d->size);
    }
}

/* The first step is not longer than a part of the extent. */
static double first_length(const descent *d) {
    double most = 0;
    if (d->pairs > 0)
        return 1;
    for (size_t i = 0; i < d->size; i++)
        most = fmax(most, fabs(d->way[i]));
    return most > 0 ? fmin(1, FIRST_MOVE * d->extent / most) : 1;
}

/* Remembers the change of the slope along the step that was made. */
static void remember(descent *d, double length) {
    size_t at = d->pairs % MEMORY;
    for (size_t i = 0; i < d->size; i++) {
        d->moves[at][i] = length * d->way[i];
        d->bends[at][i] = d->slope[i] - d->former[i];
    }
    double curvature = dot(d->moves[at], d->bends[at], d->size);
    if (curvature > 1e-12 * sqrt(dot(d->moves[at], d->moves[at], d->size) *
                                 dot(d->bends[at], d->bends[at], d->size))) {
        d->scales[at] = 1 / curvature;
        d->pairs++;
    }
}

/* One step; *made: there is one that lowers the energy. */
static starg_status make_step(descent *d, double *energy, bool *made) {
    const unfold_problem *p = d->p;
    double *own = p->now + 3 * p->fixed, *trial = d->trial + 3 * p->fixed;
    *made = false;
    choose_way(d);
    double fall = dot(d->slope, d->way, d->size);
    if (!(fall < 0)) {
        if (d->pairs == 0)
            return STARG_OK;
        d->pairs = 0;
        choose_way(d);
        fall = dot(d->slope, d->way, d->size);
    }
    double length = first_length(d), found;
    for (int halving = 0; halving < HALVINGS && !*made; halving++, length /= 2) {
        for (size_t i = 0; i < d->size; i++)
            trial[i] = own[i] + length * d->way[i];
        TRY(evaluate(d, d->trial, halving == 0 ? d->former : NULL, &found));
        *made = found <= *energy + ARMIJO * length * fall &&
                (d->epsilon > 0 || count_inverted(p, d->trial) == 0);
        if (!*made)
            continue;
        if (halving > 0)
            TRY(evaluate(d, d->trial, d->former, &found));
        double *former = d->slope;
        d->slope = d->former;
        d->former = former;
        memcpy(own, trial, d->size * sizeof *own);
        *energy = found;
        remember(d, length);
    }
    return STARG_OK;
}

/* Up to `steps` steps with the same epsilon. */
static starg_status go_down(descent *d, size_t steps, double *energy) {
    bool made = true;
    d->pairs = 0;
    TRY(evaluate(d, d->p->now, d->slope, energy));
    const bool may_end = d->by_volume && d->p->until > 0;
    for (size_t i = 0; i < steps && made && !(may_end && starg_clock() > d->p->until); i++) {
        TRY(starg_check_cancel(d->p->context, STAGE));
        TRY(make_step(d, energy, &made));
    }
    return STARG_OK;
}

/* ---- public functions ---- */

/* X as in the head. */
static double regular(double epsilon, double D) {
    double root = sqrt(epsilon * epsilon + D * D);
    return D < 0 ? epsilon * epsilon / (2 * (root - D)) : (D + root) / 2;
}

/* Takes the next epsilon, from the energies before and after a round (equation 5 of the paper). */
static starg_status lower(descent *d, double before) {
    double after;
    TRY(evaluate(d, d->p->now, NULL, &after));
    double least = d->p->springs.count > 0 ? LEAST_SHARE_SPRINGS : LEAST_SHARE;
    double share = fmax(least, 1 - after / before), lowest = d->lowest;
    double wanted = (1 - share) * regular(d->epsilon, lowest);
    d->epsilon = wanted > lowest ? 2 * sqrt(wanted * (wanted - lowest)) : 1e-10;
    return STARG_OK;
}

starg_status unfold(const unfold_problem *p, size_t steps, size_t *inverted) {
    SCOPED_BY(descent_free) descent d = {.p = p};
    size_t least = SIZE_MAX;
    int idle = 0, most_idle = p->springs.count > 0 ? ROUNDS_IDLE_SPRINGS : ROUNDS_IDLE;
    *inverted = count_inverted(p, p->now);
    if (*inverted == 0 || p->fixed >= p->vertex_count)
        return STARG_OK;
    TRY(prepare(&d));
    double before, after;
    TRY(evaluate(&d, p->now, NULL, &before));
    d.epsilon = fmax(1e-3, sqrt(1e-6 + 0.04 * d.lowest * d.lowest));
    for (size_t done_steps = 0; done_steps<steps && * inverted> 0 && idle < most_idle;
         done_steps += ROUND) {
        TRY(evaluate(&d, p->now, NULL, &before));
        TRY(go_down(&d, ROUND, &after));
        *inverted = count_inverted(p, p->now);
        TRY(lower(&d, before));
        if (p->springs.move != NULL)
            p->springs.move(p->springs.user);
        idle = *inverted < least ? 0 : idle + 1;
        least = *inverted < least ? *inverted : least;
    }
    return STARG_OK;
}

starg_status unfold_relax(const unfold_problem *p, size_t steps) {
    SCOPED_BY(descent_free) descent d = {.p = p, .by_volume = true};
    double before, after = INFINITY;
    if (p->fixed >= p->vertex_count || steps == 0)
        return STARG_OK;
    TRY(prepare(&d));
    for (size_t made = 0; made < steps; made += ROUND) {
        before = after;
        TRY(go_down(&d, steps - made < ROUND ? steps - made : ROUND, &after));
        if (!(after < before * (1 - LEAST_GAIN)))
            break;
    }
    return STARG_OK;
}
