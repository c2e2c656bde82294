# SPDX-License-Identifier: Apache-2.0
"""Guards in the order of a short tour: against all orders where legs are straight, around walls, between
solids, beside guards that stay."""
import itertools
import json
import math

from support import Case, main
from test_scenes import box, off


def length(points):
    return sum(map(math.dist, points, points[1:]))


class Tour(Case):
    def order(self, model, *words):
        self.run_text("guard", model, "-o", "g.json", "--order", "--quiet", *map(str, words))
        self.run_text("verify", model, "g.json")
        result = json.loads(self.read("g.json"))
        return result, result["tour"], [guard["position"] for guard in result["guards"]]

    def test_straight(self):
        """In a box every leg is straight, and the tour is the shortest of all orders."""
        for size, reach in (((4, 1, 3), 1.3), ((9, 1, 1), 1.5), ((3, 3, 3), 2), ((5, 2, 5), 2)):
            with self.subTest(size=size):
                self.write("box.off", off(box((0, 0, 0), size)))
                _, tour, places = self.order("box.off", "--range", reach, "--patch", 1)
                self.assertGreater(len(places), 2)
                self.assertEqual(tour["points"], places)
                self.assertEqual(tour["stops"], list(range(len(places))))
                self.assertAlmostEqual(tour["length"], length(places))
                if len(places) <= 8:
                    shortest = min(map(length, itertools.permutations(places)))
                    self.assertLess(tour["length"], 1.000001 * shortest)

    def test_around(self):
        """Ways bend around walls; another order is not shorter even where it goes through them."""
        self.run_text("sample", "gallery", "--vertices", "1000", "-o", "gallery.off")
        _, tour, places = self.order("gallery.off")
        self.assertGreater(len(tour["points"]), len(places))
        self.assertEqual([tour["points"][i] for i in tour["stops"]], places)
        self.assertAlmostEqual(tour["length"], length(tour["points"]))
        self.assertEqual(tour["blocked"], [])
        shortest = min(map(length, itertools.permutations(places)))
        self.assertGreater(tour["length"], shortest)
        self.assertLess(tour["length"], 1.3 * shortest)

    def test_apart(self):
        """No way leads from one solid to the next; each such leg is used once."""
        self.write("apart.off", off(*(box((x, 0, 0), (x + 1, 1, 1)) for x in (0, 6, 3))))
        _, tour, places = self.order("apart.off")
        self.assertEqual(len(places), 3)
        self.assertEqual(tour["blocked"], [0, 1])
        self.assertEqual(sorted(places), places if places[0] < places[1] else places[::-1])

    def test_others(self):
        """Outside, every point, and beside guards that stay, which come first and are not visited."""
        self.write("box.off", off(box((0, 0, 0), (2, 1, 1))))
        self.order("box.off", "--outside", "--standoff", "0.2,0.5")
        self.run_text("sample", "l-room", "--vertices", "500", "-o", "l.off")
        result, _, _ = self.order("l.off", "--target", "points")
        self.assertTrue(result["coverage"]["points"]["complete"])
        self.write("stay.txt", "0.5 0.5 0.5\n")
        result, tour, places = self.order("box.off", "--range", 1, "--patch", 0.5, "--keep", "stay.txt")
        self.assertEqual([tour["points"][i] for i in tour["stops"]], places[1:])
        self.assertTrue(result["guards"][0]["kept"])

    def test_forged(self):
        """A shorter way through a wall, another length, a guard left out."""
        self.run_text("sample", "gallery", "--vertices", "1000", "-o", "gallery.off")
        result, tour, places = self.order("gallery.off")
        straight = {**tour, "points": places, "stops": list(range(len(places))), "length": length(places)}
        for claim, forged in (("meet no face", straight),
                              ("long", {**tour, "length": 0.99 * tour["length"]}),
                              ("stops at each guard", {**straight, "points": places[:-1],
                                                       "stops": list(range(len(places) - 1)),
                                                       "length": length(places[:-1])}),
                              ("stops at each guard", {**tour, "blocked": [0, len(places) - 1]})):
            self.write("bad.json", json.dumps({**result, "tour": forged}))
            out, _ = self.run_text("verify", "gallery.off", "bad.json", status=4)
            self.assertIn(claim, out)


if __name__ == "__main__":
    main()
