/* SPDX-License-Identifier: Apache-2.0 */
/* The outline of a certificate: its witnesses, and the cells from which a guard may see its share
 * of them. The prices are those of the first node; a proof that begins with a branch has none
 * there, and all witnesses weigh the same. Of an odd set each witness weighs half. Nothing is
 * checked. Cost: the witnesses of all leaves.
 */
#include "verify/everywhere.h"

static const char STAGE[] = "certificate";

typedef struct sharing {
    const starg_certificate *own;
    const everywhere_node *priced; /* NULL: all witnesses weigh the same */
    starg_uint128 all;
    starg_certificate_outline *out;
} sharing;

static void set_prices(sharing *s) {
    const starg_certificate *own = s->own;
    if (own->node_count > 0 && own->nodes[0].witness == UINT32_MAX)
        s->priced = &own->nodes[0];
    s->all = s->priced != NULL ? verify_least_paid(own, s->priced, own->redundancy)
                               : (starg_uint128)own->witness_count * own->redundancy;
}

static bool keep_leaf(void *user, size_t cell, const uint64_t *open) {
    sharing *s = user;
    const verify_box *box = &s->own->cells[cell].box;
    starg_uint128 sum = s->priced != NULL ? verify_paid(s->own, s->priced, open)
                                          : starg_bit_count(open, s->own->words);
    if (sum > 0 && sum * s->own->bound >= s->all) {
        double *kept = s->out->cells + 6 * s->out->cell_count++;
        memcpy(kept, box->lower, sizeof box->lower);
        memcpy(kept + 3, box->upper, sizeof box->upper);
    }
    return true;
}

starg_status starg_certificate_outline_create(starg_context *context,
                                              const starg_certificate *certificate,
                                              starg_certificate_outline **out) {
    starg_status status = STARG_OK;
    const starg_certificate *own = certificate;
    sharing s = {.own = own};
    bool all;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, s.out, 1);
    s.out->vertex_count = own->vertex_count;
    s.out->face_count = own->face_count;
    s.out->target = own->target == STARG_TARGET_CORNERS ? STARG_TARGET_FACES : own->target;
    s.out->bound = own->bound;
    s.out->witness_count = own->witness_count;
    STARG_NEW(context, STAGE, s.out->witnesses, own->witness_count);
    if (own->witness_count > 0)
        memcpy(s.out->witnesses, own->witnesses, own->witness_count * sizeof *own->witnesses);
    STARG_NEW(context, STAGE, s.out->cells, 6 * own->cell_count);
    set_prices(&s);
    STARG_TRY(verify_visit_leaves(own, keep_leaf, &s, &all));
    *out = s.out;
    s.out = NULL;
done:
    starg_certificate_outline_free(context, s.out);
    return status;
}

void starg_certificate_outline_free(starg_context *context, starg_certificate_outline *outline) {
    if (outline == NULL)
        return;
    starg_release(context, outline->witnesses);
    starg_release(context, outline->cells);
    starg_release(context, outline);
}
