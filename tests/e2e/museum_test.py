#!/usr/bin/python3
"""The museum day (scenarios/s04_museum_day) with a real server, in simulated time: what becomes of each request is what
outcome.csv says, with the server killed now and then, too. DOCENT_E2E_CRASHES sets how often the server is killed (scripts/soak:
10), DOCENT_E2E_SEED repeats a choice of moments."""
import csv
import json
import os
import pathlib
import random
import sys
import unittest

from docent_e2e import StageTest, stage

try:
    import grpc  # noqa: F401
except ImportError:  # Debian's python has it; another one may stand before it in PATH
    if sys.executable == "/usr/bin/python3":
        raise
    os.execv("/usr/bin/python3", ["/usr/bin/python3", "-B", *sys.argv])
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scenarios/s04_museum_day/simulation"))
import museum_day  # noqa: E402

CRASHES = int(os.environ.get("DOCENT_E2E_CRASHES", "2"))
S04 = stage.ROOT / "scenarios" / "s04_museum_day"
EIGHT_FIFTY = "2026-05-12T06:50:00Z"
IN_ORDER = ("lead", "pickUp", "bringToCloakroom")  # not idempotent: at most once for a group (and exhibit)


class Museum(StageTest):
    def open(self):
        clock = self.file("museum.clock", EIGHT_FIFTY + "\n")
        server = self.stage.server(arguments=["--simulated-clock", clock])
        stage.load_s04(server)
        said = []
        self.day = museum_day.Day(
            museum_day.Protos(self.stage.folder / "protos"), server.grpc, server.http,
            museum_day.SimulatedTime(clock, museum_day.micros(museum_day.time_in(clock))), museum_day.make_plan(),
            museum_day.places_of(server.http), lambda time_us, words: said.append(f"{museum_day.text_of(time_us)} {words}"))
        self.addCleanup(lambda: (self.stage.folder / "day.log").write_text("\n".join(said)) if self.stage.folder.exists() else None)
        self.nine_us = museum_day.nine_of(museum_day.time_in(clock))
        return server

    def rows(self, server, name):
        return museum_day.sparql(server.http, (S04 / name).read_text())

    def outcomes(self, server):
        rows = server.select("""SELECT ?request ?outcome ?because { ?request a ?class . ?class rdfs:subClassOf <https://w3id.org/docent/museum#Request> .
            OPTIONAL { ?request <https://w3id.org/docent/museum#outcome> ?outcome }
            OPTIONAL { ?request <https://w3id.org/docent/museum#because> ?because } }""")
        return {r["request"].split("#")[1]: (r.get("outcome", "#none").split("#")[1], r.get("because", "")) for r in rows}

    def assert_robots_behaved(self):
        done = [c for robot in self.day.robots.values() for c in robot.done]
        self.assertEqual([f for robot in self.day.robots.values() for f in robot.faults], [])
        once = [(c.operation, c.arguments["group"], c.arguments.get("exhibit")) for c in done if c.operation in IN_ORDER]
        self.assertEqual(len(once), len(set(once)), "something that is not idempotent was done twice")
        self.assertEqual(len(done), len({c.id for c in done}))

    def assert_over(self, server):
        """Nothing is left of the day but its facts."""
        for pattern in ('?run docent:runState "running"', "?robot docent:heldBy ?run", "?workflow docent:waitingFirings ?n",
                        "?e a docent:Event", "?n docent:nodeState 'incident'"):
            self.assertFalse(server.ask(pattern), server.command("runs"))
        self.assertEqual(self.day.idleness.look()["docent_commands_open"], 0)

    @staticmethod
    def was_called_away(robot):
        """It brought the box between two exhibits of one group, or between leading and presenting."""
        tours = [c.arguments["group"] if c.operation == "lead" else c.operation for c in robot.done if c.operation in ("lead", "bringBox")]
        return any(tours[i] == "bringBox" and 0 < i < len(tours) - 1 and tours[i - 1] == tours[i + 1] for i in range(len(tours)))

    def expected(self):
        with open(S04 / "outcome.csv", encoding="ascii") as file:
            return {row["request"]: (row["outcome"], row["because"]) for row in csv.DictReader(file)}

    def play(self, kills=0, seed=0):
        server = self.open()
        dice = random.Random(seed)
        moments = [self.day.clock.now_us + int(dice.uniform(15, 615) * 60e6) for _ in range(kills)]
        # Most of the kills come when there is most to do.
        moments[: kills // 2] = [self.nine_us + int(dice.uniform(149, 220) * 60e6) for _ in moments[: kills // 2]]
        self.day.kill_at(moments, seed, server.kill, server.start)
        self.day.run(self.nine_us)
        self.assertEqual(self.day.kills, [])
        self.assert_robots_behaved()
        self.assert_over(server)
        self.assertEqual(self.outcomes(server), self.expected())
        visitors = self.rows(server, "visitors.rq")
        self.assertEqual(len({row["visitor"] for row in visitors}), 60)
        self.assertEqual([r for r in visitors if r["outcome"] != "Served" and not r.get("because")], [])
        return server

    def test_the_whole_day(self):
        server = self.play()
        robots = self.day.robots.values()
        self.assertTrue(server.ask("docent:clock docent:simulatedTime true"))
        # Before noon all guides are on tours: one is called away between two steps, and goes on afterwards.
        self.assertTrue(any(self.was_called_away(robot) for robot in robots), [[c.operation for c in r.done] for r in robots])
        for aid in server.select("""PREFIX museum: <https://w3id.org/docent/museum#> SELECT ?asked ?begun {
                ?r a museum:FirstAidRequest ; museum:askedAt ?asked ; museum:begunAt ?begun FILTER(?begun - ?asked > "PT1S"^^xsd:dayTimeDuration) }"""):
            self.fail(f"an emergency waited: {aid}")
        self.assertTrue(any(c.operation == "dock" and c.begun_us < self.nine_us + 9 * 3600e6 for r in robots for c in r.done), "none charged")
        self.assertTrue(all(robot.place == "Docks" for robot in robots))
        handed_over = {r["r"].split("#")[1] for r in server.select("SELECT ?r { ?r <https://w3id.org/docent/museum#handedOver> true }")}
        self.assertIn("G20-tour1", handed_over, "its robot failed")
        self.assertGreater(len(handed_over), 1, "R2 was taken out of service while it was on a tour")
        for name in ("requests.rq", "robots.rq", "waits.rq"):
            print("\n" + server.command("query", "-f", S04 / name), flush=True)
        # No time of this world got into the graph.
        self.assertFalse(server.ask('?s ?p ?time FILTER(DATATYPE(?time) = xsd:dateTime && (?time < "2026-05-12T00:00:00Z"^^xsd:dateTime'
                                    ' || ?time > "2026-05-14T00:00:00Z"^^xsd:dateTime))'))

    def test_kill_nine_leaves_each_outcome_as_it_is(self):
        seed = int(os.environ.get("DOCENT_E2E_SEED", random.randrange(1 << 30)))
        print(f"seed {seed}, {CRASHES} kills", flush=True)
        server = self.play(CRASHES, seed)
        server.stop()
        done = self.docent("verify", "--json", server.data)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(json.loads(done.stdout)["last"], 1000)


if __name__ == "__main__":
    unittest.main()
