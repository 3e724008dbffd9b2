// The document that is open, tried on runs of the past: which steps would go otherwise. Robots get nothing, and nothing changes.
// Runs that are kept as tests are tried again after each edit.
import { useEffect, useEffectEvent, useRef, useState } from "react";
import { replays, workflows } from "../api/client";
import { plain, sentence } from "../api/errors";
import { usePoll } from "../api/poll";
import type { ReplayReply } from "../gen/docent/v1/replays_pb";
import type { Run } from "../gen/docent/v1/workflows_pb";
import { toast } from "../ui/toasts";
import type { Findings } from "./findings";
import { dropTest, keepTest, listTests } from "../flow/run_tests";

export interface Trial {
  run: string;
  of: Run | undefined; // undefined: it is kept as a test, and no longer in the list of runs
  kept: boolean;
  reply: ReplayReply | null;
  text: string; // that was tried
  busy: boolean;
  error: string;
}
export interface StepTrial {
  state: string; // into which the step came at last
  differs: boolean;
}
type Result = Pick<Trial, "reply" | "text" | "busy" | "error">;
const notTried: Result = { reply: null, text: "", busy: false, error: "" };
const runsListed = 30;
const testsTried = 20; // after an edit
export const restMs = 900; // after an edit

// The steps of the flow itself, by name.
export function stepTrials(reply: ReplayReply): Map<string, StepTrial> {
  return new Map(
    reply.nodes
      .filter((n) => n.node !== "" && !/[/#]/.test(n.node))
      .map((n) => [
        n.node,
        { state: n.replayed.findLast((s) => s.state !== "")?.state ?? "inactive", differs: !n.same },
      ]),
  );
}
// The step that goes otherwise first; empty: none does.
export function firstDifference(reply: ReplayReply): string {
  return reply.nodes.find((n) => !n.same)?.node ?? "";
}

export function useTrials(workflow: string, text: string, findings: Findings) {
  const runs = usePoll(
    workflow && `trials ${workflow}`,
    (signal) => workflows.listRuns({ workflow, pageSize: runsListed }, { signal }),
    5000,
  );
  const tests = usePoll(workflow && `tests ${workflow}`, (signal) => listTests(workflow, signal), 5000);
  const [results, setResults] = useState<ReadonlyMap<string, Result>>(new Map());
  const [assume, setAssume] = useState(false); // commands that were not sent then count as done
  const set = (run: string, part: Partial<Result>) =>
    setResults((before) => new Map(before).set(run, { ...(before.get(run) ?? notTried), ...part }));
  const latest = useRef({ text, assume });
  latest.current = { text, assume };

  const attempt = async (run: string, signal?: AbortSignal) => {
    const tried = latest.current;
    set(run, { busy: true });
    try {
      const reply = await replays.replay(
        { run, name: `${workflow}.cawl.xml`, cawl: tried.text, assumeDone: tried.assume },
        signal ? { signal } : {},
      );
      set(run, { busy: false, reply, text: tried.text, error: "" });
    } catch (error) {
      if (plain(error).kind === "cancelled") set(run, { busy: false });
      else set(run, { busy: false, reply: null, text: tried.text, error: sentence(error) });
    }
  };
  const attemptAll = useEffectEvent(async (kept: readonly string[], signal: AbortSignal) => {
    for (const run of kept) if (!signal.aborted) await attempt(run, signal);
  });
  const kept = tests.data ?? [];
  const keptKey = kept.slice(0, testsTried).join("\n");
  const good = findings.of === text && !findings.list.some((f) => f.error) && !findings.error;
  useEffect(() => {
    if (!good || keptKey === "") return;
    const abort = new AbortController();
    const timer = window.setTimeout(() => void attemptAll(keptKey.split("\n"), abort.signal), restMs);
    return () => {
      window.clearTimeout(timer);
      abort.abort();
    };
  }, [text, good, keptKey, assume]);

  const roots = (runs.data?.runs ?? []).filter((r) => r.parent === "");
  const ids = [...kept, ...roots.map((r) => r.id).filter((id) => !kept.includes(id))];
  const list = ids.map((run): Trial => ({
    run,
    of: roots.find((r) => r.id === run),
    kept: kept.includes(run),
    ...(results.get(run) ?? notTried),
  }));
  const keep = (run: string, on: boolean) =>
    (on ? keepTest(workflow, run) : dropTest(run)).then(tests.again, (error: unknown) =>
      toast("bad", on ? "The run could not be kept" : "The test could not be dropped", sentence(error)),
    );
  return {
    list,
    attempt,
    keep,
    assume,
    setAssume,
    error: runs.error,
    differing: list.filter((t) => t.kept && t.reply && !t.reply.same && t.text === text).length,
  };
}
export type Trials = ReturnType<typeof useTrials>;
