#!/usr/bin/env python3
"""RDF files as people have them: with relative IRIs, packed, in other encodings and syntaxes, and slow to read."""
import gzip
import http.client
import threading
import unittest

from docent_e2e import StageTest

OWL = ('<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:owl="http://www.w3.org/2002/07/owl#">\n'
       '<owl:Ontology rdf:about=""/><owl:Class rdf:ID="Hall"/></rdf:RDF>\n')
SHAPES = """@prefix sh: <http://www.w3.org/ns/shacl#> .
<#S> a sh:NodeShape ; sh:targetNode <data#x> ; sh:property [ sh:path <data#p> ; sh:minCount 1 ] .
"""


class Bases(StageTest):
    """A file is its own base (RFC 8089); --base overrides it."""

    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        self.folder = f"file://{self.stage.folder.resolve()}"

    def test_load(self):
        owl = self.file("o m.owl", OWL)
        self.server.load(owl)
        self.assertTrue(self.server.ask(f"<{self.folder}/o%20m.owl> a owl:Ontology . <{self.folder}/o%20m.owl#Hall> a owl:Class"))
        self.server.command("load", "--base", "http://e/hall", owl)
        self.assertTrue(self.server.ask("<http://e/hall> a owl:Ontology . <http://e/hall#Hall> a owl:Class"))
        turtle = self.file("t.ttl", "<> <#p> <other> .\n")
        self.server.command("load", "--as", "ontology", turtle)
        self.assertTrue(self.server.ask(f"GRAPH ?g {{ <{self.folder}/t.ttl> <{self.folder}/t.ttl#p> <{self.folder}/other> }}"))
        self.server.command("load", "--as", "facts", "--base", "http://e/facts", turtle)
        self.assertTrue(self.server.ask("<http://e/facts> <http://e/facts#p> <http://e/other>"))
        self.server.command("load", "--base", "http://e/stdin", "-", text="<> <#p> 1 .\n")
        self.assertTrue(self.server.ask("<http://e/stdin> <http://e/stdin#p> 1"))
        done = self.server.run("load", "--base", "relative", turtle)
        self.assertIn('"relative" is not an absolute IRI', done.stderr)
        self.assertNotEqual(done.returncode, 0)

    def test_a_large_file_in_parts(self):
        text = "".join(f"<#s{i}> <#p> \"{'x' * 100}{i}\" .\n" for i in range(40000))
        self.server.load(self.file("large.ttl", text))
        self.assertTrue(self.server.ask(f"<{self.folder}/large.ttl#s39999> <{self.folder}/large.ttl#p> ?x"))

    def test_graphs_that_clients_cannot_write(self):
        graph = "https://w3id.org/docent#runs"
        small = self.file("small.trig", f"<urn:a> <urn:p> 1 .\n<{graph}> {{ <urn:a> <urn:p> 2 }}\n")
        large = self.file("large.nq", "".join(f"<urn:a> <urn:p> \"{i}\" .\n" for i in range(400000)) + f"<urn:a> <urn:p> <urn:b> <{graph}> .\n")
        blank = self.file("blank.trig", "_:g { <urn:a> <urn:p> 3 }\n")
        for file, place in ((small, f"{small}:2:1"), (large, f"{large}:400001:25"), (blank, f"{blank}:1:1")):
            for command in ("check", "load"):
                done = self.server.run(command, file)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(place, done.stdout + done.stderr)
        self.assertFalse(self.server.ask("<urn:a> <urn:p> ?o"), "nothing of them")

    def test_ontologies(self):
        owl = self.file("hall.owl", OWL)
        self.server.command("ontology", "load", owl)
        self.assertTrue(self.server.ask(f"GRAPH ?g {{ <{self.folder}/hall.owl#Hall> a owl:Class }}"))
        self.assertIn("0 removed, 0 added", self.server.command("ontology", "diff", owl))
        self.server.command("ontology", "replace", "--base", "http://e/hall", owl)
        self.assertTrue(self.server.ask("GRAPH ?g { <http://e/hall#Hall> a owl:Class }"))
        self.server.command("ontology", "check", owl)

    def test_check_and_validate(self):
        owl, shapes = self.file("hall.owl", OWL), self.file("shapes.ttl", SHAPES)
        done = self.docent("check", owl)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        good = self.file("facts", "<data#x> <data#p> 1 .\n")
        done = self.docent("validate", "--shapes", shapes, good)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.server.command("load", "--base", "http://e/", self.file("data.ttl", "<data#x> <data#q> 1 .\n"))
        done = self.server.run("validate", "--base", "http://e/", "--shapes", shapes)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("http://e/data#x", done.stdout)

    def test_ontologies_of_serve(self):
        owl = self.file("hall.owl", OWL)
        other = self.stage.server(data="other", arguments=["--ontology", owl])
        self.assertTrue(other.ask(f"GRAPH ?g {{ <{self.folder}/hall.owl#Hall> a owl:Class }}"))


class Files(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()

    def bytes(self, name, data):
        path = self.stage.folder / name
        path.write_bytes(data)
        return path

    def test_packed_files(self):
        self.server.load(self.bytes("x.ttl.gz", gzip.compress(b"@prefix : <http://e/> . :a :p 1 .")))
        self.server.load(self.bytes("x.nt.gz", gzip.compress(b"<http://e/a> <http://e/q> \"1\" .\n")))
        self.server.load(self.bytes("x.rules.gz", gzip.compress(b"RULE { ?a <http://e/r> ?b } WHERE { ?a <http://e/p> ?b }")))
        self.assertTrue(self.server.ask("<http://e/a> <http://e/p> 1 ; <http://e/q> '1' ; <http://e/r> 1"))
        done = self.docent("check", self.bytes("y.ttl.gz", gzip.compress(b"@prefix : <http://e/> .\n:a :p .")))
        self.assertEqual(done.returncode, 1)
        self.assertIn("y.ttl.gz:2:7: error", done.stderr)
        done = self.server.run("load", self.bytes("z.ttl.gz", gzip.compress(b"<urn:a> <urn:b> 1 .")[:-6]))
        self.assertEqual(done.returncode, 2)
        self.assertIn("z.ttl.gz: the gzip data ends too early", done.stderr)

    def test_other_encodings(self):
        text = ('<?xml version="1.0" encoding="%s"?>\n<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
                '<rdf:Bag rdf:about="http://e/%s"><rdf:li>größe</rdf:li></rdf:Bag></rdf:RDF>')
        for encoding in ("UTF-16", "ISO-8859-1", "windows-1252", "UTF-8"):
            self.server.load(self.bytes(f"{encoding}.owl", (text % (encoding, encoding)).encode(encoding)))
            self.assertTrue(self.server.ask(f"<http://e/{encoding}> rdf:_1 'größe'"), encoding)

    def test_formats_that_are_not_read(self):
        for name in ("a.jsonld", "a.n3", "a.json"):
            file = self.bytes(name, b'{ "@id": "http://e/a" }')
            for command in (["load"], ["check"], ["validate", "--shapes", file], ["ontology", "load"]):
                done = self.server.run(*command, file)
                self.assertEqual(done.returncode, 2, (name, command, done.stdout))
                self.assertIn(f"{name}:1:1: error: this is ", done.stderr)
                self.assertIn("Turtle (.ttl)", done.stderr)
        done = self.server.run("load", self.bytes("star.ttl", b"<urn:a> <urn:p> 1 .\n<< <urn:a> <urn:p> 1 >> <urn:q> 2 ."))
        self.assertIn("star.ttl:2:1: error: '<<' opens a triple term", done.stderr)


class SlowDocuments(StageTest):
    def test_a_client_that_leaves_ends_the_reading(self):
        """Many names, each different, are what libxml2 is slowest with."""
        names = "".join(f"<e:n{i}/>" for i in range(900000))
        body = (f'<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:e="http://e/">{names}</rdf:RDF>').encode()
        server = self.stage.server()
        connections = [http.client.HTTPConnection(server.http, timeout=60) for _ in range(5)]

        def put(connection):
            try:
                connection.request("PUT", "/rdf-graphs?graph=urn:z", body, {"Content-Type": "application/rdf+xml"})
            except OSError:
                pass

        threads = [threading.Thread(target=put, args=(connection,)) for connection in connections]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for connection in connections:
            connection.close()
        self.assertFalse(server.ask("GRAPH <urn:z> { ?s ?p ?o }"), "all places of queries were taken")
        self.assertEqual(server.stop(), 0)


if __name__ == "__main__":
    unittest.main()
