# SPDX-License-Identifier: Apache-2.0
"""Translates the public headers for Python, so that the C declarations have one source.

    make_declarations.py INCLUDE_FOLDER OUTPUT.py

INCLUDE_FOLDER holds starguard/*.h. The output is a module of four tables that `starguard._c` reads:

    VERSION              "1.2.3"
    CONSTANTS            name of an enumerator: its value
    STRUCTS              name: ((member, type), ...); () where the headers only name the struct
    FUNCTION_TYPES       name of a typedef: (type of the result, (type of a parameter, ...))
    FUNCTIONS            name of a function: the same

A type is written as in C without `const`: "double", "starg_mesh *", "uint64_t[8]", "double[3] *" for a
pointer to arrays. A pointer to a function that has no name is "void *". The translator knows as much of C as the headers use and refuses the rest.
It needs nothing but Python.
"""
import os
import re
import sys

PRIMITIVES = {"void", "bool", "char", "int", "unsigned", "float", "double", "size_t", "int32_t", "int64_t",
              "uint8_t", "uint32_t", "uint64_t"}
TOKEN = re.compile(r"\s*([A-Za-z_]\w*|0[xX][0-9A-Fa-f]+|\d+|<<|.)", re.DOTALL)


# ---- the text of the headers ----


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)


def headers_in_order(folder, name, seen):
    """The names of a header and of all that it includes, each after what it needs."""
    if name in seen:
        return []
    seen.add(name)
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        included = re.findall(r'^#include "(\w+\.h)"', file.read(), flags=re.MULTILINE)
    order = []
    for other in included:
        order += headers_in_order(folder, other, seen)
    return order + [name]


def declarations(folder):
    """All declarations of the headers, without comments, macros and what is for C++ alone."""
    text = ""
    for name in headers_in_order(folder, "starguard.h", set()):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            header = without_comments(file.read())
        header = re.sub(r"^#ifdef __cplusplus$.*?^#endif$", "", header, flags=re.DOTALL | re.MULTILINE)
        header = re.sub(r"^#.*$", "", header, flags=re.MULTILINE)
        text += re.sub(r"\bSTARG_API\b", "", header)
    return re.sub(r"\n\s*\n+", "\n", text)


def functions(folder):
    """The names of all public functions, by their mark."""
    names = set()
    for name in headers_in_order(folder, "starguard.h", set()):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            header = without_comments(file.read())
        for declaration in re.findall(r"^STARG_API([^;]*);", header, flags=re.MULTILINE):
            names.add(re.search(r"\b(starg_\w+)\s*\(", declaration).group(1))
    return names


def version(folder):
    """The version that the headers name."""
    with open(os.path.join(folder, "version.h"), encoding="utf-8") as file:
        numbers = re.findall(r"^#define STARG_VERSION_[A-Z]+ (\d+)$", file.read(), flags=re.MULTILINE)
    return ".".join(numbers)


# ---- the translator ----


def decayed(kind):
    """The type of a parameter: an array is a pointer to its elements."""
    array = re.fullmatch(r"([^[]*)\[\d*\](.*)", kind)
    return (array[1] + array[2] + " *").replace("* *", "**") if array else kind


class Function:
    """A type of functions."""

    def __init__(self, result, parameters):
        self.signature = result, parameters


class Translator:
    """Reads declarations one after the other, by recursive descent."""

    def __init__(self, text):
        self.tokens = TOKEN.findall(text.strip()) + [""]
        self.at = 0
        self.enums, self.constants, self.structs = set(), {}, {}
        self.function_types, self.functions = {}, {}

    def refuse(self, expected):
        near = " ".join(self.tokens[max(self.at - 8, 0):self.at + 8])
        raise SystemExit(f"make_declarations.py: expected {expected} at {self.tokens[self.at]!r} in: {near}")

    def accept(self, token):
        if self.tokens[self.at] != token:
            return False
        self.at += 1
        return True

    def expect(self, token):
        if not self.accept(token):
            self.refuse(repr(token))

    def name(self):
        word = self.tokens[self.at]
        if not re.fullmatch(r"[A-Za-z_]\w*", word):
            self.refuse("a name")
        self.at += 1
        return word

    def number(self):
        """A constant, or a sum or shift of constants."""
        value = 0
        operator, sign = "+", 1
        while True:
            if self.accept("-"):
                sign = -sign
            word = self.tokens[self.at]
            self.at += 1
            if re.fullmatch(r"0[xX][0-9A-Fa-f]+|\d+", word):
                operand = sign * int(word, 0)
            elif word in self.constants:
                operand = sign * self.constants[word]
            else:
                self.at -= 1
                self.refuse("a number")
            value = value << operand if operator == "<<" else value + operand
            operator, sign = self.tokens[self.at], 1
            if operator not in ("+", "-", "<<"):
                return value
            self.at += 1
            if operator == "-":
                sign = -1

    def enumerators(self):
        value = -1
        self.expect("{")
        while not self.accept("}"):
            name = self.name()
            value = self.number() if self.accept("=") else value + 1
            self.constants[name] = value
            if not self.accept(","):
                self.expect("}")
                return

    def base(self):
        """A type without its stars."""
        while self.accept("const"):
            pass
        if self.accept("struct"):
            kind = self.name()
        else:
            kind = self.name()
            if kind == "unsigned":
                self.accept("int")
            if kind not in PRIMITIVES | self.enums | set(self.structs) | set(self.function_types):
                self.at -= 1
                self.refuse("a type")
        while self.accept("const"):
            pass
        return "unsigned" if kind in self.enums else kind

    def parameters(self):
        kinds = []
        if self.tokens[self.at] == "void" and self.tokens[self.at + 1] == ")":
            self.at += 1
        while not self.accept(")"):
            kind, _ = self.declarator(self.base())
            kinds.append(decayed(kind))
            if not self.accept(","):
                self.expect(")")
                break
        return tuple(kinds)

    def declarator(self, kind):
        """The type and name that stand after a base type; the name may be missing."""
        while self.accept("*"):
            while self.accept("const"):
                pass
            kind += "*" if kind.endswith("*") else " *"
        if self.accept("("):  # a pointer to a function
            self.expect("*")
            name = self.name()
            self.expect(")")
            self.expect("(")
            self.parameters()
            return "void *", name
        word = self.tokens[self.at]
        name = self.name() if re.fullmatch(r"[A-Za-z_]\w*", word) else None
        if self.accept("("):
            return Function(kind, self.parameters()), name
        while self.accept("["):
            kind += f"[{'' if self.tokens[self.at] == ']' else self.number()}]"
            self.expect("]")
        return kind, name

    def members(self):
        found = []
        self.expect("{")
        while not self.accept("}"):
            base = self.base()
            while True:
                kind, name = self.declarator(base)
                found.append((name, kind))
                if not self.accept(","):
                    break
            self.expect(";")
        return tuple(found)

    def definition(self):
        """A typedef."""
        if self.accept("enum"):
            if self.tokens[self.at] != "{":
                self.name()
            self.enumerators()
            self.enums.add(self.name())
        elif self.tokens[self.at] == "struct":
            self.at += 1
            tag = self.name()
            self.structs.setdefault(tag, ())
            if self.tokens[self.at] == "{":
                self.structs[tag] = self.members()
            if self.name() != tag:
                self.refuse("the name of the struct again")
        else:
            kind, name = self.declarator(self.base())
            if isinstance(kind, Function):
                self.function_types[name] = kind.signature
            elif kind == "unsigned":
                self.enums.add(name)
            else:
                self.refuse("a type of functions")
        self.expect(";")

    def read(self):
        while self.tokens[self.at]:
            if self.accept("typedef"):
                self.definition()
            elif self.accept("enum"):
                self.enumerators()
                self.expect(";")
            elif self.tokens[self.at] == "struct" and self.tokens[self.at + 2] == "{":
                self.at += 1
                name = self.name()
                self.structs[name] = self.members()
                self.expect(";")
            else:
                kind, name = self.declarator(self.base())
                if not isinstance(kind, Function):
                    self.refuse("a function")
                self.functions[name] = kind.signature
                self.expect(";")


def table(name, rows):
    return f"{name} = {{\n" + "".join(f"    {key!r}: {value!r},\n" for key, value in rows.items()) + "}\n"


def main(include, output):
    folder = os.path.join(include, "starguard")
    translator = Translator(declarations(folder))
    translator.read()
    if set(translator.functions) != functions(folder):
        raise SystemExit("make_declarations.py: these functions lack STARG_API or have not been read: "
                         + ", ".join(sorted(set(translator.functions) ^ functions(folder))))
    with open(output, "w", encoding="utf-8") as file:
        file.write('"""Made by make_declarations.py of the public headers."""\n'
                   f'VERSION = "{version(folder)}"\n'
                   + table("CONSTANTS", translator.constants) + table("STRUCTS", translator.structs)
                   + table("FUNCTION_TYPES", translator.function_types)
                   + table("FUNCTIONS", translator.functions))


if __name__ == "__main__":
    main(*sys.argv[1:])
