#!/usr/bin/env python3
"""Scenario s01 in the browser app: starts server and robot, prints the address, and goes on until Ctrl-C."""
import argparse
import signal
import sys

import docent_stage as stage
from timeline import BOLD, PLAIN

FOLDER = stage.ROOT / "build" / "demo" / "web"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=1, help="how much faster than real time the robot lives (default 1)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulated noise")
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    with stage.Stage(FOLDER) as show:
        server = show.server()
        stage.load_s01(server)
        server.load(stage.S01 / "languages.ttl")
        show.robot(server, seed=arguments.seed, speed=arguments.speed)
        server.tell(readings=[("expo:DoorSensor", "tag-17")])
        print(f"""
  {BOLD}http://{server.http}/{PLAIN}

John stands at the entrance. In the app:
  compose   open BoothGuide and change it, or begin a workflow of your own and reuse it
  hall      the robot R01, live; select it to see why it does what it does
  visit     /visit?at=B07 is what a visitor's phone opens by the code at booth B07: choose the guide, see the robot come
  desk      favourites of the front desk, started by one touch
  be John   tell the server that he chose the guide, then see Runs and Waiting:
            {stage.binaries() / 'docent'} tell --server {server.grpc} \\
              --prefix expo={stage.EXPO} 'expo:John docent:chose expo:BoothGuideService'

The data is kept in {FOLDER.relative_to(stage.ROOT)}. Ctrl-C ends it.""", flush=True)
        signal.pause()


if __name__ == "__main__":
    try:
        main()
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
