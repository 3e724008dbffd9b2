#!/usr/bin/env python3
"""What arrives at each door before anybody works on it: requests that are packed, half sent, or small and grow when they are read. The
server's memory stays within the budgets of docs/reference/limits.md, and others are answered meanwhile."""
import gzip
import json
import os
import socket
import struct
import threading
import time
import unittest
import urllib.error
import urllib.request

from docent_e2e import StageTest
from http2_client import Http2Client
from small_client import SmallClient

MIB = 1 << 20
HTTP_BODIES = GRPC_REQUESTS = 512 * MIB
GRPC_MEMORY = 768 * MIB
REFLECTION_CALLS = 64
FIRST_BYTES = 1024 * MIB // 4  # 256 KiB of each connection, which come on top
BESIDE = 300 * MIB  # the server itself, and FIRST_BYTES


class Memory(threading.Thread):
    """Watches the resident memory of a process, and ends it where the machine is in danger."""

    def __init__(self, process):
        super().__init__(daemon=True)
        self.pid, self.process, self.peak, self.going = process.pid, process, 0, True
        self.start()

    def now(self):
        with open(f"/proc/{self.pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def run(self):
        while self.going:
            try:
                self.peak = max(self.peak, self.now())
            except (OSError, IndexError):
                return
            if self.peak > 4096 * MIB:
                self.process.kill()
            time.sleep(0.02)


def post(address, path, body, headers):
    """The status; 0: the server cut the connection."""
    request = urllib.request.Request(f"http://{address}{path}", data=body, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=240) as reply:
            return reply.status
    except urllib.error.HTTPError as error:
        return error.code
    except OSError:
        return 0


def all_at_once(works):
    threads = [threading.Thread(target=work, daemon=True) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(300)


class Arrival(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        self.memory = Memory(self.server.process)
        self.others = SmallClient(self.server.http)
        self.addCleanup(self.others.end)

    def assert_within(self, budget, may_refuse=False):
        """The memory stayed within the budget and a quarter, and the others were answered."""
        self.memory.going = False
        refused, milliseconds = self.others.stop()
        self.assertLess(self.memory.peak / MIB, (BESIDE + budget * 5 / 4) / MIB)
        self.assertTrue(may_refuse or not refused, refused)
        self.assertTrue(milliseconds)
        self.assertEqual(self.server.run("query", "ASK { }").returncode, 0)

    def assert_all_back(self, most):
        deadline = time.monotonic() + 60
        while self.memory.now() > most and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertLess(self.memory.now() / MIB, most / MIB)

    def test_packed_bodies(self):
        """40 requests of 64 KB that unpack to 64 MiB each, by every door that takes packed bodies."""
        bombs = []
        text = gzip.compress(b'{"update":"' + b" " * (60 * MIB) + b'"}')
        bombs += [("/docent.v1.Context/Update", text, {"Content-Type": "application/json", "Content-Encoding": "gzip"})] * 10
        rdf = gzip.compress(b'{"rdf":"' + b" " * (60 * MIB) + b'"}')
        bombs += [("/docent.v1.Context/Assert", rdf, {"Content-Type": "application/json", "Content-Encoding": "gzip"})] * 20
        stream = struct.pack(">BI", 1, len(rdf)) + rdf
        bombs += [("/docent.v1.Context/AssertStream", stream, {"Content-Type": "application/connect+json", "Connect-Content-Encoding": "gzip"})] * 10
        many = gzip.compress(b'{"add":[{}' + b",{}" * (20 * MIB) + b"]}")
        bombs += [("/docent.v1.Context/Assert", many, {"Content-Type": "application/json", "Content-Encoding": "gzip"})] * 10
        bombs += [("/docent.v1.Fleet/List", text, {"Content-Type": "application/json", "Content-Encoding": "gzip"})] * 5
        update = gzip.compress(b"#" * (15 * MIB))
        bombs += [("/sparql", update, {"Content-Type": "application/sparql-update", "Content-Encoding": "gzip"})] * 20
        graph = gzip.compress(b"#" * (60 * MIB))
        bombs += [("/rdf-graphs?graph=urn:g", graph, {"Content-Type": "text/turtle", "Content-Encoding": "gzip"})] * 20
        statuses = []
        all_at_once([lambda bomb=bomb: statuses.append(post(self.server.http, *bomb)) for bomb in bombs])
        self.assertEqual(len(statuses), len(bombs))
        self.assertTrue(set(statuses) <= {200, 201, 400, 413, 429, 503, 504}, statuses)
        self.assert_within(HTTP_BODIES + GRPC_REQUESTS)
        self.assertTrue(self.server.process.running())

    def half_calls(self, path, connections, calls, size, announced):
        """So many calls on each connection, of each of which a part of the message comes. The clients, and how much they could send."""
        clients = [Http2Client(self.server.grpc) for _ in range(connections)]
        self.addCleanup(lambda: [client.close() for client in clients])
        sent = []
        message = struct.pack(">BI", 0, announced) + b"\0" * size

        def one(client):
            sent.append(client.send(client.call(path), message, 3))

        all_at_once([lambda client=client: one(client) for client in clients for _ in range(calls)])
        return clients, sum(sent)

    def test_half_messages_of_documents(self):
        """One connection with 80 calls that each send a message of 65 MiB but for its end."""
        clients, sent = self.half_calls("/docent.v1.Ontologies/Load", 1, 80, 64 * MIB, 64 * MIB + 1000)
        self.assertLess(sent / MIB, GRPC_REQUESTS / MIB)
        self.assertIn("added", self.server.command("tell", "<urn:a> <urn:b> 1"))
        [client.close() for client in clients]
        self.assert_within(GRPC_REQUESTS)
        self.assert_all_back(BESIDE)

    def test_half_messages_of_many_connections(self):
        clients, sent = self.half_calls("/docent.v1.Workflows/Deploy", 40, 2, 60 * MIB, 60 * MIB + 1000)
        self.assertLess(sent / MIB, GRPC_REQUESTS * 5 / 4 / MIB)
        self.assertIn("added", self.server.command("tell", "<urn:a> <urn:b> 1"))
        [client.close() for client in clients]
        self.assert_within(GRPC_REQUESTS)
        self.assert_all_back(BESIDE)

    def test_half_messages_of_streams_and_of_any_length(self):
        """Messages that say that they are larger than any method takes, and those of streams, are within what gRPC may hold."""
        clients, _ = self.half_calls("/docent.v1.Fleet/List", 1, 20, 100 * MIB, 4000 * MIB)
        more, _ = self.half_calls("/docent.v1.Context/AssertStream", 2, 20, 60 * MIB, 60 * MIB + 1000)
        [client.close() for client in clients + more]
        self.assert_within(GRPC_MEMORY)
        self.assert_all_back(BESIDE)

    def test_half_messages_of_health(self):
        clients, _ = self.half_calls("/grpc.health.v1.Health/Check", 4, 30, 15 * MIB, 15 * MIB + 1000)
        self.assertIn("added", self.server.command("tell", "<urn:a> <urn:b> 1"))
        [client.close() for client in clients]
        self.assert_within(GRPC_MEMORY)
        self.assert_all_back(BESIDE)

    def test_half_messages_of_reflection(self):
        """Each call holds a thread: there are so many at the same time, and the others are refused. All end in grpc_arrival_ms."""
        client = Http2Client(self.server.grpc)
        self.addCleanup(client.close)
        streams = [client.call("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo") for _ in range(200)]
        for stream in streams:
            client.send(stream, struct.pack(">BI", 0, 1000) + b"\0", 5)
        deadline = time.monotonic() + 60
        while sum(client.over(stream) for stream in streams) < len(streams) - REFLECTION_CALLS and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertLess(len(os.listdir(f"/proc/{self.server.process.pid}/task")), REFLECTION_CALLS + 60)
        for stream in streams:
            self.assertTrue(client.wait_over(stream, 120))
        self.assertFalse(client.closed, "the connection is whole, and its other calls go on")

    def test_a_half_message_has_its_time(self):
        """The server ends a call whose message does not come, in grpc_arrival_ms."""
        client = Http2Client(self.server.grpc)
        self.addCleanup(client.close)
        stream = client.call("/docent.v1.Fleet/List")
        client.send(stream, struct.pack(">BI", 0, 1000) + b"\0", 5)
        self.assertTrue(client.wait_over(stream, 120))
        self.assertFalse(client.closed, "the connection is whole, and its other calls go on")

    def test_small_half_bodies(self):
        """The first 256 KiB of each connection are in no budget: all of them together are what the limits state."""
        before, sockets = self.memory.now(), []
        self.addCleanup(lambda: [one.close() for one in sockets])
        host, port = self.server.http.rsplit(":", 1)
        head = (f"POST /docent.v1.Context/Assert HTTP/1.1\r\nHost: {self.server.http}\r\nContent-Type: application/json\r\n"
                f"Content-Length: {MIB // 4}\r\n\r\n").encode()
        for _ in range(1000):
            one = socket.create_connection((host, int(port)), timeout=60)
            sockets.append(one)
            one.sendall(head + b" " * (MIB // 4 - 1))
        self.assertIn("added", self.server.command("tell", "<urn:a> <urn:b> 1"))
        self.assertLess(self.memory.peak / MIB, (before + FIRST_BYTES * 5 / 4) / MIB + 64)
        self.memory.going = False
        self.assertEqual(self.server.run("query", "ASK { }").returncode, 0)
        self.assertEqual(self.others.stop()[0], [])
        [one.close() for one in sockets]
        self.assert_all_back(BESIDE)

    def test_half_messages_of_live_and_half_bodies(self):
        """900 begun messages of tabs, and half bodies of HTTP."""
        sockets = []
        self.addCleanup(lambda: [one.close() for one in sockets])
        host, port = self.server.http.rsplit(":", 1)

        def begin(head, data):
            one = socket.create_connection((host, int(port)), timeout=60)
            sockets.append(one)
            one.sendall(head)
            if data[0] == 0x01:
                one.recv(4096)
            try:
                one.sendall(data)
            except OSError:
                pass

        upgrade = (f"GET /live HTTP/1.1\r\nHost: {self.server.http}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                   "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").encode()
        message = b"\x01\xff" + struct.pack(">Q", 1000000) + b"\0\0\0\0" + b" " * 1000000
        body = f"POST /docent.v1.Context/Assert HTTP/1.1\r\nHost: {self.server.http}\r\nContent-Type: application/json\r\nContent-Length: {60 * MIB}\r\n\r\n".encode()
        for _ in range(9):
            all_at_once([lambda: begin(upgrade, message)] * 100)
        all_at_once([lambda: begin(body, b" " * (59 * MIB))] * 20)
        self.assertIn("added", self.server.command("tell", "<urn:a> <urn:b> 1"))
        [one.close() for one in sockets]
        self.assert_within(HTTP_BODIES + 256 * MIB, may_refuse=True)  # beyond the number of connections
        self.assert_all_back(BESIDE)


if __name__ == "__main__":
    unittest.main()
