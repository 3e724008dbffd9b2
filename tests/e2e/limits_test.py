#!/usr/bin/env python3
"""What docent check passes, a server loads: documents beyond each limit that a document can break, one row a limit."""
import gzip
import unittest

from docent_e2e import StageTest

PREFIX = "PREFIX : <http://e/>\n"
LITERAL_OVER = '"%s"' % ("x" * (1024 * 1024 + 1))
CAWL = ('<CAWL name="%s" xmlns:e="http://e/" xmlns:docent="https://w3id.org/docent#" '
        'xmlns:ext="https://w3id.org/docent/cawl-ext#">%s<flow name="F"><source name="s"/>%s<sink name="t"/></flow></CAWL>')
NODE = '<node name="N">%s</node><link from="s" to="N"/><link from="N" to="t"/>'


def rule(body, head="?x :p ?y"):
    return f"RULE {{ {head} }} WHERE {{ {body} }}\n"


def values(variable, count):
    return f"VALUES ?{variable} {{ {' '.join(f':{variable}{i}' for i in range(count))} }}"


def constraints(count):
    return "".join(f'<constraint name="k{i}"><subject>?x</subject><verb>e:p{i}</verb><object>?y</object></constraint>'
                   for i in range(count))


def condition(inside):
    return f'<condition><context name="c"><rule name="r">{inside}</rule></context></condition>'


def process(name, inside):
    return f'<process name="{name}">{inside}</process>'


def rsel(inside):
    return f'<rsel name="D">{inside}</rsel>'


INVOKE = '<invoke operation="o"/>'
# file name, text, and the limit that check and load name; None: both take it.
ROWS = [
    ("nesting.rules", lambda: PREFIX + rule("{" * 101 + "?x :q ?y" + "}" * 101), "query_nesting"),
    ("elements.rules", lambda: PREFIX + rule("?x :q ?y " + " ".join(f"FILTER(?y != {i})" for i in range(4001))), "query_elements"),
    ("patterns33.rules", lambda: PREFIX + rule(" . ".join(f"?x :q{i} ?y" for i in range(33))), None),
    ("patterns.rules", lambda: PREFIX + rule(" . ".join(f"?x :q{i} ?y" for i in range(10001))), "rule_patterns"),
    ("regex.rules", lambda: PREFIX + rule('?x :q ?y FILTER REGEX(?y, "(a{1,1000}){1,1000}")'), "regex_instructions"),
    ("rounds.rules", lambda: PREFIX + "DATA { :a :n 0 }\n" + rule("?x :n ?n BIND(?n + 1 AS ?m) FILTER(?m < 20000)", "?x :n ?m"), "rule_rounds"),
    ("steps.rules", lambda: PREFIX + rule(f"{values('x', 1500)} {values('z', 1500)} {values('w', 1500)} FILTER(?x = ?z && ?w = ?x) BIND(:y AS ?y)"), "steps_per_turn"),
    ("chain.rules", lambda: PREFIX + "".join(rule(f"?x :p{i} ?y", f"?x :p{i + 1} ?y") for i in range(2000)), None),
    ("document.rules", lambda: PREFIX + "#" + "x" * (64 << 20), "document_bytes"),
    ("packed.rules.gz", lambda: gzip.compress(b"#" + b"x" * (64 << 20)), "document_bytes"),
    ("name\n.rules", lambda: PREFIX + rule("?x :q ?y"), "control character"),
    ("term.ttl", lambda: f"<http://e/a> <http://e/p> {LITERAL_OVER} .", "term_bytes"),
    ("nesting.ttl", lambda: "<http://e/a> <http://e/p> " + "(" * 257 + ")" * 257 + " .", "turtle_nesting"),
    ("year.ttl", lambda: '<http://e/a> <http://e/p> "999999999999-01-01T00:00:00Z"^^<http://www.w3.org/2001/XMLSchema#dateTime> .', None),
    ("nesting.rdf", lambda: '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:e="http://e/">'
     + "<e:D><e:p>" * 2100 + "<e:D/>" + "</e:p></e:D>" * 2100 + "</rdf:RDF>", "rdf_xml_nesting"),
    ("attributes.rdf", lambda: '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:e="http://e/"><e:D '
     + " ".join(f'e:a{i}="1"' for i in range(1025)) + "/></rdf:RDF>", "xml_attributes"),
    ("elements.cawl.xml", lambda: CAWL % ("W", "", "".join(f'<node name="N{i}"/><link from="s" to="N{i}"/><link from="N{i}" to="t"/>'
                                                         for i in range(34000))), "xml_elements"),
    ("nesting.cawl.xml", lambda: CAWL % ("W", "", NODE % ("<condition>" * 70 + "</condition>" * 70)), "xml_nesting"),
    ("parts.cawl.xml", lambda: CAWL % ("W", "", NODE % condition(constraints(10001))), "condition_parts"),
    ("fewer.cawl.xml", lambda: CAWL % ("W", "", NODE % condition(constraints(500))), None),
    ("name.cawl.xml", lambda: CAWL % ("W" * 257, "", NODE % ""), "name_bytes"),
    ("folder.cawl.xml", lambda: CAWL % ("..", "", NODE % ""), "another folder"),
    ("steps.rsel.xml", lambda: rsel(process("P", INVOKE * 1001)), "plan_steps"),
    ("nesting.rsel.xml", lambda: rsel("".join(process(f"P{i}", f'<invoke operation="P{i + 1}"/>') for i in range(34)) + process("P34", INVOKE)), "process_nesting"),
    ("all.rsel.xml", lambda: rsel(process("Q", INVOKE * 1000) + "".join(process(f"P{i}", '<invoke operation="Q"/>') for i in range(300))), "all_plan_steps"),
    ("folder.rsel.xml", lambda: rsel(process("..", INVOKE)), "another folder"),
]


class Limits(StageTest):
    def test_check_and_load_say_the_same_of_each_limit(self):
        server = self.stage.server()
        for name, text, limit in ROWS:
            with self.subTest(name):
                path = self.stage.folder / name
                made = text()
                path.write_bytes(made if isinstance(made, bytes) else made.encode())
                check = self.docent("check", path)
                load = server.run("load", path)
                self.assertNotIn("Traceback", check.stderr)
                if limit is None:
                    self.assertEqual((check.returncode, load.returncode), (0, 0), check.stderr + load.stderr)
                    continue
                self.assertNotEqual(check.returncode, 0, check.stdout + check.stderr[:2000])
                self.assertNotEqual(load.returncode, 0, load.stdout)
                self.assertIn(limit, check.stderr)
                self.assertIn(limit, load.stderr)
        self.assertTrue(server.process.running())

    def test_rules_that_only_their_facts_make_too_much_are_refused_by_both(self):
        facts = self.file("facts.ttl", "@prefix : <http://e/> .\n:a :n 0 .\n")
        rules = self.file("count.rules", PREFIX + rule("?x :n ?n BIND(?n + 1 AS ?m) FILTER(?m < 20000)", "?x :n ?m"))
        check = self.docent("check", facts, rules)
        self.assertEqual(check.returncode, 1, check.stdout + check.stderr)
        self.assertIn("count.rules:2:1: error: a server refuses to load this: count.rules rule 1 (line 2)", check.stderr)
        self.assertIn("rule_rounds = 10000", check.stderr)
        server = self.stage.server()
        self.assertEqual(server.run("load", facts).returncode, 0)
        load = server.run("load", rules)
        self.assertNotEqual(load.returncode, 0)
        self.assertIn("count.rules rule 1 (line 2)", load.stderr)
        self.assertEqual(self.docent("check", rules).returncode, 0, "without the facts it is good")


if __name__ == "__main__":
    unittest.main(verbosity=2)
