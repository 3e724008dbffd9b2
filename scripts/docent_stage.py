"""Real processes on one machine: a docent server, robots and a visitor. Shared by scripts/demo and tests/e2e.

Every server takes a free port and prints it; every process writes to a log file in the stage's folder; what was started
here is ended here, by its process id. Standard library only.
"""
import json
import os
import pathlib
import signal
import subprocess
import threading
import time
import urllib.error
import urllib.parse
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[1]
PREFIXES = {
    "docent": "https://w3id.org/docent#", "expo": "https://w3id.org/docent/expo#",
    "s02": "https://w3id.org/docent/s02#", "schema": "https://schema.org/",
    "geo": "http://www.opengis.net/ont/geosparql#", "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
    "prov": "http://www.w3.org/ns/prov#", "xsd": "http://www.w3.org/2001/XMLSchema#",
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
}
SPARQL_PROLOGUE = "".join(f"PREFIX {name}: <{iri}>\n" for name, iri in PREFIXES.items())
EXPO = PREFIXES["expo"]


class StageError(Exception):
    """Something that a person has to know; carries the end of the log that tells why."""


def binaries():
    """The folder with docent and docent-robot: DOCENT_BINARIES, or the newest build that has them."""
    if "DOCENT_BINARIES" in os.environ:
        return pathlib.Path(os.environ["DOCENT_BINARIES"])
    built = [p.parent for p in ROOT.glob("build/*/bin/docent")]
    if not built:
        raise StageError("docent is not built; run scripts/demo or scripts/test")
    return max(built, key=lambda folder: (folder / "docent").stat().st_mtime)


def wait_until(predicate, seconds, what):
    """Polls until `predicate()` gives something true, which is returned. StageError after `seconds`."""
    deadline = time.monotonic() + seconds
    while True:
        result = predicate()
        if result:
            return result
        if time.monotonic() > deadline:
            raise StageError(f"waited {seconds} s in vain for {what}")
        time.sleep(0.02)


class Process:
    """One child process with its output in a file. A process group of its own, so that its children end with it."""

    def __init__(self, argv, log, env=None):
        self.argv, self.log = [str(a) for a in argv], pathlib.Path(log)
        self.file = open(self.log, "ab")
        self.start_of_output = self.log.stat().st_size
        self.popen = subprocess.Popen(self.argv, stdout=self.file, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                      env={**os.environ, **(env or {})}, start_new_session=True)

    @property
    def pid(self):
        return self.popen.pid

    def running(self):
        return self.popen.poll() is None

    def output(self):
        with open(self.log, "rb") as file:
            file.seek(self.start_of_output)
            return file.read().decode(errors="replace")

    def wait_for_output(self, words, seconds):
        """The first line of the output that contains `words`."""
        def line():
            found = next((l for l in self.output().splitlines() if words in l), None)
            if found is None and not self.running():
                raise StageError(f"{self.argv[0]} ended with code {self.popen.returncode}: {self.tail()}")
            return found
        return wait_until(line, seconds, f'"{words}" from {self.argv[0]}; it said: {self.tail()}')

    def tail(self):
        return "\n".join(self.output().splitlines()[-12:])

    def signal(self, number):
        """To the process and its children. Nothing happens if it has ended."""
        if self.running():
            os.killpg(self.pid, number)

    def stop(self, seconds=10):
        """Asks it to end, then makes it. Its exit code."""
        try:
            self.signal(signal.SIGTERM)
            self.popen.wait(seconds)
        except subprocess.TimeoutExpired:
            self.kill()
        self.file.close()
        return self.popen.returncode

    def kill(self):
        """kill -9: it gets no chance to tidy up."""
        self.signal(signal.SIGKILL)
        self.popen.wait()


class Stage:
    """A folder for one showing, and everything that runs in it. A context manager: leaving it ends all processes."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.bin = binaries()
        self.processes = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            process.stop()

    def start(self, name, argv, env=None):
        process = Process(argv, self.folder / f"{name}.log", env)
        self.processes.append(process)
        return process

    def server(self, **options):
        return Server(self, **options)

    def robot(self, server, **options):
        return Robot(self, server, **options)


class Server:
    """`docent serve` on free ports. After kill() or stop(), start() brings it back on the same data and ports."""

    def __init__(self, stage, data="data", arguments=(), wrapper=()):
        self.stage, self.data = stage, stage.folder / data
        self.arguments, self.wrapper = list(arguments), list(wrapper)
        self.grpc, self.http, self.process = "127.0.0.1:0", "127.0.0.1:0", None
        self.start()

    def start(self):
        self.process = self.stage.start("server", [
            *self.wrapper, self.stage.bin / "docent", "serve", "--data", self.data, "--grpc", self.grpc, "--http", self.http,
            *self.arguments])
        line = self.process.wait_for_output("listening grpc=", 60)
        self.grpc, self.http = [word.split("=", 1)[1] for word in line.split() if "=" in word][:2]

    def kill(self):
        self.process.kill()

    def stop(self):
        return self.process.stop()

    def run(self, *arguments, text=None, timeout=60):
        """A client command of docent against this server: CompletedProcess with text output."""
        return subprocess.run([str(self.stage.bin / "docent"), *map(str, arguments)], input=text, timeout=timeout,
                              capture_output=True, text=True, env={**os.environ, "DOCENT_SERVER": self.grpc})

    def command(self, *arguments, **options):
        """As run; StageError if it fails. Its standard output."""
        done = self.run(*arguments, **options)
        if done.returncode != 0:
            raise StageError(f"docent {' '.join(map(str, arguments))}: code {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def load(self, *files):
        return self.command("load", *files)

    def tell(self, facts=None, *, withdraw=None, readings=(), source=None, request_id=None):
        """Asserts through the command line; the acknowledgement as a dictionary (revision, added, removed, …)."""
        arguments = ["tell", "--json", "--prefix", f"expo={EXPO}"]
        arguments += [facts] if facts else []
        arguments += ["--withdraw", withdraw] if withdraw else []
        arguments += [a for sensor, value in readings for a in ("--reading", f"{sensor}={value}")]
        arguments += ["--source", source] if source else []
        arguments += ["--request-id", request_id] if request_id else []
        return json.loads(self.command(*arguments))

    def sparql(self, query, timeout=30):
        """A query over HTTP (SPARQL 1.1 Protocol); the parsed JSON results. urllib's errors pass through."""
        body = urllib.parse.urlencode({"query": SPARQL_PROLOGUE + query}).encode()
        request = urllib.request.Request(f"http://{self.http}/sparql", body,
                                         {"Accept": "application/sparql-results+json"})
        with urllib.request.urlopen(request, timeout=timeout) as reply:
            return json.load(reply)

    def ask(self, pattern):
        return self.sparql(f"ASK {{ {pattern} }}")["boolean"]

    def select(self, query):
        """Rows as dictionaries variable → text; IRIs as prefix:local where a prefix of ours fits."""
        rows = self.sparql(query)["results"]["bindings"]
        return [{name: shorten(cell["value"]) if cell["type"] == "uri" else cell["value"] for name, cell in row.items()}
                for row in rows]

    def wait_for(self, pattern, seconds=60):
        """Until the ASK pattern holds; a server that is down meanwhile is waited for, too."""
        def holds():
            try:
                return self.ask(pattern)
            except (urllib.error.URLError, ConnectionError, TimeoutError, OSError):
                return False
        wait_until(holds, seconds, pattern)

    def metrics(self):
        """/metrics as a dictionary: name with labels → number."""
        with urllib.request.urlopen(f"http://{self.http}/metrics", timeout=10) as reply:
            lines = reply.read().decode().splitlines()
        return {l.rsplit(" ", 1)[0]: float(l.rsplit(" ", 1)[1]) for l in lines if l and not l.startswith("#")}


def shorten(iri):
    for name, namespace in PREFIXES.items():
        if iri.startswith(namespace):
            return f"{name}:{iri[len(namespace):]}"
    return iri


class Robot:
    """`docent-robot`: the simulated robot of a scenario, its own process."""

    def __init__(self, stage, server, name="R01", hall=None, folder="robot", seed=1, speed=1.0, arguments=()):
        self.stage, self.folder = stage, stage.folder / folder
        self.folder.mkdir(exist_ok=True)
        self.argv = [stage.bin / "docent-robot", "--server", server.grpc, "--robot", name if ":" in name else EXPO + name,
                     "--hall", hall or S01 / "hall.ttl", "--out", self.folder, "--seed", seed, "--speed", speed, *arguments]
        self.process = None
        self.start()

    def start(self):
        self.process = self.stage.start("robot", self.argv)

    def kill(self):
        self.process.kill()

    def stop(self):
        return self.process.stop()


# ---- scenario s04 -------------------------------------------------------------------------------------------------------

S04 = ROOT / "scenarios" / "s04_museum_day"


def load_s04(server):
    """The server has a simulated clock; scenarios/s04_museum_day/simulation plays the rest."""
    load_ontology(server)
    server.command("load", "--as", "ontology", S04 / "museum.ttl")
    server.load(S04 / "hall.ttl", S04 / "world.ttl", S04 / "museum.rules")
    server.load(*sorted(S04.glob("*.rsel.xml")), *sorted(S04.glob("*.cawl.xml")))


# ---- scenario s02 -------------------------------------------------------------------------------------------------------

S02 = ROOT / "scenarios" / "s02_real_robot_log"


def load_s02(server, layout=S02 / "layout.ttl"):
    load_ontology(server)
    server.load(layout, S02 / "world.ttl", S02 / "s02.cawl.xml")


# ---- scenario s01 -------------------------------------------------------------------------------------------------------

S01 = ROOT / "scenarios" / "s01_booth_guide"


def load_ontology(server):
    server.command("load", "--as", "ontology", *sorted(ROOT.glob("ontology/*.ttl")))


def load_s01(server, workflow=True):
    """Ontology, hall, world and rules; then the robot services and the workflow."""
    load_ontology(server)
    server.load(S01 / "hall.ttl", S01 / "world.ttl", S01 / "pictures.ttl", S01 / "guide.rules")
    if workflow:
        server.load(*sorted(S01.glob("*.rsel.xml")), *sorted(S01.glob("*.cawl.xml")))


class Visitor(threading.Thread):
    """John: comes in, asks for a guide, waits for the robot, picks a booth and follows. What he does is told as the
    scenario's sensors and his phone would tell it. A server that is down meanwhile is waited for; a call that may or may
    not have arrived is repeated under the same request id."""

    SENSORS, PHONE = "urn:docent:source:sensors", "urn:docent:source:johns-phone"

    def __init__(self, server, booth="B03", patience_s=300, on_step=lambda words, fact: None):
        super().__init__(daemon=True)
        self.server, self.booth, self.patience_s, self.on_step = server, booth, patience_s, on_step
        self.told = []  # (facts as an ASK pattern, acknowledgement)
        self.error = None

    def run(self):
        try:
            self.step("arrives", "expo:John docent:isAt expo:Entrance", "John comes in; the door sensor reads his badge, tag-17",
                      readings=[("expo:DoorSensor", "tag-17")])
            self.step("asks", "expo:John docent:chose expo:BoothGuideService", "John asks for the booth guide on his phone")
            self.server.wait_for("expo:John docent:isNear expo:R01 . expo:R01 docent:status docent:Standby", self.patience_s)
            self.step("selects", f"expo:John docent:selected expo:{self.booth}", "R01 stands before John; he selects a booth")
            self.server.wait_for(f"expo:R01 docent:isAt expo:{self.booth} ; docent:status docent:Standby", self.patience_s)
            self.step("follows", f"expo:John docent:isAt expo:{self.booth}", "John has followed R01; the booth's beacon reads his badge",
                      readings=[(f"expo:{self.booth}Beacon", "tag-17")])
        except Exception as error:  # shown by whoever joins this thread
            self.error = error

    def step(self, name, fact, words, readings=()):
        self.on_step(words, fact)

        def attempt():
            try:
                if readings:
                    return self.server.tell(readings=readings, source=self.SENSORS, request_id=f"john-{name}")
                return self.server.tell(fact, source=self.PHONE, request_id=f"john-{name}")
            except StageError:
                return None
        self.told.append((fact, wait_until(attempt, self.patience_s, f"John's step {name}")))
