#!/usr/bin/env python3
"""Scenario s05 for people: a care home's robot delivers by day, and by night brings back what is refused."""
import argparse
import shutil
import signal
import sys

import docent_stage as stage
import stage_s05
from timeline import BOLD, PLAIN, Timeline, watch

FOLDER = stage.ROOT / "build" / "demo" / "s05"


def deliver(server, timeline, name, answer, urgent=False):
    """One delivery from the order to its end; how its run has ended."""
    ended = {}

    def people():
        stage_s05.wait_for_node(server, name, "Load", "waiting")
        timeline.line("fact", "the pharmacist puts it into the tray and presses the button")
        stage_s05.event(server, "loaded", f"care:{name} care:loadedBy care:Pharmacist")
        stage_s05.wait_for_node(server, name, "HandOver", "waiting")
        timeline.line("fact", f"at the door it is {answer}")
        stage_s05.event(server, answer, f"care:{name} care:{answer}By care:ResidentOfRoom2")

    timeline.line("fact", f"{name} is ordered for room 2")
    stage_s05.order(server, name, "care:Room2", urgent=urgent)
    thread = stage.threading.Thread(target=people, daemon=True)
    thread.start()
    watch(server, timeline, "care:C01", ended, of="Deliver")
    thread.join(10)
    return ended


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=4, help="how much faster than real time the robot lives (default 4)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated noise")
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(130))
    shutil.rmtree(FOLDER, ignore_errors=True)
    with stage.Stage(FOLDER) as show:
        server = show.server()
        timeline = Timeline(server)
        timeline.line("server", f"docent serves gRPC at {server.grpc}, HTTP at {server.http}")
        stage_s05.load_s05(server)
        stage_s05.make_it(server, night=False)
        timeline.line("loaded", "ontology, floor, world, rules, robot services, workflow; it is day")
        robot = stage_s05.robot(show, server, speed=arguments.speed, seed=arguments.seed)
        server.wait_for("care:C01 docent:status docent:Standby ; docent:localised true", 120)
        by_day = deliver(server, timeline, "D1", "taken")
        stage_s05.make_it(server, night=True)
        print(f"\n{BOLD}Night falls.{PLAIN} What is not urgent waits for the morning.\n")
        by_night = deliver(server, timeline, "D2", "refused", urgent=True)
        print(f"\n{BOLD}By day {by_day['run']} is {by_day['state']}, by night {by_night['run']} is {by_night['state']}.{PLAIN} {by_night['detail']}")
        print(f"It was brought back: C01 is at {server.select('SELECT ?r { care:C01 docent:isAt ?r }')[0]['r']}.")
        print(f"Logs and data: {FOLDER.relative_to(stage.ROOT)}; what it said: {len(list(robot.folder.glob('said_*.wav')))} sound file")
    return 0 if (by_day["state"], by_night["state"]) == ("done", "failed") else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
