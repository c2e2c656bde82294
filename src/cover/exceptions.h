/* SPDX-License-Identifier: Apache-2.0 */
/* CBC and Clp are C++: what they throw must not get into C, where nobody catches it and the process
 * ends, and their memory may be out. */
#ifndef STARG_COVER_EXCEPTIONS_H
#define STARG_COVER_EXCEPTIONS_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes the call; false when it ended somewhere in the middle for an exception, or did not begin
 * for want of memory. One call at a time in the process (cover/solver.h). Where memory is out
 * within it and a reserve is used up as well, the process ends with status 3 and a message. */
bool cover_call_safely(void (*call)(void *argument), void *argument);

/* Within the call: the reserve is in use, so that the call had better come to an end. */
bool cover_memory_is_low(void);

#ifdef __cplusplus
}
#endif

#endif
