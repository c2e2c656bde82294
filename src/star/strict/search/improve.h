/* SPDX-License-Identifier: Apache-2.0 */
/* Making the pieces of a partition fewer. */
#pragma once

#include "star/strict/partition/partition.h"

enum { IMPROVE_SORTS = 8 };

/* What trials of each sort have cost and brought lately. All zero at first. */
typedef struct improve_tallies {
    struct {
        double work, trials, saved;
        double due; /* when the next one is */
    } of[IMPROVE_SORTS];
} improve_tallies;

typedef struct improve_options {
    uint64_t trials; /* to be made at most                             */
    uint64_t work;   /* likewise, in vertices, facets and rows looked at; whole batches are made */
    uint64_t patience;        /* trials that save nothing, after which the search ends */
    size_t enough;            /* stop when there are no more pieces than that   */
    uint64_t first;           /* number of the first trial: others try other things */
    uint64_t since;           /* unions contain a piece with a later stamp */
    improve_tallies *tallies; /* are read and kept up */
} improve_options;

typedef struct improve_report {
    uint64_t trials, work, joins, repartitions, eliminated, moves, refused;
    bool time_limited;
} improve_report;

/* Joins neighbours whose union is star-shaped, until there are none or the time is over. Errors:
 * MEMORY, CANCELLED. */
starg_status improve_join(partition *p);

/* Joins pieces whose union is star-shaped and cuts unions again into fewer pieces, until no trial
 * helps for long, or the trials, the work or the time are used up. The partition is valid at all
 * times. Errors: MEMORY, CANCELLED. */
starg_status improve(partition *p, const improve_options *options, improve_report *report);

/* ---- cutting some neighbouring pieces anew (renew.c) ---- */

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
