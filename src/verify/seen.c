/* SPDX-License-Identifier: Apache-2.0 */
/* Counts the vertices of its piece that each guard sees. In a star-shaped piece it sees all: that
 * is its certificate. For other pieces the segment from guard to vertex is tested exactly against
 * the boundary of all tetrahedra, which it may touch only at the vertex; a guard that is not
 * strictly inside sees nothing. If there are too many pairs, a random sample is drawn with
 * replacement. */
#include "core/rng.h"
#include "verify/pieces.h"

static const char STAGE[] = "verify";

enum { MOST_LINES = 20000, RNG_STAGE = 0x7365656e, CANCEL_STEP = 256 };

typedef struct pair {
    uint32_t piece, vertex;
} pair;

typedef struct search {
    const verify_pieces *pieces;
    const starg_pieces_report *report;
    const verify_certificate *certificates;
    size_t *start; /* of each piece's tetrahedra in `members` */
    uint32_t *members;
    uint32_t *last;         /* per vertex: the last piece that counted it, plus 1 */
    STARG_ARRAY(pair) open; /* pairs of unproven pieces */
    uint8_t *inside;        /* per piece: can its guard see anything? */
    verify_tree *tree;
} search;

static starg_status sort_members(search *own) {
    const verify_pieces *pieces = own->pieces;
    const starg_pieces_mesh *mesh = pieces->mesh;
    NEW(pieces->context, STAGE, own->start, pieces->piece_count + 1);
    NEW(pieces->context, STAGE, own->members, mesh->count);
    size_t sum = 0;
    for (size_t p = 0; p < pieces->piece_count; p++)
        own->start[p] = sum += pieces->sizes[p];
    own->start[pieces->piece_count] = sum;
    for (size_t t = mesh->count; t-- > 0;)
        own->members[--own->start[mesh->labels[t]]] = (uint32_t)t;
    return STARG_OK;
}

/* Counts the vertices of a piece, and lists them unless they are known to be visible. */
static starg_status gather_pairs(search *own, uint32_t piece, verify_seen *seen) {
    bool proven = own->certificates[piece].proof == VERIFY_PROVEN;
    for (size_t i = 4 * own->start[piece]; i < 4 * own->start[piece + 1]; i++) {
        uint32_t vertex = own->pieces->mesh->tetrahedra[4 * (size_t)own->members[i / 4] + i % 4];
        if (own->last[vertex] == piece + 1)
            continue;
        own->last[vertex] = piece + 1;
        seen->pairs++;
        seen->proven += proven;
        if (!proven)
            PUSH(own->pieces->context, STAGE, &own->open, ((pair){piece, vertex}));
    }
    return STARG_OK;
}

static starg_status find_inside(search *own) {
    NEW_ZERO(own->pieces->context, STAGE, own->inside, own->pieces->piece_count);
    for (size_t p = 0; p < own->pieces->piece_count; p++) {
        if (own->certificates[p].proof == VERIFY_PROVEN)
            continue;
        const double *guard = own->report->pieces[p].guard;
        bool on_surface;
        int winding = verify_tree_winding(own->tree, guard, &on_surface);
        own->inside[p] = !on_surface && winding > 0;
        TRY(starg_check_cancel(own->pieces->context, STAGE));
    }
    return STARG_OK;
}

static bool sees(const search *own, pair line) {
    const double *guard = own->report->pieces[line.piece].guard;
    const double *vertex = verify_point(own->pieces->mesh, line.vertex);
    return own->inside[line.piece] && !verify_tree_blocks(own->tree, guard, vertex);
}

static starg_status look(search *own, verify_seen *seen) {
    starg_rng rng = starg_rng_make(0, RNG_STAGE, 0);
    bool all = own->open.count <= MOST_LINES;
    seen->looked = all ? own->open.count : MOST_LINES;
    for (size_t i = 0; i < seen->looked; i++) {
        if (i % CANCEL_STEP == 0)
            TRY(starg_check_cancel(own->pieces->context, STAGE));
        size_t which = all ? i : (size_t)starg_rng_below(&rng, own->open.count);
        seen->seen += sees(own, own->open.data[which]);
    }
    return STARG_OK;
}

starg_status verify_find_seen(const verify_pieces *pieces, const starg_pieces_report *report,
                              const verify_certificate *certificates, verify_seen *seen) {
    starg_context *context = pieces->context;
    starg_status status = STARG_OK;
    search own = {.pieces = pieces, .report = report, .certificates = certificates};
    *seen = (verify_seen){0};
    STARG_NEW_ZERO(context, STAGE, own.last, pieces->mesh->vertex_count);
    STARG_TRY(sort_members(&own));
    for (uint32_t p = 0; p < pieces->piece_count; p++)
        STARG_TRY(gather_pairs(&own, p, seen));
    if (own.open.count > 0) {
        STARG_TRY(verify_tree_create(pieces->outer, &own.tree));
        STARG_TRY(find_inside(&own));
        STARG_TRY(look(&own, seen));
    }
done:
    RELEASE(own.start, own.members, own.last, own.inside, own.open.data);
    verify_tree_free(own.tree);
    return status;
}
