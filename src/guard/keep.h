/* SPDX-License-Identifier: Apache-2.0 */
/* Guards that stay, and faces that must be seen by several: what is left for the others. */
#ifndef STARG_GUARD_KEEP_H
#define STARG_GUARD_KEEP_H

#include "guard/stages.h"

typedef struct kept_guards {
    candidate_points poses;
    starg_bits *rows; /* what they see, by column; NULL: there are none */
    uint32_t *need;   /* by column: how many others must see it */
    size_t open;      /* number of columns that others must see */
    uint32_t times;   /* the largest need */
    bool even;        /* all that others must see, they must see as often */
    uint64_t weight;  /* of the columns that need no others */
} kept_guards;

/* Are there such guards, or such faces? */
bool keep_applies(const guard_problem *problem);

/* Of a problem with all columns as targets. Errors: MESH (a guard that is not in the free
 * space), ARGUMENT (requests that exclude each other, a guard that looks nowhere), MEMORY,
 * CANCELLED. */
starg_status keep_find(const guard_problem *problem, kept_guards *out);
void keep_free(kept_guards *kept);

/* The same for what is asked of the others, once it is known. Errors: ARGUMENT. */
starg_status keep_check(const guard_problem *problem, const kept_guards *kept);

/* How many guards must see a column, those that stay among them. */
uint32_t keep_times(const guard_problem *problem, size_t column);

#endif
