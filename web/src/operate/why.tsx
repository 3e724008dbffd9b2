// Why a fact holds: its proof down to who told what; and why a condition does not: what is missing.
import { ChevronRight, FlaskConical, HelpCircle, LoaderCircle, Unplug } from "lucide-react";
import { useState } from "react";
import { context } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { replaceIris } from "../api/iris";
import { usePoll } from "../api/poll";
import type { Names } from "../api/prefixes";
import { timeText, usePast } from "../api/past";
import { iriOf, quadText, termOf } from "../api/terms";
import { patternWords } from "../facts/term_name";
import type { ExplainReply, MissingSet, Proof } from "../gen/docent/v1/context_pb";
import { create } from "@bufbuild/protobuf";
import { type Quad, QuadSchema } from "../gen/docent/v1/term_pb";
import { asMeant, factWords } from "../facts/fact_words";
import { type Cause, causeOf, isOfRobot, type Known, noCause } from "../facts/no_robot";
import { useFleet } from "../facts/fleet";
import { tellable } from "../facts/tellable";
import { clock } from "../ui/states";
import { TellDialog } from "../facts/tell";
import { alternativesOf } from "./waits";
import "./why.css";

export function shortPattern(pattern: string, names: Names): string {
  return replaceIris(pattern, names.short).replace(/\s*\.$/, "");
}

// Ways that would do as well as the ones that are shown.
export function othersOf(reply: Pick<ExplainReply, "sets" | "more">, shown: number): number {
  return Math.max(0, reply.sets.length + Number(reply.more) - shown);
}
export function othersWords(others: number): string {
  return others === 1 ? "or in one other way" : `or in one of ${others} other ways`;
}

// A fact that can be asked why. `short`: its subject is known. `heldAt`: when it was so, for one that may no longer be so; 0: not known.
export function Fact({
  words,
  names,
  short,
  heldAt,
}: {
  words: readonly string[];
  names: Names;
  short?: boolean;
  heldAt?: () => Promise<bigint>;
}) {
  const [proof, setProof] = useState<Proof | null>(null);
  const [state, setState] = useState<"closed" | "asking" | "open">("closed");
  const [error, setError] = useState<PlainError | null>(null);
  const [held, setHeld] = useState(0n);
  const at = usePast();
  const [askedAt, setAskedAt] = useState(at);
  const open = state === "open" && askedAt === at; // a proof is of one time
  const ask = async () => {
    if (open) return setState("closed");
    setState("asking");
    setAskedAt(at);
    setError(null);
    try {
      const [s = "", p = "", o = ""] = words;
      const fact = create(QuadSchema, {
        subject: termOf(s, names.prefixes),
        predicate: termOf(p, names.prefixes),
        object: termOf(o, names.prefixes),
      });
      const reply = await context.explain({
        question: { case: "whyFact", value: fact },
        prefixes: Object.fromEntries(names.prefixes),
        timeoutMs: 5000,
        asOf: at === null ? "" : timeText(at),
      });
      setProof(reply.proof ?? null);
      if (!reply.proof && heldAt) setHeld(await heldAt().catch(() => 0n));
    } catch (failure) {
      setError(
        failure instanceof RangeError
          ? { kind: "failed", title: "It can't be asked", detail: failure.message }
          : plain(failure),
      );
    }
    setState("open");
  };
  return (
    <li className="fact">
      <div className="fact-row">
        <span className="fact-words">
          {!short && `${words[0]} `}
          <span className="fact-verb">{words[1] === "rdf:type" ? "is a" : words[1]}</span> {words[2]}
        </span>
        <button className="button plain small" aria-expanded={open} onClick={() => void ask()}>
          {state === "asking" ? <LoaderCircle size={12} className="turn" /> : <HelpCircle size={12} />}Why?
        </button>
      </div>
      {open &&
        (error ? (
          <p className="small faint fact-proof">
            {error.title}. {error.detail}
          </p>
        ) : proof ? (
          <ProofTree proof={proof} names={names} />
        ) : (
          <p className="small faint fact-proof">
            {at === null ? "It is no longer so." : "It was not so then."}
            {at === null && held > 0n && ` It was so at ${clock(held)}.`}
          </p>
        ))}
    </li>
  );
}

const defaultGraph = "https://w3id.org/docent#default";
export function ProofTree({ proof, names }: { proof: Proof; names: Names }) {
  const row = (index: number, depth: number, seen: readonly number[]): React.ReactNode => {
    const step = proof.steps[index];
    if (!step || seen.includes(index) || depth > 8) return null;
    return (
      <li key={`${index} ${depth}`}>
        {depth > 0 && step.fact && <div className="fact-words">{quadText(step.fact, names.short)}</div>}
        <div className="proof-source">
          {step.rule && <span>by {step.rule}</span>}
          {step.told.map((t, i) => (
            <span key={i}>
              {t.graph === defaultGraph
                ? `told without a source${t.by ? `, by ${t.by}` : ""}`
                : `told by ${names.short(t.graph) || t.graph}${t.by ? `, ${t.by}` : ""}`}
              {t.timeUs > 0n ? ` at ${clock(t.timeUs)}` : ""}
            </span>
          ))}
        </div>
        {step.premises.length > 0 && <ul>{step.premises.map((p) => row(p, depth + 1, [...seen, index]))}</ul>}
      </li>
    );
  };
  return <ul className="proof fact-proof">{proof.roots.map((root) => row(root, 0, []))}</ul>;
}

export function useWhyNot(ask: string, everyMs = 2500) {
  return usePoll(
    ask && `whynot ${ask}`,
    (signal) =>
      context.explain({ question: { case: "whyNot", value: ask }, sets: 3, timeoutMs: 4000 }, { signal }),
    everyMs,
  );
}

interface WhyNotProps {
  ask: string;
  names: Names;
  title: string;
  run: string; // that waits; what its own robot is busy with is no cause
  causeActions: (robots: readonly string[]) => React.ReactNode; // what can be done about robots that are the cause
}
// What is missing for each condition of a node, any of which opens it.
export function WhyNot({ ask, ...props }: WhyNotProps) {
  return alternativesOf(ask).map((one, i) => (
    <div key={i}>
      {i > 0 && <p className="faint small">or</p>}
      <WhyNotOne ask={one} {...props} />
    </div>
  ));
}
// Of one condition, with ways to try it and to tell it.
function WhyNotOne({ ask, names, title, run, causeActions }: WhyNotProps) {
  const polled = useWhyNot(ask);
  const [telling, setTelling] = useState<MissingSet | null>(null);
  const robots = useFleet();
  if (polled.error && !polled.data)
    return (
      <p className="notice">
        <Unplug size={14} />
        {polled.error.title}. {polled.error.detail}
      </p>
    );
  if (!polled.data) return <p className="faint small">Looking for what is missing…</p>;
  if (polled.data.holds) return <p className="notice">It holds now; the step opens with the next turn.</p>;
  const ways = waysOf(polled.data.sets, ask, names, robots, run);
  const others =
    ways.length === 1 && polled.data.sets.length > 1 ? 0 : othersOf(polled.data, polled.data.sets.length);
  return (
    <div className="lacks">
      {ways.map(({ set, missing, cause, add }, i) => (
        <section key={i} className="lack">
          {i > 0 && <p className="faint small">or</p>}
          {cause.words && (
            <p className="lack-words">
              <ChevronRight size={12} />
              <span>{cause.words}</span>
            </p>
          )}
          {cause.words && causeActions(cause.robots)}
          {missing.map((m, k) => (
            <p key={k} className="lack-words" title={m}>
              <ChevronRight size={12} />
              <span>{factWords(m, names.prefixes)}</span>
            </p>
          ))}
          {set.conditions.map((c, k) => (
            <p key={`c${k}`} className="lack-words faint">
              <ChevronRight size={12} />
              <code>{shortPattern(c, names)}</code>
            </p>
          ))}
          {set.remove.length > 0 &&
            set.remove.map((q, k) => (
              <p key={`r${k}`} className="lack-words">
                <ChevronRight size={12} />
                must go:{" "}
                <span title={quadText(q, names.short)}>
                  {patternWords(quadText(q, names.short), names.prefixes)}
                </span>
              </p>
            ))}
          {add.length > 0 ? (
            <button className="button small" onClick={() => setTelling(set)}>
              <FlaskConical size={13} />
              Simulate or tell
            </button>
          ) : (
            set.add.length > 0 && <p className="faint small">The robot tells this itself.</p>
          )}
        </section>
      ))}
      {others > 0 && <p className="faint small">{othersWords(others)}</p>}
      {polled.data.sets.length === 0 && (
        <pre className="small faint" style={{ whiteSpace: "pre-wrap" }}>
          {polled.data.text}
        </pre>
      )}
      {telling && (
        <TellDialog
          title={title}
          quads={tellable(telling, robots)}
          patterns={telling.missing.map((m) => asMeant(shortPattern(m, names), ask))}
          names={names}
          onTold={polled.again}
          onClose={() => setTelling(null)}
        />
      )}
    </div>
  );
}

interface Way {
  set: MissingSet;
  missing: string[]; // patterns with prefixes
  cause: Cause;
  add: Quad[]; // what people may tell
}
// The ways to make it hold; those that differ only in a thing of which any would do are one way.
export function waysOf(
  sets: readonly MissingSet[],
  ask: string,
  names: Names,
  robots: readonly Known[],
  run = "",
): Way[] {
  const ways = new Map<string, Way>();
  for (const set of sets) {
    const own = set.add.filter((quad) => isOfRobot(iriOf(quad.subject), iriOf(quad.predicate), robots));
    const cause =
      own.length === 0
        ? noCause
        : causeOf(
            robots.filter((r) => own.some((quad) => iriOf(quad.subject) === r.robot)),
            run,
          );
    const ofRobot = new Set(cause.words ? own.map((quad) => quadText(quad, names.short)) : []);
    const missing = set.missing
      .map((m) => shortPattern(m, names))
      .filter((m) => !ofRobot.has(m))
      .map((m) => asMeant(m, ask));
    const key = JSON.stringify([missing, cause.words, set.remove.length, set.conditions]);
    if (!ways.has(key)) ways.set(key, { set, missing, cause, add: tellable(set, robots) });
  }
  return [...ways.values()];
}
