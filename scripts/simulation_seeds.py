"""Plays seeds of a simulation (tests/kb_server/turn/simulation_dice.h); makes a failing one small.

    simulation_seeds.py PROGRAM SEEDS [FIRST [TEST]]     TEST: RobotSimulationTest, or ReplaysNeverDifferTest

Small: fewer steps (delta debugging), documents and worlds without what is not needed, fewer robots. What is left fails at the
same check. Prints the command that plays it, and exits with 1.
"""
import concurrent.futures
import os
import re
import subprocess
import sys

FILTER = f"--gtest_filter={sys.argv[4] if len(sys.argv) > 4 else 'RobotSimulationTest'}.*"
PARALLEL = 2
BLOCK = 500  # seeds that one process plays
STEPS = 70   # kSteps of the simulations
SECONDS = 7200
FEATURES = (
    "types", "parallel", "timeout", "retry", "failure", "incident", "repair", "output", "delay", "other-robot", "priority",
    "activator", "mode", "tell", "mark", "withdraw", "assign", "notify", "event", "after", "between", "condition", "each",
    "compensate", "holds", "subflow", "service", "repeat", "lie", "reorder", "hang", "deaf", "late", "restart", "steering", "again",
    "remove", "die", "reserve", "down", "snapshot", "documents", "edit", "rules", "robot", "reading", "source", "lifetime", "load",
    "lost")


def play(program, **settings):
    """→ where it fails (a file and line, or how the process ended), empty for well; and what it says."""
    environment = {**os.environ, **{f"DOCENT_SIMULATION_{k}": str(v) for k, v in settings.items() if v != ""}}
    try:
        done = subprocess.run([program, FILTER, "--gtest_brief=1"], env=environment, capture_output=True, text=True,
                              errors="replace", timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "no end", ""
    if done.returncode == 0:
        return "", done.stdout
    place = re.search(r"[\w./]+\.(?:h|cc):\d+(?=: Failure)", done.stdout)
    return place[0] if place else f"ends with {done.returncode}", done.stdout + done.stderr


def ranges(steps):
    """[0, 1, 2, 5] → "0-2,5"."""
    found = []
    for step in sorted(steps):
        if found and found[-1][1] == step - 1:
            found[-1][1] = step
        else:
            found.append([step, step])
    return ",".join(f"{a}-{b}" if a < b else str(a) for a, b in found) or str(STEPS)


def fewer(items, fails):
    """Delta debugging (Zeller and Hildebrandt, "Simplifying and Isolating Failure-Inducing Input", 2002): the complements."""
    parts = 2
    while len(items) >= 1:
        size = max(1, len(items) // parts)
        for start in range(0, len(items), size):
            rest = items[:start] + items[start + size:]
            if fails(rest):
                items, parts = rest, max(2, parts - 1)
                break
        else:
            if size == 1:
                break
            parts = min(len(items), 2 * parts)
    return items


def shrink(program, seed, place):
    """→ the settings of the smallest course that fails at the same place."""
    settings = {"SEED": seed, "STEPS": "", "WITHOUT": "", "ROBOTS": ""}

    def fails(**changes):
        return play(program, **{**settings, **changes})[0] == place

    steps = fewer(list(range(STEPS)), lambda rest: fails(STEPS=ranges(rest)))
    settings["STEPS"] = ranges(steps)
    without = []
    for feature in FEATURES:
        if fails(WITHOUT=",".join([*without, feature])):
            without.append(feature)
    settings["WITHOUT"] = ",".join(without)
    for robots in (1, 2):
        if fails(ROBOTS=robots):
            settings["ROBOTS"] = robots
            break
    settings["STEPS"] = ranges(fewer(steps, lambda rest: fails(STEPS=ranges(rest))))
    return settings


def main():
    program, seeds, first = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0
    blocks = [(at, min(BLOCK, first + seeds - at)) for at in range(first, first + seeds, BLOCK)]
    failed, played = None, 0
    with concurrent.futures.ThreadPoolExecutor(PARALLEL) as pool:
        tries = {pool.submit(play, program, FIRST=at, SEEDS=count): at for at, count in blocks}
        for done in concurrent.futures.as_completed(tries):
            place, said = done.result()
            played += blocks[0][1]
            if played % 1000 == 0:
                print(f"{played} of {seeds} seeds played", file=sys.stderr, flush=True)
            if place:
                seed = re.search(r"DOCENT_SIMULATION_SEED=(\d+)", said)
                failed = (int(seed[1]) if seed else tries[done], place, said)
                pool.shutdown(wait=False, cancel_futures=True)
                break  # cancelled ones are never told as completed
    if failed is None:
        return 0
    seed, place, said = failed
    print(f"{said[-3000:]}\nseed {seed} fails at {place}; making it small", flush=True)
    alone, said = play(program, SEED=seed)
    if not alone:
        print(f"alone it does not fail; DOCENT_SIMULATION_FIRST={seed // BLOCK * BLOCK} plays what came before it, too")
        return 1
    settings = shrink(program, seed, alone)
    print(play(program, **settings)[1][-6000:])
    words = " ".join(f"DOCENT_SIMULATION_{k}={v}" for k, v in settings.items() if v != "")
    print(f"\nThis plays it again:\n  {words} {program} '{FILTER}'")
    return 1


if __name__ == "__main__":
    sys.exit(main())
