/* SPDX-License-Identifier: Apache-2.0 */
/* The claims that a report makes in numbers: tetrahedra, volumes and contacts of the pieces. Cost:
 * O(n). */
#include <math.h>

#include "core/memory.h"
#include "verify/context.h"

static const char STAGE[] = "verify";

static void claim_size(const verify_context *own) {
    verify_claim(own->verdict, own->report->tetrahedra == own->mesh->count,
                 "there are %zu tetrahedra (the file holds %zu)", own->report->tetrahedra,
                 own->mesh->count);
}

static void claim_counts(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0;
    for (size_t p = report->piece_count; p-- > 0;)
        if (report->pieces[p].tetrahedra != own->pieces->sizes[p]) {
            bad++;
            first = p;
        }
    if (bad == 0)
        verify_claim(own->verdict, true, "each of %zu pieces has as many tetrahedra as claimed",
                     report->piece_count);
    else
        verify_claim(own->verdict, false,
                     "each of %zu pieces has as many tetrahedra as claimed: %zu have not, first "
                     "piece %zu, claimed %zu, found %zu",
                     report->piece_count, bad, first, report->pieces[first].tetrahedra,
                     own->pieces->sizes[first]);
}

static starg_status claim_volumes(const verify_context *own) {
    starg_status status = STARG_OK;
    const starg_pieces_report *report = own->report;
    verify_volume *volumes = NULL;
    int scale = own->pieces->scale;
    double lost = ldexp(0x1p-1022, 3 * scale); /* where a volume in the model's unit underflows */
    size_t bad = 0, first = 0;
    STARG_NEW_ZERO(own->context, STAGE, volumes, report->piece_count);
    for (size_t t = 0; t < own->mesh->count; t++)
        verify_add_tetrahedron(&volumes[own->mesh->labels[t]], own->mesh, t, scale);
    for (size_t p = report->piece_count; p-- > 0;)
        if (!verify_same_volume(&volumes[p], ldexp(report->pieces[p].volume, 3 * scale), lost)) {
            bad++;
            first = p;
        }
    if (bad == 0)
        verify_claim(own->verdict, true, "each piece has the volume that is claimed");
    else
        verify_claim(own->verdict, false,
                     "each piece has the volume that is claimed: %zu have not, first piece %zu, "
                     "claimed %.17g, found %.17g",
                     bad, first, report->pieces[first].volume,
                     ldexp(verify_volume_value(&volumes[first]), -3 * scale));
done:
    starg_release(own->context, volumes);
    return status;
}

static starg_status claim_contacts(const verify_context *own) {
    starg_status status = STARG_OK;
    verify_contacts contacts;
    STARG_TRY(verify_compare_contacts(own->pieces, own->report, &contacts));
    if (contacts.wrong == 0)
        verify_claim(own->verdict, true, "the %zu contacts of pieces and their areas are right",
                     own->report->contact_count);
    else
        verify_claim(own->verdict, false,
                     "the %zu contacts of pieces and their areas are right: %zu are wrong, twice "
                     "or missing, first %u-%u, claimed %.17g, found %.17g",
                     own->report->contact_count, contacts.wrong, contacts.first, contacts.second,
                     contacts.listed, contacts.found);
done:
    return status;
}

starg_status verify_claim_numbers(const verify_context *own) {
    starg_status status = STARG_OK;
    claim_size(own);
    if (!own->pieces->labels.good)
        goto done;
    claim_counts(own);
    STARG_TRY(claim_volumes(own));
    STARG_TRY(claim_contacts(own));
done:
    return status;
}
