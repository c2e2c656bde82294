/* SPDX-License-Identifier: Apache-2.0 */
/* Groups of compatible pieces, given up and grown anew (ruin and recreate: Schrimpf et al. 2000).
 *
 * Method: a random group of pieces that hang together is given up, its tetrahedra are grown into
 * regions and joined; the outcome stays if there are no more pieces than before. It ends when that
 * has long saved nothing, or after a number of tetrahedra in proportion to all. */
#include "core/streams.h"
#include "star/compatible/twin_pieces.h"

static const char STAGE[] = "join";

enum {
    GROUP_MOST = 4,      /* pieces grown anew at a time, from 2 on                           */
    IDLE_MOST = 150,     /* groups in a row that saved nothing: then no more                 */
    WORK_LEAST = 400000, /* tetrahedra of all groups                                         */
    WORK_EACH = 30,      /* and as many more for each tetrahedron that there is              */
    PASSES = 60          /* as many looked at once take as long as one of a group            */
};

/* The pieces without those dropped, and what is grown in their stead. */
static starg_status replace_group(const twin_pieces *w, const uint8_t *dropped, uint64_t round,
                                  twin_pieces *out) {
    TRY(grow_compatible_again(w->context, w->meshes[0], w->meshes[1], &w->pieces, dropped, round,
                              &out->pieces));
    TRY(twin_pieces_list(out));
    for (size_t p = 0, kept = 0; p < w->pieces.count; p++)
        if (!dropped[p])
            out->fresh[kept++] = 0;
    return twin_pieces_join(out);
}

starg_status compatible_regrow(twin_pieces *w) {
    starg_context *context = w->context;
    SCOPED_BY(twin_pieces_free) twin_pieces next = {.context = context};
    SCOPED uint8_t *dropped = NULL;
    IN_STAGE(context, STAGE);
    NEW(context, STAGE, dropped, w->pieces.count);
    size_t idle = 0, work = 0, most = WORK_LEAST + WORK_EACH * w->meshes[0]->count;
    for (uint64_t round = 1; idle < IDLE_MOST && work < most && w->pieces.count > 1; round++) {
        starg_rng rng = starg_rng_make(context->seed, STREAM_TWIN_GROUPS, round);
        size_t group = 0;
        TRY(twin_pieces_drop(w, 2 + starg_rng_below(&rng, GROUP_MOST - 1), &rng, dropped, &group));
        twin_pieces_free(&next);
        next = (twin_pieces){.context = context, .meshes = {w->meshes[0], w->meshes[1]}};
        TRY(replace_group(w, dropped, round, &next));
        work += group + w->meshes[0]->count / PASSES;
        idle = next.pieces.count < w->pieces.count ? 0 : idle + 1;
        if (next.pieces.count <= w->pieces.count)
            twin_pieces_swap(w, &next);
        starg_progress_step(context, work, most);
    }
    return STARG_OK;
}
