/* SPDX-License-Identifier: Apache-2.0 */
/* Distance of [YL11, section 5.1]: the energy of deforming one guarding graph into another, plus
 * the difference of the histograms of matched guards.
 *
 * Numbers: the graph in its own frame, in units of the shape's size. A guard is (x,
 * y, z, valence / 10): one edge counts as much as a tenth of the size. Its histogram is the
 * paper's, distances by direction, here in 64 directions of that frame.
 *
 * The paper sums over guards and edges; here all terms are means, so that shapes with many guards
 * are not farther from everything. With g a guard, c its nearest one of the other graph (by a k-d
 * tree over four coordinates), phi an affine map for each guard:
 *   E_M = mean |phi(g) - c|^2,  E_S = mean |phi_i - phi_j|,  E_L = mean (|e'| - |e|)^2,
 *   E_H = mean root mean square of the difference of two histograms,
 *   E = 0.1 E_M + E_S + E_L + 0.5 E_H, and the distance is the mean of both directions.
 *
 * Norms in E_S are smoothed near 0, where they have no gradient.
 *
 * Minimization: the weighted sum of the first three terms over all maps, starting from the
 * identity. E_S is a sum of norms and E_L is not convex. Each round replaces the energy by a
 * quadratic upper bound that is tight at the current maps: nearest guards stay (E_M), a norm is
 * bounded by its square (E_S), the length of an edge by the distance to its current direction
 * (E_L). The bound is lowered by the best common change of all maps, then by a few steps of
 * conjugate gradients for each; coordinates are independent. So the energy never rises, whatever
 * the graph: an isolated guard is pulled by E_M only, components move on their own, and directions
 * in no term stay. At the end the histogram of each guard is compared with that of the nearest
 * guard.
 *
 * Cost: rounds times steps times (guards + edges): a few milliseconds for 70 guards. */

#include "core/memory.h"
#include "geometry/kd_tree.h"
#include "geometry/vec3.h"
#include "shape/signature_kinds.h"

typedef struct paper_pose {
    double centre[3];  /* of the points that the guards see */
    double size;       /* root mean square distance from it; 0 if they coincide */
    double axes[3][3]; /* rows: the principal axes, a right-handed frame */
} paper_pose;

static const char STAGE[] = "paper distance";

/* Pose of a descriptor: [YL11] compares coordinates but does not state the frame.
 *
 * Here: centre, size and principal axes of the boundary points that the guards see, each guard
 * weighted by the volume of its piece. Axes point to the side of positive third moment; the axis
 * with the smallest third moment makes the frame right-handed, so that a mirror-symmetric shape,
 * for which that moment is noise, still has a unique frame. Eigenvectors by Jacobi rotations, which
 * are stable for any symmetric matrix; if two moments are equal the axes are arbitrary, but a pure
 * function of the numbers.
 *
 * Cost: three passes over guards times directions. */

enum { SWEEPS = 16 };

/* Sums over the points that guards see, relative to the first guard and to the diagonal. */
typedef struct moments {
    const starg_descriptor *d;
    double unit, largest, weight;
} moments;

static void seen_point(const moments *m, size_t guard, size_t i, double out[3]) {
    const starg_descriptor *d = m->d;
    double direction[3], step = d->distances[guard * d->direction_count + i] / m->unit;
    starg_descriptor_direction(d->direction_count, i, direction);
    for (int k = 0; k < 3; k++)
        out[k] = (d->guards[guard].position[k] - d->guards[0].position[k]) / m->unit +
                 step * direction[k];
}

/* Relative to the largest, to avoid overflow and underflow; equal if there is no volume. */
static double weigh(const moments *m, size_t guard) {
    return m->largest > 0 ? m->d->guards[guard].volume / m->largest : 1;
}

static void find_centre(moments *m, double centre[3]) {
    const starg_descriptor *d = m->d;
    memset(centre, 0, 3 * sizeof *centre);
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g), p[3];
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_along(centre, w, p, centre);
        }
        m->weight += w * (double)d->direction_count;
    }
    for (int k = 0; k < 3; k++)
        centre[k] /= m->weight;
}

static void find_spread(const moments *m, const double centre[3], double spread[3][3]) {
    const starg_descriptor *d = m->d;
    memset(spread, 0, 9 * sizeof(double));
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g) / m->weight, p[3];
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_subtract(p, centre, p);
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    spread[r][c] += w * p[r] * p[c];
        }
    }
}

/* One Jacobi rotation in the plane of axes p and q, which makes a[p][q] zero. */
static void rotate(double a[3][3], double axes[3][3], int p, int q) {
    if (a[p][q] == 0)
        return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + hypot(theta, 1));
    double c = 1 / hypot(t, 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
        double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        x = axes[p][k], y = axes[q][k];
        axes[p][k] = c * x - s * y;
        axes[q][k] = s * x + c * y;
    }
}

static void swap_rows(double a[3][3], double axes[3][3], int p, int q) {
    double value = a[p][p], row[3];
    a[p][p] = a[q][q];
    a[q][q] = value;
    vec3_copy(axes[p], row);
    vec3_copy(axes[q], axes[p]);
    vec3_copy(row, axes[q]);
}

/* Sorted by decreasing spread. */
static void find_axes(double a[3][3], double axes[3][3]) {
    memset(axes, 0, 9 * sizeof(double));
    for (int k = 0; k < 3; k++)
        axes[k][k] = 1;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        rotate(a, axes, 0, 1);
        rotate(a, axes, 0, 2);
        rotate(a, axes, 1, 2);
    }
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < 2; k++)
            if (a[k][k] < a[k + 1][k + 1])
                swap_rows(a, axes, k, k + 1);
}

static void turn_axes(const moments *m, const double centre[3], double axes[3][3]) {
    const starg_descriptor *d = m->d;
    double third[3] = {0, 0, 0}, p[3];
    for (size_t g = 0; g < d->guard_count; g++) {
        double w = weigh(m, g);
        for (size_t i = 0; i < d->direction_count; i++) {
            seen_point(m, g, i, p);
            vec3_subtract(p, centre, p);
            for (int k = 0; k < 3; k++)
                third[k] += w * pow(vec3_dot(p, axes[k]), 3);
        }
    }
    int least = 0;
    for (int k = 0; k < 3; k++) {
        if (fabs(third[k]) < fabs(third[least]))
            least = k;
        for (int c = 0; third[k] < 0 && c < 3; c++)
            axes[k][c] = -axes[k][c];
    }
    vec3_cross(axes[(least + 1) % 3], axes[(least + 2) % 3], axes[least]);
}

static paper_pose paper_pose_of(const starg_descriptor *descriptor) {
    paper_pose pose;
    double spread[3][3];
    moments m = {.d = descriptor, .unit = descriptor->diagonal};
    if (!(m.unit > 0))
        m.unit = 1;
    for (size_t i = 0; i < descriptor->guard_count; i++)
        m.largest = fmax(m.largest, descriptor->guards[i].volume);
    find_centre(&m, pose.centre);
    find_spread(&m, pose.centre, spread);
    pose.size = m.unit * sqrt(fmax(0, spread[0][0] + spread[1][1] + spread[2][2]));
    find_axes(spread, pose.axes);
    turn_axes(&m, pose.centre, pose.axes);
    for (int k = 0; k < 3; k++)
        pose.centre[k] = descriptor->guards[0].position[k] + m.unit * pose.centre[k];
    return pose;
}

/* Maps a point to the frame, in units of the size. */
static void paper_pose_apply(const paper_pose *pose, const double p[3], double out[3]) {
    double q[3], unit = pose->size > 0 ? pose->size : 1;
    for (int k = 0; k < 3; k++)
        q[k] = (p[k] - pose->centre[k]) / unit;
    for (int k = 0; k < 3; k++)
        out[k] = vec3_dot(pose->axes[k], q);
}

enum { HEAD = 2, PLACE = 4, BINS = 64, GUARD = PLACE + BINS, ROUNDS = 8, STEPS = 24 };
static const double MATCH = 0.1, SMOOTH = 1, LENGTH = 1, HISTOGRAM = 0.5;
static const double VALENCE = 0.1;
static const double KINK = 1e-3; /* norms n of E_S are taken as hypot(n, KINK) - KINK */

/* ---- layout of the numbers: guards, edges; x, y, z, valence and histogram per guard; both ends
 * per edge ---- */

typedef struct graph {
    size_t guards, edges;
    const double *guard; /* guards x GUARD */
    const double *edge;  /* edges x 2 */
} graph;

static graph graph_of(const double *numbers) {
    graph g = {.guards = (size_t)numbers[0], .edges = (size_t)numbers[1]};
    g.guard = numbers + HEAD;
    g.edge = g.guard + GUARD * g.guards;
    return g;
}

static size_t end_of(const graph *g, size_t edge, size_t k) {
    return (size_t)g->edge[2 * edge + k];
}

/* For each direction of the frame the nearest one of the descriptor. */
static void turn_directions(const starg_descriptor *d, const paper_pose *pose, size_t nearest[]) {
    for (size_t b = 0; b < BINS; b++) {
        double wanted[3], best = -2;
        starg_descriptor_direction(BINS, b, wanted);
        for (size_t i = 0; i < d->direction_count; i++) {
            double direction[3], cosine = 0;
            starg_descriptor_direction(d->direction_count, i, direction);
            for (int k = 0; k < 3; k++)
                cosine += wanted[k] * vec3_dot(pose->axes[k], direction);
            if (cosine > best) {
                best = cosine;
                nearest[b] = i;
            }
        }
    }
}

static starg_status derive(starg_context *context, const starg_descriptor *d, double **numbers,
                           size_t *count) {
    double *all = NULL;
    size_t nearest[BINS] = {0};
    const paper_pose pose = paper_pose_of(d);
    double unit = pose.size > 0 ? pose.size : 1;
    *count = HEAD + GUARD * d->guard_count + 2 * d->edge_count;
    NEW_ZERO(context, STAGE, all, *count);
    all[0] = (double)d->guard_count;
    all[1] = (double)d->edge_count;
    turn_directions(d, &pose, nearest);
    for (size_t i = 0; i < d->guard_count; i++) {
        double *guard = all + HEAD + GUARD * i;
        paper_pose_apply(&pose, d->guards[i].position, guard);
        for (size_t b = 0; b < BINS; b++)
            guard[PLACE + b] = d->distances[i * d->direction_count + nearest[b]] / unit;
    }
    double *ends = all + HEAD + GUARD * d->guard_count;
    for (size_t e = 0; e < d->edge_count; e++) {
        ends[2 * e] = d->edges[e].first;
        ends[2 * e + 1] = d->edges[e].second;
        all[HEAD + GUARD * (size_t)d->edges[e].first + 3] += VALENCE;
        all[HEAD + GUARD * (size_t)d->edges[e].second + 3] += VALENCE;
    }
    *numbers = all;
    return STARG_OK;
}

static bool check(const double *numbers, size_t count) {
    if (count < HEAD + GUARD || !(numbers[0] >= 1 && numbers[0] < (double)count) ||
        !(numbers[1] >= 0 && numbers[1] < (double)count))
        return false;
    const graph g = graph_of(numbers);
    if (numbers[0] != (double)g.guards || numbers[1] != (double)g.edges ||
        count != HEAD + GUARD * g.guards + 2 * g.edges)
        return false;
    for (size_t i = 0; i < GUARD * g.guards; i++)
        if (!(fabs(g.guard[i]) < 1e6))
            return false;
    for (size_t i = 0; i < 2 * g.edges; i++)
        if (!(g.edge[i] >= 0 && g.edge[i] < numbers[0] && g.edge[i] == floor(g.edge[i])))
            return false;
    return true;
}

/* ---- the energy ---- */

enum { MAP = 4 }; /* a row of an affine map: maps (x, y, z, 1) to one coordinate */

typedef struct fitting {
    graph from, to;
    double *places;                          /* of the other graph: guards x PLACE */
    kd_tree tree;                            /* of them */
    double *maps;                            /* guards x 3 rows x MAP */
    double *moved;                           /* guards x 3 */
    size_t *match;                           /* per guard: the nearest one of the other graph */
    double *weight;                          /* per edge: of the square that bounds the norm */
    double *target;                          /* edges x 3: edge vector of minimal E_L */
    double *right, *residual, *step, *image; /* guards x MAP, scratch */
} fitting;

static double apply_row(const double *row, const double *place) {
    return row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3];
}

static const double *place_of(const fitting *f, size_t guard) {
    return f->from.guard + GUARD * guard;
}

static double length_before(const fitting *f, size_t edge) {
    return vec3_distance(place_of(f, end_of(&f->from, edge, 0)),
                         place_of(f, end_of(&f->from, edge, 1)));
}

static double map_difference(const fitting *f, size_t edge) {
    const double *a = f->maps + 3 * MAP * end_of(&f->from, edge, 0);
    const double *b = f->maps + 3 * MAP * end_of(&f->from, edge, 1);
    double sum = 0;
    for (int k = 0; k < 3 * MAP; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

/* Applies the maps to the guards and finds their matches; returns the energy without histograms. */
static double move(fitting *f) {
    double match = 0, smooth = 0, length = 0;
    for (size_t i = 0; i < f->from.guards; i++) {
        double *q = f->moved + 3 * i, squared;
        double place[PLACE];
        for (size_t k = 0; k < 3; k++)
            place[k] = q[k] = apply_row(f->maps + MAP * (3 * i + k), place_of(f, i));
        place[3] = place_of(f, i)[3];
        f->match[i] = kd_tree_nearest(&f->tree, place, &squared);
        match += squared;
    }
    for (size_t e = 0; e < f->from.edges; e++) {
        double d = vec3_distance(f->moved + 3 * end_of(&f->from, e, 0),
                                 f->moved + 3 * end_of(&f->from, e, 1)) -
                   length_before(f, e);
        smooth += hypot(map_difference(f, e), KINK) - KINK;
        length += d * d;
    }
    double edges = fmax(1, (double)f->from.edges);
    return MATCH * match / (double)f->from.guards + (SMOOTH * smooth + LENGTH * length) / edges;
}

/* ---- the quadratic bound ---- */

static void bound(fitting *f) {
    for (size_t e = 0; e < f->from.edges; e++) {
        size_t a = end_of(&f->from, e, 0), b = end_of(&f->from, e, 1);
        double way[3], before = length_before(f, e), norm = map_difference(f, e);
        vec3_subtract(f->moved + 3 * a, f->moved + 3 * b, way);
        double now = vec3_length(way);
        f->weight[e] = 0.5 * SMOOTH / hypot(norm, KINK);
        for (size_t k = 0; k < 3; k++)
            f->target[3 * e + k] = now > 0 ? way[k] * (before / now) : 0;
    }
}

/* Adds t (place, 1) to a row. */
static void add_row(double *row, double t, const double *place) {
    for (int k = 0; k < 3; k++)
        row[k] += t * place[k];
    row[3] += t;
}

/* out = the quadratic form's matrix times x, for one coordinate */
static void multiply(const fitting *f, const double *x, double *out) {
    double guards = (double)f->from.guards, edges = (double)f->from.edges;
    memset(out, 0, MAP * f->from.guards * sizeof *out);
    for (size_t i = 0; i < f->from.guards; i++)
        add_row(out + MAP * i, MATCH / guards * apply_row(x + MAP * i, place_of(f, i)),
                place_of(f, i));
    for (size_t e = 0; e < f->from.edges; e++) {
        size_t a = end_of(&f->from, e, 0), b = end_of(&f->from, e, 1);
        const double *p = place_of(f, a), *q = place_of(f, b);
        double stretch = LENGTH / edges * (apply_row(x + MAP * a, p) - apply_row(x + MAP * b, q));
        add_row(out + MAP * a, stretch, p);
        add_row(out + MAP * b, -stretch, q);
        for (size_t k = 0; k < MAP; k++) {
            double d = f->weight[e] / edges * (x[MAP * a + k] - x[MAP * b + k]);
            out[MAP * a + k] += d;
            out[MAP * b + k] -= d;
        }
    }
}

static void compute_right_side(const fitting *f, size_t axis) {
    double guards = (double)f->from.guards, edges = (double)f->from.edges;
    memset(f->right, 0, MAP * f->from.guards * sizeof *f->right);
    for (size_t i = 0; i < f->from.guards; i++)
        add_row(f->right + MAP * i, MATCH / guards * f->to.guard[GUARD * f->match[i] + axis],
                place_of(f, i));
    for (size_t e = 0; e < f->from.edges; e++) {
        size_t a = end_of(&f->from, e, 0), b = end_of(&f->from, e, 1);
        double t = LENGTH / edges * f->target[3 * e + axis];
        add_row(f->right + MAP * a, t, place_of(f, a));
        add_row(f->right + MAP * b, -t, place_of(f, b));
    }
}

static double dot(const double *a, const double *b, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Residuals whose square is below this are rounding. Continuing would follow directions in no term;
 * an isolated guard has three of them per coordinate. */
static double negligible(const fitting *f) {
    return 1e-24 * dot(f->right, f->right, MAP * f->from.guards);
}

/* The best common change of all rows: norms of E_S do not see it, so a graph moves as a whole at
 * once however stiff it is. Conjugate gradients in four dimensions. */
static void descend_together(fitting *f, double *x) {
    double guards = (double)f->from.guards, edges = (double)f->from.edges;
    double residual[MAP] = {0}, step[MAP], change[MAP] = {0};
    multiply(f, x, f->image);
    for (size_t i = 0; i < MAP * f->from.guards; i++)
        residual[i % MAP] += f->right[i] - f->image[i];
    memcpy(step, residual, sizeof step);
    double now = dot(residual, residual, MAP), enough = negligible(f);
    for (int round = 0; round < 2 * MAP && now > enough; round++) {
        double image[MAP] = {0};
        for (size_t i = 0; i < f->from.guards; i++)
            add_row(image, MATCH / guards * apply_row(step, place_of(f, i)), place_of(f, i));
        for (size_t e = 0; e < f->from.edges; e++) {
            double way[3];
            vec3_subtract(place_of(f, end_of(&f->from, e, 0)), place_of(f, end_of(&f->from, e, 1)),
                          way);
            double t = LENGTH / edges * vec3_dot(step, way);
            for (size_t k = 0; k < 3; k++)
                image[k] += t * way[k];
        }
        double curvature = dot(step, image, MAP), before = now;
        if (!(curvature > 0))
            break;
        for (size_t k = 0; k < MAP; k++) {
            change[k] += now / curvature * step[k];
            residual[k] -= now / curvature * image[k];
        }
        now = dot(residual, residual, MAP);
        for (size_t k = 0; k < MAP; k++)
            step[k] = residual[k] + now / before * step[k];
    }
    for (size_t i = 0; i < MAP * f->from.guards; i++)
        x[i] += change[i % MAP];
}

/* Conjugate gradients from x: every step lowers the quadratic form. */
static void descend(const fitting *f, double *x) {
    size_t count = MAP * f->from.guards;
    multiply(f, x, f->image);
    for (size_t i = 0; i < count; i++)
        f->step[i] = f->residual[i] = f->right[i] - f->image[i];
    double now = dot(f->residual, f->residual, count), enough = negligible(f);
    for (int round = 0; round < STEPS && now > enough; round++) {
        multiply(f, f->step, f->image);
        double curvature = dot(f->step, f->image, count);
        if (!(curvature > 0))
            return;
        double t = now / curvature, before = now;
        for (size_t i = 0; i < count; i++) {
            x[i] += t * f->step[i];
            f->residual[i] -= t * f->image[i];
        }
        now = dot(f->residual, f->residual, count);
        for (size_t i = 0; i < count; i++)
            f->step[i] = f->residual[i] + now / before * f->step[i];
    }
}

/* One row of all maps at a time; `moved` is unused since the bound, so x can be gathered there. */
static void improve(fitting *f, double *x) {
    bound(f);
    for (size_t axis = 0; axis < 3; axis++) {
        compute_right_side(f, axis);
        for (size_t i = 0; i < f->from.guards; i++)
            memcpy(x + MAP * i, f->maps + MAP * (3 * i + axis), MAP * sizeof *x);
        descend_together(f, x);
        descend(f, x);
        for (size_t i = 0; i < f->from.guards; i++)
            memcpy(f->maps + MAP * (3 * i + axis), x + MAP * i, MAP * sizeof *x);
    }
}

/* ---- the distance ---- */

static double histogram_error(const fitting *f) {
    double sum = 0;
    for (size_t i = 0; i < f->from.guards; i++) {
        const double *a = place_of(f, i) + PLACE, *b = f->to.guard + GUARD * f->match[i] + PLACE;
        double squares = 0;
        for (int k = 0; k < BINS; k++)
            squares += (a[k] - b[k]) * (a[k] - b[k]);
        sum += sqrt(squares / BINS);
    }
    return sum / (double)f->from.guards;
}

static starg_status prepare(starg_context *context, fitting *f) {
    size_t guards = f->from.guards, edges = f->from.edges;
    NEW(context, STAGE, f->places, PLACE * f->to.guards);
    for (size_t i = 0; i < f->to.guards; i++)
        memcpy(f->places + PLACE * i, f->to.guard + GUARD * i, PLACE * sizeof *f->places);
    TRY(kd_tree_create(context, f->places, f->to.guards, PLACE, &f->tree));
    NEW_ZERO(context, STAGE, f->maps, 3 * MAP * guards);
    for (size_t i = 0; i < 3 * guards; i++)
        f->maps[MAP * i + i % 3] = 1;
    NEW(context, STAGE, f->moved, 3 * guards);
    NEW(context, STAGE, f->match, guards);
    NEW(context, STAGE, f->weight, edges);
    NEW(context, STAGE, f->target, 3 * edges);
    NEW(context, STAGE, f->right, MAP * guards);
    NEW(context, STAGE, f->residual, MAP * guards);
    NEW(context, STAGE, f->step, MAP * guards);
    NEW(context, STAGE, f->image, MAP * guards);
    return STARG_OK;
}

static void free_fitting(fitting *f) {
    kd_tree_free(&f->tree);
    RELEASE(f->places, f->maps, f->moved, f->match, f->weight, f->target, f->right, f->residual,
            f->step, f->image);
}

/* One direction. */
static starg_status fit(starg_context *context, const double *a, const double *b, double *out) {
    SCOPED_BY(free_fitting) fitting f = {.from = graph_of(a), .to = graph_of(b)};
    SCOPED double *x = NULL;
    TRY(prepare(context, &f));
    NEW(context, STAGE, x, MAP * f.from.guards);
    double energy = move(&f);
    for (int round = 0; round < ROUNDS && energy > 0; round++) {
        improve(&f, x);
        energy = move(&f);
    }
    *out = energy + HISTOGRAM * histogram_error(&f);
    return STARG_OK;
}

static starg_status compare(starg_context *context, const double *a, size_t a_count,
                            const double *b, size_t b_count, double *out) {
    double there = 0, back = 0;
    (void)a_count, (void)b_count;
    TRY(fit(context, a, b, &there));
    TRY(fit(context, b, a, &back));
    *out = (there + back) / 2;
    return STARG_OK;
}

const signature_method signature_paper = {
    .name = "paper", .version = 3, .derive = derive, .check = check, .compare = compare};
