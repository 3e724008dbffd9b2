#!/usr/bin/env python3
"""Activators: events count each time they are told, and a document that is loaded again fires nothing again."""
import time
import unittest
import urllib.request

from docent_e2e import StageTest

HEAD = """<CAWL name="%s" xmlns:docent="https://w3id.org/docent#" xmlns:ext="https://w3id.org/docent/cawl-ext#">
"""
FLOW = """<flow name="%s"><source name="s"/><node name="N"/><sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow>
</CAWL>
"""
BELL = HEAD % "Bell" + """<activator name="A"><activate flow="Answer"/>
<condition><case><event operation="doorbell"/></case></condition></activator>""" + FLOW % "Answer"
AROUND = """<CAWL name="Around"><flow name="F"><source name="s"/><node name="A"><invoke subflow="Stays"/></node>
<sink name="e"/><link from="s" to="A"/><link from="A" to="e"/></flow></CAWL>
"""
STAYS = HEAD % "Stays" + """<activator name="A"><activate flow="Serve"/><condition><context name="C"><rule name="r" ext:for="%s">
<constraint name="at"><subject>?who</subject><verb>docent:isAt</verb><object>?where</object></constraint>
</rule></context></condition></activator>""" + FLOW % "Serve"
RING = "a docent:Event ; docent:operation 'doorbell'"


class Activators(StageTest):
    def runs(self, server, flow):
        return len(server.select(f"SELECT ?run {{ ?run docent:flow '{flow}' ; docent:runState ?state }}"))

    def wait_for_runs(self, server, flow, count):
        server.wait_for(f"{{ SELECT (COUNT(?run) AS ?n) {{ ?run docent:flow '{flow}' ; docent:runState ?s }} }} FILTER(?n >= {count})")
        self.assertEqual(self.runs(server, flow), count)

    def put(self, server, method, graph, body):
        request = urllib.request.Request(f"http://{server.http}/rdf-graphs?graph={graph}", body.encode(),
                                         {"Content-Type": "text/turtle"}, method=method)
        urllib.request.urlopen(request, timeout=30).read()

    def test_each_telling_of_an_event_is_an_occurrence(self):
        server = self.stage.server()
        server.load(self.file("bell.cawl.xml", BELL))
        for _ in range(3):
            server.tell(f"[] {RING}")
        self.wait_for_runs(server, "Answer", 3)
        for source in ("urn:x:Door", "urn:x:Camera"):
            server.tell(f"<urn:x:ring> {RING}", source=source)
        self.wait_for_runs(server, "Answer", 5)
        for _ in range(2):
            server.command("update", f"PREFIX docent: <https://w3id.org/docent#> INSERT DATA {{ <urn:x:ring> {RING} }}")
        self.wait_for_runs(server, "Answer", 7)
        server.command("update", f"PREFIX docent: <https://w3id.org/docent#> INSERT DATA {{ <urn:x:1> {RING} . <urn:x:2> {RING} }}")
        self.wait_for_runs(server, "Answer", 9)
        turtle = f"@prefix docent: <https://w3id.org/docent#> . <urn:x:ring> {RING} ."
        for method in ("POST", "POST", "PUT", "PUT"):
            self.put(server, method, "urn:x:g", turtle)
        self.wait_for_runs(server, "Answer", 13)
        server.command("tell", "--lifetime-ms", "60000", f"<urn:x:ring> {RING}")
        self.wait_for_runs(server, "Answer", 14)
        server.wait_for("FILTER NOT EXISTS { ?e a docent:Event }", 20)
        self.assertFalse(server.ask("?e docent:operation 'doorbell'"))
        server.kill()
        server.start()
        self.assertEqual(self.runs(server, "Answer"), 14)
        self.assertFalse(server.ask("?e a docent:Event"))
        server.tell(f"<urn:x:ring> {RING}")
        self.wait_for_runs(server, "Answer", 15)

    def test_a_document_that_is_loaded_again_fires_nothing_again(self):
        server = self.stage.server()
        server.load(self.file("stays.cawl.xml", STAYS % "2s"))
        server.tell("<urn:x:John> docent:isAt <urn:x:B1>")
        self.wait_for_runs(server, "Serve", 1)
        server.load(self.file("stays.cawl.xml", STAYS % "2s"))
        server.load(self.file("another.cawl.xml", "<!-- layout -->\n" + (STAYS % "2s").replace("<rule", "\n  <rule")))
        server.kill()
        server.start()
        server.load(self.file("stays.cawl.xml", STAYS % "2s"))
        time.sleep(3)
        self.assertEqual(self.runs(server, "Serve"), 1)
        server.tell("<urn:x:Ann> docent:isAt <urn:x:B1>")
        for _ in range(8):
            server.load(self.file("stays.cawl.xml", STAYS % "2s"))
            time.sleep(0.4)
        self.assertEqual(self.runs(server, "Serve"), 2, "loading again does not put off what is pending")

    def test_versions_undeploy_and_disable(self):
        server = self.stage.server()
        for time_text in ("2s", "2s", "3s", "1s"):
            server.load(self.file("stays.cawl.xml", STAYS % time_text))
        self.assertEqual(server.command("workflows", "show", "Stays", "--version", "2"), STAYS % "3s")
        self.assertIn('ext:for="1s"', server.command("workflows", "show", "Stays"))
        self.assertIn('+<activator name="A"><activate flow="Serve"/><condition><context name="C"><rule name="r" ext:for="1s">',
                      server.command("workflows", "diff", "Stays"))
        self.assertIn('-<activator name="A"><activate flow="Serve"/><condition><context name="C"><rule name="r" ext:for="2s">',
                      server.command("workflows", "diff", "Stays", "1", "3"))
        self.assert_refused(server.run("workflows", "show", "Stays", "--version", "9"), 2, "no version 9", "1, 2, 3")
        for command in ("undeploy", "enable", "disable", "show", "versions"):
            self.assert_refused(server.run("workflows", command, "Stay"), 2, "did you mean Stays?")
        server.command("workflows", "disable", "Stays")
        server.kill()
        server.start()
        server.tell("<urn:x:John> docent:isAt <urn:x:B1>")
        time.sleep(2)
        self.assertEqual(self.runs(server, "Serve"), 0)
        self.assert_refused(server.run("run", "Stays", "--detach"), 2, "is disabled")
        self.assertIn("disabled", server.command("workflows"))
        server.command("workflows", "enable", "Stays")
        self.wait_for_runs(server, "Serve", 1)
        server.load(self.file("around.cawl.xml", AROUND))
        gone = server.run("workflows", "undeploy", "Stays", "--cancel-runs")
        self.assertEqual(gone.returncode, 0)
        self.assertIn("workflow Around invokes Stays", gone.stderr)
        server.command("workflows", "undeploy", "Around")
        self.assertNotIn("Stays", server.command("workflows"))
        self.assertIn("3", server.command("workflows", "versions", "Stays"))
        server.load(self.file("stays.cawl.xml", STAYS % "5s"))
        self.assertEqual(server.command("workflows", "show", "Stays", "--version", "4"), STAYS % "5s")

    def test_modes(self):
        server = self.stage.server()
        waits = HEAD % "Bell" + """<activator name="A" ext:mode="%s"><activate flow="Answer"/>
<condition><case><event operation="doorbell"/></case></condition></activator>
<flow name="Answer"><source name="s"/><node name="N"><condition><context name="C"><rule><constraint>
<subject>&lt;urn:x:Door&gt;</subject><verb>docent:isAt</verb><object>&lt;urn:x:Open&gt;</object></constraint></rule></context></condition></node>
<sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>
"""
        server.load(self.file("bell.cawl.xml", waits % "single"))
        for _ in range(3):
            server.tell(f"[] {RING}")
        self.wait_for_runs(server, "Answer", 1)
        server.wait_for("?w docent:ignoredFirings 2")
        server.kill()
        server.start()
        server.load(self.file("bell.cawl.xml", waits % "queued"))
        for _ in range(2):
            server.tell(f"[] {RING}")
        server.wait_for("?w docent:waitingFirings 2")
        server.tell("<urn:x:Door> docent:isAt <urn:x:Open>")
        self.wait_for_runs(server, "Answer", 3)
        server.wait_for("FILTER NOT EXISTS { ?run docent:runState 'running' }")


if __name__ == "__main__":
    unittest.main()
