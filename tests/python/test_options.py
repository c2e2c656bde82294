# SPDX-License-Identifier: Apache-2.0
"""Keyword arguments are the rows of the library's field tables, by the names of the command line."""
import inspect
import json
import random
import warnings

import numpy as np

import starguard
from starguard import _library, catalogue, descriptors, guards, mesh, morphs, pieces, skeletons, tetra
from starguard import solidmaps, visibility
from support import Case, main

lib = _library.lib
ROOM = starguard.sample("l-room", vertices=500)
INSIDE = [[0.5, 0.5, 0.5]]

# Command of the command line, function, its options.
CALLS = [("guard", starguard.guard, guards._OPTIONS), ("visible", starguard.visible, visibility._OPTIONS),
         ("decompose", starguard.decompose, pieces.OPTIONS),
         (None, starguard.tetrahedralize, tetra._OPTIONS),
         ("skeleton", starguard.skeleton, skeletons._OPTIONS),
         ("repair", starguard.Mesh.repair, mesh._REPAIR), ("sample", starguard.sample, catalogue._OPTIONS),
         ("describe", starguard.describe, descriptors._OPTIONS),
         ("morph", starguard.Morph, morphs._OPTIONS),
         ("map", starguard.map_solid, solidmaps._OPTIONS)]


def random_value(field):
    """One that the table takes."""
    row = field._row
    if field.kind == lib.STARG_FIELD_FLAG:
        return random.random() < 0.5
    if field.kind == lib.STARG_FIELD_CHOICE:
        return random.choice(field.words)
    if field.kind == lib.STARG_FIELD_REAL:
        low = row.low + (1e-3 if row.flags & lib.STARG_FIELD_ABOVE else 0)
        return random.uniform(low, min(row.high, 1e6))
    if field.kind == lib.STARG_FIELD_TEXT:
        return random.choice(["a", "b/c"])
    if field.kind == lib.STARG_FIELD_NUMBERS:
        return tuple(random.uniform(max(row.low, -100), min(row.high, 100)) for _ in range(row.length))
    return random.randint(row.least, row.most)


def wrong_values(field):
    """What the table does not take."""
    row = field._row
    if field.kind == lib.STARG_FIELD_NUMBERS:
        yield from ([1.0] * (row.length + 1), [2e100] * row.length, 5, "1")
        return
    yield [1, 2]
    if field.kind == lib.STARG_FIELD_TEXT:
        return
    yield {lib.STARG_FIELD_FLAG: 2, lib.STARG_FIELD_CHOICE: "made up"}.get(field.kind, "1")
    if field.kind == lib.STARG_FIELD_COUNT:
        yield from (row.least - 1, 1.5, 2**64)
        if row.most < 2**64 - 1:
            yield row.most + 1
    if field.kind == lib.STARG_FIELD_REAL:
        yield from (row.low - 2, row.high * 2, np.nan, -np.inf)


class Tables(Case):
    def test_options_come_before_work(self):
        """Mistakes in options are told before the model is looked at, with the likely name or word."""
        class Untouchable:
            def __getattr__(self, name):
                raise AssertionError(f"the model was asked for {name} before the options were checked")
        for _, function, options in CALLS:
            if function is starguard.sample:
                continue
            needs = [Untouchable()] * (2 if function in (starguard.map_solid, starguard.Morph, starguard.visible) else 1)
            for field in options:
                wrong = field.name + "x"
                with self.assertRaises(TypeError) as caught:
                    function(*needs, **{wrong: 1})
                self.assertIn(f"unknown option {wrong!r}; did you mean ", str(caught.exception))
            for field in (field for field in options if field.words):
                with self.assertRaises(starguard.ArgumentError) as caught:
                    function(*needs, **{field.name: field.words[0] + "x"})
                self.assertIn("did you mean ", str(caught.exception))
        self.fails(starguard.ArgumentError, "did you mean 'medial'?", starguard.candidate_points, Untouchable(), "medail")
        self.fails(starguard.ArgumentError, "did you mean", starguard.signature, Untouchable(), "shape-dan")

    def test_what_is_set_is_read(self):
        random.seed(26)
        for _, function, options in CALLS:
            for _ in range(50):
                given = {field.name: random_value(field) for field in options if random.random() < 0.7}
                struct = options.make(given)
                read = options.read(struct.pointer)
                self.assertEqual({name: read[name] for name in given}, given, function)
                again = options.make(read)  # holds the texts
                self.assertEqual(options.read(again.pointer), read)

    def test_what_does_not_fit_is_refused(self):
        for _, _, options in CALLS:
            for field in options:
                for value in wrong_values(field):
                    with self.subTest(field=field.name, value=value):
                        self.fails(starguard.ArgumentError, f"the {field.name.replace('_', ' ')} is ",
                                   options.make, {field.name: value})

    def test_messages_are_those_of_the_library(self):
        self.fails(starguard.ArgumentError, "the redundancy is 0; it must be 1 to 1000",
                   starguard.guard, ROOM, redundancy=0)
        self.fails(starguard.ArgumentError, "the prune is 0; it must be 1 to 1e+06", starguard.skeleton,
                   ROOM, prune=0)

    def test_defaults_are_those_of_the_library(self):
        """None, and nothing, leave what the struct's default function sets."""
        for _, _, options in CALLS:
            struct = options.make({})
            plain = options.read(struct.pointer)
            struct = options.make(dict.fromkeys(plain))
            self.assertEqual(options.read(struct.pointer), plain)
        options = starguard.guard(ROOM).options
        self.assertEqual((options["count"], options["effort"]), (None, "normal"))

    def test_unknown_names(self):
        for _, _, options in CALLS:
            with self.assertRaisesRegex(TypeError, "max_gaurds"):
                options.make({"max_gaurds": 1})

    def test_numpy_values(self):
        options = starguard.guard(ROOM, count=np.int16(50), coverage=np.float32(0.5),
                                  refine=np.bool_(False)).options
        self.assertEqual((options["count"], options["coverage"], options["refine"]), (50, 0.5, False))

    def test_options_in_force_can_be_given_again(self):
        found = starguard.guard(ROOM, method="greedy", count=100, range=20, faces="whole")
        again = starguard.guard(ROOM, **found.options)
        self.assertEqual(again.options, found.options)
        self.assertTrue((again.positions == found.positions).all())


class Names(Case):
    def test_names_are_those_of_the_command_line(self):
        commands = {c["name"]: c for c in json.loads(self.cli("help", "--json"))["commands"]}
        for command, function, options in CALLS:
            if command is None:
                continue
            words = {option["name"] for option in commands[command]["options"]}
            for field in options:
                word = _library.text(field._row.option)
                if word:
                    self.assertIn(word, words)
                    self.assertEqual(field.name, word.removeprefix("no-").replace("-", "_"))

    def test_help_teaches(self):
        for _, function, options in CALLS:
            parameters = inspect.signature(function).parameters
            self.assertNotIn(inspect.Parameter.VAR_KEYWORD, {p.kind for p in parameters.values()})
            for field in options:
                self.assertIn(field.name, parameters, function)
                self.assertIn(f"`{field.name}`", function.__doc__)

    def test_no_text_points_to_a_header(self):
        for name in starguard.__all__:
            self.assertNotRegex(getattr(starguard, name).__doc__ or "", r"include/|\.h\b", name)


class OldNames(Case):
    def check(self, old, new, value, call):
        """The old name warns of the new one where it is used, and does the same."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            by_old, by_new = call(**{old: value}), call(**{new: value})
        said = [w for w in caught if issubclass(w.category, DeprecationWarning)]
        self.assertEqual([w.filename for w in said], [__file__])
        self.assertIn(f"{old}= is now called {new}=", str(said[0].message))
        self.assertEqual(repr(by_old), repr(by_new))
        with warnings.catch_warnings(), self.assertRaisesRegex(TypeError, "given twice"):
            warnings.simplefilter("ignore")
            call(**{old: value, new: value})

    def test_guard_candidate_count(self):
        self.check("candidate_count", "count", 50, lambda **o: starguard.guard(ROOM, **o))

    def test_guard_engine(self):
        self.check("engine", "visibility", "bvh",
                   lambda **o: starguard.guard(ROOM, method="greedy", count=20, **o))

    def test_guard_face_rule(self):
        self.check("face_rule", "faces", "whole",
                   lambda **o: starguard.guard(ROOM, method="greedy", count=20, **o))

    def test_visible_face_rule(self):
        self.check("face_rule", "faces", "whole", lambda **o: starguard.visible(ROOM, INSIDE, **o))

    def test_sample_vertex_count(self):
        self.check("vertex_count", "vertices", 600, lambda **o: starguard.sample("star", **o))

    def test_skeleton_node_count(self):
        self.check("node_count", "nodes", 30, lambda **o: starguard.skeleton(ROOM, **o))

    def test_repair_max_rounds(self):
        self.check("max_rounds", "rounds", 3, lambda **o: ROOM.repair(**o))

    def test_every_old_name_has_a_test(self):
        tested = {name[5:] for name in dir(self) if name.startswith("test_")}
        for _, function, options in CALLS:
            for old in options._old:
                self.assertIn(f"{function.__name__}_{old}", tested)

    def test_options_in_force(self):
        options = starguard.guard(ROOM, count=50).options
        with self.assertWarnsRegex(DeprecationWarning, "now called 'count'"):
            self.assertEqual(options["candidate_count"], 50)
        with self.assertRaises(KeyError):
            options["nothing"]


if __name__ == "__main__":
    main()
