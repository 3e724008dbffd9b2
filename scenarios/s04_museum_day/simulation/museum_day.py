"""Plays the museum's visitors, robots and clock for a Docent server that has the scenario loaded.

    echo 2026-05-12T06:50:00Z > museum.clock
    docent serve --data data --simulated-clock museum.clock …
    python3 museum_day.py --clock museum.clock [--until 12:00]

Times are those of the museum, in Berlin: 06:50Z is ten to nine. Needs python3-grpcio, protobuf-compiler and
protobuf-compiler-grpc.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import signal
import sys
import tempfile
import threading
import urllib.parse
import urllib.request
import zoneinfo

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from day import Day  # noqa: E402
from plan import make_plan  # noqa: E402
from protos import Protos  # noqa: E402
from robots import MUSEUM  # noqa: E402
from server_time import SimulatedTime, text_of  # noqa: E402, F401

ZONE = zoneinfo.ZoneInfo("Europe/Berlin")
POINTS = """PREFIX docent: <https://w3id.org/docent#> PREFIX geo: <http://www.opengis.net/ont/geosparql#>
SELECT ?place ?point { ?place docent:servicePoint ?p . ?p geo:asWKT ?point }"""


def micros(moment):
    return int(moment.timestamp() * 1_000_000)


def time_in(path):
    return datetime.datetime.fromisoformat(pathlib.Path(path).read_text().strip().replace("Z", "+00:00"))


def nine_of(moment):
    """Nine o'clock in the museum on the day of the moment, in microseconds."""
    return micros(moment.astimezone(ZONE).replace(hour=9, minute=0, second=0, microsecond=0))


def sparql(http, query):
    """Rows of a SELECT, as dictionaries variable → text."""
    body = urllib.parse.urlencode({"query": query}).encode()
    request = urllib.request.Request(f"http://{http}/sparql", body, {"Accept": "application/sparql-results+json"})
    with urllib.request.urlopen(request, timeout=60) as reply:
        rows = json.load(reply)["results"]["bindings"]
    return [{name: cell["value"] for name, cell in row.items()} for row in rows]


def places_of(http):
    """Name → (x, y) in metres, of the regions that have a service point."""
    return {row["place"].removeprefix(MUSEUM): tuple(float(n) for n in re.findall(r"-?[\d.]+", row["point"]))
            for row in sparql(http, POINTS)}


def minute_of(text):
    """HH:MM → minutes after 09:00."""
    hours, minutes = text.split(":")
    return 60 * (int(hours) - 9) + int(minutes)


GO_ON = threading.Event()


def wait_for_signal():
    """Whether it is to go on."""
    if not GO_ON.wait(0.05):
        return False
    GO_ON.clear()
    return True


def show(time_us, words):
    moment = datetime.datetime.fromtimestamp(time_us / 1_000_000, ZONE)
    print(f"{moment:%H:%M:%S}  {words}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--server", default=os.environ.get("DOCENT_SERVER", "127.0.0.1:7400"), help="HOST:PORT of gRPC")
    parser.add_argument("--http", default=os.environ.get("DOCENT_HTTP", "127.0.0.1:7480"), help="HOST:PORT of HTTP")
    parser.add_argument("--clock", required=True, help="the file of the server's --simulated-clock")
    parser.add_argument("--until", help="HH:MM of the museum's clock; without it the whole day")
    parser.add_argument("--stop", action="append", default=[], metavar="HH:MM",
                        help="stop the clock there until kill -USR1; several times")
    parser.add_argument("--seed", type=int, default=4, help="of the plan of the day")
    arguments = parser.parse_args()
    signal.signal(signal.SIGUSR1, lambda *_: GO_ON.set())
    with tempfile.TemporaryDirectory(prefix="museum-day-") as folder:
        protos = Protos(folder)
        began = time_in(arguments.clock)
        clock = SimulatedTime(arguments.clock, micros(began))
        day = Day(protos, arguments.server, arguments.http, clock, make_plan(arguments.seed), places_of(arguments.http), show)
        for stop in arguments.stop:
            day.stop_at(nine_of(began) + 60_000_000 * minute_of(stop), wait_for_signal)
        day.run(nine_of(began), minute_of(arguments.until) if arguments.until else None)
    faults = [fault for robot in day.robots.values() for fault in robot.faults]
    for fault in faults:
        print(f"fault: {fault}", file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
