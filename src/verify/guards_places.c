/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about single guards: where they stand, and how much each sees. */
#include <math.h>

#include "verify/claims.h"
#include "verify/facts.h"
#include "verify/measure.h"
#include "verify/signs.h"
#include "verify/space.h"

static void claim_inside(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    for (size_t g = guards->count; g-- > 0;)
        if (!known->inside[g]) {
            bad++;
            first = g;
        }
    if (bad == 0) {
        verify_claim(verdict, true, "all %zu guards are strictly inside", guards->count);
        return;
    }
    const double *p = guards->positions + 3 * first;
    verify_claim(verdict, false,
                 "all %zu guards are strictly inside: %zu are not, first guard %zu at "
                 "(%.17g, %.17g, %.17g)",
                 guards->count, bad, first, p[0], p[1], p[2]);
}

static void claim_clearance(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    double wanted = guards->options.clearance;
    size_t bad = 0, first = 0;
    if (!(wanted > 0))
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!(known->distance[g] >= wanted * (1 - VERIFY_TOLERANCE))) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "guards keep a clearance of %.17g", wanted);
    else
        verify_claim(verdict, false,
                     "guards keep a clearance of %.17g: %zu do not, first guard %zu at a distance "
                     "of %.17g",
                     wanted, bad, first, known->distance[first]);
}

static bool stands_within(const verify_facts *known, size_t g) {
    const starg_space_options *o = &known->guards->space;
    const double *p = known->guards->positions + 3 * g;
    double distance = known->standoff[g];
    bool in = distance >= o->standoff_least * (1 - VERIFY_TOLERANCE) &&
              (o->standoff_most == 0 || distance <= o->standoff_most * (1 + VERIFY_TOLERANCE));
    bool boxed = false;
    for (int k = 0; k < 6; k++)
        boxed = boxed || o->within[k] != 0;
    for (int k = 0; boxed && k < 3; k++)
        in = in && p[k] >= o->within[k] && p[k] <= o->within[k + 3];
    return in;
}

static void claim_standoff(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    if (!verify_space_is_narrow(&guards->space))
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!stands_within(known, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "guards keep their distances from the model, and to their box");
    else
        verify_claim(verdict, false,
                     "guards keep their distances from the model, and to their box: %zu do not, "
                     "first guard %zu at a distance of %.17g",
                     bad, first, known->standoff[first]);
}

/* Is the guard straight above a listed face, and near one? Lists are searched one by one. */
static bool stands_by_faces(const verify_facts *known, size_t g) {
    const starg_space_options *o = &known->guards->space;
    const double *p = known->guards->positions + 3 * g;
    double foot[3], up[3] = {0, 1, 0}, length = 0, least = INFINITY;
    bool over = o->over_count == 0;
    for (int k = 0; k < 3; k++)
        length = hypot(length, o->up[k]);
    for (int k = 0; k < 3; k++) {
        up[k] = length > 0 ? o->up[k] / length : up[k];
        foot[k] = p[k] - o->height * (1 + VERIFY_TOLERANCE) * up[k];
    }
    for (size_t i = 0; i < o->over_count && !over; i++) {
        const double *t[3];
        verify_corners(known->surface, o->over[i], t);
        over = verify_blocks(p, foot, t);
    }
    for (size_t i = 0; i < o->mount_count; i++)
        least = fmin(least, verify_squared_distance(known->surface, o->mount[i], p, known->scale));
    return over && (o->mount_count == 0 || ldexp(sqrt(least), -known->scale) <=
                                               o->mount_distance * (1 + VERIFY_TOLERANCE));
}

static starg_status claim_reached(starg_verdict *verdict, const verify_facts *known) {
    const double *from = known->guards->space.from;
    bool known_cubes;
    size_t bad, first;
    if (!(known->guards->space.cell > 0))
        return STARG_OK;
    starg_status status = verify_find_unreached(known, &known_cubes, &bad, &first);
    if (status != STARG_OK)
        return status;
    if (!known_cubes)
        verify_leave(verdict,
                     "that guards can be reached from (%.17g, %.17g, %.17g): the cubes are "
                     "too small",
                     from[0], from[1], from[2]);
    else if (bad == 0)
        verify_claim(verdict, true, "guards can be reached from (%.17g, %.17g, %.17g)", from[0],
                     from[1], from[2]);
    else
        verify_claim(
            verdict, false,
            "guards can be reached from (%.17g, %.17g, %.17g): %zu cannot, first guard %zu",
            from[0], from[1], from[2], bad, first);
    return STARG_OK;
}

static void claim_faces_near(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    if (guards->space.over_count == 0 && guards->space.mount_count == 0)
        return;
    for (size_t g = guards->count; g-- > 0;)
        if (!stands_by_faces(known, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true,
                     "guards stand over, or hang near, the faces that they are bound to");
    else
        verify_claim(verdict, false,
                     "guards stand over, or hang near, the faces that they are bound to: %zu do "
                     "not, first guard %zu",
                     bad, first);
}

static void claim_seen(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t bad = 0, first = 0;
    for (size_t g = guards->count; g-- > 0;)
        if (guards->seen_faces[g] != starg_bits_count(known->faces, g)) {
            bad++;
            first = g;
        }
    if (bad == 0)
        verify_claim(verdict, true, "each guard sees as many faces as claimed");
    else
        verify_claim(verdict, false,
                     "each guard sees as many faces as claimed: %zu do not, first guard %zu, "
                     "claimed %zu, found %zu",
                     bad, first, guards->seen_faces[first], starg_bits_count(known->faces, first));
}

starg_status verify_claim_places(starg_verdict *verdict, const verify_facts *known) {
    starg_status status = STARG_OK;
    claim_inside(verdict, known);
    claim_clearance(verdict, known);
    claim_standoff(verdict, known);
    claim_faces_near(verdict, known);
    STARG_TRY(claim_reached(verdict, known));
    claim_seen(verdict, known);
done:
    return status;
}
