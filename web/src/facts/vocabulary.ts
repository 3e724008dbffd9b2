// Words for subjects, verbs and objects: what the ontology and the live graph have now, under the document's prefixes.
import { useMemo } from "react";
import { nameChosen, namePatterns } from "../api/labels";
import { usePoll } from "../api/poll";
import { query, shorten } from "../api/sparql";

export interface Word {
  term: string; // as it is written in a document
  label: string;
  use: string; // "12 facts"; of a thing its class
  classes?: string[]; // of a thing, the most specific first
  comment?: string; // of a verb: what the ontology says of it
  above?: string[]; // of a class those that it is a part of, of a verb those whose things have it
}
export interface Vocabulary {
  verbs: Word[];
  classes: Word[];
  things: Word[];
}

const rdf =
  "PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> PREFIX owl: <http://www.w3.org/2002/07/owl#> PREFIX docent: <https://w3id.org/docent#> PREFIX schema: <https://schema.org/> ";
const verbsQuery = `${rdf} SELECT ?t (SAMPLE(?l) AS ?label) (SAMPLE(?k1) AS ?comment) (GROUP_CONCAT(DISTINCT STR(?d); separator=" ") AS ?above) (MAX(?u) AS ?n) { { SELECT ?t (COUNT(*) AS ?u) { ?s ?t ?o } GROUP BY ?t } UNION { VALUES ?k { owl:ObjectProperty owl:DatatypeProperty rdf:Property docent:StateProperty } ?t a ?k BIND(0 AS ?u) } OPTIONAL { ?t rdfs:label ?l } OPTIONAL { ?t rdfs:comment ?k1 } OPTIONAL { ?t rdfs:domain ?d FILTER(isIRI(?d)) } FILTER(isIRI(?t)) } GROUP BY ?t LIMIT 600`;
const classesQuery = `${rdf} SELECT ?t (SAMPLE(?l) AS ?label) (GROUP_CONCAT(DISTINCT STR(?d); separator=" ") AS ?above) (MAX(?u) AS ?n) { { SELECT ?t (COUNT(DISTINCT ?s) AS ?u) { ?s a ?t } GROUP BY ?t } UNION { VALUES ?k { owl:Class rdfs:Class } ?t a ?k BIND(0 AS ?u) } OPTIONAL { ?t rdfs:label ?l } OPTIONAL { ?t rdfs:subClassOf ?d FILTER(isIRI(?d)) } FILTER(isIRI(?t)) } GROUP BY ?t LIMIT 400`;
const thingsQuery = `${rdf} SELECT ?t (${nameChosen} AS ?label) (GROUP_CONCAT(DISTINCT STR(?c); separator=" ") AS ?classes) { ?t a ?c . FILTER(isIRI(?t)) FILTER NOT EXISTS { ?t a docent:Run } FILTER NOT EXISTS { ?t a docent:NodeInstance } ${namePatterns("?t")} FILTER(?c NOT IN (owl:Class, rdfs:Class, owl:ObjectProperty, owl:DatatypeProperty, rdf:Property)) } GROUP BY ?t LIMIT 1500`;

export function useVocabulary(prefixes: ReadonlyMap<string, string>): Vocabulary {
  const polled = usePoll(
    "vocabulary",
    async (signal) => Promise.all([verbsQuery, classesQuery, thingsQuery].map((text) => query(text, signal))),
    30_000,
  );
  return useMemo(() => {
    const [verbs, classes, things] = polled.data ?? [];
    const words = (
      answer: typeof verbs,
      use: (row: NonNullable<typeof verbs>["rows"][number]) => string,
    ): Word[] =>
      (answer?.rows ?? []).flatMap((row) => {
        const iri = row["t"]?.text ?? "";
        const term = shorten(iri, prefixes);
        const above = (row["above"]?.text ?? "")
          .split(" ")
          .filter(Boolean)
          .map((a) => shorten(a, prefixes));
        return term && !internal.test(term)
          ? [
              {
                term,
                label: row["label"]?.text ?? "",
                use: use(row),
                comment: row["comment"]?.text ?? "",
                above,
              },
            ]
          : [];
      });
    const count = (noun: string) => (row: Record<string, { text: string } | undefined>) => {
      const n = Number(row["n"]?.text ?? 0);
      return n > 0 ? `${n} ${noun}${n === 1 ? "" : "s"}` : "";
    };
    const byUse = (a: Word, b: Word) =>
      parseInt(b.use || "0", 10) - parseInt(a.use || "0", 10) || a.term.localeCompare(b.term);
    const known = words(classes, count("thing")).sort(
      (a, b) => Number(general(a.term)) - Number(general(b.term)) || byUse(a, b),
    );
    const sizes = new Map(
      (classes?.rows ?? []).map((row) => [row["t"]?.text ?? "", Number(row["n"]?.text ?? 0)]),
    );
    return {
      verbs: words(verbs, count("fact")).sort(
        (a, b) => Number(general(a.term)) - Number(general(b.term)) || byUse(a, b),
      ),
      classes: known,
      things: (things?.rows ?? [])
        .flatMap((row) => {
          const term = shorten(row["t"]?.text ?? "", prefixes);
          // Of its classes, the one that has the fewest things says most.
          const own = (row["classes"]?.text ?? "")
            .split(" ")
            .sort((a, b) => (sizes.get(a) ?? 0) - (sizes.get(b) ?? 0))
            .map((iri) => shorten(iri, prefixes))
            .filter((c) => c && !internal.test(c));
          return term
            ? [
                {
                  term,
                  label: row["label"]?.text ?? "",
                  use: (own.find((c) => !general(c)) ?? own[0] ?? "").replace(/^[\w-]+:/, ""),
                  classes: own,
                },
              ]
            : [];
        })
        .sort((a, b) => rank(a) - rank(b) || a.term.localeCompare(b.term)),
    };
  }, [polled.data, prefixes]);
}

// What a place that wants things of a class is offered: those of it, or all where it wants none or there are none.
export function ofClass(vocabulary: Vocabulary, type: string): Word[] {
  const fitting = type ? vocabulary.things.filter((t) => t.classes?.includes(type)) : [];
  return fitting.length > 0 ? fitting : vocabulary.things;
}

// How many facts of each verb the things of some classes have now, by class.
export function useVerbsOfClasses(
  classes: readonly string[],
  prefixes: ReadonlyMap<string, string>,
): ReadonlyMap<string, ReadonlyMap<string, number>> {
  const iris = [...new Set(classes)].sort().flatMap((c) => {
    const colon = c.indexOf(":");
    const namespace = prefixes.get(c.slice(0, colon));
    return namespace && /^[\w.-]+$/.test(c.slice(colon + 1)) ? [namespace + c.slice(colon + 1)] : [];
  });
  const polled = usePoll(
    iris.length > 0 ? `verbs of ${iris.join(" ")}` : "",
    (signal) =>
      query(
        `SELECT ?c ?t (COUNT(*) AS ?n) { VALUES ?c { ${iris.map((iri) => `<${iri}>`).join(" ")} } ?s a ?c ; ?t ?o } GROUP BY ?c ?t LIMIT 2000`,
        signal,
      ),
    30_000,
  );
  return useMemo(() => {
    const found = new Map<string, Map<string, number>>();
    for (const row of polled.data?.rows ?? []) {
      const of = shorten(row["c"]?.text ?? "", prefixes);
      found.set(
        of,
        (found.get(of) ?? new Map<string, number>()).set(
          shorten(row["t"]?.text ?? "", prefixes),
          Number(row["n"]?.text ?? 0),
        ),
      );
    }
    return found;
  }, [polled.data, prefixes]);
}

// Verbs for a thing of a class (empty: not known): first those that situations are mostly made of, then those that things of the class
// have now or the ontology gives them, then all others. `used`: facts of each verb that things of the class have.
export function verbsFor(
  vocabulary: Pick<Vocabulary, "verbs" | "classes">,
  type: string,
  used: ReadonlyMap<string, number> = new Map(),
): Word[] {
  const classes = new Set([type]);
  for (const c of classes)
    for (const above of vocabulary.classes.find((w) => w.term === c)?.above ?? []) classes.add(above);
  const group = (verb: Word) => {
    const suits = type === "" || used.has(verb.term) || (verb.above ?? []).some((d) => classes.has(d));
    if (general(verb.term)) return 4;
    if (plumbing.has(verb.term)) return 3;
    return usual.includes(verb.term) && suits ? 0 : type !== "" && suits ? 1 : 2;
  };
  const place = new Map(vocabulary.verbs.map((verb, i) => [verb.term, { group: group(verb), at: i }]));
  const at = (verb: Word) => place.get(verb.term) ?? { group: 5, at: 0 };
  return [...vocabulary.verbs].sort(
    (a, b) =>
      at(a).group - at(b).group ||
      (at(a).group === 0
        ? usual.indexOf(a.term) - usual.indexOf(b.term)
        : (used.get(b.term) ?? 0) - (used.get(a.term) ?? 0) || at(a).at - at(b).at),
  );
}
// Further words that find a verb: what people say for it.
export function verbWordsToFind(verb: Word): string {
  return [verb.comment, said[verb.term]].filter(Boolean).join(" ");
}
// What most situations are made of.
const usual = [
  "docent:isAt",
  "docent:isNear",
  "docent:selected",
  "docent:chose",
  "docent:status",
  "docent:localised",
  "docent:battery",
  "docent:language",
  "docent:interest",
];
const said: Readonly<Record<string, string>> = {
  "docent:isAt": "comes to arrives reaches stands waits in inside where place",
  "docent:isNear": "comes close to beside next to meets together",
  "docent:selected": "wants to see picks booth",
  "docent:chose": "wants asks for calls orders service",
  "docent:status": "free busy standby ready charging",
  "docent:localised": "knows its place position",
};
// Measures and addresses, which things have many of and situations few.
const plumbing = new Set(
  [
    "partOf",
    "fromPlace",
    "toPlace",
    "length",
    "height",
    "radius",
    "servicePoint",
    "x",
    "y",
    "heading",
    "positionDeviation",
    "plannedPath",
    "adapterAddress",
    "incarnation",
    "lastSeenAt",
    "screenPage",
    "spokenFile",
    "currentCommand",
    "progress",
    "logOffset",
    "rule",
    "evidence",
    "binding",
    "bindingName",
    "subject",
    "predicate",
    "object",
    "listNode",
    "longList",
    "inAllFrom",
  ].map((name) => `docent:${name}`),
);
// Words of RDF's and OWL's own machinery, which no situation is made of.
const internal = /^(owl|rdfs|sh):|^rdf:(?!type$)/;
// Words of other vocabularies, which come after Docent's and those of the documents.
const general = (term: string) => /^(rdf|geo|prov|sosa|schema|xsd):/.test(term);
const first = new Set(["docent:Booth", "docent:Region", "docent:Person", "docent:Visitor", "docent:Robot"]);
const last = new Set([
  "docent:Wall",
  "docent:BoothWall",
  "docent:Counter",
  "docent:Pillar",
  "docent:Obstacle",
]);
function rank(thing: Word): number {
  const has = (classes: ReadonlySet<string>) => thing.classes?.some((c) => classes.has(c));
  return has(last) ? 2 : has(first) ? 0 : 1;
}
