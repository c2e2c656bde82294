# SPDX-License-Identifier: Apache-2.0
"""The layer between ctypes and the package: what it refuses, what it keeps alive, and its declarations."""
import gc
import importlib.util
import os
import re
import sys
import unittest
import weakref

import numpy as np

import starguard
from starguard import _library
from support import SOURCE, Case, main

ffi, lib = _library.ffi, _library.lib
sys.path.insert(0, os.path.join(SOURCE, "python", "tools"))
import make_declarations  # noqa: E402


class Values(Case):
    def test_numbers_that_do_not_fit(self):
        options = ffi.new("starg_context_options *")
        for value, error in ((2**31, OverflowError), (-2**31 - 1, OverflowError), (1.5, TypeError),
                             ("1", TypeError), (None, TypeError)):
            with self.assertRaises(error, msg=value):
                options.threads = value
        options.threads = np.int64(7)
        self.assertEqual(options.threads, 7)
        with self.assertRaises(OverflowError):
            options.seed = -1
        options.seed = 2**64 - 1
        self.assertEqual(options.seed, 2**64 - 1)
        with self.assertRaises(AttributeError):
            options.treads = 1
        with self.assertRaises(AttributeError):
            _ = options.treads

    def test_arrays_have_ends(self):
        numbers = ffi.new("double[]", [1, 2, 3])
        self.assertEqual((list(numbers), numbers[2], len(numbers)), ([1, 2, 3], 3, 3))
        for index in (-1, 3):
            with self.assertRaises(IndexError):
                _ = numbers[index]
            with self.assertRaises(IndexError):
                numbers[index] = 0
        with self.assertRaises(IndexError):
            ffi.new("double[2]", [1, 2, 3])

    def test_nothing_is_read_through_null(self):
        for read in (lambda p: p[0], lambda p: p.threads, lambda p: ffi.string(p)):
            with self.assertRaises(ValueError):
                read(ffi.cast("starg_context_options *", ffi.NULL))

    def test_strings(self):
        word = ffi.new("char[]", b"word")
        self.assertEqual((len(word), ffi.string(word)), (5, b"word"))
        self.assertEqual(ffi.string(ffi.new("char *[]", [word])[0]), b"word")

    def test_buffers(self):
        array = np.arange(6.0)
        block = ffi.from_buffer("double[]", array)
        block[1] = 9
        self.assertEqual(array[1], 9)
        with self.assertRaises(ValueError):
            ffi.from_buffer("double[]", array[::2])
        with self.assertRaises(ValueError):
            ffi.from_buffer("double[7]", array)
        for data in (b"abc", bytearray(b"abc"), memoryview(b"abc")):
            self.assertEqual(bytes(ffi.buffer(ffi.from_buffer(data), 3)), b"abc")


class Calls(Case):
    def setUp(self):
        super().setUp()
        self.mesh = starguard.sample("l-room", vertices=500)

    def test_a_pointer_to_something_else(self):
        for wrong in (ffi.new("starg_context_options *"), ffi.new("double[]", 3), 5, None, "mesh", b"mesh"):
            with self.assertRaises(TypeError, msg=repr(wrong)):
                lib.starg_mesh_area(wrong)
        with self.assertRaises(TypeError):
            lib.starg_mesh_bounds(self.mesh._handle, ffi.new("int[]", 3),
                                  ffi.new("double[]", 3))
        self.assertGreater(lib.starg_mesh_area(self.mesh._handle), 0)

    def test_the_number_of_arguments(self):
        for arguments in ((), (self.mesh._handle, self.mesh._handle)):
            with self.assertRaises(TypeError):
                lib.starg_mesh_area(*arguments)

    def test_an_unknown_function(self):
        with self.assertRaises(AttributeError):
            _ = lib.starg_nothing

    def test_what_is_owned_is_freed_once(self):
        freed = []
        pointer = ffi.gc(ffi.new("int *"), freed.append)
        ffi.release(pointer)
        ffi.release(pointer)
        del pointer
        gc.collect()
        self.assertEqual(len(freed), 1)

    def test_memory_lives_as_long_as_what_points_to_it(self):
        array = np.arange(3.0)
        gone = weakref.ref(array)
        pointer = ffi.from_buffer("double[]", array)[1:3]
        del array
        gc.collect()
        self.assertEqual(list(pointer), [1, 2])
        self.assertIsNotNone(gone())
        del pointer
        self.assertIsNone(gone())


class Declarations(Case):
    @unittest.skipUnless(importlib.util.find_spec("cffi"), "cffi is not installed")
    def test_another_parser_reads_the_same(self):
        """cffi, with a parser of all of C, finds the same types of all functions, members, constants."""
        import cffi
        other = cffi.FFI()
        other.cdef(make_declarations.declarations(os.path.join(SOURCE, "include", "starguard")))
        def name(kind):
            if kind.kind == "enum":
                return "unsigned"
            text = kind.cname.replace("unsigned int", "unsigned").replace("_Bool", "bool")
            text = re.sub(r"(?<=\*) (?=\*)", "", re.sub(r"\bstruct ", "", text))
            text = re.sub(r"\(\*\)(\[\d+\])", r"\1 *", text)  # double(*)[3]
            return "void *" if "(*" in text and "starg_log_level" not in text else text

        declared = _library._declared
        functions = {word for word in declared.FUNCTIONS}
        self.assertGreater(len(functions), 200)
        library = make_declarations.functions(os.path.join(SOURCE, "include", "starguard"))
        self.assertEqual(functions, library)
        parsed = {key.split(" ", 1)[1]: value[0] for key, value in other._parser._declarations.items()
                  if key.startswith("function ")}
        for function, (result, parameters) in declared.FUNCTIONS.items():
            with other._lock:
                kind = other._get_cached_btype(parsed[function])
            self.assertEqual((name(kind.result), tuple(map(name, kind.args))), (result, parameters), function)
        for struct, members in declared.STRUCTS.items():
            kind = other.typeof(f"{struct} *").item
            found = [(member, field.offset) for member, field in kind.fields or ()]
            mine = ffi.typeof(struct)
            self.assertEqual([(member, mine.fields[member].offset) for member, _ in members], found, struct)
        kinds = [other.typeof(word) for word in other.list_types()[0] if word not in declared.FUNCTION_TYPES]
        constants = {key: value for kind in kinds if kind.kind == "enum"
                     for key, value in kind.relements.items()}
        self.assertGreater(len(constants), 100)
        for constant, value in constants.items():
            self.assertEqual(declared.CONSTANTS[constant], value, constant)

    def test_what_is_not_understood_is_refused(self):
        for text in ("int x;", "typedef float starg_t;", "union u { int a; };", "int f(long x);",
                     "typedef struct starg_a { int x : 3; } starg_a;"):
            with self.assertRaises(SystemExit, msg=text):
                make_declarations.Translator(text).read()


if __name__ == "__main__":
    main()
