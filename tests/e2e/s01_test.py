#!/usr/bin/env python3
"""Scenario s01 with real processes: John arrives, R01 comes, leads him to B03 and presents it."""
import json
import threading
import unittest

from docent_e2e import PATIENCE_S, StageTest, journal, nodes, stage


class BoothGuide(StageTest):
    def test_the_booth_guide_runs_because_the_graph_said_so(self):
        server, robot = self.start_s01()
        self.assertEqual(server.select("SELECT ?run { ?run a docent:Run }"), [], "nothing runs before John has come")
        waits = []

        def before_step(words, fact):
            # John selects only when it was seen that the run waits for it
            if "docent:selected" in fact:
                stage.wait_until(lambda: waits.extend(row["waits"] for row in nodes(server).values() if row.get("waits")) or waits,
                                 PATIENCE_S, "the run to wait for John's selection")

        visitor = stage.Visitor(server, "B03", PATIENCE_S, before_step)
        asked = self.ask_meanwhile(server)
        visitor.start()
        run = self.wait_for_run(server)
        visitor.join(PATIENCE_S)
        self.assertIsNone(visitor.error)

        # the nodes fired in the order of the flow, each because of facts that name John, the robot and the booth
        fired = nodes(server)
        self.assertEqual({name: row["state"] for name, row in fired.items()},
                         {"Move2User": "done", "Move2Booth": "done", "InfoBooth": "done"})
        self.assertIn("expo#John", fired["Move2User"]["because"])
        self.assertIn("expo#B03", fired["Move2Booth"]["because"])
        for words in ("expo#John", "expo#R01", "isAt", "expo#B03"):
            self.assertIn(words, fired["InfoBooth"]["because"])

        # each command once, in this order; screen and voice were commanded together
        commands = journal(robot)
        self.assertEqual(len(commands), len(set(commands)), commands)
        self.assertEqual([c.split("/")[1] for c in commands], ["Move2User", "Move2Booth", "InfoBooth", "InfoBooth"])
        operations = server.select("SELECT ?o ?state { ?i a docent:Invocation ; docent:operation ?o ; docent:invocationState ?state } ORDER BY ?o")
        self.assertEqual(operations, [{"o": o, "state": "done"} for o in
                                      ("briefInformation", "displayInformation", "moveToBooth", "moveToUser")])

        # what people saw and heard
        self.assertTrue(server.ask("expo:R01 docent:isAt expo:B03 ; docent:screenPage ?page ; docent:spokenFile ?file"))
        pages = " ".join(p.read_text() for p in robot.folder.glob("*.html"))
        self.assertIn("Stairlark", pages)
        voice = [p for p in robot.folder.glob("*.wav") if p.read_bytes()[:4] == b"RIFF"]
        self.assertTrue(voice and voice[0].stat().st_size > 100_000)

        # while it ran, queries were answered: where R01 was, what the run waited for
        self.assertGreater(len(asked["regions"]), 2, asked)
        self.assertTrue(any("ASK" in w and "docent:selected" in w for w in waits), waits)
        self.assertEqual(asked["errors"], [])
        self.assertIn("done", server.command("runs"))
        self.assertIn(run.rsplit(":", 1)[1], server.command("runs"))
        self.check_robot_report(robot)

    def ask_meanwhile(self, server):
        """Asks the server during the run, over HTTP and over gRPC; what was seen, and what went wrong."""
        seen = {"regions": set(), "errors": []}
        stop = threading.Event()

        def ask():
            while not stop.wait(0.1):
                for row in server.select("SELECT ?r { expo:R01 docent:isAt ?r }"):
                    seen["regions"].add(row["r"])
                done = server.run("query", "ASK { ?r a docent:Robot }")
                if done.returncode != 0:
                    seen["errors"].append(done.stderr)

        def end():
            stop.set()
            thread.join(30)

        thread = threading.Thread(target=ask, daemon=True)
        thread.start()
        self.addCleanup(end)
        return seen

    def check_robot_report(self, robot):
        robot.stop()
        report = json.loads((robot.folder / "report.json").read_text())
        self.assertGreater(report["path_m"], 20)
        self.assertLess(report["rmse_mm"], 40)
        pictures = [p for p in robot.folder.glob("*.png") if p.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"]
        self.assertTrue(pictures)

    def test_a_second_visit_starts_a_second_run(self):
        server, _ = self.start_s01()
        visitor = stage.Visitor(server, "B09", PATIENCE_S)
        visitor.start()
        self.wait_for_run(server)
        visitor.join(PATIENCE_S)
        server.tell(withdraw="expo:John docent:chose expo:BoothGuideService", source=stage.Visitor.PHONE)
        server.tell(withdraw="expo:John docent:selected expo:B09", source=stage.Visitor.PHONE)
        server.tell(readings=[("expo:DoorSensor", "tag-17")], source=stage.Visitor.SENSORS)
        server.tell("expo:John docent:chose expo:BoothGuideService", source=stage.Visitor.PHONE)
        stage.wait_until(lambda: len(server.select("SELECT ?run { ?run a docent:Run }")) == 2, PATIENCE_S, "a second run")


if __name__ == "__main__":
    unittest.main()
