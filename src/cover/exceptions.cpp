/* The one file in C++: C has no way to catch.
 *
 * When memory is out, operator new calls a handler. It leaves by longjmp: an exception would run
 * the destructors of half-made objects on its way, and some in CBC read what was never written.
 * What the libraries held is lost with either. */
#include "cover/exceptions.h"

#include <atomic>
#include <csetjmp>
#include <new>

static thread_local std::jmp_buf *way_out;    /* of the call that this thread is in */
static std::atomic<std::new_handler> process; /* the handler of the process         */

static void leave() {
    if (way_out != nullptr)
        std::longjmp(*way_out, 1);
    std::new_handler own = process;
    if (own == nullptr)
        throw std::bad_alloc();
    own();
}

bool cover_call_safely(void (*call)(void *argument), void *argument) {
    std::jmp_buf here;
    volatile bool done = false;
    process = std::get_new_handler();
    std::set_new_handler(leave);
    way_out = &here;
    if (setjmp(here) == 0) {
        try {
            call(argument);
            done = true;
        } catch (...) {
            done = false;
        }
    }
    way_out = nullptr;
    if (std::get_new_handler() == leave)
        std::set_new_handler(process);
    return done;
}
