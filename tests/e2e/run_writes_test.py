#!/usr/bin/env python3
"""What workflows tell, compute and give back, with real processes: facts of a run outlive a kill -9 and say who told them, and a
webhook is notified at least once, with one CloudEvents id, though it fails and the server is killed meanwhile."""
import http.server
import json
import shutil
import socket
import threading
import time
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

HEAD = """<CAWL name="{name}" version="1.0" xmlns:w="urn:w:" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="{name}">
    <variable name="user"/>
    <variable name="n" type="xsd:integer"/>
    <source name="s"/>
"""
FOOT = """    <sink name="e"/>
    <link from="s" to="A"/>
    <link from="A" to="B"/>
    <link from="B" to="e"/>
    <ext:output part="count" variable="n"/>
  </flow>
</CAWL>
"""


class Receiver(http.server.ThreadingHTTPServer):
    """A webhook that refuses its first `fails` events, and keeps all of them."""

    def __init__(self, fails):
        receiver = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                event = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                receiver.events.append((self.headers["Content-Type"], event))
                ok = len(receiver.events) > fails
                self.send_response(204 if ok else 503)
                self.end_headers()

            def log_message(self, *_):
                pass

        super().__init__(("127.0.0.1", 0), Handler)
        self.events = []
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_address[1]}/hook"


class Writes(StageTest):
    def deploy(self, server, name, nodes):
        server.load(self.file(f"{name}.cawl.xml", HEAD.format(name=name) + nodes + FOOT))

    def state_of(self, server, run):
        rows = server.select(f"SELECT ?s {{ <urn:docent:run:{run}> docent:runState ?s }}")
        return rows[0]["s"] if rows else ""

    def test_facts_of_a_run_stay_and_say_who_told_them(self):
        server = self.stage.server()
        self.deploy(server, "Count", """
    <node name="A">
      <ext:tell>$user a w:Guest</ext:tell>
      <ext:tell lifetime="run">$user w:is w:counted</ext:tell>
      <ext:assign>SELECT (COUNT(?guest) AS ?n) WHERE { ?guest a w:Guest }</ext:assign>
    </node>
    <node name="B"><ext:tell>$user w:number $n</ext:tell><ext:withdraw source="any">w:Desk w:waits ?forSomething</ext:withdraw></node>
""")
        server.tell("<urn:w:Desk> <urn:w:waits> 7")
        server.command("run", "Count", "--var", "user=<urn:w:John>")
        server.wait_for("<urn:w:John> <urn:w:number> 1", PATIENCE_S)
        self.assertEqual(self.state_of(server, "Count-1"), "done")
        for _ in range(2):
            self.assertFalse(server.ask("<urn:w:John> <urn:w:is> <urn:w:counted>"))
            self.assertFalse(server.ask("<urn:w:Desk> <urn:w:waits> ?x"))
            graphs = server.select("SELECT ?g { GRAPH ?g { <urn:w:John> <urn:w:number> 1 } }")
            self.assertEqual([row["g"] for row in graphs], ["urn:docent:run:Count-1"])
            server.kill()
            server.start()
        self.assertIn("Count-1", server.run("why", "<urn:w:John> <urn:w:number> 1").stdout)
        run = json.loads(server.run("runs", "Count-1", "--json").stdout.splitlines()[0])
        self.assertEqual(run["results"][0]["name"], "count")
        self.assertIn("result count = 1", server.run("runs", "Count-1").stdout)

    def test_a_webhook_that_fails_twice_is_notified_over_a_kill(self):
        hook = Receiver(fails=2)
        self.addCleanup(hook.shutdown)
        server = self.stage.server(arguments=["--notify", hook.url])
        self.deploy(server, "Call", f"""
    <node name="A"><ext:assign variable="n" expression="7"/>
      <ext:notify to="{hook.url}" type="org.example.arrived" subject="$user" variables="user n" wait="true"/></node>
    <node name="B"><ext:tell>$user w:is w:notified</ext:tell></node>
""")
        server.command("run", "Call", "--detach", "--var", "user=<urn:w:John>")
        stage.wait_until(lambda: hook.events, PATIENCE_S, "the first attempt")
        self.assertFalse(server.ask("<urn:w:John> <urn:w:is> <urn:w:notified>"))
        server.kill()
        server.start()
        server.wait_for("<urn:w:John> <urn:w:is> <urn:w:notified>", PATIENCE_S)
        self.assertGreaterEqual(len(hook.events), 3)
        self.assertEqual({event["id"] for _, event in hook.events}, {hook.events[0][1]["id"]})
        kind, event = hook.events[-1]
        self.assertTrue(kind.startswith("application/cloudevents+json"), kind)
        self.assertEqual(event["specversion"], "1.0")
        self.assertEqual(event["type"], "org.example.arrived")
        self.assertEqual(event["source"], "urn:docent:run:Call-1")
        self.assertEqual(event["subject"], "urn:w:John")
        self.assertEqual(event["data"], {"user": "urn:w:John", "n": 7})
        # what was delivered is not sent again
        sent = len(hook.events)
        server.kill()
        server.start()
        time.sleep(2)
        self.assertEqual(len(hook.events), sent)

    def test_an_address_that_is_not_allowed_is_a_recorded_failure(self):
        hook = Receiver(fails=0)
        self.addCleanup(hook.shutdown)
        server = self.stage.server()
        self.deploy(server, "Call", f"""
    <node name="A"><ext:notify to="{hook.url}" wait="true"/></node><node name="B"/>
""")
        self.assertEqual(server.run("run", "Call").returncode, 1)
        server.wait_for("?run docent:runState 'failed'", PATIENCE_S)
        self.assertIn("--notify", server.run("runs", "Call-1").stdout)
        self.assertEqual(hook.events, [])

    def test_a_topic_of_a_broker(self):
        broker = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
        if broker is None:
            self.skipTest("mosquitto is not installed: MQTT is not tried with a real broker")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        config = self.file("mosquitto.conf", f"listener {port} 127.0.0.1\nallow_anonymous true\nlog_dest stderr\nlog_type all\n")
        process = self.stage.start("mosquitto", [broker, "-c", config])
        server = self.stage.server(arguments=["--mqtt", f"127.0.0.1:{port}"])
        self.deploy(server, "Call", """
    <node name="A"><ext:notify to="mqtt:hall/arrived" variables="user" wait="true"/></node>
    <node name="B"><ext:tell>$user w:is w:notified</ext:tell></node>
""")
        server.command("run", "Call", "--var", "user=<urn:w:John>")
        server.wait_for("<urn:w:John> <urn:w:is> <urn:w:notified>", PATIENCE_S)
        process.wait_for_output("'hall/arrived'", 10)


if __name__ == "__main__":
    unittest.main()
