/* SPDX-License-Identifier: Apache-2.0 */
/* The outline of a certificate: its witnesses, and the cells from which a guard may see its share
 * of them. The prices are those of the first node; a proof that begins with a branch has none
 * there, and all witnesses weigh the same. Of an odd set each witness weighs half. Nothing is
 * checked. Cost: the witnesses of all leaves.
 */
#include "core/int128.h"
#include "verify/everywhere.h"

static const char STAGE[] = "certificate";

typedef struct sharing {
    const starg_certificate *own;
    uint64_t *price, all;
    starg_certificate_outline *out;
} sharing;

static void set_prices(sharing *s) {
    const starg_certificate *own = s->own;
    bool priced = own->node_count > 0 && own->nodes[0].witness == UINT32_MAX;
    for (size_t j = 0; j < own->witness_count; j++)
        s->price[j] = priced ? 0 : 1;
    const uint64_t *at = own->numbers.data;
    for (size_t k = 0; priced && k < own->nodes[0].count; k += at[k] + 2)
        for (uint64_t i = 1; i <= at[k]; i++)
            s->price[at[k + i]] += at[k + at[k] + 1] / (at[k] > 1 ? 2 : 1);
    for (size_t j = 0; j < own->witness_count; j++)
        s->all += s->price[j];
}

static bool keep_leaf(void *user, size_t cell, const uint64_t *open) {
    sharing *s = user;
    const verify_box *box = &s->own->cells[cell].box;
    uint64_t sum = 0;
    for (size_t w = 0; w < s->own->words; w++)
        STARG_FOR_BITS (bit, open[w])
            sum += s->price[64 * w + bit];
    bool has_share =
        sum > 0 && (starg_uint128)sum * s->own->bound >= (starg_uint128)s->all * s->own->redundancy;
    if (has_share) {
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
    memcpy(s.out->witnesses, own->witnesses, own->witness_count * sizeof *own->witnesses);
    STARG_NEW(context, STAGE, s.out->cells, 6 * own->cell_count);
    STARG_NEW(context, STAGE, s.price, own->witness_count);
    set_prices(&s);
    STARG_TRY(verify_visit_leaves(own, keep_leaf, &s, &all));
    *out = s.out;
    s.out = NULL;
done:
    starg_release(context, s.price);
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
