#!/usr/bin/env python3
"""check_layers.py finds each kind of fault: every test plants one in a copy of the tree and expects its place."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def check(root, layers):
    run = subprocess.run([sys.executable, HERE / "check_layers.py", root, layers], capture_output=True, text=True)
    return run.returncode, run.stdout.splitlines()


class RealTree(unittest.TestCase):
    def test_real_tree_is_clean(self):
        code, faults = check(ROOT, HERE / "layers.txt")
        self.assertEqual((code, faults), (0, []))


class Planted(unittest.TestCase):
    """A copy of the sources (without build folders), clean but for what a test plants in it."""

    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="docent-layers-"))
        self.addCleanup(shutil.rmtree, self.root)
        for top in ("graph", "kb_server", "reasoner", "workflow", "maps", "robot_adapters", "proto", "bench"):
            shutil.copytree(ROOT / top, self.root / top, ignore=lambda folder, names: [
                n for n in names if os.path.isfile(os.path.join(folder, n)) and not n.endswith((".h", ".cc", ".proto"))])
        self.layers = self.root / "layers.txt"
        shutil.copy(HERE / "layers.txt", self.layers)
        self.before = set(check(self.root, self.layers)[1])

    def plant(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def assert_fault(self, place, words):
        """The check fails, one new line stands at `place` and says `words`, and there is no other (a forbidden
        include may close a cycle besides)."""
        code, faults = check(self.root, self.layers)
        self.assertEqual(code, 1)
        new = [f for f in faults if f not in self.before]
        hits = [f for f in new if f.startswith(place + ": ") and words in f]
        self.assertEqual(len(hits), 1, f"expected one '{place}: … {words} …' in {new}")
        others = [f for f in new if f not in hits and (words.startswith("cycle") or ": cycle: " not in f)]
        self.assertEqual(others, [])

    def test_forbidden_include(self):
        self.plant("graph/store/planted.h", '#include <vector>\n\n#include "reasoner/rules/rule_engine.h"\n')
        self.assert_fault("graph/store/planted.h:3", "graph/store may not include reasoner/rules")

    def test_later_stage_is_forbidden(self):
        self.plant("reasoner/rules/planted.cc", '#include "workflow/engine/engine.h"\n')
        self.assert_fault("reasoner/rules/planted.cc:1", "reasoner/rules may not include workflow/engine")

    def test_nothing_includes_the_composition_root(self):
        self.plant("kb_server/door/planted.cc", '#include "kb_server/turn/turn.h"\n')
        self.assert_fault("kb_server/door/planted.cc:1", "may not include kb_server/turn")

    def test_graph_includes_nothing_above_it(self):
        for target in ("workflow/cawl/ast.h", "robot_adapters/proxy/robot_proxies.h", "kb_server/door/inbox.h"):
            with self.subTest(target=target):
                self.plant("graph/log/planted.h", f'#include "{target}"\n')
                self.assert_fault("graph/log/planted.h:1", "graph/log may not include")

    def test_unused_grant(self):
        text = self.layers.read_text().replace("workflow/engine:  ", "workflow/engine: reasoner/rules ", 1)
        self.layers.write_text(text)
        line = next(n for n, l in enumerate(text.splitlines(), 1) if l.startswith("workflow/engine:"))
        self.assert_fault(f"layers.txt:{line}", "workflow/engine is granted reasoner/rules and does not include it")

    def test_unused_grant_of_a_header(self):
        text = self.layers.read_text().replace("sqlite3.h:  ", "sqlite3.h: maps ", 1)
        self.layers.write_text(text)
        line = next(n for n, l in enumerate(text.splitlines(), 1) if l.startswith("sqlite3.h:"))
        self.assert_fault(f"layers.txt:{line}", "maps is granted sqlite3.h and does not include it")

    def test_private_header_of_another_folder(self):
        self.plant("graph/rdf/secret.h", "// A planted table. Private to this\n// folder. Any thread.\n#include <string>\n")
        self.plant("graph/store/planted.h", '#include "graph/rdf/secret.h"\n')
        self.assert_fault("graph/store/planted.h:1", "graph/rdf/secret.h is private to its folder")

    def test_angle_brackets_do_not_hide_an_include(self):
        self.plant("graph/rdf/planted.h", "#include <graph/store/quad.h>\n")
        self.assert_fault("graph/rdf/planted.h:1", "graph/rdf may not include graph/store")

    def test_relative_include(self):
        self.plant("graph/store/planted.h", '#include "../rdf/term.h"\n')
        self.assert_fault("graph/store/planted.h:1", "not written from the root")

    def test_include_beside_the_file(self):
        self.plant("graph/store/planted.h", '\n#include "quad.h"\n')
        self.assert_fault("graph/store/planted.h:2", "not written from the root")

    def test_unlisted_folder(self):
        self.plant("kb_server/helpers/strings.h", "#include <string>\n")
        self.assert_fault("kb_server/helpers/strings.h:1", "kb_server/helpers is not listed")

    def test_unlisted_folder_below_a_listed_one(self):
        self.plant("graph/store/detail/node.h", "#include <string>\n")
        self.assert_fault("graph/store/detail/node.h:1", "graph/store/detail is not listed")

    def test_redland_outside_its_folder(self):
        self.plant("graph/sparql/run/planted.cc", "#include <redland.h>\n")
        self.assert_fault("graph/sparql/run/planted.cc:1", "redland.h may not be included in graph/sparql/run")

    def test_generated_header_outside_its_folders(self):
        self.plant("workflow/engine/planted.cc", '#include "docent/v1/context.pb.h"\n')
        self.assert_fault("workflow/engine/planted.cc:1", "docent/v1/context.pb.h may not be included in workflow/engine")

    def test_log_record_outside_the_log(self):
        self.plant("kb_server/turn/planted.cc", '#include "graph/log/turn_record.pb.h"\n')
        self.assert_fault("kb_server/turn/planted.cc:1", "may not be included in kb_server/turn")

    def test_every_named_third_party_header_is_held(self):
        for number, (header, folder) in enumerate([
                ("sqlite3.h", "graph/store"), ("libxml/parser.h", "graph/store"), ("zlib.h", "maps"),
                ("re2/re2.h", "workflow/rsel"), ("octomap/octomap.h", "robot_adapters/navigation"),
                ("mrpt/slam/CMonteCarloLocalization2D.h", "maps"), ("boost/asio.hpp", "kb_server/door"),
                ("cairo.h", "robot_adapters/sim"), ("grpcpp/grpcpp.h", "graph/log")]):
            with self.subTest(header=header):
                name = f"{folder}/planted_{number}.h"
                self.plant(name, f"#include <{header}>\n")
                self.assert_fault(f"{name}:1", f"{header} may not be included in {folder}")
                (self.root / name).unlink()

    def test_unlisted_third_party_header(self):
        self.plant("graph/base/planted.h", "#include <curl/curl.h>\n")
        self.assert_fault("graph/base/planted.h:1", "header curl/curl.h is not listed")

    def test_a_folder_listed_twice(self):
        lines = self.layers.read_text().splitlines()
        first = next(i for i, line in enumerate(lines) if line.startswith("kb_server/grpc:"))
        self.layers.write_text("\n".join(lines[:first + 1] + lines[first:]) + "\n")
        self.assert_fault(f"layers.txt:{first + 2}", "kb_server/grpc is listed a second time")

    def test_a_table_with_a_cycle(self):
        text = self.layers.read_text().replace("graph/rdf:  ", "graph/rdf: graph/store ", 1)
        self.layers.write_text(text)
        self.plant("graph/rdf/planted.h", '#include "graph/store/quad.h"\n')
        line = next(n for n, l in enumerate(text.splitlines(), 1) if l.startswith("graph/rdf:"))
        self.assert_fault(f"layers.txt:{line}", "names graph/store, which is not above it")

    def test_a_cycle_of_includes(self):
        self.plant("bench/planted_a.h", '#include "tests/cycle/planted_b.h"\n')
        self.plant("tests/cycle/planted_b.h", '#include "bench/planted_a.h"\n')
        self.layers.write_text(self.layers.read_text())
        self.assert_fault("tests/cycle/planted_b.h:1", "cycle: bench -> tests/** -> bench")

    def test_own_header_comes_first(self):
        self.plant("graph/base/planted.h", "#include <string>\n")
        self.plant("graph/base/planted.cc", '#include <string>\n\n#include "graph/base/planted.h"\n')
        self.assert_fault("graph/base/planted.cc:1", "first include")

    def test_commented_include_is_no_include(self):
        self.plant("graph/base/planted.h", '/* for example\n#include "../store/quad.h"\n*/\n// #include <redland.h>\n')
        code, faults = check(self.root, self.layers)
        self.assertEqual([f for f in faults if "planted" in f], [])


if __name__ == "__main__":
    unittest.main()
