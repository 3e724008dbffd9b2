#!/usr/bin/env python3
"""Redland programs on our graph: rdfproc and Python's RDF module load the storage module `docent`, on a data folder and
on a running server; `docent query --engine rasqal` answers beside our own engine."""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import textwrap
import time
import unittest

from docent_e2e import StageTest

MODULES = pathlib.Path(os.environ["DOCENT_BINARIES"]).parent / "redland"
E = "http://example.org/"


def interpreter_with_redland():
    """python3-librdf belongs to Debian's own Python, which need not be the one that runs this test."""
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import RDF"], capture_output=True, check=False).returncode == 0:
            return python
    return None


PYTHON = interpreter_with_redland()
HEAD = textwrap.dedent("""
    import sys, RDF
    storage = RDF.Storage(storage_name="docent", name=sys.argv[1], options_string=sys.argv[2])
    model = RDF.Model(storage)
    E = "http://example.org/"
    def statement(s, p, o):
        return RDF.Statement(RDF.Uri(E + s), RDF.Uri(E + p), RDF.Node(o) if isinstance(o, str) else RDF.Uri(E + o[0]))
    """)


@unittest.skipUnless(shutil.which("rdfproc") and PYTHON, "redland-utils and python3-librdf are not installed")
class Redland(StageTest):
    environment = {**os.environ, "REDLAND_MODULE_PATH": str(MODULES)}

    def program(self, argv, text=None):
        return subprocess.run([str(a) for a in argv], input=text, capture_output=True, text=True, timeout=120,
                              env=self.environment, check=False)

    def rdfproc(self, store, *arguments):
        return self.program(["rdfproc", "-q", "-s", "docent", store, *arguments])

    def must(self, done):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("docent:", done.stderr)
        return done.stdout

    def python(self, script, *arguments):
        """Runs a script that has `model` over the storage named by its first argument."""
        return self.program([PYTHON, "-", *arguments], text=HEAD + textwrap.dedent(script))

    def writer_script(self, numbers, size):
        """A file with a script that makes one transaction of `size` statements for each number, and prints it once it is made."""
        return self.file("writer.py", HEAD + textwrap.dedent(f"""
            import Redland
            for number in {numbers}:
                try:
                    Redland.librdf_model_transaction_start(model._model)
                    for part in range({size}):
                        model.append(statement("s%d" % number, "part%d" % part, str(number)))
                    if Redland.librdf_model_transaction_commit(model._model) == 0:
                        print(number, flush=True)
                except RDF.RedlandError as error:
                    print("refused", number, error, file=sys.stderr)
            """))

    def start_writer(self, first, script, *arguments):
        """Its standard output is not buffered here: Popen.communicate would leave out what readline had read ahead."""
        program = subprocess.Popen([PYTHON, script, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0,
                                   env=self.environment)
        self.addCleanup(program.kill)
        self.assertEqual(program.stdout.readline(), b"%d\n" % first, "the first is acknowledged")
        return program

    def refused_in_one_line(self, done, *words):
        lines = [line for line in done.stderr.splitlines() if "docent:" in line]
        self.assertEqual(len(lines), 1, done.stderr)
        for word in words:
            self.assertIn(word, lines[0])

    def test_rdfproc_on_a_data_folder(self):
        folder = self.stage.folder / "data"
        self.refused_in_one_line(self.rdfproc(folder, "print"), "there is no data folder", "new='yes'")
        self.assertFalse(folder.exists())
        done = self.program(["rdfproc", "-q", "-n", "-s", "docent", folder, "add", E + "a", E + "p", "one"])
        self.must(done)
        self.must(self.rdfproc(folder, "add", E + "a", E + "p", "two", E + "g"))
        data = self.file("data.nt", f"<{E}b> <{E}p> <{E}c> .\n<{E}b> <{E}q> \"4\"^^<http://www.w3.org/2001/XMLSchema#integer> .\n")
        self.must(self.rdfproc(folder, "parse", data, "ntriples"))
        self.assertEqual(sorted(self.must(self.rdfproc(folder, "serialize", "ntriples")).splitlines()), sorted([
            f'<{E}a> <{E}p> "one" .', f'<{E}a> <{E}p> "two" .', f"<{E}b> <{E}p> <{E}c> .",
            f'<{E}b> <{E}q> "4"^^<http://www.w3.org/2001/XMLSchema#integer> .']))
        self.assertIn(f"<{E}g>", self.must(self.rdfproc(folder, "serialize", "nquads")))
        self.assertIn("4", self.must(self.rdfproc(folder, "size")) + self.rdfproc(folder, "size").stderr)
        self.assertIn(E + "g", self.must(self.rdfproc(folder, "contexts")))
        self.assertIn(E + "b", self.must(self.rdfproc(folder, "sources", E + "p", E + "c")))
        query = f"SELECT ?o WHERE {{ <{E}b> <{E}q> ?o FILTER(?o > 3) }}"
        self.assertIn('"4"', self.must(self.program(["rdfproc", "-q", "-r", "json", "-s", "docent", folder, "query", "sparql", "-", query])))
        self.must(self.rdfproc(folder, "remove-context", E + "g"))
        self.must(self.rdfproc(folder, "remove", E + "b", E + "p", E + "c"))
        # what Redland wrote, the server has; and while it runs, the folder is its own
        server = self.stage.server(data="data")
        self.assertEqual(sorted(r["o"] for r in server.select("SELECT ?o { ?s ?p ?o }")), ["4", "one"])
        self.refused_in_one_line(self.rdfproc(folder, "print"), "in use by process", str(server.process.pid))
        done = self.rdfproc(folder, "add", E + "a", E + "p", "three")
        self.assertNotEqual(done.returncode, 0)
        server.stop()
        self.refused_in_one_line(self.program(["rdfproc", "-q", "-n", "-s", "docent", folder, "add", E + "a", E + "p", "x"]),
                                 "records")

    def test_rdfproc_on_a_server(self):
        server = self.stage.server()
        store = f"grpc://{server.grpc}"
        server.tell(f'<{E}a> <{E}p> "told"', source="urn:source")
        self.must(self.rdfproc(store, "add", E + "a", E + "p", "added", E + "g"))
        self.assertEqual(sorted(r["g"] for r in server.select(f"SELECT ?g {{ GRAPH ?g {{ <{E}a> ?p ?o }} }}")),
                         [E + "g", "urn:source"])
        self.assertIn("told", self.must(self.rdfproc(store, "find", E + "a", "-", "-")))
        self.assertIn("urn:source", self.must(self.rdfproc(store, "contexts")))
        self.refused_in_one_line(self.rdfproc(store, "add", E + "a", E + "p", "x", "https://w3id.org/docent#runs"),
                                 "only the server writes")
        self.refused_in_one_line(self.rdfproc(store, "remove", E + "a", E + "p", "told"), "<urn:source>")
        self.must(self.rdfproc(store, "remove", E + "a", E + "p", "told", "urn:source"))
        self.assertEqual([r["o"] for r in server.select("SELECT ?o { ?s ?p ?o }")], ["added"])
        server.stop()
        self.refused_in_one_line(self.rdfproc(store, "print"), "no server answers at " + server.grpc)
        for name in ("grpc://", f"http://{server.http}/"):
            self.refused_in_one_line(self.rdfproc(name, "print"), f'"{name}" names no storage', "grpc://HOST:PORT")

    def test_a_file_is_one_turn_where_the_readme_says_so(self):
        def turns(folder):
            return json.loads(self.must(self.program([self.stage.bin / "docent", "verify", "--json", folder])))["last"]

        def lines(name, count):
            return "".join(f'<{E}{name}{i}> <{E}p> "{i}" .\n' for i in range(count))
        whole = self.file("whole.nt", lines("whole", 20))
        streamed = self.file("streamed.nt", lines("streamed", 20))
        broken = self.file("broken.nt", lines("before", 20) + "<urn:x> <urn:y>\n" + lines("after", 20))
        refused = self.file("refused.nt", lines("good", 20) + f'<urn:x> <urn:y> "{"x" * (1 << 20)}x" .\n' + lines("later", 20))
        script = """
            import Redland
            def parse_in_transaction(file):
                Redland.librdf_model_transaction_start(model._model)
                try:
                    RDF.Parser("ntriples").parse_into_model(model, "file:" + file)
                except RDF.RedlandError:
                    Redland.librdf_model_transaction_rollback(model._model)
                    raise
                Redland.librdf_model_transaction_commit(model._model)
            def add(file):
                parser = RDF.Parser("ntriples")
                model.add_statements(parser.parse_as_stream("file:" + file))
            try:
                {"add": add, "transaction": parse_in_transaction}[sys.argv[3]](sys.argv[4])
                print("made", model.size())
            except RDF.RedlandError as error:
                print(error, model.size())
            """
        server = self.stage.server(data="served")
        folder = self.stage.folder / "data"
        self.must(self.program(["rdfproc", "-q", "-n", "-s", "docent", folder, "add", E + "a", E + "p", "one"]))
        self.must(self.rdfproc(f"grpc://{server.grpc}", "add", E + "a", E + "p", "one"))
        for store, data in ((folder, folder), (f"grpc://{server.grpc}", server.data)):
            def made(expected, done):
                nonlocal before
                self.assertEqual(turns(data) - before, expected, f"{done.args} {done.stderr}")
                before = turns(data)
                return done.stdout
            before = turns(data)
            made(20, self.rdfproc(store, "parse", whole, "ntriples"))
            made(20, self.rdfproc(store, "parse-stream", self.file("other.nt", lines("other", 20)), "ntriples"))
            self.assertIn("made 61", made(1, self.python(script, store, "", "add", streamed)))
            self.assertIn("Unexpected end of line", made(1, self.python(script, store, "", "add", broken)))
            self.assertIn("Unexpected end of line", made(0, self.python(script, store, "", "transaction", broken)))
            self.assertRegex(made(0, self.python(script, store, "", "transaction", refused)), "term_bytes.* 101")
            made(1, self.program(["rdfproc", "-q", "-T", "-s", "docent", store, "parse", self.file("t.nt", lines("t", 20)), "ntriples"]))
            done = self.program(["rdfproc", "-q", "-T", "-s", "docent", store, "parse", refused, "ntriples"])
            made(0, done)
            self.assertIn("term_bytes", done.stderr)
            made(20, self.rdfproc(store, "parse", refused, "ntriples"))

    def test_python_on_both(self):
        server = self.stage.server(data="served")
        script = """
            g = RDF.Node(RDF.Uri(E + "g"))
            model.append(statement("a", "p", "one"))
            model.append(statement("a", "p", ["b"]), context=g)
            import Redland
            assert Redland.librdf_model_transaction_start(model._model) == 0
            model.append(statement("a", "p", "two"))
            assert statement("a", "p", "two") in model
            assert Redland.librdf_model_transaction_rollback(model._model) == 0
            assert statement("a", "p", "two") not in model
            assert Redland.librdf_model_transaction_start(model._model) == 0
            model.append(statement("a", "p", "three"))
            model.append(statement("a", "p", "four"))
            assert Redland.librdf_model_transaction_commit(model._model) == 0
            print(sorted(str(n) for n in model.get_contexts()))
            print(sorted(str(n) for n in model.get_targets(RDF.Uri(E + "a"), RDF.Uri(E + "p"))))
            print(sorted((str(s.object), str(c)) for s, c in model.find_statements_context(RDF.Statement(None, None, None))))
            rows = RDF.SPARQLQuery("SELECT ?o { ?s <http://example.org/p> ?o FILTER(isLiteral(?o)) }").execute(model)
            print(sorted(str(row["o"]) for row in rows))
            model.remove_statements_with_context(g)
            model.sync()
            print(model.size())
            """
        for store, options in ((self.stage.folder / "data", "new='yes'"), (f"grpc://{server.grpc}", "")):
            self.assertEqual(self.must(self.python(script, store, options)).splitlines(), [
                f"['{E}g']", f"['four', '{E}b', 'one', 'three']",
                f"[('four', 'None'), ('{E}b', '{E}g'), ('one', 'None'), ('three', 'None')]",
                "['four', 'one', 'three']", "3"])
        self.assertEqual(sorted(r["o"] for r in server.select("SELECT ?o { ?s ?p ?o }")), ["four", "one", "three"])
        done = self.python("print('not reached')", self.stage.folder / "none", "")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("there is no data folder", done.stderr)

    def test_no_acknowledged_write_is_lost_when_the_server_is_killed_and_none_is_half(self):
        seed = int(os.environ.get("DOCENT_E2E_SEED", random.randrange(1 << 30)))
        print(f"seed {seed}", flush=True)
        moments = random.Random(seed)
        server = self.stage.server()
        script = self.writer_script("range(int(sys.argv[3]))", size=2)
        writer = self.start_writer(0, script, f"grpc://{server.grpc}", "", "1500")
        kills = 0
        while writer.poll() is None and kills < 5:
            time.sleep(moments.uniform(0.05, 0.5))
            server.kill()
            kills += 1
            server.start()
        out, errors = writer.communicate(timeout=200)
        acknowledged = [0] + [int(line) for line in out.split()]
        self.assertGreater(len(acknowledged), 50, errors)
        server.kill()
        server.start()
        left, right = ({int(r["n"]) for r in server.select(f"SELECT ?n {{ ?s <{E}{side}> ?n }}")} for side in ("part0", "part1"))
        self.assertEqual(left, right, "a transaction was made by half")
        self.assertEqual(set(acknowledged) - left, set(), "acknowledged and lost")
        print(f"{kills} kills, {len(acknowledged)} of 1500 transactions acknowledged, {len(errors.splitlines())} refused", flush=True)

    def test_a_killed_program_leaves_no_half_transaction(self):
        seed = int(os.environ.get("DOCENT_E2E_SEED", random.randrange(1 << 30)))
        print(f"seed {seed}", flush=True)
        moments = random.Random(seed)
        script = self.writer_script("range(int(sys.argv[3]), 10 ** 9)", size=25)
        server = self.stage.server(data="served")
        for store, options in ((self.stage.folder / "data", "new='yes'"), (f"grpc://{server.grpc}", "")):
            acknowledged = []
            for life in range(6):
                first = life * 1000000
                program = self.start_writer(first, script, str(store), options if life == 0 else "", str(first))
                time.sleep(moments.uniform(0, 0.4))
                program.kill()
                out, errors = program.communicate()
                self.assertNotIn(b"Error", errors)
                # A line that was cut off by the kill is no acknowledgement.
                acknowledged += [first] + [int(line) for line in out.splitlines(keepends=True) if line.endswith(b"\n")]
            if options:
                self.assertEqual(self.docent("verify", store).returncode, 0)
                there = self.stage.server(data=store.name)
            else:
                there = server
            counts = {int(r["n"]): int(r["count"]) for r in there.select(
                f"SELECT ?n (COUNT(?p) AS ?count) {{ ?s ?p ?n FILTER(STRSTARTS(STR(?p), '{E}part')) }} GROUP BY ?n")}
            self.assertEqual(set(counts.values()), {25}, "a transaction was made by half")
            self.assertEqual(set(acknowledged) - set(counts), set(), "acknowledged and lost")
            self.assertLessEqual(len(counts) - len(set(acknowledged)), 6, "at most the one under way of each life")
            print(f"{store}: 6 kills, {len(acknowledged)} transactions acknowledged, {len(counts)} there", flush=True)

    def test_a_refused_write_changes_nothing(self):
        server = self.stage.server(data="served")
        script = """
            import Redland
            def fails(call, word):
                try:
                    done = call()
                except RDF.RedlandError as error:
                    assert word in str(error), error
                else:
                    assert False, done
            model.append(statement("a", "p", "kept"))
            reserved = RDF.Node(RDF.Uri("https://w3id.org/docent#inferred"))
            Redland.librdf_model_transaction_start(model._model)
            model.append(statement("a", "p", "first"))
            model.append(statement("a", "p", "second"), context=reserved)
            model.remove_statement(statement("a", "p", "kept"))
            fails(lambda: Redland.librdf_model_transaction_commit(model._model), "only the server writes")
            fails(lambda: model.add_statement(RDF.Statement(RDF.Uri("relative"), RDF.Uri(E + "p"), RDF.Node("x"))), "relative")
            parser = RDF.Parser("turtle")
            stream = parser.parse_string_as_stream("<http://example.org/b> <http://example.org/p> 1, 2, 3 .", "http://example.org/")
            fails(lambda: model.add_statements(stream, context=reserved), "only the server writes")
            print(sorted(str(s.object) for s in model))
            del stream, parser  # while librdf's world is there
            """
        for store, options in ((self.stage.folder / "data", "new='yes'"), (f"grpc://{server.grpc}", "")):
            self.assertEqual(self.must(self.python(script, store, options)).splitlines(), ["['kept']"])
        server.stop()
        for data in ("data", "served"):
            report = self.docent("verify", self.stage.folder / data)
            self.assertEqual(report.returncode, 0, report.stdout)

    def test_the_second_engine_answers_as_the_first(self):
        server = self.stage.server()
        server.tell(f'<{E}a> <{E}p> 1, 2, 3 . <{E}b> <{E}q> "x"@en', source="urn:one")
        server.tell(f"<{E}a> <{E}p> 2", source="urn:two")
        environment = {**self.environment, "DOCENT_SERVER": server.grpc}

        def both(query, *options):
            runs = [subprocess.run([str(self.stage.bin / "docent"), "query", *engine, *options, query], capture_output=True,
                                   text=True, timeout=60, env=environment, check=False) for engine in ([], ["--engine", "rasqal"])]
            return runs

        ours, rasqal = both(f"SELECT ?o {{ <{E}a> <{E}p> ?o FILTER(?o > 1) }} ORDER BY ?o", "--format", "json")
        self.assertEqual(json.loads(ours.stdout), json.loads(rasqal.stdout), rasqal.stderr)
        self.assertEqual([b["o"]["value"] for b in json.loads(rasqal.stdout)["results"]["bindings"]], ["2", "3"])
        ours, rasqal = both(f"ASK {{ <{E}b> ?p ?o FILTER(lang(?o) = 'fr') }}")
        self.assertEqual((ours.returncode, ours.stdout), (1, "no\n"))
        self.assertEqual((rasqal.returncode, rasqal.stdout), (1, "no\n"), rasqal.stderr)
        ours, rasqal = both(f"CONSTRUCT {{ ?s <{E}r> ?o }} WHERE {{ ?s <{E}q> ?o }}")
        self.assertEqual(ours.stdout, rasqal.stdout)
        self.assertIn('"x"@en', rasqal.stdout)
        for query, word in ((f"SELECT * {{ ?s <{E}p>+ ?o }}", "property paths"), ("SELECT * { ?s ?p ?o MINUS { ?s ?p 1 } }", "MINUS"),
                            ("SELECT * { ?s ?p", "expected")):
            self.assert_refused(both(query)[1], 2, word)
        cross = "SELECT * { " + " ".join(f"?a{i} ?b{i} ?c{i} ." for i in range(24)) + " FILTER(?a0 = <urn:none>) }"
        self.assert_refused(both(cross, "--timeout-ms", "500")[1], 2, "query_timeout_ms = 500")


if __name__ == "__main__":
    unittest.main()
