// Of a condition that does not hold: the nearest to it that there is, what lacks of that, and what is there instead.
import { context } from "../api/client";
import { replaceIris } from "../api/iris";
import { valueWords } from "../api/labels";
import { query, shorten } from "../api/sparql";
import { quadOf, termText } from "../api/terms";
import type { ExplainReply, MissingSet } from "../gen/docent/v1/context_pb";
import type { Quad } from "../gen/docent/v1/term_pb";

export interface Lack {
  pattern: string; // "expo:R01 docent:status docent:Standby"
  now: string; // what is there instead: "Busy"; empty: nothing, or it does not matter
}
export interface NearestMiss {
  lacks: Lack[];
  tooMuch: string[]; // what must not be
  where: string; // "robot = R01, user = John"
  holds: number; // facts of it that are there
  add: Quad[]; // examples that would make it hold
  others: number; // further ways that are as near
  text: string; // where the server can only say it in words
}

// Null where it holds after all.
export async function nearestMiss(
  ask: string,
  prefixes: ReadonlyMap<string, string>,
  signal: AbortSignal,
): Promise<NearestMiss | null> {
  const reply = await context.explain(
    {
      question: { case: "whyNot", value: ask },
      sets: 4,
      timeoutMs: 2500,
      prefixes: Object.fromEntries(prefixes),
    },
    { signal },
  );
  if (reply.holds) return null;
  const instead = await valuesNow(
    reply.sets.flatMap((set) => set.add),
    prefixes,
    signal,
  ).catch(() => new Map<string, string>());
  return readMiss(reply, instead, prefixes);
}

// Of sets that lack equally much, the one is told of which most is known: "R07 is busy" helps more than a robot that tells nothing.
export function readMiss(
  reply: Pick<ExplainReply, "sets" | "more" | "text">,
  instead: ReadonlyMap<string, string>,
  prefixes: ReadonlyMap<string, string>,
): NearestMiss {
  const known = (one: MissingSet) => one.missing.filter((_, i) => insteadOf(one, i, instead) !== "").length;
  const size = (one: MissingSet) => one.missing.length + one.remove.length;
  const set = reply.sets
    .filter((one) => size(one) === size(reply.sets[0] ?? one))
    .sort((a, b) => known(b) - known(a))[0];
  const short = (iri: string) => shorten(iri, prefixes);
  const pattern = (text: string) => replaceIris(text, short).replace(/\s*\.$/, "");
  if (!set) return { lacks: [], tooMuch: [], where: "", holds: 0, add: [], others: 0, text: reply.text };
  return {
    lacks: set.missing.map((text, i) => ({ pattern: pattern(text), now: insteadOf(set, i, instead) })),
    tooMuch: [
      ...set.remove.map((quad) =>
        [quad.subject, quad.predicate, quad.object].map((term) => termText(term, short)).join(" "),
      ),
      ...set.inTheWay.filter((text) => set.remove.length === 0 && text !== "").map(pattern),
      ...set.conditions.map(pattern),
    ],
    where: set.bindings
      .map(
        (b) =>
          `${b.name} = ${valueWords(b.value?.kind.case === "iri" ? { kind: "iri", text: b.value.kind.value } : b.value?.kind.case === "literal" ? { kind: "literal", text: b.value.kind.value.lexical } : undefined)}`,
      )
      .join(", "),
    holds: set.holds.length,
    add: set.add.map(quadOf),
    others: Math.max(0, reply.sets.length - 1 + Number(reply.more)),
    text: "",
  };
}

const keyOf = (quad: Quad) =>
  quad.subject?.kind.case === "iri" && quad.predicate?.kind.case === "iri"
    ? `${quad.subject.kind.value} ${quad.predicate.kind.value}`
    : "";

// The missing patterns and the examples are in the same order.
function insteadOf(set: MissingSet, index: number, instead: ReadonlyMap<string, string>): string {
  const quad = set.missing.length === set.add.length ? set.add[index] : undefined;
  return quad ? (instead.get(keyOf(quad)) ?? "") : "";
}

const asked = 24;
// What the subjects of the examples have now as values of the same properties, in words.
async function valuesNow(
  add: readonly Quad[],
  prefixes: ReadonlyMap<string, string>,
  signal: AbortSignal,
): Promise<Map<string, string>> {
  const pairs = [
    ...new Set(
      add
        .map(keyOf)
        .filter((key) => /^[^\s<>"{}|^`\\]+ [^\s<>"{}|^`\\]+$/.test(key) && !key.endsWith("#type")),
    ),
  ].slice(0, asked);
  if (pairs.length === 0) return new Map();
  const { rows } = await query(
    `SELECT DISTINCT ?s ?p ?o { VALUES (?s ?p) { ${pairs
      .map(
        (pair) =>
          `(${pair
            .split(" ")
            .map((iri) => `<${iri}>`)
            .join(" ")})`,
      )
      .join(" ")} } ?s ?p ?o FILTER(!isBlank(?o)) } LIMIT 40`,
    signal,
  );
  const found = new Map<string, string[]>();
  for (const row of rows) {
    const key = `${row["s"]?.text} ${row["p"]?.text}`;
    const value =
      row["o"]?.kind === "iri"
        ? shorten(row["o"].text, prefixes) || `<${row["o"].text}>`
        : valueWords(row["o"]);
    found.set(key, [...(found.get(key) ?? []), value]);
  }
  return new Map(
    [...found].map(([key, values]) => [
      key,
      values.length > 3 ? `${values.slice(0, 3).join(", ")} …` : values.join(", "),
    ]),
  );
}
