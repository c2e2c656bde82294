/* SPDX-License-Identifier: Apache-2.0 */
/* A lower bound for star decompositions.
 *
 * Problem: into how few star-shaped pieces can a solid be cut, wherever its cuts run? A piece is
 * star-shaped if its guard is strictly on the inner side of all faces of its boundary, which winds
 * around it once.
 *
 * Theorem: let a surface bound the solid that has the outside just before every point of its faces,
 * as embedded ones do, and others that touch themselves in vertices and edges (star/decomposition.h).
 * Let f be a face of it and v a corner of f. Some guard g of a piece is strictly on the inner side
 * of f, and the segment from g to v meets the surface in v only. So there are at least as many
 * pieces as points are needed that see all such corners, wherever the points stand.
 *
 * Proof: let points x1, x2, ... inside f converge to v. The pieces are closed, finitely many, and
 * fill the solid: some piece P, with guard g, holds infinitely many of them, and v.
 * 1. Let x be a point of P. Every point y of the half-open segment [g, x) is an inner point of P,
 *    for some ball about g is on the inner side of all faces of P, and so P holds all segments from
 *    x to that ball, which fill a neighbourhood of y. An inner point of P is one of the solid, and
 *    no inner point of the solid lies on its surface, since outer ones are as near as you like. So
 *    [g, x) does not meet the surface.
 * 2. With x = v: the segment from g to v meets the surface in v only.
 * 3. With x = xi inside f: the segment ends in xi coming from the inside of the solid, which is on
 *    the inner side of f there, and it does not run along f. So g is strictly on the inner side.
 *
 * Stages: the search over every point of the solid with corners as targets (guard/search.c) gives
 * the bound, its certificate, and points that see all corners, from which guards of pieces can be
 * tried.
 *
 * Cost: that of starg_guard with `prove`. */
#include "star/decomposition.h"

#include "core/context.h"

static const char STAGE[] = "pieces";

starg_status piece_bound_find(starg_context *context, const starg_solid *solid, uint64_t work,
                              bool certified, corner_guards *out) {
    bool bounds;
    *out = (corner_guards){0};
    starg_status status = touching_bounds(context, solid, &bounds);
    if (status == STARG_OK && !bounds)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "how few pieces there can be is proven for surfaces only that do not "
                          "intersect themselves, and touch themselves in common vertices and edges "
                          "alone; make one with 'starguard repair --union', or leave out the "
                          "proof");
    if (status == STARG_OK)
        status = corner_guards_find(context, solid, work, certified, out);
    return status == STARG_ERROR_TIME ? STARG_OK : status;
}
