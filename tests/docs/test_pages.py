# SPDX-License-Identifier: Apache-2.0
"""Every command of the documentation is run, page by page, and every link leads somewhere.

A block marked `sh` is run, all blocks of a page in one folder in their order (it holds models under the
names that the pages use, see fixtures.py). In a block marked `console`, lines that begin with "$ " are
run, and the lines below have to be among what comes out, in their order. `make check` runs blocks of `sh`
quickly: smaller models, shorter searches (see fixtures.py). A block that cannot be run here has a
comment <!-- not run: REASON --> before it."""
import csv
import glob
import os
import re
import shutil
import unittest

from fixtures import PROGRAM, SOURCE, Fixtures, quick

# Pages that the build makes stand among those of docs/ when they are installed.
BUILD = os.environ.get("STARGUARD_BUILD", os.path.dirname(PROGRAM))
HAS_IMPORT = os.path.exists(os.path.join(BUILD, "starguard-import"))  # needs libassimp-dev
MADE = {"docs/c-api.md", "docs/fields.md", "docs/python-api.md"}

MOST_WORDS = 50000  # in all pages of docs/ but those that are made

PAGES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "examples/README.md"] + sorted(
    os.path.relpath(path, SOURCE)
    for path in glob.glob(os.path.join(SOURCE, "docs", "**", "*.md"), recursive=True))

BLOCK = re.compile(r"^(?:<!-- not run: ([^\n]*?) -->\n)?```(\w*)\n(.*?)^```$", re.S | re.M)


def place(page):
    return os.path.join(BUILD if page in MADE else SOURCE, page)


def read(page):
    with open(place(page), encoding="utf-8") as file:
        return file.read()


def headings(page):
    """What links may name in a page."""
    found = []
    for title in re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", read(page), flags=re.S), re.M):
        name = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        again = sum(name == re.sub(r"-\d+$", "", other) for other in found)
        found.append(f"{name}-{again}" if again else name)
    return found


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fixtures = Fixtures()
        cls.addClassCleanup(cls.fixtures.close)

    def run_console(self, folder, text):
        for part in re.split(r"^\$ ", text, flags=re.M)[1:]:
            command, *expected = part.rstrip("\n").split("\n")
            output = self.fixtures.shell(folder, command + " 2>&1").split("\n")
            for line in expected:
                self.assertIn(line, output, command)
                output = output[output.index(line) + 1:]

    def run_page(self, page, blocks):
        if not HAS_IMPORT and any(re.search(r"^starguard (?!export)\w+ \S+\.glb", text, re.M) for _, _, text in blocks):
            print(f"skipped {page}: starguard-import is not built")
            self.skipTest("starguard-import is not built")
        folder = self.fixtures.use(page.replace("/", "_"))
        for reason, language, text in blocks:
            if re.search(r"[|$] jq ", text) and shutil.which("jq") is None:
                reason = "no jq"
            if reason:
                print(f"skipped in {page}, {reason}: {text.split(chr(10))[0]}")
            elif language == "sh":
                self.fixtures.shell(folder, quick(text))
            else:
                self.run_console(folder, text)

    def test_commands_are_marked(self):
        """What looks like commands is a block of commands."""
        for page in PAGES:
            for _, language, text in BLOCK.findall(read(page)):
                if language == "" and re.match(r"(\$ )?(starguard|make|cmake|gcc) ", text):
                    self.fail(f"{page}: mark as sh or console:\n{text}")

    def test_made_pages(self):
        """The build makes what links count on, and nothing of it is in the sources."""
        self.assertEqual(MADE, {f"docs/{name}" for name in os.listdir(os.path.join(BUILD, "docs"))
                                if name.endswith(".md")})
        for page in MADE:
            self.assertFalse(os.path.exists(os.path.join(SOURCE, page)), page)

    def test_links(self):
        for page in PAGES + sorted(MADE):
            folder = os.path.dirname(page)
            text = re.sub(r"```.*?```", "", read(page), flags=re.S)
            for target, heading in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", text):
                if target.startswith(("http://", "https://")):
                    continue
                path = os.path.normpath(os.path.join(folder, target)) if target else page
                self.assertTrue(os.path.exists(place(path)), f"{page}: {target}")
                if heading:
                    self.assertIn(heading, headings(path), f"{page}: {target}#{heading}")

    def test_names_exist(self):
        """Functions, files and tests that the pages speak of."""
        public = "".join(read(os.path.relpath(path, SOURCE))
                         for path in glob.glob(f"{SOURCE}/include/starguard/*.h"))
        for page in PAGES:
            text = read(page)
            for name in re.findall(r"`((?:starg|STARG)_\w+)`", text):
                self.assertRegex(public, rf"\b{name}\b", page)
            for path in re.findall(r"`((?:src|tests|cli|scripts|bench|include)/[\w/.-]+)`", text):
                self.assertTrue(os.path.exists(os.path.join(SOURCE, path)), f"{page}: {path}")
            for test in re.findall(r"`((?:unit|property)/test_\w+)`", text):
                self.assertTrue(os.path.exists(f"{SOURCE}/tests/{test}.c"), f"{page}: {test}")

    def test_tables(self):
        """Each row of a table of docs/benchmarks has its columns, and a page links to the table."""
        links = {os.path.normpath(os.path.join(os.path.dirname(page), target))
                 for page in PAGES for target in re.findall(r"\]\(([^)#\s]*\.csv)\)", read(page))}
        tables = sorted(glob.glob(os.path.join(SOURCE, "docs", "benchmarks", "*")))
        self.assertTrue(tables)
        for path in tables:
            self.assertIn(os.path.relpath(path, SOURCE), links)
            with open(path, encoding="utf-8", newline="") as file:
                head, *rows = csv.reader(file)
            self.assertTrue(rows and len(set(head)) == len(head) and all(head), path)
            self.assertEqual({len(row) for row in rows}, {len(head)}, path)

    def test_words(self):
        """The pages of docs/ stay short enough to be read."""
        words = {page: len(read(page).split()) for page in PAGES if page.startswith("docs/") and page not in MADE}
        longest = sorted(words, key=words.get, reverse=True)[:5]
        self.assertLessEqual(sum(words.values()), MOST_WORDS, "docs/ has too many words: shorten the pages that were "
                             "changed last, or the longest ones, "
                             + ", ".join(f"{page} ({words[page]})" for page in longest))

    def test_every_page_is_in_the_index(self):
        """docs/README.md names all pages beside it."""
        index = read("docs/README.md")
        for page in PAGES + sorted(MADE):
            if re.fullmatch(r"docs/(?!README)[^/]*\.md", page):
                self.assertIn(f"({os.path.basename(page)})", index)


def add_test(page, blocks):
    name = "test_" + re.sub(r"\W", "_", page)
    setattr(Pages, name, lambda self: self.run_page(page, blocks))


for one in PAGES:
    found = [block for block in BLOCK.findall(read(one)) if block[1] in ("sh", "console")]
    if found:
        add_test(one, found)

if __name__ == "__main__":
    unittest.main(verbosity=2)
