#!/usr/bin/env python3
"""What many clients, or slow ones, do to a server that may have few files open: others are served all the same, /healthz tells
the truth, and when they have gone all is as before."""
import resource
import shutil
import signal
import socket
import subprocess
import threading
import time
import unittest
import urllib.error
import urllib.parse
import urllib.request

from docent_e2e import StageTest


def connect(address):
    host, port = address.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=60)


def get(address, path, timeout=60):
    """(status, text)"""
    try:
        with urllib.request.urlopen(f"http://{address}{path}", timeout=timeout) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


class Overload(StageTest):
    def server(self, files, *arguments):
        if shutil.which("prlimit") is None:
            self.skipTest("prlimit is not installed")
        return self.stage.server(wrapper=["prlimit", f"--nofile={files}"], arguments=arguments)

    def close_all(self, sockets):
        for one in sockets:
            one.close()

    def test_too_few_files_are_a_clear_error(self):
        done = subprocess.run(["prlimit", "--nofile=22", str(self.stage.bin / "docent"), "serve", "--data", str(self.stage.folder / "d"),
                               "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0"], capture_output=True, text=True, timeout=60)
        self.assert_refused(done, 2, "may have 22 files open", "ulimit -n")

    def test_the_soft_limit_is_raised(self):
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        server = self.server(f"64:{hard}")
        with open(f"/proc/{server.process.pid}/limits") as limits:
            files = next(line.split() for line in limits if line.startswith("Max open files"))
        self.assertEqual(files[3], files[4])

    def test_silent_grpc_connections_silence_nobody(self):
        """With all the places of the gRPC port taken by connections that say nothing, HTTP and gRPC answer."""
        server = self.server(128)
        silent = [connect(server.grpc) for _ in range(300)]
        self.addCleanup(self.close_all, silent)
        self.assertEqual(get(server.http, "/healthz"), (200, "ok\n"))
        self.assertIn("added", server.command("tell", "<urn:a> <urn:b> 1"))
        self.assertEqual(server.run("query", "ASK { <urn:a> <urn:b> 1 }").returncode, 0)
        self.close_all(silent)
        self.assertEqual(server.run("query", "ASK { <urn:a> <urn:b> 1 }").returncode, 0)
        self.assertTrue(server.process.running())

    def test_both_doors_open_again_when_the_clients_have_gone(self):
        server = self.server(128)
        for _ in range(3):
            sockets = [connect(address) for _ in range(200) for address in (server.grpc, server.http)]
            self.close_all(sockets)
        answers = (server.run("query", "ASK { }").returncode == 0 for _ in range(20))  # the server sees their ends one by one
        self.assertTrue(any(answers))
        self.assertEqual(get(server.http, "/healthz"), (200, "ok\n"))

    def test_slow_http_clients_turn_nobody_away(self):
        """As many connections as there are places, each with a request that does not end."""
        server = self.server(256)
        begins = [b"GET /healthz HTTP/1.1\r\nX-Slow: ", b"", b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nx"]
        slow = [connect(server.http) for _ in range(300)]
        self.addCleanup(self.close_all, slow)
        for i, one in enumerate(slow):
            try:
                one.sendall(begins[i % 2])
            except OSError:
                pass  # made room for others already
        for _ in range(20):
            self.assertEqual(get(server.http, "/healthz"), (200, "ok\n"))

    def test_an_ask_passes_heavy_queries(self):
        server = self.stage.server()
        triples = "".join(f"<urn:n{i}> <urn:p> <urn:n{i * 7 % 300}> , <urn:n{(i + 1) % 300}> .\n" for i in range(300))
        server.load(self.file("data.ttl", triples))
        heavy = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l FILTER(STRLEN(STR(?d)) < 0) }"
        threads = [threading.Thread(target=get, args=(server.http, "/sparql?" + urllib.parse.urlencode({"query": heavy, "timeout": 8000})))
                   for _ in range(40)]
        for thread in threads:
            thread.start()
        time.sleep(1)
        waits = []
        for _ in range(10):
            start = time.monotonic()
            self.assertTrue(server.ask("<urn:n1> <urn:p> <urn:n7>"))
            waits.append(time.monotonic() - start)
        self.assertLess(sorted(waits)[5], 4, waits)  # without places for short ones: as long as the heavy ones have
        for thread in threads:
            thread.join()

    def test_a_hangup_is_an_orderly_end(self):
        server = self.stage.server()
        server.tell("<urn:a> <urn:b> 1")
        server.process.signal(signal.SIGHUP)
        self.assertEqual(server.process.popen.wait(60), 0)
        snapshots = list((self.stage.folder / "data").glob("snapshot-*"))
        self.assertTrue(snapshots, "it left its state, as at every orderly end")

    def test_under_nohup_a_hangup_is_nothing(self):
        server = self.stage.server(wrapper=["nohup"])
        server.process.signal(signal.SIGHUP)
        time.sleep(1)
        self.assertTrue(server.process.running())
        self.assertEqual(get(server.http, "/healthz"), (200, "ok\n"))


if __name__ == "__main__":
    unittest.main()
