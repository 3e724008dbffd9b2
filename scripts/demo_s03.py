#!/usr/bin/env python3
"""Scenario s03 for people: John's Service, which reuses the booth guide, with two robots, of which one suits John."""
import argparse
import shutil
import signal
import sys

import docent_stage as stage
import stage_s03
from timeline import BOLD, PLAIN, Timeline, watch

FOLDER = stage.ROOT / "build" / "demo" / "s03"


def show_end(server, robot, ended):
    print(f"\n{BOLD}The run {ended['run']} is {ended['state']}.{PLAIN} {ended['detail']}".rstrip())
    for row in server.select("""SELECT ?name ?value { ?run docent:flow "JohnsService" ; docent:hasResult ?r .
            ?r docent:variableName ?name ; docent:variableValue ?value } ORDER BY ?name"""):
        print(f"  {row['name']:<10} {row['value']}")
    print("\nWhat R02 said to John, in his language:")
    for path in sorted(robot.folder.glob("said_*.wav.txt")):
        print(f"  {path.relative_to(stage.ROOT)}: {path.read_text()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=4, help="how much faster than real time the robots live (default 4)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated noise")
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(130))
    shutil.rmtree(FOLDER, ignore_errors=True)
    ended = {}
    with stage.Stage(FOLDER) as show:
        server = show.server()
        timeline = Timeline(server)
        timeline.line("server", f"docent serves gRPC at {server.grpc}, HTTP at {server.http}")
        stage_s03.load_s03(server)
        timeline.line("loaded", "ontology, hall, profiles, rules, the booth guide and John's Service")
        _, robot = stage_s03.robots(show, server, seed=arguments.seed, speed=arguments.speed)
        for name in ("R01", "R02"):
            server.wait_for(f"expo:{name} docent:status docent:Standby ; docent:localised true", 120)
        timeline.line("robot", "R01 and R02 are on standby")
        john = stage_s03.John(server, on_step=lambda words, fact: timeline.line("fact", fact, more=[words]))
        john.start()
        watch(server, timeline, "expo:R02", ended, of="JohnsService")  # sub-flows are runs, too, and end before it
        john.join(10)
        if john.error:
            raise john.error
        show_end(server, robot, ended)
    return 0 if ended["state"] == "done" else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
