/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about the number of guards, and bounds for it. A bound for candidates, which the result
 * does not have, can only be refuted: by guards of the result that suffice (verify/needed.c). */
#include "core/memory.h"
#include "verify/claims.h"
#include "verify/everywhere.h"
#include "verify/facts.h"

/* A sufficient subset of the guards, which are candidates, refutes a larger lower bound. Not in
 * files of morph --guards, where `count` is the number of guards: those must suffice in another
 * shape, too. */
static starg_status claim_bound(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *certificate) {
    const starg_guards *guards = known->guards;
    size_t needed = guards->count;
    bool pairs = guards->options.candidates == STARG_CANDIDATES_GIVEN &&
                 guards->options.candidate_count == guards->count;
    starg_status status = pairs ? STARG_OK : verify_find_needed(known, &needed);
    if (status != STARG_OK)
        return status;
    if (needed < guards->lower_bound && guards->lower_bound <= guards->count)
        verify_claim(verdict, false,
                     "the lower bound %zu is at most the number of guards that would do: %zu of "
                     "the %zu guards do what was asked for",
                     guards->lower_bound, needed, guards->count);
    else
        verify_claim(verdict, guards->lower_bound <= guards->count,
                     "the lower bound %zu is at most the number of guards %zu", guards->lower_bound,
                     guards->count);
    bool follows = certificate != NULL && guards->lower_bound <= certificate->bound;
    if (guards->lower_bound > 0 && !follows)
        verify_leave(
            verdict, "that no fewer than %zu%s candidates would do%s", guards->lower_bound,
            guards->optimal ? " (\"optimal\")" : "",
            pairs ? ", nor fewer of the guards: in results of morph they stand for two shapes"
                  : "");
    return STARG_OK;
}

starg_status verify_claim_count(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *certificate) {
    starg_status status = STARG_OK;
    const starg_guards *guards = known->guards;
    verify_target goal = verify_target_of(known);
    /* with fewer guards than required per face, none may suffice */
    bool too_few =
        guards->options.max_guards != 0 && guards->options.max_guards < guards->options.redundancy;
    verify_claim(verdict, guards->count > 0 || goal.coverable == 0 || too_few,
                 "there are guards (%zu), unless nothing can be seen", guards->count);
    verify_claim(verdict, guards->count <= guards->candidate_count,
                 "%zu guards are among %zu candidates", guards->count, guards->candidate_count);
    if (guards->options.max_guards != 0)
        verify_claim(verdict, guards->count <= guards->options.max_guards,
                     "%zu guards are at most %zu", guards->count, guards->options.max_guards);
    verify_leave(verdict, "that there were %zu candidates: they are not in the file",
                 guards->candidate_count);
    STARG_TRY(claim_bound(verdict, known, certificate));
    bool equal = guards->lower_bound == guards->count;
    verify_claim(verdict, guards->optimal == equal,
                 "the result is called %s, with %zu guards and a lower bound of %zu",
                 guards->optimal ? "optimal" : "not proven optimal", guards->count,
                 guards->lower_bound);
    if (guards->lower_bound_everywhere > 0)
        verify_claim(
            verdict,
            guards->lower_bound_everywhere <= guards->lower_bound &&
                guards->optimal_everywhere == (guards->lower_bound_everywhere == guards->count),
            "the lower bound for guards anywhere, %zu, is at most that for candidates, and "
            "the result is called %s",
            guards->lower_bound_everywhere,
            guards->optimal_everywhere ? "the fewest possible" : "not proven such");
    if (certificate != NULL)
        STARG_TRY(verify_claim_everywhere(verdict, known, certificate));
    else if (guards->lower_bound_everywhere > 0)
        verify_leave_asked(
            verdict,
            "that at least %zu guards are needed, wherever they stand: the certificate "
            "would say why",
            guards->lower_bound_everywhere);
    double seen = verify_fraction(known->covered_area, known->total_area);
    verify_claim(verdict, seen <= guards->area_bound * (1 + VERIFY_TOLERANCE),
                 "the area seen, %.9g, is within its bound %.9g", seen, guards->area_bound);
    if (guards->area_bound < 1)
        verify_leave(verdict, "that so many candidates see at most a fraction of %.9g of the area",
                     guards->area_bound);
    if (guards->area_bound_everywhere > 0) {
        verify_claim(verdict, seen <= guards->area_bound_everywhere * (1 + VERIFY_TOLERANCE),
                     "the area seen, %.9g, is within the bound for guards anywhere, %.9g", seen,
                     guards->area_bound_everywhere);
        verify_leave_asked(
            verdict,
            "that so many guards see at most a fraction of %.9g of the area, wherever "
            "they stand",
            guards->area_bound_everywhere);
    }
done:
    return status;
}
