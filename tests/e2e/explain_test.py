#!/usr/bin/env python3
"""Why, why not, what if and watch through the command line, in the hall of scenario s01."""
import json
import os
import pathlib
import subprocess
import time
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

EXPO = ["--prefix", "expo=https://w3id.org/docent/expo#"]


class Explain(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        stage.load_s01(self.server)
        self.server.tell("expo:R01 docent:isAt expo:RobotDock ; docent:status docent:Standby ; docent:localised false")
        self.server.tell(readings=[("expo:DoorSensor", "tag-17")])

    def test_why_not_and_then_why(self):
        done = self.server.run("whynot", *EXPO, "expo:John docent:isNear expo:R01")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("missing     expo:R01 docent:isAt expo:Entrance   (now expo:RobotDock)", done.stdout)
        self.assertIn("then        expo:John docent:isNear expo:R01   by guide.rules rule 1", done.stdout)
        self.assertEqual(self.server.run("why", *EXPO, "expo:John docent:isNear expo:R01").returncode, 1)

        self.server.tell("expo:R01 docent:isAt expo:Entrance")
        done = self.server.run("why", *EXPO, "expo:John docent:isNear expo:R01")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("by guide.rules rule 1", done.stdout)
        self.assertIn("reading of expo:DoorSensor", done.stdout)
        self.assertIn("log offset", done.stdout)
        proof = json.loads(self.server.run("why", "--json", *EXPO, "ask", "ASK { ?v docent:isNear ?r }").stdout)
        self.assertEqual(proof["proof"]["steps"][0]["depth"], 1)
        self.assertIn("prov:wasDerivedFrom", self.server.run("why", "--prov", *EXPO, "expo:John docent:isNear expo:R01").stdout)
        self.assertEqual(self.server.run("whynot", *EXPO, "expo:John docent:isNear expo:R01").returncode, 1)

    def test_the_past_is_explained_on_the_facts_of_then(self):
        fact = "expo:John docent:isNear expo:R01"
        def revision():
            return int(self.server.run("why", *EXPO, "expo:John docent:isAt expo:Entrance").stderr.split()[-1])
        apart = revision()
        self.server.tell("expo:R01 docent:isAt expo:Entrance")
        together = revision()
        self.server.tell("expo:R01 docent:isAt expo:B03")
        self.assertEqual(self.server.run("why", *EXPO, fact).returncode, 1)
        done = self.server.run("why", *EXPO, "--as-of", str(together), fact)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("by guide.rules rule 1", done.stdout)
        self.assertIn("reading of expo:DoorSensor", done.stdout)
        self.assertEqual(done.stderr, f"revision {together}\n")
        done = self.server.run("whynot", *EXPO, "--as-of", str(apart), fact)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("missing     expo:R01 docent:isAt expo:Entrance   (now expo:RobotDock)", done.stdout)
        done = self.server.run("why", *EXPO, "--as-of", "999999", fact)
        self.assertEqual(done.returncode, 2)
        self.assertIn("the newest", done.stderr)
        done = self.server.run("why", *EXPO, "--as-of", "yesterday", fact)
        self.assertIn("as-of must be a revision number or a time", done.stderr)

    def test_what_a_run_waited_for_in_the_past(self):
        self.server.tell("expo:John docent:chose expo:BoothGuideService")
        time.sleep(0.5)
        run = json.loads(self.server.run("runs", "--json").stdout.splitlines()[0])
        run = run["runs"][0]["id"] if "runs" in run else run["id"]
        then = int(self.server.run("why", *EXPO, "expo:John docent:isAt expo:Entrance").stderr.split()[-1])
        waited = self.server.run("whynot", "--run", run).stdout
        self.server.command("runs", "cancel", run)
        self.assertNotEqual(self.server.run("whynot", "--run", run).stdout, waited)
        self.assertEqual(self.server.run("whynot", "--run", run, "--as-of", str(then)).stdout, waited)

    def test_what_stays_told_by_another_is_said(self):
        prefix = ("--prefix", "ex=http://ex/")
        self.server.command("tell", *prefix, "--source", "http://ex/s1", "ex:k ex:bad 1")
        done = self.server.run("whynot", *prefix, "ask", "PREFIX ex: <http://ex/> ASK { FILTER NOT EXISTS { ex:k ex:bad 1 } }")
        self.assertIn("in the way  ex:k ex:bad 1   (there must be no { ex:k ex:bad 1 }; told by ex:s1)", done.stdout)
        for command in (("tell", *prefix, "--withdraw", "ex:k ex:bad 1"), ("whatif", *prefix, "-ex:k ex:bad 1")):
            done = self.server.run(*command)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("ex:k ex:bad 1 is told by ex:s1; withdraw it there with --source ex:s1", done.stderr)
        done = self.server.run("tell", *prefix, "--source", "ex:s1", "--withdraw", "ex:k ex:bad 1")
        self.assertIn("1 removed", done.stdout)
        self.assertEqual(done.stderr, "")

    def test_the_empty_prefix_and_a_name_with_its_colon(self):
        self.server.command("tell", "--prefix", ":=http://ex/", "--prefix", "e:=http://ex/", "--source", ":s", ":k e:bad 2")
        done = self.server.run("query", "ASK { GRAPH <http://ex/s> { <http://ex/k> <http://ex/bad> 2 } }")
        self.assertEqual(done.stdout, "yes\n")
        done = self.server.run("tell", "--prefix", "=http://ex/", ":k e:bad 2")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nor :=IRI for the empty prefix", done.stderr)

    def test_what_if(self):
        done = self.server.run("whatif", *EXPO, "+expo:R01 docent:localised true",
                               "+expo:John docent:chose expo:BoothGuideService", "-expo:John docent:isAt expo:Entrance")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("+ expo:R01 a docent:AvailableRobot   (inferred)", done.stdout)
        self.assertIn("- expo:John docent:isAt expo:Entrance", done.stdout)
        self.assertIn("activator of BoothGuide", done.stdout)
        self.assertIn("BoothGuide-1: running", done.stdout)
        self.assertFalse(self.server.ask("?r a docent:AvailableRobot"))
        self.assertFalse(self.server.ask("?r docent:runState ?s"))

    def follow(self, *arguments):
        """A command that goes on, and a function that waits for a text among what it has said, and gives all of that."""
        log = open(self.stage.folder / f"{arguments[0]}.log", "w+b")
        self.addCleanup(log.close)
        process = subprocess.Popen([str(self.stage.bin / "docent"), arguments[0], "--server", self.server.grpc, *arguments[1:]],
                                   stdout=log, stderr=log)
        self.addCleanup(lambda: process.poll() is None and (process.kill(), process.wait()))

        def seen(text):
            for _ in range(600):
                said = pathlib.Path(log.name).read_text()
                if text in said:
                    return said
                time.sleep(0.1)
            self.fail(f"no {text!r} in {said!r}")

        return process, seen

    def wait_until_it_listens(self, process):
        """It says nothing before something happens. Its connection is there first, and then the call."""
        port = f":{int(self.server.grpc.rsplit(':', 1)[1]):04X}"

        def connected():
            tables = [pathlib.Path(f"/proc/{process.pid}/net/{name}") for name in ("tcp", "tcp6")]  # gRPC's are of IPv6
            rows = [line.split() for table in tables if table.exists() for line in table.read_text().splitlines()[1:]]
            inodes = {row[9] for row in rows if row[2].endswith(port) and row[3] == "01"}
            files = pathlib.Path(f"/proc/{process.pid}/fd").iterdir()
            return any(os.readlink(file) in {f"socket:[{inode}]" for inode in inodes} for file in files)

        stage.wait_until(connected, PATIENCE_S, "its connection")
        time.sleep(0.5)

    def test_a_run_knows_its_variables(self):
        self.assert_refused(self.server.run("run", "BoothGuide", "--var", "usr=expo:John"), 2, "no variable usr", "did you mean user?")

    def test_runs_are_watched_on_after_the_server_was_away(self):
        watch, seen = self.follow("runs", "--watch")
        self.wait_until_it_listens(watch)
        first = self.server.command("run", "BoothGuide", "--detach").strip()
        seen(first)
        self.server.kill()
        seen("the connection was lost")
        self.server.start()
        second = self.server.command("run", "BoothGuide", "--detach").strip()
        said = seen(second).splitlines()
        self.assertEqual(len(said), len(set(said)), said)

    def test_a_run_is_watched_on_although_nothing_had_happened_yet(self):
        run = self.server.command("run", "BoothGuide", "--detach").strip()
        watch, seen = self.follow("runs", run, "--watch")
        self.wait_until_it_listens(watch)
        self.server.kill()
        seen("the connection was lost")
        time.sleep(2)
        self.server.start()
        time.sleep(2)
        self.server.command("runs", "--cancel", run)
        watch.wait(60)
        self.assertIn("cancelled on request", seen("cancelled"))

    def test_watch_goes_on_after_the_server_was_away(self):
        watch, seen = self.follow("watch", "--count", "3",
                                  "SELECT ?where { <https://w3id.org/docent/expo#John> docent:isAt ?where }")
        seen("Entrance")
        self.server.tell(readings=[("expo:B01Beacon", "tag-17")])
        seen("B01")
        self.server.kill()
        seen("the connection was lost")
        self.server.start()
        watch.wait(60)
        self.assertEqual(watch.returncode, 0)

    def test_several_answers_are_watched_together(self):
        where = "SELECT ?where { <https://w3id.org/docent/expo#John> docent:isAt ?where }"
        file = self.stage.folder / "query.rq"
        file.write_text("ASK { ?nobody a docent:NoSuchThing }")
        done = self.server.run("watch", "--count", "3", where, "--file", str(file), where)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertIn("3  no", lines)
        for number in "12":
            self.assertTrue(any(line.startswith(number + "  + ?where = ") for line in lines), done.stdout)

    def test_what_has_not_lasted_is_not_told(self):
        where = "SELECT ?where { <https://w3id.org/docent/expo#John> docent:isAt ?where }"
        for at_least_ms, rows in ("0", 1), ("3600000", 0):
            done = self.server.run("watch", "--count", "1", "--at-least-ms", at_least_ms, where)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.count("+ ?where = "), rows, done.stdout)

    def test_bad_questions(self):
        self.assert_refused(self.server.run("why", "ask", "ASK { ?x"), 2, "1:")
        self.assert_refused(self.server.run("why", "expo:John docent:isAt"), 2, "error")
        self.assert_refused(self.server.run("whatif"), 2, "no facts given")
        self.assert_refused(self.server.run("watch", "CONSTRUCT WHERE { ?s ?p ?o }"), 2, "ASK and SELECT")
        self.assert_refused(self.server.run("watch", "ASK {}", "ASK {"), 2, "query 2: 1:6")
        self.assert_refused(self.server.run("watch"), 2, "no query given")


if __name__ == "__main__":
    unittest.main()
