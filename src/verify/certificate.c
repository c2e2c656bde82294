/* SPDX-License-Identifier: Apache-2.0 */
/* Star-shapedness with respect to a guard: the guard is strictly on the inner side of every wall,
 * and the walls wind around it once. Both are exact.
 *
 * Why this is enough: the walls are closed (verify/facets.c). Seen from the guard every wall has
 * the same orientation, so each ray from it meets as many walls as the winding number says, one:
 * the piece is everything before that wall, and every point of it is visible. Positive tetrahedra
 * contain every point as often as the walls wind around it; here once or never: tetrahedra of a
 * piece do not overlap. */
#include "verify/pieces.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";

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
