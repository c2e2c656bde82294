/* The ends of a shape's limbs: features that tell which way round it stands. */
#ifndef STARG_MORPH_TIPS_H
#define STARG_MORPH_TIPS_H

#include "morph/sphere.h"

enum { TIPS_MOST = 16 };

typedef struct tip_list {
    size_t count;
    uint32_t vertices[TIPS_MOST];
} tip_list;

/* Finds the tips of a surface, the farthest from everything else first. Errors: MEMORY, CANCELLED.
 */
starg_status tips_find(const sphere *s, tip_list *out);

#endif
