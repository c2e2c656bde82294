/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about single guards: where they stand, and how much each sees. */
#include <math.h>

#include "verify/facts.h"
#include "verify/sight.h"
#include "verify/signs.h"
#include "verify/surface.h"

/* The guards that a claim does not hold for. */
typedef struct exceptions {
    size_t count, first;
} exceptions;

static exceptions find_exceptions(const verify_facts *known,
                                  bool (*holds)(const verify_facts *known, size_t guard)) {
    exceptions found = {0, 0};
    for (size_t g = 0; g < known->guards->count; g++)
        if (!holds(known, g) && found.count++ == 0)
            found.first = g;
    return found;
}

static bool is_inside(const verify_facts *known, size_t g) {
    return known->inside[g];
}

static void claim_inside(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const exceptions bad = find_exceptions(known, is_inside);
    if (bad.count == 0) {
        verify_claim(verdict, true, "all %zu guards are strictly inside", guards->count);
        return;
    }
    const double *p = guards->positions + 3 * bad.first;
    verify_claim(verdict, false,
                 "all %zu guards are strictly inside: %zu are not, first guard %zu at "
                 "(%.9g, %.9g, %.9g)",
                 guards->count, bad.count, bad.first, p[0], p[1], p[2]);
}

static bool keeps_clearance(const verify_facts *known, size_t g) {
    return known->distance[g] >= known->guards->options.clearance * (1 - VERIFY_TOLERANCE);
}

static void claim_clearance(starg_verdict *verdict, const verify_facts *known) {
    double wanted = known->guards->options.clearance;
    if (!(wanted > 0))
        return;
    const exceptions bad = find_exceptions(known, keeps_clearance);
    if (bad.count == 0)
        verify_claim(verdict, true, "guards keep a clearance of %.9g", wanted);
    else
        verify_claim(verdict, false,
                     "guards keep a clearance of %.9g: %zu do not, first guard %zu at a distance "
                     "of %.9g",
                     wanted, bad.count, bad.first, known->distance[bad.first]);
}

static bool is_within(const verify_facts *known, const double p[3], double distance) {
    const starg_space_options *o = &known->guards->space;
    bool in = distance >= o->standoff_least * (1 - VERIFY_TOLERANCE) &&
              (o->standoff_most == 0 || distance <= o->standoff_most * (1 + VERIFY_TOLERANCE));
    bool boxed = false;
    for (int k = 0; k < 6; k++)
        boxed = boxed || o->within[k] != 0;
    for (int k = 0; boxed && k < 3; k++)
        in = in && p[k] >= o->within[k] && p[k] <= o->within[k + 3];
    return in;
}

static bool stands_within(const verify_facts *known, size_t g) {
    return is_within(known, known->guards->positions + 3 * g, known->standoff[g]);
}

static void claim_standoff(starg_verdict *verdict, const verify_facts *known) {
    if (!verify_space_is_narrow(&known->guards->space))
        return;
    const exceptions bad = find_exceptions(known, stands_within);
    if (bad.count == 0)
        verify_claim(verdict, true, "guards keep their distances from the model, and to their box");
    else
        verify_claim(verdict, false,
                     "guards keep their distances from the model, and to their box: %zu do not, "
                     "first guard %zu at a distance of %.9g",
                     bad.count, bad.first, known->standoff[bad.first]);
}

/* Is p straight above a listed face, and near one? Lists are searched one by one. */
static bool is_by_faces(const verify_facts *known, const double p[3]) {
    const starg_space_options *o = &known->guards->space;
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

static bool stands_by_faces(const verify_facts *known, size_t g) {
    return is_by_faces(known, known->guards->positions + 3 * g);
}

bool verify_admits(const verify_facts *known, const double p[3]) {
    const verify_surface *surface = known->surface;
    bool on_surface;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    if (on_surface || winding + surface->ambient < 1 ||
        verify_tree_distance(known->tree, p, known->scale) < known->guards->options.clearance)
        return false;
    return !verify_space_is_narrow(&known->guards->space) ||
           (is_within(known, p, verify_distance(surface, p, surface->model_faces, known->scale)) &&
            is_by_faces(known, p));
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
                     "that guards can be reached from (%.9g, %.9g, %.9g): the cubes are "
                     "too small",
                     from[0], from[1], from[2]);
    else if (bad == 0)
        verify_claim(verdict, true, "guards can be reached from (%.9g, %.9g, %.9g)", from[0],
                     from[1], from[2]);
    else
        verify_claim(verdict, false,
                     "guards can be reached from (%.9g, %.9g, %.9g): %zu cannot, first guard %zu",
                     from[0], from[1], from[2], bad, first);
    return STARG_OK;
}

static void claim_faces_near(starg_verdict *verdict, const verify_facts *known) {
    const starg_space_options *space = &known->guards->space;
    if (space->over_count == 0 && space->mount_count == 0)
        return;
    const exceptions bad = find_exceptions(known, stands_by_faces);
    if (bad.count == 0)
        verify_claim(verdict, true,
                     "guards stand over, or hang near, the faces that they are bound to");
    else
        verify_claim(verdict, false,
                     "guards stand over, or hang near, the faces that they are bound to: %zu do "
                     "not, first guard %zu",
                     bad.count, bad.first);
}

static bool sees_as_claimed(const verify_facts *known, size_t g) {
    return known->guards->seen_faces[g] == starg_bits_count(known->faces, g);
}

static void claim_seen(starg_verdict *verdict, const verify_facts *known) {
    const exceptions bad = find_exceptions(known, sees_as_claimed);
    if (bad.count == 0)
        verify_claim(verdict, true, "each guard sees as many faces as claimed");
    else
        verify_claim(verdict, false,
                     "each guard sees as many faces as claimed: %zu do not, first guard %zu, "
                     "claimed %zu, found %zu",
                     bad.count, bad.first, known->guards->seen_faces[bad.first],
                     starg_bits_count(known->faces, bad.first));
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
