/* CBC and Clp are C++: what they throw must not get into C, where nobody catches it and the process
 * ends, and their memory may be out. */
#ifndef STARG_COVER_EXCEPTIONS_H
#define STARG_COVER_EXCEPTIONS_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes the call; false when it ended somewhere in the middle, for an exception or for memory. One
 * call at a time in the process (cover/solver.h). */
bool cover_call_safely(void (*call)(void *argument), void *argument);

#ifdef __cplusplus
}
#endif

#endif
