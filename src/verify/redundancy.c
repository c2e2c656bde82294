/* SPDX-License-Identifier: Apache-2.0 */
/* Redundancy: what fewer guards see than requested must be seen by no other candidate. The
 * candidates are unknown, except for their number and that they are spread over the whole solid.
 *
 * If more than a tenth of what is seen lacks guards, points are sampled at random in the solid.
 * Every candidate that is not a guard must see nothing that lacks guards. If three of four sample
 * points see some, no set of at least MANY other candidates avoids it: a single cover posing as a
 * double one. If guards are lacking only because candidates are few, the lacking places are hard to
 * see and few points see any.
 *
 * Cost: that of VERIFY_PLACES guards, if needed. */
#include <math.h>

#include "core/memory.h"
#include "core/rng.h"
#include "verify/facts.h"
#include "verify/measure.h"

static const char STAGE[] = "verify";

enum { ATTEMPTS = 4096, MANY = 20, RNG_STAGE = 0x7265646e };

static bool is_place(const verify_facts *known, const double p[3]) {
    bool on_surface;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    return !on_surface && winding + known->surface->ambient >= 1 &&
           verify_tree_distance(known->tree, p, known->scale) >= known->guards->options.clearance;
}

/* Are there other candidates, and do the options give no excuse for the lack? */
static bool must_hold(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const starg_guard_options *o = &guards->options;
    return o->candidates != STARG_CANDIDATES_GIVEN && !(o->coverage < 1) && o->max_guards == 0 &&
           o->visibility.cone >= 360 && !guards->time_limited &&
           guards->candidate_count >= guards->count + MANY;
}

static starg_status look_about(const verify_facts *known, const uint8_t *lacks,
                               verify_lack *found) {
    starg_status status = STARG_OK;
    const verify_surface *surface = known->surface;
    const verify_view view = verify_view_of(known->guards, NULL);
    size_t columns = verify_rows(known)->columns;
    verify_sight *sight = NULL;
    starg_rng rng = starg_rng_make(0, RNG_STAGE, 0);
    STARG_TRY(verify_sight_create(surface, &sight));
    for (int i = 0; i < ATTEMPTS && found->points < VERIFY_PLACES; i++) {
        const uint8_t *vertices, *faces;
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] =
                surface->lower[k] + starg_rng_unit(&rng) * (surface->upper[k] - surface->lower[k]);
        STARG_TRY(starg_check_cancel(surface->context, STAGE));
        if (!is_place(known, p))
            continue;
        STARG_TRY(verify_look(sight, p, &view, &vertices, &faces));
        const uint8_t *seen = verify_targets_vertices(known) ? vertices : faces;
        bool meets = false;
        for (size_t j = 0; j < columns && !meets; j++)
            meets = seen[j] && lacks[j];
        found->points++;
        found->meeting += meets;
    }
done:
    verify_sight_free(sight);
    return status;
}

starg_status verify_find_lack(const verify_facts *known, verify_lack *found) {
    starg_status status = STARG_OK;
    starg_context *context = known->surface->context;
    size_t columns = verify_rows(known)->columns, seen = 0;
    uint32_t *held = NULL;
    uint8_t *lacks = NULL;
    *found = (verify_lack){0};
    if (known->guards->options.redundancy < 2)
        return STARG_OK;
    STARG_TRY(verify_count_held(known, &held));
    STARG_NEW(context, STAGE, lacks, columns);
    for (size_t j = 0; j < columns; j++) {
        lacks[j] = held[j] > 0 && held[j] < known->guards->options.redundancy;
        found->lacking += lacks[j];
        seen += held[j] > 0;
    }
    if (10 * found->lacking > seen && must_hold(known))
        STARG_TRY(look_about(known, lacks, found));
done:
    starg_release(context, held);
    starg_release(context, lacks);
    return status;
}
