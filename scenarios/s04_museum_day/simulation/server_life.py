"""The server as a simulation sees it: what it is told, and that it may be killed. A part of Day."""
import heapq
import random
import time

import grpc

from robots import MUSEUM

SECOND_US = 1_000_000
PREFIXES = f"@prefix museum: <{MUSEUM}> . @prefix docent: <https://w3id.org/docent#> . @prefix xsd: <http://www.w3.org/2001/XMLSchema#> .\n"
CALL_S = 30


class ServerLife:
    def tell(self, source, turtle):
        self.told += 1
        source = source if ":" in source else f"urn:museum:phone:{source}"
        self.outbox.append(self.protos.context.AssertRequest(request_id=f"day-{self.told}", source=source, rdf=PREFIXES + turtle))
        robot = self.robots.get(source.removeprefix(MUSEUM))
        if robot is not None:
            robot.told_charge, robot.told_us = round(robot.charge, 1), self.clock.now_us

    def call(self, method, request):
        """Again while the server is away; whoever gets the request twice knows it."""
        deadline = time.monotonic() + CALL_S
        while True:
            try:
                return method(request, timeout=CALL_S, wait_for_ready=True)
            except grpc.RpcError as error:
                if error.code() != grpc.StatusCode.UNAVAILABLE or time.monotonic() > deadline:
                    raise
                time.sleep(0.01)

    def flush(self, at_most=None):
        """In order, each until it is acknowledged; again with the same id where it is not known whether it arrived."""
        while self.up and self.outbox and at_most != 0:
            self.call(self.context.Assert, self.outbox[0])
            self.outbox.pop(0)
            at_most = None if at_most is None else at_most - 1

    def join(self, robot):
        with robot.presence:
            if robot.alive:
                request = self.protos.fleet.JoinRequest(address=f"127.0.0.1:{robot.port}", description=robot.description())
                self.call(self.fleet.Join, request)

    def keep_joining(self):
        while not self.over.wait(0.5):
            for robot in self.robots.values():
                try:
                    if self.up:
                        self.join(robot)
                except (grpc.RpcError, ValueError):
                    pass  # the next time

    # ---- the server, which may be killed -----------------------------------------------------------------------------------

    def kill_at(self, times_us, seed, kill_server, start_server):
        """The server is killed at these times: at rest, in the middle of what it does, or before it has answered."""
        self.kills, self.dice = sorted(times_us), random.Random(seed)
        self.kill_server, self.start_server = kill_server, start_server

    def next_kill(self):
        return self.kills[0] if self.kills else None

    def kill(self):
        self.kills.pop(0)
        how = self.dice.choice(("at rest", "at work", "before it answers"))
        if how == "before it answers":
            self.tell("nobody", f"museum:Kill{len(self.kills)} museum:greeted true .")
            call = self.context.Assert.future(self.outbox[0], timeout=CALL_S)
            time.sleep(self.dice.uniform(0, 0.004))
        elif how == "at work":
            self.flush(self.dice.randint(0, len(self.outbox)))
        else:
            self.settle()
        self.kill_server()
        if how == "before it answers":
            call.cancel()
        self.up = False
        down_us = int(self.dice.uniform(5, 60) * SECOND_US)
        self.show(self.clock.now_us, f"kill -9 of the server, {how}; it is away for {down_us // SECOND_US} s")
        back_us = self.clock.now_us + down_us
        while self.events and self.events[0][0] <= back_us:
            self.clock.go_to(self.events[0][0])
            heapq.heappop(self.events)[2]()
        self.clock.go_to(back_us)
        self.start_server()
        self.up = True
        self.wait_for_robots()
