#!/usr/bin/env python3
"""Texts of users and robots that would command a terminal: no command prints them as they are, and none makes a line of its own."""
import json
import unittest

from docent_e2e import StageTest, stage

EXPO = "https://w3id.org/docent/expo#"
HOSTILE = "x\x1b]0;title\x07\x1b[31mRED\x1b[2J\u202egnp\u200f\x9b1m\r\nFORGED-1  done"
LINE = HOSTILE.replace("\n", "")
FORBIDDEN = {chr(c) for c in range(0x20) if chr(c) not in "\n\t"} | {chr(c) for c in range(0x7F, 0xA0)} | set("\u202e\u200f")
WORKFLOW = """<CAWL name="W" version="1.0" xmlns:ext="https://w3id.org/docent/cawl-ext#" xmlns:expo="https://w3id.org/docent/expo#">
  <flow name="W">
    <variable name="text"/>
    <source name="begin"/>
    <node name="Wait"><condition><context><rule><constraint>
      <subject>expo:never</subject><verb>expo:is</verb><object>true</object></constraint></rule></context></condition></node>
    <sink name="end"/>
    <link from="begin" to="Wait"/>
    <link from="Wait" to="end"/>
  </flow>
</CAWL>
"""


def in_turtle(text):
    return json.dumps(text)  # its escapes are those of Turtle


class HostileText(StageTest):
    def assert_harmless(self, done, name):
        text = done.stdout + done.stderr
        self.assertFalse(FORBIDDEN & set(text), f"{name}: {text!r}")
        self.assertFalse([line for line in text.split("\n") if line.startswith("FORGED")], f"{name}: {text!r}")

    def test_no_command_prints_them_as_they_are(self):
        server = self.stage.server()
        stage.load_ontology(server)
        server.load(self.file("w.cawl.xml", WORKFLOW))
        facts = f'<{EXPO}R1> a docent:Robot ; rdfs:label {in_turtle(HOSTILE)} ; <{EXPO}says> {in_turtle(HOSTILE)} .'
        server.command("update", f"INSERT DATA {{ {facts} }}")
        first, second = (server.command("run", "W", "--detach", "--var", f"text={in_turtle(HOSTILE)}").strip() for _ in range(2))
        broken = self.file("broken.ttl", f"<urn:a> <urn:b> \x1b[2J\u202e .\n")
        shapes = self.file("shapes.ttl", f"""@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
            [] a sh:NodeShape ; sh:targetSubjectsOf rdfs:label ; sh:property [ sh:path rdfs:label ; sh:maxLength 1 ;
                sh:message {in_turtle(HOSTILE)} ] .""")
        data = self.file("data.ttl", f"<urn:a> <http://www.w3.org/2000/01/rdf-schema#label> {in_turtle(HOSTILE)} .")
        for arguments in (["runs", "pause", first, "--reason", HOSTILE], ["whynot", "--run", first], ["runs", "resume", first],
                          ["runs", "cancel", second, "--reason", HOSTILE], ["runs"], ["runs", first], ["runs", second],
                          ["why", "--run", second], ["whynot", "--run", second], ["runs", "--json"], ["runs", second, "--json"],
                          ["robots", "out", f"<{EXPO}R1>", "--reason", HOSTILE], ["robots"], ["robots", "--json"],
                          ["query", "SELECT ?x { ?r rdfs:label ?x FILTER(CONTAINS(?x, 'title')) }"],
                          ["query", "ASK { <urn:a> <urn:b> \x1b[2J }"], ["why", f"<{EXPO}R1> <{EXPO}says> ?x"],
                          ["whynot", f"<{EXPO}R1> <{EXPO}says> {in_turtle(HOSTILE)}, 1"], ["update", f"INSERT \x1b[2J\u202e"],
                          ["load", broken], ["check", broken], ["validate", "--shapes", shapes, data],
                          ["run", LINE], ["runs", LINE], ["workflows"], ["services"], ["robots", "in", LINE]):
            with self.subTest(arguments=arguments):
                self.assert_harmless(server.run(*arguments), arguments)

    def test_json_means_the_same(self):
        server = self.stage.server()
        server.load(self.file("w.cawl.xml", WORKFLOW))
        run = server.command("run", "W", "--detach", "--var", f"text={in_turtle(HOSTILE)}").strip()
        shown = json.loads(server.command("runs", run, "--json"))
        self.assertEqual(shown["variables"][0]["value"]["literal"]["lexical"], HOSTILE)

    def test_what_a_program_reads_stays_as_it_is(self):
        server = self.stage.server()
        server.command("update", f"INSERT DATA {{ <urn:a> <urn:b> {in_turtle('x' + chr(0x202e) + 'y')} }}")
        self.assertIn("x\u202ey", server.command("query", "--format", "csv", "SELECT ?x { <urn:a> <urn:b> ?x }"))


if __name__ == "__main__":
    unittest.main()
