# SPDX-License-Identifier: Apache-2.0
"""Help, version, and every way to get the command line wrong."""
import json
import re

import support
from support import COMMANDS, TETRAHEDRON


class Help(support.Case):
    def test_no_words(self):
        out, err = self.run_text(status=1)
        self.assertEqual(out, "")
        self.assertIn("Usage: starguard COMMAND", err)
        for command in COMMANDS:
            self.assertIn(command, err)

    def test_program(self):
        text, err = self.run_text("--help")
        self.assertEqual(err, "")
        for command in COMMANDS:
            self.assertIn(f"\n  {command} ", text)
        for word in ["Exit status", "--threads N", "--time-limit S", "--json", "--quiet"]:
            self.assertIn(word, text)
        for same in [("help",), ("-h",), ("help", "help")]:
            self.assertEqual(self.run_text(*same)[0], text)

    def test_commands(self):
        for command in COMMANDS:
            text, err = self.run_text(command, "--help", "all")
            self.assertEqual(err, "")
            self.assertTrue(text.startswith(f"Usage: starguard {command} "), text)
            examples = text.split("\nExamples\n")[1]
            self.assertGreaterEqual(examples.count(f"starguard {command} "), 2, command)
            self.assertIn("--seed N", text)
            self.assertEqual(self.run_text("help", command, "all")[0], text)
            self.assertEqual(self.run_text(command, "-h", "a", "all", "c")[0], text)
            self.assertLessEqual(max(map(len, text.splitlines())), 90, command)

    def test_groups(self):
        """A screen for most; each option is in one group, and all of them are all."""
        for command in ("guard", "decompose", "map", "morph", "visible"):
            short = self.run_text(command, "--help")[0]
            self.assertEqual(self.run_text("help", command)[0], short)
            self.assertEqual(self.run_text(command, "-h", "a", "b")[0], short)
            rows = short.splitlines()
            self.assertLessEqual(len(rows), 50, command)
            self.assertLessEqual(max(map(len, rows[1:])), 79, command)
            groups = re.search(r"--help all\|(.*)", short).group(1).split("|")
            name = r"^  (?:-\w, )?--([\w-]+)"
            parts = [set(re.findall(name, self.run_text(command, "--help", group)[0], re.M)) for group in groups]
            self.assertTrue(all(parts), command)
            everything, common = self.run_text(command, "--help", "all")[0].split("\nCommon options\n")
            options = re.findall(name, everything, re.M)
            self.assertEqual(sorted(options), sorted(option for part in parts for option in part), command)
            self.assertLess(set(re.findall(name, short, re.M)), set(options), command)
        self.assertIn("--resolution W,H", self.run_text("help", "guard", "cameras")[0])
        self.assertIn("takes one command", self.run_text("help", "guard", "kameras", status=1)[1])

    def test_contract(self):
        """The options that outside checks rely on."""
        contract = {
            "sample": ["-o", "--pose", "--vertices", "--list"],
            "check": ["--marks"],
            "repair": ["-o"],
            "visible": ["--from", "--box", "-o"],
            "guard": ["-o", "--method", "--candidates", "--count", "--visibility", "--target",
                      "--faces", "--coverage", "--max-guards", "--range", "--redundancy",
                      "--clearance"],
            "verify": [],
        }
        for command, options in contract.items():
            text = self.run_text("help", command, "all")[0]
            for option in options:
                self.assertRegex(text, rf"\n  ({option},? )|\n  -., {option} |\n  {option}\n")

    def test_version(self):
        for words in [("--version",), ("guard", "--version")]:
            self.assertRegex(self.run_text(*words)[0], r"^starguard \d+\.\d+\.\d+\n$")

    def test_full_device(self):
        for words in [("--help",), ("--version",), ("help", "guard")]:
            with open("/dev/full", "wb") as full:
                self.run_text(*words, status=3, stdout=full)


class Mistakes(support.Case):
    def setUp(self):
        super().setUp()
        self.write("m.off", TETRAHEDRON)

    def test_command(self):
        self.usage_error("gaurd", "m.off", says="did you mean 'guard'?")
        self.usage_error("chek", says="did you mean 'check'?")
        self.usage_error("help", "vrify", says="did you mean 'verify'?")
        self.usage_error("frobnicate", says="unknown command 'frobnicate'")
        self.usage_error("", says="unknown command ''")
        self.usage_error("--versoin", says="did you mean '--version'?")
        self.usage_error("--nonsense", says="unknown option '--nonsense'")
        self.usage_error("-x", says="unknown option '-x'")

    def test_options_before_the_command(self):
        _, err = self.run_text("--threads", "2", "check", "m.off", status=1)
        self.assertIn("options follow the command", err)

    def test_unknown_option(self):
        for command in COMMANDS:
            self.usage_error(command, "--nonsense", says="unknown option '--nonsense'")
            self.usage_error(command, "-Z", says="unknown option '-Z'")
            self.usage_error(command, "--thraeds", "2", says="did you mean '--threads'?")
        self.usage_error("guard", "m.off", "-o", "g.json", "--cuont=3", says="did you mean '--count'?")
        self.usage_error("check", "m.off", "--" + "x" * 5000, says="unknown option")

    def test_no_abbreviations(self):
        self.usage_error("check", "m.off", "--thread", "2", says="did you mean '--threads'?")
        self.usage_error("check", "m.off", "--js", says="unknown option '--js'")

    def test_missing_value(self):
        self.usage_error("guard", "m.off", "-o", says="-o needs a value")
        self.usage_error("guard", "m.off", "--count", says="--count needs a value")
        self.usage_error("guard", "m.off", "-o", "--quiet", says="-o needs a value")
        self.usage_error("guard", "m.off", "-o", "", says="-o takes a name")

    def test_options_given_twice(self):
        """Of every option of every command: values add up or the second is refused, none replaces another."""
        table = json.loads(self.run_text("help", "--json")[0])
        adding = set()
        for command in (c for c in table["commands"] if not c["group"]):
            for option in command["options"] + (table["common_options"] if command["name"] == "check" else []):
                if option["kind"] == "flag":
                    continue
                name = "--" + option["name"]
                for value in option.get("choices", ["1", "0.5", "10000", "1,2", "1,2,3", "1,2,3,4,5,6"]):
                    words = [f"{name}={value}"] * 2
                    _, err = self.run_text(*command["name"].split(), *words, "--nonsense", status=1)
                    if f"{name} takes" not in err:
                        break
                if f"{name} is given more than once" not in err:
                    adding.add((command["name"], option["name"]))
        self.assertEqual(adding, {("visible", "from"), ("visible", "box")} | {
            (command, option) for command in ("visible", "guard")
            for option in ("obstacles", "see", "ignore", "clear", "within", "without")
        } | {("guard", "over"), ("guard", "mount"), ("guard", "require")})
        self.usage_error("guard", "m.off", "-o", "a", "--output=b", says="more than once")
        self.usage_error("visible", "m.off", "--unseen", "--outside", "--from=2,2,2", "--from=3,3,3", says="one point")
        self.run_text("check", "m.off", "--quiet", "--quiet")

    def test_value_for_a_flag(self):
        self.usage_error("check", "m.off", "--quiet=yes", says="--quiet takes no value")

    def test_numbers(self):
        for word in ["", "x", "1x", "1.5", "-1", "+1", " 1", "0x10", "1e3", "2000",
                     "99999999999999999999999"]:
            self.usage_error("check", "m.off", f"--threads={word}", says="--threads takes")
        for word in ["", "x", "nan", "inf", "-1", "0", "1e999", "0x1p3", "1,5", "1 ", "2..3"]:
            self.usage_error("check", "m.off", f"--time-limit={word}", says="--time-limit takes")
        for word in ["0", "1.0001", "-0.5", "nan"]:
            self.usage_error("guard", "m.off", "-o", "g.json", f"--coverage={word}",
                             says="--coverage takes a number above 0 and at most 1")
        for option in ["--range=0", "--range=-1", "--clearance=-1", "--redundancy=0", "--count=0",
                       "--max-guards=-1", "--max-guards=0.5"]:
            self.usage_error("guard", "m.off", "-o", "g.json", option, says=option.split("=")[0])
        self.usage_error("sample", "horse", "-o", "h.off", "--vertices", "499", says="500")
        self.usage_error("sample", "horse", "-o", "h.off", "--pose", "77", says="pose")
        self.run_text("check", "m.off", "--seed", "18446744073709551615", "--threads", "0")
        self.usage_error("check", "m.off", "--seed", "18446744073709551616", says="--seed takes")

    def test_points(self):
        for word in ["1,2", "1,2,3,4", "1,2,", ",,", "1,2,x", "1, 2,3", "1;2;3", "1,2,nan", ""]:
            self.usage_error("visible", "m.off", f"--from={word}", says="--from takes a point")
        self.run_text("visible", "m.off", "--from", "-1,2e-1,+.3")
        for word in ["1,2,3", "1,2,3,4,5,6,7", "1,2,3,4,5,x"]:
            self.usage_error("visible", "m.off", f"--box={word}", says="--box takes a box")
        self.usage_error("visible", "m.off", "--box", "0,0,0,1,1,1", "--from", "0,0,0",
                         says="exclude each other")

    def test_choices(self):
        wrong = {
            "--method": ("pilq", "did you mean 'pilp'?"),
            "--visibility": ("gird", "did you mean 'grid'?"),
            "--target": ("edges", "faces, vertices or points"),
            "--faces": ("half", "vertices or whole"),
            "--candidates": ("medail", "did you mean 'medial'?"),
        }
        for option, (word, says) in wrong.items():
            self.usage_error("guard", "m.off", "-o", "g.json", option, word, says=says)
        self.usage_error("guard", "m.off", "-o", "g.json", "--candidates", "bones",
                         says="skeleton, medial, interior or a file")
        self.usage_error("visible", "m.off", "--from", "0,0,0", "--engine", "swep",
                         says="did you mean 'sweep'?")

    def test_operands(self):
        for command in ["check", "repair", "visible", "guard", "verify"]:
            self.usage_error(command, says="too few arguments")
        self.usage_error("verify", "m.off", says="too few arguments")
        self.usage_error("check", "m.off", "n.off", says="one argument too many: 'n.off'")
        self.usage_error("guard", "m.off", says="-o GUARDS.json")
        self.usage_error("repair", "m.off", says="-o FILE")
        self.usage_error("visible", "m.off", says="--from X,Y,Z")
        self.usage_error("sample", says="--list")
        self.usage_error("sample", "horse", says="-o FILE")
        self.usage_error("sample", "hors", "-o", "h.off", says="did you mean 'horse'?")
        self.usage_error("sample", "zzzzzz", "-o", "h.off", says="--list")

    def test_endings(self):
        self.usage_error("sample", "horse", "-o", "h.xyz", says=".off, .obj, .ply, .stl or .vtp")
        self.usage_error("repair", "m.off", "-o", "noextension", says=".off, .obj, .ply, .stl or .vtp")
        self.usage_error("check", "m.off", "--marks", "marks.png", says=".ply")
        self.usage_error("visible", "m.off", "--from", "0,0,0", "-o", "v.off", says=".ply")
        self.usage_error("guard", "m.off", "-o", "g.json", "--picture", "p.jpg", says=".png")
        self.usage_error("guard", "m.off", "-o", "g.json", "--marks", ".ply", says=".ply")

    def test_endings_of_others(self):
        """An output is never written under the extension of another kind: the message names what writes that."""
        for words, says in [("guard m.off -o x.glb", "starguard export RESULT"), ("guard m.off -o x.CSV", "--poses"),
                            ("guard m.off -o x.png", "--picture FILE.png"), ("guard m.off -o x.html", "starguard view"),
                            ("decompose m.off -o p.ply", "starguard export"), ("decompose m.off -o p.json", "--report"),
                            ("decompose m.off -o p.vtk --report r.off", "starguard repair"),
                            ("describe m.off -o d.vtk", "starguard decompose"), ("view g.json -o v.glb", "export"),
                            ("repair m.off -o r.vtu", "export"), ("map m.off m.off -o m.vtu", "--solid"),
                            ("map --solid m.off m.off -o m.json", "--solid"), ("db matrix d -o m.html", "view"),
                            ("morph m.off m.off --frames 2 -o m.glb", "--glb FILE.glb"),
                            ("guard m.off -o x.obj", "starguard export"),
                            ("view m.off -o v.png", "--picture FILE.png of"), ("sample cube -o c.png", "--picture")]:
            self.usage_error(*words.split(), says=says)
        self.run_text("guard", "m.off", "-o", "guards.txt")

    def test_two_results_on_standard_output(self):
        self.usage_error("guard", "m.off", "-o", "-", "--marks", "-", says="only one output")

    def test_words_after_the_dashes_are_operands(self):
        self.write("--quiet", TETRAHEDRON)
        self.assertIn("usable", self.run_text("check", "--", "--quiet")[0])

    def test_forms_of_a_value(self):
        for words in [["-o", "g"], ["-og"], ["--output", "g"], ["--output=g"]]:
            self.run_text("guard", "m.off", *words, "--count", "3")
            self.assertIn("g", self.names())
        self.assertEqual(self.names(), ["g", "m.off"])


if __name__ == "__main__":
    support.main()
