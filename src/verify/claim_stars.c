/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about guards: star-shaped pieces by their certificates, and the
 * fraction of its vertices that each guard sees (verify/seen.c). */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";

/* Star-shapedness with respect to a guard: the guard is strictly on the inner side of every wall,
 * and the walls wind around it once. Both are exact.
 *
 * Why this is enough: the walls are closed (verify/facets.c). Seen from the guard every wall has
 * the same orientation, so each ray from it meets as many walls as the winding number says, one:
 * the piece is everything before that wall, and every point of it is visible. Positive tetrahedra
 * contain every point as often as the walls wind around it; here once or never: tetrahedra of a
 * piece do not overlap. */

static verify_certificate certify(const verify_pieces *pieces, size_t piece,
                                  const double guard[3]) {
    size_t begin = pieces->wall_start[piece], end = pieces->wall_start[piece + 1];
    for (size_t wall = begin; wall < end; wall++) {
        const double *t[3];
        verify_corners(pieces->walls, wall, t);
        if (verify_side(t[0], t[1], t[2], guard) <= 0)
            return (verify_certificate){.proof = VERIFY_BEHIND, .wall = wall};
    }
    verify_surface own = *pieces->walls;
    bool on_surface;
    own.faces += 3 * begin;
    own.face_count = end - begin;
    int winding = verify_winding(&own, NULL, own.face_count, guard, &on_surface);
    return (verify_certificate){.proof = winding == 1 ? VERIFY_PROVEN : VERIFY_WOUND,
                                .winding = winding};
}

starg_status verify_certify(const verify_pieces *pieces, const starg_pieces_report *report,
                            verify_certificate *certificates) {
    starg_status status = STARG_OK;
    for (size_t p = 0; p < pieces->piece_count && status == STARG_OK; p++) {
        certificates[p] = certify(pieces, p, report->pieces[p].guard);
        status = starg_check_cancel(pieces->context, STAGE);
    }
    return status;
}

static const double TOLERANCE = 1e-9; /* of fractions */

/* ---- star-shapedness ---- */

static void tell_failed_proof(const verify_context *own, const verify_certificate *failed,
                              const char *claim, size_t bad, size_t first) {
    if (failed->proof == VERIFY_BEHIND)
        verify_claim(own->verdict, false,
                     "%s: %zu are not, first piece %zu, whose guard is not strictly on the inner "
                     "side of %s",
                     claim, bad, first,
                     verify_facet_words(own, own->pieces->wall_facets[failed->wall]).text);
    else
        verify_claim(own->verdict, false,
                     "%s: %zu are not, first piece %zu, whose boundary winds %d times around its "
                     "guard",
                     claim, bad, first, failed->winding);
}

static void claim_star(const verify_context *own, const verify_certificate *certificates) {
    static const char claim[] = "pieces called star-shaped are so about their guards";
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0, called = 0, proven = 0;
    for (size_t p = report->piece_count; p-- > 0;) {
        bool good = certificates[p].proof == VERIFY_PROVEN;
        called += report->pieces[p].star;
        proven += good;
        if (report->pieces[p].star && !good) {
            bad++;
            first = p;
        }
    }
    if (bad > 0)
        tell_failed_proof(own, &certificates[first], claim, bad, first);
    else
        verify_claim(own->verdict, true, "%s (%zu of %zu, exactly proven)", claim, called,
                     report->piece_count);
    verify_claim(own->verdict, report->strictly_star == proven && called == proven,
                 "%zu pieces are strictly star-shaped (called so: %zu, found: %zu)",
                 report->strictly_star, called, proven);
    if (report->mode == STARG_DECOMPOSE_STRICT)
        verify_claim(own->verdict, proven == report->piece_count,
                     "in strict mode all %zu pieces are star-shaped (found: %zu)",
                     report->piece_count, proven);
}

/* If all vertices were tested the fraction must match; a sampled fraction may deviate by five times
 * its standard error. */
static bool agrees(const verify_seen *seen, double claimed) {
    double open = (double)(seen->pairs - seen->proven), all = (double)seen->pairs;
    if (seen->looked == seen->pairs - seen->proven)
        return fabs(claimed * all - (double)(seen->proven + seen->seen)) <= TOLERANCE * all;
    double share = (claimed * all - (double)seen->proven) / open;
    double drawn = (double)seen->looked, found = (double)seen->seen / drawn;
    if (!(share >= -TOLERANCE && share <= 1 + TOLERANCE))
        return false;
    return fabs(found - share) <= 5 * sqrt(fmax(share * (1 - share), 0) / drawn) + 5 / drawn;
}

static starg_status claim_seen(const verify_context *own, const verify_certificate *certificates) {
    verify_seen seen;
    TRY(verify_find_seen(own->pieces, own->report, certificates, &seen));
    double open = (double)(seen.pairs - seen.proven), share = 0;
    if (seen.looked > 0)
        share = (double)seen.seen / (double)seen.looked;
    verify_claim(own->verdict, agrees(&seen, own->report->visible_vertices),
                 "guards see a fraction of %.9g of their pieces' vertices (found: %.9g; %zu of "
                 "%zu lines tested)",
                 own->report->visible_vertices,
                 ((double)seen.proven + share * open) / (double)seen.pairs, seen.looked,
                 seen.pairs);
    if (seen.looked < seen.pairs - seen.proven)
        verify_leave(own->verdict, "whether guards see the %zu vertices to which no line was drawn",
                     seen.pairs - seen.proven - seen.looked);
    return STARG_OK;
}

/* ---- public function ---- */

starg_status verify_claim_stars(const verify_context *own) {
    SCOPED verify_certificate *certificates = NULL;
    if (!own->pieces->labels.good)
        return STARG_OK;
    NEW(own->context, STAGE, certificates, own->report->piece_count);
    TRY(verify_certify(own->pieces, own->report, certificates));
    claim_star(own, certificates);
    return claim_seen(own, certificates);
}
