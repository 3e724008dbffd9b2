"""The readable timeline of a demo: fact → condition with its facts → command with its steps → answer."""
import json
import re
import sys
import threading
import time

import docent_stage as stage

BOLD, DIM, PLAIN = ("\033[1m", "\033[2m", "\033[0m") if sys.stdout.isatty() else ("", "", "")


class Timeline:
    """Prints one line an event, with the time since the beginning. Any thread."""

    def __init__(self, server):
        self.server, self.start, self.lock = server, time.time(), threading.Lock()

    def line(self, kind, words, at=None, more=()):
        since = (at or time.time()) - self.start
        with self.lock:
            print(f"{since:7.2f} s  {BOLD}{kind:<10}{PLAIN} {words}", flush=True)
            for detail in more:
                print(f"{'':22}{DIM}{detail}{PLAIN}", flush=True)

    def events(self, events):
        """RunEvents (proto/docent/v1/workflows.proto) of a moment; within a turn what came in stands before what went out."""
        order = {"report": 0, "command": 2}
        for event in sorted(events, key=lambda e: (int(e["revision"]), order.get(e["kind"], 1))):
            getattr(self, "show_" + event["kind"])(event, event.get("to", ""), event.get("detail", "").strip(),
                                                   int(event["time_us"]) / 1e6)

    def show_run(self, event, to, detail, at):
        facts = [f.strip(" .") + " ." for f in shorten_text(detail.partition(": ")[2]).split(" . ") if f.strip(" .")]
        words = f"{event['run']} begins, because" if to == "running" else f"{event['run']} is {to}"
        self.line("run", words, at, facts)

    def show_node(self, event, to, detail, at):
        """A condition that opened is shown with its facts, a node that waits with what it waits for."""
        node = event["node"]
        if to == "running":
            because = self.look(event, "firedBecause")
            self.line("condition", f"{node} fires: {shorten_text(detail)}", at, because)
        elif to == "waiting":
            asks = [l for l in self.look(event, "waitsFor") if not l.startswith("PREFIX")]
            self.line("condition", f"{node} waits {detail}" + (" until" if asks else ""), at, asks)
        else:
            self.line("result", f"{node} is {to}: {shorten_text(detail)}", at)

    def look(self, event, name):
        """The lines of a property of the node, as the graph has it now."""
        node = f"urn:docent:run:{event['run']}/{event['node']}"
        rows = self.server.select(f"SELECT ?text {{ <{node}> docent:{name} ?text }}")
        return [shorten_text(line).rstrip() for row in rows for line in row["text"].splitlines() if line.strip()]

    def show_invocation(self, event, to, detail, at):
        """An RSEL process, or with "N/M" one of its steps."""
        place, _, words = shorten_text(detail).partition(": ")
        step = re.search(r" (\d+/\d+) (\w+):?$", place.rstrip(":") + ":")
        if step:
            self.line("step", f"{step[1]} {step[2]} is {to}{': ' if words else ''}{words}", at)
        elif to == "running":
            self.line("service", f"{words}", at)

    def show_command(self, event, to, detail, at):
        sent = re.match(r"(\S+) to (\S+): (\w+\(.*?\)),", detail)
        robot = stage.shorten(sent[2])
        self.line("command", f"to {robot}: {shorten_text(sent[3])}   {DIM}{sent[1]}{PLAIN}", at)

    def show_report(self, event, to, detail, at):
        command, _, words = detail.partition(": ")
        self.line("answer", f"{to}{': ' if words else ''}{words}   {DIM}{command}{PLAIN}", at)


def shorten_text(text):
    """IRIs of N-Triples or SPARQL lines as prefixed names."""
    return re.sub(r"<([^<>\s]+)>", lambda iri: stage.shorten(iri[1]) if stage.shorten(iri[1]) != iri[1] else iri[0], text)


def watch(server, timeline, robot, ended, alive=lambda: True, of=""):
    """Follows all runs until the first one of the workflow `of` (of any, without a name) ends, whose state goes to `ended`, or
    `alive()` is false. Also shows in which region `robot` is, a prefixed name."""
    process = server.stage.start("watch", [server.stage.bin / "docent", "runs", "--watch", "--json", "--server", server.grpc])
    try:
        follow(server, timeline, robot, ended, alive, of, process)
    finally:
        process.stop()  # the next one writes into the same file


def follow(server, timeline, robot, ended, alive, of, process):
    seen, region = 0, ""
    while not ended.get("state"):
        last_look = not alive()
        time.sleep(0.05)
        lines = [l for l in process.output().splitlines(keepends=True) if l.endswith("\n")]
        events = [json.loads(line) for line in lines[seen:]]
        seen = len(lines)
        now = next((row["r"] for row in server.select(f"SELECT ?r {{ {robot} docent:isAt ?r }}")), "")
        if now != region:
            region = now
            timeline.line("fact", f"{robot} docent:isAt {region or '(nowhere)'}")
        timeline.events(events)
        for event in events:
            is_end = event["kind"] == "run" and event["to"] in ("done", "failed", "cancelled")
            if is_end and event["run"].startswith(of) and not ended.get("state"):
                ended.update(state=event["to"], run=event["run"], detail=event.get("detail", ""))
        if not process.running():
            raise stage.StageError(f"docent runs --watch ended: {process.tail()}")
        if last_look:
            return
