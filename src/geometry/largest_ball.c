/* SPDX-License-Identifier: Apache-2.0 */
/* Largest ball in an intersection of half-spaces, updated as half-spaces are added.
 *
 * Problem: maximize r over (x, r) with n_i . x + r <= b_i, where there are many half-spaces and
 * only those that the ball violates are added.
 *
 * Method: the dual simplex algorithm [Lemke 1954] in four variables. Four half-spaces are tight;
 * their weights w >= 0 with sum w_i n_i = 0 and sum w_i = 1 prove that no larger ball fits. A
 * violated half-space is written as a combination of the four; the ratio test picks the one to
 * replace so that all weights stay >= 0. Changing an offset does not change the weights: a
 * half-space is removed by moving it far away, which keeps the basis.
 *
 * Invariants: weights >= 0 up to rounding; the inverse is recomputed each time, so that errors do
 * not accumulate. Cost: some 200 operations per half-space added. */
#include "geometry/linear_program.h"

#include <math.h>
#include <string.h>

enum { UPDATES_MOST = 12 };

static const double TINY = 1e-11, SMALL = 1e-3;

/* inverse = inverse of the matrix with rows (normal, 1); false if singular. */
static bool invert(largest_ball *ball) {
    double m[4][8];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 8; k++)
            m[i][k] = k < 3 ? ball->normals[i][k] : k == 3 ? 1 : k == i + 4 ? 1 : 0;
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int i = c + 1; i < 4; i++)
            if (fabs(m[i][c]) > fabs(m[pivot][c]))
                pivot = i;
        if (fabs(m[pivot][c]) < TINY)
            return false;
        double swap[8];
        memcpy(swap, m[c], sizeof swap);
        memcpy(m[c], m[pivot], sizeof swap);
        memcpy(m[pivot], swap, sizeof swap);
        double scale = 1 / m[c][c];
        for (int k = c; k < 8; k++)
            m[c][k] *= scale;
        for (int i = 0; i < 4; i++) {
            double factor = m[i][c];
            if (i == c || factor == 0)
                continue;
            for (int k = c; k < 8; k++)
                m[i][k] -= factor * m[c][k];
        }
    }
    for (int i = 0; i < 4; i++)
        memcpy(ball->inverse[i], m[i] + 4, sizeof ball->inverse[i]);
    return true;
}

/* The inverse after replacing row `out` by a combination of the four with these factors. */
static bool replace(largest_ball *ball, int out, const double factors[4]) {
    if (factors[out] < SMALL || ++ball->updates == UPDATES_MOST) {
        ball->updates = 0;
        return invert(ball);
    }
    for (int i = 0; i < 4; i++) {
        double share = ball->inverse[i][out] / factors[out];
        for (int k = 0; k < 4; k++)
            ball->inverse[i][k] -= share * factors[k];
        ball->inverse[i][out] = share;
    }
    return true;
}

static void place(largest_ball *ball) {
    double at[4];
    for (int i = 0; i < 4; i++) {
        at[i] = 0;
        for (int k = 0; k < 4; k++)
            at[i] += ball->inverse[i][k] * ball->offsets[k];
    }
    memcpy(ball->center, at, sizeof ball->center);
    ball->radius = at[3];
}

void largest_ball_start(largest_ball *ball) {
    static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++)
            ball->normals[i][k] = corner[i][k] / sqrt(3);
        ball->offsets[i] = LARGEST_BALL_DISTANCE;
        ball->names[i] = LARGEST_BALL_FAR;
        ball->weights[i] = 0.25;
    }
    ball->updates = 0;
    invert(ball);
    place(ball);
}

/* The slot that the new half-space takes, given its normal as a combination of the four. */
static int leaving(const largest_ball *ball, const double factors[4]) {
    int best = -1;
    double least = INFINITY;
    for (int i = 0; i < 4; i++) {
        if (factors[i] <= 1e-9)
            continue;
        double ratio = fmax(ball->weights[i], 0) / factors[i];
        if (ratio < least || (ratio == least && factors[i] > factors[best])) {
            least = ratio;
            best = i;
        }
    }
    return best;
}

bool largest_ball_add(largest_ball *ball, const double normal[3], double offset, uint32_t name) {
    double factors[4];
    for (int i = 0; i < 4; i++)
        factors[i] = normal[0] * ball->inverse[0][i] + normal[1] * ball->inverse[1][i] +
                     normal[2] * ball->inverse[2][i] + ball->inverse[3][i];
    int out = leaving(ball, factors);
    if (out < 0)
        return false;
    memcpy(ball->normals[out], normal, sizeof ball->normals[out]);
    ball->offsets[out] = offset;
    ball->names[out] = name;
    if (!replace(ball, out, factors))
        return false;
    for (int i = 0; i < 4; i++)
        ball->weights[i] = ball->inverse[3][i];
    place(ball);
    return true;
}

void largest_ball_move(largest_ball *ball, int at, double offset, uint32_t name) {
    ball->offsets[at] = offset;
    ball->names[at] = name;
    place(ball);
}
