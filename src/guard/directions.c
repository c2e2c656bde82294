/* SPDX-License-Identifier: Apache-2.0 */
/* Where cones of view may look: directions spread evenly over the sphere by a golden spiral.
 *
 * A cone of half angle a takes the fraction (1 - cos a) / 2 of the sphere; OVERLAP times as many
 * directions as would fill it see nearly every group of faces that fits into a cone in one piece,
 * and refinement turns them further. Candidates are points times directions: beyond MOST of them,
 * points are left out evenly, with a notice. */
#include <math.h>

#include "guard/candidates.h"

enum { LEAST_DIRECTIONS = 12, MOST_DIRECTIONS = 500, MOST = 12000 };

static const double OVERLAP = 4, GOLDEN_ANGLE = 2.399963229728653;

static size_t direction_count(double cone) {
    double wanted = 2 * OVERLAP / (1 - starg_cone_cosine(cone));
    if (!(wanted < MOST_DIRECTIONS))
        return MOST_DIRECTIONS;
    return wanted < LEAST_DIRECTIONS ? LEAST_DIRECTIONS : (size_t)wanted;
}

static void spiral(size_t index, size_t count, double out[3]) {
    double z = 1 - (2 * (double)index + 1) / (double)count, r = sqrt(1 - z * z);
    double turn = GOLDEN_ANGLE * (double)index;
    out[0] = r * cos(turn);
    out[1] = r * sin(turn);
    out[2] = z;
}

starg_status candidates_turn(starg_context *context, const candidate_points *points, double cone,
                             candidate_points *out) {
    starg_status status = STARG_OK;
    size_t directions = direction_count(cone), count = candidates_count(points);
    size_t most = MOST / directions, used = count < most ? count : most;
    if (used < count)
        starg_log(context, STARG_LOG_NOTICE,
                  "using %zu of %zu candidates, each with %zu directions", used, count, directions);
    for (size_t i = 0; i < used; i++)
        for (size_t k = 0; k < directions; k++) {
            double direction[3];
            spiral(k, directions, direction);
            STARG_TRY(candidates_push(context, out, points->data.data + 3 * (i * count / used),
                                      direction));
        }
done:
    return status;
}
