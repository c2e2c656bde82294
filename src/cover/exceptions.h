/* SPDX-License-Identifier: Apache-2.0 */
/* Calls into CBC and Clp, which are C++: their exceptions must not pass through C code, and they
 * may run out of memory. */
#pragma once

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes the call; false if an exception ended it, or if memory was too low to begin. One call at a
 * time in the process (cover/solver.h). If memory runs out during the call and the reserve is used
 * up too, the process ends with status 3 and a message. */
bool cover_call_safely(void (*call)(void *argument), void *argument);

/* Within the call: the reserve is in use, so the call should end soon. */
bool cover_memory_is_low(void);

#ifdef __cplusplus
}
#endif
