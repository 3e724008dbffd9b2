// Everything that is waited for: all live runs, grouped by the fact that lacks, the oldest first.
import { CircleCheck, FlaskConical, Hourglass, Timer, Unplug } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { context } from "../api/client";
import { usePoll } from "../api/poll";
import { useNames } from "../api/prefixes";
import { localName } from "../api/sparql";
import { quadOf } from "../api/terms";
import { Link } from "../app/link";
import { paths } from "../app/router";
import type { ExplainReply } from "../gen/docent/v1/context_pb";
import type { Node, Run } from "../gen/docent/v1/workflows_pb";
import { words } from "../cawl/names";
import { RunActions, SettleButtons } from "./run_actions";
import { useRuns, useTicks } from "./runs";
import { duration, isLive, nowUs } from "./states";
import { TellDialog } from "./tell";
import { shortPattern } from "./why";
import "./board.css";

interface Waiting {
  run: Run;
  node: Node;
}
interface Group {
  key: string;
  kind: "fact" | "robot" | "operator" | "paused";
  title: string[]; // patterns, or words
  waiting: Waiting[];
  oldest: bigint;
  reply: ExplainReply | undefined;
}
const asked = 40; // conditions that are asked about at a time

export default function Board() {
  const runs = useRuns();
  const names = useNames();
  useTicks(1000);
  useEffect(() => void (document.title = "Waiting – Docent"), []);
  const waiting = (runs.data?.runs ?? []).filter((r) => isLive(r.state)).flatMap((run) => run.nodes.filter((n) => ["waiting", "running", "incident"].includes(n.state)).map((node): Waiting => ({ run, node })));
  const asks = [...new Set(waiting.map((w) => w.node.waitsFor).filter(Boolean))].slice(0, asked);
  const whyNot = usePoll(asks.length > 0 ? `board ${asks.join("|")}` : "", async (signal) =>
    new Map(await Promise.all(asks.map(async (ask): Promise<[string, ExplainReply]> => [ask, await context.explain({ question: { case: "whyNot", value: ask }, sets: 1, timeoutMs: 4000 }, { signal })]))), 2000);
  const [last, setLast] = useState<ReadonlyMap<string, ExplainReply>>(new Map());
  useEffect(() => void (whyNot.data && setLast(whyNot.data)), [whyNot.data]);
  const groups = useMemo(() => group(waiting, last, (p) => shortPattern(p, names)), [waiting, last, names]);
  const [telling, setTelling] = useState<Group | null>(null);
  const set = telling?.reply?.sets[0];
  return (
    <main className="page view-page">
      <header className="head"><h1>Waiting</h1><span className="faint small">{groups.length > 0 ? waitWords(new Set(waiting.map((w) => w.run.id)).size, groups.length) : ""}</span></header>
      <div className="view" tabIndex={0} aria-label="What is waited for">
        {runs.error && !runs.data && <div className="nothing"><Unplug size={28} /><h2>{runs.error.title}</h2><p>{runs.error.detail}</p></div>}
        {runs.data && groups.length === 0 && <div className="nothing"><CircleCheck size={28} /><h2>Nothing waits</h2><p>As soon as a run waits for a fact, a robot or a person, it stands here: what lacks, for how long, and what you can do.</p></div>}
        <div className="board">
          {groups.map((g) => (
            <section key={g.key} className="card board-group">
              <header>
                <span className={`board-icon ${g.kind}`}>{g.kind === "robot" ? <Timer size={16} /> : <Hourglass size={16} />}</span>
                <div className="grow">
                  <p className="board-kind faint small">{g.kind === "fact" ? "A fact lacks" : g.kind === "robot" ? "A robot lacks" : g.kind === "paused" ? "Paused" : "Somebody has to decide"}</p>
                  <div className="board-title">{g.title.map((t, i) => (g.kind === "fact" ? <code key={i}>{t}</code> : <span key={i}>{t}</span>))}</div>
                </div>
                <span className="board-count number" title="Runs that wait for it">{g.waiting.length}</span>
                {g.reply && g.reply.sets[0]?.add.length ? <button className="button small" onClick={() => setTelling(g)}><FlaskConical size={13} />Simulate or tell</button> : null}
              </header>
              <ul>
                {g.waiting.slice(0, 12).map(({ run, node }) => (
                  <li key={`${run.id} ${node.name}`}>
                    <Link href={paths.run(run.id, node.name)} className="run-id">{run.id}</Link>
                    <span className="faint cut grow">at {node.name}{runFor(run)}</span>
                    <SettleButtons run={run.id} node={node} again={runs.again} />
                    <span className="board-actions"><RunActions run={run} again={runs.again} /></span>
                    <span className="faint small number board-time">{duration(node.sinceUs || run.startedUs, nowUs())}</span>
                  </li>
                ))}
                {g.waiting.length > 12 && <li className="faint small">and {g.waiting.length - 12} more</li>}
              </ul>
            </section>
          ))}
        </div>
      </div>
      {telling && set && <TellDialog title="What lacks" quads={set.add.map(quadOf)} patterns={telling.title} names={names} onTold={() => (runs.again(), whyNot.again())} onClose={() => setTelling(null)} />}
    </main>
  );
}

function waitWords(runs: number, things: number): string {
  return `${runs === 1 ? "One run waits" : `${runs} runs wait`} for ${things === 1 ? "one thing" : `${things} things`}`;
}

// Whom a run is for, if it says so.
function runFor(run: Run): string {
  const user = run.variables.find((v) => v.name === "user" || v.name === "visitor")?.value?.kind;
  return user?.case === "iri" ? `, for ${localName(user.value)}` : "";
}

function group(waiting: readonly Waiting[], replies: ReadonlyMap<string, ExplainReply>, short: (pattern: string) => string): Group[] {
  const groups = new Map<string, Group>();
  const put = (kind: Group["kind"], title: string[], one: Waiting, reply?: ExplainReply) => {
    const key = `${kind} ${title.join(" ")}`;
    const since = one.node.sinceUs || one.run.startedUs;
    const found = groups.get(key);
    if (found) {
      found.waiting.push(one);
      if (since < found.oldest) found.oldest = since;
    } else groups.set(key, { key, kind, title, waiting: [one], oldest: since, reply });
  };
  for (const one of waiting) {
    const { node, run } = one;
    const pending = node.invocations.find((i) => i.state === "pending");
    if (run.paused) put("paused", [run.workflow], one);
    else if (node.state === "incident") put("operator", [node.reason || `${node.name} has failed`], one);
    else if (pending) put("robot", [`a free robot that can ${words(pending.operation).toLowerCase()}`], one);
    else if (node.state === "waiting" && node.waitsFor) {
      const reply = replies.get(node.waitsFor);
      const missing = reply?.sets[0]?.missing.map(short) ?? [];
      if (missing.length > 0) put("fact", missing, one, reply);
      else put("fact", [reply?.holds ? "it holds now" : "not known yet"], one, reply);
    } else if (node.state === "waiting") put("fact", ["other steps of the run"], one);
  }
  return [...groups.values()].sort((a, b) => Number(a.oldest - b.oldest));
}
