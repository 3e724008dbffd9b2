#!/usr/bin/env python3
"""How the command line shows results: names of IRIs, tables, colours, JSON, exit codes, output that cannot be written."""
import fcntl
import json
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import unittest

from docent_e2e import StageTest, stage

EXPO = "https://w3id.org/docent/expo#"
ESCAPE = "\x1b"


class Manners(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()

    def on_terminal(self, *arguments, columns=80, env=None):
        """What a command prints where its standard output is a terminal of that width."""
        leader, follower = pty.openpty()
        fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen(
            [self.stage.bin / "docent", *arguments], stdout=follower, stderr=subprocess.PIPE,
            env={**os.environ, "DOCENT_SERVER": self.server.grpc, "TERM": "xterm", "NO_COLOR": "", **(env or {})})
        os.close(follower)
        text = b""
        while select.select([leader], [], [], 60)[0]:
            try:
                part = os.read(leader, 65536)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
        process.communicate(timeout=60)
        os.close(leader)
        return text.decode().replace("\r\n", "\n")

    # ---- tables

    def test_names_that_other_commands_take_stay_whole_on_a_narrow_terminal(self):
        name = "rounds_of_the_nurses_on_the_second_floor_of_the_east_wing"
        flow = f'<flow name="{name}"><source name="s"/><node name="N"/><sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow>'
        self.server.command("load", "--as", "ontology", self.file(f"{name}.ttl", "<urn:a> a <http://www.w3.org/2002/07/owl#Class> ."))
        self.server.command("rules", "use", self.file(f"{name}.rules", "RULE { ?x a <urn:b> } WHERE { ?x a <urn:a> }"))
        self.server.command("load", self.file("w.cawl.xml", f'<CAWL name="{name}">{flow}</CAWL>'))
        self.server.command("run", name)
        for columns in (80, 40):
            for command in (("ontology", "list"), ("rules", "list"), ("workflows",)):
                self.assertIn(name, self.on_terminal(*command, columns=columns), command)
            self.assertIn(f"{name}-1", self.on_terminal("runs", columns=columns))
            versions = self.on_terminal("workflows", "versions", name, columns=columns)
            self.assertRegex(versions, r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d")

    # ---- names

    def test_iris_are_named_by_the_prefixes_of_modules_rules_and_workflows(self):
        module = self.file("words.ttl", f"@prefix expo: <{EXPO}> . expo:Stand a <http://www.w3.org/2002/07/owl#Class> .")
        self.server.command("load", "--as", "ontology", module)
        self.server.command("tell", f"<{EXPO}R01> a <{EXPO}Stand> ; docent:isAt <{EXPO}a/b>")
        query = "SELECT ?s ?o { ?s docent:isAt ?o }"
        self.assertEqual(self.server.command("query", query).splitlines(),
                         ["?s        ?o", "--------  " + "-" * len(f"<{EXPO}a/b>"), f"expo:R01  <{EXPO}a/b>"])
        self.assertIn(f"<{EXPO}R01>", self.server.command("query", "--full", query))
        for arguments in (["--json"], ["--format", "json"], ["--format", "csv"], ["--format", "tsv"], ["--format", "xml"]):
            text = self.server.command("query", *arguments, query)
            self.assertIn(f"{EXPO}R01", text)
            self.assertNotIn("expo:R01", text)
        # after a restart, too, from the log and from a snapshot
        for end in (self.server.kill, self.server.stop):
            end()
            self.server.start()
            self.assertIn("expo:R01", self.server.command("query", query))

    def test_what_is_printed_can_be_given_back(self):
        module = self.file("words.ttl", f"@prefix expo: <{EXPO}> . expo:Stand a <http://www.w3.org/2002/07/owl#Class> .")
        self.server.command("load", "--as", "ontology", module)
        self.assertIn("1 added", self.server.command("tell", "--source", "expo:me", "expo:R01 docent:isAt expo:B03"))
        self.assertTrue(self.server.ask(f"GRAPH <{EXPO}me> {{ <{EXPO}R01> docent:isAt <{EXPO}B03> }}"))
        self.assertIn("expo:R01 docent:isAt expo:B03", self.server.command("why", "expo:R01 docent:isAt expo:B03"))
        self.assertEqual(self.server.run("why", "ask", "ASK { expo:R01 docent:isAt expo:B03 }").returncode, 0)
        self.assertIn("expo:B04", self.server.command("whatif", "+expo:R01 docent:isAt expo:B04"))

    def test_the_querys_own_prefixes_name_its_answer(self):
        self.server.command("tell", "<urn:x:a> <urn:x:p> <urn:x:b>")
        self.assertIn("x:a  x:b", self.server.command("query", "PREFIX x: <urn:x:> SELECT * { ?s x:p ?o }"))
        turtle = self.server.command("query", "PREFIX x: <urn:x:> CONSTRUCT { ?s x:p ?o } { ?s x:p ?o }")
        self.assertEqual(turtle, "@prefix x: <urn:x:> .\n\nx:a x:p x:b .\n")
        self.assertIn("?s = x:a, ?o = x:b",
                      self.server.command("watch", "--count", "1", "PREFIX x: <urn:x:> SELECT * { ?s x:p ?o }"))

    def test_explanations_name_iris_and_whole_ones_are_there(self):
        self.server.command("tell", "--prefix", f"expo={EXPO}", "expo:R01 docent:isAt expo:B03")
        self.assertIn("expo:R01 docent:isAt expo:B03",
                      self.server.command("why", "--prefix", f"expo={EXPO}", "expo:R01 docent:isAt expo:B03"))
        full = self.server.command("why", "--full", f"<{EXPO}R01> docent:isAt <{EXPO}B03>")
        self.assertIn(f"<{EXPO}R01> <https://w3id.org/docent#isAt> <{EXPO}B03>", full)
        answer = json.loads(self.server.command("why", "--json", f"<{EXPO}R01> docent:isAt <{EXPO}B03>"))
        self.assertNotIn("docent:isAt", json.dumps(answer))

    def test_check_names_iris_by_the_files_prefixes(self):
        data = self.file("hall.ttl", f"@prefix expo: <{EXPO}> . expo:R01 a expo:Nothing .\n"
                                     "expo:Robot a <http://www.w3.org/2002/07/owl#Class> .")
        done = self.docent("check", data)
        self.assertIn("expo:Nothing", done.stderr.splitlines()[0])
        self.assertIn(f"<{EXPO}Nothing>", self.docent("check", "--full", data).stderr.splitlines()[0])

    # ---- tables and colours

    def test_tables_of_robots_runs_and_services(self):
        stage.load_s01(self.server)
        self.assertIn("no runs", self.server.run("runs").stderr)
        for command, header in (("services", r"service +steps +robots that offer all of it +from"),
                                ("robots", r"robot +state +x, y, heading +in +held by +reserved +operations +can +adapter")):
            lines = self.server.command(command).splitlines()
            self.assertRegex(lines[0], f"^{header}$")
            self.assertRegex(lines[1], r"^-+(  -+)+$")
            self.assertNotIn(ESCAPE, "".join(lines))
            for line in lines[2:]:  # columns begin where the rule says
                for start in [m.start() for m in re.finditer(r"-+", lines[1])][1:]:
                    self.assertEqual(line[start - 2:start].strip(), "", line)
        self.server.command("run", "BoothGuide", "--detach")
        self.assertRegex(self.server.command("runs"), r"(?m)^BoothGuide-\d+ +running +BoothGuide +\d{4}-\d\d-\d\d \d\d:\d\d:\d\d")
        self.assertRegex(self.on_terminal("runs"), r"(?m)\x1b\[33mrunning\x1b\[0m")
        self.assertNotIn(ESCAPE, self.on_terminal("runs", env={"NO_COLOR": "1"}))
        self.assertNotIn(ESCAPE, self.on_terminal("runs", env={"TERM": "dumb"}))
        self.assertNotIn(ESCAPE, self.on_terminal("runs", "--color", "never"))
        self.assertIn(ESCAPE, self.server.command("runs", "--color", "always"))

    def test_a_table_fits_the_terminal(self):
        long = "a very long name that goes on and on " * 5
        self.server.command("tell", f'<urn:a> <urn:name> "{long}", "展示ブース"')
        query = "SELECT ?s ?name { ?s <urn:name> ?name } ORDER BY ?name"
        text = self.on_terminal("query", "--color", "never", query, columns=60)
        self.assertTrue(all(len(line) <= 60 for line in text.splitlines()), text)
        self.assertIn("…", text)
        self.assertIn(long, self.on_terminal("query", "--full", query, columns=60))
        self.assertIn(long, self.server.command("query", query))  # into a pipe nothing is cut

    def test_a_value_cannot_command_the_terminal(self):
        self.server.command("update", 'INSERT DATA { <urn:a> <urn:p> "\\u001b[31mred\\u009b2J" }')
        text = self.server.command("query", "SELECT ?o { <urn:a> <urn:p> ?o }")
        self.assertNotIn(ESCAPE, text)
        self.assertNotIn("\x9b", text)

    # ---- JSON

    def test_json_means_json_of_every_command(self):
        facts = self.file("f.ttl", "<urn:a> <urn:p> <urn:b> .")
        rules = self.file("r.rules", "RULE { ?a <urn:q> ?b } WHERE { ?a <urn:p> ?b }")
        module = self.file("m.ttl", "<urn:m> a <http://www.w3.org/2002/07/owl#Ontology> .")
        for arguments in (["load", facts], ["load", "--as", "facts", facts], ["load", rules], ["rules", "list"],
                          ["rules", "use", rules], ["rules", "preview", "--remove", "r.rules"], ["rules", "remove", "r.rules"],
                          ["ontology", "load", module], ["ontology", "list"], ["ontology", "diff", module],
                          ["ontology", "remove", "m.ttl"], ["query", "ASK {}"], ["tell", "<urn:a> <urn:p> <urn:c>"],
                          ["update", "DELETE WHERE { <urn:a> <urn:p> <urn:c> }"], ["validate", facts, "--shapes", facts],
                          ["whatif", "+<urn:a> <urn:p> <urn:d>"], ["why", "<urn:a> <urn:p> <urn:b>"]):
            done = self.server.run(*arguments, "--json")
            if arguments[0] != "validate":
                self.assertEqual(done.returncode, 0, f"{arguments} {done.stderr}")
            for line in done.stdout.splitlines():
                json.loads(line)
            if arguments[0] != "validate":
                self.assertTrue(done.stdout, arguments)

    # ---- the program

    def test_the_version_tells_the_commit(self):
        for program in ("docent", "docent-robot"):
            if not (self.stage.bin / program).exists():
                continue
            done = subprocess.run([self.stage.bin / program, "--version"], capture_output=True, text=True, timeout=60)
            self.assertRegex(done.stdout, rf"^{program} \d+\.\d+\.\d+( \(commit [0-9a-f]{{7,40}}(, changed)?\))?\n$")

    def test_a_reader_that_stops_hears_no_noise(self):
        facts = " ".join(f"<urn:s{i}> <urn:p> {i} ." for i in range(20000))
        self.server.command("update", "-f", "-", text=f"INSERT DATA {{ {facts} }}")
        for arguments in ("query 'SELECT * { ?s ?p ?o }'", "query --format csv 'SELECT * { ?s ?p ?o }'", "watch 'SELECT * { ?s <urn:p> ?o }'",
                          "--help"):
            done = subprocess.run(["bash", "-c", f"{self.stage.bin}/docent {arguments} | head -n 1"], capture_output=True, text=True,
                                  timeout=60, env={**os.environ, "DOCENT_SERVER": self.server.grpc})
            self.assertEqual((done.returncode, done.stderr.replace("20000 rows, revision 1\n", "")), (0, ""), arguments)
            self.assertEqual(len(done.stdout.splitlines()), 1)

    def test_output_that_cannot_be_written_is_an_error(self):
        for target in (">/dev/full", ">&-"):
            done = subprocess.run(["bash", "-c", f"{self.stage.bin}/docent query 'ASK {{}}' {target}"], capture_output=True, text=True,
                                  timeout=60, env={**os.environ, "DOCENT_SERVER": self.server.grpc})
            self.assertEqual(done.returncode, 2, target)
            self.assertIn("could not be written to standard output", done.stderr)

    def test_an_interrupted_watch_ends_by_its_signal(self):
        watch = self.stage.start("watch", [self.stage.bin / "docent", "watch", "--server", self.server.grpc, "ASK {}"])
        watch.wait_for_output("yes", 60)
        watch.signal(signal.SIGINT)
        self.assertEqual(watch.popen.wait(60), -signal.SIGINT)

    def test_settings_from_a_file(self):
        settings = self.file("docent.toml", f'\N{ZERO WIDTH NO-BREAK SPACE}data = "{self.stage.folder}/other"\ngrpc = "127.0.0.1:0"\nhttp = "127.0.0.1:0"\n'
                                            'default-graph = "strict"\nrules = ["rdfs"]\n')
        server = self.stage.start("configured", [self.stage.bin / "docent", "serve", "--config", settings])
        line = server.wait_for_output("listening grpc=", 60)
        address = re.search(r"grpc=(\S+)", line)[1]
        listed = self.docent("rules", "list", "--server", address)
        self.assertIn("rdfs", listed.stdout)
        server.stop()
        bad = self.file("bad.toml", 'grpc = "127.0.0.1:0"\ndefault-grph = "strict"\nhttp = 7\nsnapshot-records = "0"\n')
        done = self.docent("serve", "--config", bad, "--http", "127.0.0.1:0")
        self.assert_refused(done, 2, "bad.toml:2:1: error: there is no setting default-grph", "did you mean default-graph?",
                            "bad.toml:3:1: error: http takes a text, and 7 is none", 'write it in quotes: "7"',
                            "bad.toml:4:1: error: ")


if __name__ == "__main__":
    unittest.main()
