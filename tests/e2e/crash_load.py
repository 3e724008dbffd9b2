"""A mixed load on a server that is going to crash, and what must be true of it afterwards.

Each writer sends batches that belong together: a batch's facts are all there or none, and all of a batch that was
acknowledged are there. A batch whose answer was lost is sent again under the same request id, as a careful client does,
and must not be applied twice.
"""
import contextlib
import http.client
import json
import threading
import urllib.parse

BATCH = 4  # facts of a batch


class Writer(threading.Thread):
    """SPARQL updates over HTTP: sometimes plain insertions, sometimes a counter that each update raises by one."""

    def __init__(self, load, name):
        super().__init__(daemon=True)
        self.load, self.server, self.name = load, load.server, name
        self.acknowledged, self.attempted, self.raised = [], 0, 0
        self.refusals = []  # answers that say why nothing was done
        self.stopped = threading.Event()

    def update(self, number):
        if number % 5 == 4:
            counter = f"<urn:load:{self.name}> <urn:load:count>"
            return (f"DELETE {{ {counter} ?n }} INSERT {{ {counter} ?m }} "
                    f"WHERE {{ OPTIONAL {{ {counter} ?n }} BIND(COALESCE(?n, 0) + 1 AS ?m) }}")
        facts = " . ".join(f"<urn:load:{self.name}:{number}> <urn:load:part> {part}" for part in range(BATCH))
        return f"INSERT DATA {{ {facts} }}"

    def send(self, number):
        host, port = self.server.http.rsplit(":", 1)
        connection = http.client.HTTPConnection(host, int(port), timeout=10)
        try:
            query = urllib.parse.urlencode({"request-id": f"{self.name}-{number}"})
            connection.request("POST", f"/sparql?{query}", self.update(number), {"Content-Type": "application/sparql-update"})
            reply = connection.getresponse()
            body = reply.read().decode()
            if reply.status == 200:
                return json.loads(body)
            self.refusals.append(f"{reply.status} {body.strip()}")
            return None
        finally:
            connection.close()

    def run(self):
        number = 0
        while not self.stopped.is_set():
            self.attempted = number
            cuts = self.load.cuts
            try:
                answer = self.send(number)
            except (OSError, http.client.HTTPException, ValueError):
                answer = None  # the server is down; the same batch again under the same request id
            if answer is None or cuts % 2 == 1 or cuts != self.load.cuts:
                self.stopped.wait(0.02)
                continue
            if number % 5 == 4:
                self.raised += 1
            else:
                self.acknowledged.append(number)
            number += 1


class Load:
    def __init__(self, server, writers=4):
        self.server = server
        self.cuts = 0  # odd: within a cut
        self.writers = [Writer(self, f"w{i}") for i in range(writers)]

    def __enter__(self):
        for writer in self.writers:
            writer.start()
        return self

    def __exit__(self, *_):
        for writer in self.writers:
            writer.stopped.set()
        for writer in self.writers:
            writer.join(60)

    @contextlib.contextmanager
    def cut(self):
        """Answers are lost: none counts that came after this began, nor any to a request that was sent before it ended."""
        self.cuts += 1
        try:
            yield
        finally:
            self.cuts += 1

    def acknowledged(self):
        return sum(len(w.acknowledged) + w.raised for w in self.writers)

    def faults(self):
        """What is wrong, in words; empty: everything acknowledged is there, and nothing is half there. The load may go on."""
        before = [(w, list(w.acknowledged), w.raised) for w in self.writers]
        rows = self.server.select("SELECT ?s (COUNT(*) AS ?n) { ?s <urn:load:part> ?p } GROUP BY ?s")
        parts = {row["s"]: int(row["n"]) for row in rows}
        counters = {row["s"]: int(row["n"]) for row in self.server.select("SELECT ?s ?n { ?s <urn:load:count> ?n }")}
        faults = [f"{s} is half there: {n} of {BATCH} facts" for s, n in parts.items() if n != BATCH]
        for writer, acknowledged, raised in before:
            lost = [n for n in acknowledged if f"urn:load:{writer.name}:{n}" not in parts]
            faults += [f"{writer.name}: batch {n} was acknowledged and is not there" for n in lost]
            count = counters.get(f"urn:load:{writer.name}", 0)
            most = writer.raised + 1  # the last may be there without an answer
            if not raised <= count <= most:
                faults.append(f"{writer.name}: counted {count}, acknowledged {raised} to {most - 1}")
        return faults
