#!/usr/bin/env python3
"""Scenario s05 with real processes: deliveries in a care home by day and by night, one that is refused and brought back, one
that a person has to settle, a round at its time; and the same workflow on the floor of a real building."""
import os
import pathlib
import re
import time
import unittest

from docent_e2e import PATIENCE_S, SPEED, StageTest, journal, stage
import stage_s05
from stage_s05 import CARE, S05, event, order, tell, wait_for_end, wait_for_node

DATA = pathlib.Path(os.environ.get("DOCENT_DATA", stage.ROOT.parent / "shared" / "data"))
SPEED_HERE = max(SPEED, 8)


class HospitalRound(StageTest):
    def start(self, night):
        server = self.stage.server()
        stage_s05.load_s05(server)
        stage_s05.make_it(server, night)
        robot = stage_s05.robot(self.stage, server, speed=SPEED_HERE)
        server.wait_for("care:C01 docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        return server, robot

    def load(self, server, name):
        """The pharmacist puts it into the tray and confirms it."""
        wait_for_node(server, name, "Load", "waiting", PATIENCE_S)
        server.wait_for("care:C01 docent:isAt care:Pharmacy", PATIENCE_S)
        event(server, "loaded", f"care:{name} care:loadedBy care:Pharmacist")

    def test_by_day_it_is_announced_aloud_and_confirmed(self):
        server, robot = self.start(night=False)
        order(server, "D1", "care:Room2")
        self.load(server, "D1")
        wait_for_node(server, "D1", "HandOver", "waiting", PATIENCE_S)
        self.assertTrue(server.ask("care:C01 docent:isAt care:Room2 . care:D1 care:state care:OnBoard"))
        event(server, "taken", "care:D1 care:takenBy care:ResidentOfRoom2")
        _, state, reason = wait_for_end(server, "D1")
        self.assertEqual((state, reason), ("done", ""))
        self.assertTrue(server.ask("care:D1 care:state care:Delivered"))
        self.assertFalse(server.ask("care:D1 care:due true"))
        self.assertIn("I bring evening medicine.", (robot.folder / "said_1.wav.txt").read_text())
        done = [c.split("/")[1] for c in journal(robot)]
        self.assertEqual(done, ["Fetch", "Load", "Drive", "Drive", "AnnounceAloud", "AnnounceAloud"])
        self.assertEqual(self.ways(server, "D1"), ["care:MainCorridor"])

    def ways(self, server, name):
        rows = server.select(f"""SELECT ?via {{ ?run docent:hasVariable ?v , ?w . ?v docent:variableName "delivery" ;
            docent:variableValue care:{name} . ?w docent:variableName "via" ; docent:variableValue ?via }}""")
        return [row["via"] for row in rows]

    def test_by_night_only_what_is_urgent_goes_silently_by_another_way_and_what_is_refused_goes_back(self):
        server, robot = self.start(night=True)
        order(server, "Linen", "care:Room1", item="care:FreshLinen", store="care:Store")
        order(server, "D2", "care:Room2", urgent=True)
        self.load(server, "D2")
        wait_for_node(server, "D2", "HandOver", "waiting", PATIENCE_S)
        self.assertEqual(self.ways(server, "D2"), ["care:ServicePassage"])
        event(server, "refused", "care:D2 care:refusedBy care:ResidentOfRoom2")
        run, state, reason = wait_for_end(server, "D2")
        self.assertEqual(state, "failed")
        self.assertIn("Refuse: the delivery was refused", reason)
        self.assertTrue(server.ask("care:D2 care:notDelivered true"), "a rule sees how its run has ended")
        self.assertTrue(server.ask("care:C01 docent:isAt care:Pharmacy"), "it was brought back before the run ended")
        self.assertTrue(server.ask(f'?undo docent:parentRun <{run}> ; docent:runState "done"'), "the undoing is a run of its own")
        self.assertEqual(list(robot.folder.glob("said_*")), [], "not a sound by night")
        self.assertIn("Not delivered", (robot.folder / "screen_text.html").read_text())
        self.assertFalse(server.ask('?v docent:variableValue care:Linen'), "it can wait until the morning")

        stage_s05.make_it(server, night=False)  # and now it is morning
        wait_for_node(server, "Linen", "Load", "waiting", PATIENCE_S)

    def test_what_the_robot_cannot_do_waits_for_a_person(self):
        server, robot = self.start(night=False)
        order(server, "D3", "care:Room7")  # there is no such room on the robot's floor
        self.load(server, "D3")
        wait_for_node(server, "D3", "Drive", "incident", PATIENCE_S)
        run = server.select("SELECT ?id { ?run docent:flow 'Deliver' ; docent:runState 'running' BIND (STR(?run) AS ?id) }")[0]["id"]
        run = run.rsplit(":", 1)[1]
        self.assertIn("no region", server.command("runs", run))
        server.command("runs", "set", run, f"place=<{CARE}Room3>")
        server.command("runs", "retry", run, "Drive")
        wait_for_node(server, "D3", "HandOver", "waiting", PATIENCE_S)
        self.assertTrue(server.ask("care:C01 docent:isAt care:Room3"))
        event(server, "taken", "care:D3 care:takenBy care:NurseOnDuty")
        self.assertEqual(wait_for_end(server, "D3")[1], "done")

    def test_the_night_round_begins_at_its_time_and_ends_with_the_night(self):
        server, robot = self.start(night=True)
        text = (S05 / "night_round.cawl.xml").read_text()
        soon = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(time.time() + 4))
        text = re.sub('ext:zone="[^"]*"', 'ext:zone="UTC"', text).replace('at="02:30"', f'at="{soon}"')
        server.load(self.file("night_round.cawl.xml", text))
        server.wait_for('?run docent:flow "NightRound" ; docent:runState "done"', PATIENCE_S)
        self.assertTrue(server.ask("care:C01 docent:isAt care:Lounge"), "the places in order: kitchen, lounge")
        self.assertEqual([c.split("/")[1] for c in journal(robot)], ["LookIn"] * 4, "by the passage to each place")


class RealFloor(StageTest):
    def test_the_same_workflow_on_the_floor_of_a_real_building(self):
        aaf = DATA / "buildings" / "aaf"
        if not (aaf / "aaf_HAN_y4.yaml").exists():
            self.skipTest("there are no floors of real buildings; DOCENT_DATA names the folder that has them")
        hall = self.stage.folder / "hall.ttl"
        done = self.docent("map", "import", aaf / "y4_aaf-cropped.yaml", aaf / "aaf_HAN_y4.yaml", "--namespace", CARE + "aaf/",
                           "--name", "floor", "--out", hall)
        self.assertEqual(done.returncode, 0, done.stderr)
        server = self.stage.server()
        stage_s05.load_s05(server, hall)
        stage_s05.make_it(server, night=False)
        place = CARE + "aaf/"
        server.command("tell", "--prefix", f"care={CARE}", f"care:Floor care:dayRoute <{place}Rezeption>", "--withdraw",
                       "care:Floor care:dayRoute care:MainCorridor")
        self.stage.start("C01", [self.stage.bin / "docent-scripted-adapter", "--server", server.grpc, "--robot", CARE + "C01",
                                 "--journal", self.stage.folder / "journal", "--operation", "driveTo:place=docent:Region",
                                 "--operation", "say:text=xsd:string", "--operation", "showText:text=xsd:string"])
        server.wait_for("care:C01 docent:status docent:Standby", PATIENCE_S)
        tell(server, "care:C01 docent:localised true")
        order(server, "D9", f"<{place}Frisoer>", store=f"<{place}Ambulanz>")
        wait_for_node(server, "D9", "Load", "waiting", PATIENCE_S)
        event(server, "loaded", "care:D9 care:loadedBy care:Pharmacist")
        wait_for_node(server, "D9", "HandOver", "waiting", PATIENCE_S)
        event(server, "taken", "care:D9 care:takenBy care:NurseOnDuty")
        self.assertEqual(wait_for_end(server, "D9")[1:], ("done", ""))
        begun = [f[3].split("/")[1] for f in map(lambda line: line.split("\t"), (self.stage.folder / "journal").read_text().splitlines())
                 if f[0] == "begun"]
        self.assertEqual(begun[:4], ["Fetch", "Load", "Drive", "Drive"])
        # the named rooms are there, with where a robot stands and how far it is from one to the next
        rows = server.select("""SELECT ?name { ?room a docent:Region ; schema:name ?name ; docent:servicePoint ?p }""")
        self.assertLessEqual({"Kapelle", "Frisoer", "Ambulanz", "Rezeption"}, {row["name"] for row in rows})
        self.assertTrue(server.ask(f"?c docent:fromPlace <{place}Ambulanz> ; docent:toPlace ?to ; docent:length ?m FILTER (?m > 1)"))


if __name__ == "__main__":
    unittest.main()
