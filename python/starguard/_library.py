"""The shared library, which lies beside this module, and its declarations."""
from __future__ import annotations

import importlib
import os
from typing import Any


_ffi: Any = importlib.import_module("._ffi", __package__)  # made by make_ffi.py
ffi: Any = _ffi.ffi
lib: Any = ffi.dlopen(os.path.join(os.path.dirname(os.path.abspath(__file__)), "libstarguard.so"))


def text(pointer: Any) -> str:
    """A C string; "" for NULL. Paths need not be UTF-8, and come back as os.fsencode takes them."""
    return "" if pointer == ffi.NULL else os.fsdecode(ffi.string(pointer))


version = text(lib.starg_version())
if version != _ffi.version:
    raise ImportError(f"the library is version {version}, but the package was made for "
                      f"{_ffi.version}; install starguard anew")
