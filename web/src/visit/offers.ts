// The services that visitors can choose: what the graph describes, with what their workflows have to know.
import { query, type Row } from "../api/sparql";
import { workflows } from "../api/client";

export const docentNs = "https://w3id.org/docent#";
export interface Offer {
  iri: string;
  name: string;
  text: string;
  workflow: string; // that starts when somebody chooses it; empty: none
  live: boolean; // it is deployed, armed and not paused
  asksBooth: boolean;
}
// What a workflow's text says of a service: choosing it starts a run, which may need a booth.
export interface Wish {
  service: string;
  asksBooth: boolean;
}

// "docent:chose" of the activator, and whether the steps wait for "docent:selected".
export async function wishesOf(text: string): Promise<Wish[]> {
  // With the parser, which the first view does not need.
  const [{ prefixesOf, readCawl }, { neededRows }] = await Promise.all([
    import("../cawl/document"),
    import("../cawl/condition_logic"),
  ]);
  const document = readCawl(text);
  const prefixes = prefixesOf(document);
  const iri = (word: string) => {
    const [prefix = "", local = ""] = word.trim().split(/:(.*)/s);
    return word.trim().startsWith("<")
      ? word.trim().slice(1, -1)
      : (prefixes.get(prefix) ?? `${prefix}:`) + local;
  };
  const asksBooth = document.flows.some((f) =>
    f.steps.some((s) => neededRows(s.condition).some((r) => iri(r.verb.text) === `${docentNs}selected`)),
  );
  return neededRows(document.activator?.condition ?? null)
    .filter((r) => iri(r.verb.text) === `${docentNs}chose`)
    .map((r) => ({ service: /^[?$]/.test(r.object.text.trim()) ? "" : iri(r.object.text), asksBooth }));
}

const servicesQuery = `PREFIX docent: <${docentNs}> PREFIX schema: <https://schema.org/> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>
SELECT ?s ?name ?text { ?s a docent:Service FILTER NOT EXISTS { ?s a docent:RobotService } FILTER(isIRI(?s)) OPTIONAL { ?s schema:name|rdfs:label ?name } OPTIONAL { ?s schema:description|rdfs:comment ?text } } ORDER BY ?s LIMIT 500`;

// The text in the language, else without one, else any.
export function inLanguage(rows: readonly Row[], variable: string, language: string): string {
  const values = rows.flatMap((row) => (row[variable] ? [row[variable]] : []));
  const of = (tag: string) =>
    values.find((v) => (v.language ?? "").toLowerCase().split("-")[0] === tag)?.text;
  return of(language) ?? of("") ?? of("en") ?? values[0]?.text ?? "";
}

const mostWorkflows = 60;
const known = new Map<string, Wish[]>(); // by workflow and deployed version

export async function readOffers(language: string, signal: AbortSignal): Promise<Offer[]> {
  const [answer, deployed] = await Promise.all([
    query(servicesQuery, signal),
    workflows.list({}, { signal }),
  ]);
  const starts = new Map<string, { workflow: string; live: boolean; asksBooth: boolean }>();
  for (const w of deployed.workflows.filter((one) => one.activatedFlow).slice(0, mostWorkflows)) {
    const key = `${w.name} ${w.revision}`;
    let wishes = known.get(key);
    if (!wishes) {
      const { versions } = await workflows.listVersions({ workflow: w.name, withTexts: true }, { signal });
      wishes = await wishesOf((versions.find((v) => v.live) ?? versions.at(-1))?.text ?? "");
      known.set(key, wishes);
    }
    for (const { service, asksBooth } of wishes) {
      const live = !w.disabled && !w.paused;
      if (!starts.get(service)?.live) starts.set(service, { workflow: w.name, live, asksBooth });
    }
  }
  const any = starts.get(""); // a workflow for whatever is chosen
  return [...new Set(answer.rows.map((row) => row["s"]?.text ?? ""))].filter(Boolean).map((iri) => {
    const rows = answer.rows.filter((row) => row["s"]?.text === iri);
    const start = starts.get(iri) ?? any;
    return {
      iri,
      name: inLanguage(rows, "name", language) || iri.replace(/^.*[#/]/, ""),
      text: inLanguage(rows, "text", language),
      workflow: start?.workflow ?? "",
      live: start?.live ?? false,
      asksBooth: start?.asksBooth ?? false,
    };
  });
}
