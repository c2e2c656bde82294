# SPDX-License-Identifier: Apache-2.0
"""The shared libraries beside this module, and their declarations."""
from __future__ import annotations

import glob
import importlib
import os
from typing import Any


_ffi: Any = importlib.import_module("._ffi", __package__)  # made by make_ffi.py
ffi: Any = _ffi.ffi


def _open(name: str) -> Any:
    path, = glob.glob(os.path.join(os.path.dirname(os.path.abspath(__file__)), f"{name}.so.*"))
    return ffi.dlopen(path)


_base: Any = _open("libstarguard")  # first, because the other one needs it
lib: Any = _open("libstarguard-shapes")  # its functions are found here as well


def text(pointer: Any) -> str:
    """A C string; "" for NULL. Paths need not be UTF-8; os.fsencode restores them."""
    return "" if pointer == ffi.NULL else os.fsdecode(ffi.string(pointer))


version = text(lib.starg_version())
if version != _ffi.version:
    raise ImportError(f"the library is version {version}, but the package was made for "
                      f"{_ffi.version}; install starguard anew")
