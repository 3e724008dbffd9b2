#!/usr/bin/env python3
"""The API for browsers on a real server: every method by the Connect protocol, streams that come as they happen, live
connections that lose nothing and double nothing while the server is killed, pages of other servers, the app's files."""
import base64
import gzip
import http.client
import json
import os
import pathlib
import re
import socket
import struct
import threading
import time
import unittest
import urllib.parse

from docent_e2e import PATIENCE_S, StageTest, stage

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXPO = "https://w3id.org/docent/expo#"


def methods():
    """(service, method, client streams, server streams, only reads) of all that a server has, from proto."""
    found = []
    for file in sorted((ROOT / "proto/docent/v1").glob("*.proto")):
        for service in re.finditer(r"^service (\w+) \{(.*?)^\}", file.read_text(), re.MULTILINE | re.DOTALL):
            if service.group(1) == "RobotAdapter":
                continue  # of robots
            for rpc in re.finditer(r"rpc (\w+)\((stream )?\w+\) returns \((stream )?\w+\)(.*)$", service.group(2), re.MULTILINE):
                found.append((service.group(1), rpc.group(1), bool(rpc.group(2)), bool(rpc.group(3)),
                              "NO_SIDE_EFFECTS" in rpc.group(4)))
    return found


def envelope(data, flags=0):
    return struct.pack(">BI", flags, len(data)) + data


class Tab:
    """A WebSocket at /live, by hand."""

    def __init__(self, address, timeout=PATIENCE_S, **headers):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=timeout)
        self.socket.settimeout(timeout)
        lines = [f"GET /live HTTP/1.1", f"Host: {address}", "Connection: Upgrade", "Upgrade: websocket",
                 "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(),
                 *(f"{name}: {value}" for name, value in headers.items())]
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        while self.file.readline().strip():
            pass

    def send(self, **message):
        data = json.dumps(message).encode()
        mask = os.urandom(4)
        length = bytes([0x80 | len(data)]) if len(data) < 126 else struct.pack(">BH", 0x80 | 126, len(data))
        self.socket.sendall(b"\x81" + length + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def receive(self):
        """The next message; ConnectionError at the end of the connection."""
        while True:
            head = self.file.read(2)
            if len(head) < 2:
                raise ConnectionError("the server has gone")
            length = head[1]
            if length == 126:
                length, = struct.unpack(">H", self.file.read(2))
            elif length == 127:
                length, = struct.unpack(">Q", self.file.read(8))
            payload = self.file.read(length)
            if len(payload) < length:
                raise ConnectionError("the server has gone")
            if head[0] == 0x81:
                return json.loads(payload)
            if head[0] == 0x88:
                raise ConnectionError(payload[2:].decode())

    def close(self):
        self.file.close()
        self.socket.close()


class Web(StageTest):
    def request(self, method, path, body=None, headers=None, host=None):
        connection = http.client.HTTPConnection(host or self.server.http, timeout=60)
        self.addCleanup(connection.close)
        connection.request(method, path, body, headers or {})
        reply = connection.getresponse()
        return reply, reply.read()

    def call(self, method, message=None, **headers):
        """(status, answer) of a unary call in JSON."""
        reply, body = self.request("POST", f"/docent.v1.{method}", json.dumps(message or {}),
                                   {"Content-Type": "application/json", **headers})
        return reply.status, json.loads(body)

    def stream(self, method, message=None):
        """The connection and its answer, to be read as it comes."""
        connection = http.client.HTTPConnection(self.server.http, timeout=60)
        self.addCleanup(connection.close)
        connection.request("POST", f"/docent.v1.{method}", envelope(json.dumps(message or {}).encode()),
                           {"Content-Type": "application/connect+json", "Connect-Protocol-Version": "1"})
        return connection, connection.getresponse()

    def tab(self, **headers):
        tab = Tab(self.server.http, **headers)
        self.addCleanup(tab.close)
        return tab

    @staticmethod
    def next_message(reply):
        """(flags, message)"""
        head = reply.read(5)
        flags, length = struct.unpack(">BI", head)
        return flags, json.loads(reply.read(length))


class Calls(Web):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        stage.load_s01(self.server)

    def test_every_method_is_there_without_code_of_its_own(self):
        found = methods()
        self.assertGreater(len(found), 35)
        for service, method, client, server, reads in found:
            with self.subTest(f"{service}.{method}"):
                path = f"/docent.v1.{service}/{method}"
                # A field that no message has: the bridge knows the type, and nothing is done.
                bad = b'{"noSuchField":1}'
                if client or server:
                    reply, body = self.request("POST", path, envelope(bad), {"Content-Type": "application/connect+json"})
                    self.assertEqual(reply.status, 200)
                    error = json.loads(body[5:])["error"]
                else:
                    reply, body = self.request("POST", path, bad, {"Content-Type": "application/json"})
                    self.assertEqual(reply.status, 400)
                    error = json.loads(body)
                self.assertEqual(error["code"], "invalid_argument")
                self.assertIn("noSuchField", error["message"])
                reply, body = self.request("GET", path + "?encoding=json&message=%7B%22noSuchField%22%3A1%7D")
                self.assertEqual(reply.status, 400 if reads and not client and not server else 405, body)

    def test_facts_are_told_and_asked_in_json_and_binary(self):
        status, told = self.call("Context/Assert", {"rdf": "<urn:a> <urn:b> \"ü\" .", "requestId": "once"})
        self.assertEqual((status, told["added"]), (200, "1"))
        self.assertEqual(self.call("Context/Assert", {"rdf": "<urn:a> <urn:b> \"ü\" .", "requestId": "once"})[1]["repeated"], True)
        _, reply = self.stream("Context/Query", {"query": "SELECT ?o { <urn:a> <urn:b> ?o }", "minRevision": told["offset"]})
        self.assertEqual(self.next_message(reply)[1]["header"]["variables"], ["o"])
        self.assertEqual(self.next_message(reply), (0, {"row": {"values": [{"literal": {"lexical": "ü"}}]}}))
        self.assertEqual(self.next_message(reply), (2, {}))
        reply, body = self.request("POST", "/docent.v1.Fleet/List", b"", {"Content-Type": "application/proto"})
        self.assertEqual((reply.status, reply.headers["Content-Type"]), (200, "application/proto"))

    def test_reads_by_get_and_packed(self):
        message = urllib.parse.quote(json.dumps({"workflow": "BoothGuide", "withTexts": True}))
        target = f"/docent.v1.Workflows/List?connect=v1&encoding=json&message=%7B%7D"
        reply, body = self.request("GET", target)
        self.assertEqual(json.loads(body)["workflows"][0]["name"], "BoothGuide")
        coded = base64.urlsafe_b64encode(b"{}").decode().rstrip("=")
        self.assertEqual(self.request("GET", target.replace("%7B%7D", coded) + "&base64=1")[1], body)
        reply, packed = self.request("GET", "/docent.v1.Ontologies/Prefixes?encoding=json&message=%7B%7D", None,
                                     {"Accept-Encoding": "gzip"})
        self.assertIn("prefixes", json.loads(gzip.decompress(packed) if reply.headers["Content-Encoding"] else packed))
        reply, body = self.request("POST", "/docent.v1.Context/Assert", gzip.compress(b'{"rdf":"<urn:g> <urn:z> 1 ."}'),
                                   {"Content-Type": "application/json", "Content-Encoding": "gzip"})
        self.assertEqual((reply.status, json.loads(body)["added"]), (200, "1"))
        self.assertEqual(self.request("GET", f"/docent.v1.Workflows/Check?encoding=json&message={message}")[0].status, 400)

    def test_errors_are_those_of_the_services(self):
        status, error = self.call("Context/Assert", {"rdf": "<urn:a> <urn:b> ."})
        self.assertEqual((status, error["code"]), (400, "invalid_argument"))
        self.assertIn("1:", error["message"])
        self.assertEqual(self.call("Workflows/Get", {"run": "nothing"})[0], 404)
        status, error = self.call("Context/Explain", {"whyAsk": "ASK { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"},
                                  **{"Connect-Timeout-Ms": "0"})
        self.assertEqual((status, error["code"]), (504, "deadline_exceeded"))
        for headers, code in (({"Connect-Protocol-Version": "2"}, 400), ({"Content-Encoding": "br"}, 501),
                              ({"Content-Type": "text/plain"}, 415), ({"Connect-Timeout-Ms": "soon"}, 400)):
            self.assertEqual(self.call("Fleet/List", {}, **headers)[0], code, headers)
        self.assertEqual(self.call("Fleet/Nothing")[0], 404)

    def test_a_stream_comes_as_it_happens_and_ends_with_its_reader(self):
        connection, reply = self.stream("Context/Subscribe", {"query": "SELECT ?o { <urn:s> <urn:p> ?o }"})
        _, first = self.next_message(reply)
        self.assertTrue(first["reset"])
        for number in range(3):
            self.server.tell(f"<urn:s> <urn:p> {number}")
            flags, change = self.next_message(reply)
            self.assertEqual((flags, change["appeared"][0]["row"]["values"][0]["literal"]["lexical"]), (0, str(number)))
        connection.sock.shutdown(socket.SHUT_RDWR)
        connection.close()
        stage.wait_until(lambda: self.server.metrics()["docent_subscriptions"] == 0, PATIENCE_S, "the end of the subscription")

    def test_many_streams_leave_room_for_calls(self):
        streams = [self.stream("Workflows/Watch") for _ in range(40)]
        self.assertEqual(self.call("Fleet/List")[0], 200)
        for connection, _ in streams:
            connection.close()
        self.assertEqual(self.call("Fleet/List")[0], 200)

    def test_a_batch_of_batches_in_one_stream(self):
        body = b"".join(envelope(json.dumps({"rdf": f"<urn:n{i}> <urn:p> {i} ."}).encode()) for i in range(20))
        reply, answer = self.request("POST", "/docent.v1.Context/AssertStream", body, {"Content-Type": "application/connect+json"})
        replies, at = [], 0
        while at < len(answer):
            flags, length = struct.unpack(">BI", answer[at:at + 5])
            replies.append((flags, json.loads(answer[at + 5:at + 5 + length])))
            at += 5 + length
        self.assertEqual([flags for flags, _ in replies], [0] * 20 + [2])
        self.assertTrue(all("offset" in one["reply"] for _, one in replies[:-1]))


class Pages(Web):
    """Who may use it, and the app's files."""

    def setUp(self):
        super().setUp()
        app = self.stage.folder / "app"
        (app / "assets").mkdir(parents=True)
        (app / "index.html").write_text('<!doctype html><script nonce="docent-csp-nonce" src="/assets/index-0123abcd.js"></script>')
        (app / "assets/index-0123abcd.js").write_text("console.log(1)\n" * 500)
        self.server = self.stage.server(arguments=["--http-origin", "http://app.example:5173", "--web", app])

    def test_pages_of_other_servers_are_refused_unless_they_are_allowed(self):
        ask = {"Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "content-type"}
        good, evil = {"Origin": "http://app.example:5173"}, {"Origin": "http://evil.example"}
        reply, _ = self.request("OPTIONS", "/docent.v1.Fleet/List", None, {**ask, **good})
        self.assertEqual((reply.status, reply.headers["Access-Control-Allow-Origin"]), (200, good["Origin"]))
        self.assertEqual(self.request("OPTIONS", "/docent.v1.Fleet/List", None, {**ask, **evil})[0].status, 403)
        self.assertEqual(self.call("Fleet/List", {}, **good)[0], 200)
        reply, _ = self.request("POST", "/docent.v1.Fleet/List", "{}", {"Content-Type": "application/json", **evil})
        self.assertEqual(reply.status, 403)
        self.assertEqual(self.tab(**evil).status, 403)
        self.assertEqual(self.tab(**good).status, 101)
        reply, _ = self.request("GET", "/docent.v1.Fleet/List?encoding=json&message=%7B%7D", None, {"Sec-Fetch-Site": "cross-site"})
        self.assertEqual(reply.status, 403)
        reply, _ = self.request("POST", "/sparql", "ASK {}", {"Content-Type": "application/sparql-query", **good})
        self.assertEqual((reply.status, reply.headers["Access-Control-Allow-Origin"]), (200, good["Origin"]))

    def test_the_app_is_served(self):
        reply, page = self.request("GET", "/", None, {"Accept": "text/html"})
        nonce = re.search(rb'nonce="([^"]+)"', page).group(1).decode()
        self.assertIn(f"'nonce-{nonce}'", reply.headers["Content-Security-Policy"])
        self.assertIn(b"<script", self.request("GET", "/runs/x", None, {"Accept": "text/html"})[1])
        reply, script = self.request("GET", "/assets/index-0123abcd.js", None, {"Accept-Encoding": "gzip"})
        self.assertIn("immutable", reply.headers["Cache-Control"])
        self.assertTrue(gzip.decompress(script).startswith(b"console"))
        reply, body = self.request("GET", "/assets/index-0123abcd.js", None,
                                   {"Accept-Encoding": "gzip", "If-None-Match": reply.headers["ETag"]})
        self.assertEqual((reply.status, body), (304, b""))
        self.assertEqual(self.request("GET", "/nothing.js")[0].status, 404)
        self.assertEqual(self.request("GET", "/healthz")[1], b"ok\n")

    def test_a_folder_that_is_no_app_and_an_origin_that_is_none(self):
        for arguments, word in ((["--web", self.stage.folder / "none"], "--web"), (["--http-origin", "app.example/x"], "origin")):
            done = self.docent("serve", "--data", self.stage.folder / "other", "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", *arguments)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(word, done.stderr)


class Follower(threading.Thread):
    """A tab that follows runs, an answer and robots, and comes back whenever it loses the server."""

    QUERY = "SELECT ?n { ?x <urn:count> ?n }"

    def __init__(self, server, address):
        super().__init__(daemon=True)
        self.server, self.address = server, address
        self.calls = {1: {"call": "docent.v1.Workflows/Watch"},
                      2: {"call": "docent.v1.Context/Subscribe", "request": {"query": self.QUERY}},
                      3: {"call": "docent.v1.Fleet/List", "everyMs": 50}}
        self.begun, self.stopped = threading.Event(), threading.Event()
        self.events, self.numbers, self.robots, self.resets, self.connections = [], set(), [], 0, 0
        self.part, self.first, self.trouble = None, None, []

    def run(self):
        while not self.stopped.is_set():
            try:
                self.follow(Tab(self.address(), timeout=5))
            except (OSError, ConnectionError, IndexError):
                time.sleep(0.02)

    def follow(self, tab):
        self.connections += 1
        self.part = None  # of a change whose end did not come
        tab.receive()
        for number, call in self.calls.items():
            tab.send(id=number, **call)
        while not self.stopped.is_set():
            message = tab.receive()
            if "end" in message or "refused" in message:
                code = message.get("end", {}).get("error", {}).get("code")
                if code not in ("unavailable", "canceled"):  # of a server that stops
                    self.trouble.append(message)
                continue
            self.take(message)
            if "resume" in message:
                self.calls[message["id"]]["resume"] = message["resume"]
        tab.close()

    def take(self, message):
        if "begun" in message:
            self.first = self.first or (message.get("resume") if message["id"] == 1 else None)
            return
        body = message["message"]
        if message["id"] == 1:
            self.events.append(body)
        elif message["id"] == 2:
            self.part = self.part or {"reset": body.get("reset"), "appeared": [], "gone": []}
            for name, rows in (("appeared", "appeared"), ("gone", "disappeared")):
                self.part[name] += [row["row"]["values"][0]["literal"]["lexical"] for row in body.get(rows, [])]
            if not body.get("more"):
                self.resets += bool(self.part["reset"])
                if self.part["reset"]:
                    self.numbers = set()
                for number in self.part["appeared"]:
                    if number in self.numbers:
                        self.trouble.append(f"{number} came twice")
                    self.numbers.add(number)
                self.numbers -= set(self.part["gone"])
                self.part = None
        else:
            self.robots.append(body)
            self.begun.set()


class Live(Web):
    def test_a_tab_loses_nothing_and_gets_nothing_twice_while_the_server_is_killed(self):
        self.server, _ = self.start_s01()
        tab = Follower(self.server, lambda: self.server.http)
        tab.start()
        self.assertTrue(tab.begun.wait(PATIENCE_S))
        visitor = stage.Visitor(self.server, "B03", PATIENCE_S)
        visitor.start()
        told, kills = 0, 0
        while not self.done():
            for _ in range(5):
                self.tell(told)
                told += 1
            if kills < 4:
                self.server.kill()
                kills += 1
                self.server.start()
        visitor.join(PATIENCE_S)
        self.assertIsNone(visitor.error)
        after = int(tab.first.split(":")[0])
        expected = self.events_after(after)
        stage.wait_until(lambda: len(tab.events) >= len(expected) and len(tab.numbers) >= told, PATIENCE_S,
                         f"{len(expected)} events and {told} rows")
        tab.stopped.set()
        self.server.tell("<urn:last> <urn:count> -1")
        tab.join(PATIENCE_S)
        self.assertEqual(tab.events, expected)
        self.assertEqual(tab.trouble, [])
        self.assertGreater(tab.connections, kills)
        self.assertEqual(tab.robots[-1]["robots"][0]["robot"], EXPO + "R01")

    def done(self):
        try:
            return self.server.ask("?run docent:runState 'done'")
        except OSError:
            return False

    def tell(self, number):
        def attempt():
            try:
                return self.server.tell(f"<urn:x:{number}> <urn:count> {number}", request_id=f"count-{number}")
            except (stage.StageError, OSError):
                return None
        stage.wait_until(attempt, PATIENCE_S, f"fact {number}")

    def events_after(self, revision):
        """All events of turns after `revision`, as a client that was never disturbed has them."""
        tab = self.tab()
        tab.receive()
        tab.send(id=1, call="docent.v1.Workflows/Watch", resume=f"{revision}:0")
        tab.receive()
        tab.socket.settimeout(2)
        events = []
        try:
            while True:
                events.append(tab.receive()["message"])
        except (TimeoutError, socket.timeout):
            return events

    def test_a_tab_that_is_slow_does_not_hold_others(self):
        self.server = self.stage.server()
        slow = self.tab()
        slow.send(id=1, call="docent.v1.Context/Subscribe", request={"query": "SELECT * { ?s ?p ?o }"})
        quick = self.tab()
        quick.receive()
        quick.send(id=1, call="docent.v1.Context/Subscribe", request={"query": "ASK { <urn:a> <urn:b> 199 }"})
        self.assertEqual(quick.receive()["begun"], True)
        self.assertTrue(quick.receive()["message"]["reset"])
        for number in range(200):
            self.call("Context/Assert", {"rdf": f'<urn:a> <urn:b> {number}, "{"x" * 50000}{number}" .'})
        self.assertEqual(quick.receive()["message"]["boolean"], True)
        self.assertEqual(self.call("Fleet/List")[0], 200)


if __name__ == "__main__":
    unittest.main(verbosity=2)
