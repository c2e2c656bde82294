/* CBC and Clp are C++: what they throw (above all when memory is out) must not get into C, where
 * nobody catches it and the process ends. */
#ifndef STARG_COVER_EXCEPTIONS_H
#define STARG_COVER_EXCEPTIONS_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes the call; false when an exception came out of it, which left it at some place in the
 * middle.
 */
bool cover_call_safely(void (*call)(void *argument), void *argument);

#ifdef __cplusplus
}
#endif

#endif
