/* SPDX-License-Identifier: Apache-2.0 */
/* The one file in C++: C has no way to catch.
 *
 * When memory is out, operator new calls a handler, again and again until it finds some. The first
 * time it gets a reserve, and the solver is asked to stop. Where the reserve does not last until it
 * does, the handler of the process has its turn, if it has one; else the process ends with
 * status 3. A jump out of the handler would be undefined, and an exception runs the destructors of
 * half-made objects, some of which read in CBC what was never written. */
#include "cover/exceptions.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

static const std::size_t RESERVE = std::size_t(32) << 20;
static const int OUT_OF_MEMORY =
    3; /* exit status, that of the command line for what could not finish */

static thread_local bool is_inside;           /* this thread is in a call            */
static thread_local void *reserve;            /* NULL: used up                       */
static std::atomic<std::new_handler> process; /* the handler of the process          */

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
