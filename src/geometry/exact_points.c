/* SPDX-License-Identifier: Apache-2.0 */
/* Rational points: constructions by Cramer's rule, signs of determinants of homogeneous
 * coordinates, rounding by long division. Cost: 0.1-2 us where the filter does not decide. */
#include "geometry/exact_points.h"

#include <stdlib.h>

#include "core/rng.h"

static const char STAGE[] = "exact points";

enum { FIRST_SLOTS = 256 };

/* ---- integers ---- */

static int bit_length(const exact *a) {
    return a->count == 0 ? 0 : 64 * a->count - __builtin_clzll(a->limb[a->count - 1]);
}

/* out = |a| 2^bits */
static void shift_left(exact *out, const exact *a, int bits) {
    int words = bits / 64, rest = bits % 64;
    memset(out->limb, 0, (size_t)words * sizeof *out->limb);
    uint64_t carry = 0;
    for (int i = 0; i < a->count; i++) {
        out->limb[words + i] = a->limb[i] << rest | carry;
        carry = rest == 0 ? 0 : a->limb[i] >> (64 - rest);
    }
    out->count = a->count + words;
    if (carry != 0)
        out->limb[out->count++] = carry;
    out->sign = 1;
}

static void copy(exact *out, const exact *a) {
    out->sign = a->sign;
    out->count = a->count;
    memcpy(out->limb, a->limb, (size_t)a->count * sizeof *a->limb);
}

/* Nearest double to a / b 2^scale, b > 0. Both are shifted to the same length, so that 56 steps of
 * long division give 55 or 56 bits of the quotient; the remainder only breaks ties. */
static double round_quotient(const exact *a, const exact *b, int scale) {
    if (a->sign == 0)
        return 0;
    exact rest[2], divisor;
    int shift = bit_length(b) - bit_length(a), now = 0;
    shift_left(&rest[0], a, shift > 0 ? shift : 0);
    shift_left(&divisor, b, shift < 0 ? -shift : 0);
    uint64_t quotient = 0;
    for (int i = 0; i < 56; i++) {
        exact difference;
        exact_subtract(&difference, &rest[now], &divisor);
        quotient *= 2;
        if (difference.sign >= 0) {
            quotient |= 1;
            copy(&rest[now], &difference);
        }
        exact_add(&rest[1 - now], &rest[now], &rest[now]);
        now = 1 - now;
    }
    quotient |= rest[now].sign != 0;
    return a->sign * ldexp((double)quotient, scale - shift - 55);
}

/* out = x a - y b, coordinate by coordinate, for points a, b of weight 1. */
static void combine(exact_point *out, const exact a[3], const exact *x, const exact b[3],
                    const exact *y) {
    for (int k = 0; k < 3; k++)
        exact_minor(&out->x[k], &a[k], x, &b[k], y);
}

static void make_positive(exact_point *out) {
    if (out->x[3].sign < 0)
        for (int k = 0; k < 4; k++)
            out->x[k].sign = -out->x[k].sign;
}

static void set_vertex(exact out[3], const double p[3], int scale) {
    for (int k = 0; k < 3; k++)
        exact_set(&out[k], p[k], scale);
}

static void dot(exact *out, const exact a[3], const exact b[3]) {
    exact product, sum;
    exact_multiply(&sum, &a[0], &b[0]);
    exact_multiply(&product, &a[1], &b[1]);
    exact_add(out, &sum, &product);
    copy(&sum, out);
    exact_multiply(&product, &a[2], &b[2]);
    exact_add(out, &sum, &product);
}

/* ---- constructions ---- */

void exact_plane_set(exact_plane *out, const double *const corner[3], int scale) {
    exact p[3][3], side[2][3];
    for (int i = 0; i < 3; i++)
        set_vertex(p[i], corner[i], scale);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            exact_subtract(&side[i][k], &p[i + 1][k], &p[0][k]);
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        exact_minor(&out->normal[k], &side[0][u], &side[1][v], &side[0][v], &side[1][u]);
    }
    dot(&out->offset, out->normal, p[0]);
}

/* Fills `rounded` from x, which the caller set. */
static void round_point(exact_point *point, int scale) {
    for (int k = 0; k < 3; k++)
        point->rounded[k] = round_quotient(&point->x[k], &point->x[3], scale);
}

void exact_point_set(exact_point *out, const double p[3], int scale) {
    set_vertex(out->x, p, scale);
    out->x[3].sign = out->x[3].count = 1;
    out->x[3].limb[0] = 1;
    for (int k = 0; k < 3; k++)
        out->rounded[k] = p[k] + 0.0; /* no -0: equal points have equal bits */
}

/* The zero on line p q of a linear function with values at_p and at_q. */
static void set_zero(exact_point *out, const exact p[3], const exact *at_p, const exact q[3],
                     const exact *at_q, int scale) {
    combine(out, p, at_q, q, at_p);
    exact_subtract(&out->x[3], at_q, at_p);
    make_positive(out);
    round_point(out, scale);
}

void exact_point_on_plane(exact_point *out, const double p[3], const double q[3],
                          const exact_plane *plane, int scale) {
    exact x[2][3], product, value[2];
    set_vertex(x[0], p, scale);
    set_vertex(x[1], q, scale);
    for (int i = 0; i < 2; i++) {
        dot(&product, plane->normal, x[i]);
        exact_subtract(&value[i], &product, &plane->offset);
    }
    set_zero(out, x[0], &value[0], x[1], &value[1], scale);
}

void exact_point_on_line(exact_point *out, const double p[3], const double q[3], const double a[3],
                         const double b[3], int u, int v, int scale) {
    exact x[4][3], along[2], across[2], value[2];
    const double *points[4] = {p, q, a, b};
    for (int i = 0; i < 4; i++)
        set_vertex(x[i], points[i], scale);
    exact_subtract(&along[0], &x[3][u], &x[2][u]);
    exact_subtract(&along[1], &x[3][v], &x[2][v]);
    for (int i = 0; i < 2; i++) {
        exact_subtract(&across[0], &x[i][u], &x[2][u]);
        exact_subtract(&across[1], &x[i][v], &x[2][v]);
        exact_minor(&value[i], &along[0], &across[1], &along[1], &across[0]);
    }
    set_zero(out, x[0], &value[0], x[1], &value[1], scale);
}

void exact_point_of_planes(exact_point *out, const exact_plane *const plane[3], int scale) {
    exact row[3][3];
    for (int column = 0; column < 4; column++) {
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                copy(&row[i][k], k == column ? &plane[i]->offset : &plane[i]->normal[k]);
        exact_determinant(&out->x[column], row[0], row[1], row[2]);
    }
    make_positive(out);
    round_point(out, scale);
}

void exact_point_between(exact_point *out, const exact_point *const corner[3],
                         const uint32_t weight[3], int scale) {
    exact factor[3], product, sum, whole = {0};
    for (int i = 0; i < 3;
         i++) { /* the other two weights times the coordinates, and its own share */
        exact share = {.sign = 1, .count = 1, .limb = {weight[i]}};
        exact_multiply(&product, &corner[(i + 1) % 3]->x[3], &corner[(i + 2) % 3]->x[3]);
        exact_multiply(&factor[i], &product, &share);
        exact_multiply(&product, &factor[i], &corner[i]->x[3]);
        exact_add(&sum, &whole, &product);
        copy(&whole, &sum);
    }
    copy(&out->x[3], &whole);
    for (int k = 0; k < 3; k++) {
        exact total = {0};
        for (int i = 0; i < 3; i++) {
            exact_multiply(&product, &corner[i]->x[k], &factor[i]);
            exact_add(&sum, &total, &product);
            copy(&total, &sum);
        }
        copy(&out->x[k], &total);
    }
    round_point(out, scale);
}

/* ---- signs ---- */

/* The turn of the rounded points if it is certain, else 0. Each coordinate is off by at most 2^-53
 * of the largest magnitude m, each difference by 4 x 2^-53 m; the resulting error of the
 * determinant, with the roundings here, is below half the bound. Below 1e-250 underflow could
 * matter. */
static int certain_turn(const double *a, const double *b, const double *c, int u, int v) {
    double au = a[u] - c[u], av = a[v] - c[v], bu = b[u] - c[u], bv = b[v] - c[v];
    double m = fmax(fmax(fmax(fabs(a[u]), fabs(a[v])), fmax(fabs(b[u]), fabs(b[v]))),
                    fmax(fabs(c[u]), fabs(c[v])));
    double left = au * bv, right = av * bu, turn = left - right;
    double bound = 0x1p-50 * m * (fabs(au) + fabs(av) + fabs(bu) + fabs(bv)) +
                   0x1p-50 * (fabs(left) + fabs(right)) + 0x1p-98 * m * m;
    return bound > 1e-250 && fabs(turn) > bound ? (turn > 0) - (turn < 0) : 0;
}

static int turn_of_rows(const exact a[3], const exact b[3], const exact c[3]) {
    exact determinant;
    exact_determinant(&determinant, a, b, c);
    return determinant.sign;
}

int exact_turn(const exact_point *a, const exact_point *b, const exact_point *c, int u, int v) {
    int turn = certain_turn(a->rounded, b->rounded, c->rounded, u, v);
    if (turn != 0)
        return turn;
    const exact_point *point[3] = {a, b, c};
    exact row[3][3];
    for (int i = 0; i < 3; i++) {
        copy(&row[i][0], &point[i]->x[u]);
        copy(&row[i][1], &point[i]->x[v]);
        copy(&row[i][2], &point[i]->x[3]);
    }
    return turn_of_rows(row[0], row[1], row[2]);
}

int exact_side(const exact_plane *plane, const exact_point *point) {
    exact height, offset, difference;
    dot(&height, plane->normal, point->x);
    exact_multiply(&offset, &plane->offset, &point->x[3]);
    exact_subtract(&difference, &height, &offset);
    return difference.sign;
}

/* ---- a set of points ---- */

void exact_points_free(exact_points *set) {
    RELEASE(set->points.data, set->limbs.data, set->slots);
}

static void load(const exact_points *set, uint32_t number, int k, exact *out) {
    const exact_entry *entry = &set->points.data[number];
    size_t limb = entry->limb;
    for (int i = 0; i < k; i++)
        limb += (size_t)abs(entry->count[i]);
    out->count = abs(entry->count[k]);
    out->sign = (entry->count[k] > 0) - (entry->count[k] < 0);
    memcpy(out->limb, set->limbs.data + limb, (size_t)out->count * sizeof *out->limb);
}

void exact_points_get(const exact_points *set, uint32_t number, exact_point *out) {
    for (int k = 0; k < 4; k++)
        load(set, number, k, &out->x[k]);
    memcpy(out->rounded, exact_points_rounded(set, number), sizeof out->rounded);
}

/* Sign of a's coordinate minus b's, compared as quotients. */
static int compare_quotients(const exact *a, const exact *a_weight, const exact *b,
                             const exact *b_weight) {
    exact difference;
    exact_minor(&difference, a, b_weight, b, a_weight);
    return difference.sign;
}

static bool is_point(const exact_points *set, uint32_t number, const exact_point *point) {
    const double *rounded = exact_points_rounded(set, number);
    for (int k = 0; k < 3; k++)
        if (rounded[k] != point->rounded[k])
            return false;
    exact weight, own;
    load(set, number, 3, &weight);
    for (int k = 0; k < 3; k++) {
        load(set, number, k, &own);
        if (compare_quotients(&own, &weight, &point->x[k], &point->x[3]) != 0)
            return false;
    }
    return true;
}

static size_t home_slot(const double rounded[3], size_t slot_count) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &rounded[k], sizeof bits);
        hash = starg_hash64(hash ^ bits);
    }
    return (size_t)hash & (slot_count - 1);
}

static starg_status grow_slots(exact_points *set) {
    size_t count = set->slot_count ? 2 * set->slot_count : FIRST_SLOTS;
    uint32_t *slots;
    NEW_ZERO(set->context, STAGE, slots, count);
    for (uint32_t i = 0; i < set->points.count; i++) {
        size_t slot = home_slot(exact_points_rounded(set, i), count);
        while (slots[slot] != 0)
            slot = (slot + 1) & (count - 1);
        slots[slot] = i + 1;
    }
    starg_release(set->context, set->slots);
    set->slots = slots;
    set->slot_count = count;
    return STARG_OK;
}

starg_status exact_points_add(exact_points *set, const exact_point *point, uint32_t *number) {
    if (2 * (set->points.count + 1) > set->slot_count)
        TRY(grow_slots(set));
    size_t slot = home_slot(point->rounded, set->slot_count);
    for (; set->slots[slot] != 0; slot = (slot + 1) & (set->slot_count - 1)) {
        *number = set->slots[slot] - 1;
        if (is_point(set, *number, point))
            return STARG_OK;
    }
    exact_entry entry = {.limb = set->limbs.count};
    memcpy(entry.rounded, point->rounded, sizeof entry.rounded);
    for (int k = 0; k < 4; k++) {
        entry.count[k] = (int16_t)(point->x[k].sign * point->x[k].count);
        for (int i = 0; i < point->x[k].count; i++)
            PUSH(set->context, STAGE, &set->limbs, point->x[k].limb[i]);
    }
    *number = (uint32_t)set->points.count;
    PUSH(set->context, STAGE, &set->points, entry);
    set->slots[slot] = *number + 1;
    return STARG_OK;
}

int exact_points_turn(const exact_points *set, uint32_t a, uint32_t b, uint32_t c, int u, int v) {
    if (a == b || b == c || c == a)
        return 0;
    int turn = certain_turn(exact_points_rounded(set, a), exact_points_rounded(set, b),
                            exact_points_rounded(set, c), u, v);
    if (turn != 0)
        return turn;
    const uint32_t point[3] = {a, b, c};
    exact row[3][3];
    for (int i = 0; i < 3; i++) {
        load(set, point[i], u, &row[i][0]);
        load(set, point[i], v, &row[i][1]);
        load(set, point[i], 3, &row[i][2]);
    }
    return turn_of_rows(row[0], row[1], row[2]);
}

int exact_points_compare(const exact_points *set, uint32_t a, uint32_t b, int k) {
    double x = exact_points_rounded(set, a)[k], y = exact_points_rounded(set, b)[k];
    if (x != y)
        return x > y ? 1 : -1;
    exact left, left_weight, right, right_weight;
    load(set, a, k, &left);
    load(set, a, 3, &left_weight);
    load(set, b, k, &right);
    load(set, b, 3, &right_weight);
    return compare_quotients(&left, &left_weight, &right, &right_weight);
}
