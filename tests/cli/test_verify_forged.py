# SPDX-License-Identifier: Apache-2.0
"""verify refuses forged results, passes genuine ones, and says what it does not check."""
import json
import random

import support

# What is asked of guard, one line a question.
QUESTIONS = ["", "--method ilp", "--method greedy", "--no-refine", "--coverage 0.9",
             "--coverage 0.5 --method ilp", "--max-guards 3", "--max-guards 4 --redundancy 2",
             "--redundancy 2", "--redundancy 2 --method greedy", "--range 0.6",
             "--range 0.5 --clearance 0.03 --method greedy", "--cone 120 --method greedy --count 50",
             "--target vertices", "--target vertices --redundancy 2", "--faces whole",
             "--candidates interior --count 50 --method ilp", "--candidates places.txt"]
MODELS = ["l-room", "star"]  # in this order: --range 0.6 takes long in the room, of which check asks other questions
BOX = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3),
       (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
# The candidates that are given: most are in none of the models, and left out.
PLACES = "".join(f"{x / 4} {y / 4} {z / 4}\n" for x in range(-4, 9) for y in range(-4, 9)
                 for z in range(-4, 9))


class Forged(support.Case):
    def setUp(self):
        super().setUp()
        self.sample("octopus", 500, "m.off")

    def guard(self, *words, model="m.off"):
        fewer = [] if {"--count", "--candidates"} & set(words) else ["--count", "100"]
        self.run_text("guard", model, "-o", "g.json", *fewer, *words)
        return json.loads(self.read("g.json"))

    def honest(self, result, *guards, model="m.off"):
        """The result with these of its guards alone: what they see told by verify's own claims."""
        chosen = [result["guards"][i] for i in guards]
        self.write("places.txt", "".join("{} {} {}\n".format(*g["position"]) for g in chosen))
        seen = self.guard("--method", "ilp", "--candidates", "places.txt", model=model)
        self.assertEqual(len(seen["guards"]), len(chosen))
        seen["options"] = dict(result["options"])
        seen["candidates"] = result["candidates"]
        return seen

    def refused(self, result, *texts, model="m.off"):
        """Each text is of a claim that fails; no other claim does."""
        self.write("forged.json", json.dumps(result))
        out, _ = self.run_text("verify", model, "forged.json", status=4)
        self.assertNotIn("ok  ", out)
        failed = [line for line in out.splitlines() if "FAILED" in line]
        for line in failed:
            self.assertTrue(any(text in line for text in texts), line)
        for text in texts:
            self.assertTrue(any(text in line for line in failed), f"{text!r} is in none of {failed}")

    # ---- guards ----

    def test_coverable_faces_that_are_only_those_seen(self):
        result = self.guard("--method", "ilp")
        forged = self.honest(result, 0)
        forged.update(lower_bound=1, optimal=True)
        self.assertLess(forged["coverage"]["area"], 0.9)
        for options in [{}, {"clearance": 0.001}]:
            forged["options"].update(options)
            self.refused(forged, "can be seen: more can")
        # nothing is known of candidates that were given
        forged["options"]["candidates"] = "given"
        self.write("given.json", json.dumps(forged))
        out, _ = self.run_text("verify", "m.off", "given.json", "--verbose")
        self.assertIn("cannot be seen: the candidates were given", out)

    def test_duplicates_of_guards(self):
        result = self.guard("--method", "ilp")
        forged = json.loads(json.dumps(result))
        forged["guards"] += forged["guards"]
        forged["coverage"]["curve"] += [forged["coverage"]["curve"][-1]] * len(result["guards"])
        forged.update(lower_bound=len(forged["guards"]), optimal=True)
        self.refused(forged, "the lower bound")

    def test_needless_guard(self):
        result = self.guard("--method", "ilp")
        count = len(result["guards"])
        more = json.loads(json.dumps(result["guards"][0]))
        more["position"][0] += 1e-7
        self.write("places.txt", "".join("{} {} {}\n".format(*g["position"])
                                         for g in result["guards"] + [more]))
        seen = self.guard("--method", "greedy", "--candidates", "places.txt", "--redundancy", "2")
        self.assertEqual(len(seen["guards"]), count + 1)
        seen["options"].update(candidates=result["options"]["candidates"], redundancy=1)
        seen.update(lower_bound=count + 1, optimal=True, candidates=result["candidates"])
        self.refused(seen, "the lower bound")

    def test_certificates_of_points(self):
        self.run_text("sample", "horse", "--vertices", "500", "-o", "h.off")
        less = ["--effort", "quick", "--prove-work", "100000"] if support.LONG else ["--no-refine", "--prove-work", "20000"]
        prove = [*less, "--count", "60", "--prove", "--certificate"]
        self.guard(*prove, "faces.txt", model="h.off")
        faces = self.read("g.json")
        bound = self.guard("--target", "points", *prove, "points.txt", model="h.off")["lower_bound_everywhere"]
        out, _ = self.run_text("verify", "h.off", "g.json", "points.txt", "--verbose")
        self.assertIn(f"at least {bound} guards are needed to see every point of the boundary, wherever they stand", out)
        out, _ = self.run_text("verify", "h.off", "g.json", "faces.txt", status=4)
        self.assertRegex(out, "FAILED .*its targets are others")
        self.write("f.json", faces)
        out, _ = self.run_text("verify", "h.off", "f.json", "points.txt", status=4)
        self.assertRegex(out, "FAILED .*its targets are others")
        text = self.read("points.txt").decode()
        head, tail = text.split("\nwitnesses ")
        count, first, rest = tail.split("\n", 2)
        for point, status in [(first + "9", 2), (first.split()[0] + " 1 1 1 1", 2), ("0 1 0 0", 2)]:
            self.write("forged.txt", f"{head}\nwitnesses {count}\n{point}\n{rest}")
            self.run_text("verify", "h.off", "g.json", "forged.txt", status=status)
        self.write("forged.txt", text.replace(f"\nbound {bound}\n", f"\nbound {bound + 1}\n"))
        out, _ = self.run_text("verify", "h.off", "g.json", "forged.txt", status=4)
        self.assertRegex(out, "FAILED .*does not follow")

    def test_more_guards_than_the_part_needs(self):
        forged = self.guard("--method", "ilp")
        one = next(i for i, point in enumerate(forged["coverage"]["curve"], 1) if point[1] > 0.3)
        forged["options"]["coverage"] = 0.3
        self.assertLess(one, len(forged["guards"]))
        forged.update(lower_bound=len(forged["guards"]), optimal=True)
        self.refused(forged, "the lower bound")

    def test_redundancy_of_a_single_cover(self):
        forged = self.guard("--method", "ilp", "--no-refine")
        forged["options"]["redundancy"] = 2
        self.refused(forged, "what fewer than 2 guards see")
        forged = self.guard("--no-refine", "--within", "-1,-1,0,1,1,1", "--clearance", "0.01", "--count", "60")
        forged["options"]["redundancy"] = 2
        self.refused(forged, "what fewer than 2 guards see")

    def test_fewer_candidates_than_guards(self):
        forged = self.guard()
        forged["candidates"] = len(forged["guards"]) - 1
        self.refused(forged, "candidates")

    def test_levels(self):
        result = self.guard("--no-refine", "--coarsest", "100", "--step", "200")
        self.assertGreater(len(result["levels"]), 2)
        self.run_text("verify", "m.off", "g.json")
        last = len(result["levels"]) - 1

        def beyond(r):
            r["guards"][0]["level"] = last + 1

        def elsewhere(r):
            r["levels"][last]["guards"][0][0] += 1e-9

        def larger(r):
            r["levels"][last]["vertices"] += 1

        def keep(r):
            r["levels"][0]["kept"] = 1

        for forge in [beyond, elsewhere, larger, keep]:
            forged = json.loads(json.dumps(result))
            forge(forged)
            self.refused(forged, "levels grow")
        forged = json.loads(json.dumps(result))
        forged["levels"][0]["guards"].append([9, 9, 9])
        self.refused(forged, "the guards of levels are strictly inside")

    def test_curve(self):
        forged = self.guard()
        forged["coverage"]["curve"][0][1] += 1e-6
        self.refused(forged, "the curve")

    # ---- pieces ----

    def decompose(self, *words, model="m.off"):
        self.run_text("decompose", model, "-o", "p.vtk", "--report", "p.json", "--effort", "100", *words)
        return json.loads(self.read("p.json"))

    def refused_pieces(self, report, text, model="m.off"):
        self.write("forged.json", json.dumps(report))
        out, _ = self.run_text("verify", model, "p.vtk", "forged.json", status=4)
        self.assertTrue(any(text in line for line in out.splitlines() if "FAILED" in line), out)

    def test_radius_and_flattest(self):
        report = self.decompose()
        self.run_text("verify", "m.off", "p.vtk", "p.json")
        for change in [1 + 1e-6, 0.5, -1]:
            forged = json.loads(json.dumps(report))
            max(forged["pieces"], key=lambda piece: piece["radius"])["radius"] *= change
            self.refused_pieces(forged, "as far from the planes")
        for change in [1 + 1e-6, 2]:
            forged = json.loads(json.dumps(report))
            forged["flattest"] *= change
            self.refused_pieces(forged, "the flattest tetrahedron")

    def test_angles_and_margins(self):
        report = self.decompose()
        self.assertLessEqual(report["smallest_angle"], report["smallest_angle_made"])
        for key, text in [("smallest_angle", "the smallest dihedral angle is"),
                          ("median_angle", "the median of the smallest"),
                          ("smallest_angle_made", "faces of the model do not force")]:
            for change in [1 + 1e-4, 0.5, 2]:
                forged = dict(report)
                forged[key] = report[key] * change
                self.refused_pieces(forged, text)
        forged = json.loads(json.dumps(report))
        forged["pieces"][0]["margin"] *= 1 + 1e-6
        self.refused_pieces(forged, "margins are radii")

    def test_bound_for_pieces(self):
        self.run_text("sample", "gallery", "--vertices", "500", "-o", "maze.off")
        prove = ["--prove", "--prove-work", "20000"]
        self.decompose(*prove, model="maze.off")
        plain = self.read("p.json")
        report = self.decompose(*prove, "--certificate", "why.txt", model="maze.off")
        self.assertEqual(self.read("p.json"), plain)
        self.assertTrue(self.read("why.txt").startswith(b"starguard-certificate 2\n"))
        self.assertIn(b"\ntarget corners\n", self.read("why.txt"))
        bound, pieces = report["lower_bound"], len(report["pieces"])
        self.assertLessEqual(bound, pieces)
        self.assertEqual(report["optimal"], bound == pieces)
        out, _ = self.run_text("verify", "maze.off", "p.vtk", "p.json", "--verbose")
        self.assertRegex(out, f"not checked: that no fewer than {bound} star-shaped pieces")
        for order in [["p.json", "p.vtk"], ["p.vtk", "p.json"]]:
            told = self.run_json("verify", "maze.off", *order, "why.txt")["results"]
            self.assertEqual([(r["certificate"], r["passed"]) for r in told], [("why.txt", True)])
            self.assertTrue(any("no fewer than" in c["claim"] for c in told[0]["claims"]))
        for change in [{"lower_bound": bound + 1, "optimal": bound + 1 == pieces},
                       {"optimal": not report["optimal"]},
                       {"lower_bound": pieces + 1, "optimal": False}]:
            self.write("forged.json", json.dumps({**report, **change}))
            out, _ = self.run_text("verify", "maze.off", "p.vtk", "forged.json", "why.txt", status=4)
            self.assertRegex(out, "FAILED (no fewer than|the lower bound is)")
        # a certificate of another model, of guards, and damaged ones
        self.write("t.off", support.TETRAHEDRON)
        self.run_text("decompose", "t.off", "-o", "o.vtk", "--effort", "10", *prove, "--certificate", "other.txt")
        self.run_text("guard", "maze.off", "-o", "g.json", "--count", "60", *prove, "--certificate", "guards.txt")
        for name, text in [("other.txt", "another model"), ("guards.txt", "not about corners")]:
            out, _ = self.run_text("verify", "maze.off", "p.vtk", "p.json", name, status=4)
            self.assertRegex(out, "FAILED the certificate is about pieces.*" + text)
        self.write("raised.txt", self.read("why.txt").decode().replace(
            f"\nbound {bound}\n", f"\nbound {bound + 1}\n"))
        self.write("forged.json", json.dumps({**report, "lower_bound": bound + 1,
                                              "optimal": bound + 1 == pieces}))
        out, _ = self.run_text("verify", "maze.off", "p.vtk", "forged.json", "raised.txt", status=4)
        self.assertRegex(out, "FAILED .*does not follow")
        err = self.run_text("verify", "maze.off", "p.vtk", "why.txt", status=1)[1]
        self.assertIn("PIECES.json, which is missing", err)

    def test_bounds_that_are_not_proven(self):
        self.write("tets.mesh", """MeshVersionFormatted 2
Dimension 3
Vertices
4
0 0 0 0
1 0 0 0
0 1 0 0
0 0 1 0
Tetrahedra
1
1 2 3 4 0
End
""")
        for words, status, text in [
                (["m.off", "--certificate", "no.txt"], 1, "add --prove"),
                (["m.off", "--prove", "--mode", "paper"], 1, "in strict mode only"),
                (["tets.mesh", "--prove"], 1, "for surfaces only")]:
            err = self.run_text("decompose", *words, "-o", "no.vtk", status=status)[1]
            self.assertIn(text, err)
        self.assertFalse({"no.vtk", "no.txt"} & set(self.names()))

    def test_pieces_of_another_model(self):
        self.run_text("sample", "star", "--vertices", "500", "-o", "other.off")
        report = self.decompose(model="other.off")
        for distance in [100, 1e99]:
            report.update(surface="approximated", distance=distance, distance_back=distance)
            self.refused_pieces(report, "a part of the diagonal")

    def write_boxes(self, boxes):
        """Each is turned at random: (random numbers, middle)."""
        points, faces = [], []
        for rng, middle in boxes:
            w, x, y, z = (rng.gauss(0, 1) for _ in range(4))
            size, n = [rng.uniform(.3, 1.5) for _ in range(3)], w * w + x * x + y * y + z * z
            turn = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
            faces += [[len(points) + i for i in face] for face in BOX]
            points += [[m + sum(t * s * ((i >> k & 1) - .5) for k, (t, s) in enumerate(zip(row, size))) / n
                        for m, row in zip(middle, turn)] for i in range(8)]
        self.write("boxes.off", "\n".join([f"OFF\n{len(points)} {len(faces)} 0",
                                          *(" ".join(map(repr, p)) for p in points),
                                          *("3 {} {} {}".format(*f) for f in faces), ""]))

    def test_distances_of_models_that_cross_themselves(self):
        for seed in range(12):
            rng = random.Random(seed)
            self.write_boxes([(rng, [rng.uniform(-.4, .4) for _ in range(3)]) for _ in range(3)])
            report = self.decompose(model="boxes.off")
            with self.subTest(seed=seed):
                self.assertEqual(report["surface"], "approximated")
                self.run_text("verify", "boxes.off", "p.vtk", "p.json")

    def test_a_part_that_is_missing(self):
        rng = random.Random(1)
        near = [(rng, [0, 0, 0]), (rng, [.2, .1, 0])]
        self.write_boxes([*near, (rng, [4, 0, 0])])
        report = self.decompose(model="boxes.off")
        self.assertEqual(report["surface"], "approximated")
        self.run_text("verify", "boxes.off", "p.vtk", "p.json")
        rng.seed(1)
        self.write_boxes(near)
        short = self.decompose(model="boxes.off")
        short.update(model=report["model"], distance_back=2.4)
        self.write_boxes([*near, (rng, [4, 0, 0])])
        self.refused_pieces(short, "fill what the model encloses", model="boxes.off")

    # ---- what is not checked, and what is genuine ----

    def test_not_checked(self):
        result = self.guard("--method", "ilp")
        found = self.run_json("verify", "m.off", "g.json")["results"][0]["not_checked"]
        out, _ = self.run_text("verify", "m.off", "g.json", "--verbose")
        for text in [f"that there were {result['candidates']} candidates",
                     f"no fewer than {result['lower_bound']}"]:
            self.assertTrue(any(text in line for line in found), found)
            self.assertIn(text, out)
        self.assertEqual(out.count("  not checked: "), len(found))

    def test_genuine_guards(self):
        self.write("places.txt", PLACES)
        for which, model in enumerate(MODELS):
            self.run_text("sample", model, "--vertices", "500", "-o", "m.off")
            for question in QUESTIONS if support.LONG else QUESTIONS[which::3]:
                count = () if "--count" in question else ("--count", "40")
                with self.subTest(model=model, question=question):
                    self.guard("--refine-lines", "5000", *count, *question.split())
                    self.run_text("verify", "m.off", "g.json")

    def test_genuine_pieces(self):
        for model in MODELS:
            self.run_text("sample", model, "--vertices", "500", "-o", "m.off")
            for words in [(), ("--mode", "paper")]:
                with self.subTest(model=model, words=words):
                    self.decompose(*words)
                    self.run_text("verify", "m.off", "p.vtk", "p.json")


if __name__ == "__main__":
    support.main()
