"""What the end-to-end tests share: a stage for each test, kept with all its logs when the test fails."""
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import docent_stage as stage  # noqa: E402

# Simulated time against real time: fast, but slow enough for two busy cores. Sanitizers make everything slower.
SPEED = float(os.environ.get("DOCENT_E2E_SPEED", "8"))
PATIENCE_S = 300  # how long a test waits for something before it says what did not happen


class StageTest(unittest.TestCase):
    """self.stage is a fresh stage; self.server() and self.robot() start processes on it."""

    maxDiff = None

    def setUp(self):
        folder = tempfile.mkdtemp(prefix=self.id().split(".")[-1] + "-", dir=os.environ.get("DOCENT_E2E_FOLDER"))
        self.stage = stage.Stage(folder)
        self.addCleanup(self.end_stage)

    def end_stage(self):
        self.stage.__exit__()
        outcome = self._outcome
        failed = any(error for _, error in outcome.errors) if hasattr(outcome, "errors") else not outcome.success
        if failed:
            print(f"\nlogs and data are kept in {self.stage.folder}", file=sys.stderr)
            for log in sorted(self.stage.folder.glob("*.log")):
                print(f"---- end of {log.name}", file=sys.stderr)
                print("\n".join(log.read_text(errors="replace").splitlines()[-25:]), file=sys.stderr)
        else:
            shutil.rmtree(self.stage.folder, ignore_errors=True)

    def docent(self, *arguments, text=None):
        """A docent command without a server."""
        import subprocess
        return subprocess.run([str(self.stage.bin / "docent"), *map(str, arguments)], input=text, capture_output=True,
                              text=True, timeout=60)

    def file(self, name, text):
        path = self.stage.folder / name
        path.write_text(text)
        return path

    def start_s01(self, **robot_options):
        """Server with s01 loaded and its robot on standby."""
        server = self.stage.server()
        stage.load_s01(server)
        robot = self.stage.robot(server, speed=SPEED, **robot_options)
        server.wait_for("expo:R01 docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        return server, robot

    def wait_for_run(self, server, state="done"):
        """Until the only run has ended; fails with its reason if it ended otherwise. The run's IRI."""
        server.wait_for("?run docent:runState ?s FILTER(?s != 'running')", PATIENCE_S)
        run = server.select("SELECT ?run ?state ?reason { ?run docent:runState ?state OPTIONAL { ?run docent:reason ?reason } }")
        self.assertEqual([r["state"] for r in run], [state], f"{run} {nodes(server)}")
        return run[0]["run"]

    def assert_refused(self, done, code, *words):
        """A command failed with this exit code and says all of the words, in a few lines, without a crash."""
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertNotIn("terminate called", done.stderr)


def nodes(server):
    """name → row, for all nodes of all runs."""
    rows = server.select("""SELECT ?name ?state ?reason ?because ?waits { ?n docent:nodeName ?name ; docent:nodeState ?state
        OPTIONAL { ?n docent:reason ?reason } OPTIONAL { ?n docent:firedBecause ?because } OPTIONAL { ?n docent:waitsFor ?waits } }""")
    return {row["name"]: row for row in rows}


def journal(robot):
    """Ids of the commands that the adapter has begun, from its own journal (robot_adapters/sdk/command_journal.h), in order."""
    path = next(robot.folder.glob("*journal*"), None)
    fields = [line.split("\t") for line in path.read_text().splitlines()] if path else []
    return [f[3] for f in fields if f[0] == "begun"]
