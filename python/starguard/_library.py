# SPDX-License-Identifier: Apache-2.0
"""The shared libraries beside this module, and their declarations."""
from __future__ import annotations

import glob
import importlib
import os
from typing import Any

from ._c import Interface, Library

_declared: Any = importlib.import_module("._declarations", __package__)  # made by make_declarations.py
ffi: Any = Interface(_declared.STRUCTS, _declared.FUNCTION_TYPES)


def _open(name: str) -> Any:
    path, = glob.glob(os.path.join(os.path.dirname(os.path.abspath(__file__)), f"{name}.so.*"))
    return Library(ffi, path, _declared.FUNCTIONS, _declared.CONSTANTS)


_base: Any = _open("libstarguard")  # first, because the other one needs it
lib: Any = _open("libstarguard-shapes")  # its functions are found here as well


def text(pointer: Any) -> str:
    """A C string; "" for NULL. Paths need not be UTF-8; os.fsencode restores them."""
    return "" if pointer == ffi.NULL else os.fsdecode(ffi.string(pointer))


version = text(lib.starg_version())
if version != _declared.VERSION:
    raise ImportError(f"the library is version {version}, but the package was made for "
                      f"{_declared.VERSION}; install starguard anew")
