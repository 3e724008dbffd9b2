# python3 rdflib_peer.py JOB.json: rdflib as a measured system of `docent-bench kb`. What it prints: bench/kb_docent_main.cc.
import json, signal, sys, time
import rdflib

CASE_LIMIT_S = 4  # a case that takes longer has no figure


class TooLong(Exception):
    pass


def give_up(*_):
    raise TooLong()


def resident():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * 4096


def say(**line):
    print(json.dumps(line), flush=True)


job = json.load(open(sys.argv[1]))
before, start = resident(), time.perf_counter()
graph = rdflib.Graph()
graph.parse(job["data"], format="nt")
say(load_s=time.perf_counter() - start, bytes=resident() - before)


def run(text, form):
    result = graph.query(text)
    if form == "ask":
        return int(result.askAnswer)
    rows = [[str(term) for term in row] for row in result]
    return int(rows[0][0]) if form == "count" else len(rows)


signal.signal(signal.SIGALRM, give_up)
for request in sys.stdin:
    number = int(request.split()[0])
    case = job["cases"][number]
    answers, passes = [], []
    budget = job["budget_ms"] / 1000
    signal.alarm(CASE_LIMIT_S)
    try:
        run(case["text"].replace("@P@", case["parameters"][0]), case["form"])
        begun = time.perf_counter()
        for attempt in range(job["passes"]):
            if attempt and time.perf_counter() - begun > budget:
                break
            us = []
            for parameter in case["parameters"]:
                if us and time.perf_counter() - begun > budget:
                    break
                text = case["text"].replace("@P@", parameter)
                start = time.perf_counter()
                answer = run(text, case["form"])
                us.append((time.perf_counter() - start) * 1e6)
                if attempt == 0:
                    answers.append(answer)
            if attempt == 0 or len(us) == len(passes[0]):
                passes.append(us)
        signal.alarm(0)
        say(case=number, mode="cold", answers=answers, us=passes)
    except TooLong:
        say(case=number, mode="cold", reason=f"longer than {CASE_LIMIT_S} s")
    except Exception as error:
        signal.alarm(0)
        say(case=number, mode="cold", reason=str(error))
