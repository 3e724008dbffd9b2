#!/usr/bin/env python3
"""Bad input through the command line and over HTTP: an error with its place and remedy, and the server goes on."""
import os
import socket
import sqlite3
import unittest
import urllib.error
import urllib.parse
import urllib.request

from docent_e2e import StageTest, stage

GOOD = "@prefix : <http://example.org/> .\n:a :b :c .\n"


class Documents(StageTest):
    def setUp(self):
        super().setUp()
        self.server = self.stage.server()
        stage.load_ontology(self.server)
        self.server.load(self.file("good.ttl", GOOD))

    def tearDown(self):
        """Whatever was tried: nothing of it was applied, and the server answers."""
        self.assertTrue(self.server.ask("<http://example.org/a> <http://example.org/b> <http://example.org/c>"))
        self.assertFalse(self.server.ask("<http://example.org/a> <http://example.org/bad> ?x"))
        self.assertTrue(self.server.process.running())

    def assert_place(self, done, place, *words):
        self.assert_refused(done, 2, place, *words)

    def test_turtle(self):
        file = self.file("bad.ttl", "@prefix : <http://example.org/> .\n:a :bad :c .\n:a :bad ,, .\n")
        self.assert_place(self.server.run("load", file), "bad.ttl:3:")

    def test_turtle_with_an_unknown_prefix(self):
        file = self.file("prefix.ttl", "@prefix : <http://example.org/> .\n:a :bad nope:c .\n")
        self.assert_place(self.server.run("load", file), "prefix.ttl:2:", "nope")

    def test_sparql(self):
        done = self.server.run("query", "SELECT ?x WHERE {\n  ?x docent:isAt ?y \n  FILTER(?y = )\n}")
        self.assert_place(done, "3:15: error", "^")

    def test_an_address_with_a_port_that_is_none(self):
        for address, words in (("127.0.0.1:99999", "the port 99999 is not between 1 and 65535"), ("localhost:0", "the port 0"),
                               ("http://127.0.0.1:7400", "without http://"), ("127.0.0.1", "write HOST:PORT"),
                               ("127.0.0.1:7400x", "write HOST:PORT"), (":7400", "write HOST:PORT"), ("", "write HOST:PORT")):
            self.assert_refused(self.docent("query", "--server", address, "ASK {}"), 2, words)

    def test_sparql_over_http(self):
        url = f"http://{self.server.http}/sparql?" + urllib.parse.urlencode({"query": "SELECT ?x WHERE { ?x"})
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(url, timeout=10)
        with caught.exception as error:
            self.assertEqual(error.code, 400)
            self.assertIn("1:21: error", error.read().decode())

    def test_rules(self):
        file = self.file("bad.rules", "PREFIX docent: <https://w3id.org/docent#>\nRULE { ?a docent:isNear } WHERE { ?a ?b ?c }\n")
        self.assert_place(self.server.run("load", file), "bad.rules:2:")

    def test_cawl_that_is_no_xml(self):
        file = self.file("bad.cawl.xml", "<CAWL name='x'>\n  <flow name='f'>\n</CAWL>\n")
        self.assert_place(self.server.run("load", file), "bad.cawl.xml:")

    def test_cawl_with_names_that_are_not_there(self):
        text = next(stage.S01.glob("*.cawl.xml")).read_text().replace('to="Move2Booth"', 'to="Move2Both"', 1)
        done = self.server.run("load", self.file("names.cawl.xml", text))
        self.assert_place(done, "names.cawl.xml:", "Move2Both", "Move2Booth", "^")

    def test_check_reports_the_same_without_deploying(self):
        text = next(stage.S01.glob("*.cawl.xml")).read_text().replace('to="Move2Booth"', 'to="Move2Both"', 1)
        done = self.server.run("check", self.file("names.cawl.xml", text))
        self.assertEqual(done.returncode, 1, done.stderr + done.stdout)
        self.assertIn("Move2Both", done.stderr + done.stdout)

    def test_document_type_definitions_are_refused(self):
        bomb = '<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n<CAWL name="&b;"/>\n'
        for name in ("bomb.cawl.xml", "bomb.rsel.xml"):
            with self.subTest(name):
                self.assert_place(self.server.run("load", self.file(name, bomb)), f"{name}:", "document type")

    def test_an_external_entity_reads_no_file(self):
        secret = self.file("secret.txt", "very-secret")
        text = f'<!DOCTYPE x [<!ENTITY s SYSTEM "file://{secret}">]>\n<rsel name="&s;"/>\n'
        done = self.server.run("load", self.file("entity.rsel.xml", text))
        self.assert_place(done, "entity.rsel.xml:")
        self.assertNotIn("very-secret", done.stdout + done.stderr)

    def test_rsel(self):
        file = self.file("bad.rsel.xml", '<rsel name="x">\n  <process>\n    <invoke/>\n  </process>\n</rsel>\n')
        self.assert_place(self.server.run("load", file), "bad.rsel.xml:2:", "name")

    def test_a_mistake_at_the_end_of_a_large_file(self):
        """A file that goes to the server in parts is checked whole first."""
        lines = "".join(f'<http://example.org/{i}> <http://example.org/bad> "{"x" * 100}" .\n' for i in range(40_000))
        self.assert_place(self.server.run("load", self.file("large.nt", lines + "<http://example.org/a> oops .\n")),
                          "large.nt:40001:", "^")
        turtle = "@prefix : <http://example.org/> .\n" + "".join(f':a :bad "{i}{"x" * 100}" .\n' for i in range(45_000))
        self.assert_place(self.server.run("load", self.file("large.ttl", turtle + ":a :bad nope:c .\n")), "large.ttl:45002:")

    def test_a_batch_beyond_the_limit_is_refused_whole(self):
        lines = "".join(f"<http://example.org/a> <http://example.org/bad> {i} .\n" for i in range(100_001))
        done = self.server.run("load", "--as", "facts", self.file("large.ttl", lines))
        self.assert_refused(done, 2, "batch_operations", "100000")

    def test_a_term_beyond_the_limit_is_refused(self):
        file = self.file("long.ttl", f'@prefix : <http://example.org/> .\n:a :bad "{"x" * (1 << 20)}x" .\n')
        self.assert_refused(self.server.run("load", "--as", "facts", file), 2, "term_bytes")

    def test_an_ending_that_is_not_known(self):
        file = self.file("data.facts", GOOD.replace(":b", ":other"))
        self.assert_refused(self.server.run("load", file), 2, "data.facts: unknown file name extension", ".ttl", "--as")
        self.assert_refused(self.server.run("check", file), 2, "data.facts: unknown file name extension", ".xml", ".sparql")
        self.assert_refused(self.server.run("check", "-", text=GOOD), 2, "check does not read standard input", "text.ttl")
        self.server.command("load", "--as", "data", file)
        self.server.command("load", "-", text=GOOD.replace(":b", ":other"))

    def test_a_format_that_cannot_hold_the_answer(self):
        for query in ("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }", "CONSTRUCT WHERE { ?s ?p ?o }", "DESCRIBE <http://example.org/a>"):
            for arguments, format in (["--format", "csv"], "csv"), (["--format", "xml"], "xml"), (["--json"], "json"):
                done = self.server.run("query", *arguments, query)
                self.assert_refused(done, 2, "triples", format, "Turtle")
                self.assertEqual(done.stdout, "")
            self.assertIn("<http://example.org/b>", self.server.command("query", query))
        self.assertEqual(self.server.command("query", "--format", "csv", "SELECT * WHERE { <http://example.org/a> ?p ?o }").splitlines()[0], "p,o")
        self.assert_refused(self.server.run("query", "--format", "csv", "CONSTRUCT { ?s } WHERE { ?s ?p ?o }"), 2, "1:1")

    def test_a_source_may_have_a_prefix(self):
        for i, (source, iri) in enumerate([("ex:sensor1", "http://example.org/s#sensor1"), ("<http://example.org/s2>", "http://example.org/s2"),
                                           ("docent:sensor3", "https://w3id.org/docent#sensor3"), ("urn:ex:4", "urn:ex:4")]):
            self.server.command("tell", "--prefix", "ex=http://example.org/s#", "--source", source, f"ex:a ex:b {i}")
            self.assertTrue(self.server.ask(f"GRAPH <{iri}> {{ <http://example.org/s#a> <http://example.org/s#b> {i} }}"), source)

    def test_standard_input_in_a_format_and_into_a_graph(self):
        for arguments, text in ((["--format", "nq"], "_:x <urn:p> \"1\" <urn:g1> .\n"), (["--format", "trig"], "<urn:g1> { _:x <urn:p> 2 }"),
                                (["--graph", "docent:g2"], "_:x <urn:p> 3 .")):
            self.assertEqual(self.docent("load", "--server", self.server.grpc, *arguments, "-", text=text).returncode, 0)
        self.assertTrue(self.server.ask('GRAPH <urn:g1> { ?a <urn:p> "1" . ?b <urn:p> 2 FILTER(?a != ?b) }'))
        self.assertTrue(self.server.ask("GRAPH <https://w3id.org/docent#g2> { ?a <urn:p> 3 }"))

    def test_a_graph_that_would_not_be_obeyed(self):
        quads = self.file("named.nq", '<urn:a> <urn:p> "1" <urn:other> .\n')
        facts = self.file("facts.ttl", "<urn:a> <urn:p> 1 .")
        self.assert_refused(self.server.run("load", "--graph", "urn:want", quads), 2, "named.nq", "<urn:other>", "leave graph (--graph) away")
        self.assert_refused(self.server.run("load", "--as", "ontology", quads), 2, "named.nq", "<urn:other>")
        self.assert_refused(self.server.run("load", "--as", "facts", "--graph", "urn:want", facts), 2, "--source")
        self.assert_refused(self.server.run("load", "--source", "urn:me", facts), 2, "--as facts")
        self.assert_refused(self.server.run("load", "--as", "ontology", "--graph", "urn:g", facts), 2, "--graph goes with data")
        self.assert_refused(self.server.run("load", "--as", "rules", "--format", "ttl", facts), 2, "--format goes with RDF")
        self.server.command("load", "--graph", "urn:other", quads)
        self.assertTrue(self.server.ask('GRAPH <urn:other> { <urn:a> <urn:p> "1" }'))

    def test_an_answer_that_breaks_off_is_not_made_to_look_whole(self):
        self.server.command("load", self.file("many.nt", "".join(f"<urn:s{i}> <urn:p> \"{i}\" .\n" for i in range(300))))
        bomb = "SELECT ?a ?b ?c WHERE { ?a <urn:p> ?x . ?b <urn:p> ?y . ?c <urn:p> ?z }"
        for arguments in ([], ["--format", "json"], ["--format", "xml"], ["--format", "csv"]):
            with self.subTest(arguments):
                done = self.server.run("query", "--timeout-ms", 1500, *arguments, bomb)
                self.assertEqual(done.returncode, 2)
                self.assertIn("the answer is not whole", done.stderr)
                self.assertRegex(done.stderr, "query_timeout_ms|time limit")
                self.assertFalse(done.stdout.rstrip().endswith(("]}}", "</sparql>")))
                self.assertNotIn("revision", done.stderr)

    def test_a_directory_is_no_file(self):
        folder = self.stage.folder / "folder.ttl"
        folder.mkdir()
        plain = self.stage.folder / "folder"
        plain.mkdir()
        for command in ("load", "check"):
            self.assert_refused(self.server.run(command, plain), 2, f"{plain} is a directory")
        shapes = self.file("shapes.ttl", "")
        for arguments in (["load"], ["ontology", "load"], ["ontology", "replace"], ["ontology", "diff"], ["check"], ["rules", "use"],
                          ["query", "-f"], ["update", "-f"], ["watch", "-f"], ["validate", "--shapes", shapes], ["validate", "--shapes"]):
            with self.subTest(arguments):
                self.assert_refused(self.server.run(*arguments, folder), 2, f"{folder} is a directory")

    def test_what_is_not_utf8(self):
        latin = self.stage.folder / "latin.ttl"
        latin.write_bytes(b'<urn:a> <urn:p> "\xc3\xa4" .\n<http://example.org/a> <http://example.org/bad> "\xc3\xa4\xe4" .\n')
        rules = self.stage.folder / "latin.rules"
        rules.write_bytes(b'RULE { ?x <http://example.org/bad> "\xe4" } WHERE { ?x ?p ?y }')
        for arguments, place in ((["load", latin], "latin.ttl:2:51"), (["load", "--as", "facts", latin], "latin.ttl:2:51"),
                                 (["ontology", "load", latin], "latin.ttl:2:51"), (["load", rules], "latin.rules:1:37"),
                                 (["rules", "use", rules], "latin.rules:1:37"), (["query", "-f", latin], "latin.ttl:2:51")):
            with self.subTest(arguments):
                self.assert_refused(self.server.run(*arguments), 2, place, "not UTF-8", "save the text as UTF-8")
        for command in ("query", "update", "watch"):
            with self.subTest(command):
                done = self.server.run(command, b"ASK { <urn:a> <urn:p> \"\xe4\" }".decode(errors="surrogateescape"))
                self.assert_refused(done, 2, "1:24: error", "not UTF-8", "save the text as UTF-8")
        done = self.server.run("tell", "--reading", b"docent:s=\xe4".decode(errors="surrogateescape"))
        self.assert_refused(done, 2, "--reading:1:10", "not UTF-8")
        self.assertEqual(self.server.run("check", latin, rules).returncode, 1, "it says what is wrong with all files")

    def test_bytes_that_are_no_message(self):
        """A client that talks nonsense to the gRPC and HTTP ports does not disturb the others."""
        for address in (self.server.grpc, self.server.http):
            host, port = address.rsplit(":", 1)
            with socket.create_connection((host, int(port)), timeout=10) as connection:
                connection.sendall(os.urandom(2000))
                try:
                    connection.shutdown(socket.SHUT_WR)
                    while connection.recv(4096):
                        pass
                except OSError:
                    pass  # hung up on us: fine

    def test_http_from_another_site_is_refused(self):
        for header, value in (("Host", "evil.example"), ("Origin", "http://evil.example")):
            request = urllib.request.Request(f"http://{self.server.http}/sparql?query=ASK%7B%7D", headers={header: value})
            with self.assertRaises(urllib.error.HTTPError) as caught:
                urllib.request.urlopen(request, timeout=10)
            with caught.exception as error:
                self.assertEqual(error.code, 403, header)


class Starting(StageTest):
    def serve(self, *arguments):
        return self.docent("serve", "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", *arguments)

    def assert_one_line(self, done, *words):
        self.assertNotEqual(done.returncode, 0)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_port_in_use(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            address = f"127.0.0.1:{taken.getsockname()[1]}"
            for option in ("--grpc", "--http"):
                with self.subTest(option):
                    addresses = {"--grpc": "127.0.0.1:0", "--http": "127.0.0.1:0", option: address}
                    done = self.docent("serve", "--data", self.stage.folder / "data", *sum(addresses.items(), ()))
                    self.assert_one_line(done, address)

    def test_second_server_on_the_same_data(self):
        server = self.stage.server()
        self.assert_one_line(self.serve("--data", server.data), str(server.data))

    def test_data_folder_that_cannot_be_used(self):
        path = self.file("occupied", "a file, not a folder")
        self.assert_one_line(self.serve("--data", path), str(path))

    @unittest.skipIf(os.geteuid() == 0, "root reads everything")
    def test_data_folder_without_permission(self):
        path = self.stage.folder / "locked"
        path.mkdir(mode=0)
        self.addCleanup(path.chmod, 0o700)
        self.assert_one_line(self.serve("--data", path), str(path))

    def test_log_of_a_newer_format(self):
        server = self.stage.server()
        server.load(self.file("good.ttl", GOOD))
        server.stop()
        log = next(p for p in server.data.rglob("*") if p.is_file() and p.read_bytes()[:15] == b"SQLite format 3")
        with sqlite3.connect(log) as db:
            version = db.execute("PRAGMA user_version").fetchone()[0]
            db.execute(f"PRAGMA user_version = {version + 1}")
        db.close()
        self.assert_one_line(self.serve("--data", server.data), "newer")

    def test_a_flipped_byte_in_the_log_is_named(self):
        server = self.stage.server()
        for i in range(5):
            server.tell(f"expo:John docent:x {i}.5")
        server.kill()  # an orderly end would leave a snapshot, and the start would not need the record
        log = next(p for p in server.data.rglob("*") if p.is_file() and p.read_bytes()[:15] == b"SQLite format 3")
        with sqlite3.connect(log) as db:
            seq, data = db.execute("SELECT seq, data FROM ctxlog ORDER BY seq LIMIT 1 OFFSET 3").fetchone()
            middle = len(data) // 2
            db.execute("UPDATE ctxlog SET data = ? WHERE seq = ?",
                       (data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1:], seq))
        db.close()
        self.assert_one_line(self.serve("--data", server.data), str(seq))

    def test_an_address_for_everyone_needs_insecure(self):
        done = self.docent("serve", "--data", self.stage.folder / "data", "--grpc", "0.0.0.0:0", "--http", "127.0.0.1:0")
        self.assert_one_line(done, "--insecure")

    def test_no_server(self):
        done = self.docent("query", "--server", "127.0.0.1:1", "ASK {}")
        self.assert_refused(done, 2, "127.0.0.1:1")

    def test_wrong_usage(self):
        self.assert_refused(self.docent("no-such-command"), 2, 'there is no command `docent no-such-command`', "docent --help")
        self.assert_refused(self.docent("serv", "--data", "x"), 2, "`docent serv`", "did you mean `docent serve`?")
        self.assert_refused(self.docent("ontology", "reload", "m.ttl"), 2, "`docent ontology reload`", "did you mean `docent ontology load`?")
        self.assert_refused(self.docent("serve", "--adta", "x"), 2, "docent serve: there is no option --adta; did you mean --data?")
        self.assert_refused(self.docent("--data", "x", "serve"), 2, "docent: --data belongs behind `docent serve`")
        self.assert_refused(self.docent("query", "--no-such-thing=1", "ASK {}"), 2, "no option --no-such-thing; `docent query --help` lists them")
        self.assert_refused(self.docent("query", "ASK {}", "ASK {}"), 2, "one argument too many: ASK {}; `docent query --help`")
        self.assert_refused(self.docent("load"), 2, "docent load: FILES... is missing; write `docent load FILES...`; `docent load --help`")
        self.assert_refused(self.docent("rules"), 2, "docent rules: a command is missing; there are list, use, ")
        self.assert_refused(self.docent(), 2, "docent: a command is missing; there are serve, status, load, ")
        self.assert_refused(self.docent("query", "--timeout-ms", "-5", "ASK {}"), 2, "--timeout-ms: give a whole number, 0 or more, not -5")
        self.assert_refused(self.docent("watch", "--count", "-1", "ASK {}"), 2, "--count: give a whole number, 1 or more, not -1")
        self.assert_refused(self.docent("query", "--format", "csv", "--format", "json", "ASK {}"), 2, "--format is given 2 times; give it once")
        self.assert_refused(self.docent("tell", "--prefix", "1=http://e/", "1:b <urn:c> 1"), 2, '"1" is not the name of a prefix')
        self.assert_refused(self.docent("serve", "--grpc", ":0", "--data", "d", "--http", "127.0.0.1:0"), 2, '":0" is not HOST:PORT')
        self.assert_refused(self.docent("fmt", self.file("n.ttl", GOOD)), 2, "n.ttl is no XML document; fmt lays out CAWL and RSEL")

    def test_an_empty_value_is_not_an_option_left_out(self):
        """As an unset variable of a shell gives it: facts went elsewhere, and the exit code was 0."""
        file = self.file("facts.ttl", "<http://example.org/a> <http://example.org/bad> 1 .")
        for arguments in (["load", "--graph", "", file], ["load", "--as", "facts", "--source", "", file], ["load", ""],
                          ["tell", "--source", "", "<http://example.org/a> <http://example.org/bad> 1"],
                          ["update", "--request-id", "", "INSERT DATA { <http://example.org/a> <http://example.org/bad> 1 }"],
                          ["runs", "--workflow", ""], ["robots", "out", ""], ["query", "--as-of", "", "ASK {}"], ["query", "--file", ""]):
            with self.subTest(arguments):
                self.assert_refused(self.docent(*arguments), 2, "it is empty")
        for arguments in (["--data", ""], ["--http-name", ""]):
            self.assert_refused(self.docent("serve", *arguments), 2, f"{arguments[0]}: it is empty")
        self.assert_refused(self.docent("serve", "--data", self.stage.folder / "names", "--http-name", "http://x/", "--grpc", "127.0.0.1:0",
                                        "--http", "127.0.0.1:0"), 2, '"http://x/" is not NAME or NAME:PORT')
        self.assertEqual(self.docent("--help").returncode, 0)
        self.assertIn("serve", self.docent("--help").stdout)


if __name__ == "__main__":
    unittest.main()
