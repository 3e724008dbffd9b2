// One run: its flow with live states, what it waits for and why, its history and its values.
import { ArrowLeft, ChevronRight, CircleAlert, History, Workflow } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { useAsOf, useKept } from "../api/as_of";
import { workflows } from "../api/client";
import { replaceIris } from "../api/iris";
import { useFollow } from "../api/live";
import { usePoll } from "../api/poll";
import { readTriples, useNames, type Names } from "../api/prefixes";
import { query } from "../api/sparql";
import { termText } from "../api/terms";
import { Link } from "../ui/link";
import { usePast } from "../api/past";
import { navigate, paths } from "../ui/router";
import { type Flow, readCawl } from "../cawl/document";
import { words } from "../cawl/names";
import { loadDraft } from "../flow/drafts";
import { usePalette } from "../flow/palette_data";
import { type Node, type Run, RunSchema } from "../gen/docent/v1/workflows_pb";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { AnotherRobot, CauseActions } from "./cause_actions";
import { FlowView } from "../flow/flow_view";
import { askRun } from "./past_runs";
import { reasonWords } from "./reason_words";
import { RunActions, SettleButtons, StillBusy } from "./run_actions";
import { useRuns, useTicks } from "./runs";
import { awayWords, isAway } from "../facts/no_robot";
import { useFleet, useOfflineRobots } from "../facts/fleet";
import { LostBar } from "./offline";
import { lostOf, progressOf, stateOf, whereWords } from "./runs_within";
import { clock, duration, isLive, nowUs, runWords, StateTag, Time, timeTitle } from "../ui/states";
import { Timeline } from "./timeline";
import { PastWhyNot } from "./past_why";
import { RunTest } from "./run_test";
import { Fact, WhyNot } from "./why";
import "./run_page.css";

export default function RunPage({ id, node }: { id: string; node: string }) {
  const at = usePast();
  const now = useFollow(at === null ? `run ${id}` : "", {
    call: "docent.v1.Workflows/Get",
    request: { run: id },
    reply: RunSchema,
    poll: (signal) => workflows.get({ run: id }, { signal }),
    everyMs: 250,
  });
  const then = useAsOf(`run ${id}`, at, async (asOf, signal) => (await askRun(id, asOf, signal)) ?? null);
  const polled = useKept<Run | null>(`run ${id}`, at === null ? now : then);
  const run = polled.data;
  useTicks(1000);
  useEffect(() => void (document.title = `${runWords(id)} – Docent`), [id]);
  const flow = useFlow(run ?? undefined);
  const names = useNames();
  const palette = usePalette();
  const serviceKey = palette.entries
    .filter((e) => e.kind === "service")
    .map((e) => e.id)
    .join("\n");
  const serviceNames = useMemo(() => new Set(serviceKey.split("\n")), [serviceKey]);
  const [tab, setTab] = useState<"now" | "history" | "values">("now");
  const pick = (name: string) => navigate(paths.run(id, name), true);
  const all = useRuns().data?.runs ?? [];
  const offline = useOfflineRobots();
  const chosen = run?.nodes.find((n) => n.name === node);
  if (!run)
    return (
      <main className="view nothing">
        {run === null && at !== null ? (
          <>
            <History size={28} />
            <h1>{runWords(id)} had not begun yet</h1>
            <p>At {clock(BigInt(at) * 1000n)} there was no such run.</p>
          </>
        ) : polled.error ? (
          <>
            <CircleAlert size={28} />
            <h1>
              {polled.error.kind === "missing" ? `There is no run ${runWords(id)}` : polled.error.title}
            </h1>
            <p>
              {polled.error.kind === "missing"
                ? "It may have ended long ago: only the newest ended runs are kept."
                : polled.error.detail}
            </p>
            <p>
              <Link href={paths.runs()}>Show all runs</Link>
            </p>
          </>
        ) : (
          <p aria-busy="true">Loading…</p>
        )}
      </main>
    );
  return (
    <main className="editor">
      <header className="head run-head">
        <Link href={paths.runs()} className="faint crumb">
          Runs
        </Link>
        <ChevronRight size={13} className="faint crumb" />
        <Link
          href={run.parent ? paths.run(run.parent) : paths.runs()}
          className="button plain icon narrow-only"
          aria-label={run.parent ? `Back to ${runWords(run.parent)}` : "Back to all runs"}
        >
          <ArrowLeft size={16} />
        </Link>
        <h1 className="cut">{runWords(run.id)}</h1>
        <StateTag state={stateOf(run, all)} />
        <span className="faint small cut number run-time">
          <Time us={run.startedUs} /> · {duration(run.startedUs, run.endedUs || nowUs())}
        </span>
        <span className="grow" />
        {run.parent && (
          <Link className="button plain wide-only" href={paths.run(run.parent)}>
            Part of {runWords(run.parent)}
          </Link>
        )}
        <Link
          className="button plain wide-only"
          href={paths.compose(run.workflow, run.flow === run.workflow ? "" : run.flow)}
        >
          <Workflow size={14} />
          {run.workflow}
        </Link>
        {!run.parent && at === null && (
          <span className="wide-only row" style={{ gap: "var(--space-1)" }}>
            <RunTest run={run} />
          </span>
        )}
        <RunActions run={run} runs={all} again={polled.again} keys />
      </header>
      <LostBar lost={lostOf(run, offline)} />
      <StillBusy run={run} runs={all} again={polled.again} />
      {run.reason && (
        <div
          className="stale"
          style={run.state === "failed" ? { background: "var(--bad-soft)", color: "var(--bad)" } : {}}
        >
          <CircleAlert size={14} />
          <Reason text={run.reason} />
        </div>
      )}
      <div className="editor-body run-body">
        {flow ? (
          <FlowView flow={flow} run={run} picked={node} onPick={pick} serviceNames={serviceNames} />
        ) : (
          <div className="run-list">
            {run.nodes.map((n) => (
              <button key={n.name} aria-pressed={node === n.name} onClick={() => pick(n.name)}>
                <StateTag state={n.state} />
                <b>{n.name}</b>
              </button>
            ))}
          </div>
        )}
        <aside className="dock run-dock">
          <div className="segments run-tabs" role="tablist">
            {(
              [
                ["now", chosen ? chosen.name : at === null ? "Now" : "Then"],
                ["history", "History"],
                ["values", "Values"],
              ] as const
            ).map(([key, title]) => (
              <button
                key={key}
                role="tab"
                aria-selected={tab === key}
                className="cut"
                onClick={() => setTab(key)}
              >
                {title}
              </button>
            ))}
          </div>
          <div className="run-details" tabIndex={0} aria-label="Details">
            {tab === "now" &&
              (chosen ? (
                <NodeDetails run={run} runs={all} node={chosen} names={names} again={polled.again} />
              ) : (
                <Now run={run} runs={all} names={names} again={polled.again} />
              ))}
            {tab === "history" && <Timeline run={id} names={names} picked={node} onPick={pick} />}
            {tab === "values" && <Values run={run} names={names} />}
          </div>
        </aside>
      </div>
    </main>
  );
}

// The flow of the version that the run began with: the newest text that was deployed before it and has all of its nodes. Of a
// server that keeps no texts, this browser's draft.
function useFlow(run: Run | undefined): Flow | null {
  const [texts, setTexts] = useState<readonly string[]>([]); // the likeliest first
  const workflow = run?.workflow ?? "";
  const began = run?.startedUs ?? 0n;
  useEffect(() => {
    if (!workflow) return;
    let there = true;
    const draft = () => [loadDraft(workflow)?.text ?? ""];
    workflows.listVersions({ workflow, withTexts: true }).then(
      ({ versions }) => {
        const newest = versions.slice().reverse();
        const before = newest.filter((v) => v.timeUs <= began);
        if (there) setTexts([...before, ...newest.filter((v) => v.timeUs > began)].map((v) => v.text));
      },
      () => there && setTexts(draft()),
    );
    return () => void (there = false);
  }, [workflow, began]);
  const nodes = run?.nodes.map((n) => n.name).join("\n") ?? "";
  return useMemo(() => {
    for (const text of texts) {
      const flow = text ? readCawl(text).flows.find((f) => f.name === run?.flow) : undefined;
      const steps = new Set(flow?.steps.map((s) => s.name));
      if (flow && nodes.split("\n").every((name) => steps.has(name))) return flow;
    }
    return null;
  }, [texts, run?.flow, nodes]);
}

function Now({
  run,
  runs,
  names,
  again,
}: {
  run: Run;
  runs: readonly Run[];
  names: Names;
  again: () => void;
}) {
  const active = run.nodes.filter((n) =>
    ["waiting", "running", "incident", ...(run.state === "failed" ? ["failed"] : [])].includes(n.state),
  );
  const within = runs.filter((r) => r.parent === run.id);
  const parts = within.length > 0 && (
    <section className="run-section">
      <h3>Runs within</h3>
      <ul className="runs-within">
        {within.map((r) => (
          <li key={r.id}>
            <Link href={paths.run(r.id)} className="run-id cut grow">
              {runWords(r.id)}
            </Link>
            <span className="faint small cut">{whereWords(r, runs)}</span>
            <StateTag state={stateOf(r, runs)} />
          </li>
        ))}
      </ul>
    </section>
  );
  if (active.length === 0)
    return (
      <>
        {parts}
        <p className="quiet run-section">
          {isLive(run.state)
            ? "Nothing is under way."
            : `The run is ${run.state}. Choose a step to see why it opened.`}
        </p>
      </>
    );
  return (
    <>
      {parts}
      {active.map((n) => (
        <NodeDetails key={n.name} run={run} runs={runs} node={n} names={names} again={again} titled />
      ))}
    </>
  );
}

function NodeDetails({
  run,
  runs,
  node,
  names,
  again,
  titled,
}: {
  run: Run;
  runs: readonly Run[];
  node: Node;
  names: Names;
  again: () => void;
  titled?: boolean;
}) {
  const because = readTriples(node.firedBecause, names.short);
  const past = usePast() !== null;
  const robots = useFleet();
  const about = (causes: readonly string[]) => (
    <>
      <CauseActions causes={causes} robots={robots} names={names} again={again} />
      <AnotherRobot
        run={run}
        node={node}
        runs={runs}
        causes={causes}
        robots={robots}
        names={names}
        again={again}
      />
    </>
  );
  const away = robots.filter(
    (r) =>
      isAway(r) &&
      node.invocations.some(
        (i) => (i.state === "running" && i.robot === r.robot) || i.awaits.some((a) => a.robot === r.robot),
      ),
  );
  return (
    <section className="run-section">
      <div className="row">
        {titled && (
          <Link
            href={paths.run(run.id, node.name)}
            className="cut"
            style={{ fontWeight: 600, color: "var(--text)" }}
          >
            {node.name}
          </Link>
        )}
        <StateTag state={node.state} />
        <NodeTime run={run.id} node={node} />
      </div>
      {node.reason && node.reason !== run.reason && (
        <p className="notice bad">
          <CircleAlert size={14} />
          <Reason
            text={node.reason}
            robot={node.invocations.find((i) => i.reason === node.reason)?.robot}
            names={names}
          />
        </p>
      )}
      <SettleButtons run={run.id} node={node} again={again} />
      {node.state === "incident" ? (
        about([])
      ) : (
        <CauseActions causes={away.map((r) => r.robot)} robots={robots} names={names} again={again} />
      )}
      {node.invocations.map((i, k) => (
        <div key={k} className="invocation">
          <div className="row">
            <b className="cut grow">{words(i.operation)}</b>
            <StateTag state={i.state} />
          </div>
          {i.state === "running" && <Progress part={progressOf(run, i, runs)} label={i.operation} />}
          <p className="faint small">
            {[
              i.robot && (
                <Link key="r" href={paths.hall(names.short(i.robot) || i.robot)}>
                  {names.name(i.robot)}
                </Link>
              ),
              i.step && ` step ${i.step}`,
            ]}
          </p>
          {i.reason && i.reason !== node.reason && (
            <p className="faint small">
              <Reason text={i.reason} robot={i.robot} names={names} />
            </p>
          )}
          {i.awaits.map((a) => (
            <p key={a.robot} className="small faint">
              {names.name(a.robot)} is{" "}
              {awaitWords(
                a.state,
                robots.find((r) => r.robot === a.robot),
              )}
              {a.heldBy && (
                <>
                  , held by <Link href={paths.run(a.heldBy)}>{runWords(a.heldBy)}</Link>
                </>
              )}
            </p>
          ))}
        </div>
      ))}
      {node.waitsFor && (
        <>
          <h3>Why not yet?</h3>
          {past ? (
            <PastWhyNot run={run.id} node={node.name} names={names} />
          ) : (
            <WhyNot
              ask={node.waitsFor}
              names={names}
              title={`What ${node.name} waits for`}
              run={run.id}
              causeActions={about}
            />
          )}
        </>
      )}
      {because.length > 0 && (
        <>
          <h3>Opened because</h3>
          <ul>
            {because.map((fact, i) => (
              <Fact key={i} words={fact} names={names} heldAt={() => firedAt(run.id, node.name)} />
            ))}
          </ul>
        </>
      )}
    </section>
  );
}

// As the server says it, and more where the robot can't come whatever it does.
function awaitWords(state: string, robot: RobotStatus | undefined): string {
  return robot && isAway(robot) ? awayWords(robot) : state;
}

// Why it failed or stands still, in words; as the server said it in the title.
function Reason({ text, robot, names }: { text: string; robot?: string | undefined; names?: Names }) {
  const { words: said, detail } = reasonWords(
    replaceIris(text, (iri) => names?.name(iri) ?? ""),
    robot && names ? names.name(robot) : "",
  );
  return <span title={detail || undefined}>{said}</span>;
}

// How long it is so; of what has ended, when it ended and how long it took.
function NodeTime({ run, node }: { run: string; node: Node }) {
  const ended = !["waiting", "running", "incident", "compensating"].includes(node.state) && node.sinceUs > 0n;
  const fired = usePoll(
    ended ? `fired ${run} ${node.name} ${node.sinceUs}` : "",
    () => firedAt(run, node.name),
    60_000,
  );
  if (node.sinceUs === 0n) return null;
  const took =
    fired.data && fired.data > 0n && fired.data <= node.sinceUs
      ? `, took ${duration(fired.data, node.sinceUs)}`
      : "";
  return (
    <span className="faint small number" title={timeTitle(node.sinceUs)}>
      {ended ? `at ${clock(node.sinceUs)}${took}` : `for ${duration(node.sinceUs, nowUs())}`}
    </span>
  );
}

// When the step opened last, as the graph has it; 0: not known.
async function firedAt(run: string, node: string): Promise<bigint> {
  const { rows } = await query(
    `PREFIX docent: <https://w3id.org/docent#> SELECT ?t { GRAPH docent:runs { ?n docent:ofRun <urn:docent:run:${run.replace(/[<>"{}|^`\\\s]/g, encodeURIComponent)}> ; docent:nodeName ${JSON.stringify(node)} ; docent:firedAt ?t } } ORDER BY DESC(?t) LIMIT 1`,
  );
  return BigInt(Date.parse(rows[0]?.["t"]?.text ?? "") || 0) * 1000n;
}

function Progress({ part, label }: { part: number; label: string }) {
  return (
    <div className="progress" role="progressbar" aria-valuenow={Math.round(part * 100)} aria-label={label}>
      <span style={{ width: `${Math.max(2, part * 100)}%` }} />
    </div>
  );
}

function Values({ run, names }: { run: Run; names: Names }) {
  const rows = [...run.variables, ...run.results.map((r) => ({ ...r, name: `${r.name} (result)` }))];
  if (rows.length === 0) return <p className="quiet run-section">The run has no values yet.</p>;
  return (
    <table className="values">
      <tbody>
        {rows.map((v) => (
          <tr key={v.name}>
            <td className="mono">${v.name}</td>
            <td className="mono">{termText(v.value, names.short)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
