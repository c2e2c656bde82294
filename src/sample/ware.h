/* SPDX-License-Identifier: Apache-2.0 */
/* Families of man-made things: members of random proportions, built of revolved and extruded
 * outlines and round cones. */
#ifndef STARG_SAMPLE_WARE_H
#define STARG_SAMPLE_WARE_H

#include "sample/implicit.h"

typedef enum ware_kind { WARE_VASE, WARE_BUST, WARE_BEARING, WARE_TABLE, WARE_TOOL } ware_kind;

enum { WARE_MEMBERS = 10, WARE_MAX_OUTLINES = 16 };

typedef struct ware {
    implicit_field field;
    size_t outline_count;
    implicit_outline outlines[WARE_MAX_OUTLINES];
    int genus;
} ware;

/* Builds a member, 0 to WARE_MEMBERS - 1; the parts point into *out, which is not to be moved. */
void ware_build(ware_kind kind, int member, ware *out);

#endif
