#!/usr/bin/env python3
"""Workflows with no bound of their own: the server refuses them or gives them up, and what others send is done."""
import unittest

from docent_e2e import StageTest

HEAD = """<CAWL name="%s" xmlns:docent="https://w3id.org/docent#" xmlns:w="urn:w:"><activator name="A"><activate flow="F"/>
<condition><context name="c"><rule name="r">%s</rule></context></condition></activator>"""
ONE = '<constraint name="%s"><subject>%s</subject><verb>%s</verb><object>%s</object></constraint>'
ANY_PAIR = ONE % ("k", "?a", "?b", "?c") + ONE % ("l", "?d", "?e", "?f")
PAIR = ONE % ("k", "?a", "w:in", "?c") + ONE % ("l", "?d", "w:in", "?f")


def chain(count):
    names = "".join(f'<node name="n{i}"/>' for i in range(count))
    links = "".join(f'<link from="n{i}" to="{f"n{i + 1}" if i + 1 < count else "t"}"/>' for i in range(count))
    return f'<flow name="F"><source name="s"/>{names}<sink name="t"/><link from="s" to="n0"/>{links}</flow></CAWL>'


def document(name, constraints, nodes=1):
    return HEAD % (name, constraints) + chain(nodes)


def facts(count, predicate="in"):
    return " . ".join(f"<urn:w:x{i}> <urn:w:{predicate}> <urn:w:y{i}>" for i in range(count))


class Bounds(StageTest):
    def load(self, server, text):
        file = self.file("w.cawl.xml", text)
        return server.run("load", file)

    def goes_on(self, server, word):
        server.tell(f"<urn:w:one> <urn:w:says> <urn:w:{word}>")
        self.assertTrue(server.ask(f"<urn:w:one> <urn:w:says> <urn:w:{word}>"))

    def test_what_its_own_runs_start_again_is_refused(self):
        server = self.stage.server()
        server.tell(facts(300))
        refused = self.load(server, document("Any", ANY_PAIR))
        self.assert_refused(refused, refused.returncode or 1, "Any", "limit")
        self.goes_on(server, "a")
        server.kill()
        server.start()
        self.goes_on(server, "b")
        self.assertFalse(server.ask("?run docent:runState ?state"))

    def test_a_condition_that_comes_to_match_too_much_is_given_up(self):
        server = self.stage.server()
        self.assertEqual(self.load(server, document("Pairs", PAIR)).returncode, 0)
        server.tell(facts(400))
        self.goes_on(server, "a")
        self.assertEqual(server.metrics()["docent_conditions"], 0)
        server.kill()
        server.start()
        server.tell(facts(500))
        self.goes_on(server, "b")
        self.assertEqual(server.metrics()["docent_conditions"], 0)

    def test_runs_that_go_on_later_do_so_after_a_crash(self):
        server = self.stage.server()
        self.assertEqual(self.load(server, document("W", ONE % ("k", "?a", "w:in", "?b"), 3000)).returncode, 0)
        server.tell(facts(20))
        server.kill()
        server.start()
        self.goes_on(server, "a")
        server.wait_for("{ SELECT (COUNT(?run) AS ?n) { ?run docent:runState 'done' } } FILTER(?n = 20)", 120)


if __name__ == "__main__":
    unittest.main()
