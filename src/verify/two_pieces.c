/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that a model is not made up of two star-shaped pieces, against the tree of pairs of
 * boxes that their guards cannot be in (docs/verification.md has the proof).
 *
 * A face belongs to a guard if the other guard is not strictly on its inner side: the piece of the
 * first holds it. Leaves of the tree say that no point of a box is in the model, that a face has
 * neither guard on its inner side, or that a point x is between the first guard and a face that
 * belongs to it, and between the second one and such a face, wherever they are in their boxes: an
 * inner point of both pieces.
 *
 * Leaves are checked in parallel, each on its own. Cost: a flood of faces for each patch. */
#include "core/parallel.h"
#include "verify/claims.h"
#include "verify/everywhere.h"

static const char STAGE[] = "verify";

typedef struct checking {
    verify_scene scene; /* the first member, for verify_watch_make */
    const starg_certificate *certificate;
    bool *right; /* by leaf */
} checking;

static bool is_right(const checking *own, verify_watch *watch, const everywhere_pair *leaf) {
    const double *x;
    switch (leaf->kind) {
    case 'o':
        verify_watch_box(watch, &leaf->box[leaf->number]);
        return verify_box_outside(watch);
    case 'f':
        return verify_box_behind(watch, &leaf->box[0], leaf->number) &&
               verify_box_behind(watch, &leaf->box[1], leaf->number);
    default:
        x = own->certificate->points.data + 3 * (size_t)leaf->number;
        return verify_box_shades(watch, &leaf->box[0], x, leaf->seeds[0], &leaf->box[1]) &&
               verify_box_shades(watch, &leaf->box[1], x, leaf->seeds[1], &leaf->box[0]);
    }
}

static starg_status check_leaf(starg_context *context, void *shared, void *scratch, size_t item) {
    const checking *own = shared;
    (void)context;
    own->right[item] = is_right(own, scratch, &own->certificate->leaves.data[item]);
    return verify_watch_failed(scratch) ? STARG_ERROR_MEMORY : STARG_OK;
}

starg_status verify_claim_pairs(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *c) {
    starg_status status = STARG_OK;
    starg_context *context = known->surface->context;
    checking own = {.certificate = c};
    size_t wrong = c->leaves.count;
    STARG_TRY(verify_scene_create(known->surface, known->tree, false, &own.scene));
    STARG_NEW(context, STAGE, own.right, c->leaves.count);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = c->leaves.count,
                                      .shared = &own,
                                      .item = check_leaf,
                                      .make_scratch = verify_watch_make,
                                      .free_scratch = verify_watch_drop};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = c->leaves.count; i-- > 0;)
        wrong = own.right[i] ? wrong : i;
    if (!verify_box_holds(&c->root, known->surface))
        verify_claim(verdict, false, "the boxes of the certificate hold all of the model");
    else if (wrong < c->leaves.count)
        verify_claim(verdict, false,
                     "reasons of the certificate are right: guards may be in the two boxes on "
                     "line %zu, or that is not certain",
                     c->leaves.data[wrong].line);
    else
        verify_claim(verdict, true,
                     "the boxes hold all of the model, and all %zu reasons why guards of two "
                     "pieces are not in two of them are right",
                     c->leaves.count);
done:
    verify_scene_free(&own.scene);
    starg_release(context, own.right);
    return status;
}
