#!/usr/bin/python3
"""Scenario s04 for people: a museum's day in simulated time, and what became of everybody in the end."""
import argparse
import shutil
import signal
import subprocess
import sys

import docent_stage as stage

FOLDER = stage.ROOT / "build" / "demo" / "s04"


def main():
    parser = argparse.ArgumentParser(prog="scripts/demo s04", description=__doc__)
    parser.add_argument("--until", default="19:30", help="HH:MM of the museum's clock")
    parser.add_argument("--seed", default="4", help="of the plan of the day")
    arguments = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(130))
    shutil.rmtree(FOLDER, ignore_errors=True)
    with stage.Stage(FOLDER) as show:
        clock = FOLDER / "museum.clock"
        clock.write_text("2026-05-12T06:50:00Z\n")
        server = show.server(arguments=["--simulated-clock", clock])
        stage.load_s04(server)
        played = subprocess.run(["/usr/bin/python3", stage.S04 / "simulation" / "museum_day.py", "--server", server.grpc, "--http", server.http, "--clock", clock,
                                 "--until", arguments.until, "--seed", arguments.seed])
        for name in ("requests.rq", "robots.rq", "waits.rq"):
            print("\n" + server.command("query", "-f", stage.S04 / name))
        return played.returncode


if __name__ == "__main__":
    try:
        sys.exit(main())
    except stage.StageError as error:
        sys.exit(f"demo: {error}")
