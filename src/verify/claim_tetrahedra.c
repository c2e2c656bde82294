/* SPDX-License-Identifier: Apache-2.0 */
/* Claims for any labelled tetrahedra: each is positive, triangles fit together, labels are
 * complete, pieces are connected. Signs are exact. Cost: O(n). */
#include <stdio.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";

enum { CANCEL_STEP = 1 << 16 };

/* ---- names of elements ---- */

verify_words verify_facet_words(const verify_context *own, uint32_t facet) {
    verify_words name;
    uint32_t v[3];
    verify_facet_corners(own->mesh->tetrahedra, facet, v);
    snprintf(name.text, sizeof name.text, "face %u-%u-%u of tetrahedron %u", v[0], v[1], v[2],
             facet / 4);
    return name;
}

verify_words verify_outer_words(const verify_context *own, size_t face) {
    return verify_facet_words(own, own->pieces->outer_facets[face]);
}

/* ---- tetrahedra ---- */

static starg_status claim_positive(const verify_context *own) {
    const starg_pieces_mesh *mesh = own->mesh;
    size_t bad = 0, first = 0;
    for (size_t t = 0; t < mesh->count; t++) {
        const uint32_t *v = mesh->tetrahedra + 4 * t;
        if (t % CANCEL_STEP == 0)
            TRY(starg_check_cancel(own->context, STAGE));
        if (verify_side(verify_point(mesh, v[0]), verify_point(mesh, v[2]),
                        verify_point(mesh, v[1]), verify_point(mesh, v[3])) <= 0 &&
            bad++ == 0)
            first = t;
    }
    if (bad == 0)
        verify_claim(own->verdict, true, "all %zu tetrahedra are positive", mesh->count);
    else
        verify_claim(own->verdict, false,
                     "all %zu tetrahedra are positive: %zu are inverted or flat, first "
                     "tetrahedron %zu of piece %d",
                     mesh->count, bad, first, mesh->labels[first]);
    return STARG_OK;
}

static void claim_conforming(const verify_context *own) {
    static const char claim[] = "each triangle has one tetrahedron, or two on opposite sides";
    const verify_misuse *third = &own->pieces->facets->third;
    const verify_misuse *same = &own->pieces->facets->same_side;
    if (third->count > 0)
        verify_claim(own->verdict, false, "%s: %zu have more, first %s", claim, third->count,
                     verify_facet_words(own, third->facet).text);
    else if (same->count > 0)
        verify_claim(own->verdict, false,
                     "%s: %zu have two on one side, first %s, also of tetrahedron %u", claim,
                     same->count, verify_facet_words(own, same->facet).text, same->other / 4);
    else
        verify_claim(own->verdict, true, "%s", claim);
}

static void claim_labels(const verify_context *own) {
    const verify_labels *labels = &own->pieces->labels;
    size_t count = own->pieces->piece_count;
    if (labels->tetrahedron != VERIFY_NONE)
        verify_claim(
            own->verdict, false, "labels name the pieces 0 to %zu: tetrahedron %zu has label %d",
            count - (count > 0), labels->tetrahedron, own->mesh->labels[labels->tetrahedron]);
    else if (!labels->good)
        verify_claim(own->verdict, false,
                     "labels name the pieces 0 to %zu: %zu are empty, first piece %zu", count - 1,
                     labels->empty, labels->first);
    else
        verify_claim(own->verdict, true, "labels name the pieces 0 to %zu, and none is empty",
                     count - 1);
}

/* ---- pieces ---- */

static void join_mates(const verify_context *own, uint32_t *parent) {
    const uint32_t *mate = own->pieces->facets->mate;
    for (uint32_t t = 0; t < own->mesh->count; t++)
        parent[t] = t;
    for (uint32_t f = 0; f < 4 * own->mesh->count; f++) {
        if (mate[f] == VERIFY_NONE || own->mesh->labels[mate[f] / 4] != own->mesh->labels[f / 4])
            continue;
        verify_join(parent, f / 4, mate[f] / 4);
    }
}

static starg_status claim_connected(const verify_context *own) {
    static const char claim[] = "each piece is connected through faces";
    SCOPED uint32_t *parent = NULL, *first = NULL;
    uint32_t bad = VERIFY_NONE;
    size_t parts = 0;
    NEW(own->context, STAGE, parent, own->mesh->count);
    NEW(own->context, STAGE, first, own->pieces->piece_count);
    for (size_t p = 0; p < own->pieces->piece_count; p++)
        first[p] = VERIFY_NONE;
    join_mates(own, parent);
    for (uint32_t t = 0; t < own->mesh->count; t++) {
        int32_t label = own->mesh->labels[t];
        if (parent[t] != t)
            continue;
        if (first[label] == VERIFY_NONE)
            first[label] = t;
        else if (parts++ == 0)
            bad = t;
    }
    if (parts == 0)
        verify_claim(own->verdict, true, "%s", claim);
    else
        verify_claim(own->verdict, false,
                     "%s: piece %d falls apart, tetrahedra %u and %u are not connected "
                     "(%zu parts too many in all)",
                     claim, own->mesh->labels[bad], first[own->mesh->labels[bad]], bad, parts);
    return STARG_OK;
}

/* ---- public function ---- */

starg_status verify_claim_tetrahedra(const verify_context *own) {
    TRY(claim_positive(own));
    claim_conforming(own);
    claim_labels(own);
    if (own->pieces->labels.good)
        TRY(claim_connected(own));
    return STARG_OK;
}
