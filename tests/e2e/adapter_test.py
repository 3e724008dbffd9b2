#!/usr/bin/env python3
"""An adapter that is absent, hangs or dies: the step times out, the run says so and why, the server goes on."""
import signal
import unittest

from docent_e2e import PATIENCE_S, SPEED, StageTest, journal, nodes, stage


class Adapter(StageTest):
    def impatient_s01(self):
        """s01 that gives up after seconds, so that a test need not wait for minutes."""
        server = self.stage.server()
        stage.load_s01(server, workflow=False)
        rsel = (stage.S01 / "booth_guide.rsel.xml").read_text()
        self.assertIn('ext:timeout="5min" ext:retry="1"', rsel)
        server.load(self.file("booth_guide.rsel.xml", rsel.replace('ext:timeout="5min" ext:retry="1"', 'ext:timeout="4s"')))
        cawl = (stage.S01 / "booth_guide.cawl.xml").read_text()
        before = '<documentation>A robot that is free and knows where it is comes to the visitor.</documentation>\n      <condition'
        self.assertIn(before, cawl)
        server.load(self.file("booth_guide.cawl.xml", cawl.replace(before, before + ' ext:timeout="4s"')))
        return server

    def arrive(self, server):
        server.tell(readings=[("expo:DoorSensor", "tag-17")], source=stage.Visitor.SENSORS)
        server.tell("expo:John docent:chose expo:BoothGuideService", source=stage.Visitor.PHONE)

    def assert_failed(self, server, *words):
        """The run failed, and node and run say why in these words. The server still takes and answers."""
        self.wait_for_run(server, "failed")
        failed = [row for row in nodes(server).values() if row["state"] == "failed"]
        self.assertEqual(len(failed), 1, nodes(server))
        for word in words:
            self.assertIn(word, failed[0]["reason"])
        server.tell("expo:John docent:selected expo:B07", source=stage.Visitor.PHONE)
        self.assertTrue(server.ask("expo:John docent:selected expo:B07"))
        self.assertIn("failed", server.command("runs"))

    def test_absent_from_the_beginning(self):
        server = self.impatient_s01()
        self.arrive(server)
        self.assert_failed(server, "condition", "4")

    def test_hangs(self):
        server = self.impatient_s01()
        robot = self.stage.robot(server, speed=SPEED)
        server.wait_for("expo:R01 docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        robot.process.signal(signal.SIGSTOP)
        self.addCleanup(robot.process.signal, signal.SIGCONT)
        self.arrive(server)
        self.assert_failed(server, "deadline")

    def test_dies_while_it_drives(self):
        server = self.impatient_s01()
        robot = self.stage.robot(server, speed=0.5)
        server.wait_for("expo:R01 docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        self.arrive(server)
        stage.wait_until(lambda: journal(robot), PATIENCE_S, "the first command")
        robot.kill()
        self.assert_failed(server)
        server.wait_for("expo:R01 docent:status docent:Offline", PATIENCE_S)

    def test_dies_and_comes_back_as_another_incarnation(self):
        """Its command's outcome is unknown; moving is idempotent, so the command is sent again and the run goes on."""
        server, robot = self.start_s01()
        before = server.select("SELECT ?i { expo:R01 docent:incarnation ?i }")
        visitor = stage.Visitor(server, "B03", PATIENCE_S)
        visitor.start()
        stage.wait_until(lambda: journal(robot), PATIENCE_S, "the first command")
        robot.kill()
        robot.start()
        run = self.wait_for_run(server)
        self.assertIn("urn:docent:run:", run)
        self.assertNotEqual(server.select("SELECT ?i { expo:R01 docent:incarnation ?i }"), before)


if __name__ == "__main__":
    unittest.main()
