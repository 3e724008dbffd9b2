#!/usr/bin/env python3
"""The hall of s01 is sound: nothing overlaps, every service point is free and a robot can reach it."""
import collections
import math
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "ontology"))
import rdf_triples  # noqa: E402

SCENARIO = ROOT / "scenarios" / "s01_booth_guide"
ROBOT_RADIUS_M = 0.3
CELL_M = 0.1
OBSTACLES = {"docent:Wall", "docent:BoothWall", "docent:Counter", "docent:Pillar"}


def numbers(wkt):
    return [tuple(map(float, p.split())) for p in re.search(r"\(+([^()]*)\)+", wkt)[1].split(",")]


def inside(ring, x, y):
    """Even-odd rule."""
    hit = False
    for (x0, y0), (x1, y1) in zip(ring, ring[1:]):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            hit = not hit
    return hit


def outline_distance(ring, x, y):
    def to_segment(a, b):
        dx, dy = b[0] - a[0], b[1] - a[1]
        t = max(0.0, min(1.0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)))
        return math.hypot(x - a[0] - t * dx, y - a[1] - t * dy)
    return min(to_segment(a, b) for a, b in zip(ring, ring[1:]))


class Hall(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = {}
        for s, p, o in rdf_triples.read(SCENARIO / "hall.ttl") + rdf_triples.read(SCENARIO / "world.ttl"):
            cls.data.setdefault(s, {}).setdefault(p, []).append(o)
        cls.hall = cls.ring("expo:Hall")
        cls.booths = sorted(s for s in cls.data if "docent:Booth" in cls.types(s))
        cls.obstacles = sorted(s for s in cls.data if OBSTACLES & cls.types(s))
        cls.shapes = [cls.shape(o) for o in cls.obstacles]
        cls.served = sorted(s for s in cls.data if "docent:servicePoint" in cls.data[s])

    @classmethod
    def types(cls, subject):
        return set(cls.data[subject].get("rdf:type", []))

    @classmethod
    def ring(cls, subject):
        return numbers(cls.data[cls.data[subject]["geo:hasGeometry"][0]]["geo:asWKT"][0])

    @classmethod
    def shape(cls, obstacle):
        """(ring or centre, radius or 0, bounding box)"""
        ring, radius = cls.ring(obstacle), float(cls.data[obstacle].get("docent:radius", [0])[0])
        xs, ys = zip(*ring)
        return ring, radius, (min(xs) - radius, min(ys) - radius, max(xs) + radius, max(ys) + radius)

    def service_point(self, subject):
        point = self.data[self.data[subject]["docent:servicePoint"][0]]
        return numbers(point["geo:asWKT"][0])[0] + (float(point["docent:heading"][0]),)

    def clearance(self, x, y):
        """Distance to the nearest obstacle or the hall's outline; 0 or less inside one."""
        nearest = outline_distance(self.hall, x, y) if inside(self.hall, x, y) else 0.0
        for ring, radius, (x0, y0, x1, y1) in self.shapes:
            if math.hypot(max(x0 - x, 0, x - x1), max(y0 - y, 0, y - y1)) >= nearest:
                continue
            if radius:
                distance = math.dist(ring[0], (x, y)) - radius
            else:
                distance = 0.0 if inside(ring, x, y) else outline_distance(ring, x, y)
            nearest = min(nearest, distance)
        return nearest

    def test_size_and_booths(self):
        xs, ys = zip(*self.hall)
        self.assertGreaterEqual(max(xs) - min(xs), 30)
        self.assertGreaterEqual(max(ys) - min(ys), 20)
        self.assertEqual(self.booths, [f"expo:B{i:02}" for i in range(1, 13)])
        self.assertGreaterEqual(len({(w, d) for w, d in map(self.booth_size, self.booths)}), 9, "sizes differ")

    def booth_size(self, booth):
        xs, ys = zip(*self.ring(booth))
        return round(max(xs) - min(xs), 3), round(max(ys) - min(ys), 3)

    def test_polygons_are_closed_and_in_the_hall(self):
        xs, ys = zip(*self.hall)
        for subject in self.data:
            if "geo:hasGeometry" not in self.data[subject] or "docent:Pillar" in self.types(subject):
                continue
            ring = self.ring(subject)
            if len(ring) > 1:
                self.assertEqual(ring[0], ring[-1], subject)
            for x, y in ring:
                self.assertTrue(min(xs) - 0.2 <= x <= max(xs) + 0.2 and min(ys) - 0.2 <= y <= max(ys) + 0.2, subject)

    def test_booths_do_not_overlap(self):
        for i, a in enumerate(self.booths):
            (ax0, ay0), (ax1, ay1) = self.ring(a)[0], self.ring(a)[2]
            for b in self.booths[i + 1:]:
                (bx0, by0), (bx1, by1) = self.ring(b)[0], self.ring(b)[2]
                self.assertFalse(ax0 < bx1 and bx0 < ax1 and ay0 < by1 and by0 < ay1, f"{a} and {b}")

    def test_walls_and_counters_of_a_booth_stand_in_it(self):
        for obstacle in self.obstacles:
            owner = self.data[obstacle]["docent:partOf"][0]
            self.assertIn(owner, self.booths + ["expo:Hall"], obstacle)
            if owner != "expo:Hall":
                (x0, y0), (x1, y1) = self.ring(owner)[0], self.ring(owner)[2]
                for x, y in self.ring(obstacle):
                    self.assertTrue(x0 <= x <= x1 and y0 <= y <= y1, f"{obstacle} leaves {owner}")

    def test_service_points_lie_in_their_region_and_are_free(self):
        self.assertEqual(self.served, sorted(self.booths + ["expo:Entrance", "expo:RobotDock"]))
        for region in self.served:
            x, y, _ = self.service_point(region)
            self.assertTrue(inside(self.ring(region), x, y), region)
            self.assertGreaterEqual(outline_distance(self.ring(region), x, y), 0.5, f"{region}: near its border")
            self.assertGreaterEqual(self.clearance(x, y), 0.5, region)

    def test_every_service_point_can_be_reached_from_the_dock(self):
        free = {}

        def is_free(cell):
            if cell not in free:
                free[cell] = self.clearance(cell[0] * CELL_M, cell[1] * CELL_M) > ROBOT_RADIUS_M + 0.1
            return free[cell]

        def cell_of(region):
            x, y, _ = self.service_point(region)
            return round(x / CELL_M), round(y / CELL_M)

        start = cell_of("expo:RobotDock")
        seen, queue = {start}, collections.deque([start])
        while queue:
            i, j = queue.popleft()
            for cell in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if cell not in seen and is_free(cell):
                    seen.add(cell)
                    queue.append(cell)
        for region in self.served:
            self.assertIn(cell_of(region), seen, region)

    def test_the_hall_does_not_look_the_same_from_the_other_side(self):
        """No half turn and no mirror image of the hall maps its obstacles onto themselves."""
        width, depth = self.hall[2]
        points = {(i * 0.5, j * 0.5) for i in range(1, int(width * 2)) for j in range(1, int(depth * 2))}
        solid = {p for p in points if self.clearance(*p) <= 0.05}
        for image in (lambda x, y: (width - x, depth - y), lambda x, y: (width - x, y), lambda x, y: (x, depth - y)):
            same = sum(image(*p) in solid for p in solid)
            self.assertLess(same / len(solid), 0.5)

    def test_every_booth_is_described_and_has_a_beacon(self):
        mapped = {about["docent:forSensor"][0]: about["docent:object"][0]
                  for about in self.data.values() if "docent:forSensor" in about}
        for booth in self.booths:
            about = self.data[booth]
            self.assertGreater(len(about["schema:description"][0]), 60)
            self.assertIn("schema:name", self.data[about["docent:exhibitor"][0]])
            self.assertEqual(mapped[booth + "Beacon"], booth)
        self.assertEqual(mapped["expo:DoorSensor"], "expo:Entrance")


if __name__ == "__main__":
    unittest.main()
