#!/usr/bin/env python3
"""strace of the server shows an fdatasync before each acknowledgement and before each command.

The trace holds the system calls that sync the log and those that write to sockets. Each batch carries a mark; the order must be:
the mark arrives (recv) … fdatasync … the reply with the batch's answer (send). Between the arrival of a batch and the next
bytes sent to that client there must be a finished fdatasync.
"""
import re
import shutil
import unittest

from docent_e2e import PATIENCE_S, StageTest, stage

CALL = re.compile(r"^(?P<pid>\d+) +(?P<time>[\d.]+) (?P<call>\w+)\((?P<rest>.*)$")


def calls(trace):
    """(time of completion, name, text) of each finished call, in order. strace splits a call that another interrupts."""
    unfinished = {}
    for line in trace.read_text(errors="replace").splitlines():
        match = CALL.match(line)
        if match:
            if line.endswith("<unfinished ...>"):
                unfinished[match["pid"], match["call"]] = match["rest"]
            else:
                yield match["call"], match["rest"]
            continue
        resumed = re.match(r"^(\d+) +[\d.]+ <\.\.\. (\w+) resumed>(.*)$", line)
        if resumed:
            yield resumed[2], unfinished.pop((resumed[1], resumed[2]), "") + resumed[3]


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class Durability(StageTest):
    def trace(self):
        return ["strace", "-f", "-ttt", "-s", "65536", "-o", str(self.stage.folder / "trace.txt"), "-e",
                "trace=fdatasync,fsync,sendmsg,sendto,write,pwrite64,writev,recvmsg,recvfrom,read"]

    def test_fdatasync_stands_before_each_acknowledgement(self):
        server = self.stage.server(wrapper=self.trace())
        marks = [f"urn:mark:{i:04}" for i in range(20)]
        for mark in marks:
            server.tell(f"<{mark}> <urn:says> 1", request_id=f"request-{mark}")
        server.stop()
        state, synced, shown = {}, 0, []
        for name, text in calls(self.stage.folder / "trace.txt"):
            if name in ("recvmsg", "recvfrom", "read"):
                for mark in marks:
                    if f"request-{mark}" in text and mark not in state:
                        state[mark] = synced
            elif name in ("fdatasync", "fsync") and "= 0" in text:
                synced += 1
            elif name in ("sendmsg", "sendto", "writev") and "grpc-status" in text:
                for mark in [m for m in state if m not in shown]:
                    self.assertGreater(synced, state[mark], f"{mark} was acknowledged before an fdatasync")
                    shown.append(mark)
        self.assertEqual(shown, marks, "every batch was seen to arrive, to be synced and to be acknowledged")

    def test_fdatasync_stands_before_each_command(self):
        server = self.stage.server(wrapper=self.trace())
        stage.load_s01(server)
        robot = self.stage.robot(server, speed=8)
        server.wait_for("expo:R01 docent:status docent:Standby ; docent:localised true", PATIENCE_S)
        visitor = stage.Visitor(server, "B03", PATIENCE_S)
        visitor.start()
        self.wait_for_run(server)
        robot.stop()
        server.stop()
        decided, sent, synced = {}, {}, 0
        for name, text in calls(self.stage.folder / "trace.txt"):
            ids = set(re.findall(r"BoothGuide[\w-]*/\w+/\d+/[\d.]+/\d+/\d+", text))
            if name in ("fdatasync", "fsync") and "= 0" in text:
                synced += 1
            elif name == "write" or name.startswith("pwrite"):
                for command in ids - decided.keys():
                    decided[command] = synced  # the record that decides it is being written to the log
            elif name in ("sendmsg", "sendto", "writev"):
                for command in ids - sent.keys():
                    sent[command] = synced
        self.assertGreaterEqual(len(sent), 4)
        for command, syncs in sent.items():
            self.assertIn(command, decided, "sent without having been written to the log")
            self.assertGreater(syncs, decided[command], f"{command} was sent before its record was durable")


if __name__ == "__main__":
    unittest.main()
