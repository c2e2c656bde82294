/* SPDX-License-Identifier: Apache-2.0 */
/* The report of a morph as read for the verifier. */
#ifndef STARG_VERIFY_MORPH_H
#define STARG_VERIFY_MORPH_H

#include "starguard/verify.h"

typedef struct verify_frame {
    double t, volume, area, volume_drift, area_drift;
    size_t intersections;
} verify_frame;

struct starg_morph_report {
    starg_context *context;
    size_t frame_count;
    verify_frame *frames;
};

#endif
