// Everything that is waited for: all live runs, grouped by what is missing, the oldest first, with what can be done about it.
import { Bot, CircleAlert, CircleCheck, CirclePause, Clock3, FlaskConical, Hourglass, LoaderCircle, Unplug, type LucideIcon } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { context, workflows } from "../api/client";
import { sentence } from "../api/errors";
import { useShown } from "../api/as_of";
import { usePast } from "../api/past";
import { useNames, type Names } from "../api/prefixes";
import { nameOf } from "../api/labels";
import { quadOf } from "../api/terms";
import { patternWords } from "../compose/term_name";
import { Link } from "../app/link";
import { paths } from "../app/router";
import type { Quad } from "../gen/docent/v1/term_pb";
import type { Run, Wait } from "../gen/docent/v1/workflows_pb";
import { toast } from "../ui/toasts";
import { RunActions, SettleButtons } from "./run_actions";
import { useRuns, useTicks } from "./runs";
import { clock, duration, isLive, nowUs, runWords } from "./states";
import { TellDialog } from "./tell";
import { type Group, groupWaits, type WaitKind } from "./waits";
import { othersOf, othersWords, useWhyNot } from "./why";
import "./board.css";

const asked = 60; // runs that are explained at a time, the oldest first
const shownAtOnce = 12;
const groupsCounted = 20; // whose other ways are asked for
const othersMs = 10_000;
const looks: Record<WaitKind, { words: string; icon: LucideIcon }> = {
  operator: { words: "Somebody has to decide", icon: CircleAlert },
  fact: { words: "A fact is missing", icon: Hourglass },
  robot: { words: "A robot is needed", icon: Bot },
  time: { words: "A time has to come", icon: Clock3 },
  resume: { words: "Paused", icon: CirclePause },
};

function useWaits(runs: readonly Run[]) {
  const ids = runs.filter((r) => !r.parent && isLive(r.state)).sort((a, b) => Number(a.startedUs - b.startedUs)).slice(0, asked).map((r) => r.id);
  const polled = useShown(ids.length > 0 ? `waits ${ids.join(" ")}` : "", async (asOf, signal) =>
    new Map(await Promise.all(ids.map(async (run): Promise<[string, readonly Wait[]]> => [run, (await workflows.explain({ run, asOf }, { signal }).catch(() => ({ waits: [] }))).waits]))), 2000);
  const [last, setLast] = useState<ReadonlyMap<string, readonly Wait[]>>(new Map());
  useEffect(() => void (polled.data && setLast(polled.data)), [polled.data]);
  return { waits: last, again: polled.again, left: Math.max(0, runs.filter((r) => !r.parent && isLive(r.state)).length - asked) };
}

export default function Board() {
  const runs = useRuns();
  const names = useNames();
  useTicks(1000);
  useEffect(() => void (document.title = "Waiting – Docent"), []);
  const all = runs.data?.runs ?? [];
  const { waits, again, left } = useWaits(all);
  const groups = useMemo(() => groupWaits(all, waits, names, clock), [all, waits, names]);
  const [telling, setTelling] = useState<{ group: Group; quads: Quad[] } | null>(null);
  const refresh = () => (runs.again(), again());
  const count = new Set(groups.flatMap((g) => g.waiting.map((w) => w.root.id))).size;
  return (
    <main className="page view-page">
      <header className="head"><h1>Waiting</h1><span className="faint small">{groups.length > 0 ? waitWords(count, groups.length) : ""}</span></header>
      <div className="view" tabIndex={0} aria-label="What is waited for">
        {runs.error && !runs.data && <div className="nothing"><Unplug size={28} /><h2>{runs.error.title}</h2><p>{runs.error.detail}</p></div>}
        {runs.data && groups.length === 0 && <div className="nothing"><CircleCheck size={28} /><h2>Nothing waits</h2><p>As soon as a run waits for a fact, a robot or a person, you see it here: what is missing, for how long, and what you can do.</p></div>}
        <div className="board">
          {groups.map((group, i) => <GroupCard key={group.key} group={group} counted={i < groupsCounted} names={names} again={refresh} onTell={(quads) => setTelling({ group, quads })} />)}
          {left > 0 && <p className="faint small">{left} younger runs are not asked about.</p>}
        </div>
      </div>
      {telling && <TellDialog title="What is missing" quads={telling.quads} patterns={telling.group.title} names={names} onTold={refresh} onClose={() => setTelling(null)} />}
    </main>
  );
}

function GroupCard({ group, counted, names, again, onTell }: { group: Group; counted: boolean; names: Names; again: () => void; onTell: (quads: Quad[]) => void }) {
  const { words, icon: Icon } = looks[group.kind];
  const [busy, setBusy] = useState(false);
  const [all, setAll] = useState(false);
  const past = usePast() !== null; // can't be changed
  const missing = useWhyNot(past || !counted ? "" : group.ask, othersMs);
  const others = missing.data && !missing.data.holds && missing.data.sets.length > 0 ? othersOf(missing.data, 1) : 0;
  const tell = async () => {
    setBusy(true);
    try {
      const reply = await context.explain({ question: { case: "whyNot", value: group.ask }, sets: 1, prefixes: Object.fromEntries(names.prefixes), timeoutMs: 5000 });
      const quads = reply.sets[0]?.add.map(quadOf) ?? [];
      if (quads.length > 0) onTell(quads);
      else toast(reply.holds ? "good" : "bad", reply.holds ? "It holds now" : "Nothing that could be told would make it hold", reply.holds ? "The step opens with the next turn." : reply.text);
    } catch (error) {
      toast("bad", "It could not be asked what is missing", sentence(error));
    }
    setBusy(false);
  };
  const shown = all ? group.waiting : group.waiting.slice(0, shownAtOnce);
  return (
    <section className="card board-group" aria-label={`${words}: ${group.title.map((t) => (group.kind === "fact" ? patternWords(t, names.prefixes) : t)).join(", ")}`}>
      <header>
        <span className={`board-icon ${group.kind}`}><Icon size={16} /></span>
        <div className="grow">
          <p className="board-kind faint small">{words}</p>
          <div className="board-title">{group.title.map((t, i) => (group.kind === "fact" ? <span key={i} className="board-fact" title={t}>{patternWords(t, names.prefixes)}</span> : <span key={i}>{i > 0 && " or "}{t}</span>))}{others > 0 && <span className="quiet small"> {othersWords(others)}</span>}{group.heldBy && <span className="quiet">, which <Link href={paths.run(group.heldBy)}>{runWords(group.heldBy)}</Link> has</span>}</div>
        </div>
        <span className="board-count number" title="Steps that wait for it">{group.waiting.length}</span>
        {group.ask && !past && <button className="button small" disabled={busy} onClick={() => void tell()}>{busy ? <LoaderCircle size={13} className="turn" /> : <FlaskConical size={13} />}Simulate or tell</button>}
      </header>
      <ul>
        {shown.map(({ run, node, root, sinceUs }) => (
          <li key={`${run.id} ${node?.name ?? ""}`}>
            <Link href={paths.run(run.id, node?.name ?? "")} className="run-id">{runWords(run.id)}</Link>
            <span className="faint cut grow">{node && `at ${node.name}`}{run !== root && ` in ${runWords(root.id)}`}{runFor(root)}</span>
            {node && <SettleButtons run={run.id} node={node} again={again} />}
            <span className="board-actions"><RunActions run={root} again={again} /></span>
            <span className="faint small number board-time">{duration(sinceUs, nowUs())}</span>
          </li>
        ))}
        {group.waiting.length > shown.length && <li><button className="button plain small" onClick={() => setAll(true)}>Show {group.waiting.length - shown.length} more</button></li>}
      </ul>
    </section>
  );
}

function waitWords(runs: number, things: number): string {
  return `${runs === 1 ? "One run waits" : `${runs} runs wait`} for ${things === 1 ? "one thing" : `${things} things`}`;
}

// The person that a run is for, if it names one.
function runFor(run: Run): string {
  const user = run.variables.find((v) => v.name === "user" || v.name === "visitor")?.value?.kind;
  return user?.case === "iri" ? `, for ${nameOf(user.value)}` : "";
}
