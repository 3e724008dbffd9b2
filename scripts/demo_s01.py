#!/usr/bin/env python3
"""Scenario s01 for people: starts server, robot and visitor, and prints what happens, fact → condition → command → result."""
import argparse
import json
import shutil
import signal
import sys

import docent_stage as stage
from timeline import BOLD, PLAIN, Timeline, watch

FOLDER = stage.ROOT / "build" / "demo" / "s01"


def show_end(server, robot, ended):
    print(f"\n{BOLD}The run {ended['run']} is {ended['state']}.{PLAIN} {ended['detail']}".rstrip())
    report = json.loads((robot.folder / "report.json").read_text())
    print(f"\nThe robot drove {report['path_m']:.1f} m. Position error of its estimate against the simulator's truth:")
    print(f"  RMSE {report['rmse_mm']:.1f} mm and {report['rmse_deg']:.2f}°, largest {report['max_error_mm']:.1f} mm")
    print("\nLook at:")
    for words, file in (("spoken", "*.wav"), ("screen page", "*.html"), ("driven path on the hall", "*.png")):
        for path in sorted(robot.folder.glob(file)):
            print(f"  {words:<24} {path.relative_to(stage.ROOT)}")
    print(f"  {'logs and data':<24} {FOLDER.relative_to(stage.ROOT)}")
    binary = (stage.binaries() / "docent").relative_to(stage.ROOT)
    print(f"""
To go on from here, start the server again on the same data and ask it:
  {binary} serve --data {(FOLDER / 'data').relative_to(stage.ROOT)} &
  {binary} query 'SELECT ?robot ?region WHERE {{ ?robot a docent:Robot ; docent:isAt ?region }}'
  {binary} runs
  curl -s -H 'Accept: text/csv' --data-urlencode 'query=SELECT ?node ?because WHERE {{ GRAPH ?g {{ ?n <https://w3id.org/docent#nodeName> ?node ; <https://w3id.org/docent#firedBecause> ?because }} }}' http://127.0.0.1:7480/sparql""")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=4, help="how much faster than real time the robot lives (default 4)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated noise")
    parser.add_argument("--booth", default="B03", choices=[f"B{i:02}" for i in range(1, 13)])
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(130))
    shutil.rmtree(FOLDER, ignore_errors=True)
    ended = {}
    with stage.Stage(FOLDER) as show:
        server = show.server()
        timeline = Timeline(server)
        timeline.line("server", f"docent serves gRPC at {server.grpc}, HTTP at {server.http}")
        stage.load_s01(server)
        timeline.line("loaded", "ontology, hall, world, rules, robot services, workflow")
        robot = show.robot(server, seed=arguments.seed, speed=arguments.speed)
        server.wait_for("expo:R01 docent:status docent:Standby ; docent:localised true", 120)
        timeline.line("robot", f"R01 is on standby at {server.select('SELECT ?r { expo:R01 docent:isAt ?r }')[0]['r']}")
        visitor = stage.Visitor(server, arguments.booth,
                                on_step=lambda words, fact: timeline.line("fact", fact, more=[words]))
        visitor.start()
        watch(server, timeline, "expo:R01", ended)
        visitor.join(10)
        if visitor.error:
            raise visitor.error
        robot.stop()
        show_end(server, robot, ended)
    return 0 if ended["state"] == "done" else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
