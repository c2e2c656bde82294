/* SPDX-License-Identifier: Apache-2.0 */
/* The threads of a context besides the calling one. They sleep between loops: searches run many
 * loops that take less time than the start of a thread. */
#ifndef STARG_CORE_WORKERS_H
#define STARG_CORE_WORKERS_H

#include <stdbool.h>
#include <stddef.h>

#include "starguard/context.h"

/* Lets up to `most` threads call run(argument), each once, until workers_end; fewer if they cannot
 * be started. *begun is false if the threads are in use already: nothing is to be ended then.
 * Errors: MEMORY, without detail. */
starg_status workers_begin(starg_context *context, size_t most, void (*run)(void *argument),
                           void *argument, bool *begun);

/* Waits for the calls that have begun; no other begins. */
void workers_end(starg_context *context);

/* Ends the threads. */
void workers_free(starg_context *context);

#endif
