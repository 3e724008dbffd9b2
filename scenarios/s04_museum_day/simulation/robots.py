"""The museum's robots: adapters that speak gRPC, whose commands take simulated time.

An adapter keeps the ids of its commands, gives a repeated one the state of the first, and after a failure (another incarnation)
says of what it had begun that nobody knows how it ended.
"""
import dataclasses
import math
import queue
import threading
from concurrent import futures

import grpc

MUSEUM = "https://w3id.org/docent/museum#"
MINUTE_US = 60_000_000
SPEED = {"alone": 0.8, "normal": 0.5, "slow": 0.25}  # m/s
DRAIN = {"busy": 0.35, "idle": 0.05, "dock": -1.5}   # percent a minute
FULL, DOCK_PLACE = 90, "Docks"

# name → input parts with types, idempotent
GUIDING = {"driveTo": ([("place", "")], True), "speak": ([("language", "")], True),
           "lead": ([("group", MUSEUM + "Group"), ("exhibit", MUSEUM + "Exhibit"), ("pace", "")], False),
           "present": ([("exhibit", MUSEUM + "Exhibit"), ("language", "")], True), "greet": ([("group", MUSEUM + "Group")], True)}
CARRYING = {"pickUp": ([("group", MUSEUM + "Group")], False), "bringToCloakroom": ([("group", MUSEUM + "Group")], False)}
EVERYBODY = {"fetchBox": ([], True), "bringBox": ([("place", "")], True), "dock": ([], True)}


@dataclasses.dataclass
class Command:
    id: str
    operation: str
    arguments: dict
    begun_us: int = 0
    ends_us: int = 0
    final: object = None                              # Feedback
    followers: list = dataclasses.field(default_factory=list)


class Robot:
    """One adapter. gRPC's threads only hand over what comes in; all else happens in the thread of the day."""

    def __init__(self, protos, name, kind, place, charge):
        self.protos, self.name, self.iri, self.kind = protos, name, MUSEUM + name, kind
        self.place, self.charge, self.docked = place, float(charge), True
        self.operations = {**(CARRYING if kind == "Porter" else GUIDING), **EVERYBODY}
        self.life, self.commands, self.forgotten = 0, {}, set()
        self.came, self.lock, self.presence, self.server, self.out_of_service = queue.Queue(), threading.Lock(), threading.RLock(), None, False
        self.done, self.busy_us, self.used_us, self.faults = [], 0, 0, []
        self.told_charge, self.told_us = self.charge, 0

    # ---- its gRPC side -----------------------------------------------------------------------------------------------

    @property
    def incarnation(self):
        return f"{self.name}-life-{self.life}"

    @property
    def alive(self):
        return self.server is not None

    def start(self):
        server = grpc.server(futures.ThreadPoolExecutor(max_workers=12), options=[("grpc.so_reuseport", 0)])
        self.protos.adapter_grpc.add_RobotAdapterServicer_to_server(self.servicer(), server)
        port = server.add_insecure_port("127.0.0.1:0")
        with self.presence:
            self.life += 1
            server.start()
            self.port, self.server = port, server

    def die(self):
        """As a power cut: what it did is unknown."""
        self.forgotten |= {c.id for c in self.active()}
        self.stop()
        self.commands = {}

    def stop(self):
        with self.presence:
            if self.server is not None:
                self.server.stop(None).wait()
            self.server = None

    def description(self):
        described = self.protos.adapter.RobotDescription(robot=self.iri, label=self.name, incarnation=self.incarnation,
                                                         type=MUSEUM + self.kind)
        for name, (parts, idempotent) in self.operations.items():
            operation = described.operations.add(name=name, idempotent=idempotent)
            for part, kind in parts:
                operation.inputs.append(part)
                operation.input_parts.add(name=part, type=kind)
        return described

    def servicer(robot):
        adapter = robot.protos.adapter

        class Servicer(robot.protos.adapter_grpc.RobotAdapterServicer):
            def Describe(self, request, context):
                return robot.description()

            def Invoke(self, request, context):
                with robot.lock:
                    command = robot.commands.get(request.command_id)
                    if command is None and request.expected_incarnation not in ("", robot.incarnation):
                        context.abort(grpc.StatusCode.FAILED_PRECONDITION, f"this is {robot.incarnation}")
                    if command is None:
                        arguments = {a.name: a.value.iri or a.value.literal.lexical for a in request.arguments}
                        command = Command(request.command_id, request.operation, arguments)
                        robot.commands[command.id] = command
                        robot.came.put(command)
                    follower = robot.follow(command)
                return robot.feedback(follower, context)

            def Attach(self, request, context):
                with robot.lock:
                    command = robot.commands.get(request.command_id)
                    if command is None and request.command_id in robot.forgotten:
                        context.abort(grpc.StatusCode.FAILED_PRECONDITION, "the robot failed while it did this")
                    if command is None:
                        context.abort(grpc.StatusCode.NOT_FOUND, "never begun")
                    follower = robot.follow(command)
                return robot.feedback(follower, context)

            def Cancel(self, request, context):
                known = request.command_id in robot.commands
                if known:
                    robot.came.put(request.command_id)
                return adapter.CancelReply(known=known)

        return Servicer()

    def follow(self, command):
        follower = queue.Queue()
        adapter = self.protos.adapter
        follower.put(adapter.Feedback(command_id=command.id, state=adapter.Feedback.ACCEPTED, incarnation=self.incarnation))
        if command.final is not None:
            follower.put(command.final)
        command.followers.append(follower)
        return follower

    def feedback(self, follower, context):
        final = self.protos.adapter.Feedback.SUCCEEDED
        while context.is_active():
            try:
                said = follower.get(timeout=0.2)
            except queue.Empty:
                continue
            yield said
            if said.state >= final:
                return

    # ---- its work, in simulated time -----------------------------------------------------------------------------------

    def active(self):
        return [c for c in self.commands.values() if c.final is None and c.ends_us]

    def unread(self):
        return not self.came.empty()

    def end(self, command, state, message=""):
        adapter = self.protos.adapter
        with self.lock:
            command.final = adapter.Feedback(command_id=command.id, state=getattr(adapter.Feedback, state), progress=1,
                                             message=message, incarnation=self.incarnation)
            for follower in command.followers:
                follower.put(command.final)

    def use(self, now_us):
        """The battery, since the last time."""
        minutes = (now_us - self.used_us) / MINUTE_US if self.used_us else 0
        how = "busy" if self.active() else "dock" if self.docked else "idle"
        self.charge = min(100.0, max(1.0, self.charge - DRAIN[how] * minutes))
        if self.active():
            self.busy_us += now_us - self.used_us
        self.used_us = now_us


def minutes_to_us(minutes):
    return int(round(minutes * MINUTE_US))


def way_us(places, start, end, speed):
    (x0, y0), (x1, y1) = places[start], places[end]
    return int((5 + 1.3 * math.hypot(x1 - x0, y1 - y0) / SPEED[speed]) * 1_000_000)
