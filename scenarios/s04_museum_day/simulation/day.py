"""The day itself: groups come and ask, robots work, time goes on from one thing to the next.

All that happens does so in one thread, at times of the simulated clock: it waits until the server has nothing more to do at a
time, and then goes to the next time at which a group, a robot or the server has.
"""
import heapq
import itertools
import random
import threading
import time

import grpc

from group_life import GroupLife
from robot_life import RobotLife
from robots import DOCK_PLACE, Robot, minutes_to_us
from server_life import ServerLife
from server_time import Idleness

ROBOTS = (("R1", "Guide", 100), ("R2", "Guide", 55), ("R3", "Guide", 90), ("R4", "Guide", 80), ("R5", "Porter", 100))
SLOW_S = 2


class Day(GroupLife, RobotLife, ServerLife):
    """`places`: name of each region with a service point → (x, y). `show(time_us, words)`: for people."""

    def __init__(self, protos, grpc_address, http_address, clock, plan, places, show=lambda time_us, words: None):
        self.protos, self.clock, self.plan, self.places, self.show = protos, clock, plan, dict(places), show
        self.idleness = Idleness(http_address)
        options = [("grpc.min_reconnect_backoff_ms", 20), ("grpc.initial_reconnect_backoff_ms", 20), ("grpc.max_reconnect_backoff_ms", 200)]
        self.channel = grpc.insecure_channel(grpc_address, options)
        self.context = protos.context_grpc.ContextStub(self.channel)
        self.fleet = protos.fleet_grpc.FleetStub(self.channel)
        self.robots = {name: Robot(protos, name, kind, DOCK_PLACE, charge) for name, kind, charge in ROBOTS}
        self.events, self.order = [], itertools.count()
        self.outbox, self.told, self.up = [], 0, True
        self.at = {}                    # group → place
        self.failures = list(plan.failures)
        self.kills, self.dice, self.kill_server, self.start_server = [], random.Random(1), None, None
        self.over = threading.Event()

    def run(self, nine_us, until_minute=None):
        """From the clock's time to a minute after 09:00, or to the end of the plan. `nine_us`: when it is 09:00."""
        self.nine_us = nine_us
        self.schedule()
        for robot in self.robots.values():
            self.begin(robot)
            self.flush()
        joins = threading.Thread(target=self.keep_joining, daemon=True)
        joins.start()
        try:
            self.wait_for_robots()
            end_us = self.time_of(self.plan.end_minute if until_minute is None else until_minute)
            while self.clock.now_us < end_us:
                due = self.settle()
                times = [t for t in (due, self.events[0][0] if self.events else None, self.next_kill(), end_us) if t is not None]
                self.clock.go_to(max(self.clock.now_us, min(times)))
                self.idleness.wait_for_time(self.clock)
                self.act()
            self.settle()
        finally:
            self.over.set()
            joins.join()
            for robot in self.robots.values():
                robot.stop()

    def time_of(self, minute):
        return self.nine_us + minutes_to_us(minute)

    def at_time(self, time_us, act):
        heapq.heappush(self.events, (time_us, next(self.order), act))

    def act(self):
        while self.events and self.events[0][0] <= self.clock.now_us:
            heapq.heappop(self.events)[2]()
        if self.kills and self.next_kill() <= self.clock.now_us:
            self.kill()

    def settle(self):
        began = time.monotonic()
        due = self.idleness.wait(self.clock, self.open_commands, self.work)
        if time.monotonic() - began > SLOW_S:
            self.show(self.clock.now_us, f"the server took {time.monotonic() - began:.1f} s of real time")
        return due

    def open_commands(self):
        active = sum(len(r.active()) for r in self.robots.values())
        return active, active + sum(len(r.forgotten) for r in self.robots.values())

    def work(self):
        """What came in for robots, and what is to be told; whether there was something."""
        busy = bool(self.outbox)
        for robot in self.robots.values():
            while robot.unread():
                busy = True
                came = robot.came.get()
                self.stop_command(robot, came) if isinstance(came, str) else self.begin_command(robot, came)
        self.flush()
        return busy

    def stop_at(self, time_us, go_on):
        """The clock stops there until `go_on()`. The server may be another one then."""
        self.at_time(time_us, lambda: self.stop_clock(go_on))

    def stop_clock(self, go_on):
        self.settle()
        self.show(self.clock.now_us, "the clock stands still")
        while not go_on():
            self.work()
        self.wait_for_robots()
