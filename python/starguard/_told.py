# SPDX-License-Identifier: Apache-2.0
"""What a user sees of results and of long calls: one line each."""
from __future__ import annotations

import dataclasses
import importlib
import sys
from typing import Any, Callable, Optional

_WIDTH = 30  # of a bar


class Told:
    """A dataclass whose repr is a line: numbers as they are, of arrays and lists the size."""

    def __repr__(self) -> str:
        parts = []
        for one in dataclasses.fields(self):
            value = getattr(self, one.name)
            if not one.repr or value is None:
                continue
            if hasattr(value, "shape"):
                told = "x".join(map(str, value.shape))
            elif isinstance(value, (list, tuple, dict)):
                told = str(len(value))
            else:
                told = f"{value:.6g}" if isinstance(value, float) else repr(value)
            parts.append(f"{one.name}={told}")
        return f"{type(self).__name__}({', '.join(parts)})"


class Bar:
    """Progress of a call on standard error: by tqdm, if that is installed, else by itself."""

    def __init__(self) -> None:
        try:
            tqdm: Any = importlib.import_module("tqdm.auto").tqdm
            self._bar: Any = tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}")
        except ImportError:
            self._bar = None
        self._longest = 0

    def __call__(self, stage: str, fraction: float) -> Optional[bool]:
        if self._bar is not None:
            self._bar.set_description_str(stage, refresh=False)
            self._bar.n = fraction
            self._bar.refresh()
            return None
        full = round(_WIDTH * fraction)
        line = f"{stage}: {100 * fraction:3.0f} % [{'#' * full}{' ' * (_WIDTH - full)}]"
        self._longest = max(self._longest, len(line))
        print("\r" + line.ljust(self._longest), end="", file=sys.stderr, flush=True)
        return None

    def close(self) -> None:
        """Removes the line."""
        if self._bar is not None:
            self._bar.close()
        elif self._longest > 0:
            print("\r" + " " * self._longest + "\r", end="", file=sys.stderr, flush=True)


def with_bar(call: Callable[[Any], int]) -> int:
    """Calls with a bar, and removes it."""
    bar = Bar()
    try:
        return call(bar)
    finally:
        bar.close()
