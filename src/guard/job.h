/* One call of starg_guard: its inputs, what its stages hand on, and what they found. */
#ifndef STARG_GUARD_JOB_H
#define STARG_GUARD_JOB_H

#include "guard/choose.h"
#include "starguard/simplify.h"

typedef struct guard_job {
    starg_context *context;
    const starg_solid *solid;
    const starg_guard_options *options;
    starg_levels *detail;  /* NULL: none are wanted, or there was no time */
    starg_solid *samples;  /* NULL: the solid itself                      */
    candidate_shape shape; /* what candidates are of                      */
    guard_pool pool;
    column_weights weights;
    STARG_ARRAY(uint32_t) chosen; /* candidates, the one that adds most first */
    STARG_ARRAY(int) levels;      /* of `chosen` */
    STARG_ARRAY(starg_guard_level) records;
    size_t lower_bound;
    uint64_t weight_bound; /* no max_guards candidates see more */
    uint64_t lines_tested;
    bool time_limited;
} guard_job;

/* The level of a candidate that is chosen already, else `otherwise`. */
int job_level_of(const guard_job *job, uint32_t candidate, int otherwise);

/* Takes a cover's rows as the chosen ones, with its bounds; those that were chosen before keep
 * their level, the others are of `level`. Errors: MEMORY. */
starg_status job_take_cover(guard_job *job, const starg_cover *cover, int level);

/* STARG_GUARD_PILP (guard/progressive.c): fills chosen, levels and records. The bounds are found
 * apart. Errors: MEMORY, CANCELLED. */
starg_status progressive_guards(guard_job *job);
starg_status bound_guards(guard_job *job);

/* Adds candidates where they pay and chooses again (guard/refine.c). Errors: MEMORY, CANCELLED. */
starg_status refine_guards(guard_job *job);

/* Fills the coverage, the counts and the curve of a result that has its positions
 * (guard/measure.c). Errors: MEMORY, CANCELLED. */
starg_status measure_guards(guard_job *job, starg_guards *result);

#endif
