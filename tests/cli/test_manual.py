# SPDX-License-Identifier: Apache-2.0
"""Manual pages and completion: they tell of all that there is, and shells and man take them."""
import json
import re
import shutil
import subprocess

import support


class Manual(support.Case):
    def setUp(self):
        super().setUp()
        self.table = json.loads(self.run_text("help", "--json")[0])

    def need(self, program):
        if shutil.which(program) is None:
            print(f"skipped: {program} is not installed")
            self.skipTest(f"{program} is not installed")

    def page(self, *words):
        return self.run_text("help", "--man", *words)[0]

    def test_table(self):
        """The table has what the help has."""
        for command in self.table["commands"]:
            text = self.run_text("help", *command["name"].split(), "all")[0]
            self.assertTrue(text.startswith(f"Usage: starguard {command['name']} "))
            listed = set(re.findall(r"^  (?:-\w, )?--([\w-]+)", text, re.M))
            options = command["options"] + self.table["common_options"]
            self.assertEqual(listed, {option["name"] for option in options})
        names = {command["name"] for command in self.table["commands"]}
        self.assertLessEqual(set(support.COMMANDS), names)

    def test_pages(self):
        for command in self.table["commands"]:
            name = command["name"].replace(" ", "-")
            text = self.page(*command["name"].split())
            self.assertIn(f".TH STARGUARD\\-{name.upper()} 1".replace("DB-", "DB\\-"), text)
            for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "EXAMPLES", "EXIT STATUS", "SEE ALSO"]:
                self.assertIn(f"\n.SH {section}\n", text)
            for option in command["options"] + self.table["common_options"]:
                escaped = option["name"].replace("-", "\\-")
                self.assertIn(f"\\fB\\-\\-{escaped}\\fR", text)
        whole = self.page()
        for command in self.table["commands"]:
            if " " not in command["name"]:
                self.assertIn(f"\\fBstarguard\\-{command['name']}\\fR(1)", whole)

    def test_pages_are_clean(self):
        """man and mandoc report nothing (but that there is no date)."""
        self.need("man")
        for command in [None] + self.table["commands"]:
            words = command["name"].split() if command else []
            self.write("page.1", self.page(*words))
            run = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", self.path("page.1")],
                                 capture_output=True, text=True, check=True)
            self.assertEqual(run.stderr, "", words)
            self.assertIn("EXIT STATUS", run.stdout)
            if shutil.which("mandoc") is not None:
                run = subprocess.run(["mandoc", "-Tlint", "-W", "warning", self.path("page.1")],
                                     capture_output=True, text=True, check=False)
                left = [line for line in run.stdout.splitlines() if "missing date" not in line]
                self.assertEqual(left, [], words)

    def test_wrong_words(self):
        self.usage_error("help", "--man", "gaurd", says="did you mean 'guard'?")
        for words in [("help", "--json", "guard"), ("help", "--man", "guard", "x")]:
            self.assertEqual(self.run_text(*words, status=1)[0], "")
        for words in [("help", "--json"), ("help", "--man"), ("completion", "bash")]:
            with open("/dev/full", "wb") as full:
                self.run_text(*words, status=3, stdout=full)


class Completion(support.Case):
    def script(self, shell):
        self.write(f"script.{shell}", self.run_text("completion", shell)[0])
        return self.path(f"script.{shell}")

    def test_unknown_shell(self):
        self.usage_error("completion", "tcsh", says="bash, zsh and fish")

    def bash(self, *words):
        """What bash would offer for the last word."""
        text = ('source "$1"; shift; compopt() { :; }; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                '_starguard; printf "%s\\n" "${COMPREPLY[@]}"')
        run = subprocess.run(["bash", "-c", text, "bash", self.path("script.bash"), *words],
                             capture_output=True, text=True, check=True, cwd=self.folder)
        self.assertEqual(run.stderr, "")
        return run.stdout.split()

    def test_bash(self):
        self.script("bash")
        self.write("model.off", "")
        self.assertEqual(self.bash("starguard", "gu"), ["guard"])
        self.assertEqual(self.bash("starguard", "guard", "--met"), ["--method"])
        self.assertEqual(self.bash("starguard", "guard", "--method", "p"), ["pilp"])
        self.assertEqual(self.bash("starguard", "guard", "--candidates", "sk"), ["skeleton"])
        self.assertEqual(self.bash("starguard", "guard", "mo"), ["model.off"])
        self.assertEqual(self.bash("starguard", "guard", "--count", ""), [])
        self.assertEqual(self.bash("starguard", "check", "--seed", ""), [])
        self.assertEqual(self.bash("starguard", "sample", "ho"), ["horse"])
        self.assertEqual(self.bash("starguard", "db", "q"), ["query"])
        self.assertEqual(self.bash("starguard", "db", "query", "--dist"), ["--distance"])
        self.assertEqual(self.bash("starguard", "help", "dec"), ["decompose"])
        self.assertEqual(self.bash("starguard", "completion", "z"), ["zsh"])
        self.assertIn("--threads", self.bash("starguard", "morph", "-"))

    def test_bash_offers_every_option(self):
        self.script("bash")
        table = json.loads(self.run_text("help", "--json")[0])
        for command in table["commands"]:
            if command["group"]:
                continue
            offered = set(self.bash("starguard", *command["name"].split(), "-"))
            options = command["options"] + table["common_options"]
            expected = {f"--{option['name']}" for option in options}
            expected |= {f"-{option['letter']}" for option in options if "letter" in option}
            self.assertEqual(offered, expected, command["name"])

    def test_fish(self):
        script = self.script("fish")
        if shutil.which("fish") is None:
            self.skipTest("fish is not installed")
        def offer(line):
            run = subprocess.run(["fish", "-c", f"source {script}; complete -C '{line}'"],
                                 capture_output=True, text=True, check=True, cwd=self.folder,
                                 env={"HOME": self.folder, "PATH": "/usr/bin:/bin"})
            return [row.split("\t")[0] for row in run.stdout.splitlines()]
        self.assertEqual(offer("starguard gu"), ["guard"])
        self.assertEqual(offer("starguard guard --method p"), ["pilp"])
        self.assertEqual(offer("starguard db qu"), ["query"])
        self.assertNotIn("query", offer("starguard db add "))

    def test_zsh(self):
        script = self.script("zsh")
        if shutil.which("zsh") is None:
            self.skipTest("zsh is not installed")
        subprocess.run(["zsh", "-n", script], check=True)


if __name__ == "__main__":
    support.main()
