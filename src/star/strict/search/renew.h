/* SPDX-License-Identifier: Apache-2.0 */
/* Cutting some neighbouring pieces anew. */
#ifndef STARG_STAR_STRICT_SEARCH_RENEW_H
#define STARG_STAR_STRICT_SEARCH_RENEW_H

#include "star/strict/search/improve.h"

typedef struct renew_options {
    uint64_t trials, work; /* of the search in what is cut anew, at most */
    uint64_t round;        /* number of it: others try other things      */
    improve_tallies *tallies;
} renew_options;

typedef struct renew_report {
    uint64_t trials, work;
    bool better; /* there are fewer pieces */
    bool time_limited;
} renew_report;

/* Joins some pieces of a partition with an index, cuts their union from scratch and searches what
 * has become of it; the partition is as it was if that gives more pieces than before. Errors:
 * MEMORY, CANCELLED. */
starg_status renew(partition *p, const renew_options *options, renew_report *report);

#endif
