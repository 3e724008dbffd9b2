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
}
export interface Vocabulary {
  verbs: Word[];
  classes: Word[];
  things: Word[];
}

const rdf = "PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> PREFIX owl: <http://www.w3.org/2002/07/owl#> PREFIX docent: <https://w3id.org/docent#> PREFIX schema: <https://schema.org/> ";
const verbsQuery = `${rdf} SELECT ?t (SAMPLE(?l) AS ?label) (MAX(?u) AS ?n) { { SELECT ?t (COUNT(*) AS ?u) { ?s ?t ?o } GROUP BY ?t } UNION { VALUES ?k { owl:ObjectProperty owl:DatatypeProperty rdf:Property docent:StateProperty } ?t a ?k BIND(0 AS ?u) } OPTIONAL { ?t rdfs:label ?l } FILTER(isIRI(?t)) } GROUP BY ?t LIMIT 600`;
const classesQuery = `${rdf} SELECT ?t (SAMPLE(?l) AS ?label) (MAX(?u) AS ?n) { { SELECT ?t (COUNT(DISTINCT ?s) AS ?u) { ?s a ?t } GROUP BY ?t } UNION { VALUES ?k { owl:Class rdfs:Class } ?t a ?k BIND(0 AS ?u) } OPTIONAL { ?t rdfs:label ?l } FILTER(isIRI(?t)) } GROUP BY ?t LIMIT 400`;
const thingsQuery = `${rdf} SELECT ?t (${nameChosen} AS ?label) (GROUP_CONCAT(DISTINCT STR(?c); separator=" ") AS ?classes) { ?t a ?c . FILTER(isIRI(?t)) FILTER NOT EXISTS { ?t a docent:Run } FILTER NOT EXISTS { ?t a docent:NodeInstance } ${namePatterns("?t")} FILTER(?c NOT IN (owl:Class, rdfs:Class, owl:ObjectProperty, owl:DatatypeProperty, rdf:Property)) } GROUP BY ?t LIMIT 1500`;

export function useVocabulary(prefixes: ReadonlyMap<string, string>): Vocabulary {
  const polled = usePoll("vocabulary", async (signal) => Promise.all([verbsQuery, classesQuery, thingsQuery].map((text) => query(text, signal))), 30_000);
  return useMemo(() => {
    const [verbs, classes, things] = polled.data ?? [];
    const words = (answer: typeof verbs, use: (row: NonNullable<typeof verbs>["rows"][number]) => string): Word[] =>
      (answer?.rows ?? []).flatMap((row) => {
        const iri = row["t"]?.text ?? "";
        const term = shorten(iri, prefixes);
        return term && !internal.test(term) ? [{ term, label: row["label"]?.text ?? "", use: use(row) }] : [];
      });
    const count = (noun: string) => (row: Record<string, { text: string } | undefined>) => {
      const n = Number(row["n"]?.text ?? 0);
      return n > 0 ? `${n} ${noun}${n === 1 ? "" : "s"}` : "";
    };
    const byUse = (a: Word, b: Word) => parseInt(b.use || "0", 10) - parseInt(a.use || "0", 10) || a.term.localeCompare(b.term);
    const known = words(classes, count("thing")).sort((a, b) => Number(general(a.term)) - Number(general(b.term)) || byUse(a, b));
    const sizes = new Map((classes?.rows ?? []).map((row) => [row["t"]?.text ?? "", Number(row["n"]?.text ?? 0)]));
    return {
      verbs: words(verbs, count("fact")).sort((a, b) => Number(general(a.term)) - Number(general(b.term)) || byUse(a, b)),
      classes: known,
      things: (things?.rows ?? []).flatMap((row) => {
        const term = shorten(row["t"]?.text ?? "", prefixes);
        // Of its classes, the one that has the fewest things says most.
        const own = (row["classes"]?.text ?? "").split(" ").sort((a, b) => (sizes.get(a) ?? 0) - (sizes.get(b) ?? 0)).map((iri) => shorten(iri, prefixes)).filter((c) => c && !internal.test(c));
        return term ? [{ term, label: row["label"]?.text ?? "", use: (own.find((c) => !general(c)) ?? own[0] ?? "").replace(/^[\w-]+:/, ""), classes: own }] : [];
      }).sort((a, b) => rank(a) - rank(b) || a.term.localeCompare(b.term)),
    };
  }, [polled.data, prefixes]);
}

// What a place that wants things of a class is offered: those of it, or all where it wants none or there are none.
export function ofClass(vocabulary: Vocabulary, type: string): Word[] {
  const fitting = type ? vocabulary.things.filter((t) => t.classes?.includes(type)) : [];
  return fitting.length > 0 ? fitting : vocabulary.things;
}

// Words of RDF's and OWL's own machinery, which no situation is made of.
const internal = /^(owl|rdfs|sh):|^rdf:(?!type$)/;
// Words of other vocabularies, which come after Docent's and those of the documents.
const general = (term: string) => /^(rdf|geo|prov|sosa|schema|xsd):/.test(term);
const first = new Set(["docent:Booth", "docent:Region", "docent:Person", "docent:Visitor", "docent:Robot"]);
const last = new Set(["docent:Wall", "docent:BoothWall", "docent:Counter", "docent:Pillar", "docent:Obstacle"]);
function rank(thing: Word): number {
  const has = (classes: ReadonlySet<string>) => thing.classes?.some((c) => classes.has(c));
  return has(last) ? 2 : has(first) ? 0 : 1;
}
