#!/usr/bin/env python3
"""Graphs by the command line: one is replaced, all are written out and taken again; which server it is; and a server that is only starting."""
import json
import os
import re
import socket
import subprocess
import unittest
import urllib.error
import urllib.request

from docent_e2e import StageTest

HALL = "https://e.example/hall"


class Graphs(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()

    def quads(self, server):
        """All told facts, as N-Quads; blank nodes by what is told of them alone."""
        return sorted(server.command("export", "--format", "nq").splitlines())

    def revision(self):
        return int(re.search(r"revision (\d+)", self.server.run("export").stderr)[1])

    def test_a_graph_is_replaced_in_one_turn(self):
        self.server.command("load", "--graph", HALL, self.file("hall.ttl", "<urn:a> <urn:p> 1 , 2 . <urn:b> <urn:p> 3 ."))
        self.server.command("load", self.file("other.ttl", "<urn:a> <urn:p> 2 ."))
        edited = self.file("hall.ttl", "<urn:a> <urn:p> 2 , 4 .")
        before = self.revision()
        said = self.server.command("load", "--graph", HALL, "--replace", edited)
        self.assertIn("1 added, 2 removed", said)
        self.assertEqual(self.quads(self.server), [
            f'<urn:a> <urn:p> "2"^^<http://www.w3.org/2001/XMLSchema#integer> <{HALL}> .',
            '<urn:a> <urn:p> "2"^^<http://www.w3.org/2001/XMLSchema#integer> <https://w3id.org/docent#default> .',
            f'<urn:a> <urn:p> "4"^^<http://www.w3.org/2001/XMLSchema#integer> <{HALL}> .'])
        self.assertEqual(self.revision(), before + 1)
        self.assertIn("0 added, 0 removed", self.server.command("load", "--graph", HALL, "--replace", edited))
        bad = self.server.run("load", "--graph", HALL, "--replace", self.file("bad.ttl", "<urn:a> <urn:p> "))
        self.assertEqual(bad.returncode, 2)
        self.assertTrue(self.server.ask(f"GRAPH <{HALL}> {{ <urn:a> <urn:p> 4 }}"), "nothing of it")

    def test_what_replace_does_not_go_with(self):
        data = self.file("d.ttl", "<urn:a> <urn:p> 1 .")
        for arguments, says in ((("--replace", data), "--graph"), (("--replace", "--graph", HALL, data, data), "one file"),
                                (("--replace", "--graph", HALL, "--as", "facts", data), "source"),
                                (("--replace", "--graph", HALL, self.file("n.trig", "<urn:g> { <urn:a> <urn:p> 1 }")), "urn:g"),
                                (("--replace", "--graph", "https://w3id.org/docent#runs", data), "only the server writes")):
            done = self.server.run("load", *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(says, done.stderr)
        self.assertFalse(self.server.ask("<urn:a> <urn:p> ?o"))

    def test_an_export_is_taken_again(self):
        self.server.load(self.file("a.trig", """@prefix e: <https://e.example/> .
e:s e:p "a\\n\\"b\\\\"@de-AT , 1.50 , true , "x"^^e:t ; e:q [ e:r e:s ] .
<https://e.example/g> { e:s e:p e:ö , "" . e:s e:of [ e:r "in g" ] }
"""))
        self.server.command("load", "--as", "ontology", self.file("words.ttl", "<urn:w> a <http://www.w3.org/2002/07/owl#Class> ."))
        self.server.command("rules", "use", self.file("r.rules", "PREFIX e: <https://e.example/>\nRULE { ?x a e:T } WHERE { ?x e:p 1.50 }"))
        told = "SELECT (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } FILTER(?g NOT IN (docent:inferred, docent:documents)) }"
        count = self.server.select(told)[0]["n"]
        other = self.stage.server(data="other")
        for format in ("trig", "nq"):
            text = self.server.command("export", "--format", format)
            self.assertNotIn("inferred", text)
            other.load(self.file(f"all.{format}", text))
            other.command("update", "DELETE WHERE { GRAPH ?g { ?s ?p ?o } }") if format == "trig" else None
        self.assertEqual(other.select(told)[0]["n"], count)
        ground = [line for line in self.quads(self.server) if "_:" not in line]
        self.assertEqual([line for line in self.quads(other) if "_:" not in line], ground)
        self.assertTrue(other.ask('?s <https://e.example/q> ?b . ?b <https://e.example/r> ?s'))
        self.assertIn("docent#inferred", self.server.command("export", "--inferred", "--format", "nq"))
        one = self.server.command("export", "--graph", "https://e.example/g", "--format", "ttl")
        self.assertNotIn("{", one)
        self.assertIn('"in g"', one)
        refused = self.server.run("export", "--format", "ttl")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--graph", refused.stderr)

    def test_nobody_tells_facts_in_the_name_of_a_run_or_an_operator(self):
        server = self.server
        server.load(self.file("tell.cawl.xml", """<CAWL name="T" version="1.0" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="T"><source name="b"/><node name="N"><ext:tell>&lt;urn:a&gt; &lt;urn:p&gt; 1</ext:tell></node><sink name="e"/>
  <link from="b" to="N"/><link from="N" to="e"/></flow></CAWL>"""))
        run = server.command("run", "T", "--detach").strip()
        server.wait_for("<urn:a> <urn:p> 1", 60)
        data, fact = self.file("d.ttl", "<urn:a> <urn:p> 2 ."), "<urn:a> <urn:p> 2"
        for graph in (f"urn:docent:run:{run}", "urn:docent:run:None-7", "urn:docent:operator"):
            named = self.file("n.trig", f"<{graph}> {{ {fact} }}")
            for arguments in (("load", "--graph", graph, data), ("load", "--graph", graph, "--replace", data), ("load", named),
                              ("load", "--as", "facts", "--source", graph, data), ("tell", "--source", graph, fact),
                              ("update", f"INSERT DATA {{ GRAPH <{graph}> {{ {fact} }} }}"),
                              ("update", f"COPY DEFAULT TO <{graph}>"), ("update", f"ADD DEFAULT TO <{graph}>"),
                              ("update", f"MOVE DEFAULT TO <{graph}>"),
                              ("update", f"INSERT {{ GRAPH ?g {{ {fact} }} }} WHERE {{ BIND(<{graph}> AS ?g) }}")):
                refused = server.run(*arguments)
                self.assertEqual(refused.returncode, 2, arguments)
                self.assertIn("only the server writes", refused.stderr, arguments)
            for method in ("PUT", "POST"):
                request = urllib.request.Request(f"http://{server.http}/rdf-graphs?graph={graph}", b"<urn:a> <urn:p> 2 .",
                                                 {"Content-Type": "text/turtle"}, method=method)
                with self.assertRaises(urllib.error.HTTPError) as answer:
                    urllib.request.urlopen(request, timeout=60)
                self.assertEqual(answer.exception.code, 403)
        self.assertFalse(server.ask(f"GRAPH ?g {{ {fact} }}"))
        self.assertTrue(server.ask(f"GRAPH <urn:docent:run:{run}> {{ <urn:a> <urn:p> 1 }}"), "it was replaced")
        self.assertNotIn("urn:docent:run:", server.command("export", "--format", "nq"))
        self.assertIn("<urn:a>", server.command("export", "--graph", f"urn:docent:run:{run}", "--format", "nt"))
        server.command("tell", "--source", f"urn:docent:run:{run}", "--withdraw", "<urn:a> <urn:p> 1")
        self.assertFalse(server.ask("<urn:a> <urn:p> 1"), "it outlived its run")

    def test_a_graph_that_is_not_there_is_not_exported(self):
        refused = self.server.run("export", "--graph", "https://e.example/none")
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("there is no graph <https://e.example/none>", refused.stderr)

    def test_a_large_graph_is_written_whole(self):
        self.server.load(self.file("large.nt", "".join(f'<urn:s{i}> <urn:p> "{i}" .\n' for i in range(25000))))
        for format in ("trig", "nq"):
            text = self.server.command("export", "--format", format)
            self.assertEqual(text.count("<urn:s") if format == "nq" else text.count("<urn:p>"), 25000)
        self.assertEqual(text.count("@prefix"), 0)

    def test_status(self):
        self.server.load(self.file("a.ttl", "<urn:a> <urn:p> 1 ."))
        told = self.server.command("status")
        for line in ("health      ok", f"grpc {self.server.grpc}", "data folder", "violations  ignore", "runs        0, 0 of them live"):
            self.assertIn(line, told)
        status = json.loads(self.server.command("status", "--json"))
        self.assertEqual(status["facts"], "1")
        self.assertEqual(status["data_folder"], str(self.server.data.resolve()))
        self.assertEqual(status["problem"], "")


class Start(StageTest):
    """`docent serve &` and a command right behind it."""

    def test_a_server_that_is_only_starting_is_waited_for(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        docent = self.stage.bin / "docent"
        command = subprocess.Popen([docent, "query", "ASK {}"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "DOCENT_SERVER": f"127.0.0.1:{port}"})
        self.stage.start("late", [docent, "serve", "--data", self.stage.folder / "late", "--grpc", f"127.0.0.1:{port}", "--http", "127.0.0.1:0"])
        out, error = command.communicate(timeout=60)
        if command.returncode == 2:  # a busy machine takes longer than is waited
            self.assertIn("no server answers", error)
        else:
            self.assertEqual((command.returncode, out), (0, "yes\n"), error)

    def test_where_there_is_none_it_says_so(self):
        done = subprocess.run([self.stage.bin / "docent", "robots", "--server", "127.0.0.1:1"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no server answers at 127.0.0.1:1", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
