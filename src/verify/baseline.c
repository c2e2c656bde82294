/* SPDX-License-Identifier: Apache-2.0 */
/* How many faces do two guards see that are the baseline apart? All pairs of guards of all faces.
 */
#include "verify/facts.h"

static bool is_paired(const verify_facts *known, size_t face, double cosine) {
    const double *t[3], *places = known->guards->positions;
    verify_corners(known->surface, face, t);
    for (size_t g = 0; g < known->guards->count; g++)
        for (size_t h = g + 1; starg_bits_test(known->faces, g, face) && h < known->guards->count;
             h++)
            if (starg_bits_test(known->faces, h, face) &&
                verify_apart(t, places + 3 * g, places + 3 * h, cosine))
                return true;
    return false;
}

size_t verify_count_paired(const verify_facts *known) {
    double cosine = starg_cone_cosine(2 * known->guards->options.baseline);
    size_t count = 0;
    for (size_t f = 0; f < known->surface->face_count; f++)
        count += is_paired(known, f, cosine);
    return count;
}
