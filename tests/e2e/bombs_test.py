#!/usr/bin/env python3
"""Texts that are small and grow when they are read, planned or evaluated: generated ones of each grammar, to each entry that takes it.
Each is answered, the server's memory stays within what docs/operations/sizing.md states and a quarter, all of it comes back, and others
are answered meanwhile."""
import gzip
import json
import random
import socket
import struct
import subprocess
import time
import unittest

from arrival_test import MIB, Memory, all_at_once, post
from docent_e2e import StageTest
from http2_client import Http2Client
from small_client import SmallClient

STATED = (2048 + 512 + 512 + 512) * MIB  # queries, bodies, messages of gRPC, what is followed
BESIDE = 300 * MIB
ANSWERS = {200, 201, 204, 400, 404, 409, 413, 415, 422, 429, 499, 500, 501, 503, 504}
LONG = "http://e/" + "x" * 4000


def filled(first, more, last, size):
    """`first`, as many of `more` as fit into `size` bytes, `last`."""
    return first + more * ((size - len(first) - len(last)) // len(more)) + last


def nested(opening, inside, closing, depth):
    return opening * depth + inside + closing * depth


def queries(size):
    yield filled("ASK { FILTER(1 IN (1", ",1", ")) }", size)
    yield filled("SELECT * { VALUES ?x {", " 1", "} }", size)
    yield filled("ASK { ?s <u:p>", "/<u:p>", " ?o }", size)
    yield filled("ASK { ?s ?p 1", ",1", " }", size)
    yield filled("ASK { {}", "UNION{}", "}", size)
    yield filled("ASK {", "OPTIONAL{?a ?b ?c}", "}", size)
    yield filled("SELECT (CONCAT(?x", ",?x", ") AS ?y) { ?s ?p ?x }", size)
    yield filled(f"PREFIX p: <{LONG}> ASK {{ ?s ?p p:a", ",p:b", " }", size)
    yield "ASK " + nested("{", "", "}", size // 3)
    yield "ASK { FILTER(" + "(" * (size // 3) + "1" + ")" * (size // 3) + ") }"
    yield filled("ASK { ?s ?p '", "x", "' FILTER REGEX(STR(?s), '(a*)*\\\\1b', 'i') }", size)
    yield "SELECT (GROUP_CONCAT(?a) AS ?x) (GROUP_CONCAT(?b) AS ?y) { ?a ?p ?b . ?c ?q ?d . ?e ?r ?f }"
    yield "SELECT DISTINCT * { ?a ?p ?b . ?c ?q ?d . ?e ?r ?f } ORDER BY ?b ?d"
    yield "SELECT * { ?a (!<u:x>|^!<u:x>)* ?b . ?c (!<u:x>)* ?d }"


def updates(size):
    for query in list(queries(size))[:10]:
        yield "INSERT { <u:a> <u:b> <u:c> } WHERE " + query[query.index("{"):]
    yield filled("INSERT DATA { <u:a> <u:b> 1", ",1", " }", size)
    yield filled("", "CLEAR ALL;", "CLEAR ALL", size)
    yield filled(f"PREFIX p: <{LONG}> INSERT DATA {{ p:a p:b p:c", ",p:d", " }", size)
    yield "INSERT { ?a ?p ?d } WHERE { ?a ?p ?b . ?c ?q ?d . ?e ?r ?f }"


def graphs(size):
    yield "text/turtle", filled("<u:a> <u:b> 1", ",1", " .", size)
    yield "text/turtle", filled(f"@prefix p: <{LONG}> . p:a p:b p:c", ",p:d", " .", size)
    yield "text/turtle", nested("<u:a> <u:b> [ <u:c> ", "1", "]", size // 20)
    yield "text/turtle", nested("(", "1", ")", size // 3)
    yield "text/turtle", filled("<u:a> <u:b> (", " []", ") .", size)
    yield "application/n-triples", filled("", "<u:a> <u:b> <u:c> .\n", "", size)
    yield "application/rdf+xml", filled(
        '<!DOCTYPE r [<!ENTITY a "xxxxxxxxxx"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><r:RDF xmlns:r="http://www.w3.org/1999/02/22-rdf-syntax-ns#" '
        'xmlns:u="u:"><r:Description r:about="u:a"><u:b>', "&b;", "</u:b></r:Description></r:RDF>", size)
    yield "application/rdf+xml", '<r:RDF xmlns:r="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:u="u:">' + nested(
        "<r:Description><u:b>", "", "</u:b></r:Description>", size // 40) + "</r:RDF>"


def rules(size):
    yield filled("", "RULE { ?a ?b ?c } WHERE { ?a ?d ?c . ?e ?b ?f }\n", "", size)
    yield filled("RULE { ?a <u:x> ?c } WHERE { ?a <u:y> ?c ", ". ?a <u:z> ?c ", "}", size)
    yield filled("RULE { ?a <u:x> ?c } WHERE { ?a <u:y> ?c FILTER(1 IN (1", ",1", ")) }", size)
    yield "RULE { ?a <u:x> ?c } WHERE " + "{" * (size // 2)


def documents(size):
    """XML of CAWL, RSEL or WSDL, whichever reads it."""
    head = '<CAWL name="W" xmlns:e="u:"><flow name="F"><source name="s"/>'
    yield filled(head, '<node name="n"/>', "</flow></CAWL>", size)
    yield filled(head, '<link from="s" to="s"/>', "</flow></CAWL>", size)
    yield nested("<a>", "", "</a>", size // 7)
    yield filled('<!DOCTYPE a [<!ENTITY b "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx">]><a>', "&b;", "</a>", size)
    yield "<a " + " ".join(f'b{i}=""' for i in range(size // 10)) + "/>"
    yield filled('<rsel name="r">', '<process name="p"><invoke operation="x"/></process>', "</rsel>", size)


def requests(size):
    """(method, what is asked) of Connect, for each text that a method takes."""
    for query in queries(size):
        yield from (("Context/Query", {"query": query, "timeoutMs": 3000}), ("Context/Subscribe", {"query": query}),
                    ("Context/Explain", {"whyAsk": query, "timeoutMs": 3000}), ("Context/Explain", {"whyNot": query, "timeoutMs": 3000}))
    for update in updates(size):
        yield "Context/Update", {"update": update, "timeoutMs": 3000}
    for media_type, text in graphs(size):
        yield from (("Context/Assert", {"rdf": text, "rdfMediaType": media_type}),
                    ("Ontologies/Load", {"name": "m", "text": text, "mediaType": media_type, "kind": "ONTOLOGY"}),
                    ("Ontologies/Check", {"name": "m", "text": text, "mediaType": media_type, "kind": "ONTOLOGY"}),
                    ("Ontologies/Load", {"text": text, "mediaType": media_type, "kind": "DATA"}),
                    ("Ontologies/Validate", {"shapes": [{"text": text, "mediaType": media_type}]}))
    for text in rules(size):
        yield from (("Ontologies/Load", {"name": "r", "text": text, "kind": "RULES"}), ("Ontologies/PreviewRules", {"name": "r", "text": text}))
    for text in documents(size):
        yield from (("Workflows/Check", {"name": "w", "cawl": text}), ("Workflows/Deploy", {"name": "w", "cawl": text}),
                    ("Replays/Simulate", {"name": "w", "cawl": text}), ("RobotServices/Register", {"name": "r", "rsel": text}),
                    ("RobotServices/Check", {"name": "r", "rsel": text}), ("RobotServices/ImportTemplates", {"name": "i", "wsdl": text}))
    quads = [{}] * (size // 10)
    yield from (("Context/Assert", {"add": quads}), ("Context/WhatIf", {"add": quads}), ("Replays/Simulate", {"told": quads}))


STREAMED = {"Context/Query", "Context/Subscribe"}
FIELDS = {"Context/Query": 1, "Context/Update": 1, "Context/Assert": 8, "Ontologies/Load": 3, "Workflows/Check": 2, "RobotServices/Register": 2}


def varint(number):
    out = b""
    while number > 127:
        out, number = out + bytes([number & 127 | 128]), number >> 7
    return out + bytes([number])


class Bombs(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        triples = "".join(f"<urn:n{i}> <urn:p> <urn:n{i * 7 % 300}> , \"{'x' * 300}{i}\" .\n" for i in range(300))
        self.server.load(self.file("data.ttl", triples))
        self.memory = Memory(self.server.process)
        self.before = self.memory.now()
        self.others = SmallClient(self.server.http)
        self.addCleanup(self.others.end)

    def throw(self, bombs, at_once=12):
        """Calls the functions, so many at the same time, each with its answer's status in ANSWERS."""
        random.Random(1).shuffle(bombs)
        wrong = []

        def work(some):
            for name, bomb in some:
                status = bomb()
                if status not in ANSWERS:
                    wrong.append((name, status))

        all_at_once([lambda some=bombs[i::at_once]: work(some) for i in range(at_once)])
        self.assertEqual(wrong, [])
        refused, milliseconds = self.others.stop()
        self.assertEqual(refused, [])
        self.assertTrue(milliseconds)
        over = time.monotonic()
        deadline = over + 60
        while self.memory.now() > self.before + BESIDE and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertLess((self.memory.now() - self.before) / MIB, BESIDE / MIB, "it is given back")
        print(f"{self.id()}: peak {self.memory.peak / MIB:.0f} MiB, given back after {time.monotonic() - over:.1f} s; {len(milliseconds)} small "
              f"questions of another client: median {milliseconds[len(milliseconds) // 2]} ms, p99 {milliseconds[len(milliseconds) * 99 // 100]} ms")
        self.memory.going = False
        self.assertLess(self.memory.peak / MIB, (self.before + STATED * 5 / 4) / MIB)
        self.assertEqual(self.server.run("query", "ASK { }").returncode, 0)
        self.assertTrue(self.server.process.running())

    def send(self, path, body, content_type, packed, more=None):
        headers = {"Content-Type": content_type, **(more or {})}
        if packed:
            headers["Content-Encoding"] = "gzip"
        return post(self.server.http, path, gzip.compress(body, 1) if packed else body, headers)

    def test_http(self):
        bombs = []
        for packed in (False, True):
            for query in queries(MIB - 100):
                bombs.append((query[:60], lambda q=query, p=packed: self.send("/sparql?timeout=3000", q.encode(), "application/sparql-query", p)))
            for update in updates(15 * MIB if packed else 2 * MIB):
                bombs.append((update[:60], lambda u=update, p=packed: self.send("/sparql?timeout=3000", u.encode(), "application/sparql-update", p)))
            for media_type, text in graphs(40 * MIB if packed else 4 * MIB):
                bombs.append((text[:60], lambda t=text, m=media_type, p=packed: self.send("/rdf-graphs?graph=urn:g", t.encode(), m, p)))
        self.throw(bombs)

    def test_connect(self):
        bombs = []
        for method, request in requests(MIB - 100):
            body, path = json.dumps(request).encode(), f"/docent.v1.{method}"
            if method in STREAMED:
                bombs.append((method, lambda b=body, a=path: post(self.server.http, a, struct.pack(">BI", 0, len(b)) + b, {
                    "Content-Type": "application/connect+json", "Connect-Timeout-Ms": "5000"})))
            else:
                bombs.append((method, lambda b=body, a=path: self.send(a, b, "application/json", True, {"Connect-Timeout-Ms": "10000"})))
        self.throw(bombs)

    def test_live(self):
        self.throw([(query[:60], lambda q=query: self.follow(q)) for query in list(queries(MIB - 1000)) * 10])

    def follow(self, query):
        """200 when the tab has heard of its query."""
        host, port = self.server.http.rsplit(":", 1)
        with socket.create_connection((host, int(port)), timeout=60) as tab:
            tab.sendall((f"GET /live HTTP/1.1\r\nHost: {self.server.http}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                         "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").encode())
            message = json.dumps({"id": 1, "call": "docent.v1.Context/Subscribe", "request": {"query": query}}).encode()
            tab.sendall(b"\x81\xff" + struct.pack(">Q", len(message)) + b"\0\0\0\0" + message)
            heard = b""
            while b'"id":1' not in heard:
                more = tab.recv(65536)
                if not more:
                    return 0
                heard += more
        return 200

    def test_grpc(self):
        bombs = []
        for method, request in requests(MIB - 100):
            texts = [value for value in request.values() if isinstance(value, str) and len(value) > 20]
            if method not in FIELDS or not texts:
                continue
            message = varint(FIELDS[method] << 3 | 2) + varint(len(texts[0].encode())) + texts[0].encode()
            bombs.append((method, lambda m=message, a=f"/docent.v1.{method}": self.call(a, m)))
        self.throw(bombs)

    def call(self, path, message):
        client = Http2Client(self.server.grpc)
        stream = client.call(path)
        client.send(stream, struct.pack(">BI", 0, len(message)) + message, 60)
        client.wait_over(stream, 20)
        client.close()
        return 200

    def test_files_of_the_command_line(self):
        for kind, texts in (("ttl", [text for media, text in graphs(4 * MIB) if media == "text/turtle"]), ("rules", list(rules(MIB))),
                            ("rq", list(queries(MIB - 100))), ("cawl.xml", list(documents(4 * MIB)))):
            for number, text in enumerate(texts):
                with self.subTest(kind=kind, begin=text[:60]):
                    file = self.file(f"bomb{number}.{kind}", text)
                    done = subprocess.run(["prlimit", f"--as={3 << 30}", str(self.stage.bin / "docent"), "check", file],
                                          capture_output=True, text=True, timeout=240)
                    self.assertIn(done.returncode, (0, 1, 2), done.stderr[-500:])
        self.throw([])


if __name__ == "__main__":
    unittest.main()
