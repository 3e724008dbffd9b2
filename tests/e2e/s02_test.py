#!/usr/bin/env python3
"""Scenario s02 with real processes: a real robot's recording fires a workflow when it enters a region, and only then."""
import re
import sys
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

sys.path.insert(0, str(stage.ROOT / "scripts"))
import demo_s02  # noqa: E402


class RealRobotLog(StageTest):
    def replay(self, layout):
        server = self.stage.server()
        stage.load_s02(server, layout)
        robot = self.stage.start("robot", [self.stage.bin / "docent-robot", "replay", "--server", server.grpc, "--layout",
                                           layout, "--speed", "4", "--out", self.stage.folder / "robot"])
        self.assertEqual(robot.popen.wait(PATIENCE_S), 0, robot.tail())
        return server, robot

    def test_fires_within_one_step_of_the_reference(self):
        server, robot = self.replay(stage.S02 / "layout.ttl")
        self.wait_for_run(server)
        wkt = server.select("SELECT ?wkt { s02:EastDoors geo:hasGeometry ?g . ?g geo:asWKT ?wkt }")[0]["wkt"]
        entered = int(re.search(r"step (\d+) .*EastDoors", robot.output())[1])
        self.assertLessEqual(abs(entered - demo_s02.reference_entry(wkt)), 1)
        self.assertEqual((self.stage.folder / "robot" / "replay.png").read_bytes()[:4], b"\x89PNG")

    def test_nothing_fires_when_the_region_is_moved_away(self):
        text = (stage.S02 / "layout.ttl").read_text()
        polygon = "POLYGON((11.5 -12.4, 23 -12.4, 23 -8.8, 11.5 -8.8, 11.5 -12.4))"
        self.assertIn(polygon, text)
        moved = self.file("layout.ttl", text.replace(polygon, "POLYGON((-20 -1, -8 -1, -8 2.6, -20 2.6, -20 -1))"))
        server, robot = self.replay(moved)
        self.assertNotIn("EastDoors", robot.output())
        self.assertEqual(server.select("SELECT ?run { ?run a docent:Run }"), [])
        self.assertTrue(server.ask("s02:RealRobot docent:x ?x"), "poses came all the same")


if __name__ == "__main__":
    unittest.main()
