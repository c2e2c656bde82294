# SPDX-License-Identifier: Apache-2.0
"""Keyword arguments, range checks and docstrings of options, derived from the library's field tables
(starguard/fields.h). A new row there is a new keyword here."""
from __future__ import annotations

import inspect
import math
import operator
import re
import textwrap
import warnings
from typing import Any, Callable, Iterator, Mapping, TypeVar

from . import _arrays
from ._choice import near
from ._library import ffi, lib, text
from .errors import ArgumentError

T = TypeVar("T")
_TYPES = {lib.STARG_FIELD_FLAG: "bool", lib.STARG_FIELD_COUNT: "int", lib.STARG_FIELD_REAL: "float",
          lib.STARG_FIELD_CHOICE: "str", lib.STARG_FIELD_TEXT: "PathLike",
          lib.STARG_FIELD_NUMBERS: "Sequence[float]"}
_TEXT_SIZE = 512


class Field:
    """A row of a table."""

    def __init__(self, row: Any) -> None:
        self._row, self.kind = row, row.kind
        #: As on the command line, with _ for -; flags without "no".
        name = text(row.option) or text(row.key)
        self._cleared = self.kind == lib.STARG_FIELD_FLAG and name.startswith("no-")
        if self._cleared:
            name = name[3:]
        self.name = name.replace("-", "_")
        #: A word of starg_field_group, or "".
        self.group = text(row.group)
        self.words: list[str] = []
        while row.words and row.words[len(self.words)]:
            self.words.append(text(row.words[len(self.words)]))

    def _at(self, struct: Any, kind: str) -> Any:
        return ffi.cast(kind, ffi.cast("char *", struct) + self._row.offset)

    def _text(self, function: Any) -> str:
        buffer = ffi.new("char[]", _TEXT_SIZE)
        function(self._row, buffer, _TEXT_SIZE)
        return text(buffer)

    def _numbers(self, struct: Any) -> Any:
        return self._at(struct, "double *")[0:self._row.length]

    def _fits(self, number: float) -> bool:
        above = number > self._row.low if self._row.flags & lib.STARG_FIELD_ABOVE else number >= self._row.low
        return bool(above and number <= self._row.high)

    def _expectation(self) -> str:
        said = self._text(lib.starg_field_expectation)
        if self.kind == lib.STARG_FIELD_TEXT:
            return "a file name"
        return f"{self._row.length} numbers, each {said}" if self.kind == lib.STARG_FIELD_NUMBERS else said

    def _wrong(self, value: Any) -> ArgumentError:
        what = self._expectation()
        hint = near(value, self.words) if isinstance(value, str) else ""
        return ArgumentError(f"the {self.name.replace('_', ' ')} is {value!r}; it must be {what}{hint}")

    def get(self, struct: Any) -> Any:
        """The value as a caller would give it; None if it has no number."""
        if self.kind == lib.STARG_FIELD_REAL:
            number = self._at(struct, "double *")[0]
            return text(lib.starg_field_real_word(self._row, number)) or number
        if self.kind == lib.STARG_FIELD_TEXT:
            return text(self._at(struct, "char **")[0]) or None
        if self.kind == lib.STARG_FIELD_NUMBERS:
            numbers = tuple(self._numbers(struct))
            return None if all(number == self._row.standard for number in numbers) else numbers
        value = lib.starg_field_count(self._row, struct)
        if self.kind == lib.STARG_FIELD_FLAG:
            return bool(value)
        if self.kind == lib.STARG_FIELD_CHOICE:
            return self.words[value]
        if word := text(lib.starg_field_word(self._row, value)):
            return word
        return value if self._row.least <= value <= self._row.most else None

    def set(self, struct: Any, value: Any) -> Any:
        """Sets it; the returned object must live as long as the struct."""
        fits, keep = False, None
        try:
            if self.words and isinstance(value, str):
                fits = lib.starg_field_set_word(self._row, struct, value.encode())
            elif self.kind == lib.STARG_FIELD_REAL:
                number = math.nan if isinstance(value, (str, bytes)) else float(value)
                fits = (lib.starg_field_set_real(self._row, struct, number)
                        or number == self._row.standard)  # a default outside the range
            elif self.kind == lib.STARG_FIELD_TEXT:
                keep = ffi.new("char[]", _arrays.path(value))
                self._at(struct, "char **")[0] = keep
                fits = True
            elif self.kind == lib.STARG_FIELD_NUMBERS:
                numbers = [] if isinstance(value, (str, bytes)) else [float(number) for number in value]
                fits = len(numbers) == self._row.length and all(map(self._fits, numbers))
                if fits:
                    ffi.memmove(self._at(struct, "double *"), ffi.new("double[]", numbers), 8 * len(numbers))
            elif self.kind == lib.STARG_FIELD_CHOICE:
                fits = lib.starg_field_set_word(self._row, struct, value.encode())
            elif self.kind == lib.STARG_FIELD_FLAG:
                fits = (value in (True, False)
                        and lib.starg_field_set_count(self._row, struct, bool(value)))
            else:
                number = operator.index(value)
                fits = number <= self._row.most and lib.starg_field_set_count(self._row, struct, number)
        except (AttributeError, TypeError, ValueError, OverflowError) as error:
            raise self._wrong(value) from error
        if not fits:
            raise self._wrong(value)
        return keep

    def explain(self) -> str:
        """A line for a docstring: values, meaning and default."""
        values = self._text(lib.starg_field_expectation)
        if self.kind == lib.STARG_FIELD_CHOICE:
            values = ", ".join(f'"{word}"' for word in self.words)
        elif self.kind in (lib.STARG_FIELD_TEXT, lib.STARG_FIELD_NUMBERS):
            values = self._expectation()
        elif self.kind == lib.STARG_FIELD_FLAG:
            values = f"True or False, by default {bool(self._row.initial)}"
        else:
            values = f"{text(self._row.value)}: {values}"
        said = re.sub(r"--([a-z-]+)", lambda m: m.group(1).replace("-", "_"), text(self._row.help))
        return (f"- `{self.name}` ({values}): {'if False: ' * self._cleared}{said} "
                f"{self._text(lib.starg_field_default_text)}").rstrip()


class Struct:
    """A filled options struct and the memory it refers to."""

    def __init__(self, pointer: Any, keep: list[Any]) -> None:
        self.pointer, self._keep = pointer, keep


class Options:
    """The options of a call. `old` maps names of the last version to current names."""

    def __init__(self, kind: str, old: Mapping[str, str] = {}) -> None:
        self._kind, self._old = kind, dict(old)
        table = getattr(lib, f"{kind}_fields")()
        fields = [Field(table.fields + i) for i in range(table.count)]
        self.fields = {field.name: field for field in fields if field.kind in _TYPES}

    def __iter__(self) -> Iterator[Field]:
        return iter(self.fields.values())

    def _renamed(self, given: Mapping[str, Any]) -> dict[str, Any]:
        values = {}
        for name, value in given.items():
            now = self._old.get(name, name)
            if now not in self.fields:
                raise TypeError(f"unknown option {name!r}{near(name, self.fields)}")
            if now in values:
                raise TypeError(f"{now!r} is given twice, once by its old name")
            if now != name:
                warnings.warn(f"{name}= is now called {now}=; the next version removes the old name",
                              DeprecationWarning, stacklevel=4)
            values[now] = value
        return values

    def make(self, given: Mapping[str, Any]) -> Struct:
        """The struct with defaults and the given values that are not None. Must be called by the
        public function itself, because warnings refer to its caller."""
        pointer = ffi.new(f"{self._kind} *")
        getattr(lib, f"{self._kind}_default")(pointer)
        keep = [self.fields[name].set(pointer, value)
                for name, value in self._renamed(given).items() if value is not None]
        return Struct(pointer, keep)

    def read(self, struct: Any) -> dict[str, Any]:
        """All options of a struct, by name."""
        values = {field.name: field.get(struct) for field in self}
        return _Values(values, self._old)

    def word(self, name: str, number: int) -> str:
        """The word for the number of an enum."""
        return self.fields[name].words[number]


class _Values(dict[str, Any]):
    """Options by name, or by an old name."""

    def __init__(self, values: Mapping[str, Any], old: Mapping[str, str]) -> None:
        super().__init__(values)
        self._old = old

    def __missing__(self, name: str) -> Any:
        if name not in self._old:
            raise KeyError(name)
        warnings.warn(f"{name!r} is now called {self._old[name]!r}", DeprecationWarning, stacklevel=2)
        return self[self._old[name]]


# ---- what help() shows ----


def _groups() -> list[tuple[str, str]]:
    """Words and titles of the groups of options; "" is that of the others."""
    title = ffi.new("char **")
    found: list[tuple[str, str]] = []
    while group := text(lib.starg_field_group(len(found), title)):
        found.append((group, text(title[0])))
    return [*found, ("", "Others")]


def _explained(doc: str | None, fields: list[Field]) -> str:
    """A docstring with a list of options before its example."""
    told, example, rest = inspect.cleandoc(doc or "").partition(">>> ")
    lines: list[str] = []
    for group, title in _groups():
        part = [textwrap.fill(field.explain(), 96, subsequent_indent="  ", break_on_hyphens=False)
                for field in fields if field.group == group]
        if part:
            lines += [f"{title}:", *part, ""]
    return "\n".join([told.rstrip(), "", "Options (None is the default):", "", *lines, example + rest]).rstrip()


def takes(options: Options) -> Callable[[T], T]:
    """Adds all options to the signature and docstring of a function with `**options`, or a
    class, except its own parameters."""

    def decorate(thing: T) -> T:
        function: Any = thing.__init__ if inspect.isclass(thing) else thing
        signature = inspect.signature(function)
        own = {name: p for name, p in signature.parameters.items() if p.kind != p.VAR_KEYWORD}
        fields = [field for field in options if field.name not in own]
        thing.__doc__ = _explained(thing.__doc__, fields)
        made = [inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=None,
                                  annotation=f"{_TYPES[field.kind]} | None") for field in fields]
        before = [p for p in own.values() if p.kind != p.KEYWORD_ONLY]
        after = [p for p in own.values() if p.kind == p.KEYWORD_ONLY]
        function.__signature__ = signature.replace(parameters=before + made + after)
        return thing

    return decorate
