# SPDX-License-Identifier: Apache-2.0
"""What a person sees: colours and bars on a terminal, and neither anywhere else."""
import os
import pty
import re
import select
import signal
import time

import support
from support import OPEN, processor_time

ESCAPE = b"\x1b["


class Terminal(support.Case):
    def on_terminal(self, *words, stream="stderr", status=0, until=None, **environment):
        """Runs with one stream on a terminal; what appeared there. The run is interrupted once until(seen,
        seconds of processor time) holds."""
        master, slave = pty.openpty()
        environment = {"TERM": "xterm", "NO_COLOR": "", **environment}
        seen = b""
        with self.start(*words, environment=environment, **{stream: slave}) as process:
            os.close(slave)
            while True:
                if until is not None and until(seen, processor_time(process.pid)):
                    process.send_signal(signal.SIGINT)
                    until = None
                if not select.select([master], [], [], 0.05)[0]:
                    continue
                try:
                    data = os.read(master, 65536)
                except OSError:  # the other end is closed
                    break
                if not data:
                    break
                seen += data
            process.communicate()
        os.close(master)
        self.assertEqual(process.returncode, status, seen)
        return seen

    def test_colours(self):
        self.write("m.off", OPEN)
        words = ["guard", "m.off", "-o", "g.json"]
        self.assertIn(ESCAPE, self.on_terminal(*words, status=2))
        self.assertNotIn(ESCAPE, self.on_terminal(*words, status=2, NO_COLOR="1"))
        self.assertNotIn(ESCAPE, self.on_terminal(*words, status=2, TERM="dumb"))
        self.assertNotIn(ESCAPE, self.run_bytes(*words, status=2)[1])
        self.assertIn(ESCAPE, self.on_terminal("--help", stream="stdout"))
        self.assertNotIn(ESCAPE, self.on_terminal("--help", stream="stdout", NO_COLOR="1"))
        self.assertNotIn(ESCAPE, self.run_bytes("--help")[0])

    def test_bar(self):
        """On a terminal; the longer runs would have shown it as well."""
        slow = ["guard", self.sample("horse", 30000), "-o", "g.json", "--visibility", "sweep", "--threads", "1"]
        bar = re.compile(rb"visibility +\[#* *\] +\d+ %  [0-9.e+-]+ %/s  \S+ \S+ left")
        shown = []

        def has_bar(seen, seconds):
            shown.append(seconds)
            return bar.search(seen)

        seen = self.on_terminal(*slow, status=130, until=has_bar)
        last_bar = seen.rindex(b" left")
        self.assertIn(b"\r\x1b[K", seen[last_bar:], "the bar is taken away")
        longer = shown[-1] + 1.5
        seen = self.on_terminal(*slow, "--quiet", status=130, until=lambda _, seconds: seconds >= longer)
        self.assertNotIn(b" left", seen)
        with self.start(*slow) as process:
            self.wait_for_work(process, longer)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate()
        self.assertEqual(process.returncode, 130, err)
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
