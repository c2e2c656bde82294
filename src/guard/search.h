/* The search over every point of the free space. */
#ifndef STARG_GUARD_SEARCH_H
#define STARG_GUARD_SEARCH_H

#include "guard/stages.h"

/* Replaces the choice by fewer guards where it finds them, which see all that the former ones saw,
 * and adds them to the pool. *bound: no fewer guards see that, wherever they stand. All is to be
 * covered once, all around. Errors: MEMORY, CANCELLED. */
starg_status search_guards(const guard_problem *problem, guard_pool *pool,
                           guard_selection *selection, size_t *bound);

#endif
