/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that no fewer star-shaped pieces are possible, against the certificate of a bound for
 * points that see vertices (verify/everywhere.h).
 *
 * Why such a bound holds for pieces: pieces are closed and fill the model, so that each vertex v of
 * its surface is in some piece. The guard g of the piece is strictly on the inner side of all of
 * its walls, and so is a ball about g; the piece holds all segments between the ball and v, and
 * they hold a neighbourhood of each point between g and v. So none of these points is on the
 * surface, which is embedded: g sees v, by the rule that the certificate speaks of. Hence the
 * guards of any partition into star-shaped pieces see all witnesses, and are as many as the bound
 * says.
 *
 * Cost: that of the certificate (verify/everywhere.c), and of pairs of faces near each other. */
#include <math.h>
#include <stdio.h>

#include "core/memory.h"
#include "verify/context.h"
#include "verify/everywhere.h"

static const char STAGE[] = "verify";

static bool is_answered_by_pieces(const starg_certificate *c) {
    return c->target == STARG_TARGET_VERTICES && isinf(c->range) && c->clearance == 0 &&
           c->redundancy == 1;
}

/* What else than vertices of faces a file numbers is no witness. */
static starg_status find_stray(const verify_context *own, size_t *stray) {
    starg_status status = STARG_OK;
    const starg_certificate *c = own->certificate;
    uint8_t *used = NULL;
    STARG_NEW_ZERO(own->context, STAGE, used, own->model->vertex_count);
    for (size_t i = 0; i < 3 * own->model->face_count; i++)
        used[own->model->faces[i]] = 1;
    *stray = 0;
    for (size_t i = 0; i < c->witness_count; i++)
        *stray += !used[c->witnesses[i]];
done:
    starg_release(own->context, used);
    return status;
}

/* Is the certificate of the model, and of a question that pieces answer? */
static starg_status claim_question(const verify_context *own, const verify_facts *known,
                                   bool *good) {
    starg_status status = STARG_OK;
    const starg_certificate *c = own->certificate;
    verify_scene scene = {0};
    size_t stray = 0;
    const char *difference = NULL;
    if (own->report->approximated)
        difference = ": pieces that approximate the model say nothing about it";
    else if (!verify_certificate_is_of(c, own->model))
        difference = ": it is of another model";
    else if (!is_answered_by_pieces(c))
        difference = ": it is not about all vertices, seen once, from anywhere";
    if (difference == NULL) {
        STARG_TRY(find_stray(own, &stray));
        STARG_TRY(verify_scene_create(own->model, known->tree, true, &scene));
        if (stray > 0)
            difference = ": some of its witnesses are no corners of faces";
        else if (!scene.embedded)
            difference = ": the surface touches or intersects itself";
    }
    *good = difference == NULL;
    verify_claim(own->verdict, *good, "the certificate is about pieces of this model%s",
                 *good ? "" : difference);
done:
    verify_scene_free(&scene);
    return status;
}

static starg_status check_certificate(const verify_context *own) {
    starg_status status = STARG_OK;
    verify_tree *tree = NULL;
    char claim[96];
    bool good;
    size_t bound = own->report->lower_bound;
    STARG_TRY(verify_tree_create(own->model, &tree));
    const verify_facts known = {
        .surface = own->model, .tree = tree, .scale = verify_scale(own->model)};
    STARG_TRY(claim_question(own, &known, &good));
    if (!good)
        goto done;
    STARG_TRY(verify_claim_cells(own->verdict, &known, own->certificate));
    snprintf(claim, sizeof claim, "no fewer than %zu star-shaped pieces make up the model", bound);
    STARG_TRY(verify_claim_follows(own->verdict, own->certificate, claim, bound));
done:
    verify_tree_free(tree);
    return status;
}

starg_status verify_claim_fewest(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    size_t bound = report->lower_bound;
    bool stars = report->strictly_star == report->piece_count;
    if (bound == 0)
        verify_leave(own->verdict, "whether fewer pieces would do");
    else
        verify_claim(own->verdict,
                     (!stars || bound <= report->piece_count) &&
                         report->optimal == (bound == report->piece_count),
                     "the lower bound is at most the number of star-shaped pieces (%zu, %zu), and "
                     "the result is called %s",
                     bound, report->piece_count,
                     report->optimal ? "optimal" : "not proven optimal");
    if (own->certificate != NULL)
        return check_certificate(own);
    if (bound > 0)
        verify_leave(own->verdict,
                     "that no fewer than %zu star-shaped pieces make up the model: the "
                     "certificate would say why",
                     bound);
    return STARG_OK;
}
