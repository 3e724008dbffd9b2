#!/usr/bin/env python3
"""What an operator does at night: pause and resume over a kill of the server, an incident settled on another robot, a robot
taken out of service, a run cancelled that undoes what it did; each from the command line, and each explained there."""
import unittest

from docent_e2e import PATIENCE_S, StageTest, nodes, stage

EXPO = "https://w3id.org/docent/expo#"
WHILE_OPERATOR_ACTS_MS = "4000"  # of a command: the operator's programs start slowly on a busy machine
WORKFLOW = """<CAWL name="Night" version="1.0" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Night">
    <source name="begin"/>
    <node name="Fetch" ext:onFailure="incident" ext:compensate="bringBack"><invoke operation="fetch"/></node>
    <node name="Show"><invoke operation="show"/></node>
    <sink name="end"/>
    <link from="begin" to="Fetch"/>
    <link from="Fetch" to="Show"/>
    <link from="Show" to="end"/>
  </flow>
</CAWL>
"""


class Steering(StageTest):
    def night(self):
        server = self.stage.server()
        stage.load_ontology(server)
        server.load(self.file("night.cawl.xml", WORKFLOW))
        return server

    def adapter(self, server, name, *arguments, operations=("fetch", "show", "bringBack")):
        given = [word for operation in operations for word in ("--operation", operation)]
        process = self.stage.start(name, [self.stage.bin / "docent-scripted-adapter", "--server", server.grpc, "--robot", EXPO + name,
                                          "--journal", self.stage.folder / f"{name}.journal", *given, *arguments])
        server.wait_for(f"<{EXPO}{name}> docent:offers ?o", PATIENCE_S)
        return process

    def begin(self, server):
        return server.command("run", "Night", "--detach").strip()

    def wait_for_node(self, server, node, state):
        stage.wait_until(lambda: nodes(server).get(node, {}).get("state") == state, PATIENCE_S, f"{node} {state}")

    def test_a_pause_outlives_a_kill(self):
        server = self.night()
        self.adapter(server, "R07", "--take-ms", WHILE_OPERATOR_ACTS_MS)
        run = self.begin(server)
        self.wait_for_node(server, "Fetch", "running")
        done = server.run("runs", "pause", run, "--reason", "the floor is wet")
        self.assertIn(f"paused {run}", done.stdout)
        self.assertIn(f"{run} still does Fetch to the end; --cancel-commands ends it", done.stderr)
        self.assertIn("paused already", server.run("runs", "pause", run).stderr)
        server.kill()
        server.start()
        self.wait_for_node(server, "Fetch", "done")
        self.assertEqual(nodes(server)["Show"]["state"], "waiting")
        self.assertIn("paused", server.command("runs", "--state", "paused"))
        self.assertIn("the floor is wet", server.command("whynot", "--run", run))
        self.assertIn(f"resumed {run}", server.command("runs", "resume", run))
        self.assertIn("is not paused", server.run("runs", "resume", run).stderr)
        self.wait_for_run(server)
        self.assertIn("done", server.command("whynot", "--run", run))
        self.assert_refused(server.run("runs", "pause", run), 2, run)

    def test_an_incident_is_settled_on_another_robot(self):
        server = self.night()
        self.adapter(server, "R07", "--fail")
        run = self.begin(server)
        self.wait_for_node(server, "Fetch", "incident")
        self.assertIn("incident", server.command("runs", "--state", "incident"))
        self.assertIn("docent runs retry", server.command("whynot", "--run", run))
        self.adapter(server, "R08", "--take-ms", WHILE_OPERATOR_ACTS_MS)
        server.command("runs", "retry", run, "--robot", EXPO + "R08", "--reason", "R07 is stuck")
        self.wait_for_node(server, "Fetch", "done")
        self.assert_refused(server.run("runs", "retry", run, "Fetch"), 2, "no incident")

    def test_a_command_whose_run_has_failed_is_not_sent(self):
        """The first of two commands for one robot fails, so the run ends in the turn in which the second one would go out."""
        server = self.stage.server()
        stage.load_ontology(server)
        server.load(self.file("night.cawl.xml", """<CAWL name="Night"><flow name="Night"><source name="begin"/>
          <node name="Both"><invoke operation="fetch"/><invoke operation="show"/></node><sink name="end"/>
          <link from="begin" to="Both"/><link from="Both" to="end"/></flow></CAWL>"""))
        self.adapter(server, "R07", "--fail")
        runs = []
        for _ in range(2):  # the second run shows that nothing of the first is under way
            runs.append(self.begin(server))
            stage.wait_until(lambda: "Night" not in server.command("runs", "--live"), PATIENCE_S, f"{runs[-1]} to fail")
        lines = [line.split("\t") for line in (self.stage.folder / "R07.journal").read_text().splitlines()]
        begun = [fields[3].split("@")[0] for fields in lines if fields[0] == "begun"]
        self.assertEqual(begun, [f"{run}/Both/0/0.1/1/1" for run in runs])

    def test_a_robot_whose_facts_are_cleared_is_back_with_its_next_join(self):
        server = self.night()
        self.adapter(server, "R07")
        server.command("update", "CLEAR ALL")
        server.wait_for(f"<{EXPO}R07> docent:offers ?o ; docent:status docent:Standby", PATIENCE_S)
        self.begin(server)
        self.wait_for_run(server)

    def test_what_goes_on_though_an_operator_steers_is_said(self):
        server = self.night()
        server.load(self.file("night.cawl.xml", WORKFLOW.replace('<flow name="Night">', '<flow name="Night"><variable name="who"/>')))
        robot = self.adapter(server, "R07", "--take-ms", "600000")
        run = self.begin(server)
        stage.wait_until(lambda: "/Fetch" in server.command("robots"), PATIENCE_S, "the command")
        self.assertIn("who: what runs already goes on with the former value (Fetch)", server.run("runs", "set", run, "who=7").stderr)
        for arguments in ([run], [run, "Fetch"]):
            self.assert_refused(server.run("runs", "retry", *arguments), 2, "no incident", "docent robots out ROBOT --cancel-commands")
        self.assertIn("ext:retry-other-robot", server.run("runs", "retry", run, "Fetch").stderr)
        said = server.run("robots", "out", EXPO + "R07", "--reason", "a wheel squeaks").stderr
        self.assertRegex(said, rf"it still does {run}/Fetch .*; --cancel-commands ends it")
        robot.kill()
        server.wait_for(f"<{EXPO}R07> docent:status docent:Offline", PATIENCE_S)
        said = server.run("robots", "out", EXPO + "R07", "--cancel-commands").stderr
        self.assertRegex(said, rf"{run}/Fetch .* is asked to stop; .*R07>, which is offline \(last seen .*\), has not yet confirmed it")
        self.assertRegex(server.command("runs", run), r"asked to stop, and its robot has not yet confirmed it: its robot was taken out of service")
        self.assertRegex(server.command("whynot", "--run", run), r"R07.*, which is offline \(last seen .*\), which is out of service \(a wheel squeaks\).*asked to stop")
        said = server.run("runs", "pause", run, "--cancel-commands").stderr
        self.assertIn("has not yet confirmed it", said)
        self.assertRegex(server.command("runs", "cancel", run), r"asked to stop, and its robot has not yet confirmed it")
        self.assertRegex(server.command("whynot", "--run", run), r"not yet confirmed: the end of command .*R07.*, which is offline")
        self.assertIn("a wheel squeaks", server.command("robots"))  # a reason that is not given erases none
        server.command("robots", "out", EXPO + "R07", "--reason", "it is gone")
        self.assertIn("it is gone", server.command("robots"))

    def test_a_robot_out_of_service_gets_no_command(self):
        server = self.night()
        self.adapter(server, "R07", "--idempotent")
        server.command("robots", "out", EXPO + "R07", "--reason", "a wheel squeaks")
        self.assertIn("a wheel squeaks", server.command("robots"))
        run = self.begin(server)
        server.kill()
        server.start()
        said = server.command("whynot", "--run", run, "--node", "Fetch")
        self.assertIn("a wheel squeaks", said)
        self.assertEqual(nodes(server)["Fetch"]["state"], "running")
        self.assert_refused(server.run("robots", "out", EXPO + "R99"), 2, "R99")
        self.assert_refused(server.run("robots", "out", "hotel:R07"), 2, "no robot <hotel:R07>", "--prefix hotel=IRI")
        server.command("robots", "in", EXPO + "R07")
        self.wait_for_run(server)

    def test_a_cancelled_run_undoes_what_it_did(self):
        server = self.night()
        self.adapter(server, "R07", "--take-ms", WHILE_OPERATOR_ACTS_MS)
        run = self.begin(server)
        self.wait_for_node(server, "Show", "running")
        server.command("runs", "cancel", run, "--compensate", "--reason", "fire drill")
        server.wait_for(f"<urn:docent:run:{run}> docent:runState 'cancelled'", PATIENCE_S)
        said = server.run("runs", run).stdout
        self.assertIn("fire drill; what it did was undone", said)
        self.assertIn("bringBack", (self.stage.folder / "R07.journal").read_text())


if __name__ == "__main__":
    unittest.main()
