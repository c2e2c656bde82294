/* SPDX-License-Identifier: Apache-2.0 */
/* Redundancy: what fewer guards see than requested must be seen by no other candidate. The
 * candidates are not in the file. But where one of them sees an element, the solver looks for more
 * beside it: at random places in cubes around it whose sizes are halved from round to round.
 *
 * So places around the guards that see the most of such elements are drawn in the same way. If a
 * guard may stand at a quarter of them and sees an element from there, the search for candidates
 * cannot have missed all of them: two admissible places are shown for the element, and the result
 * is refuted. Signs are exact. Cost: that of HOSTS x ROUNDS x PLACES guards, if anything lacks. */

#include "core/rng.h"
#include "verify/facts.h"

static const char STAGE[] = "verify";

enum { HOSTS = 3, ROUNDS = 30, PLACES = 2, ENOUGH = ROUNDS * PLACES / 4, RNG_STAGE = 0x7265646e };

static const double FIRST_DISTANCE = 1.0 / 64; /* of the diagonal */

/* Do the options leave no excuse for the lack? */
static bool must_hold(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const starg_guard_options *o = &guards->options;
    return o->candidates != STARG_CANDIDATES_GIVEN && !(o->coverage < 1) && o->max_guards == 0 &&
           !guards->time_limited;
}

/* The guard that sees the most lacking elements that are not looked at yet; these are marked. */
static bool take_host(const verify_facts *known, const uint8_t *lacks, uint8_t *looked,
                      size_t *host) {
    const starg_bits *rows = verify_rows(known);
    size_t most = 0;
    for (size_t g = 0; g < rows->rows; g++) {
        size_t seen = 0;
        if (verify_is_kept(known->guards, g))
            continue; /* candidates were not looked for beside it */
        for (size_t j = 0; j < rows->columns; j++)
            seen += lacks[j] && !looked[j] && starg_bits_test(rows, g, j);
        if (seen > most) {
            most = seen;
            *host = g;
        }
    }
    for (size_t j = 0; j < rows->columns && most > 0; j++)
        looked[j] = looked[j] || starg_bits_test(rows, *host, j);
    return most > 0;
}

/* From how many places beside a guard are the lacking elements seen that it sees? */
static starg_status look_beside(const verify_facts *known, verify_sight *sight, size_t host,
                                const uint8_t *lacks, uint32_t *times, verify_lack *found) {
    const verify_surface *surface = known->surface;
    const starg_bits *rows = verify_rows(known);
    const verify_view view = verify_view_of(known->guards, host);
    starg_rng rng = starg_rng_make(0, RNG_STAGE, host);
    double distance = FIRST_DISTANCE * verify_diagonal(surface);
    memset(times, 0, rows->columns * sizeof *times);
    for (int i = 0; i < ROUNDS * PLACES && found->shown == VERIFY_NO_COLUMN; i++) {
        const uint8_t *vertices, *patches;
        double p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] =
                known->guards->positions[3 * host + k] + distance * (2 * starg_rng_unit(&rng) - 1);
        distance /= i % PLACES == PLACES - 1 ? 2 : 1;
        TRY(starg_check_cancel(surface->context, STAGE));
        if (!verify_admits(known, p))
            continue;
        TRY(verify_look(sight, p, &view, &vertices, &patches));
        const uint8_t *seen = verify_targets_vertices(known) ? vertices : patches;
        for (size_t j = 0; j < rows->columns && found->shown == VERIFY_NO_COLUMN; j++) {
            times[j] += seen[j] && lacks[j] && starg_bits_test(rows, host, j);
            if (times[j] < ENOUGH)
                continue;
            found->shown = j;
            memcpy(found->place, p, sizeof p);
        }
    }
    return STARG_OK;
}

static starg_status show_places(const verify_facts *known, const uint8_t *lacks,
                                verify_lack *found) {
    starg_context *context = known->surface->context;
    size_t columns = verify_rows(known)->columns, host = 0;
    SCOPED_BY(verify_sight_drop) verify_sight *sight = NULL;
    SCOPED uint32_t *times = NULL;
    SCOPED uint8_t *looked = NULL;
    TRY(verify_sight_create(known->surface, &sight));
    NEW(context, STAGE, times, columns);
    NEW_ZERO(context, STAGE, looked, columns);
    for (int i = 0; i < HOSTS && found->shown == VERIFY_NO_COLUMN; i++)
        if (take_host(known, lacks, looked, &host))
            TRY(look_beside(known, sight, host, lacks, times, found));
    return STARG_OK;
}

starg_status verify_find_lack(const verify_facts *known, verify_lack *found) {
    starg_context *context = known->surface->context;
    size_t columns = verify_rows(known)->columns;
    SCOPED uint32_t *held = NULL;
    SCOPED uint8_t *lacks = NULL;
    *found = (verify_lack){.shown = VERIFY_NO_COLUMN};
    if (known->guards->options.redundancy < 2 && known->guards->need_count == 0)
        return STARG_OK;
    TRY(verify_count_held(known, verify_rows(known), &held));
    NEW(context, STAGE, lacks, columns);
    for (size_t j = 0; j < columns; j++) {
        lacks[j] = held[j] > 0 && held[j] < verify_times(known, j);
        found->lacking += lacks[j];
    }
    if (found->lacking > 0 && must_hold(known))
        TRY(show_places(known, lacks, found));
    return STARG_OK;
}

/* By how many guards is each patch of a face seen? */
static size_t least_times(const verify_facts *known, const uint32_t *held, size_t face) {
    size_t least = SIZE_MAX;
    for (size_t j = verify_first_patch(known->surface, face);
         j < verify_first_patch(known->surface, face + 1); j++)
        least = held[j] < least ? held[j] : least;
    return least;
}

starg_status verify_count_met(const verify_facts *known, size_t *met) {
    const starg_guards *guards = known->guards;
    SCOPED uint32_t *held = NULL;
    *met = 0;
    TRY(verify_count_held(known, known->patches, &held));
    for (size_t i = 0; i < guards->need_count; i++) {
        size_t face = guards->needs[i].face;
        *met += face < known->surface->model_faces &&
                least_times(known, held, face) >=
                    verify_times(known, verify_first_patch(known->surface, face));
    }
    return STARG_OK;
}

starg_status verify_count_often(const verify_facts *known, size_t most, size_t *often) {
    SCOPED uint32_t *held = NULL;
    TRY(verify_count_held(known, known->patches, &held));
    memset(often, 0, most * sizeof *often);
    for (size_t f = 0; f < known->surface->model_faces; f++) {
        size_t times = verify_is_target(known->surface, f) ? least_times(known, held, f) : 0;
        for (size_t k = 0; k < most && k < times; k++)
            often[k]++;
    }
    return STARG_OK;
}
