/* SPDX-License-Identifier: Apache-2.0 */
/* Compatible decomposition, pieces that are star-shaped in two solids at once: consistent
 * decomposition [YL11, section 5.2].
 *
 * Problem: the same tetrahedra lie in two places, positive in both. Label them so that each set is
 * strictly star-shaped in both places, about a guard in either, with few labels.
 *
 * Stages: regions grown about pairs of guards (region_growing.c); of these, two neighbours at a
 * time (twin_pieces.c) whose union has a kernel with an interior in both places become one, those
 * that touch over the largest area first, until no two can be joined. Then a random group of pieces
 * that hang together is given up (groups.c), its tetrahedra are grown and joined anew, and the
 * outcome stays if there are no more pieces than before (ruin and recreate: Schrimpf et al. 2000),
 * until that has long saved nothing. Where tetrahedra may be cut: several times parts between
 * planes (planes.c), joined in the same way; they stay if they are fewer. Then three and more
 * pieces that hang together become two by a random plane in one of the places (cuts.c), if the
 * kernels allow it. At last every guard goes to the middle of its kernel.
 *
 * Invariants: after each stage every set is proven to be star-shaped in both, by exact signs.
 *
 * Cost: that of the region growing, for the whole and for a fixed number of tetrahedra of groups,
 * and that of the joins. */
#include "star/compatible/compatible.h"

#include "core/parallel.h"
#include "star/compatible/twin_pieces.h"
#include "star/decomposition.h"

static const char STAGE[] = "join";

enum { PLANE_STARTS = 3 }; /* divisions by planes: the one of the fewest pieces stays */

/* ---- stages ---- */

static starg_status join_start(twin_pieces *w) {
    TRY(twin_pieces_list(w));
    return twin_pieces_join(w);
}

/* Divisions by planes, side by side. */
typedef struct plane_starts {
    const twin_pieces *from;
    twin_pieces found[PLANE_STARTS];
} plane_starts;

static starg_status divide_by_planes(starg_context *context, void *shared, void *scratch,
                                     size_t item) {
    plane_starts *all = shared;
    const starg_tetmesh *const *meshes = all->from->meshes;
    twin_pieces *next = &all->found[item];
    (void)scratch;
    *next = (twin_pieces){.context = context, .meshes = {meshes[0], meshes[1]}};
    TRY(compatible_planes(context, meshes, item, next->own, &next->pieces));
    for (int i = 0; i < 2; i++)
        if (next->own[i] != NULL)
            next->meshes[i] = next->own[i];
    return join_start(next);
}

static void free_starts(plane_starts *all) {
    for (size_t i = 0; i < PLANE_STARTS; i++)
        if (all->found[i].context != NULL)
            twin_pieces_free(&all->found[i]);
}

/* Parts between planes, of several divisions the one of the fewest. */
static starg_status start_by_planes(const twin_pieces *from, twin_pieces *best) {
    SCOPED_BY(free_starts) plane_starts all = {.from = from};
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = PLANE_STARTS,
                                      .shared = &all,
                                      .item = divide_by_planes,
                                      .silent = true};
    TRY(starg_parallel_for(from->context, &loop));
    for (size_t i = 0; i < PLANE_STARTS; i++)
        if (i == 0 || all.found[i].pieces.count < best->pieces.count)
            twin_pieces_swap(best, &all.found[i]);
    return STARG_OK;
}

/* Regions that are grown or, where tetrahedra may be cut and these are fewer, parts between planes.
 */
static starg_status start(twin_pieces *w, bool cut) {
    SCOPED_BY(twin_pieces_free) twin_pieces other = {.context = w->context};
    TRY(grow_compatible_regions(w->context, w->meshes[0], w->meshes[1], &w->pieces));
    TRY(join_start(w));
    TRY(compatible_regrow(w));
    if (cut && w->pieces.count > 1)
        TRY(start_by_planes(w, &other));
    if (other.pieces.count > 0 && other.pieces.count < w->pieces.count)
        twin_pieces_swap(w, &other);
    return STARG_OK;
}

/* ---- the result ---- */

static starg_status finish(const twin_pieces *w, int place, starg_decomposition **out) {
    starg_status status = STARG_OK;
    const double *guards = place == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
    starg_tetmesh *mesh = NULL;
    int32_t *labels = NULL;
    STARG_NEW(w->context, STAGE, labels, w->meshes[0]->count);
    for (size_t t = 0; t < w->meshes[0]->count; t++)
        labels[t] = (int32_t)w->pieces.labels[t];
    STARG_TRY(tetmesh_copy(w->context, w->meshes[place], &mesh));
    status = decomposition_finish(w->context, STARG_DECOMPOSE_STRICT, mesh, labels, guards,
                                  w->pieces.count, out);
    labels = NULL;
    if (status == STARG_OK)
        (*out)->flattest = (*out)->flattest_given = tetmesh_flattest((*out)->mesh);
done:
    starg_release(w->context, labels);
    return status;
}

/* Guards in the middle, and the result. */
static starg_status deliver(twin_pieces *w, starg_decomposition *out[2]) {
    starg_status status = STARG_OK;
    STARG_TRY(twin_pieces_center(w));
    for (int i = 0; i < 2; i++)
        STARG_TRY(finish(w, i, &out[i]));
done:
    if (status != STARG_OK) {
        starg_decomposition_free(w->context, out[0]);
        out[0] = NULL;
    }
    return status;
}

starg_status compatible_join(starg_context *context, const starg_tetmesh *mesh,
                             const starg_tetmesh *image, const uint32_t *labels,
                             const double *const guards[2], size_t count,
                             starg_decomposition *out[2]) {
    SCOPED_BY(twin_pieces_free) twin_pieces w = {.context = context, .meshes = {mesh, image}};
    out[0] = out[1] = NULL;
    NEW(context, STAGE, w.pieces.labels, mesh->count);
    memcpy(w.pieces.labels, labels, mesh->count * sizeof *labels);
    w.pieces.count = count;
    for (size_t i = 0; i < 3 * count; i++) {
        PUSH(context, STAGE, &w.pieces.guards, guards[0][i]);
        PUSH(context, STAGE, &w.pieces.counterparts, guards[1][i]);
    }
    TRY(join_start(&w));
    return deliver(&w, out);
}

starg_status compatible_decompose(starg_context *context, const starg_tetmesh *mesh,
                                  const starg_tetmesh *image, bool cut,
                                  starg_decomposition *out[2]) {
    SCOPED_BY(twin_pieces_free) twin_pieces w = {.context = context, .meshes = {mesh, image}};
    out[0] = out[1] = NULL;
    TRY(start(&w, cut));
    if (cut)
        TRY(compatible_cut(&w));
    return deliver(&w, out);
}
