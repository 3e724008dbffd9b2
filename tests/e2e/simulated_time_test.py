#!/usr/bin/env python3
"""docent serve --simulated-clock: time stands still until the file says a later one, for workflows, facts and commands;
leases of adapters go by real time; output, log, metrics and graph say that the time is simulated."""
import time
import unittest

from docent_e2e import PATIENCE_S, StageTest, nodes, stage

HEAD = '<CAWL name="{0}" xmlns:ext="https://w3id.org/docent/cawl-ext#" xmlns:docent="https://w3id.org/docent#">'
FLOW = '<flow name="{0}"><source name="s"/>{1}<sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>'
DAY = "2026-05-12T"


def later(name, inside):
    return HEAD.format(name) + FLOW.format(name, f'<node name="N">{inside}</node>')


class SimulatedTime(StageTest):
    def open(self, at="09:00:00"):
        self.clock = self.stage.folder / "clock"
        self.go_to(at)
        return self.stage.server(arguments=["--simulated-clock", self.clock])

    def go_to(self, at):
        new = self.stage.folder / "clock.new"
        new.write_text(f"{DAY}{at}Z\n")
        new.rename(self.clock)

    def now(self, server):
        return server.select("SELECT ?now { BIND(STR(NOW()) AS ?now) }")[0]["now"]

    def test_workflows_wait_for_it(self):
        server = self.open()
        self.assertTrue(server.process.wait_for_output("listening", 1).endswith(" time=simulated"))
        server.load(self.file("later.cawl.xml", later("Later", '<condition><context><ext:time after="8h"/></context></condition>')),
                    self.file("noon.cawl.xml", later("Noon", '<condition><context><ext:time between="12:00-13:00" zone="Europe/Berlin"/></context></condition>')))
        for flow in ("Later", "Noon"):
            server.command("run", flow, "--detach")
        time.sleep(0.5)
        self.assertEqual(self.now(server), DAY + "09:00:00Z")
        self.assertEqual(len(server.select("SELECT ?run { ?run docent:runState 'running' }")), 2)
        due = server.metrics()["docent_next_due_seconds"] - server.metrics()["docent_time_seconds"]
        self.assertEqual(due, 3600, "noon in Berlin comes first")
        self.go_to("10:00:00")
        server.wait_for('?run docent:flow "Noon" ; docent:runState "done" ; prov:endedAtTime "2026-05-12T10:00:00Z"^^xsd:dateTime', PATIENCE_S)
        self.go_to("16:59:59.999999")
        server.wait_for("FILTER(NOW() > '2026-05-12T16:59:59Z'^^xsd:dateTime)", PATIENCE_S)
        time.sleep(0.2)
        self.assertFalse(server.ask('?run docent:flow "Later" ; docent:runState "done"'))
        self.go_to("17:00:00")
        server.wait_for('?run docent:flow "Later" ; docent:runState "done"', PATIENCE_S)

    def test_it_says_that_it_is_simulated_and_goes_on_after_a_kill(self):
        server = self.open()
        server.wait_for("docent:clock docent:simulatedTime true", PATIENCE_S)
        self.assertEqual(server.metrics()["docent_time_is_simulated"], 1)
        self.assertIn("simulated", server.process.output())
        self.go_to("11:30:00")
        server.wait_for("FILTER(NOW() > '2026-05-12T11:00:00Z'^^xsd:dateTime)", PATIENCE_S)
        server.tell("<urn:a> <urn:b> 1")
        server.kill()
        server.start()
        self.assertEqual(self.now(server), DAY + "11:30:00Z")
        server.stop()
        self.go_to("11:00:00")
        refused = self.docent("serve", "--data", server.data, "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", "--simulated-clock", self.clock)
        self.assert_refused(refused, 2, "2026-05-12T11:00:00Z", "2026-05-12T11:30:00Z", "later time")
        missing = self.docent("serve", "--data", server.data, "--simulated-clock", self.stage.folder / "absent")
        self.assert_refused(missing, 2, "absent", "2026-05-12T09:00:00Z")
        server.arguments = []
        server.start()
        server.wait_for("FILTER NOT EXISTS { ?clock docent:simulatedTime true }", PATIENCE_S)
        self.assertIn("simulation", server.process.output())
        self.assertEqual(server.metrics()["docent_time_is_simulated"], 0)

    def test_commands_have_their_time_by_it_and_adapters_their_leases_in_this_world(self):
        server = self.open()
        robot = "https://w3id.org/docent/expo#R07"
        adapter = self.stage.start("adapter", [self.stage.bin / "docent-scripted-adapter", "--server", server.grpc, "--robot", robot,
                                               "--operation", "look", "--take-ms", "60000"])
        server.load(self.file("look.cawl.xml", later("Look", '<invoke operation="look" ext:timeout="10min"/>')))
        server.wait_for(f"<{robot}> docent:status docent:Standby", PATIENCE_S)
        server.command("run", "Look", "--detach")
        server.wait_for('?n docent:nodeName "N" ; docent:nodeState "running"', PATIENCE_S)
        stage.wait_until(lambda: server.metrics()["docent_commands_open"] == 1, PATIENCE_S, "the command")
        self.go_to("09:09:59")
        time.sleep(0.3)
        self.assertEqual(nodes(server)["N"]["state"], "running")
        self.go_to("09:10:01")
        self.wait_for_run(server, "failed")
        stage.wait_until(lambda: server.metrics()["docent_commands_open"] == 0, PATIENCE_S, "its end")
        self.go_to("15:00:00")
        time.sleep(1.5)
        self.assertFalse(server.ask(f"<{robot}> docent:status docent:Offline"), "six hours are no time for its lease")
        adapter.kill()
        server.wait_for(f"<{robot}> docent:status docent:Offline", 30)


if __name__ == "__main__":
    unittest.main()
