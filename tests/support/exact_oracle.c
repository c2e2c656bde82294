/* SPDX-License-Identifier: Apache-2.0 */
/* Signs are determinants of rationals. Intersections are systems of linear equations and
 * inequalities in the parameters of the shapes, decided by Gaussian and then Fourier-Motzkin
 * elimination: no position is a special case, so none can be missed. The winding number counts the
 * crossings of a ray with a random direction, replaced whenever it meets a triangle other than in
 * its interior. */
#include "exact_oracle.h"

#include <gmp.h>
#include <stdlib.h>

#include "core/rng.h"

/* ---- rational vectors and determinants ---- */

typedef struct vector {
    mpq_t x[3];
} vector;

static void vector_init(vector *v) {
    for (int k = 0; k < 3; k++)
        mpq_init(v->x[k]);
}

static void vector_clear(vector *v) {
    for (int k = 0; k < 3; k++)
        mpq_clear(v->x[k]);
}

static void vector_set(vector *v, const double a[3]) {
    for (int k = 0; k < 3; k++)
        mpq_set_d(v->x[k], a[k]);
}

/* v = a - b */
static void vector_difference(vector *v, const double a[3], const double b[3]) {
    mpq_t t;
    mpq_init(t);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(v->x[k], a[k]);
        mpq_set_d(t, b[k]);
        mpq_sub(v->x[k], v->x[k], t);
    }
    mpq_clear(t);
}

/* out = a b - c d */
static void two_by_two(mpq_t out, const mpq_t a, const mpq_t b, const mpq_t c, const mpq_t d) {
    mpq_t s, t;
    mpq_inits(s, t, (mpq_ptr)NULL);
    mpq_mul(s, a, b);
    mpq_mul(t, c, d);
    mpq_sub(out, s, t);
    mpq_clears(s, t, (mpq_ptr)NULL);
}

/* out = a x b; out is neither. */
static void vector_cross(vector *out, const vector *a, const vector *b) {
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        two_by_two(out->x[k], a->x[u], b->x[v], a->x[v], b->x[u]);
    }
}

static void vector_dot(mpq_t out, const vector *a, const vector *b) {
    mpq_t sum, t;
    mpq_inits(sum, t, (mpq_ptr)NULL);
    for (int k = 0; k < 3; k++) {
        mpq_mul(t, a->x[k], b->x[k]);
        mpq_add(sum, sum, t);
    }
    mpq_set(out, sum);
    mpq_clears(sum, t, (mpq_ptr)NULL);
}

/* out = det(a, b, c) */
static void determinant(mpq_t out, const vector *a, const vector *b, const vector *c) {
    vector n;
    vector_init(&n);
    vector_cross(&n, b, c);
    vector_dot(out, a, &n);
    vector_clear(&n);
}

static int determinant_sign(const vector *a, const vector *b, const vector *c) {
    mpq_t d;
    mpq_init(d);
    determinant(d, a, b, c);
    int sign = mpq_sgn(d);
    mpq_clear(d);
    return sign;
}

/* ---- points between vertices ---- */

void oracle_mix_coordinate(const oracle_mix *mix, int k, mpq_ptr out) {
    mpq_t t;
    mpq_init(t);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < 3; i++) {
        mpq_set_d(t, mix->corner[i][k]);
        mpz_mul_si(mpq_numref(t), mpq_numref(t), (long)mix->weight[i]);
        mpq_canonicalize(t);
        mpq_add(out, out, t);
    }
    mpq_div_2exp(out, out, ORACLE_DEPTH);
    mpq_clear(t);
}

/* ---- predicates ---- */

int oracle_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    vector u, v, w;
    vector_init(&u);
    vector_init(&v);
    vector_init(&w);
    vector_difference(&u, a, d);
    vector_difference(&v, b, d);
    vector_difference(&w, c, d);
    int sign = determinant_sign(&u, &v, &w);
    vector_clear(&u);
    vector_clear(&v);
    vector_clear(&w);
    return sign;
}

/* (b - a) x (c - a) */
static void normal(vector *n, const double a[3], const double b[3], const double c[3]) {
    vector s, t;
    vector_init(&s);
    vector_init(&t);
    vector_difference(&s, b, a);
    vector_difference(&t, c, a);
    vector_cross(n, &s, &t);
    vector_clear(&s);
    vector_clear(&t);
}

/* ---- polynomials ---- */

enum { DEGREE = 3 };

typedef struct polynomial {
    mpq_t c[DEGREE + 1]; /* ascending */
} polynomial;

static void polynomial_init(polynomial *p) {
    for (int i = 0; i <= DEGREE; i++)
        mpq_init(p->c[i]);
}

static void polynomial_clear(polynomial *p) {
    for (int i = 0; i <= DEGREE; i++)
        mpq_clear(p->c[i]);
}

static int degree_of(const polynomial *p) {
    int degree = DEGREE;
    while (degree >= 0 && mpq_sgn(p->c[degree]) == 0)
        degree--;
    return degree;
}

/* At 0 and at 1. */
static int sign_at(const polynomial *p, int t) {
    mpq_t sum;
    mpq_init(sum);
    for (int i = 0; i <= (t == 0 ? 0 : DEGREE); i++)
        mpq_add(sum, sum, p->c[i]);
    int sign = mpq_sgn(sum);
    mpq_clear(sum);
    return sign;
}

/* a = -(a mod b), for b of degree 0 or more */
static void negative_remainder(polynomial *a, const polynomial *b) {
    mpq_t factor, part;
    mpq_inits(factor, part, (mpq_ptr)NULL);
    int low = degree_of(b);
    for (int high = degree_of(a); high >= low; high = degree_of(a)) {
        mpq_div(factor, a->c[high], b->c[low]);
        for (int i = 0; i <= low; i++) {
            mpq_mul(part, factor, b->c[i]);
            mpq_sub(a->c[high - low + i], a->c[high - low + i], part);
        }
    }
    for (int i = 0; i <= DEGREE; i++)
        mpq_neg(a->c[i], a->c[i]);
    mpq_clears(factor, part, (mpq_ptr)NULL);
}

/* Changes of sign in Sturm's sequence at t. */
static int changes_at(const polynomial *sequence, int count, int t) {
    int changes = 0, last = 0;
    for (int i = 0; i < count; i++) {
        int sign = sign_at(&sequence[i], t);
        changes += sign * last < 0;
        last = sign != 0 ? sign : last;
    }
    return changes;
}

/* Sturm's theorem: the number of distinct roots between 0 and 1, where it does not vanish. */
static int roots_between(const polynomial *p) {
    polynomial sequence[DEGREE + 2];
    int count = 2;
    for (int i = 0; i < DEGREE + 2; i++)
        polynomial_init(&sequence[i]);
    mpq_t factor;
    mpq_init(factor);
    for (int i = 0; i <= DEGREE; i++)
        mpq_set(sequence[0].c[i], p->c[i]);
    for (int i = 1; i <= DEGREE; i++) {
        mpq_set_si(factor, i, 1);
        mpq_mul(sequence[1].c[i - 1], p->c[i], factor);
    }
    while (count < DEGREE + 2 && degree_of(&sequence[count - 1]) > 0) {
        for (int i = 0; i <= DEGREE; i++)
            mpq_set(sequence[count].c[i], sequence[count - 2].c[i]);
        negative_remainder(&sequence[count], &sequence[count - 1]);
        count++;
    }
    int roots = changes_at(sequence, count, 0) - changes_at(sequence, count, 1);
    mpq_clear(factor);
    for (int i = 0; i < DEGREE + 2; i++)
        polynomial_clear(&sequence[i]);
    return roots;
}

/* The determinant of edges at time t, an integer. */
static void volume_at(mpq_t out, const double *const from[4], const double *const to[4], int t) {
    vector edges[3], late[3];
    mpq_t weights[2];
    mpq_inits(weights[0], weights[1], (mpq_ptr)NULL);
    mpq_set_si(weights[0], 1 - t, 1);
    mpq_set_si(weights[1], t, 1);
    for (int i = 0; i < 3; i++) {
        vector_init(&edges[i]);
        vector_init(&late[i]);
        vector_difference(&edges[i], from[i + 1], from[0]);
        vector_difference(&late[i], to[i + 1], to[0]);
        for (int k = 0; k < 3; k++) {
            mpq_mul(edges[i].x[k], edges[i].x[k], weights[0]);
            mpq_mul(late[i].x[k], late[i].x[k], weights[1]);
            mpq_add(edges[i].x[k], edges[i].x[k], late[i].x[k]);
        }
    }
    determinant(out, &edges[0], &edges[1], &edges[2]);
    for (int i = 0; i < 3; i++) {
        vector_clear(&edges[i]);
        vector_clear(&late[i]);
    }
    mpq_clears(weights[0], weights[1], (mpq_ptr)NULL);
}

/* The polynomial with given values at -1, 0, 1 and 2, by Lagrange's formula. */
static void interpolate(polynomial *p, mpq_t values[4]) {
    static const int NUMERATORS[4][4] = {
        {0, -2, 3, -1}, {6, -3, -6, 3}, {0, 6, 3, -3}, {0, -1, 0, 1}};
    mpq_t factor;
    mpq_init(factor);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k <= DEGREE; k++) {
            mpq_set_si(factor, NUMERATORS[i][k], 6);
            mpq_canonicalize(factor);
            mpq_mul(factor, factor, values[i]);
            mpq_add(p->c[k], p->c[k], factor);
        }
    mpq_clear(factor);
}

bool oracle_stays_positive(const double *const from[4], const double *const to[4]) {
    polynomial p;
    mpq_t values[4];
    polynomial_init(&p);
    for (int i = 0; i < 4; i++) {
        mpq_init(values[i]);
        volume_at(values[i], from, to, i - 1);
    }
    interpolate(&p, values);
    bool positive = sign_at(&p, 0) > 0 && sign_at(&p, 1) > 0 && roots_between(&p) == 0;
    for (int i = 0; i < 4; i++)
        mpq_clear(values[i]);
    polynomial_clear(&p);
    return positive;
}

/* ---- predicates in the plane and about spheres ---- */

int oracle_orient2d(const double a[3], const double b[3], const double c[3], int u, int v) {
    vector n;
    vector_init(&n);
    normal(&n, (double[3]){a[u], a[v], 0}, (double[3]){b[u], b[v], 0}, (double[3]){c[u], c[v], 0});
    int sign = mpq_sgn(n.x[2]);
    vector_clear(&n);
    return sign;
}

bool oracle_collinear(const double a[3], const double b[3], const double c[3]) {
    vector n;
    vector_init(&n);
    normal(&n, a, b, c);
    bool none = mpq_sgn(n.x[0]) == 0 && mpq_sgn(n.x[1]) == 0 && mpq_sgn(n.x[2]) == 0;
    vector_clear(&n);
    return none;
}

/* The determinant of the rows (x - e, |x - e|^2) for x = a, b, c, d, expanded by its last column.
 * Its sign is that of a point inside for a positive orient3d(a, b, c, d): with e at the centre of
 * a regular tetrahedron all four squares are r^2, and the cofactors sum to det(a - d, ...). */
int oracle_insphere(const double a[3], const double b[3], const double c[3], const double d[3],
                    const double e[3]) {
    const double *points[4] = {a, b, c, d};
    vector rows[4];
    for (int i = 0; i < 4; i++) {
        vector_init(&rows[i]);
        vector_difference(&rows[i], points[i], e);
    }
    mpq_t sum, square, minor;
    mpq_inits(sum, square, minor, (mpq_ptr)NULL);
    for (int i = 0; i < 4; i++) {
        const vector *others[3];
        for (int j = 0, n = 0; j < 4; j++)
            if (j != i)
                others[n++] = &rows[j];
        determinant(minor, others[0], others[1], others[2]);
        vector_dot(square, &rows[i], &rows[i]);
        mpq_mul(minor, minor, square);
        if (i % 2 == 1) /* the sign of cofactor (i, 3) is (-1)^(i + 1), negated overall */
            mpq_sub(sum, sum, minor);
        else
            mpq_add(sum, sum, minor);
    }
    int sign = -mpq_sgn(sum);
    mpq_clears(sum, square, minor, (mpq_ptr)NULL);
    for (int i = 0; i < 4; i++)
        vector_clear(&rows[i]);
    return sign;
}

int oracle_compare_distance(const double p[3], const double q[3], double radius) {
    vector v;
    vector_init(&v);
    vector_difference(&v, p, q);
    mpq_t square, limit;
    mpq_inits(square, limit, (mpq_ptr)NULL);
    vector_dot(square, &v, &v);
    mpq_set_d(limit, radius);
    mpq_mul(limit, limit, limit);
    int sign = mpq_cmp(square, limit);
    mpq_clears(square, limit, (mpq_ptr)NULL);
    vector_clear(&v);
    return (sign > 0) - (sign < 0);
}

/* Sign of u . v - cosine |u| |v|: x |x| grows with x, and so compares two numbers by squares that
 * keep their signs. */
static int compare_angle(const vector *u, const vector *v, double cosine) {
    mpq_t dot, far, length, c;
    mpq_inits(dot, far, length, c, (mpq_ptr)NULL);
    vector_dot(dot, u, v);
    vector_dot(far, u, u);
    vector_dot(length, v, v);
    mpq_set_d(c, cosine);
    mpq_mul(far, far, length);
    mpq_mul(far, far, c);
    mpq_abs(c, c);
    mpq_mul(far, far, c);
    mpq_abs(length, dot);
    mpq_mul(dot, dot, length);
    int sign = mpq_cmp(dot, far);
    mpq_clears(dot, far, length, c, (mpq_ptr)NULL);
    return (sign > 0) - (sign < 0);
}

static const double ORIGIN[3] = {0, 0, 0};

int oracle_compare_cone(const double p[3], const double d[3], double cosine, const double q[3]) {
    vector v, axis;
    vector_init(&v);
    vector_init(&axis);
    vector_difference(&v, q, p);
    vector_difference(&axis, d, ORIGIN);
    int sign = compare_angle(&v, &axis, cosine);
    vector_clear(&axis);
    vector_clear(&v);
    return sign;
}

int oracle_compare_plane(const double p[3], const double n[3], const double q[3]) {
    return oracle_compare_cone(p, n, 0, q);
}

int oracle_compare_incidence(const double a[3], const double b[3], const double c[3],
                             const double p[3], const double q[3], double cosine) {
    vector u, v, normal, line;
    if (oracle_orient3d(a, b, c, p) <= 0)
        return -1;
    vector_init(&u);
    vector_init(&v);
    vector_init(&normal);
    vector_init(&line);
    vector_difference(&u, c, a);
    vector_difference(&v, b, a);
    vector_cross(&normal, &u, &v);
    vector_difference(&line, p, q);
    int sign = compare_angle(&normal, &line, cosine);
    vector_clear(&u);
    vector_clear(&v);
    vector_clear(&normal);
    vector_clear(&line);
    return sign;
}

/* The sum of the lines from the corners to p: three times that from the centroid. */
static void from_centroid(vector *out, const double *const t[3], const double p[3]) {
    vector line;
    vector_init(&line);
    vector_difference(out, p, t[0]);
    for (int i = 1; i < 3; i++) {
        vector_difference(&line, p, t[i]);
        for (int k = 0; k < 3; k++)
            mpq_add(out->x[k], out->x[k], line.x[k]);
    }
    vector_clear(&line);
}

int oracle_compare_parallax(const double a[3], const double b[3], const double c[3],
                            const double p[3], const double q[3], double cosine) {
    vector u, v;
    const double *const t[3] = {a, b, c};
    vector_init(&u);
    vector_init(&v);
    from_centroid(&u, t, p);
    from_centroid(&v, t, q);
    int sign = compare_angle(&u, &v, cosine);
    vector_clear(&u);
    vector_clear(&v);
    return sign;
}

/* ---- linear systems ---- */

enum { VARIABLES = 5 }; /* the most that any pair of shapes needs */

typedef enum relation { EQUAL_ZERO, AT_LEAST_ZERO, ABOVE_ZERO } relation;

/* The relation of (sum of k[i] x[i] over the variables, plus k[VARIABLES]) to zero. */
typedef struct row {
    mpq_t k[VARIABLES + 1];
    relation relation;
} row;

typedef struct linear_system {
    row *rows;
    size_t count, capacity;
} linear_system;

static row *new_row(linear_system *s, relation r) {
    if (s->count == s->capacity) {
        s->capacity = s->capacity ? 2 * s->capacity : 16;
        s->rows = realloc(s->rows, s->capacity * sizeof *s->rows);
        if (s->rows == NULL)
            abort();
    }
    row *added = &s->rows[s->count++];
    for (int i = 0; i <= VARIABLES; i++)
        mpq_init(added->k[i]);
    added->relation = r;
    return added;
}

static void clear_row(row *r) {
    for (int i = 0; i <= VARIABLES; i++)
        mpq_clear(r->k[i]);
}

static void clear_system(linear_system *s) {
    for (size_t i = 0; i < s->count; i++)
        clear_row(&s->rows[i]);
    free(s->rows);
    *s = (linear_system){0};
}

/* out += factor x r */
static void add_multiple(row *out, const mpq_t factor, const row *r) {
    mpq_t t;
    mpq_init(t);
    for (int i = 0; i <= VARIABLES; i++)
        if (mpq_sgn(r->k[i]) != 0) {
            mpq_mul(t, factor, r->k[i]);
            mpq_add(out->k[i], out->k[i], t);
        }
    mpq_clear(t);
}

/* ---- elimination ----
 *
 * Integer rows, and only positive multiples of inequalities: no fractions to reduce, which dominate
 * the cost of rational arithmetic. */

static mpz_ptr whole(row *r, int i) {
    return mpq_numref(r->k[i]);
}

/* Multiplies a row by its common denominator. */
static void clear_denominators(row *r) {
    mpq_t common;
    mpq_init(common);
    mpq_set_ui(common, 1, 1);
    for (int i = 0; i <= VARIABLES; i++)
        mpz_lcm(mpq_numref(common), mpq_numref(common), mpq_denref(r->k[i]));
    for (int i = 0; i <= VARIABLES; i++)
        mpq_mul(r->k[i], r->k[i], common);
    mpq_clear(common);
}

/* Divides a row by its common power of two. */
static void shorten(row *r) {
    mp_bitcnt_t shift = ~(mp_bitcnt_t)0;
    for (int i = 0; i <= VARIABLES; i++) {
        mp_bitcnt_t zeros = mpz_scan1(whole(r, i), 0); /* the maximum for 0 */
        shift = zeros < shift ? zeros : shift;
    }
    if (shift > 0)
        for (int i = 0; i <= VARIABLES; i++)
            mpz_tdiv_q_2exp(whole(r, i), whole(r, i), shift);
}

/* out = a r - b q, where out may be r. */
static void combine(row *out, mpz_srcptr a, row *r, mpz_srcptr b, row *q) {
    for (int i = 0; i <= VARIABLES; i++) {
        mpz_mul(whole(out, i), a, whole(r, i));
        mpz_submul(whole(out, i), b, whole(q, i));
    }
    shorten(out);
}

/* Removes the equation `from` from the system, and `variable` from all others by it. */
static void substitute(linear_system *s, size_t from, int variable) {
    row equation = s->rows[from];
    s->rows[from] = s->rows[--s->count];
    if (mpz_sgn(whole(&equation, variable)) < 0)
        for (int i = 0; i <= VARIABLES; i++)
            mpz_neg(whole(&equation, i), whole(&equation, i));
    mpz_t factor;
    mpz_init(factor);
    for (size_t i = 0; i < s->count; i++) {
        mpz_set(factor, whole(&s->rows[i], variable));
        if (mpz_sgn(factor) != 0)
            combine(&s->rows[i], whole(&equation, variable), &s->rows[i], factor, &equation);
    }
    mpz_clear(factor);
    clear_row(&equation);
}

/* Fourier-Motzkin: every lower bound of `variable` must be below every upper bound. */
static void eliminate(linear_system *s, int variable) {
    linear_system rest = {0};
    for (size_t i = 0; i < s->count; i++) {
        row *low = &s->rows[i];
        int side = mpz_sgn(whole(low, variable));
        if (side == 0) {
            row *same = new_row(&rest, low->relation);
            for (int j = 0; j <= VARIABLES; j++)
                mpz_swap(whole(same, j), whole(low, j));
        }
        for (size_t j = 0; j < s->count && side > 0; j++) {
            row *high = &s->rows[j];
            if (mpz_sgn(whole(high, variable)) >= 0)
                continue;
            bool strict = low->relation == ABOVE_ZERO || high->relation == ABOVE_ZERO;
            row *sum = new_row(&rest, strict ? ABOVE_ZERO : AT_LEAST_ZERO);
            combine(sum, whole(low, variable), high, whole(high, variable), low);
        }
    }
    clear_system(s);
    *s = rest;
}

static bool is_constant(row *r) {
    for (int i = 0; i < VARIABLES; i++)
        if (mpz_sgn(whole(r, i)) != 0)
            return false;
    return true;
}

/* Removes rows without variables; false if one of them does not hold. */
static bool constants_hold(linear_system *s) {
    bool hold = true;
    for (size_t i = s->count; i-- > 0;) {
        row *r = &s->rows[i];
        if (!is_constant(r))
            continue;
        int sign = mpz_sgn(whole(r, VARIABLES));
        hold = hold && (r->relation == EQUAL_ZERO      ? sign == 0
                        : r->relation == AT_LEAST_ZERO ? sign >= 0
                                                       : sign > 0);
        clear_row(r);
        *r = s->rows[--s->count];
    }
    return hold;
}

/* Is the system solvable? Consumes it. */
static bool solvable(linear_system *s) {
    for (size_t i = 0; i < s->count; i++)
        clear_denominators(&s->rows[i]);
    for (int variable = 0; variable < VARIABLES; variable++)
        for (size_t i = 0; i < s->count; i++)
            if (s->rows[i].relation == EQUAL_ZERO && mpz_sgn(whole(&s->rows[i], variable)) != 0) {
                substitute(s, i, variable);
                break;
            }
    bool yes = constants_hold(s);
    for (int variable = 0; variable < VARIABLES && yes; variable++) {
        eliminate(s, variable);
        yes = constants_hold(s);
    }
    clear_system(s);
    return yes;
}

/* ---- shapes as systems ----
 *
 * A simplex uses the variables first, first + 1, ...: its points are corner[0] plus the sum of
 * x[first + i] times (corner[i + 1] - corner[0]), where the variables are nonnegative and sum to at
 * most one. */
typedef struct simplex {
    const double *corner[4];
    int dimension, first;
    const oracle_mix *mixed[4]; /* in place of the corner, where not NULL */
} simplex;

/* out = coordinate k of a corner */
static void coordinate_of(mpq_t out, const simplex *shape, int corner, int k) {
    const oracle_mix *mix = shape->mixed[corner];
    if (mix == NULL)
        mpq_set_d(out, shape->corner[corner][k]);
    else
        oracle_mix_coordinate(mix, k, out);
}

/* Adds the inequalities of a simplex; `open` requires a sum below one, which excludes the face
 * opposite corner 0. */
static void add_simplex(linear_system *s, const simplex *shape, bool open) {
    for (int i = 0; i < shape->dimension; i++)
        mpq_set_ui(new_row(s, AT_LEAST_ZERO)->k[shape->first + i], 1, 1);
    row *sum = new_row(s, open ? ABOVE_ZERO : AT_LEAST_ZERO);
    for (int i = 0; i < shape->dimension; i++)
        mpq_set_si(sum->k[shape->first + i], -1, 1);
    mpq_set_ui(sum->k[VARIABLES], 1, 1);
}

/* Adds `sign` times coordinate k of the shape's point to a row. */
static void add_coordinate(row *r, const simplex *shape, int k, int sign) {
    mpq_t base, t;
    mpq_inits(base, t, (mpq_ptr)NULL);
    coordinate_of(base, shape, 0, k);
    if (sign < 0)
        mpq_neg(base, base);
    mpq_add(r->k[VARIABLES], r->k[VARIABLES], base);
    for (int i = 0; i < shape->dimension; i++) {
        mpq_ptr out = r->k[shape->first + i];
        coordinate_of(t, shape, i + 1, k);
        if (sign < 0)
            mpq_neg(t, t);
        mpq_sub(t, t, base);
        mpq_add(out, out, t);
    }
    mpq_clears(base, t, (mpq_ptr)NULL);
}

/* The common points of a and b. */
static linear_system common_points(const simplex *a, bool open, const simplex *b) {
    linear_system s = {0};
    add_simplex(&s, a, open);
    add_simplex(&s, b, false);
    for (int k = 0; k < 3; k++) {
        row *equation = new_row(&s, EQUAL_ZERO);
        add_coordinate(equation, a, k, 1);
        add_coordinate(equation, b, k, -1);
    }
    return s;
}

static bool shapes_meet(const simplex *a, bool open, const simplex *b) {
    linear_system s = common_points(a, open, b);
    return solvable(&s);
}

static bool same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* ---- intersections ---- */

bool oracle_segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                                   const double b[3], const double c[3]) {
    if (same_point(p, q))
        return false;
    simplex segment = {{p, q}, 1, 0, {NULL}}, triangle = {{a, b, c}, 2, 1, {NULL}};
    return shapes_meet(&segment, true, &triangle);
}

bool oracle_point_on_triangle(const double p[3], const double a[3], const double b[3],
                              const double c[3]) {
    simplex point = {{p}, 0, 0, {NULL}}, triangle = {{a, b, c}, 2, 0, {NULL}};
    return shapes_meet(&point, false, &triangle);
}

bool oracle_segments_meet(const double a[3], const double b[3], const double c[3],
                          const double d[3]) {
    simplex first = {{a, b}, 1, 0, {NULL}}, second = {{c, d}, 1, 1, {NULL}};
    return shapes_meet(&first, false, &second);
}

bool oracle_tetrahedron_meets_triangle(const double p[3], const double *const face[3],
                                       const double *const t[3]) {
    simplex tetrahedron = {{p, face[0], face[1], face[2]}, 3, 0, {NULL}};
    simplex triangle = {{t[0], t[1], t[2]}, 2, 3, {NULL}};
    return shapes_meet(&tetrahedron, true, &triangle);
}

bool oracle_mix_hidden(const double p[3], const oracle_mix *q, const double *const t[3]) {
    simplex segment = {{p, NULL}, 1, 0, {NULL, q}}, triangle = {{t[0], t[1], t[2]}, 2, 1, {NULL}};
    return shapes_meet(&segment, true, &triangle);
}

bool oracle_mixes_entered(const double p[3], const oracle_mix part[3], const double *const t[3]) {
    simplex tetrahedron = {{p}, 3, 0, {NULL, &part[0], &part[1], &part[2]}};
    simplex triangle = {{t[0], t[1], t[2]}, 2, 3, {NULL}};
    return shapes_meet(&tetrahedron, true, &triangle);
}

/* Do s and t have a common point x with direction . (x - origin) > 0? */
static bool meet_beyond(const simplex *s, const simplex *t, const vector *direction,
                        const double origin[3]) {
    linear_system system = common_points(s, false, t);
    row *beyond = new_row(&system, ABOVE_ZERO);
    vector from;
    vector_init(&from);
    vector_set(&from, origin);
    mpq_t offset;
    mpq_init(offset);
    vector_dot(offset, direction, &from);
    mpq_neg(beyond->k[VARIABLES], offset);
    for (int k = 0; k < 3; k++) {
        linear_system one = {0};
        row *coordinate = new_row(&one, EQUAL_ZERO);
        add_coordinate(coordinate, s, k, 1);
        add_multiple(beyond, direction->x[k], coordinate);
        clear_system(&one);
    }
    mpq_clear(offset);
    vector_clear(&from);
    return solvable(&system);
}

/* Same for the direction or its opposite. */
static bool meet_off_plane(const simplex *s, const simplex *t, vector *direction,
                           const double origin[3]) {
    if (meet_beyond(s, t, direction, origin))
        return true;
    for (int k = 0; k < 3; k++)
        mpq_neg(direction->x[k], direction->x[k]);
    return meet_beyond(s, t, direction, origin);
}

/* Do they have a common point other than `point`? */
static bool meet_off_point(const simplex *s, const simplex *t, const double point[3]) {
    bool found = false;
    vector axis;
    vector_init(&axis);
    for (int k = 0; k < 3 && !found; k++) {
        for (int j = 0; j < 3; j++)
            mpq_set_ui(axis.x[j], j == k, 1);
        found = meet_off_plane(s, t, &axis, point);
    }
    vector_clear(&axis);
    return found;
}

/* Do they have a common point off the segment a b (a is not b)? Off its line means on one side of
 * one of three planes through it; on the line, before a or behind b. */
static bool meet_off_segment(const simplex *s, const simplex *t, const double a[3],
                             const double b[3]) {
    vector axis, along, side;
    vector_init(&axis);
    vector_init(&along);
    vector_init(&side);
    vector_difference(&along, b, a);
    bool found = meet_beyond(s, t, &along, b);
    for (int k = 0; k < 3 && !found; k++) {
        for (int j = 0; j < 3; j++)
            mpq_set_ui(axis.x[j], j == k, 1);
        vector_cross(&side, &along, &axis);
        found = meet_off_plane(s, t, &side, a);
    }
    vector_difference(&along, a, b);
    found = found || meet_beyond(s, t, &along, a);
    vector_clear(&axis);
    vector_clear(&along);
    vector_clear(&side);
    return found;
}

bool oracle_triangles_contact(const double *const s[3], const double *const t[3], int shared) {
    simplex first = {{s[0], s[1], s[2]}, 2, 0, {NULL}};
    simplex second = {{t[0], t[1], t[2]}, 2, 2, {NULL}};
    if (shared == 0)
        return shapes_meet(&first, false, &second);
    if (shared == 1 || (shared == 2 && same_point(s[0], s[1])))
        return meet_off_point(&first, &second, s[0]);
    if (shared == 2)
        return meet_off_segment(&first, &second, s[0], s[1]);
    return false;
}

/* ---- half-spaces ---- */

/* Adds n . (a - x) > 0 for the normal n = (b - a) x (c - a). */
static void add_half_space(linear_system *s, const double *const corner[3]) {
    row *inside = new_row(s, ABOVE_ZERO);
    vector n, a;
    vector_init(&n);
    vector_init(&a);
    normal(&n, corner[0], corner[1], corner[2]);
    vector_set(&a, corner[0]);
    vector_dot(inside->k[VARIABLES], &n, &a);
    for (int k = 0; k < 3; k++)
        mpq_neg(inside->k[k], n.x[k]);
    vector_clear(&n);
    vector_clear(&a);
}

/* Adds sign x >= sign limit for coordinate k. */
static void add_limit(linear_system *s, int k, int sign, double limit) {
    row *within = new_row(s, AT_LEAST_ZERO);
    mpq_set_si(within->k[k], sign, 1);
    mpq_set_d(within->k[VARIABLES], -sign * limit);
}

bool oracle_half_spaces_meet(const double *const *corners, int count, const double lower[3],
                             const double upper[3]) {
    linear_system s = {0};
    for (int i = 0; i < count; i++)
        add_half_space(&s, corners + 3 * i);
    for (int k = 0; k < 3 && lower != NULL; k++) {
        add_limit(&s, k, 1, lower[k]);
        add_limit(&s, k, -1, upper[k]);
    }
    return solvable(&s);
}

/* ---- winding number ---- */

typedef enum crossing { RAY_MISSES, RAY_CROSSES, RAY_GRAZES } crossing;

/* How the ray from p along d meets a triangle off p; *side is 1 if p lies on the inner side. d is
 * in the open cone of the corners if it is a positive combination of them. */
static crossing cross_triangle(const double p[3], const vector *d, const double *const t[3],
                               int *side) {
    vector corner[3];
    for (int i = 0; i < 3; i++) {
        vector_init(&corner[i]);
        vector_difference(&corner[i], t[i], p);
    }
    *side = determinant_sign(&corner[0], &corner[1], &corner[2]);
    int weight[3] = {determinant_sign(d, &corner[1], &corner[2]) * *side,
                     determinant_sign(&corner[0], d, &corner[2]) * *side,
                     determinant_sign(&corner[0], &corner[1], d) * *side};
    for (int i = 0; i < 3; i++)
        vector_clear(&corner[i]);
    if (*side == 0)
        return RAY_GRAZES; /* the caller decides */
    if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0)
        return RAY_MISSES;
    return weight[0] > 0 && weight[1] > 0 && weight[2] > 0 ? RAY_CROSSES : RAY_GRAZES;
}

/* Does the closed ray from p along d meet the triangle, in whose plane p lies? */
static bool ray_meets_flat(const double p[3], const double d[3], const double *const t[3]) {
    linear_system s = {0};
    simplex triangle = {{t[0], t[1], t[2]}, 2, 1, {NULL}};
    add_simplex(&s, &triangle, false);
    mpq_set_ui(new_row(&s, AT_LEAST_ZERO)->k[0], 1, 1);
    mpq_t x;
    mpq_init(x);
    for (int k = 0; k < 3; k++) {
        row *equation = new_row(&s, EQUAL_ZERO);
        add_coordinate(equation, &triangle, k, 1);
        mpq_set_d(x, -p[k]);
        mpq_add(equation->k[VARIABLES], equation->k[VARIABLES], x);
        mpq_set_d(equation->k[0], -d[k]);
    }
    mpq_clear(x);
    return solvable(&s);
}

static void corners(const double *vertices, const uint32_t *faces, size_t f, const double *t[3]) {
    for (int i = 0; i < 3; i++)
        t[i] = vertices + 3 * (size_t)faces[3 * f + (size_t)i];
}

/* Sums the crossings of one ray; false when it grazes a triangle. */
static bool count_crossings(const double *vertices, const uint32_t *faces, size_t face_count,
                            const double p[3], const double d[3], int *sum) {
    bool clean = true;
    vector direction;
    vector_init(&direction);
    vector_set(&direction, d);
    *sum = 0;
    for (size_t f = 0; f < face_count && clean; f++) {
        const double *t[3];
        int side;
        corners(vertices, faces, f, t);
        switch (cross_triangle(p, &direction, t, &side)) {
        case RAY_CROSSES:
            *sum += side;
            break;
        case RAY_GRAZES:
            clean = side == 0 && !ray_meets_flat(p, d, t);
            break;
        case RAY_MISSES:
            break;
        }
    }
    vector_clear(&direction);
    return clean;
}

static bool box_holds(const double *const t[3], const double p[3]) {
    for (int k = 0; k < 3; k++)
        if ((p[k] < t[0][k] && p[k] < t[1][k] && p[k] < t[2][k]) ||
            (p[k] > t[0][k] && p[k] > t[1][k] && p[k] > t[2][k]))
            return false;
    return true;
}

int oracle_winding(const double *vertices, const uint32_t *faces, size_t face_count,
                   const double p[3], bool *on_surface) {
    *on_surface = false;
    for (size_t f = 0; f < face_count && !*on_surface; f++) {
        const double *t[3];
        corners(vertices, faces, f, t);
        *on_surface = box_holds(t, p) && oracle_point_on_triangle(p, t[0], t[1], t[2]);
    }
    if (*on_surface)
        return 0;
    starg_rng rng = starg_rng_make(1, 2, 3);
    int sum;
    double d[3];
    do {
        for (int k = 0; k < 3; k++)
            d[k] = (double)starg_rng_below(&rng, 2001) - 1000;
    } while ((d[0] == 0 && d[1] == 0 && d[2] == 0) ||
             !count_crossings(vertices, faces, face_count, p, d, &sum));
    return sum;
}
