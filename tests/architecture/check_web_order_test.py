#!/usr/bin/env python3
"""check_web_order.py finds each kind of fault, and none in a tree that is right."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from check_web_order import check  # noqa: E402

ORDER = "# lowest first\ngen\napi\nleft, right\napp\n"
RIGHT = {
    "main.tsx": 'import { start } from "./app/start";\n',
    "api/client.ts": 'import { Reply } from "../gen/reply_pb";\nexport const client = 1;\n',
    "left/view.tsx": 'import {\n  client,\n} from "../api/client";\nimport "./view.css";\n',
    "left/view.css": "",
    "right/view.tsx": 'export * from "../api/client";\n',
    "app/start.ts": 'const view = () => import("../left/view");\n',
}


class CheckWebOrder(unittest.TestCase):
    def faults(self, **changed):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "order.txt").write_text(ORDER)
            for name, text in {**RIGHT, **{k.replace("__", "/").replace("_ts", ".ts"): v for k, v in changed.items()}}.items():
                file = root / "src" / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            return check(root / "src", root / "order.txt")

    def test_right(self):
        self.assertEqual(self.faults(), [])

    def test_upward(self):
        self.assertEqual(self.faults(api__up_ts='import { view } from "../left/view";\n'),
                         ["api/up.ts:1: api may not import left, which is not below it"])

    def test_upward_at_run_time(self):
        self.assertEqual(len(self.faults(api__up_ts='void import("../left/view");\n')), 1)

    def test_upward_for_types_alone(self):
        self.assertEqual(len(self.faults(api__up_ts='import type { View } from "../left/view";\n')), 1)

    def test_beside(self):
        self.assertEqual(self.faults(left__other_ts='\nimport { view } from "../right/view";\n'),
                         ["left/other.ts:2: left may not import right, which is not below it"])

    def test_to_the_top(self):
        self.assertEqual(self.faults(app__other_ts='import "../main";\n'),
                         ["app/other.ts:1: app may not import main.tsx, which is not below it"])

    def test_unlisted(self):
        self.assertEqual(self.faults(misc__x_ts="export const x = 1;\n"), ["misc/x.ts:1: the folder misc is not in order.txt"])

    def test_absent(self):
        self.assertEqual(self.faults(api__x_ts='import { y } from "./y";\n'), ["api/x.ts:1: there is no y"])

    def test_circle(self):
        self.assertEqual(self.faults(api__x_ts='import { y } from "./y";\n', api__y_ts='import { x } from "./x";\n'),
                         ["api/x.ts:1: a circle of imports: x.ts → y.ts → x.ts"])

    def test_circle_of_types(self):
        self.assertEqual(self.faults(api__x_ts='import { y } from "./y";\n', api__y_ts='import type { X } from "./x";\n'), [])


if __name__ == "__main__":
    unittest.main()
