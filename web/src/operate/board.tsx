// Everything that is waited for: all live runs, grouped by what is missing, the oldest first, with what can be done about it.
import {
  Bot,
  CircleAlert,
  CircleCheck,
  CirclePause,
  Clock3,
  FlaskConical,
  Hourglass,
  LoaderCircle,
  Unplug,
  type LucideIcon,
} from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { context } from "../api/client";
import { sentence } from "../api/errors";
import { usePast } from "../api/past";
import { useNames, type Names } from "../api/prefixes";
import { nameOf } from "../api/labels";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import type { Quad } from "../gen/docent/v1/term_pb";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import type { Run } from "../gen/docent/v1/workflows_pb";
import { toast } from "../ui/toasts";
import { factWords } from "../facts/fact_words";
import { AnotherRobot, CauseActions } from "./cause_actions";
import { useFleet } from "../facts/fleet";
import { tellable } from "../facts/tellable";
import { RunActions, SettleButtons } from "./run_actions";
import { useRuns, useTicks } from "./runs";
import { clock, duration, nowUs, runWords } from "../ui/states";
import { TellDialog } from "../facts/tell";
import { type Group, groupWaits, type WaitKind } from "./waits";
import { useWaits } from "./use_waits";
import { othersOf, othersWords, useWhyNot, waysOf } from "./why";
import "./board.css";

const noRuns: Run[] = [];
const shownAtOnce = 12;
const groupsCounted = 20; // whose other ways are asked for
const othersMs = 10_000;
const looks: Record<WaitKind, { words: string; icon: LucideIcon }> = {
  operator: { words: "Somebody has to decide", icon: CircleAlert },
  lost: { words: "A robot is offline in the middle of it", icon: Unplug },
  fact: { words: "A fact is missing", icon: Hourglass },
  robot: { words: "A robot is needed", icon: Bot },
  time: { words: "A time has to come", icon: Clock3 },
  resume: { words: "Paused", icon: CirclePause },
};

export default function Board() {
  const runs = useRuns();
  const names = useNames();
  useTicks(1000);
  useEffect(() => void (document.title = "Waiting – Docent"), []);
  const all = runs.data?.runs ?? noRuns;
  const { waits, again, left } = useWaits(all);
  const robots = useFleet();
  const groups = useMemo(() => groupWaits(all, waits, names, clock, robots), [all, waits, names, robots]);
  const [telling, setTelling] = useState<{ group: Group; quads: Quad[] } | null>(null);
  const refresh = () => (runs.again(), again());
  const count = new Set(groups.flatMap((g) => g.waiting.map((w) => w.root.id))).size;
  return (
    <main className="page view-page">
      <header className="head">
        <h1>Waiting</h1>
        <span className="faint small">{groups.length > 0 ? waitWords(count, groups.length) : ""}</span>
      </header>
      <div className="view" tabIndex={0} aria-label="What is waited for">
        {runs.error && !runs.data && (
          <div className="nothing">
            <Unplug size={28} />
            <h2>{runs.error.title}</h2>
            <p>{runs.error.detail}</p>
          </div>
        )}
        {runs.data && groups.length === 0 && (
          <div className="nothing">
            <CircleCheck size={28} />
            <h2>Nothing waits</h2>
            <p>
              As soon as a run waits for a fact, a robot or a person, you see it here: what is missing, for
              how long, and what you can do.
            </p>
          </div>
        )}
        <div className="board">
          {groups.map((group, i) => (
            <GroupCard
              key={group.key}
              group={group}
              counted={i < groupsCounted}
              runs={all}
              robots={robots}
              names={names}
              again={refresh}
              onTell={(quads) => setTelling({ group, quads })}
            />
          ))}
          {left > 0 && <p className="faint small">{left} younger runs are not asked about.</p>}
        </div>
      </div>
      {telling && (
        <TellDialog
          title="What is missing"
          quads={telling.quads}
          patterns={telling.group.kind === "fact" ? telling.group.title : []}
          names={names}
          onTold={refresh}
          onClose={() => setTelling(null)}
        />
      )}
    </main>
  );
}

function GroupCard({
  group,
  counted,
  runs,
  robots,
  names,
  again,
  onTell,
}: {
  group: Group;
  counted: boolean;
  runs: readonly Run[];
  robots: readonly RobotStatus[];
  names: Names;
  again: () => void;
  onTell: (quads: Quad[]) => void;
}) {
  const { words, icon: Icon } = looks[group.kind];
  const [busy, setBusy] = useState(false);
  const [all, setAll] = useState(false);
  const past = usePast() !== null; // can't be changed
  const missing = useWhyNot(past || !counted ? "" : group.ask, othersMs);
  const sets = missing.data && !missing.data.holds ? missing.data.sets : [];
  const others =
    missing.data && sets.length > 0 && waysOf(sets, group.ask, names, robots).length > 1
      ? othersOf(missing.data, 1)
      : 0;
  const tell = async () => {
    setBusy(true);
    try {
      const reply = await context.explain({
        question: { case: "whyNot", value: group.ask },
        sets: 1,
        prefixes: Object.fromEntries(names.prefixes),
        timeoutMs: 5000,
      });
      const quads = reply.sets[0] ? tellable(reply.sets[0], robots) : [];
      if (quads.length > 0) onTell(quads);
      else
        toast(
          reply.holds ? "good" : "bad",
          reply.holds ? "It holds now" : "Nothing that people can tell would make it hold",
          reply.holds ? "The step opens with the next turn." : reply.text,
        );
    } catch (error) {
      toast("bad", "It could not be asked what is missing", sentence(error));
    }
    setBusy(false);
  };
  const shown = all ? group.waiting : group.waiting.slice(0, shownAtOnce);
  return (
    <section
      className="card board-group"
      aria-label={`${words}: ${[group.noRobot, ...group.title.map((t) => (group.kind === "fact" ? factWords(t, names.prefixes) : t))].filter(Boolean).join(", ")}`}
    >
      <header>
        <span className={`board-icon ${group.kind}`}>
          <Icon size={16} />
        </span>
        <div className="grow">
          <p className="board-kind faint small">{words}</p>
          <div className="board-title" title={group.detail || undefined}>
            {group.noRobot && <span className="board-fact">{group.noRobot}</span>}
            {group.title.map((t, i) =>
              group.kind === "fact" ? (
                <span key={i} className="board-fact" title={t}>
                  {factWords(t, names.prefixes)}
                </span>
              ) : (
                <span key={i}>
                  {i > 0 && " or "}
                  {t}
                </span>
              ),
            )}
            {others > 0 && <span className="quiet small"> {othersWords(others)}</span>}
            {group.heldBy && (
              <span className="quiet">
                , which <Link href={paths.run(group.heldBy)}>{runWords(group.heldBy)}</Link> has
              </span>
            )}
          </div>
        </div>
        <span className="board-count number" title="Steps that wait for it">
          {group.waiting.length}
        </span>
        {group.ask && !past && (
          <button className="button small" disabled={busy} onClick={() => void tell()}>
            {busy ? <LoaderCircle size={13} className="turn" /> : <FlaskConical size={13} />}Simulate or tell
          </button>
        )}
      </header>
      <CauseActions causes={group.robots} robots={robots} names={names} again={again} />
      <ul>
        {shown.map(({ run, node, root, sinceUs }) => (
          <li key={`${run.id} ${node?.name ?? ""}`}>
            <Link href={paths.run(run.id, node?.name ?? "")} className="run-id">
              {runWords(run.id)}
            </Link>
            <span className="faint cut grow">
              {node && `at ${node.name}`}
              {run !== root && ` in ${runWords(root.id)}`}
              {runFor(root)}
            </span>
            {node && <SettleButtons run={run.id} node={node} again={again} />}
            <AnotherRobot
              run={run}
              node={node}
              runs={runs}
              causes={group.robots}
              robots={robots}
              names={names}
              again={again}
            />
            <span className="board-actions">
              <RunActions run={root} runs={runs} again={again} />
            </span>
            <span className="faint small number board-time">{duration(sinceUs, nowUs())}</span>
          </li>
        ))}
        {group.waiting.length > shown.length && (
          <li>
            <button className="button plain small" onClick={() => setAll(true)}>
              Show {group.waiting.length - shown.length} more
            </button>
          </li>
        )}
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
