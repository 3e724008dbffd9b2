#!/usr/bin/env python3
"""What the pages of docs/ show is true: every whole document is one that `docent check` accepts, and the page on file
formats has the numbers of this version and a checker that reads what a server writes.

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
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
DOCENT = pathlib.Path(os.environ["DOCENT_BINARIES"]) / "docent"
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
    if language == "sparql" and re.match(r"(#[^\n]*\n)*(PREFIX|SELECT|ASK|CONSTRUCT|DESCRIBE)\b", text):
        return ".rq"
    return None


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
            server = subprocess.Popen([DOCENT, "serve", "--data", data, "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0"],
                                      stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            try:
                address = re.search(r"grpc=(\S+)", server.stdout.readline()).group(1)
                for n in range(3):
                    subprocess.run([DOCENT, "tell", "--server", address, f"<urn:a> <urn:n> {n}"], check=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
            finally:
                server.send_signal(signal.SIGTERM)
                server.wait(timeout=60)
                server.stdout.close()
            self.assertEqual(len(list(data.glob("snapshot-*"))), 1)
            run = subprocess.run([sys.executable, "-c", checker, data], capture_output=True, text=True, timeout=60)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(run.stdout, "3 records, all right\n")


if __name__ == "__main__":
    unittest.main()
