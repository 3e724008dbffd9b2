#!/usr/bin/env python3
"""Scenario s02 for people: what a real robot recorded goes through the localiser into the graph, and a workflow fires when
that robot enters a region."""
import argparse
import csv
import re
import shutil
import signal
import sys

import docent_stage as stage
from timeline import BOLD, PLAIN, Timeline, watch

FOLDER = stage.ROOT / "build" / "demo" / "s02"


def reference_entry(region_wkt):
    """The step at which the recorded reference (reference.csv) first lies in the axis-parallel region."""
    corners = [tuple(map(float, p.split())) for p in re.search(r"\(\((.*)\)\)", region_wkt)[1].split(",")]
    (x0, x1), (y0, y1) = [(min(v), max(v)) for v in zip(*corners)]
    with open(stage.S02 / "reference.csv") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if x0 <= float(row["x_m"]) <= x1 and y0 <= float(row["y_m"]) <= y1:
                return int(row["step"])
    return None


def show_end(server, robot, ended):
    print(f"\n{BOLD}The run {ended.get('run', '(none)')} is {ended.get('state', 'not there')}.{PLAIN}")
    wkt = server.select("SELECT ?wkt { s02:EastDoors geo:hasGeometry ?g . ?g geo:asWKT ?wkt }")[0]["wkt"]
    entered = re.search(r"step (\d+) .*EastDoors", robot.output())
    print(f"The robot entered s02:EastDoors at step {entered[1] if entered else '(never)'} of the recording; "
          f"the reference enters it at step {reference_entry(wkt)}.")
    folder = FOLDER.relative_to(stage.ROOT)
    print(f"""
Look at:
  path in the real building  {folder}/robot/replay.png
  poses of all steps         {folder}/robot/replay.csv
  logs and data              {folder}""")


def main():
    argparse.ArgumentParser(prog="scripts/demo s02", description=__doc__).parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(130))
    shutil.rmtree(FOLDER, ignore_errors=True)
    ended = {}
    with stage.Stage(FOLDER) as show:
        server = show.server()
        timeline = Timeline(server)
        timeline.line("server", f"docent serves gRPC at {server.grpc}, HTTP at {server.http}")
        stage.load_s02(server)
        timeline.line("loaded", "ontology, places, the robot that made the recording, workflow")
        robot = show.start("robot", [show.bin / "docent-robot", "replay", "--server", server.grpc,
                                     "--layout", stage.S02 / "layout.ttl", "--out", FOLDER / "robot"])
        timeline.line("robot", "the recording begins: wheel odometry and laser scans, at the pace of 2006")
        watch(server, timeline, "s02:RealRobot", ended, robot.running)
        if robot.popen.wait(120) != 0:
            raise stage.StageError(f"docent-robot replay: {robot.tail()}")
        timeline.line("robot", robot.output().splitlines()[-1])
        show_end(server, robot, ended)
    return 0 if ended.get("state") == "done" else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
