#!/usr/bin/env python3
"""What ontology authors use: docent check, docent validate, docent ontology, with their exit codes."""
import json
import os
import subprocess
import unittest

from docent_e2e import StageTest, stage

SHAPES = """@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix : <http://example.org/> .
:RoomShape a sh:NodeShape ; sh:targetClass :Room ;
  sh:property [ sh:path :door ; sh:minCount 1 ] .
"""
WORDS = """@prefix : <http://example.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
:m a owl:Ontology ; owl:versionInfo "1.0" .
:Room a owl:Class ; rdfs:label "room" ; rdfs:comment "has doors" ; rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :door ; owl:minCardinality 1 ] .
:door a owl:ObjectProperty ; rdfs:label "door" ; rdfs:comment "leads in" .
"""
# In the shape that Protégé writes.
PROTEGE = """<?xml version="1.0"?>
<!DOCTYPE rdf:RDF [
    <!ENTITY owl "http://www.w3.org/2002/07/owl#" >
]>
<rdf:RDF xmlns="http://example.org/"
     xml:base="http://example.org/m"
     xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"
     xmlns:owl="http://www.w3.org/2002/07/owl#"
     xmlns:xml="http://www.w3.org/XML/1998/namespace"
     xmlns:rdfs="http://www.w3.org/2000/01/rdf-schema#">
    <owl:Ontology rdf:about="http://example.org/m"><owl:versionInfo>1.1</owl:versionInfo></owl:Ontology>
    <owl:ObjectProperty rdf:about="http://example.org/door">
        <rdfs:label>door</rdfs:label>
        <rdfs:comment>leads in</rdfs:comment>
    </owl:ObjectProperty>
    <owl:Class rdf:about="http://example.org/Room">
        <rdf:type rdf:resource="&owl;NamedIndividual"/>
        <rdfs:label>room</rdfs:label>
        <rdfs:comment>has doors</rdfs:comment>
    </owl:Class>
</rdf:RDF>
"""

WORKFLOW = """<CAWL name="T" xmlns:docent="https://w3id.org/docent#">
<flow name="F"><variable name="user"/>
    <source name="s"/>
  <node name="Greet" timeout="1min"><condition><context><rule>
        <constraint><subject>$usr</subject><verb>docent:isAt</verb><object>?place</object></constraint>
  </rule></context></condition><invoke operation="say"/></node> <!-- says hello -->
  <sink name="e"/>
    <link from="s" to="Gret"/><link from="Greet" to="e"/>
</flow></CAWL>
"""


class Check(StageTest):
    def test_workflows_that_are_checked_together_may_invoke_each_other(self):
        flow = '<flow name="{0}"><source name="s"/><node name="N">{1}</node><sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow>'
        guide = self.file("guide.cawl.xml", f'<CAWL name="Guide">{flow.format("Lead", "")}</CAWL>')
        words = self.file("words.ttl", "<urn:x#A> a <http://www.w3.org/2002/07/owl#Class> .")
        for name, code in (("Guide", 0), ("Guide/Lead", 0), ("Guid", 1), ("Guide/Led", 1)):
            invoke = f'<invoke subflow="{name}"/>'
            tour = self.file("tour.cawl.xml", f'<CAWL name="Tour">{flow.format("Tour", invoke)}</CAWL>')
            done = self.docent("check", tour, guide, "--ontology", words)
            self.assertEqual(done.returncode, code, done.stderr)
            if code:
                self.assertIn(f"there is no flow or deployed workflow {name}", done.stderr)
        self.assertEqual(self.docent("check", tour, "--ontology", words).returncode, 1)

    def test_the_project_s_own_files_have_no_errors(self):
        files = sorted(stage.ROOT.glob("ontology/*.ttl")) + sorted(stage.S01.glob("*.ttl")) + sorted(stage.S01.glob("*.rules"))
        done = self.docent("check", *files)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count(": ok"), len(files))

    def test_fixes_are_edits_that_a_program_can_make(self):
        file = self.file("t.cawl.xml", WORKFLOW)
        found = [json.loads(line) for line in self.docent("check", "--json", file).stdout.splitlines()]
        text = WORKFLOW.encode()
        usr, = [f for f in found if "$usr" in f["message"]]
        edit, = usr["fix"]
        self.assertEqual(text[edit["offset"]:edit["offset"] + edit["length"]], b"usr")
        self.assertEqual(edit["replacement"], "user")
        done = self.docent("check", "--fix", file)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("fixes made", done.stderr)
        fixed = file.read_text()
        self.assertIn("$user<", fixed)
        self.assertIn(' xmlns:ext="https://w3id.org/docent/cawl-ext#"', fixed)
        self.assertIn('ext:timeout="1min"', fixed)
        self.assertIn('to="Greet"', fixed)
        again = self.docent("check", "--fix", file)
        self.assertEqual((again.returncode, again.stderr), (0, ""))

    def test_a_workflow_is_held_to_the_words_of_ontologies_checked_with_it(self):
        text = WORKFLOW.replace("$usr", "$user").replace("Gret", "Greet").replace(" timeout=\"1min\"", "").replace("docent:isAt", "docent:isBesides")
        file = self.file("t.cawl.xml", text)
        self.assertIn("isBesides", self.docent("check", file).stderr)  # Docent's own words are always known
        other = self.file("other.cawl.xml", text.replace("https://w3id.org/docent#", "http://example.org/"))
        self.assertNotIn("isBesides", self.docent("check", other).stderr)
        words = self.file("words.ttl", WORDS)
        done = self.docent("check", other, words)
        self.assertIn("isBesides", done.stdout + done.stderr)

    def test_words_of_docent_are_checked_in_every_kind_of_file(self):
        prefix = "PREFIX docent: <https://w3id.org/docent#> "
        for name, text in (("t.rules", prefix + 'RULE { ?a <urn:p> "x" } WHERE { ?a docent:isatt ?b }'),
                           ("t.rq", prefix + "SELECT * { ?a docent:isatt ?b }"),
                           ("t.ttl", "@prefix docent: <https://w3id.org/docent#> . <urn:a> docent:isatt <urn:b> .")):
            done = self.docent("check", self.file(name, text))
            self.assertEqual(done.returncode, 1, name)
            self.assertIn("docent:isatt is not defined", done.stderr)
            good = self.docent("check", self.file(name, text.replace("isatt", "isAt")))
            self.assertEqual((good.returncode, good.stderr), (0, ""), name)

    def test_a_copied_program_says_that_it_lacks_its_own_ontology(self):
        file = self.file("t.ttl", "@prefix docent: <https://w3id.org/docent#> . <urn:a> a docent:Regoin .")
        done = subprocess.run([self.stage.bin / "docent", "check", file], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "DOCENT_DATA_DIR": str(self.stage.folder)})
        self.assertEqual(done.returncode, 2)
        self.assertIn("DOCENT_DATA_DIR", done.stderr)
        self.assertIn("ontology/docent.ttl", done.stderr)
        self.assertIn("docent:Region", self.docent("check", file).stderr)

    def test_modules_of_the_ontology_are_checked_by_themselves(self):
        modules = sorted(stage.ROOT.glob("ontology/*.ttl"))
        done = self.docent("check", *modules)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(done.stdout.splitlines()), len(modules))

    def test_workflow_findings_have_rules(self):
        ontologies = [a for f in sorted(stage.ROOT.glob("ontology/*.ttl")) for a in ("--ontology", f)]
        text = (stage.S01 / "booth_guide.cawl.xml").read_text(encoding="utf-8")
        file = self.file("booth.cawl.xml", text.replace('type="docent:Visitor">?user', 'type="docent:Robot">?user'))
        done = self.docent("check", "--json", *ontologies, stage.S01 / "booth_guide.rsel.xml", file)
        self.assertEqual(done.returncode, 0, done.stderr)
        rules = {json.loads(line)["rule"] for line in done.stdout.splitlines()}
        self.assertEqual(rules, {"unsatisfiable-condition", "activator-never-rises"})
        clean = self.docent("check", *ontologies, stage.S01 / "booth_guide.rsel.xml", stage.S01 / "booth_guide.cawl.xml")
        self.assertEqual((clean.returncode, clean.stderr), (0, ""))

    def test_fmt_changes_layout_alone(self):
        file = self.file("f.cawl.xml", WORKFLOW)
        self.assertEqual(self.docent("fmt", "--check", file).returncode, 1)
        self.assertEqual(file.read_text(), WORKFLOW)
        done = self.docent("fmt", file)
        self.assertEqual((done.returncode, done.stdout.strip()), (0, str(file)))
        formatted = file.read_text()
        self.assertEqual("".join(formatted.split()), "".join(WORKFLOW.split()))
        self.assertIn("</node> <!-- says hello -->\n", formatted)
        self.assertEqual(self.docent("fmt", "--check", file).returncode, 0)
        self.assertEqual(self.docent("fmt", "-", text=WORKFLOW).stdout, formatted)
        for kind in ("cawl", "rsel"):
            shipped = sorted(stage.ROOT.glob(f"scenarios/*/*.{kind}.xml"))
            self.assertEqual(self.docent("fmt", "--check", *shipped).returncode, 0)

    def test_fmt_refuses_what_is_no_document(self):
        broken = self.file("b.cawl.xml", "<CAWL name='T'>\n<flow></CAWL>\n")
        done = self.docent("fmt", broken)
        self.assertEqual(done.returncode, 2)
        self.assertIn("b.cawl.xml:2:", done.stderr)
        other = self.file("o.xml", "<html/>")
        self.assertIn("neither a CAWL nor an RSEL document", self.docent("fmt", other).stderr)
        self.assertEqual(self.docent("fmt", "/nowhere.cawl.xml").returncode, 2)

    def test_findings_have_place_rule_and_remedy(self):
        words = self.file("words.ttl", WORDS)
        data = self.file("data.ttl", "@prefix : <http://example.org/> .\n:A a :Rom ;\n  :door \"front\" .\n")
        done = self.docent("check", words, data)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("data.ttl:2:6: error: the class :Rom is not defined", done.stderr)
        self.assertIn("did you mean :Room?", done.stderr)
        found = [json.loads(line) for line in self.docent("check", "--json", words, data).stdout.splitlines()]
        self.assertEqual([(f["rule"], f["line"], f["column"]) for f in found if f["severity"] == "error"],
                         [("undefined-term", 2, 6), ("range-clash", 3, 9)])

    def test_an_inconsistency_has_its_proof(self):
        words = self.file("words.ttl", WORDS + ":Robot a owl:Class ; rdfs:label \"robot\" ; rdfs:comment \"moves\" ; owl:disjointWith :Room .\n")
        data = self.file("data.ttl", "@prefix : <http://example.org/> .\n:A :door :A .\n:C a :Robot .\n")
        rules = self.file("c.rules", "PREFIX : <http://example.org/>\nRULE { ?x a :Room } WHERE { ?x a :Robot }\n")
        self.assertEqual(self.docent("check", words, data).returncode, 0)
        done = self.docent("check", words, data, rules)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("data.ttl:3:6: error: the facts contradict each other, by owl2rl cax-dw", done.stderr)
        self.assertIn("c.rules rule 1 (line 2), ?x = :C", done.stderr)
        self.assertIn("data.ttl:3:6\n", done.stderr[done.stderr.index("proof:"):])
        found = [json.loads(line) for line in self.docent("check", "--json", words, data, rules).stdout.splitlines()]
        self.assertIn("told in ", [f for f in found if f["rule"] == "inconsistency"][0]["proof"])

    def test_an_option_takes_one_file(self):
        words, data = self.file("words.ttl", WORDS), "<http://e/A> a <http://example.org/Rom> .\n"
        files = [self.file("a.ttl", data), self.file("b.ttl", data)]
        for arguments in (["--ontology", words, *files], ["--ontology", words, "--ontology", words, *files]):
            done = self.docent("check", *arguments)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            for file in files:
                self.assertIn(f"{file}:1:", done.stderr)

    def test_rules_are_checked_together(self):
        prefix = "PREFIX : <http://example.org/>\n"
        free = self.file("free.rules", prefix + "RULE { ?x a :Free } WHERE { ?x a :Robot NOT { ?x a :Busy } }\n")
        busy = self.file("busy.rules", prefix + "# busy\nRULE { ?x a :Busy } WHERE { ?x a :Free }\n")
        for file in (free, busy):
            self.assertEqual(self.docent("check", file).returncode, 0)
        done = self.docent("check", free, busy)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("free.rules:2:1: error: negation through recursion", done.stderr)
        self.assertIn("\n  RULE { ?x a :Free }", done.stderr)

    def test_strict_counts_warnings(self):
        unused = self.file("unused.ttl", "@prefix x: <http://x/> .\n<http://e/a> <http://e/b> <http://e/c> .\n")
        self.assertEqual(self.docent("check", unused).returncode, 0)
        self.assertEqual(self.docent("check", "--strict", unused).returncode, 1)
        self.assertEqual(self.docent("check", unused.parent / "nothing.ttl").returncode, 2)


class Validate(StageTest):
    def test_files(self):
        shapes, good = self.file("shapes.ttl", SHAPES), self.file("good.ttl", "<http://e/A> a <http://example.org/Room> ; "
                                                                  "<http://example.org/door> <http://e/D> .\n")
        bad = self.file("bad.ttl", "\n<http://e/A> a <http://example.org/Room> .\n")
        done = self.docent("validate", "--shapes", shapes, good)
        self.assertEqual((done.returncode, done.stdout), (0, "conforms (1 node checked)\n"), done.stderr)
        done = self.docent("validate", "--shapes", shapes, bad)
        self.assertEqual(done.returncode, 1)
        self.assertIn("bad.ttl:2:1: violation: <http://e/A> <http://example.org/door>: has 0 values; at least 1 needed", done.stdout)
        self.assertIn("shapes.ttl:3:", done.stdout)
        report = self.file("report.ttl", self.docent("validate", "--rdf", "--shapes", shapes, bad).stdout)
        self.assertIn("sh:conforms false", report.read_text())
        self.assertEqual(self.docent("check", report).returncode, 0, "it is Turtle")
        lines = self.docent("validate", "--json", "--shapes", shapes, bad).stdout.splitlines()
        self.assertEqual(json.loads(lines[-1]), {"conforms": False, "results": 1, "focus_nodes": 1})
        self.assertEqual(json.loads(lines[0])["line"], 2)

    def test_bad_shapes(self):
        bad = self.file("bad.ttl", "@prefix sh: <http://www.w3.org/ns/shacl#> .\n<http://e/S> sh:targetNode 1 ;\n  sh:not <http://e/S> .\n")
        done = self.docent("validate", "--shapes", bad, bad)
        self.assertEqual(done.returncode, 2)
        self.assertIn("refers to itself", done.stderr)


class Modules(StageTest):
    def test_a_module_is_loaded_compared_replaced_and_removed_while_it_runs(self):
        server = self.stage.server()
        words = self.file("m.ttl", WORDS)
        server.command("ontology", "load", words)
        self.assertEqual(server.run("ontology", "load", words).returncode, 2, "it is there already")
        self.assertIn("version 1.0", server.command("ontology", "list"))
        self.assertEqual(server.run("ontology", "diff", words).returncode, 0, "blank nodes are no difference")
        protege = self.file("m.owl", PROTEGE)
        done = server.run("ontology", "diff", "--name", "m.ttl", protege)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("# version 1.0 → version 1.1", done.stdout)
        self.assertIn("+ :Room rdf:type owl:NamedIndividual", done.stdout)
        self.assertNotIn("rdfs:label", done.stdout)
        server.command("ontology", "replace", "--name", "m.ttl", protege)
        self.assertIn("version 1.1", server.command("ontology", "list"))
        self.assertEqual(server.run("ontology", "diff", "--name", "m.ttl", protege).returncode, 0)
        self.assertFalse(server.ask("?x <http://www.w3.org/2002/07/owl#minCardinality> ?y"))
        server.command("ontology", "remove", "m.ttl")
        self.assertEqual(server.run("ontology", "replace", words).returncode, 2, "there is none to replace")
        self.assertFalse(server.ask("<http://example.org/Room> ?p ?o"))

    def test_a_module_that_was_emptied_can_be_compared_and_filled_again(self):
        server = self.stage.server()
        words, empty = self.file("m.ttl", WORDS), self.file("empty.ttl", "")
        server.command("ontology", "load", words)
        server.command("ontology", "replace", "--name", "m.ttl", empty)
        self.assertIn("0 triples", server.command("ontology", "list"))
        self.assertEqual(server.run("ontology", "diff", "--name", "m.ttl", empty).returncode, 0)
        self.assertEqual(server.run("ontology", "diff", words).returncode, 1)
        server.command("ontology", "replace", words)

    def test_the_rules_of_a_shape_are_called_by_their_lines(self):
        server = self.stage.server()
        shapes = """@prefix sh: <http://www.w3.org/ns/shacl#> .
<http://e/S> sh:targetNode <http://e/x> ;
  sh:rule [ sh:construct \'\'\'PREFIX : <http://e/>
    CONSTRUCT { $this :b 1 }
    WHERE { $this :a 1 }\'\'\' ] .
"""
        server.command("rules", "use", self.file("af.ttl", shapes))
        server.command("load", self.file("d.ttl", "<http://e/x> <http://e/a> 1 .\n"))
        self.assertIn("by af.ttl rule 1 (line 3)", server.command("why", "<http://e/x> <http://e/b> 1"))
        done = server.run("rules", "use", self.file("bad.ttl", shapes.replace("WHERE {", "WHERE { OPTIONAL { $this :c 1 }")))
        self.assertEqual(done.returncode, 2)
        self.assertIn("bad.ttl:5:13: error: a rule body cannot contain OPTIONAL\n      WHERE { OPTIONAL", done.stderr)

    def test_functions_that_a_server_has(self):
        good = self.file("good.rules", "PREFIX : <http://e/> RULE { ?a :d ?x } WHERE { ?a :x ?p ; :y ?q BIND(docent:distance(?p, ?q, 0, 0) AS ?x) }\n")
        self.assertEqual(self.docent("check", good).returncode, 0)
        bad = self.file("bad.rq", "SELECT * { BIND(docent:distanse(1, 2, 3, 4) AS ?d) }\n")
        done = self.docent("check", bad)
        self.assertEqual(done.returncode, 1)
        self.assertIn("bad.rq:1:17: error: no function", done.stderr + done.stdout)

    def test_a_module_whose_name_has_characters_that_terms_do_not(self):
        server = self.stage.server()
        words = self.file("my words (1)+é–100%@home.ttl", WORDS)
        for arguments in (["load"], ["ontology", "load"], ["ontology", "replace"], ["ontology", "diff"]):
            done = server.run(*arguments, words)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"\n{words.name} ", "\n" + server.command("ontology", "list"))
        self.assertTrue(server.ask("GRAPH <https://w3id.org/docent/ontology/my%20words%20(1)+é–100%25@home.ttl> { ?r :onProperty ?p }"
                                   .replace(":onProperty", "<http://www.w3.org/2002/07/owl#onProperty>")))
        server.command("ontology", "remove", words.name)
        self.assertEqual(server.command("ontology", "list"), "")

    def test_a_server_that_refuses_what_violates_its_shapes(self):
        server = stage.Server(self.stage, arguments=["--on-violation", "refuse"])
        server.command("ontology", "load", self.file("shapes.ttl", SHAPES))
        bad = self.file("bad.ttl", "<http://e/A> a <http://example.org/Room> .\n")
        done = server.run("load", bad)
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing was changed", done.stderr)
        self.assertIn("bad.ttl:1:1: violation: <http://e/A>", done.stderr)
        done = server.run("tell", "<http://e/B> a <http://example.org/Room> .")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing was changed", done.stderr)
        self.assertFalse(server.ask("?room a <http://example.org/Room>"))
        self.assertEqual(server.run("ontology", "check", bad).returncode, 1)
        self.assertEqual(server.run("validate").returncode, 0)
        self.assertEqual(server.command("validate").split(",")[0], "conforms (0 nodes checked)")

    def test_a_graph_is_checked_by_shapes_of_a_file(self):
        server = self.stage.server()
        server.command("tell", "<http://e/B> a <http://example.org/Room> .")
        done = server.run("validate", "--shapes", self.file("given.ttl", "\n" + SHAPES))
        self.assertEqual(done.returncode, 1)
        self.assertIn("given.ttl:4:15)", done.stdout)


if __name__ == "__main__":
    unittest.main()
