/* How must one spread surface be turned so that it lies on another one as well as possible? */
#ifndef STARG_MORPH_ALIGN_H
#define STARG_MORPH_ALIGN_H

#include "morph/locate.h"

/* Vertices that shall meet: `from` of the first surface, `to` of the second. */
typedef struct landmark_list {
    const uint32_t *from, *to;
    size_t count;
} landmark_list;

/* Turns the directions of `from`. Errors: MEMORY, CANCELLED. */
starg_status align_spheres(sphere *from, const locator *to, const landmark_list *landmarks);

#endif
