# SPDX-License-Identifier: Apache-2.0
"""Library calls, each with its own context and off the main thread, so that they can be interrupted.

Each call has its own context, so that any thread may call anything at any time. Created objects
keep their context alive, because their memory returns there.

Python runs signal handlers on the main thread between instructions, not while a C function runs
there. So a helper thread runs the C function (ctypes releases the interpreter lock), while the main
thread waits and can receive Ctrl-C. It then cancels the library call, waits until the call has
returned (its arrays must outlive it), and re-raises the KeyboardInterrupt. The progress callback also
runs on the waiting thread, so that its exceptions are raised at the call.
"""
from __future__ import annotations

import collections
import logging
import operator
import threading
from dataclasses import dataclass
from typing import Any, SupportsIndex

from . import _told, errors
from ._library import ffi, lib, text
from ._types import Progress

logger = logging.getLogger("starguard")
_LEVELS = {lib.STARG_LOG_NOTICE: logging.INFO, lib.STARG_LOG_WARNING: logging.WARNING}
_TICK = 0.05  # seconds between checks for signals and progress


@dataclass
class Defaults:
    """Default arguments of all calls; `starguard.defaults` is the current one.

    >>> import starguard
    >>> starguard.defaults
    Defaults(threads=0, seed=1)
    """

    #: Threads of a call; 0: all cores. Results do not depend on it.
    threads: int = 0
    #: Seed for random numbers.
    seed: int = 1


defaults = Defaults()


class _Listener:
    """Receives the library's callbacks, on any thread."""

    def __init__(self) -> None:
        self.context: Any = None
        self.reports: collections.deque[tuple[str, float, str]] | None = None


@ffi.callback("starg_progress_fn")  # type: ignore[misc]
def _on_progress(user: Any, stage: Any, fraction: float) -> bool:
    listener = ffi.from_handle(user)
    reports = listener.reports
    if reports is not None:
        what = ffi.new("char **")
        best = lib.starg_context_best(listener.context, what)
        reports.append((text(stage), fraction, f"{best} {text(what[0])} so far" if best > 0 else ""))
    return True


@ffi.callback("starg_log_fn")  # type: ignore[misc]
def _on_log(user: Any, level: int, message: Any) -> None:
    logger.log(_LEVELS.get(level, logging.WARNING), "%s", errors.in_python(text(message)))


def _whole(name: str, value: SupportsIndex, most: int) -> int:
    number = operator.index(value) if hasattr(value, "__index__") else -1
    if not 0 <= number <= most:
        raise errors.ArgumentError(f"{name} is {value!r}; it must be a whole number from 0 to {most}")
    return number


# What objects and contexts need when they are freed, by address. A closure would not work: in cyclic
# garbage the collector clears functions in any order before it frees the objects that call them. This
# table is never garbage, so a context outlives all of its objects.
_owned: dict[int, tuple[Any, Any, bool, list[Any]]] = {}
_callbacks: dict[int, Any] = {}


def _address(block: Any) -> int:
    return int(ffi.cast("uintptr_t", block))


def _release(block: Any, owned: dict[int, tuple[Any, Any, bool, list[Any]]] = _owned,
             address: Any = _address) -> None:
    free, context, shared, others = owned.pop(address(block))
    if shared:
        free(context, block)
    else:
        free(block)
    del others


def _release_context(context: Any, callbacks: dict[int, Any] = _callbacks, address: Any = _address,
                     free: Any = lib.starg_context_free) -> None:
    handle = callbacks.pop(address(context))
    free(context)
    del handle


class Session:
    """A context and calls with it. One thread at a time."""

    def __init__(self, threads: int | None = None, seed: int | None = None) -> None:
        options = ffi.new("starg_context_options *")
        lib.starg_context_options_default(options)
        options.threads = _whole("threads", defaults.threads if threads is None else threads, 1024)
        options.seed = _whole("seed", defaults.seed if seed is None else seed, 2**64 - 1)
        self._listener = _Listener()
        handle = ffi.new_handle(self._listener)
        options.log = _on_log
        options.progress = _on_progress
        options.log_user = options.progress_user = handle
        out = ffi.new("starg_context **")
        status = lib.starg_context_create(options, out)
        if status != lib.STARG_OK:
            raise errors.of_status(status, None)

        _callbacks[_address(out[0])] = handle
        self.context = ffi.gc(out[0], _release_context)
        self._listener.context = out[0]

    # ---- calls ----

    def call(self, function: Any, *arguments: Any, progress: Progress | None = None,
             time_limit: float | None = None, brief: bool = False) -> None:
        """Calls a function that returns a status; raises on failure. Brief calls do not need a
        thread."""
        lib.starg_context_set_time_limit(self.context, _seconds(time_limit))
        on_main_thread = threading.current_thread() is threading.main_thread()
        if progress is False:
            progress = None
        if brief or (progress is None and not on_main_thread):
            status = function(*arguments)
        elif progress is True:
            status = _told.with_bar(lambda bar: self._call_aside(function, arguments, bar))
        else:
            status = self._call_aside(function, arguments, progress)
        if status != lib.STARG_OK:
            raise errors.of_status(status, self.context)

    def _call_aside(self, function: Any, arguments: tuple[Any, ...],
                    progress: Progress | None) -> int:
        """Runs the call on a separate thread and always waits for it."""
        begun, done = threading.Event(), threading.Event()
        outcome: list[Any] = []
        reports: collections.deque[tuple[str, float, str]] = collections.deque()
        self._listener.reports = reports if progress is not None else None

        def work() -> None:
            begun.set()
            try:
                outcome.append(function(*arguments))
            except BaseException as error:  # an argument that is not of the C type
                outcome.append(error)
            done.set()

        interruption: BaseException | None = None
        try:
            threading.Thread(target=work, name="starguard", daemon=True).start()
        except BaseException as error:  # a signal, probably after the thread has started
            lib.starg_context_cancel(self.context)
            if not begun.wait(1):
                raise
            interruption = error
        finished = False
        while interruption is None and not finished:
            try:
                finished = done.wait(_TICK)  # a signal just before the wait does not end it
                self._deliver(reports, progress)
            except BaseException as error:
                interruption = error
        while interruption is not None and not done.is_set():
            try:
                lib.starg_context_cancel(self.context)
                done.wait()
            except BaseException:  # checked again: already finishing
                continue
        self._listener.reports = None
        lib.starg_context_reset(self.context)
        if interruption is None and isinstance(outcome[0], BaseException):
            interruption = outcome[0]
        if interruption is not None:
            try:
                raise interruption
            finally:
                del interruption, outcome  # break the reference cycle with this frame
        return int(outcome[0])

    def _deliver(self, reports: collections.deque[tuple[str, float, str]],
                 progress: Progress | None) -> None:
        while reports:
            stage, fraction, best = reports.popleft()
            if isinstance(progress, _told.Bar) and best:
                stage = f"{stage}, {best}"
            answer = progress(stage, fraction) if callable(progress) else None
            if answer is False:
                lib.starg_context_cancel(self.context)
            elif answer == "enough":
                lib.starg_context_finish(self.context)

    # ---- what calls make ----

    def make(self, kind: str, free: Any, function: Any, *arguments: Any, shared: bool = False,
             progress: Progress | None = None, time_limit: float | None = None,
             brief: bool = False) -> Any:
        """Calls a function whose last parameter receives a new `kind`, and owns the result."""
        out = ffi.new(f"{kind} **")
        try:
            self.call(function, *arguments, out, progress=progress, time_limit=time_limit,
                      brief=brief)
        finally:  # an interrupted call may still have finished
            handle = self.own(out[0], free, shared) if out[0] else None
        return handle

    def own(self, pointer: Any, free: Any, shared: bool = False) -> Any:
        """A handle that frees its object; `shared`: with the context as first argument."""
        _owned[_address(pointer)] = free, self.context, shared, []
        return ffi.gc(pointer, _release)

    def lends(self, handle: Any) -> None:
        """The object of `handle` now holds memory of this context as well, which has to outlive it."""
        _owned[_address(handle)][3].append(self.context)


def _seconds(time_limit: float | None) -> float:
    if time_limit is None:
        return 0.0
    if not time_limit > 0:
        raise errors.ArgumentError(f"time_limit is {time_limit!r}; it must be above 0 seconds")
    return float(time_limit)
