#!/usr/bin/env python3
"""The timeline of a demo: each event stands in it once, up to the end of the run that is shown."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import timeline  # noqa: E402


def event(run, to):
    return json.dumps({"revision": "1", "time_us": "1", "run": run, "kind": "run", "to": to, "detail": ""}) + "\n"


class Watch:
    """`docent runs --watch`, whose output all of them append to one file."""

    file = ""

    def __init__(self, events):
        self.start, self.stopped = len(Watch.file), False
        Watch.file += events

    def output(self):
        return Watch.file[self.start:]

    def running(self):
        return not self.stopped

    def stop(self):
        self.stopped = True


class Server:
    """Stands for its stage, too."""

    def __init__(self, *events):
        self.stage, self.bin, self.grpc = self, pathlib.Path("bin"), "127.0.0.1:1"
        self.events, self.watches = list(events), []

    def start(self, *_):
        self.watches.append(Watch(self.events.pop(0)))
        return self.watches[-1]

    def select(self, _):
        return []


class Timeline(unittest.TestCase):
    def test_runs_that_end_before_do_not_begin_it_again(self):
        server = Server(event("Talk-1", "running") + event("Talk-1", "done") + event("Visit-1", "done"), event("Visit-2", "failed"))
        shown = []
        line = timeline.Timeline(server)
        line.line = lambda kind, words, *_, **__: shown.append(words)
        first, second = {}, {}
        timeline.watch(server, line, "e:R1", first, of="Visit")
        timeline.watch(server, line, "e:R1", second, of="Visit")
        self.assertEqual((first["run"], first["state"]), ("Visit-1", "done"))
        self.assertEqual((second["run"], second["state"]), ("Visit-2", "failed"))
        self.assertEqual(shown, ["Talk-1 begins, because", "Talk-1 is done", "Visit-1 is done", "Visit-2 is failed"])
        self.assertTrue(all(watch.stopped for watch in server.watches), "the next one writes into the same file")


if __name__ == "__main__":
    unittest.main(verbosity=2)
