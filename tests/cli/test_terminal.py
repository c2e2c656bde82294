"""What a person sees: colours and bars on a terminal, and neither anywhere else."""
import os
import pty
import select
import time

import support
from support import OPEN, SLOWNESS

ESCAPE = b"\x1b["


class Terminal(support.Case):
    def on_terminal(self, *words, stream="stderr", status=(0,), **environment):
        """Runs with one stream on a terminal, to one of some exit statuses; what appeared there."""
        master, slave = pty.openpty()
        environment = {"TERM": "xterm", "NO_COLOR": "", **environment}
        seen = b""
        with self.start(*words, environment=environment, **{stream: slave}) as process:
            os.close(slave)
            limit = time.monotonic() + 60 * SLOWNESS
            while time.monotonic() < limit:
                if not select.select([master], [], [], 0.5)[0]:
                    continue
                try:
                    data = os.read(master, 65536)
                except OSError:  # the other end is closed
                    break
                if not data:
                    break
                seen += data
            process.communicate(timeout=10)
        os.close(master)
        self.assertIn(process.returncode, status, seen)
        return seen

    def test_colours(self):
        self.write("m.off", OPEN)
        words = ["guard", "m.off", "-o", "g.json"]
        self.assertIn(ESCAPE, self.on_terminal(*words, status=(2,)))
        self.assertNotIn(ESCAPE, self.on_terminal(*words, status=(2,), NO_COLOR="1"))
        self.assertNotIn(ESCAPE, self.on_terminal(*words, status=(2,), TERM="dumb"))
        self.assertNotIn(ESCAPE, self.run_bytes(*words, status=2)[1])
        self.assertIn(ESCAPE, self.on_terminal("--help", stream="stdout"))
        self.assertNotIn(ESCAPE, self.on_terminal("--help", stream="stdout", NO_COLOR="1"))
        self.assertNotIn(ESCAPE, self.run_bytes("--help")[0])

    def test_bar(self):
        model = self.sample("horse", 10000)
        slow = ["guard", model, "-o", "g.json", "--visibility", "sweep",
                "--time-limit", str(3 * SLOWNESS), "--threads", "1"]
        either = (0, 3)  # a busy machine may have nothing when the time is over
        seen = self.on_terminal(*slow, status=either)
        self.assertRegex(seen, rb"visibility +\[#* *\] +\d+ %  [0-9.e+-]+ %/s  \S+ \S+ left")
        last_bar = seen.rindex(b" left")
        self.assertIn(b"\r\x1b[K", seen[last_bar:], "the bar is taken away")
        self.assertNotIn(b" left", self.on_terminal(*slow, "--quiet", status=either))
        with self.start(*slow) as process:
            _, err = process.communicate(timeout=60 * SLOWNESS)
        self.assertIn(process.returncode, either, err)
        self.assertNotIn(b" left", err)

    def test_no_bar_for_short_stages(self):
        model = self.sample("l-room")
        began = time.monotonic()
        seen = self.on_terminal("guard", model, "-o", "g.json")
        if time.monotonic() - began >= 1:
            self.skipTest("on this machine the stages may not be short")
        self.assertNotIn(b" left", seen)


if __name__ == "__main__":
    support.main()
