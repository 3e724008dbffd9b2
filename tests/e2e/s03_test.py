#!/usr/bin/env python3
"""Scenario s03 with real processes: John's Service meets John with a robot that suits him, has the booth guide show him what
suits him, speaks his language, and asks him at the end."""
import unittest

from docent_e2e import PATIENCE_S, SPEED, StageTest, journal, stage
import stage_s03


class JohnsService(StageTest):
    def start(self):
        server = self.stage.server()
        stage_s03.load_s03(server)
        robots = stage_s03.robots(self.stage, server, speed=SPEED)
        for name in ("R01", "R02"):
            server.wait_for(f"expo:{name} docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        return server, *robots

    def test_john_is_shown_what_suits_him_in_his_language(self):
        server, one, two = self.start()
        server.tell("expo:Ada docent:isAt expo:Entrance ; docent:chose expo:JohnsService")
        self.assertFalse(server.ask("?run a docent:Run"), "nobody knows the profile of Ada")
        john = stage_s03.John(server, rating=4, patience_s=PATIENCE_S)
        john.start()
        server.wait_for('?run docent:flow "JohnsService" ; docent:runState ?s FILTER(?s != "running")', PATIENCE_S)
        john.join(PATIENCE_S)
        self.assertIsNone(john.error)
        runs = server.select("SELECT ?flow ?state { ?run docent:flow ?flow ; docent:runState ?state } ORDER BY ?run")
        self.assertEqual([(r["flow"], r["state"]) for r in runs],
                         [("BoothGuide", "done"), ("BoothGuide", "done"), ("JohnsService", "done")], runs)
        self.assertTrue(server.ask('?guide docent:flow "BoothGuide" ; docent:parentRun ?run . ?run docent:flow "JohnsService"'))

        # four booths suit him, and he has time for two
        self.assertEqual(john.seen, ["expo:B03", "expo:B04"])
        self.assertEqual(server.select("SELECT ?b { expo:John docent:hasSeen ?b } ORDER BY ?b"), [{"b": b} for b in john.seen])
        results = server.select("""SELECT ?name ?value { ?run docent:flow "JohnsService" ; docent:hasResult ?r .
            ?r docent:variableName ?name ; docent:variableValue ?value }""")
        self.assertEqual({r["name"]: r["value"] for r in results}, {"shown": "expo:B04", "rating": "4", "servedBy": "expo:R02"})
        self.assertFalse(server.ask("expo:John docent:chose ?service"), "his wish is fulfilled")
        self.assertFalse(server.ask("expo:John docent:placesLeft ?n"), "what was told for the run ends with it")

        # the robot that speaks German and is not too fast did it all, and said it in German
        self.assertEqual(journal(one), [])
        self.assertEqual([c.split("/")[1] for c in journal(two) if c.startswith("JohnsService")],
                         ["Meet", "Greet", "Greet", "Explain", "Explain", "Explain", "Explain", "Ask", "Ask",
                          "SayGoodbye", "SayGoodbye"])
        said = [p.read_text() for p in sorted(two.folder.glob("said_*.wav.txt"))]
        self.assertEqual(len(said), 5)
        for words, text in zip(("Willkommen", "Treppen", "Pumpe", "gefallen", "Auf Wiedersehen"), said):
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()
