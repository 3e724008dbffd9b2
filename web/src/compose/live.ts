// Whether conditions hold now, in how many ways, and one match in words; if not, what lacks.
import { live } from "../api/live";
import { usePoll } from "../api/poll";
import { valueWords } from "../api/labels";
import { query } from "../api/sparql";
import { useStable } from "../api/stable";
import { useEffect, useEffectEvent } from "react";
import { type CawlDocument, type Constraint, prefixesOf } from "../cawl/document";
import { type NearestMiss, nearestMiss } from "./nearest_miss";

export interface Live {
  matches: number; // -1: it could not be asked
  witness: string; // "robot = R01, booth = B03"
  found: Readonly<Record<string, string>>; // the same by the names of the variables
  miss: NearestMiss | null; // where nothing matches
  note: string;
}
export const matchesShown = 50;

// Only what the ask needs of the prefixes, so that a document's own never stand in the way.
function prologue(document: CawlDocument, body: string): string {
  return [...prefixesOf(document)]
    .filter(([prefix]) => body.includes(`${prefix}:`))
    .map(([prefix, iri]) => `PREFIX ${prefix}: <${iri.replace(/[<>"{}|^`\\\s]/g, encodeURIComponent)}>\n`)
    .join("");
}

function term(text: string): string {
  const variable = /^[?$]([A-Za-z]\w*)(?:\.(\w+))?$/.exec(text.trim());
  return variable ? `?${variable[1]}${variable[2] ? `_${variable[2]}` : ""}` : text.trim();
}

// The pattern of one row; empty if a word of it lacks.
export function constraintPattern(constraint: Constraint): string {
  const { subject, verb, object } = constraint;
  if (!subject.text.trim() || !verb.text.trim() || !object.text.trim()) return "";
  const compared = /^<[^\s<>=]+>$/.test(object.text.trim())
    ? null
    : /^(<=|>=|!=|<|>|=)\s*(.+)$/.exec(object.text.trim());
  const value = compared ? "?value_" : term(object.text);
  const kind = (type: string, of: string) =>
    type && !type.startsWith("xsd:") && of.startsWith("?") ? ` ${of} a ${type} .` : "";
  return `${term(subject.text)} ${term(verb.text)} ${value} .${kind(subject.type, term(subject.text))}${kind(object.type, value)}${compared ? ` FILTER(${value} ${compared[1]} ${term(compared[2] ?? "")})` : ""}`;
}

export function constraintAsk(document: CawlDocument, constraint: Constraint): string {
  const pattern = constraintPattern(constraint);
  return pattern ? `${prologue(document, pattern)}ASK { ${pattern} }` : "";
}

// An ask in which values of the run ("$robot") are of the kinds that their declarations say: here they are free.
export function ofKinds(
  document: CawlDocument,
  ask: string,
  rows: readonly Constraint[],
  kinds: ReadonlyMap<string, string>,
): string {
  const end = ask.lastIndexOf("}");
  if (end < 0) return ask;
  const names = new Set(
    rows
      .flatMap((row) => [row.subject.text, row.object.text])
      .flatMap((text) => /^\$([A-Za-z]\w*)$/.exec(text.trim())?.[1] ?? []),
  );
  const patterns = [...names].flatMap((name) => (kinds.has(name) ? [`?${name} a ${kinds.get(name)} .`] : []));
  if (patterns.length === 0) return ask;
  const missing = prologue(document, patterns.join(" "))
    .split("\n")
    .filter((line) => line && !ask.includes(line.split(":")[0] + ":"));
  return `${missing.map((line) => `${line}\n`).join("")}${ask.slice(0, end)} ${patterns.join(" ")} }`;
}

function asSelect(ask: string): string {
  const whole = ask.replace(/\bASK\s*(WHERE\s*)?\{/, "SELECT * WHERE {").trimEnd();
  return `${whole.slice(0, -1)} BIND(true AS ?value_holds) } LIMIT ${matchesShown}`; // a row has a value, also where nothing is free
}

export function useLive(
  document: CawlDocument,
  asks: readonly { id: string; ask: string }[],
): ReadonlyMap<string, Live> {
  const key = asks.map((a) => a.ask).join("\n");
  const polled = usePoll(
    key === "" ? "" : `live ${key}`,
    async (signal) => {
      const entries = await Promise.all(
        asks
          .filter((a) => a.ask)
          .map(async ({ id, ask }): Promise<[string, Live]> => [id, await state(document, ask, signal)]),
      );
      return new Map(entries);
    },
    live.state === "open" ? 3000 : 700,
  ); // where /live tells of each turn, only counts and what lacks are asked for in between
  useTurns(asks.map((a) => a.ask).filter(Boolean), polled.again);
  return polled.data ?? new Map();
}

// Tells at once when one of the conditions begins or ceases to hold, where the server has /live.
function useTurns(asks: readonly string[], turned: () => void) {
  const onTurn = useEffectEvent(turned);
  const followed = useStable([...new Set(asks)]);
  useEffect(() => {
    if (live.state === "none") return;
    const stops = followed.map((ask) =>
      live.follow({
        call: "docent.v1.Context/Subscribe",
        request: { query: ask },
        everyMs: undefined,
        onMessage: () => onTurn(),
        onEnd: () => undefined,
      }),
    );
    return () => stops.forEach((stop) => stop());
  }, [followed]);
}

async function state(document: CawlDocument, ask: string, signal: AbortSignal): Promise<Live> {
  try {
    const answer = await query(asSelect(ask), signal);
    const first = answer.rows[0];
    const found = Object.fromEntries(
      first
        ? answer.variables.filter((v) => !v.startsWith("value_")).map((v) => [v, valueWords(first[v])])
        : [],
    );
    const witness = Object.entries(found)
      .map(([name, value]) => `${name} = ${value}`)
      .join(", ");
    const miss =
      answer.rows.length === 0
        ? await nearestMiss(ask, prefixesOf(document), signal).catch(() => null)
        : null;
    return { matches: answer.rows.length, witness, found, miss, note: "" };
  } catch (error) {
    if (signal.aborted) throw error;
    return {
      matches: -1,
      witness: "",
      found: {},
      miss: null,
      note: error instanceof Error ? error.message : String(error),
    };
  }
}
