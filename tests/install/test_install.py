# SPDX-License-Identifier: Apache-2.0
"""Installs into a fresh prefix, moves that, and builds and runs the examples with what is there: by
find_package and by pkg-config, with the shared and with the static library."""
import glob
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = os.environ["STARGUARD_SOURCE"]
BUILD = os.environ["STARGUARD_BUILD"]
CMAKE = os.environ["CMAKE"]
CC = os.environ["CC"]
EXAMPLES = ["guards", "pieces", "visible", "match"]


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = cls.scratch.name
        first = os.path.join(cls.folder, "first")
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", first], check=True,
                       stdout=subprocess.DEVNULL)
        cls.prefix = os.path.join(cls.folder, "moved here")
        shutil.move(first, cls.prefix)
        pkgconfig, = glob.glob(f"{cls.prefix}/lib*/**/pkgconfig", recursive=True)
        cls.library = os.path.dirname(pkgconfig)
        cls.environment = dict(os.environ, PKG_CONFIG_PATH=pkgconfig)
        cls.program = os.path.join(cls.prefix, "bin", "starguard")
        cls.model = os.path.join(cls.folder, "room.off")
        cls.other = os.path.join(cls.folder, "torus.off")
        for name, file in [("l-room", cls.model), ("torus", cls.other)]:
            cls.run_command(cls.program, "sample", name, "--vertices", "500", "-o", file)

    @classmethod
    def run_command(cls, *words, **options):
        run = subprocess.run(words, capture_output=True, text=True, cwd=cls.folder,
                             env=options.pop("env", cls.environment), **options)
        if run.returncode != 0:
            raise AssertionError(f"{words}: status {run.returncode}\n{run.stdout}{run.stderr}")
        return run.stdout

    def try_examples(self, folder, **options):
        """Runs all four; each has to say what it found."""
        program = {name: os.path.join(folder, name) for name in EXAMPLES}
        result = os.path.join(self.folder, "guards.json")
        text = self.run_command(program["guards"], self.model, result, **options)
        count = int(re.match(r"(\d+) guards", text).group(1))
        self.assertEqual(text.count(" sees "), count)
        with open(result, encoding="utf-8") as file:
            self.assertEqual(len(json.load(file)["guards"]), count)
        self.run_command(self.program, "verify", self.model, result)
        text = self.run_command(program["pieces"], self.model, **options)
        pieces, stars = map(int, re.match(r"(\d+) pieces, (\d+) ", text).groups())
        self.assertEqual(pieces, stars)
        position = re.search(r"from (\S+) (\S+) (\S+):", text).groups()
        text = self.run_command(program["visible"], self.model, *position, **options)
        self.assertGreater(int(text.split()[0]), 0)
        text = self.run_command(program["match"], self.model, self.other, **options)
        self.assertTrue(all(float(line.split()[1]) > 0 for line in text.splitlines()), text)
        text = self.run_command(program["match"], self.model, self.model, **options)
        self.assertTrue(all(float(line.split()[1]) == 0 for line in text.splitlines()), text)
        bad = subprocess.run([program["guards"], __file__], capture_output=True, text=True,
                             env=options.get("env", self.environment), check=False)
        self.assertEqual(bad.returncode, 1)
        self.assertIn(os.path.basename(__file__), bad.stderr)

    def with_library(self):
        return dict(self.environment, LD_LIBRARY_PATH=self.library)

    def build_by_cmake(self, name, *options):
        build = os.path.join(self.folder, name)
        self.run_command(CMAKE, "-S", f"{SOURCE}/examples", "-B", build, f"-DCMAKE_C_COMPILER={CC}",
                         f"-DCMAKE_PREFIX_PATH={self.prefix}", *options)
        self.run_command(CMAKE, "--build", build)
        return build

    def test_find_package(self):
        self.try_examples(self.build_by_cmake("shared"))

    def test_find_package_static(self):
        build = self.build_by_cmake("static", "-DSTATIC=ON")
        needed = self.run_command("readelf", "-d", os.path.join(build, "guards"))
        self.assertNotIn("libstarguard", needed)
        self.try_examples(build)

    def test_find_package_versions(self):
        """Another minor version is refused before 1.0, another patch is not."""
        for version, fits in [("0.1", False), ("0.2.0", True), ("0.3", False), ("1.0", False)]:
            project = os.path.join(self.folder, f"version {version}")
            os.mkdir(project)
            with open(os.path.join(project, "CMakeLists.txt"), "w", encoding="utf-8") as file:
                file.write("cmake_minimum_required(VERSION 3.25)\nproject(p NONE)\n"
                           f"find_package(starguard {version} REQUIRED)\n")
            run = subprocess.run([CMAKE, "-S", project, "-B", project + "/b",
                                  f"-DCMAKE_PREFIX_PATH={self.prefix}"], capture_output=True,
                                 check=False)
            self.assertEqual(run.returncode == 0, fits, version)

    def test_pkg_config(self):
        examples = os.path.join(self.folder, "by make")
        shutil.copytree(f"{SOURCE}/examples", examples)
        self.run_command("make", "-C", examples, f"CC={CC}")
        self.try_examples(examples, env=self.with_library())

    def test_guards_alone(self):
        """A program that only guards loads neither a database nor an eigenvalue solver."""
        program = os.path.join(self.folder, "guards alone")
        flags = self.run_command("pkg-config", "--cflags", "--libs", "starguard").split()
        self.run_command(CC, f"{SOURCE}/examples/guards.c", "-o", program,
                         f"-I{self.prefix}/include", f"-L{self.library}", flags[-1])
        loaded = self.run_command("ldd", program, env=self.with_library())
        self.assertIn("libstarguard", loaded)
        self.assertNotRegex(loaded, "sqlite|libldl|libamd|starguard-shapes")

    def test_pkg_config_static(self):
        """--static names all that the static library needs, and without it nothing of that."""
        shared = self.run_command("pkg-config", "--libs", "starguard").split()
        self.assertEqual([word for word in shared if word.startswith("-l")], ["-lstarguard"])
        folder = os.path.join(self.folder, "by hand")
        os.mkdir(folder)
        archive = os.path.join(self.library, "libstarguard.a")
        for name in EXAMPLES:
            package = "starguard-shapes" if name == "match" else "starguard"
            flags = self.run_command("pkg-config", "--static", "--libs-only-l", package).split()
            flags = [flag for flag in flags if not flag.startswith("-lstarguard")]
            archives = [os.path.join(self.library, "libstarguard-shapes.a")] * (name == "match")
            self.run_command(CC, "-std=c11", f"-I{self.prefix}/include", f"{SOURCE}/examples/{name}.c",
                             "-o", f"{folder}/{name}", *archives, archive, *flags)
        self.try_examples(folder)

    def test_manual_and_completion(self):
        """They are where man and the shells look, and say what this program says."""
        share = os.path.join(self.prefix, "share")
        for file, words in [("man/man1/starguard.1", ["help", "--man"]),
                            ("man/man1/starguard-guard.1", ["help", "--man", "guard"]),
                            ("man/man1/starguard-db-add.1", ["help", "--man", "db", "add"]),
                            ("bash-completion/completions/starguard", ["completion", "bash"]),
                            ("zsh/site-functions/_starguard", ["completion", "zsh"]),
                            ("fish/vendor_completions.d/starguard.fish", ["completion", "fish"])]:
            with open(os.path.join(share, file), encoding="utf-8") as installed:
                self.assertEqual(installed.read(), self.run_command(self.program, *words), file)
        pages = set(os.listdir(os.path.join(share, "man", "man1")))
        table = json.loads(self.run_command(self.program, "help", "--json"))
        names = [command["name"].replace(" ", "-") for command in table["commands"]]
        self.assertEqual(pages, {f"starguard-{name}.1" for name in names} | {"starguard.1"})

    def test_made_documentation(self):
        """Pages and schemas that the build makes stand among the others."""
        docs = os.path.join(self.prefix, "share", "doc", "starguard", "docs")
        for page in ["README.md", "formats.md", "fields.md", "c-api.md"]:
            with open(os.path.join(docs, page), encoding="utf-8") as file:
                self.assertTrue(file.read().startswith("# "), page)
        for schema in ["common", "guards", "report-guard", "error"]:
            with open(os.path.join(docs, "schema", f"{schema}.schema.json"), encoding="utf-8") as file:
                self.assertEqual(json.load(file)["$id"], f"{schema}.schema.json")

    def test_version(self):
        version = self.run_command("pkg-config", "--modversion", "starguard").strip()
        self.assertEqual(self.run_command(self.program, "--version"), f"starguard {version}\n")

    def test_no_path_of_the_build(self):
        """Text files name neither the build nor the prefix."""
        for root, _, files in os.walk(self.prefix):
            for name in files:
                if name.endswith((".pc", ".cmake", ".h", ".md", ".json")):
                    with open(os.path.join(root, name), encoding="utf-8") as file:
                        text = file.read()
                    for path in [BUILD, SOURCE, os.path.join(self.folder, "first")]:
                        self.assertNotIn(path, text, name)

    def test_program_reads_cxx(self):
        """The headers serve C++ too."""
        source = os.path.join(self.folder, "p.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write("#include <starguard/starguard.h>\n#include <cstdio>\n"
                       "int main() { std::puts(starg_version()); }\n")
        self.run_command("g++", source, "-o", source + ".out", f"-I{self.prefix}/include",
                         f"-L{self.library}", "-lstarguard")
        self.assertRegex(self.run_command(source + ".out", env=self.with_library()), r"^\d+\.\d+")


if __name__ == "__main__":
    unittest.main(verbosity=2)
