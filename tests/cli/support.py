# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command line share: running it, scratch folders, small models."""
import json
import os
import resource
import signal
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ.get("STARGUARD", "build/starguard")
BUILD = os.environ.get("STARGUARD_BUILD", os.path.dirname(PROGRAM))  # has what is made while building
SHARED = os.environ.get("STARGUARD_SHARED", "../shared")
SANITIZE = os.environ.get("STARGUARD_SANITIZE")
LONG = bool(os.environ.get("STARGUARD_LONG"))  # all cases of what `make check` samples
# Limits on processor time grow with it: programs under a sanitizer, or that count lines, are several times
# slower. No test limits other time, which on a busy machine has no bound; ctest ends what hangs.
SLOWNESS = int(os.environ.get("STARGUARD_SLOWNESS", "1"))

COMMANDS = ["sample", "check", "repair", "skeleton", "visible", "kernel", "guard", "decompose",
            "describe", "match", "verify", "map", "morph", "completion"]

TETRAHEDRON = """OFF
4 4 6
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""

OPEN = """OFF
4 3 6
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
"""


def processor_time(process):
    """Seconds that the threads of a running process have worked; 0 when it has ended."""
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return 0


def processor_time_of_ended():
    """Seconds that all processes have worked that were waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Case(unittest.TestCase):
    """A test in a scratch folder of its own, which is the working directory of every run."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return name

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def names(self):
        return sorted(os.listdir(self.folder))

    def start(self, *words, launcher=(), **options):
        environment = dict(os.environ, **options.pop("environment", {}))
        return subprocess.Popen([*launcher, PROGRAM, *words], cwd=self.folder, env=environment,
                                stdin=options.pop("stdin", subprocess.DEVNULL),
                                stdout=options.pop("stdout", subprocess.PIPE),
                                stderr=options.pop("stderr", subprocess.PIPE), **options)

    def run_bytes(self, *words, status=0, input=None, **options):
        """Runs the program and checks its exit status, if one is given; what it wrote to both streams."""
        stdin = subprocess.DEVNULL if input is None else subprocess.PIPE
        with self.start(*words, stdin=options.pop("stdin", stdin), **options) as process:
            out, err = process.communicate(input)
        if status is not None:
            self.assertEqual(process.returncode, status, f"{words}: {out!r} {err!r}")
        return out or b"", err or b""

    def wait_for_work(self, process, seconds):
        """Until the process has had that much of a processor, and is still at work."""
        while processor_time(process.pid) < seconds:
            self.assertIsNone(process.poll(), "it ended before it was to be stopped")
            time.sleep(0.02)

    def wait_for_sleep(self, process):
        """Until the process handles signals and waits for something."""
        ready = False
        while not ready:
            self.assertIsNone(process.poll(), "it does not wait")
            with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
                fields = dict(line.split(":", 1) for line in file)
            caught = int(fields["SigCgt"], 16) >> (signal.SIGINT - 1) & 1
            ready = caught and fields["State"].split()[0] == "S"
            time.sleep(0.02)

    def run_text(self, *words, **options):
        out, err = self.run_bytes(*words, **options)
        return out.decode(), err.decode()

    def run_json(self, *words, **options):
        """Runs with --json: the one object on standard output."""
        out, _ = self.run_text(words[0], "--json", *words[1:], **options)
        value = json.loads(out)
        self.assertIsInstance(value, dict)
        return value

    def usage_error(self, *words, says):
        """A wrong command line: status 1, nothing on standard output, a hint on standard error."""
        before = self.names()
        out, err = self.run_text(*words, status=1)
        self.assertEqual(out, "")
        self.assertIn(says, err)
        self.assertIn("--help", err)
        self.assertEqual(self.names(), before)

    sampled = {}  # which are wanted again and again

    def sample(self, name="l-room", vertices=520, file=None, *more):
        """Of 520: spectra are taken of a surface of 2,000 at least, so one of 500 is subdivided twice."""
        file = file or f"{name}.off"
        wanted = (name, vertices, os.path.splitext(file)[1], *more)
        if wanted not in self.sampled:
            self.run_text("sample", name, "--vertices", str(vertices), "-o", file, "--quiet", *more)
            self.sampled[wanted] = self.read(file)
        return self.write(file, self.sampled[wanted])


def main():
    unittest.main(verbosity=2)
