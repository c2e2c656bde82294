/* The one file in C++: C has no way to catch. */
#include "cover/exceptions.h"

bool cover_call_safely(void (*call)(void *argument), void *argument) {
    try {
        call(argument);
    } catch (...) {
        return false;
    }
    return true;
}
