#!/usr/bin/env python3
"""Which robot gets what: an operation asked for by its class, and robots that are reserved, over a kill of the server; each from the command
line, and each explained there."""
import unittest

from docent_e2e import PATIENCE_S, StageTest, nodes, stage

EXPO = "https://w3id.org/docent/expo#"
CAPABLE = """<CAWL name="Welcome" version="1.0" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Welcome">
    <source name="begin"/>
    <node name="Speak"><invoke ext:capability="docent:SpeechSynthesis"/></node>
    <sink name="end"/>
    <link from="begin" to="Speak"/>
    <link from="Speak" to="end"/>
  </flow>
</CAWL>
"""
TOUR = """<CAWL name="Tour" version="1.0">
  <flow name="Tour">
    <source name="begin"/>
    <node name="Show"><invoke operation="show"/></node>
    <sink name="end"/>
    <link from="begin" to="Show"/>
    <link from="Show" to="end"/>
  </flow>
</CAWL>
"""


class Choice(StageTest):
    def prepare(self, name, text):
        server = self.stage.server()
        stage.load_ontology(server)
        server.load(self.file(name, text))
        return server

    def adapter(self, server, name, *arguments):
        process = self.stage.start(name, [self.stage.bin / "docent-scripted-adapter", "--server", server.grpc, "--robot", EXPO + name,
                                          "--journal", self.stage.folder / f"{name}.journal", *arguments])
        server.wait_for(f"<{EXPO}{name}> docent:offers ?o", PATIENCE_S)
        return process

    def test_an_operation_of_a_class_below_serves(self):
        server = self.prepare("welcome.cawl.xml", CAPABLE)
        run = server.command("run", "Welcome", "--detach").strip()
        self.adapter(server, "R01", "--operation", "drive", "--capability", "drive=docent:Navigation")
        self.assertIn("no robot that is online offers an operation of class", server.command("whynot", "--run", run))
        self.adapter(server, "R02", "--operation", "chatter", "--capability", "chatter=docent:SpeechWithGesture")
        self.wait_for_run(server)
        self.assertIn("chatter", server.command("runs", run))
        self.assertIn("docent:SpeechWithGesture", server.command("robots"))
        server.wait_for(f"<{EXPO}R02> docent:hasCapability docent:SpeechWithGesture", PATIENCE_S)

    def test_a_robot_that_ends_in_order_gets_nothing_more(self):
        server = self.prepare("tour.cawl.xml", TOUR)
        leaving = self.adapter(server, "R01", "--operation", "show")
        leaving.stop()
        self.assertIn("offline", server.command("robots"))
        self.assertTrue(server.ask(f"<{EXPO}R01> docent:status docent:Offline ; docent:lastSeenAt ?at"))
        self.adapter(server, "R02", "--operation", "show")
        server.command("run", "Tour", "--detach")
        self.wait_for_run(server)
        robots = server.select("SELECT DISTINCT ?robot { ?invocation a docent:Invocation ; docent:robot ?robot }")
        self.assertEqual([row["robot"] for row in robots], ["expo:R02"])

    def test_a_reserved_robot_is_kept_over_a_kill(self):
        server = self.prepare("tour.cawl.xml", TOUR)
        self.adapter(server, "R07", "--operation", "show", "--idempotent")
        said = server.command("robots", "reserve", EXPO + "R07", "--lasting", "12s", "--reason", "a visit of the mayor")
        self.assertIn("is reserved: operator-", said)
        run = server.command("run", "Tour", "--detach").strip()
        self.assertIn("a visit of the mayor", server.command("robots"))
        self.assertIn("is reserved until", server.command("whynot", "--run", run))
        server.kill()
        server.start()
        self.assertIn("is reserved until", server.command("whynot", "--run", run))
        self.assertEqual(nodes(server)["Show"]["state"], "running")
        self.wait_for_run(server)
        self.assertNotIn("a visit of the mayor", server.command("robots"))

    def test_a_release_frees_the_robot(self):
        server = self.prepare("tour.cawl.xml", TOUR)
        self.adapter(server, "R07", "--operation", "show")
        said = server.command("robots", "reserve", EXPO + "R07", "--lasting", "1h", "--priority", "5")
        reservation = next(word for word in said.replace(",", " ").split() if word.startswith("operator-"))
        run = server.command("run", "Tour", "--detach").strip()
        self.assertIn("with priority 5", server.command("whynot", "--run", run))
        self.assertIn("is released", server.command("robots", "release", reservation))
        self.wait_for_run(server)
        self.assert_refused(server.run("robots", "release", reservation), 2, "no reservation")
        self.assert_refused(server.run("robots", "reserve", EXPO + "R07"), 2, "no end")
        self.assert_refused(server.run("robots", "reserve", EXPO + "R99", "--lasting", "1h"), 2, "R99")
        self.assert_refused(server.run("robots", "reserve", EXPO + "R07", "--for", "Nothing"), 2, "Nothing")
        self.assert_refused(server.run("robots", "reserve", EXPO + "R07", "--until", "2001-01-01T00:00:00Z"), 2, "past")
        self.assert_refused(server.run("robots", "reserve", EXPO + "R07", "--lasting", "soon"), 2, "soon")


if __name__ == "__main__":
    unittest.main()
