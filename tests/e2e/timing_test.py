#!/usr/bin/env python3
"""Times as triggers with real processes: intervals, hours, delays, a trigger of the graph for a rule; a restart fires nothing twice."""
import time
import unittest

from docent_e2e import PATIENCE_S, StageTest

HEAD = '<CAWL name="{0}" xmlns:ext="https://w3id.org/docent/cawl-ext#" xmlns:docent="https://w3id.org/docent#">'
FLOW = """<flow name="{0}"><source name="s"/><node name="N">{1}</node><sink name="e"/>
<link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>"""


def activator(name, context):
    return (HEAD.format(name) + f'<activator name="A"><activate flow="{name}"/><condition><context>{context}</context>'
            '</condition></activator>' + FLOW.format(name, ""))


def node(name, context):
    return HEAD.format(name) + FLOW.format(name, f"<condition><context>{context}</context></condition>")


class Timing(StageTest):
    def runs(self, server, flow):
        return len(server.select(f'SELECT ?run {{ ?run docent:runState ?s ; docent:flow "{flow}" }}'))

    def test_times_start_runs_and_open_nodes(self):
        server = self.stage.server()
        server.load(self.file("often.cawl.xml", activator("Often", '<ext:time every="1s"/>')),
                    self.file("always.cawl.xml", node("Always", '<ext:time between="00:00-24:00" zone="Asia/Tokyo"/>')),
                    self.file("never.cawl.xml", node("Never", '<ext:time from="2001-01-01" until="2001-01-02"/>')),
                    self.file("later.cawl.xml", node("Later", '<ext:time after="2s"/>')))
        for flow in ("Always", "Never", "Later"):
            server.command("run", flow, "--detach")
        server.wait_for('?run docent:flow "Always" ; docent:runState "done"', PATIENCE_S)
        server.wait_for('?run docent:flow "Later" ; docent:runState "done"', PATIENCE_S)
        self.assertFalse(server.ask('?run docent:flow "Never" ; docent:runState "done"'))
        took = server.select("""SELECT ?ms { ?run docent:flow "Later" ; prov:startedAtTime ?from ; prov:endedAtTime ?to
            BIND (?to - ?from AS ?ms) }""")
        self.assertGreaterEqual(took[0]["ms"], "PT2")
        server.wait_for('?a docent:flow "Often" . ?b docent:flow "Often" FILTER(?a != ?b)', PATIENCE_S)

    def test_a_restart_fires_nothing_twice_and_what_was_missed_once(self):
        server = self.stage.server()
        server.load(self.file("often.cawl.xml", activator("Often", '<ext:time every="2s"/>')))
        server.wait_for('?run docent:flow "Often"', PATIENCE_S)
        server.stop()
        time.sleep(7)  # three intervals
        server.start()
        server.wait_for('?trigger docent:lastOccurrence ?last', PATIENCE_S)
        time.sleep(0.5)
        times = [row["t"] for row in server.select(
            'SELECT ?t { ?run docent:flow "Often" ; prov:startedAtTime ?t } ORDER BY ?t')]
        self.assertEqual(len(times), len(set(times)))
        self.assertLessEqual(len(times), 4, "one late run for all intervals that were missed, and one that may be due since")

    def test_a_trigger_of_the_graph_is_a_fact_for_a_rule(self):
        server = self.stage.server()
        server.load(self.file("night.rules", """PREFIX docent: <https://w3id.org/docent#>
            RULE { ?robot <urn:volume> "soft" } WHERE { <urn:Night> docent:timeHolds true . ?robot a docent:Robot }"""))
        server.tell('<urn:R1> a docent:Robot . <urn:Night> a docent:TimeTrigger ; docent:between "00:00-24:00"')
        server.wait_for('<urn:R1> <urn:volume> "soft"', PATIENCE_S)
        server.tell('<urn:Night> docent:validFrom "2999-01-01"')
        server.wait_for('<urn:Night> docent:timeHolds false FILTER NOT EXISTS { <urn:R1> <urn:volume> ?v }', PATIENCE_S)

    def test_check_names_times_that_can_never_be(self):
        done = self.docent("check", self.file("bad.cawl.xml", node(
            "Bad", '<ext:time from="2027-02-31"/><ext:time at="10:00" zone="Europe/Berln"/>')))
        self.assertEqual(done.returncode, 1)
        for words in ("can never be: the month has no day 31", "did you mean Europe/Berlin?"):
            self.assertIn(words, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
