// What things are called: by their labels in the graph, else by a short end of their IRI. The labels are asked for once for the whole app.
import { useEffect } from "react";
import { usePoll } from "./poll";
import { localName, query, type Value } from "./sparql";
import { isSame } from "./stable";
import { createStore } from "./store";

// A thing's name in a language, else in none, else in English, else any: patterns of a query that groups by the thing, and the
// expression that chooses. A thing may have its name in several languages.
export const namePatterns = (thing: string, language = "en") =>
  [
    `LANGMATCHES(LANG(?name1), "${language.replace(/[^\w-]/g, "")}")`,
    'LANG(?name2) = ""',
    'LANGMATCHES(LANG(?name3), "en")',
    "true",
  ]
    .map((filter, i) => `OPTIONAL { ${thing} schema:name|rdfs:label ?name${i + 1} FILTER(${filter}) }`)
    .join(" ");
export const nameChosen = "COALESCE(SAMPLE(?name1), SAMPLE(?name2), SAMPLE(?name3), SAMPLE(?name4))";

const labelsQuery = `PREFIX docent: <https://w3id.org/docent#> PREFIX schema: <https://schema.org/> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>
SELECT ?t (${nameChosen} AS ?label) { { SELECT DISTINCT ?t { VALUES ?c { docent:Region docent:Robot docent:Person docent:Visitor docent:Service } ?t a ?c FILTER(isIRI(?t)) } } ${namePatterns("?t")} } GROUP BY ?t LIMIT 5000`;
const labels = createStore<ReadonlyMap<string, string>>(new Map());

// To be called once, by the frame of the app.
export function usePollLabels() {
  const polled = usePoll(
    "labels",
    async (signal) =>
      new Map(
        (await query(labelsQuery, signal)).rows.flatMap((row): [string, string][] =>
          row["t"] && row["label"] ? [[row["t"].text, row["label"].text]] : [],
        ),
      ),
    10_000,
  );
  useEffect(() => {
    if (polled.data && !isSame(polled.data, labels.get())) labels.set(polled.data);
  }, [polled.data]);
}
// The labels, to draw again when they change.
export const useLabels = labels.use;

const longest = 24;
// "urn:uuid:162c0914-5b1e-…" as "162c0914…".
export function shortName(name: string): string {
  return name.length > longest
    ? `${/[0-9a-f]{8}(?=-[0-9a-f]{4}-)/.exec(name)?.[0] ?? name.slice(0, longest - 1)}…`
    : name;
}
export function nameIn(labels: ReadonlyMap<string, string>, iri: string): string {
  return labels.get(iri) || shortName(localName(iri));
}
export function nameOf(iri: string): string {
  return nameIn(labels.get(), iri);
}
export function valueWords(value: Value | undefined): string {
  if (!value) return "";
  return value.kind === "iri"
    ? nameOf(value.text)
    : value.kind === "literal"
      ? value.text
      : `_:${value.text}`;
}
