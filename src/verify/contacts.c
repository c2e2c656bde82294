/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of pieces. For each piece the areas of its walls towards later pieces are summed,
 * compared with the report's list for that piece, and reset. Cost: O(walls + contacts listed). */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-9; /* relative */

typedef struct ledger {
    const verify_pieces *pieces;
    const starg_pieces_report *report;
    size_t *start;                 /* of each piece's contacts in `listed`, by first piece */
    uint32_t *listed;              /* contacts of the report */
    double *area;                  /* towards each piece, from the current one */
    uint8_t *open;                 /* 1: touched, and not yet found in the report */
    STARG_ARRAY(uint32_t) touched; /* pieces with nonzero area */
    verify_contacts *result;
} ledger;

static void note(ledger *own, uint32_t first, uint32_t second, double listed, double found) {
    verify_contacts *result = own->result;
    if (result->wrong++ == 0)
        *result = (verify_contacts){1, first, second, listed, found};
}

/* Is this a pair of distinct pieces in ascending order? */
static bool is_pair(const ledger *own, const starg_piece_contact *contact) {
    return contact->first < contact->second && contact->second < own->pieces->piece_count;
}

static starg_status sort_listed(ledger *own) {
    starg_context *context = own->pieces->context;
    const starg_pieces_report *report = own->report;
    size_t count = own->pieces->piece_count;
    NEW_ZERO(context, STAGE, own->start, count + 1);
    NEW(context, STAGE, own->listed, report->contact_count);
    for (size_t i = 0; i < report->contact_count; i++) {
        const starg_piece_contact *contact = &report->contacts[i];
        if (is_pair(own, contact))
            own->start[contact->first]++;
        else
            note(own, contact->first, contact->second, contact->area, 0);
    }
    for (size_t p = 1; p <= count; p++)
        own->start[p] += own->start[p - 1];
    for (size_t i = report->contact_count; i-- > 0;)
        if (is_pair(own, &report->contacts[i]))
            own->listed[--own->start[report->contacts[i].first]] = (uint32_t)i;
    return STARG_OK;
}

/* The piece on the other side of a wall, or VERIFY_NONE. */
static uint32_t verify_beyond(const verify_pieces *pieces, size_t wall) {
    uint32_t mate = pieces->facets->mate[pieces->wall_facets[wall]];
    return mate == VERIFY_NONE ? VERIFY_NONE : (uint32_t)pieces->mesh->labels[mate / 4];
}

static starg_status add_walls(ledger *own, uint32_t piece) {
    const verify_pieces *pieces = own->pieces;
    own->touched.count = 0;
    for (size_t w = pieces->wall_start[piece]; w < pieces->wall_start[piece + 1]; w++) {
        uint32_t other = verify_beyond(pieces, w);
        if (other == VERIFY_NONE || other < piece)
            continue;
        if (!own->open[other])
            PUSH(pieces->context, STAGE, &own->touched, other);
        own->open[other] = 1;
        own->area[other] += verify_area(pieces->walls, w, pieces->scale);
    }
    return STARG_OK;
}

static void compare_listed(ledger *own, uint32_t piece) {
    for (size_t i = own->start[piece]; i < own->start[piece + 1]; i++) {
        const starg_piece_contact *contact = &own->report->contacts[own->listed[i]];
        uint32_t other = contact->second;
        double found = own->open[other] ? ldexp(own->area[other], -2 * own->pieces->scale) : 0;
        bool same =
            fabs(contact->area - found) <= TOLERANCE * fmax(fabs(contact->area), found) + 0x1p-1022;
        if (!own->open[other] || !same)
            note(own, piece, other, contact->area, found);
        own->open[other] = 0;
    }
}

static void clear(ledger *own, uint32_t piece) {
    for (size_t i = 0; i < own->touched.count; i++) {
        uint32_t other = own->touched.data[i];
        if (own->open[other])
            note(own, piece, other, 0, ldexp(own->area[other], -2 * own->pieces->scale));
        own->open[other] = 0;
        own->area[other] = 0;
    }
}

starg_status verify_compare_contacts(const verify_pieces *pieces, const starg_pieces_report *report,
                                     verify_contacts *contacts) {
    starg_status status = STARG_OK;
    starg_context *context = pieces->context;
    ledger own = {.pieces = pieces, .report = report, .result = contacts};
    *contacts = (verify_contacts){0};
    STARG_NEW_ZERO(context, STAGE, own.area, pieces->piece_count);
    STARG_NEW_ZERO(context, STAGE, own.open, pieces->piece_count);
    STARG_TRY(sort_listed(&own));
    for (uint32_t p = 0; p < pieces->piece_count; p++) {
        STARG_TRY(add_walls(&own, p));
        compare_listed(&own, p);
        clear(&own, p);
    }
done:
    RELEASE(own.start, own.listed, own.area, own.open, own.touched.data);
    return status;
}
