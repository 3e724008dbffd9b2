#!/usr/bin/env python3
"""What builds and checks the documentation finds the faults that it is there for."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import check_site  # noqa: E402
import docs_nav  # noqa: E402
import package_try  # noqa: E402
from tutorial_blocks import compare, read_blocks  # noqa: E402
from tutorial_renewal import renewed  # noqa: E402


class Help(unittest.TestCase):
    def test_every_script_answers_before_it_does_anything(self):
        scripts = [p for p in sorted((ROOT / "scripts").iterdir()) if p.is_file() and os.access(p, os.X_OK)]
        self.assertGreater(len(scripts), 15)
        calls = [[script, "--help"] for script in scripts]
        calls += [[ROOT / "scripts/demo", "--web", "--help"], [ROOT / "scripts/demo", "s03", "-h"], [ROOT / "scripts/soak", "fuzz", "-h"],
                  [ROOT / "scripts/test", "--preset", "release", "--help"]]
        with tempfile.TemporaryDirectory() as elsewhere:
            # Whatever would be installed, built or started is not to be found.
            for tool in ("apt-get", "dpkg-query", "cmake", "ninja", "npm", "mkdocs", "sudo"):
                fake = pathlib.Path(elsewhere) / tool
                fake.write_text("#!/bin/sh\necho $0 is called >&2\nexit 99\n")
                fake.chmod(0o755)
            path = f"{elsewhere}:{os.environ['PATH']}"
            for call in calls:
                with self.subTest(" ".join(str(c) for c in call)):
                    said = subprocess.run(call, cwd=elsewhere, env={**os.environ, "PATH": path}, stdin=subprocess.DEVNULL,
                                          capture_output=True, text=True, timeout=60)
                    self.assertEqual((said.returncode, said.stderr), (0, ""))
                    self.assertTrue(said.stdout.strip())


class Pages(unittest.TestCase):
    def test_each_tutorial_names_its_packages_and_stands_in_the_index(self):
        index = (ROOT / "docs/tutorials/index.md").read_text()
        for page in sorted((ROOT / "docs/tutorials").glob("[0-9]*.md")):
            self.assertIn("docent", package_try.packages_of(page), page.name)
            title = page.read_text().split("\n")[0].split(". ", 1)[1]
            self.assertIn(f"[{title}]({page.name})", index)
        self.assertEqual(package_try.packages_of(ROOT / "docs/index.md"), ["docent", "docent-robot"])

    def test_the_tour_of_the_readme_is_that_of_the_documentation(self):
        tour = (ROOT / "README.md").read_text().split("## A short tour")[1].split("\n## ")[0]
        commands = [line.strip() for line in tour.split("\n") if line.startswith("    ")][2:]  # without where the tree is
        shown = [s.command.replace("/usr/share/docent", "$TREE") for s in read_blocks((ROOT / "docs/index.md").read_text())
                 if s.command is not None]
        self.assertEqual(commands, shown)


class Blocks(unittest.TestCase):
    def test_a_titled_block_is_a_file(self):
        file, = read_blocks('Write:\n\n```turtle title="a.ttl"\n:a :b :c .\n```\n')
        self.assertEqual((file.file, file.text, file.line), ("a.ttl", ":a :b :c .\n", 3))

    def test_a_session_is_commands_with_their_output(self):
        first, second = read_blocks("```console\n$ one \\\n>   more\nout\n$ two\n```\n")
        self.assertEqual((first.command, first.expected, first.first_output), ("one \\\n  more", ["out"], 4))
        self.assertEqual((second.command, second.expected, second.line), ("two", [], 5))

    def test_terminals_are_named_and_go_on(self):
        steps = read_blocks('```console title="second"\n$ watch\n1\n```\n```console title="second"\n2\n^C\n```\n')
        self.assertEqual([(s.terminal, s.command) for s in steps], [("second", "watch"), ("second", None), ("second", "^C")])

    def test_other_blocks_are_for_the_reader(self):
        self.assertEqual(read_blocks("```sh\n$ rm -rf x\n```\n"), [])

    def test_an_open_block_is_an_error(self):
        with self.assertRaisesRegex(ValueError, "^1:"):
            read_blocks("```console\n$ one\n")


class Output(unittest.TestCase):
    def test_equal_and_different(self):
        self.assertIsNone(compare(["a", "b"], ["a", "b"]))
        self.assertEqual(compare(["a", "b"], ["a", "c"]), (1, 1))
        self.assertEqual(compare(["a"], ["a", "b"]), (1, 1))
        self.assertEqual(compare(["a", "b"], ["a"]), (1, 1))
        self.assertEqual(compare([], ["a"]), (0, 0))

    def test_an_ellipsis_is_any_text_of_a_line(self):
        self.assertIsNone(compare(["took … ms"], ["took 12.5 ms"]))
        self.assertIsNotNone(compare(["took … ms"], ["took 12.5 s"]))
        self.assertIsNotNone(compare(["a.c"], ["abc"]))

    def test_a_line_of_an_ellipsis_is_any_lines(self):
        self.assertIsNone(compare(["a", "…", "z"], ["a", "b", "c", "z"]))
        self.assertIsNone(compare(["…"], []))
        self.assertIsNotNone(compare(["a", "…", "z"], ["a", "b"]))


class Renewal(unittest.TestCase):
    def test_new_output_takes_the_place_of_the_old(self):
        text = "```console\n$ one\nold\n$ two\nat …\nkept\n```\n"
        one, two = read_blocks(text)
        self.assertEqual(renewed(text, [(one, ["new", "12:30:01"]), (two, ["at 5", "other"])]),
                         "```console\n$ one\nnew\n…\n$ two\nat …\nother\n```\n")


class Running(unittest.TestCase):
    """scripts/tutorials itself, on tutorials that need no server."""

    def run_tutorial(self, text, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "01-try.md"
            path.write_text(text)
            done = subprocess.run([sys.executable, "-B", ROOT / "scripts/tutorials", *options, path], capture_output=True, text=True,
                                  timeout=120, env={**os.environ, "DOCENT_BINARIES": "/bin"})
            return done.returncode, done.stdout + done.stderr, path.read_text()

    def test_files_commands_terminals_and_addresses(self):
        code, output, _ = self.run_tutorial(
            '```text title="a.txt"\nhello\n127.0.0.1:7400\n```\n'
            "```console\n$ ls\na.txt\n$ cat a.txt\nhello\n127.0.0.1:7400\n$ cd /\n$ pwd\n/\n$ (sleep 0.1; echo late) &\nlate\n```\n"
            '```console title="other"\n$ pwd; tail -f a.txt\n…/work\nhello\n127.0.0.1:7400\n```\n'
            '```console title="other"\n^C\n$ echo over\nover\n```\n')
        self.assertEqual(code, 0, output)

    def test_the_first_command_that_differs_is_named_with_its_line(self):
        code, output, _ = self.run_tutorial("# x\n\n```console\n$ echo a\na\n$ printf 'b\\nd\\n'\nb\nc\n$ echo e\n```\n")
        self.assertEqual(code, 1, output)
        self.assertIn("01-try.md:8: ", output)
        self.assertIn("  - c\n", output)
        self.assertIn("  + d\n", output)
        self.assertNotIn("echo e", output)

    def test_renewing_writes_what_is_printed_now(self):
        code, output, text = self.run_tutorial("```console\n$ echo a\nb\n```\n", "--renew")
        self.assertEqual((code, text), (0, "```console\n$ echo a\na\n```\n"), output)


class Navigation(unittest.TestCase):
    def test_folders_become_the_pages_that_are_not_named(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "a").mkdir()
            for name in "two", "one", "first":
                (root / f"a/{name}.md").write_text("# x\n")
            nav = docs_nav.on_config({"docs_dir": folder, "nav": [{"A": ["a/first.md", "a/"]}, {"B": ["b/"]}]})["nav"]
            self.assertEqual(nav, [{"A": ["a/first.md", "a/one.md", "a/two.md"]}])


class Site(unittest.TestCase):
    def faults(self, page, css=""):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "page.html").write_text(page)
            (root / "other.html").write_text('<h1 id="here">x</h1>')
            (root / "style.css").write_text(css)
            return check_site.faults_of(root)[0]

    def test_links_that_lead_somewhere(self):
        self.assertEqual(self.faults('<a href="other.html#here">x</a><a href="https://example.org/">x</a>'), [])

    def test_links_that_lead_nowhere(self):
        self.assertIn("no file", self.faults('<a href="gone.html">x</a>')[0])
        self.assertIn("no such heading", self.faults('<a href="other.html#gone">x</a>')[0])
        self.assertIn("no such heading", self.faults('<a href="#gone">x</a>')[0])
        self.assertIn("no file", self.faults('<img src="gone.png">')[0])

    def test_what_other_hosts_would_be_asked_for(self):
        self.assertIn("another host", self.faults('<script src="https://example.org/x.js"></script>')[0])
        self.assertIn("another host", self.faults('<link rel="stylesheet" href="//example.org/x.css">')[0])
        self.assertIn("another host", self.faults("", "@font-face { src: url('https://example.org/x.woff') }")[0])
        self.assertIn("another host", self.faults('<pre class="mermaid">graph</pre>')[0])
        self.assertEqual(self.faults('<link rel="canonical" href="https://example.org/">'), [])


if __name__ == "__main__":
    unittest.main()
