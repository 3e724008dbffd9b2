#!/usr/bin/env python3
"""`docent serve --on-violation refuse`: the same shapes at every door of clients, with what the rules derive."""
import json
import threading
import unittest
import urllib.error
import urllib.request

from docent_e2e import StageTest

SHAPES = """@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix e: <https://e.example/> .
e:RoomShape a sh:NodeShape ; sh:targetClass e:Room ; sh:property [ sh:path e:door ; sh:minCount 1 ; sh:message "a room needs a door" ] .
e:OwnerShape a sh:NodeShape ; sh:targetSubjectsOf e:owner ; sh:property [ sh:path e:owner ; sh:maxCount 1 ] .
"""
ROOM = "<https://e.example/A> a <https://e.example/Room> ."
UPDATE = "INSERT DATA { " + ROOM + " }"


class Guard(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server(arguments=["--on-violation", "refuse"])
        self.server.command("load", "--as", "ontology", self.file("shapes.ttl", SHAPES))

    def http(self, method, target, media_type, body):
        request = urllib.request.Request(f"http://{self.server.http}{target}", body.encode(), {"Content-Type": media_type}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()

    def refused(self, *command):
        done = self.server.run(*command)
        self.assertEqual(done.returncode, 2, command)
        self.assertIn("a room needs a door", done.stderr)

    def test_what_violates_is_refused_at_every_door(self):
        self.refused("tell", ROOM)
        self.refused("update", UPDATE)
        self.refused("load", self.file("a.ttl", ROOM))
        self.refused("load", "--as", "facts", self.file("a.ttl", ROOM))
        self.refused("load", "--graph", "https://e.example/g", "--replace", self.file("a.ttl", ROOM))
        graph = "/rdf-graphs?graph=https://e.example/g"
        for method, target, media_type, body in (("PUT", graph, "text/turtle", ROOM), ("POST", graph, "text/turtle", ROOM),
                                                 ("PATCH", graph, "application/sparql-update", UPDATE),
                                                 ("POST", "/sparql", "application/sparql-update", UPDATE)):
            status, body = self.http(method, target, media_type, body)
            self.assertGreaterEqual(status, 400)
            self.assertIn("a room needs a door", body)
        self.assertFalse(self.server.ask("<https://e.example/A> ?p ?o"), "nothing of them")

    def test_a_refusal_names_the_line_of_the_file_however_it_is_loaded(self):
        file = self.file("a.ttl", "@prefix e: <https://e.example/> .\n\ne:A\n  a e:Room .")
        for arguments in ((), ("--as", "facts"), ("--graph", "https://e.example/g"), ("--graph", "https://e.example/g", "--replace")):
            refused = self.server.run("load", *arguments, file)
            self.assertEqual(refused.returncode, 2, arguments)
            self.assertRegex(refused.stderr, r"a\.ttl:3:1: violation: e:A", arguments)

    def test_what_conforms_passes(self):
        self.server.command("tell", "<https://e.example/A> a <https://e.example/Room> ; <https://e.example/door> 1")
        self.server.command("tell", "<https://e.example/A> <https://e.example/temperature> 21")
        self.server.command("update", "INSERT DATA { <https://e.example/B> a <https://e.example/Room> ; <https://e.example/door> 2 }")
        self.assertTrue(self.server.ask("<https://e.example/A> <https://e.example/temperature> 21 . <https://e.example/B> <https://e.example/door> 2"))
        done = self.server.run("update", "DELETE WHERE { <https://e.example/A> <https://e.example/door> ?d }")
        self.assertIn("a room needs a door", done.stderr)

    def test_state_properties_are_judged_as_they_will_be(self):
        self.server.command("tell", "<https://e.example/owner> a docent:StateProperty")
        for owner in (1, 2, 3):
            self.server.command("tell", f"<https://e.example/T> <https://e.example/owner> {owner}")
        self.assertTrue(self.server.ask("<https://e.example/T> <https://e.example/owner> 3"))
        self.assertNotEqual(self.server.run("tell", "--source", "urn:other", "<https://e.example/T> <https://e.example/owner> 4").returncode, 0)

    def test_what_rules_derive_is_judged(self):
        self.server.command("tell", "<https://e.example/A> <https://e.example/number> 7")
        rules = self.file("r.rules", "PREFIX e: <https://e.example/>\nRULE { ?x a e:Room } WHERE { ?x e:number ?n }")
        self.refused("rules", "use", rules)
        self.server.command("tell", "<https://e.example/A> <https://e.example/door> 1")
        self.server.command("rules", "use", rules)
        self.assertTrue(self.server.ask("<https://e.example/A> a <https://e.example/Room>"))
        self.refused("tell", "<https://e.example/B> <https://e.example/number> 8")
        self.refused("update", "INSERT DATA { <https://e.example/B> <https://e.example/number> 8 }")
        self.server.command("tell", "<https://e.example/B> <https://e.example/number> 8 ; <https://e.example/door> 1")

    def test_no_two_writes_at_once_pass_that_together_violate(self):
        things, taken, other = 8, [], []

        def client(name):
            for thing in range(things):
                done = self.server.run("tell", f"<https://e.example/T{thing}> <https://e.example/owner> <urn:{name}>")
                if done.returncode == 0:
                    taken.append(thing)
                elif "violation" not in done.stderr:
                    other.append(done.stderr)
        clients = [threading.Thread(target=client, args=(name,)) for name in "abc"]
        for thread in clients:
            thread.start()
        for thread in clients:
            thread.join()
        self.assertEqual(other, [])
        self.assertEqual(sorted(taken), list(range(things)))


class Warnings(StageTest):
    def http_put(self, server, body):
        request = urllib.request.Request(f"http://{server.http}/rdf-graphs?graph=https://e.example/g", body.encode(), {"Content-Type": "text/turtle"}, method="PUT")
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.read().decode()

    def test_a_server_that_warns_takes_it_and_says_why(self):
        server = self.stage.server(arguments=["--on-violation", "warn"])
        server.command("load", "--as", "ontology", self.file("shapes.ttl", SHAPES))
        for command in (("tell", ROOM), ("update", UPDATE.replace("/A", "/B")), ("load", self.file("c.ttl", ROOM.replace("/A", "/C")))):
            done = server.run(*command)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("a room needs a door", done.stderr)
        self.assertIn("a room needs a door", self.http_put(server, ROOM.replace("/A", "/D")))
        self.assertTrue(server.ask(" . ".join(f"<https://e.example/{x}> a <https://e.example/Room>" for x in "ABCD")))

    def test_unknown_words(self):
        server = self.stage.server(arguments=["--warn-unknown"])
        words = "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix e: <https://e.example/> . e:Room a owl:Class . e:door a owl:ObjectProperty . e:width a owl:DatatypeProperty ."
        server.command("load", "--as", "ontology", self.file("words.ttl", words))
        said = server.run("tell", "e:A a e:Rom ; e:dor 1 ; e:width 2 ; <urn:p> 3").stderr
        for text in ("class e:Rom", "did you mean e:Room?", "property e:dor", "did you mean e:door?"):
            self.assertIn(text, said)
        self.assertEqual(said.count("warning"), 2)
        self.assertIn("e:dor", server.run("update", "INSERT DATA { e:A e:dor 2 }").stderr)
        self.assertIn("did you mean e:door?", self.http_put(server, "<urn:a> <https://e.example/dor> 1 ."))
        loaded = server.run("load", self.file("d.ttl", "@prefix e: <https://e.example/> .\ne:B e:width 1 ;\n  e:dor 2 ."))
        self.assertIn("d.ttl:3:3: warning", loaded.stderr)
        rules = self.file("n.rules", "PREFIX e: <https://e.example/>\nRULE { ?o a e:Rom } WHERE { ?o e:door/e:widht ?w }\n")
        said = server.run("load", rules).stderr
        self.assertIn("n.rules:2:13: warning: no loaded ontology has the class e:Rom", said)
        self.assertIn("did you mean e:width?", said)
        told = json.loads(server.run("load", "--json", rules).stdout)
        self.assertEqual([f["line"] for f in told["findings"]], [2, 2])
        self.assertEqual(server.run("load", "--json", rules).stderr, "")
        self.assertEqual(server.run("tell", "e:A a e:Room ; e:door 1").stderr, "")
        self.assertTrue(server.ask("e:A e:dor 1 , 2 . e:B e:dor 2"), "it is taken")


if __name__ == "__main__":
    unittest.main(verbosity=2)
