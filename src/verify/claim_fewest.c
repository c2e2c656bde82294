/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that no fewer star-shaped pieces are possible, against the certificate of a bound for
 * points that see corners of faces (verify/everywhere.h). A point sees corner v of face f if it is
 * strictly on the inner side of f and the segment to v meets the surface in v only.
 *
 * Why such a bound holds for pieces: pieces are closed and fill the model, so one of them, P, holds
 * v and points of f as near to v as you like. Its guard g is strictly on the inner side of all of
 * its walls, and so is a ball about g; P holds all segments between the ball and any point x of it,
 * and these hold a neighbourhood of each point between g and x. So none of these points is on the
 * surface, which has the outside just before every point of its faces. With x = v: the segment to v
 * meets the surface in v only. With x inside f: the segment reaches f from the inner side. Hence
 * the guards of any partition into star-shaped pieces see all corners, and are as many as the bound
 * says.
 *
 * Cost: that of the certificate (verify/everywhere.c), and of pairs of faces near each other. */
#include <math.h>
#include <stdio.h>

#include "verify/everywhere.h"
#include "verify/pieces.h"

static bool is_answered_by_pieces(const starg_certificate *c) {
    return c->target == STARG_TARGET_CORNERS && isinf(c->range) && c->clearance == 0 &&
           c->redundancy == 1;
}

static bool has_corner(const verify_surface *surface, uint32_t face, uint32_t vertex) {
    const uint32_t *c = surface->faces + 3 * (size_t)face;
    return c[0] == vertex || c[1] == vertex || c[2] == vertex;
}

static bool has_corners(const starg_certificate *c, const verify_surface *surface) {
    for (size_t i = 0; i < c->witness_count; i++)
        if (!has_corner(surface, c->witnesses[i], c->corners[i]))
            return false;
    return true;
}

/* Is the certificate of the model, and of a question that pieces answer? */
static starg_status claim_question(const verify_context *own, const verify_facts *known,
                                   bool *good) {
    const starg_certificate *c = own->certificate;
    SCOPED_BY(verify_scene_free) verify_scene scene = {0};
    const char *difference = NULL;
    bool bounds = true;
    if (own->report->approximated)
        difference = ": pieces that approximate the model say nothing about it";
    else if (!verify_certificate_is_of(c, own->model))
        difference = ": it is of another model";
    else if (!is_answered_by_pieces(c))
        difference = ": it is not about corners of faces, seen once, from anywhere";
    else if (!has_corners(c, own->model))
        difference = ": some of its witnesses are no corners of the faces that they name";
    else {
        TRY(verify_scene_create(own->model, known->tree, true, &scene));
        if (!scene.embedded)
            TRY(verify_find_bounding(&scene, &bounds));
        if (!bounds)
            difference = ": the surface touches or intersects itself";
    }
    *good = difference == NULL;
    verify_claim(own->verdict, *good, "the certificate is about pieces of this model%s",
                 *good ? "" : difference);
    return STARG_OK;
}

static starg_status check_certificate(const verify_context *own) {
    SCOPED_BY(verify_tree_drop) verify_tree *tree = NULL;
    char claim[96];
    bool good;
    size_t bound = own->report->lower_bound;
    TRY(verify_tree_create(own->model, &tree));
    const verify_facts known = {
        .surface = own->model, .tree = tree, .scale = verify_scale(own->model)};
    TRY(claim_question(own, &known, &good));
    if (!good)
        return STARG_OK;
    snprintf(claim, sizeof claim, "no fewer than %zu star-shaped pieces make up the model", bound);
    TRY(verify_claim_cells(own->verdict, &known, own->certificate));
    return verify_claim_follows(own->verdict, own->certificate, claim, bound);
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
