/* SPDX-License-Identifier: Apache-2.0 */
/* In C++, because C cannot catch exceptions.
 *
 * When memory is out, operator new calls a handler repeatedly until it finds some. The first call
 * releases a reserve and asks the solver to stop. If the reserve runs out before it does, the
 * process's own handler runs if there is one; otherwise the process ends with status 3. Jumping out
 * of the handler would be undefined, and an exception would run destructors of partly constructed
 * objects, some of which read uninitialized memory in CBC. */
#include "cover/exceptions.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

static const std::size_t RESERVE = std::size_t(32) << 20;
static const int OUT_OF_MEMORY = 3; /* exit status, as of the command line for unfinished work */

static thread_local bool is_inside;           /* this thread is in a call */
static thread_local void *reserve;            /* NULL: used up */
static std::atomic<std::new_handler> process; /* the handler of the process */

static void find_memory() {
    std::new_handler own = process;
    if (is_inside && reserve != nullptr) {
        std::free(reserve);
        reserve = nullptr;
    } else if (own != nullptr) {
        own();
    } else if (is_inside) {
        std::fputs("starguard: out of memory in the solver library, which cannot recover; use "
                   "fewer candidates\n",
                   stderr);
        std::_Exit(OUT_OF_MEMORY);
    } else {
        throw std::bad_alloc();
    }
}

bool cover_memory_is_low(void) {
    return is_inside && reserve == nullptr;
}

bool cover_call_safely(void (*call)(void *argument), void *argument) {
    bool done = false;
    reserve = std::malloc(RESERVE);
    if (reserve == nullptr)
        return false;
    process = std::get_new_handler();
    std::set_new_handler(find_memory);
    is_inside = true;
    try {
        call(argument);
        done = true;
    } catch (...) {
        done = false;
    }
    is_inside = false;
    if (std::get_new_handler() == find_memory)
        std::set_new_handler(process);
    std::free(reserve);
    return done;
}
