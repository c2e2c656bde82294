/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about single guards: where they stand, and how much each sees. */
#include <math.h>

#include "verify/facts.h"

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

/* Guards that were given to stay come first, and are as many as told. */
static void claim_kept(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    size_t told = guards->options.keep_count, count = verify_count_kept(guards), first = 0;
    while (first < guards->count && verify_is_kept(guards, first))
        first++;
    if (told > 0 || count > 0)
        verify_claim(verdict, count == told && first == count,
                     "%zu guards stay, and come first (found: %zu, of which the first %zu)", told,
                     count, first);
}

static bool keeps_clearance(const verify_facts *known, size_t g) {
    return verify_is_kept(known->guards, g) ||
           known->distance[g] >= known->guards->options.clearance * (1 - VERIFY_TOLERANCE);
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

/* The angle of a direction above the horizon, by tangents. */
static bool is_tilted(const verify_facts *known, size_t g) {
    const starg_visibility_options *o = &known->guards->options.visibility;
    const double *d = known->guards->directions + 3 * g;
    bool plain = o->up[0] == 0 && o->up[1] == 0 && o->up[2] == 0;
    const double up[3] = {o->up[0], plain ? 1 : o->up[1], o->up[2]};
    double rise = d[0] * up[0] + d[1] * up[1] + d[2] * up[2];
    double run = hypot(hypot(d[1] * up[2] - d[2] * up[1], d[2] * up[0] - d[0] * up[2]),
                       d[0] * up[1] - d[1] * up[0]);
    double angle = atan2(rise, run) * (180 / 3.14159265358979323846);
    return verify_is_kept(known->guards, g) ||
           (angle >= o->tilt[0] - 2e-6 && angle <= o->tilt[1] + 2e-6);
}

static void claim_tilt(starg_verdict *verdict, const verify_facts *known) {
    const starg_visibility_options *o = &known->guards->options.visibility;
    if (o->tilt[0] == STARG_TILT_ANY || known->guards->directions == NULL)
        return;
    const exceptions bad = find_exceptions(known, is_tilted);
    verify_claim_all(verdict, bad.count, bad.first,
                     "guards look %g to %g degrees above the horizon", o->tilt[0], o->tilt[1]);
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
    return verify_is_kept(known->guards, g) ||
           is_within(known, known->guards->positions + 3 * g, known->standoff[g]);
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
    return verify_is_kept(known->guards, g) || is_by_faces(known, known->guards->positions + 3 * g);
}

bool verify_admits(const verify_facts *known, const double p[3]) {
    const verify_surface *surface = known->surface;
    bool on_surface;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    if (on_surface || winding + surface->ambient < 1 ||
        verify_tree_distance(known->tree, p, known->scale) < known->guards->options.clearance)
        return false;
    if (!verify_zones_admit(known->zones, p))
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
    TRY(verify_find_unreached(known, &known_cubes, &bad, &first));
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

static bool stands_in_zones(const verify_facts *known, size_t g) {
    return verify_is_kept(known->guards, g) ||
           verify_zones_admit(known->zones, known->guards->positions + 3 * g);
}

static void claim_zones(starg_verdict *verdict, const verify_facts *known) {
    if (known->zones == NULL)
        return;
    const exceptions bad = find_exceptions(known, stands_in_zones);
    verify_claim_all(verdict, bad.count, bad.first,
                     "guards stand in zones where they may, and in none where they may not");
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
    return known->guards->seen_faces[g] == known->seen_faces[g];
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
                     known->seen_faces[bad.first]);
}

starg_status verify_claim_places(starg_verdict *verdict, const verify_facts *known) {
    claim_inside(verdict, known);
    claim_kept(verdict, known);
    claim_tilt(verdict, known);
    claim_clearance(verdict, known);
    claim_standoff(verdict, known);
    claim_zones(verdict, known);
    claim_faces_near(verdict, known);
    TRY(claim_reached(verdict, known));
    claim_seen(verdict, known);
    return STARG_OK;
}
