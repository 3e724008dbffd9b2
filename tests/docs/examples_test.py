#!/usr/bin/env python3
"""What the pages of docs/ say is true: every whole document is one that `docent check` accepts, files of the tree and limits
are what they are said to be, and the page on file formats has the numbers of this version and a checker that reads what a
server writes.

A whole document is a fenced block of
  xml      whose root element is <CAWL> or <rsel>,
  rules    all of them,
  turtle   that declares a prefix,
  sparql   that begins with PREFIX, SELECT, ASK, CONSTRUCT or DESCRIBE.
What is shown as wrong stands in blocks of `text`.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
DOCENT = pathlib.Path(os.environ["DOCENT_BINARIES"]) / "docent"
PYTHON = "/usr/bin/python3"  # the one that Debian's packages are for
BLOCK = re.compile(r"^```(\w+)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def ending(language, text):
    """The ending of the file that a block is, or None for a fragment."""
    if language == "xml":
        root = re.search(r"<(CAWL|rsel)\b", re.sub(r"<\?xml.*?\?>|<!--.*?-->", "", text, flags=re.DOTALL).lstrip()[:6])
        return root and {"CAWL": ".cawl.xml", "rsel": ".rsel.xml"}[root.group(1)]
    if language == "rules":
        return ".rules"
    if language == "turtle" and "@prefix" in text:
        return ".ttl"
    if re.search(r"^(DELETE|INSERT)\b", text, re.MULTILINE):  # an update, which is not checked
        return None
    if language == "sparql" and re.match(r"(#[^\n]*\n)*(PREFIX|SELECT|ASK|CONSTRUCT|DESCRIBE)\b", text):
        return ".rq"
    return None


def begin_server(data):
    """The process and its gRPC address."""
    server = subprocess.Popen([DOCENT, "serve", "--data", data, "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0"],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    grpc, server.http = re.search(r"grpc=(\S+) http=(\S+)", server.stdout.readline()).groups()
    return server, grpc


def end(program):
    program.terminate()
    program.wait(timeout=60)
    program.stdout.close()


def serve(test_class, data):
    server, address = begin_server(data)
    test_class.addClassCleanup(end, server)
    return address


class Examples(unittest.TestCase):
    def test_whole_documents_are_accepted(self):
        found = 0
        with tempfile.TemporaryDirectory() as folder:
            for page in PAGES:
                text = page.read_text(encoding="utf-8")
                for block in BLOCK.finditer(text):
                    kind = ending(block.group(1), block.group(2))
                    if kind is None:
                        continue
                    found += 1
                    place = f"{page.relative_to(ROOT)}:{text.count(chr(10), 0, block.start()) + 2}"
                    with self.subTest(place):
                        file = pathlib.Path(folder) / f"example{found}{kind}"
                        file.write_text(block.group(2), encoding="utf-8")
                        run = subprocess.run([DOCENT, "check", file], capture_output=True, text=True, timeout=60)
                        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertGreater(found, 3)

    def test_file_formats_has_the_numbers_of_this_version(self):
        page = (ROOT / "docs/reference/file_formats.md").read_text(encoding="utf-8")
        rows = re.findall(r"^\|[^|]*\| `?(\w+)`? \| `(k\w+)` in `([\w/.]+)` \|$", page, re.MULTILINE)
        self.assertEqual(len(rows), 5)
        for value, name, file in rows:
            with self.subTest(name):
                line = re.search(rf"\b{name}\b[^=]*= ([^;]*);", (ROOT / file).read_text(encoding="utf-8"))
                self.assertEqual("".join(re.findall(r"\w", line.group(1))), value)

    def test_the_checker_of_file_formats_reads_what_a_server_writes(self):
        page = (ROOT / "docs/reference/file_formats.md").read_text(encoding="utf-8")
        checker = next(b.group(2) for b in BLOCK.finditer(page) if b.group(1) == "python")
        with tempfile.TemporaryDirectory() as folder:
            data = pathlib.Path(folder) / "data"
            server, address = begin_server(data)
            try:
                for n in range(3):
                    subprocess.run([DOCENT, "tell", "--server", address, f"<urn:a> <urn:n> {n}"], check=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
            finally:
                end(server)
            self.assertEqual(len(list(data.glob("snapshot-*"))), 1)
            run = subprocess.run([sys.executable, "-c", checker, data], capture_output=True, text=True, timeout=60)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(run.stdout, "3 records, all right\n")


class Names(unittest.TestCase):
    """What the pages name by its name is there, and a limit has the value that stands before its name."""

    FOLDERS = "graph|reasoner|workflow|maps|robot_adapters|kb_server|proto|ontology|scenarios|tests|scripts|bench|docs"
    PROSE = [ROOT / "ARCHITECTURE.md", *PAGES]

    def test_files_of_the_tree_are_there(self):
        for page in self.PROSE:
            for name in re.findall(rf"`((?:{self.FOLDERS})/[\w./-]*)`", page.read_text(encoding="utf-8")):
                with self.subTest(f"{page.relative_to(ROOT)}: {name}"):
                    self.assertTrue((ROOT / name).exists())

    def test_limits_have_the_values_that_pages_say(self):
        table = (ROOT / "docs/reference/limits.md").read_text(encoding="utf-8")
        limits = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", table, re.MULTILINE))
        compared = 0
        for page in PAGES:
            text = page.read_text(encoding="utf-8")
            for value, name in re.findall(r"([0-9][\d,]*(?: (?:[GMK]iB|min|m?s)\b)?)[^(|.`\d]{0,60}\(`(\w+)`\)", text):
                if name not in limits:
                    continue
                compared += 1
                with self.subTest(f"{page.relative_to(ROOT)}: {name}"):
                    self.assertEqual(re.match(r"[\d,]+(?: (?:[GMK]iB|min|m?s))?", limits[name]).group(), value)
        self.assertGreater(compared, 20)


class Grpc(unittest.TestCase):
    """The Python of the page on gRPC, one program a block, against a server that has the workflow of the page on CAWL."""

    @classmethod
    def setUpClass(cls):
        has_grpc = subprocess.run([PYTHON, "-c", "import grpc, google.protobuf"], stderr=subprocess.DEVNULL).returncode == 0
        if not has_grpc or not shutil.which("protoc") or not shutil.which("grpc_python_plugin"):
            raise unittest.SkipTest("needs python3-grpcio, protobuf-compiler and protobuf-compiler-grpc")
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.root = pathlib.Path(cls.folder.name)
        protos = sorted((ROOT / "proto").rglob("*.proto"))
        subprocess.run(["protoc", "-I", ROOT / "proto", f"--python_out={cls.root}", f"--grpc_python_out={cls.root}",
                        f"--plugin=protoc-gen-grpc_python={shutil.which('grpc_python_plugin')}", *protos], check=True)
        blocks = [b.group(2) for b in BLOCK.finditer((ROOT / "docs/reference/grpc.md").read_text(encoding="utf-8"))
                  if b.group(1) == "python"]
        for name, block in zip(["tell", "follow", "start", "adapter"], blocks, strict=True):
            (cls.root / f"{name}.py").write_text(block, encoding="utf-8")
        cls.address = serve(cls, cls.root / "data")
        hello = next(b.group(2) for b in BLOCK.finditer((ROOT / "docs/reference/cawl.md").read_text(encoding="utf-8"))
                     if 'name="Hello"' in b.group(2))
        (cls.root / "hello.cawl.xml").write_text(hello, encoding="utf-8")

    def start(self, name):
        program = subprocess.Popen([PYTHON, "-u", self.root / f"{name}.py", self.address], stdout=subprocess.PIPE, text=True)
        self.addCleanup(end, program)
        return program

    def test_telling_is_read_back(self):
        out, _ = self.start("tell").communicate(timeout=60)
        self.assertRegex(out, r"revision \d+ added \d+ inferred 0\nrevision \d+ who booth\n.*#John .*#B03\n")

    def test_followers_get_the_answer_first(self):
        self.assertEqual(self.start("follow").stdout.readline(), "the answer is now:\n")

    def test_a_workflow_runs_on_the_adapter(self):
        adapter = self.start("adapter")
        client = [DOCENT, "query", "--server", self.address]
        until = time.monotonic() + 60
        ready = "ASK { ?r docent:offers ?o ; docent:status docent:Standby ; docent:localised true }"
        while subprocess.run([*client, ready], capture_output=True).returncode:
            self.assertLess(time.monotonic(), until)
            time.sleep(0.1)
        loaded = subprocess.run([DOCENT, "load", "--server", self.address, self.root / "hello.cawl.xml"], capture_output=True, text=True)
        self.assertEqual(loaded.returncode, 0, loaded.stderr)
        out, _ = self.start("start").communicate(timeout=60)
        self.assertRegex(out, r"^Welcome-\d+\n")
        self.assertRegex(out, r"- run done\n$")
        self.assertEqual(adapter.stdout.readline(), "says: Welcome!\n")
        (self.root / "speech.rsel.xml").write_text(
            '<rsel name="Speech"><message name="Text"><part name="text"/></message>'
            '<process name="speak" input="Text"><invoke operation="say"/></process></rsel>', encoding="utf-8")
        loaded = subprocess.run([DOCENT, "load", "--server", self.address, self.root / "speech.rsel.xml"], capture_output=True, text=True)
        self.assertEqual(loaded.returncode, 0, loaded.stderr)
        speak = [DOCENT, "services", "invoke", "--server", self.address, "speak", "--arg"]
        said = subprocess.run([*speak, 'text="hello"'], capture_output=True, text=True)
        self.assertEqual((said.returncode, adapter.stdout.readline()), (0, "says: hello\n"), said.stdout)
        refused = subprocess.run([*speak, 'text=""'], capture_output=True, text=True)
        self.assertEqual(refused.returncode, 1, refused.stdout)
        self.assertIn("there is nothing to say", refused.stdout)
        adapter.terminate()
        self.assertEqual(adapter.wait(timeout=30), 0)
        left = subprocess.run([*client, "ASK { ?r docent:status docent:Offline ; docent:lastSeenAt ?at }"], capture_output=True)
        self.assertEqual(left.returncode, 0)


class Http(unittest.TestCase):
    """The commands and programs of the page on HTTP about the API, on a new server, in order."""

    def test_the_api_answers_as_the_page_says(self):
        page = (ROOT / "docs/reference/http.md").read_text(encoding="utf-8")
        section = page[page.index("## The API"):page.index("### Errors of the API")]
        commands = 0
        with tempfile.TemporaryDirectory() as folder:
            server, _ = begin_server(pathlib.Path(folder) / "data")
            self.addCleanup(end, server)
            for language, text in BLOCK.findall(section):
                text = text.replace("127.0.0.1:7480", server.http)
                if language == "python":
                    out = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60)
                    self.assertEqual((out.stderr, out.stdout.splitlines()[-1]), ("", "{}"))
                    self.assertIn("urn:B03", out.stdout)
                if language != "text":
                    continue
                for example in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                    command, expected = re.match(r"((?:[^\n]*\\\n)*[^\n]*)\n(.*)", example, re.DOTALL).groups()
                    commands += 1
                    with self.subTest(command):
                        out = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
                        self.assertEqual(out.stdout.strip(), expected.strip())
        self.assertGreater(commands, 3)


if __name__ == "__main__":
    unittest.main()
