// SPARQL over the Context service, with answers as plain rows, and the words that the graph uses now.
import { context } from "./client";
import type { Term } from "../gen/docent/v1/term_pb";

export type Value = { kind: "iri" | "blank" | "literal"; text: string; datatype?: string; language?: string };
export type Row = Record<string, Value | undefined>;
export interface Answer {
  variables: string[];
  rows: Row[];
  boolean: boolean;
  revision: bigint;
}

export function valueOf(term: Term | undefined): Value | undefined {
  switch (term?.kind.case) {
    case "iri":
      return { kind: "iri", text: term.kind.value };
    case "blank":
      return { kind: "blank", text: term.kind.value };
    case "literal":
      return {
        kind: "literal",
        text: term.kind.value.lexical,
        datatype: term.kind.value.datatype,
        language: term.kind.value.language,
      };
    default:
      return undefined;
  }
}

// `asOf`: of the graph as it was at this time or revision; empty: as it is now.
export async function query(text: string, signal?: AbortSignal, asOf = ""): Promise<Answer> {
  const answer: Answer = { variables: [], rows: [], boolean: false, revision: 0n };
  for await (const { part } of context.query(
    { query: text, timeoutMs: 8000, asOf },
    signal ? { signal } : {},
  )) {
    if (part.case === "header")
      Object.assign(answer, {
        variables: part.value.variables,
        boolean: part.value.boolean,
        revision: part.value.revision,
      });
    else if (part.case === "row")
      answer.rows.push(
        Object.fromEntries(answer.variables.map((name, i) => [name, valueOf(part.value.values[i])])),
      );
  }
  return answer;
}

// "expo:B03" where a prefix fits, else the end of the IRI or the IRI itself.
export function shorten(iri: string, prefixes: Iterable<readonly [string, string]>): string {
  let best = "";
  let length = 0;
  for (const [prefix, namespace] of prefixes)
    if (
      namespace.length > length &&
      iri.startsWith(namespace) &&
      /^[\p{L}\p{N}_-]+$/u.test(iri.slice(namespace.length))
    ) {
      best = `${prefix}:${iri.slice(namespace.length)}`;
      length = namespace.length;
    }
  return best;
}

export function localName(iri: string): string {
  return /[^#/]+$/.exec(iri)?.[0] ?? iri;
}

// SPARQL 1.1, section 19.7: a string in quotes.
export function sparqlString(text: string): string {
  const escapes: Record<string, string> = {
    "\\": "\\\\",
    '"': '\\"',
    "\n": "\\n",
    "\r": "\\r",
    "\t": "\\t",
    "\b": "\\b",
    "\f": "\\f",
  };
  return `"${text.replace(/[\\"\n\r\t\b\f]/g, (c) => escapes[c] ?? c)}"`;
}
