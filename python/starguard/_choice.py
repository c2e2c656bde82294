# SPDX-License-Identifier: Apache-2.0
"""C options: words for enum values, and fields given by the caller."""
from __future__ import annotations

import difflib
import warnings
from typing import Any, Iterable, Mapping

from .errors import ArgumentError


def near(word: str, words: Iterable[str]) -> str:
    """"; did you mean ...?" for the most similar word, or nothing."""
    found = difflib.get_close_matches(word, list(words), 1)
    return f"; did you mean {found[0]!r}?" if found else ""


def choose(name: str, word: str, words: Mapping[str, int]) -> int:
    """The value of a word."""
    value = words.get(word) if isinstance(word, str) else None
    if value is None:
        raise ArgumentError(f"{name} is {word!r}; it must be one of {', '.join(words)}"
                            + (near(word, words) if isinstance(word, str) else ""))
    return value


def renamed(name: str, value: Any, old: str, old_value: Any) -> Any:
    """The value of a keyword that was called `old` in the last version."""
    if old_value is None:
        return value
    warnings.warn(f"{old}= is now called {name}=; the next version removes the old name",
                  DeprecationWarning, stacklevel=3)
    return old_value


def word_of(value: int, words: Mapping[str, int]) -> str:
    """The word of a value."""
    return next(word for word, other in words.items() if other == value)


def give(options: Any, **values: Any) -> None:
    """Sets the fields of an options struct that the caller has given."""
    for name, value in values.items():
        if value is None:
            continue
        try:
            setattr(options, name, value)
        except (TypeError, OverflowError) as error:
            raise ArgumentError(f"{name} is {value!r}: {error}") from error
