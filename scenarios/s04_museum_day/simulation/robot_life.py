"""What robots do: how long a command takes, where it leaves them, and what goes wrong. A part of Day."""
import time

from robots import DOCK_PLACE, FULL, MUSEUM, minutes_to_us, way_us
from server_time import text_of

CHARGE_TOLD = minutes_to_us(5)
SECOND_US = 1_000_000


class RobotLife:
    def begin(self, robot):
        robot.used_us = self.clock.now_us
        robot.start()
        self.join(robot)
        self.tell_status(robot, "Standby")
        self.at_time(self.clock.now_us + CHARGE_TOLD, lambda life=robot.life: self.tell_charge(robot, life))

    def tell_status(self, robot, status):
        x, y = self.places[robot.place]
        self.tell(robot.iri, f"museum:{robot.name} docent:status docent:{status} ; docent:x {x} ; docent:y {y} ; docent:battery "
                             f"{robot.charge:.1f} ; museum:isDocked {str(robot.docked).lower()} .")

    def tell_charge(self, robot, life):
        if not robot.alive or robot.life != life:
            return
        robot.use(self.clock.now_us)
        self.tell(robot.iri, f"museum:{robot.name} docent:battery {robot.charge:.1f} .")
        self.at_time(self.clock.now_us + CHARGE_TOLD, lambda: self.tell_charge(robot, life))

    def begin_command(self, robot, command):
        if command.final is not None:
            return
        now = self.clock.now_us
        if robot.active():
            robot.faults.append(f"{command.id} came while {robot.active()[0].id} was under way")
        if robot.out_of_service:
            robot.faults.append(f"{command.id} came though the robot is out of service")
        if robot.docked and robot.told_charge < FULL and now - robot.told_us > SECOND_US:
            robot.faults.append(f"{command.id} came though the robot is charging at {robot.told_charge:.1f} %")
        robot.use(now)
        command.begun_us, command.ends_us = now, now + self.takes_us(robot, command)
        robot.docked = False
        self.show(now, f"{robot.name} begins {command.operation}{self.about(command)}")
        self.tell_status(robot, "Busy")
        at = self.failure_of(command)
        if at is not None:
            self.at_time((command.begun_us + command.ends_us) // 2, lambda: self.fail(robot, at))
        self.at_time(command.ends_us, lambda life=robot.life: self.end_command(robot, command, life))

    def about(self, command):
        return "".join(f" {value.removeprefix(MUSEUM)}" for name, value in command.arguments.items() if name != "pace")

    def takes_us(self, robot, command):
        name, given = command.operation, {k: v.removeprefix(MUSEUM) for k, v in command.arguments.items()}
        way = lambda place, speed="alone": way_us(self.places, robot.place, place, speed)
        if name in ("driveTo", "bringBox"):
            return way(given["place"])
        if name == "lead":
            return way(given["exhibit"], given["pace"])
        if name == "present":  # from four minutes to seven, each exhibit its own
            return way(given["exhibit"]) + minutes_to_us(4 + int(given["exhibit"][1:]) * 0.25)
        if name == "pickUp":
            return way(given["group"]) + minutes_to_us(2)
        if name == "bringToCloakroom":
            return way("Cloakroom") + minutes_to_us(3)
        if name == "fetchBox":
            return way("FirstAidRoom") + minutes_to_us(0.5)
        return way("Docks") if name == "dock" else minutes_to_us(0.5)  # speak, greet

    def place_after(self, robot, command):
        given = {k: v.removeprefix(MUSEUM) for k, v in command.arguments.items()}
        place = {"pickUp": given.get("group"), "bringToCloakroom": "Cloakroom", "fetchBox": "FirstAidRoom", "dock": DOCK_PLACE}.get(
            command.operation, given.get("exhibit", given.get("place", robot.place)))
        return self.at.get(place, place)

    def end_command(self, robot, command, life):
        if robot.life != life or not robot.alive or command.final is not None:
            return
        robot.use(self.clock.now_us)
        robot.place, robot.docked = self.place_after(robot, command), command.operation == "dock"
        robot.end(command, "SUCCEEDED")
        robot.done.append(command)
        self.show(self.clock.now_us, f"{robot.name} has done {command.operation}{self.about(command)}")
        if command.operation == "lead":
            self.move(command.arguments["group"].removeprefix(MUSEUM), command.arguments["exhibit"].removeprefix(MUSEUM))
        self.tell_status(robot, "Standby")

    def stop_command(self, robot, command_id):
        command = robot.commands.get(command_id)
        if command is None or command.final is not None:
            return
        robot.use(self.clock.now_us)
        command.ends_us = self.clock.now_us
        robot.end(command, "CANCELLED", "told to stop")
        self.show(self.clock.now_us, f"{robot.name} is told to stop {command.operation}")
        self.tell_status(robot, "Standby")

    # ---- what goes wrong -------------------------------------------------------------------------------------------------

    def failure_of(self, command):
        group = command.arguments.get("group", "").removeprefix(MUSEUM)
        for failure in self.failures:
            if failure[:2] == (group, command.operation):
                number = sum(1 for r in self.robots.values() for c in r.done if c.operation == command.operation
                             and c.arguments.get("group") == command.arguments["group"]) + 1
                if number == failure[2]:
                    self.failures.remove(failure)
                    return failure
        return None

    def fail(self, robot, failure):
        """The robot dies; where it stays away, the server learns of it when its lease is over, in real time."""
        group, operation, _, minutes = failure
        if not self.up:
            return self.at_time(self.clock.now_us + SECOND_US, lambda: self.fail(robot, failure))
        self.show(self.clock.now_us, f"{robot.name} fails while it does {operation} for {group}")
        robot.use(self.clock.now_us)
        self.outbox = [told for told in self.outbox if told.source != robot.iri]
        robot.die()
        if not minutes:
            return self.repair(robot)
        self.await_real(lambda: f"{MUSEUM}{robot.name}" not in self.online(), f"{robot.name} to be missed")
        self.at_time(self.clock.now_us + minutes_to_us(minutes), lambda: self.repair(robot))

    def repair(self, robot):
        if not self.up:
            return self.at_time(self.clock.now_us + SECOND_US, lambda: self.repair(robot))
        self.show(self.clock.now_us, f"{robot.name} is there again")
        self.begin(robot)
        self.await_real(lambda: self.idleness.look()["docent_commands_open"] <= self.open_commands()[0], "an end of what was unknown")
        robot.forgotten = set()

    def online(self):
        listed = self.call(self.fleet.List, self.protos.fleet.ListRobotsRequest())
        lives = {robot.iri: robot.incarnation for robot in self.robots.values()}
        return {r.robot for r in listed.robots if r.state != "offline" and lives.get(r.robot) == r.incarnation}

    def wait_for_robots(self):
        alive = {robot.iri for robot in self.robots.values() if robot.alive}
        self.await_real(lambda: alive <= self.online(), "all robots to join")

    def await_real(self, happened, what, seconds=60):
        deadline = time.monotonic() + seconds
        while True:
            self.work()
            if happened():
                return
            if time.monotonic() > deadline:
                raise TimeoutError(f"waited {seconds} s for {what} at {text_of(self.clock.now_us)}")
            time.sleep(0.02)

    def service(self, name, out):
        if not self.up:
            return self.at_time(self.clock.now_us + SECOND_US, lambda: self.service(name, out))
        self.show(self.clock.now_us, f"the operator {'takes ' + name + ' out of' if out else 'puts ' + name + ' back into'} service")
        self.settle()
        fleet, robot = self.protos.fleet, self.robots[name]
        if out:
            self.call(self.fleet.TakeOutOfService, fleet.TakeOutOfServiceRequest(robot=robot.iri, reason="its wheels are cleaned"))
        else:
            self.call(self.fleet.PutInService, fleet.PutInServiceRequest(robot=robot.iri))
        robot.out_of_service = out
