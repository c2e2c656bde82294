/* SPDX-License-Identifier: Apache-2.0 */
/* Farkas' lemma for up to four half-spaces, in integers.
 *
 * Problem: the half-spaces n_i . x < d_i have no common point if factors f_i >= 0, not all zero,
 * make sum f_i (d_i - n_i . x) <= 0.
 *
 * In a box: any factors will do, and the sum is linear in x, so testing the corners of the box is
 * enough. Everywhere: sum f_i n_i = 0 and sum f_i d_i <= 0. For an irreducible set such factors are
 * unique up to scale and are minors of the normals. This also proves tight cases (such as a flat
 * intersection of the closed half-spaces), where rounded factors fail.
 *
 * Stages: normals and offsets as integers relative to one corner; factors, by the number of
 * half-spaces; the test of the definition, on which alone the answer depends.
 *
 * Degrees everywhere: normals 2, offsets 3, factors at most 6, sums 9; coordinates of up to
 * MOST_BITS bits keep the sums within the limbs of `exact`. Cost: some microseconds. */
#include "geometry/linear_program.h"

#include "geometry/exact.h"

enum { MOST = HALF_SPACES_MOST, MOST_BITS = 800 };

typedef struct system {
    int count;
    exact normal[MOST][3], offset[MOST];
    exact factor[MOST];
} system;

/* out = p q - r s */
static void minor(exact *out, const exact *p, const exact *q, const exact *r, const exact *s) {
    exact pq, rs;
    exact_multiply(&pq, p, q);
    exact_multiply(&rs, r, s);
    exact_subtract(out, &pq, &rs);
}

/* One component of u x v. */
static void cross(exact *out, const exact u[3], const exact v[3], int axis) {
    int y = (axis + 1) % 3, z = (axis + 2) % 3;
    minor(out, &u[y], &v[z], &u[z], &v[y]);
}

/* sum += p q */
static void add_product(exact *sum, const exact *p, const exact *q) {
    exact product, before = *sum;
    exact_multiply(&product, p, q);
    exact_add(sum, &before, &product);
}

/* out = p . q */
static void dot(exact *out, const exact p[3], const exact q[3]) {
    *out = (exact){.sign = 0};
    for (int k = 0; k < 3; k++)
        add_product(out, &p[k], &q[k]);
}

static void difference(exact out[3], const double p[3], const double q[3], int scale) {
    for (int k = 0; k < 3; k++) {
        exact x, y;
        exact_set(&x, p[k], scale);
        exact_set(&y, q[k], scale);
        exact_subtract(&out[k], &x, &y);
    }
}

/* out = (b - a) x (c - a), the outward normal. */
static void set_normal(exact out[3], const half_space *space, int scale) {
    exact u[3], v[3];
    difference(u, space->b, space->a, scale);
    difference(v, space->c, space->a, scale);
    for (int k = 0; k < 3; k++)
        cross(&out[k], u, v, k);
}

/* The common scale of all corners and of `more` further values. */
static int find_scale(const half_space *spaces, int count, const double *more, int more_count,
                      int *bits) {
    double values[9 * MOST + 6];
    int used = 0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            values[used++] = spaces[i].a[k];
            values[used++] = spaces[i].b[k];
            values[used++] = spaces[i].c[k];
        }
    for (int i = 0; i < more_count; i++)
        values[used++] = more[i];
    return exact_scale(values, (size_t)used, bits);
}

static bool set_up(system *s, const half_space *spaces, int count) {
    int bits, scale = find_scale(spaces, count, NULL, 0, &bits);
    if (bits > MOST_BITS)
        return false;
    s->count = count;
    for (int i = 0; i < count; i++) {
        exact corner[3];
        difference(corner, spaces[i].a, spaces[0].a, scale);
        set_normal(s->normal[i], &spaces[i], scale);
        dot(&s->offset[i], s->normal[i], corner);
    }
    return true;
}

/* Factors for which at least two components of sum f_i n_i vanish; all of them if the normals have
 * rank count - 1. */
static void choose_factors(system *s, int axis) {
    exact(*n)[3] = s->normal;
    if (s->count == 1) {
        s->factor[0] = (exact){.sign = 1, .count = 1, .limb = {1}};
    } else if (s->count == 2) {
        s->factor[0] = n[1][axis];
        s->factor[1] = n[0][axis];
        s->factor[1].sign = -s->factor[1].sign;
    } else if (s->count == 3) {
        for (int i = 0; i < 3; i++)
            cross(&s->factor[i], n[(i + 1) % 3], n[(i + 2) % 3], axis);
    } else {
        for (int i = 0; i < 4; i++) {
            exact u[3];
            const exact *p = n[(i + 1) % 4];
            for (int k = 0; k < 3; k++)
                cross(&u[k], n[(i + 2) % 4], n[(i + 3) % 4], k);
            dot(&s->factor[i], p, u);
            if (i % 2 == 1)
                s->factor[i].sign = -s->factor[i].sign;
        }
    }
}

/* Makes the factors >= 0 if their signs agree; false if they do not, or all are zero. */
static bool orient_factors(system *s) {
    int sign = 0;
    for (int i = 0; i < s->count; i++) {
        if (s->factor[i].sign * sign < 0)
            return false;
        if (s->factor[i].sign != 0)
            sign = s->factor[i].sign;
    }
    for (int i = 0; i < s->count; i++)
        s->factor[i].sign *= sign;
    return sign != 0;
}

/* Tests the definition: the normals cancel, and the offsets sum to at most 0. */
static bool factors_prove(const system *s) {
    for (int k = 0; k < 3; k++) {
        exact sum = {.sign = 0};
        for (int i = 0; i < s->count; i++)
            add_product(&sum, &s->factor[i], &s->normal[i][k]);
        if (sum.sign != 0)
            return false;
    }
    exact room = {.sign = 0};
    for (int i = 0; i < s->count; i++)
        add_product(&room, &s->factor[i], &s->offset[i]);
    return room.sign <= 0;
}

bool half_spaces_apart(const half_space *spaces, int count) {
    system s;
    if (count < 1 || count > MOST || !set_up(&s, spaces, count))
        return false;
    for (int axis = 0; axis < 3; axis++) {
        choose_factors(&s, axis);
        if (orient_factors(&s) && factors_prove(&s))
            return true;
    }
    return false;
}

/* Is the weighted sum of depths at x at most zero? */
static bool no_depth_at(const system *s, const half_space *spaces, const double x[3], int scale) {
    exact sum = {.sign = 0};
    for (int i = 0; i < s->count; i++) {
        exact to_plane[3], depth;
        difference(to_plane, spaces[i].a, x, scale);
        dot(&depth, s->normal[i], to_plane);
        add_product(&sum, &s->factor[i], &depth);
    }
    return sum.sign <= 0;
}

bool half_spaces_apart_in_box(const half_space *spaces, const double *weights, int count,
                              const double lower[3], const double upper[3]) {
    system s = {.count = count};
    double box[6];
    bool proven = false;
    for (int k = 0; k < 3; k++) {
        box[k] = lower[k];
        box[3 + k] = upper[k];
    }
    if (count < 1 || count > MOST)
        return false;
    int bits, scale = find_scale(spaces, count, box, 6, &bits);
    int weight_scale = exact_scale(weights, (size_t)count, &bits);
    for (int i = 0; i < count; i++) {
        if (!(weights[i] >= 0))
            return false;
        proven = proven || weights[i] > 0; /* not all are zero */
        set_normal(s.normal[i], &spaces[i], scale);
        exact_set(&s.factor[i], weights[i], weight_scale);
    }
    for (int corner = 0; corner < 8 && proven; corner++) {
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = box[3 * (corner >> k & 1) + k];
        proven = no_depth_at(&s, spaces, x, scale);
    }
    return proven;
}
