"""The server's simulated clock, and when the server has nothing more to do at a time."""
import datetime
import os
import time
import urllib.error
import urllib.request

STILL = 2            # looks one after the other that have to find the server idle
LOOK_S = 0.002       # between two looks
PATIENCE_S = 120     # of real time, until a server that is not idle is a fault


def text_of(time_us):
    moment = datetime.datetime.fromtimestamp(time_us // 1_000_000, datetime.timezone.utc)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{time_us % 1_000_000:06}Z"


class SimulatedTime:
    """Writes the file that `docent serve --simulated-clock` reads."""

    def __init__(self, path, now_us):
        self.path, self.now_us = path, now_us
        self.go_to(now_us)

    def go_to(self, time_us):
        self.now_us = max(self.now_us, time_us)
        half = f"{self.path}.new"
        with open(half, "w", encoding="ascii") as file:
            file.write(text_of(self.now_us) + "\n")
        os.replace(half, self.path)


class Idleness:
    """What a server's /metrics say of what it still does."""

    def __init__(self, http):
        self.address = f"http://{http}/metrics"

    def look(self):
        with urllib.request.urlopen(self.address, timeout=30) as reply:
            lines = reply.read().decode().splitlines()
        numbers = dict(line.rsplit(" ", 1) for line in lines if line.startswith("docent_") and "{" not in line)
        return {name: float(value) for name, value in numbers.items()}

    def wait_for_time(self, clock):
        """Until the server has the clock's time: what is told from then on happens at that time."""
        deadline = time.monotonic() + PATIENCE_S
        while not self.is_at(clock, self.look()):
            if time.monotonic() > deadline:
                raise TimeoutError(f"the server does not see that it is {text_of(clock.now_us)}")
            time.sleep(LOOK_S)

    @staticmethod
    def is_at(clock, seen):
        return abs(seen["docent_time_seconds"] * 1e6 - clock.now_us) < 1

    def wait(self, clock, commands_open, work):
        """Until nothing is under way at the clock's time. `commands_open`: gives the least and the most commands that robots
        have; `work` is called between looks, and says whether it found something to do. When the next thing is due, or None."""
        deadline = time.monotonic() + PATIENCE_S
        still, before = 0, None
        while True:
            worked = work()
            seen = self.look()
            least, most = commands_open()
            idle = (not worked and self.is_at(clock, seen) and seen["docent_inbox_batches"] == 0
                    and seen["docent_next_due_seconds"] * 1e6 > clock.now_us + 0.5
                    and least <= seen["docent_commands_open"] <= most)
            still = still + 1 if idle and seen["docent_turns_total"] == before else 0
            before = seen["docent_turns_total"]
            if still >= STILL:
                due = seen["docent_next_due_seconds"]
                return None if due == float("inf") else int(due * 1e6) + 1
            if time.monotonic() > deadline:
                raise TimeoutError(f"the server is not idle at {text_of(clock.now_us)}: commands of robots {least} to {most}, "
                                   f"{ {k: seen[k] for k in ('docent_time_seconds', 'docent_next_due_seconds', 'docent_commands_open', 'docent_inbox_batches')} }")
            time.sleep(LOOK_S)
