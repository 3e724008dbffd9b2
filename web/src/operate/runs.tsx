// All runs: which are live, where each stands, and how the others ended.
import { ListChecks, Unplug } from "lucide-react";
import { useEffect, useState } from "react";
import { useAsOf, useKept } from "../api/as_of";
import { workflows } from "../api/client";
import { useFollow } from "../api/live";
import { nameOf } from "../api/labels";
import { useCommands } from "../ui/commands";
import { Link } from "../ui/link";
import { usePast } from "../api/past";
import { navigate, paths } from "../ui/router";
import { ListRunsReplySchema, type Run } from "../gen/docent/v1/workflows_pb";
import { askRuns } from "./past_runs";
import { useOfflineRobots } from "../facts/fleet";
import { LostTag } from "./offline";
import { lostOf, stateOf, whereWords } from "./runs_within";
import { duration, isLive, nowUs, runWords, StateTag, Time } from "../ui/states";
import "./runs.css";

const filters = [
  ["", "All"],
  ["live", "Live"],
  ["waiting", "Waiting"],
  ["incident", "Needs you"],
  ["done", "Done"],
  ["failed", "Failed"],
  ["cancelled", "Cancelled"],
] as const;
const shownAtOnce = 200;

export function useRuns() {
  const at = usePast();
  const now = useFollow(at === null ? "runs" : "", {
    call: "docent.v1.Workflows/ListRuns",
    request: {},
    reply: ListRunsReplySchema,
    poll: (signal) => workflows.listRuns({}, { signal }),
    everyMs: 500,
  });
  const then = useAsOf("runs", at, askRuns);
  return useKept("runs", at === null ? now : then);
}

export default function Runs(props: { state: string; workflow: string }) {
  const polled = useRuns();
  const offline = useOfflineRobots();
  const [count, setCount] = useState(shownAtOnce);
  useTicks(1000);
  useEffect(() => void (document.title = "Runs – Docent"), []);
  const all = polled.data?.runs ?? [];
  const names = [...new Set(all.map((r) => r.workflow))].sort();
  const fits = (run: Run, state: string) =>
    state === "" ? true : state === "live" ? isLive(run.state) : stateOf(run, all) === state;
  const ofWorkflow = all.filter((r) => props.workflow === "" || r.workflow === props.workflow);
  const runs = ofWorkflow.filter((r) => fits(r, props.state));
  useCommands(
    runs.slice(0, 30).map((r) => ({
      title: `Open ${runWords(r.id)}`,
      group: "Runs",
      icon: ListChecks,
      words: r.workflow,
      run: () => navigate(paths.run(r.id)),
    })),
  );
  return (
    <main className="page view-page">
      <header className="head">
        <h1>Runs</h1>
        <div className="segments run-filters" role="group" aria-label="State">
          {filters.map(([state, title]) => {
            const n = ofWorkflow.filter((r) => fits(r, state)).length;
            return (
              <button
                key={state}
                aria-pressed={props.state === state}
                onClick={() => navigate(paths.runs(state, props.workflow), true)}
              >
                {title}
                {n > 0 && <span className="faint number"> {n}</span>}
              </button>
            );
          })}
        </div>
        <span className="grow" />
        <select
          className="field run-workflow"
          aria-label="Workflow"
          value={props.workflow}
          onChange={(e) => navigate(paths.runs(props.state, e.target.value), true)}
        >
          <option value="">All workflows</option>
          {[...new Set([...names, ...(props.workflow ? [props.workflow] : [])])].map((name) => (
            <option key={name}>{name}</option>
          ))}
        </select>
      </header>
      <div className="view" tabIndex={0} aria-label="Runs">
        {polled.error && !polled.data && (
          <div className="nothing">
            <Unplug size={28} />
            <h2>{polled.error.title}</h2>
            <p>{polled.error.detail}</p>
          </div>
        )}
        {polled.data && runs.length === 0 && (
          <div className="nothing">
            <ListChecks size={28} />
            <h2>{all.length === 0 ? "Nothing has run yet" : "No run is like this"}</h2>
            <p>
              {all.length === 0 ? (
                <>
                  A run begins when the situation of a workflow’s start comes true, or when somebody starts it
                  by hand. <Link href={paths.documents()}>Go to the workflows</Link>.
                </>
              ) : (
                <Link href={paths.runs()}>Show all {all.length}</Link>
              )}
            </p>
          </div>
        )}
        {runs.length > 0 && (
          <table className="runs">
            <thead>
              <tr>
                <th>Run</th>
                <th>State</th>
                <th>What it does</th>
                <th>Robot</th>
                <th>Began</th>
                <th className="right">Took</th>
              </tr>
            </thead>
            <tbody>
              {runs.slice(0, count).map((run) => (
                <tr key={run.id} onClick={() => navigate(paths.run(run.id))}>
                  <td>
                    <Link href={paths.run(run.id)} className="run-id">
                      {runWords(run.id)}
                    </Link>
                    {run.parent && <span className="faint small"> in {runWords(run.parent)}</span>}
                  </td>
                  <td>
                    <span className="run-states">
                      <StateTag state={stateOf(run, all)} />
                      <LostTag lost={lostOf(run, offline)} />
                    </span>
                  </td>
                  <td className="run-where">{whereWords(run, all)}</td>
                  <td>
                    {[...new Set(run.nodes.flatMap((n) => n.invocations.map((i) => i.robot)).filter(Boolean))]
                      .map(nameOf)
                      .join(", ")}
                  </td>
                  <td className="number faint">
                    <Time us={run.startedUs} />
                  </td>
                  <td className="number faint right">{duration(run.startedUs, run.endedUs || nowUs())}</td>
                </tr>
              ))}
            </tbody>
          </table>
        )}
        {runs.length > count && (
          <p style={{ padding: "var(--space-8)", textAlign: "center" }}>
            <button className="button" onClick={() => setCount(count + shownAtOnce)}>
              Show {Math.min(shownAtOnce, runs.length - count)} more of {runs.length}
            </button>
          </p>
        )}
      </div>
    </main>
  );
}

export function useTicks(ms: number) {
  const [, tick] = useState(0);
  useEffect(() => {
    const timer = window.setInterval(() => tick((n) => n + 1), ms);
    return () => window.clearInterval(timer);
  }, [ms]);
}
