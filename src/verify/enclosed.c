/* SPDX-License-Identifier: Apache-2.0 */
/* Do the pieces fill what the model encloses? Points are drawn in the model's box, and on both
 * sides of its faces; the model encloses those about which it winds at least once, the pieces those
 * about which their boundary winds, which must be once. Where the boundary is only near the model's
 * surface, they may differ near that surface, so points there are left out.
 *
 * Signs are exact; which points are drawn decides only what is noticed: a missing part that has a
 * face of the model, or some thousandths of the volume. Cost: O(log n) for each point, typically.
 */

#include "core/rng.h"
#include "verify/pieces.h"

static const char STAGE[] = "verify";

enum { MOST = 1000, RNG_STAGE = 0x656e636c, CANCEL_STEP = 64 };

typedef struct survey {
    const verify_surface *model;
    const verify_tree *solid, *pieces;
    int scale;
    double near;
    verify_enclosed *found;
} survey;

static void look_at(const survey *own, const double p[3]) {
    bool on_model, on_boundary;
    int within = verify_tree_winding(own->solid, p, &on_model);
    int filled = verify_tree_winding(own->pieces, p, &on_boundary);
    bool wrong = filled != (within >= 1);
    if (on_model || on_boundary ||
        (wrong && verify_tree_distance(own->solid, p, own->scale) <= own->near))
        return;
    own->found->points++;
    own->found->inside += within >= 1;
    own->found->overlapping += within > 1;
    if (!wrong)
        return;
    if (own->found->missing + own->found->excess == 0)
        for (int k = 0; k < 3; k++)
            own->found->place[k] = p[k];
    own->found->missing += filled < 1;
    own->found->excess += filled >= 1;
}

static void look_in_box(const survey *own, size_t i) {
    starg_rng rng = starg_rng_make(0, RNG_STAGE, i);
    double p[3];
    for (int k = 0; k < 3; k++) {
        double lower = own->model->lower[k];
        p[k] = lower + starg_rng_unit(&rng) * (own->model->upper[k] - lower);
    }
    look_at(own, p);
}

/* On both sides of a face, twice as far from it as points that are left out. */
static void look_beside(const survey *own, size_t face) {
    const double *t[3];
    double n[3], length = 0;
    verify_corners(own->model, face, t);
    verify_normal(own->model, face, own->scale, n);
    for (int k = 0; k < 3; k++)
        length = hypot(length, n[k]);
    for (int side = -1; side <= 1 && length > 0; side += 2) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = t[0][k] / 3 + t[1][k] / 3 + t[2][k] / 3 + side * 2 * own->near * n[k] / length;
        look_at(own, p);
    }
}

starg_status verify_compare_enclosed(const verify_pieces *pieces, const verify_surface *model,
                                     double near, verify_enclosed *found) {
    SCOPED_BY(verify_tree_drop) verify_tree *solid = NULL, *boundary = NULL;
    bool all = model->face_count <= MOST;
    *found = (verify_enclosed){0};
    TRY(verify_tree_create(model, &solid));
    TRY(verify_tree_create(pieces->outer, &boundary));
    const survey own = {model, solid, boundary, pieces->scale, near, found};
    for (size_t i = 0; i < MOST; i++) {
        if (i % CANCEL_STEP == 0)
            TRY(starg_check_cancel(pieces->context, STAGE));
        look_in_box(&own, i);
        starg_rng rng = starg_rng_make(1, RNG_STAGE, i);
        size_t face = all ? i : (size_t)starg_rng_below(&rng, model->face_count);
        if (face < model->face_count)
            look_beside(&own, face);
    }
    return STARG_OK;
}
