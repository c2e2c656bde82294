# SPDX-License-Identifier: Apache-2.0
"""Calls: progress, cancelling, Ctrl-C, time limits, threads, and the interpreter lock."""
import inspect
import logging
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np

import starguard
from support import FACES, SLOWNESS, VERTICES, Case, main


DOG = starguard.sample("dog", vertices=2000)


def long_work(**options):
    """Takes hours on any machine, and is asked to stop long before."""
    return starguard.decompose(DOG, effort=2**60, time_limit=10000, **options)


class Progress(Case):
    def test_stages_and_fractions(self):
        seen, threads = [], set()

        def note(stage, fraction):
            seen.append((stage, fraction))
            threads.add(threading.get_ident())

        starguard.guard(starguard.sample("dog", vertices=1000), progress=note)
        self.assertGreater(len({stage for stage, _ in seen}), 3)
        self.assertTrue(all(stage and 0 <= fraction <= 1 for stage, fraction in seen))
        self.assertEqual(threads, {threading.get_ident()})

    def test_false_cancels(self):
        begun = time.process_time()
        self.fails(starguard.CancelledError, "cancelled", long_work, progress=lambda *_: False)
        self.assertLess(time.process_time() - begun, 20 * SLOWNESS)

    def test_none_and_others_go_on(self):
        for answer in (None, True, 0, ""):
            room = starguard.guard(starguard.sample("l-room", vertices=500),
                                   progress=lambda *_, answer=answer: answer)
            self.assertEqual(len(room), 1)

    def test_what_it_raises_arrives(self):
        def fail(stage, fraction):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            long_work(progress=fail)
        outcome = []

        def elsewhere():
            try:
                long_work(progress=fail)
            except KeyError as error:
                outcome.append(error)

        thread = threading.Thread(target=elsewhere)
        thread.start()
        thread.join()
        self.assertEqual(len(outcome), 1)

    def test_it_may_call_the_library(self):
        inner = []
        starguard.guard(starguard.sample("l-room", vertices=500),
                        progress=lambda *_: inner.append(starguard.Mesh(VERTICES, FACES).volume))
        self.assertTrue(inner and all(abs(volume - 1 / 6) < 1e-12 for volume in inner))


class Interruption(Case):
    def interrupt(self, function, after=0.5):
        """Calls a function, and sends Ctrl-C meanwhile; processor time from then on."""
        sent = []

        def send():
            sent.append(time.process_time())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(after, send)
        timer.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                function()
        finally:
            timer.cancel()
            timer.join()
        return time.process_time() - sent[0]

    def test_ctrl_c(self):
        self.assertLess(self.interrupt(long_work), 10 * SLOWNESS)
        self.assertEqual(len(starguard.guard((VERTICES, FACES))), 1)

    def test_enough(self):
        """A search ends with its best result once the callback says so."""
        model = starguard.sample("horse", vertices=5000)
        guards = starguard.guard(model, effort="best", progress=lambda stage, _: "enough" if stage == "search" else None)
        self.assertTrue(guards.time_limited)
        self.assertEqual(guards.step_guards[0], len(guards))
        self.assertFalse(starguard.guard(model, effort=1000).time_limited)

    def test_ctrl_c_with_progress(self):
        seen = []
        taken = self.interrupt(lambda: long_work(progress=lambda *report: seen.append(report)))
        self.assertLess(taken, 10 * SLOWNESS)
        self.assertTrue(seen)

    def test_a_signal_that_does_not_end_the_wait(self):
        """Another thread gets it, as it may; else it is rare: one that comes just before the wait."""
        def shielded():
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            try:
                long_work()
            finally:
                signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

        self.assertLess(self.interrupt(shielded), 5 * SLOWNESS)

    def test_objects_with_a_context_of_their_own_go_on(self):
        mesh = starguard.sample("dog", vertices=1000)
        for i in range(12):
            mesh.__class__(mesh.vertices + i, mesh.faces).write(f"{i}.off")
        with starguard.Database.create("shapes.db") as shapes:
            self.interrupt(lambda: shapes.add([f"{i}.off" for i in range(12)]))
            before = len(shapes.models())
            starguard.Mesh(VERTICES, FACES).write("t.off")
            self.assertEqual(shapes.add(["t.off"])[0].outcome, "added")
            self.assertEqual(len(shapes.models()), before + 1)

    def test_handlers_of_the_program(self):
        """A handler that does not raise runs at once, and the call goes on."""
        timers = []

        def send_soon():
            timers.append(threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)))
            timers[-1].start()

        def hear(*_):
            if len(timers) == 2:
                raise KeyboardInterrupt
            send_soon()

        before = signal.signal(signal.SIGINT, hear)
        try:
            send_soon()
            with self.assertRaises(KeyboardInterrupt): # of the second signal: the first has ended nothing
                long_work()
        finally:
            for timer in timers:
                timer.join()
            signal.signal(signal.SIGINT, before)
        self.assertEqual(len(timers), 2)

    def test_a_script_ends_as_scripts_do(self):
        script = ("import starguard, sys\nprint('go', flush=True)\n"
                  "starguard.decompose(starguard.sample('dog', vertices=2000), time_limit=100)\n")
        with subprocess.Popen([sys.executable, "-B", "-c", script], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            process.stdout.readline()
            time.sleep(1) # it is at work, or will be soon: either ends so
            process.send_signal(signal.SIGINT)
            _, error = process.communicate()
        self.assertIn(b"KeyboardInterrupt", error)
        self.assertEqual(process.returncode, -signal.SIGINT)


class Threads(Case):
    def test_two_calls_at_once_give_the_same(self):
        models = [starguard.sample("gallery", vertices=n) for n in (500, 600)]
        alone = [starguard.guard(model, threads=1).positions.tolist() for model in models]
        together = [None, None]

        def work(i):
            for _ in range(2):
                together[i] = starguard.guard(models[i], threads=1).positions.tolist()

        threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(together, alone)

    def test_one_model_for_many_threads(self):
        solid = starguard.Solid(starguard.sample("gallery", vertices=1000))
        points = starguard.candidate_points(solid, "interior", 40)
        wanted = np.asarray(starguard.visible(solid, points))
        morph = starguard.Morph((VERTICES, FACES), [[2 * x for x in row] for row in VERTICES],
                                method="linear")
        outcomes = []

        def work():
            for t in np.linspace(0, 1, 10):
                same = (np.asarray(starguard.visible(solid, points, threads=2)) == wanted).all()
                outcomes.append(bool(same) and abs(morph.positions(t)[1, 0] - (1 + t)) < 1e-12)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(outcomes, [True] * 40)

    def test_the_interpreter_goes_on_meanwhile(self):
        counts, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counts[0] += 1
                time.sleep(0.001)

        def off_the_main_thread():
            limit = 1
            while counts[0] <= 50 and limit <= 64:
                starguard.decompose(starguard.sample("dog", vertices=1000), effort=2**60,
                                    time_limit=limit, threads=1)
                limit *= 2

        counter, worker = threading.Thread(target=count), threading.Thread(target=off_the_main_thread)
        counter.start()
        worker.start()
        worker.join()
        stop.set()
        counter.join()
        self.assertGreater(counts[0], 50)

    def test_seed_and_thread_count(self):
        model = starguard.sample("gallery", vertices=500)
        files = []
        for threads in (1, 2, 3):
            starguard.guard(model, threads=threads, seed=5).write("g.json")
            files.append(self.read("g.json"))
        self.assertEqual(len(set(files)), 1)
        before = starguard.defaults.seed, starguard.defaults.threads
        try:
            starguard.defaults.seed, starguard.defaults.threads = 5, 1
            starguard.guard(model).write("g.json")
        finally:
            starguard.defaults.seed, starguard.defaults.threads = before
        self.assertEqual(self.read("g.json"), files[0])


class Log(Case):
    def test_notices_go_to_the_logger(self):
        inward = starguard.Mesh(VERTICES, [face[::-1] for face in FACES])
        with self.assertLogs("starguard", logging.INFO) as caught:
            self.assertGreater(starguard.Solid(inward).mesh.volume, 0)
        self.assertEqual(caught.records[0].levelno, logging.INFO)
        with self.assertLogs("starguard", logging.INFO) as caught:
            starguard.decompose((VERTICES, FACES[:3]), effort=30, fill=True)
        self.assertIn("stuffing", caught.output[0])


class Time(Case):
    def test_no_clock_unless_asked_for(self):
        for call in (starguard.decompose, starguard.guard, starguard.tetrahedralize):
            self.assertIsNone(inspect.signature(call).parameters["time_limit"].default)

    def test_a_limit_that_strikes_is_told(self):
        model = starguard.sample("dog", vertices=2000)
        limit, pieces = 1, None
        while pieces is None:
            begun = time.process_time()
            try:
                pieces = starguard.decompose(model, effort=2**60, time_limit=limit, threads=1)
            except starguard.TimeLimitError: # no start by then
                pass
            self.assertLess(time.process_time() - begun, (limit + 20) * SLOWNESS)
            limit *= 2
        self.assertTrue(pieces.time_limited)
        self.assertEqual(pieces.strictly_star, len(pieces))


if __name__ == "__main__":
    main()
