/* SPDX-License-Identifier: Apache-2.0 */
/* A lower bound for star decompositions.
 *
 * Problem: into how few star-shaped pieces can a solid be cut, wherever its cuts run? A piece is
 * star-shaped if its guard is strictly on the inner side of all faces of its boundary, which winds
 * around it once.
 *
 * Theorem: the guards of the pieces see all vertices of an embedded surface, by the rule of
 * starguard/visibility.h: the segment from the guard to the vertex meets the surface in the vertex
 * only. So there are at least as many pieces as points are needed to see all vertices, wherever
 * those points stand.
 *
 * Proof: the pieces are closed and fill the solid, so each vertex v is in some piece P, with guard
 * g. Every point x of the half-open segment [g, v) is an inner point of P: some ball about g is on
 * the inner side of all faces of P, and so P holds all segments from v to that ball, which fill a
 * neighbourhood of x. An inner point of P is an inner point of the solid. The surface is embedded,
 * so that no inner point of the solid lies on it. Hence [g, v) does not meet the surface.
 *
 * Stages: the search over every point of the solid with the vertices as the target (guard/search.c)
 * gives the bound, its certificate, and points that see all vertices, from which guards of pieces
 * can be tried.
 *
 * Cost: that of starg_guard with `prove`. */
#include "star/lower_bound.h"

#include "core/context.h"

static const char STAGE[] = "pieces";

static starg_guard_options proof_options(uint64_t work) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.visibility.target = STARG_TARGET_VERTICES;
    options.prove = true;
    options.prove_work = work;
    return options;
}

starg_status piece_bound_find(starg_context *context, const starg_solid *solid, uint64_t work,
                              bool certified, piece_bound *out) {
    const starg_guard_options options = proof_options(work);
    *out = (piece_bound){0};
    if (!solid->check->embedded)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "how few pieces there can be is proven for surfaces only that neither "
                          "touch nor intersect themselves; make one with 'starguard repair "
                          "--union', or leave out the proof");
    starg_status status = certified ? starg_guard_certified(context, solid, &options, &out->guards,
                                                            &out->certificate, &out->size)
                                    : starg_guard(context, solid, &options, &out->guards);
    if (status == STARG_ERROR_TIME)
        return STARG_OK;
    if (status == STARG_OK)
        out->bound = out->guards->lower_bound_everywhere;
    return status;
}

void piece_bound_free(starg_context *context, piece_bound *bound) {
    starg_guards_free(context, bound->guards);
    starg_text_free(context, bound->certificate);
    *bound = (piece_bound){0};
}
