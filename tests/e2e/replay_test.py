#!/usr/bin/env python3
"""Recorded runs lived again, with real processes: the booth guide with an adapter that only takes its time, replayed on the server,
saved, tested without a server, and tested after edits of its document; also after a kill of the server."""
import json
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

EXPO = stage.EXPO
GUIDE = stage.S01 / "booth_guide.cawl.xml"
SENSORS, PHONE, WATCH = "urn:docent:source:sensors", "urn:docent:source:phone", "urn:docent:source:watch"
OPERATIONS = ("moveToUser:user", "moveToBooth:booth", "displayBoothInfo:booth", "briefBoothInfo:booth")


class Replay(StageTest):
    def guide(self):
        """The booth guide from John's arrival to its end; the server and the run."""
        server = self.stage.server()
        stage.load_s01(server)
        given = [word for operation in OPERATIONS for word in ("--operation", operation)]
        self.stage.start("adapter", [self.stage.bin / "docent-scripted-adapter", "--server", server.grpc, "--robot", EXPO + "R01",
                                     "--journal", self.stage.folder / "journal", "--take-ms", "200", *given])
        server.wait_for("expo:R01 docent:offers ?o", PATIENCE_S)
        server.tell("expo:R01 docent:localised true", source=WATCH)
        server.tell("expo:R01 docent:isAt expo:Entrance", source=WATCH)
        server.wait_for("expo:R01 docent:status docent:Standby", PATIENCE_S)
        server.tell(readings=[("expo:DoorSensor", "tag-17")], source=SENSORS)
        server.tell("expo:John docent:chose expo:BoothGuideService", source=PHONE)
        self.wait_for_node(server, "Move2User", "done")
        server.tell("expo:John docent:selected expo:B03", source=PHONE)
        self.wait_for_node(server, "Move2Booth", "done")
        server.tell("expo:R01 docent:isAt expo:B03", source=WATCH)
        server.tell(readings=[("expo:B03Beacon", "tag-17")], source=SENSORS)
        return server, self.wait_for_run(server).removeprefix("urn:docent:run:")

    def wait_for_node(self, server, node, state):
        server.wait_for(f"?n docent:nodeName '{node}' ; docent:nodeState '{state}'", PATIENCE_S)

    def edited(self, name, *changes):
        text = GUIDE.read_text()
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after)
        return self.file(name, text)

    def test_a_run_is_replayed_saved_and_tested(self):
        server, run = self.guide()
        server.kill()
        server.start()
        same = server.run("replay", "--run", run)
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertIn("the same", same.stdout)
        self.assertIn("Move2Booth", same.stdout)
        self.assertNotIn("note:", same.stdout)
        saved = self.stage.folder / "guide.run.json"
        self.assertIn("is saved in", server.command("runs", "save", run, "--to", saved))
        kept = json.loads(saved.read_text())
        self.assertEqual(kept["format"], "docent-saved-run")
        before = server.metrics()
        self.check_edits(server, run, saved)
        self.check_one_node(server, run)
        self.check_bad_input(server, run, saved)
        self.assertEqual(server.metrics()["docent_commands_total"], before["docent_commands_total"], "nothing is sent")
        self.assertEqual(server.select("SELECT ?run { ?run a docent:Run }"), [{"run": f"urn:docent:run:{run}"}])
        server.stop()
        self.assertEqual(self.docent("test", GUIDE, saved).returncode, 0)

    def check_edits(self, server, run, saved):
        guard = self.edited("guard.cawl.xml", ("<verb>docent:selected</verb>\n              <object type=\"docent:Booth\">?booth</object>",
                                               "<verb>docent:selected</verb>\n              <object type=\"docent:Exit\">?booth</object>"))
        link = self.edited("link.cawl.xml", ('<link from="Move2Booth" to="InfoBooth"/>\n    <link from="InfoBooth" to="Presented"/>',
                                             '<link from="Move2Booth" to="Presented"/>'),
                           ('<link from="Arrived" to="Move2User"/>', '<link from="Arrived" to="Move2User"/>\n    <link from="Arrived" to="InfoBooth"/>\n    <link from="InfoBooth" to="Presented"/>'))
        value = self.edited("value.cawl.xml", ('<invoke operation="moveToBooth"/>',
                                               '<ext:assign variable="booth" expression="expo:B09"/>\n      <invoke operation="moveToBooth"/>'))
        other = self.edited("other.cawl.xml", ('<invoke operation="briefInformation"/>', '<invoke operation="moveToUser"/>'))
        for file, node, words in ((guard, "Move2Booth", "not reached"), (link, "InfoBooth", "turn"), (value, "Move2Booth", "expo:B09"),
                                  (other, "InfoBooth", "there is no recorded report of moveToUser(")):
            replayed = server.run("replay", "--run", run, "--workflow", file)
            tested = self.docent("test", file, saved)
            for done in (replayed, tested):
                self.assertEqual(done.returncode, 1, f"{file}: {done.stdout}{done.stderr}")
                self.assertIn(words, done.stdout)
            self.assertIn(f"first difference: {node},", replayed.stdout)
            answer = json.loads(server.run("replay", "--run", run, "--workflow", file, "--json").stdout)
            self.assertFalse(answer["same"])
            self.assertEqual(answer["nodes"][0]["node"], node)
        assumed = server.run("replay", "--run", run, "--workflow", other, "--assume-done")
        self.assertIn("taken to have succeeded at once", assumed.stdout)
        both = self.docent("test", GUIDE, saved, saved, "--json")
        self.assertEqual(both.returncode, 0)
        self.assertEqual([json.loads(line)["same"] for line in both.stdout.splitlines()], [True, True])

    def check_one_node(self, server, run):
        tried = server.run("replay", "--run", run, "--node", "Move2Booth")
        self.assertEqual(tried.returncode, 0, tried.stdout + tried.stderr)
        self.assertIn("would send moveToBooth(booth=expo:B03) to expo:R01", tried.stdout)
        turn = json.loads(server.run("replay", "--run", run, "--node", "Move2User", "--json").stdout)["turn"]
        early = server.run("replay", "--run", run, "--node", "Move2Booth", "--at", turn)
        self.assertEqual(early.returncode, 1, early.stdout + early.stderr)
        self.assertIn("does not open", early.stdout)
        self.assertIn("docent:selected", early.stdout)

    def check_bad_input(self, server, run, saved):
        self.assert_refused(server.run("replay", "--run", "BoothGuide-99"), 2, "BoothGuide-99", "docent runs")
        broken = self.edited("broken.cawl.xml", ("<verb>docent:selected</verb>", "<verb>dosent:selected</verb>"))
        self.assert_refused(server.run("replay", "--run", run, "--workflow", broken), 2, "broken.cawl.xml:", "dosent")
        self.assert_refused(self.docent("test", broken, saved), 2, "broken.cawl.xml:", "dosent")
        renamed = self.edited("renamed.cawl.xml", ('<CAWL name="BoothGuide"', '<CAWL name="Tour"'))
        self.assert_refused(server.run("replay", "--run", run, "--workflow", renamed), 2, "Tour", "BoothGuide")
        self.assert_refused(server.run("replay", "--run", run, "--node", "Move2Boot"), 2, "did you mean Move2Booth?")
        cut = self.file("cut.run.json", saved.read_text()[:5000])
        self.assert_refused(self.docent("test", GUIDE, cut, saved), 2, "cut.run.json", "damaged")
        newer = self.file("newer.run.json", saved.read_text().replace('"formatVersion": 2', '"formatVersion": 7'))
        self.assert_refused(self.docent("test", GUIDE, newer), 2, "format version 7")
        self.assert_refused(self.docent("test", GUIDE, self.stage.folder / "none.json"), 2, "none.json")
        self.assert_refused(server.run("replay", "--run", run, "--at", "3"), 2, "--node")


if __name__ == "__main__":
    unittest.main()
