// What runs now, and what has ended a moment ago, for the front desk: state, where it stands, who does it, and an end to it.
import { CircleCheck } from "lucide-react";
import { useMemo } from "react";
import { nameOf } from "../api/labels";
import { useNames } from "../api/prefixes";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import { words } from "../cawl/names";
import type { Run } from "../gen/docent/v1/workflows_pb";
import { RunActions, SettleButtons } from "../operate/run_actions";
import { useRuns, useTicks } from "../operate/runs";
import { useFleet, useOfflineRobots } from "../facts/fleet";
import { LostTag } from "../operate/offline";
import { lostOf, stateOf, whereWords } from "../operate/runs_within";
import { clock, duration, isLive, nowUs, StateTag } from "../ui/states";
import { useWaits } from "../operate/use_waits";
import { groupWaits, waitsWords } from "../operate/waits";

const shownUs = 5n * 60_000_000n; // how long what has ended stands here
const shownAtOnce = 40;

export function RunningNow() {
  const runs = useRuns();
  const offline = useOfflineRobots();
  const names = useNames();
  const robots = useFleet();
  const { waits } = useWaits(runs.data?.runs ?? []);
  const groups = useMemo(
    () => groupWaits(runs.data?.runs ?? [], waits, names, clock, robots),
    [runs.data, waits, names, robots],
  );
  const why = (run: Run) =>
    groups
      .filter((g) => g.kind !== "lost")
      .flatMap((g) => (g.waiting.some((w) => w.root.id === run.id) ? [waitsWords(g, names.prefixes)] : []))
      .filter(Boolean)
      .join("; ");
  useTicks(1000);
  const all = runs.data?.runs ?? [];
  const roots = all.filter((r) => !r.parent);
  const live = roots.filter((r) => isLive(r.state));
  const ended = roots.filter((r) => !isLive(r.state) && r.endedUs > nowUs() - shownUs);
  const list = (some: readonly Run[]) => (
    <ul>
      {some.slice(0, shownAtOnce).map((run) => (
        <li key={run.id} className={isLive(run.state) ? "" : "ended"}>
          <span className="desk-state">
            <StateTag state={stateOf(run, all)} />
          </span>
          <span className="desk-run">
            <span>
              <Link href={paths.run(run.id)} className="run-id">
                {words(run.workflow.replace(/^service /, ""))}
              </Link>{" "}
              <span className="faint small">{valuesOf(run)}</span>
            </span>
            <span className="quiet small">
              {[whereWords(run, all), isLive(run.state) && why(run)].filter(Boolean).join(" · ")}
            </span>
            <LostTag lost={lostOf(run, offline)} />
            {run.nodes
              .filter((n) => n.state === "incident")
              .map((n) => (
                <SettleButtons key={n.name} run={run.id} node={n} again={runs.again} />
              ))}
          </span>
          <span className="faint small cut desk-robot">{robotsOf(run, all)}</span>
          <span className="faint small number desk-time">
            {duration(run.startedUs, run.endedUs || nowUs())}
          </span>
          <span className="desk-actions">
            <RunActions run={run} runs={all} again={runs.again} />
          </span>
        </li>
      ))}
    </ul>
  );
  return (
    <section className="desk-runs" aria-label="Runs">
      <h2>Running now{live.length > 0 && <span className="faint number"> {live.length}</span>}</h2>
      {runs.data && live.length === 0 && (
        <p className="quiet desk-quiet">
          <CircleCheck size={16} />
          Nothing runs.
        </p>
      )}
      {runs.error && !runs.data && (
        <p className="notice wait">
          {runs.error.title}. {runs.error.detail}
        </p>
      )}
      {list(live)}
      {live.length > shownAtOnce && (
        <p>
          <Link href={paths.runs("live")}>All {live.length}</Link>
        </p>
      )}
      {ended.length > 0 && (
        <>
          <h2>Just finished</h2>
          {list(ended)}
        </>
      )}
    </section>
  );
}

// Of the run and of those within it.
function robotsOf(run: Run, runs: readonly Run[]): string {
  const family = [run, ...runs.filter((r) => r.parent === run.id)];
  return [
    ...new Set(
      family.flatMap((r) => r.nodes.flatMap((n) => n.invocations.map((i) => i.robot))).filter(Boolean),
    ),
  ]
    .map(nameOf)
    .join(", ");
}
// "user John, booth B05": what the run is for, without the robot.
function valuesOf(run: Run): string {
  return run.variables
    .filter((v) => v.name !== "robot" && v.value?.kind.case === "iri")
    .slice(0, 3)
    .map((v) =>
      v.value?.kind.case === "iri" ? `${words(v.name).toLowerCase()} ${nameOf(v.value.kind.value)}` : "",
    )
    .join(", ");
}
