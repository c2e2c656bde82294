# SPDX-License-Identifier: Apache-2.0
"""C types, memory and functions by ctypes, with the interface of cffi as far as this package uses it.

The package thus needs nothing but Python and NumPy, and one wheel serves every Python. ctypes alone
would not do: it truncates numbers silently, copies strings where a pointer is meant and lets a pointer
to one struct pass for another. Here all memory is reached through `Data`, which checks what goes in.

`Data` is an address with a type: a pointer, an array or a struct. As in C, p.member, p[i], p + i and
p == q work, and an array passes as a pointer to its first element. A pointer that `new`, `from_buffer`
or `gc` has made keeps its memory alive; a pointer that was read from memory does not.
"""
from __future__ import annotations

import ctypes
import re
from typing import Any, Callable, Iterator, Mapping

_PRIMITIVES: dict[str, Any] = {
    "bool": ctypes.c_bool, "char": ctypes.c_char, "int": ctypes.c_int, "unsigned": ctypes.c_uint,
    "float": ctypes.c_float, "double": ctypes.c_double, "size_t": ctypes.c_size_t, "uintptr_t": ctypes.c_size_t,
    "int32_t": ctypes.c_int32, "int64_t": ctypes.c_int64, "uint8_t": ctypes.c_uint8,
    "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64}


class Field:
    """A member of a struct."""

    def __init__(self, kind: Type, offset: int) -> None:
        self.type, self.offset = kind, offset


class Type:
    """`kind` is "primitive", "pointer", "array", "struct", "function" or "void".

    Pointers and arrays have an `item`, arrays a `length`, structs their `fields`, if they are known.
    """

    def __init__(self, name: str, kind: str, size: int = 0, alignment: int = 1) -> None:
        self.name, self.kind, self.size, self.alignment = name, kind, size, alignment
        self.item: Type = self
        self.length = 0
        self.fields: dict[str, Field] = {}
        self.memory: Any = None  # the type of ctypes for one value in memory
        self.low, self.high = 0, 0  # the range of whole numbers

    def __repr__(self) -> str:
        return f"<C type {self.name}>"


class Data:
    """An address with a type."""

    __slots__ = ("_address", "_type", "_keep", "__weakref__")
    _address: int
    _type: Type
    _keep: Any

    def __init__(self, kind: Type, address: int, keep: Any = None) -> None:
        object.__setattr__(self, "_type", kind)
        object.__setattr__(self, "_address", address)
        object.__setattr__(self, "_keep", keep)

    def __repr__(self) -> str:
        return f"<C {self._type.name} at {self._address:#x}>"

    # Results of the library do not change, so copies share them. An address means nothing elsewhere.

    def __copy__(self) -> Data:
        return self

    def __deepcopy__(self, memo: Any) -> Data:
        return self

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError("this object belongs to the library and cannot be pickled; write it to a file (write) and "
                        "read it again, or pickle what it was made of, such as its mesh")

    def __bool__(self) -> bool:
        return self._address != 0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Data) and self._address == other._address

    def __hash__(self) -> int:
        return hash(self._address)

    def __int__(self) -> int:
        return self._address

    def __add__(self, count: int) -> Data:
        kind = self._type
        if kind.kind == "array":
            raise TypeError("only a pointer can be moved")
        return Data(kind, self._address + count * kind.item.size, self._keep)

    # ---- members of a struct, also through a pointer ----

    def _field(self, name: str) -> tuple[Type, int]:
        kind = self._type.item if self._type.kind == "pointer" else self._type
        field = kind.fields.get(name)
        if field is None:
            raise AttributeError(f"{kind.name} has no member {name!r}")
        if self._address == 0:
            raise ValueError(f"{kind.name}.{name} through NULL")
        return field.type, self._address + field.offset

    def __getattr__(self, name: str) -> Any:
        return _read(*self._field(name), self._keep)

    def __setattr__(self, name: str, value: Any) -> None:
        _write(*self._field(name), value)

    # ---- elements ----

    def _element(self, index: int) -> tuple[Type, int]:
        kind = self._type
        if kind.kind not in ("pointer", "array"):
            raise TypeError(f"{kind.name} has no elements")
        if kind.kind == "array" and not 0 <= index < kind.length:
            raise IndexError(f"element {index} of {kind.name}")
        if self._address == 0:
            raise ValueError(f"element {index} of a {kind.name} that is NULL")
        if kind.item.size == 0:
            raise TypeError(f"the size of {kind.item.name} is not known")
        return kind.item, self._address + index * kind.item.size

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            first, last = index.start or 0, index.stop
            item, address = self._element(first) if last > first else (self._type.item, self._address)
            return Data(_array(item, last - first), address, self._keep)
        return _read(*self._element(index), self._keep)

    def __setitem__(self, index: int, value: Any) -> None:
        _write(*self._element(index), value)

    def __len__(self) -> int:
        if self._type.kind != "array":
            raise TypeError(f"{self._type.name} has no length")
        return self._type.length

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))


class Owned(Data):
    """A pointer whose memory `destructor` frees, once: when the pointer is no longer used."""

    __slots__ = ("_destructor",)
    _destructor: Callable[[Data], None] | None

    def __init__(self, pointer: Data, destructor: Callable[[Data], None]) -> None:
        super().__init__(pointer._type, pointer._address, pointer._keep)
        object.__setattr__(self, "_destructor", destructor)

    def _free(self) -> None:
        destructor = self._destructor
        object.__setattr__(self, "_destructor", None)
        if destructor is not None:
            destructor(self)

    def __del__(self) -> None:
        self._free()


# ---- values in memory ----


def _read(kind: Type, address: int, keep: Any) -> Any:
    if kind.kind == "primitive":
        return kind.memory.from_address(address).value
    if kind.kind == "pointer":
        return Data(kind, ctypes.c_size_t.from_address(address).value)
    return Data(kind, address, keep)


def _write(kind: Type, address: int, value: Any) -> None:
    if kind.kind in ("primitive", "pointer"):
        kind.memory.from_address(address).value = _passed(kind, value, [])
    elif kind.kind == "array":
        if len(value) > kind.length:
            raise IndexError(f"{len(value)} values for {kind.name}")
        for i, item in enumerate(value):
            _write(kind.item, address + i * kind.item.size, item)
    elif isinstance(value, Data):
        if value._type is not kind:
            raise TypeError(f"expected {kind.name}, not {value._type.name}")
        ctypes.memmove(address, value._address, kind.size)
    else:
        fields = list(kind.fields.values())
        if len(value) > len(fields):
            raise TypeError(f"{len(value)} values for {kind.name}")
        for field, item in zip(fields, value):
            _write(field.type, address + field.offset, item)


def _passed(kind: Type, value: Any, keep: list[Any]) -> Any:
    """A value as ctypes takes it; what `keep` receives must live until it has been used."""
    if kind.kind == "pointer":
        return _passed_pointer(kind, value, keep)
    if kind.memory is ctypes.c_double:
        if isinstance(value, (str, bytes)):
            raise TypeError(f"expected a number, not {value!r}")
        return float(value)
    if kind.memory is ctypes.c_char:
        if not isinstance(value, bytes) or len(value) != 1:
            raise TypeError(f"expected one byte, not {value!r}")
        return value
    if not hasattr(value, "__index__"):
        raise TypeError(f"expected a whole number, not {value!r}")
    number = value.__index__()
    if not kind.low <= number <= kind.high:
        raise OverflowError(f"{number} does not fit {kind.name}")
    return number


def _passed_pointer(kind: Type, value: Any, keep: list[Any]) -> Any:
    if isinstance(value, bytes) and kind.item.name in ("char", "void"):
        text = ctypes.c_char_p(value)
        keep.append(text)
        return ctypes.cast(text, ctypes.c_void_p).value
    if isinstance(value, Data) and value._type.kind in ("pointer", "array"):
        given, wanted = value._type.item, kind.item
        if given is wanted or "void" in (given.kind, wanted.kind):
            return value._address or None
        raise TypeError(f"expected {kind.name}, not {value._type.name}")
    raise TypeError(f"expected {kind.name}, not {value!r}")


def _block(size: int) -> Any:
    """Zeroed memory, aligned for any type."""
    return (ctypes.c_longdouble * (size // ctypes.sizeof(ctypes.c_longdouble) + 1))()



def _array(item: Type, length: int) -> Type:
    made = Type(f"{item.name}[{length}]", "array", item.size * length, item.alignment)
    made.item, made.length = item, length
    return made


# ---- what the package uses ----


class Interface:
    """Types by their names in C, and memory of them: `ffi` of this package."""

    def __init__(self, structs: Mapping[str, Any], function_types: Mapping[str, Any]) -> None:
        self._structs, self._function_types = structs, function_types
        self._types: dict[str, Type] = {}
        self.NULL = Data(self.typeof("void *"), 0)

    # ---- types ----

    def typeof(self, name: str | Data) -> Type:
        """The type of that name, or of a value."""
        if isinstance(name, Data):
            return name._type
        made = self._types.get(name)
        if made is None:
            made = self._types[name] = self._make_type(name)
            if made.kind == "struct":
                self._lay_out(made)
        return made

    def _make_type(self, name: str) -> Type:
        if name.endswith("*"):
            made = Type(name, "pointer", ctypes.sizeof(ctypes.c_void_p), ctypes.alignment(ctypes.c_void_p))
            made.item = self.typeof(name[:-1].rstrip())
            made.memory = ctypes.c_void_p
            return made
        array = re.fullmatch(r"([^[]*)\[(\d+)\](.*)", name)
        if array is not None:
            return _array(self.typeof(array[1] + array[3]), int(array[2]))
        if name in _PRIMITIVES:
            memory = _PRIMITIVES[name]
            made = Type(name, "primitive", ctypes.sizeof(memory), ctypes.alignment(memory))
            made.memory = memory
            if memory is ctypes.c_bool:
                made.high = 1
            elif memory not in (ctypes.c_double, ctypes.c_char):
                bits, signed = 8 * made.size, memory(-1).value < 0
                made.low, made.high = (-2**(bits - 1), 2**(bits - 1) - 1) if signed else (0, 2**bits - 1)
            return made
        if name in self._structs:
            return Type(name, "struct")
        if name in self._function_types:
            return Type(name, "function")
        if name == "void":
            return Type(name, "void")
        raise TypeError(f"there is no C type {name!r}")

    def _lay_out(self, made: Type) -> None:
        """Places the members of a struct as the ABI does."""
        for member, name in self._structs[made.name]:
            kind = self.typeof(name)
            made.size = -(-made.size // kind.alignment) * kind.alignment
            made.fields[member] = Field(kind, made.size)
            made.size += kind.size
            made.alignment = max(made.alignment, kind.alignment)
        made.size = -(-made.size // made.alignment) * made.alignment

    def sizeof(self, name: str) -> int:
        return self.typeof(name).size

    # ---- memory ----

    def new(self, name: str, value: Any = None) -> Data:
        """Zeroed memory: "T *" for one T, "T[]" for as many as `value` says or has, then filled."""
        if name.endswith("[]"):
            item = self.typeof(name[:-2].rstrip())
            terminated = isinstance(value, bytes)
            length = value if isinstance(value, int) else len(value) + terminated
            kind = _array(item, length)
            block = _block(kind.size)
            address = ctypes.addressof(block)
            if isinstance(value, bytes):
                ctypes.memmove(address, value, len(value))
            elif not isinstance(value, int):
                _write(kind, address, value)
            return Data(kind, address, block)
        kind = self.typeof(name)
        target = kind.item if kind.kind == "pointer" else kind
        if target.size == 0:
            raise TypeError(f"the size of {target.name} is not known")
        block = _block(target.size)
        if value is not None:
            _write(target, ctypes.addressof(block), value)
        return Data(kind, ctypes.addressof(block), block)

    def from_buffer(self, name: str | Any, buffer: Any = None) -> Data:
        """The memory of an object as an array of C, without a copy if it can be."""
        if buffer is None:
            name, buffer = "char[]", name
        seen = memoryview(buffer)
        if not seen.c_contiguous:
            raise ValueError("the memory is not contiguous")
        keep: Any = buffer
        if hasattr(buffer, "__array_interface__"):
            address = buffer.__array_interface__["data"][0]
        elif not seen.readonly:
            keep = (ctypes.c_char * seen.nbytes).from_buffer(seen)
            address = ctypes.addressof(keep)
        else:
            keep = ctypes.c_char_p(bytes(seen))  # no copy of an object that is bytes already
            address = ctypes.cast(keep, ctypes.c_void_p).value
        item = self.typeof(name.partition("[")[0].rstrip())
        kind = _array(item, seen.nbytes // item.size)
        if not name.endswith("[]") and self.typeof(name).size > seen.nbytes:
            raise ValueError(f"{seen.nbytes} bytes for {name}")
        return Data(kind, address, keep)

    def buffer(self, block: Data, size: int) -> Any:
        """Memory as an object with the buffer interface."""
        return (ctypes.c_char * size).from_address(block._address) if size > 0 else b""

    def memmove(self, to: Data, source: Any, size: int) -> None:
        """Copies bytes."""
        block = source if isinstance(source, Data) else self.from_buffer(source)
        ctypes.memmove(to._address, block._address, size)

    def string(self, pointer: Data) -> bytes:
        """A copy of a C string."""
        if not pointer:
            raise ValueError("a string that is NULL")
        return ctypes.string_at(pointer._address)

    def unpack(self, pointer: Data, count: int) -> list[Any]:
        """Copies of elements."""
        return list(pointer[0:count])

    def cast(self, name: str, value: Any) -> Any:
        """A pointer as another one or as a number, or a number modulo the range of another type."""
        kind = self.typeof(name)
        if kind.kind == "pointer":
            return Data(kind, value._address, value._keep)
        return kind.memory(value._address if isinstance(value, Data) else value).value

    def addressof(self, struct: Data, member: str) -> Data:
        """A pointer to a struct inside another one."""
        kind, address = struct._field(member)
        return Data(self.typeof(f"{kind.name} *"), address, struct._keep)

    def offsetof(self, name: str, member: str) -> int:
        return self.typeof(name).fields[member].offset

    # ---- owners and callbacks ----

    def gc(self, pointer: Data, destructor: Callable[[Data], None]) -> Data:
        """A pointer that calls `destructor` with itself when it is no longer used."""
        return Owned(pointer, destructor)

    def release(self, pointer: Data) -> None:
        """Calls the destructor now."""
        if isinstance(pointer, Owned):
            pointer._free()

    def new_handle(self, thing: Any) -> Data:
        """A `void *` that stands for an object, as long as it is kept."""
        return Data(self.typeof("void *"), id(thing), thing)

    def from_handle(self, pointer: Data) -> Any:
        return ctypes.cast(pointer._address, ctypes.py_object).value

    def callback(self, name: str) -> Callable[[Callable[..., Any]], Data]:
        """Makes a C function of a Python function; after an exception it returns 0."""
        result, parameters = ([self.typeof(word) for word in words] for words in (
            [self._function_types[name][0]], self._function_types[name][1]))

        def decorate(function: Callable[..., Any]) -> Data:
            def called(*values: Any) -> Any:
                return function(*(Data(kind, value or 0) if kind.kind == "pointer" else value
                                  for kind, value in zip(parameters, values)))

            made = ctypes.CFUNCTYPE(result[0].memory, *(kind.memory for kind in parameters))(called)
            return Data(self.typeof(f"{name} *"), ctypes.cast(made, ctypes.c_void_p).value or 0, made)

        return decorate


class Library:
    """Functions and constants of a shared library, by name."""

    def __init__(self, ffi: Interface, path: str, functions: Mapping[str, Any],
                 constants: Mapping[str, int]) -> None:
        self._ffi, self._functions = ffi, functions
        self._library = ctypes.CDLL(path)
        self.__dict__.update(constants)

    def __getattr__(self, name: str) -> Any:
        if name not in self._functions:
            raise AttributeError(f"the library has no {name}")
        function = self._bound(name)
        setattr(self, name, function)
        return function

    def _bound(self, name: str) -> Callable[..., Any]:
        result, *parameters = map(self._ffi.typeof, (self._functions[name][0], *self._functions[name][1]))
        function = self._library[name]
        function.restype, function.argtypes = result.memory, [kind.memory for kind in parameters]

        def call(*values: Any) -> Any:
            if len(values) != len(parameters):
                raise TypeError(f"{name} takes {len(parameters)} arguments, not {len(values)}")
            keep: list[Any] = []
            passed = [_passed(kind, value, keep) for kind, value in zip(parameters, values)]
            value = function(*passed)
            return Data(result, value or 0) if result.kind == "pointer" else value

        return call
