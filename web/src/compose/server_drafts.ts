// Drafts on the server: one a workflow, as facts in a graph of their own, so that another browser can go on with them. A draft is
// written only over the one that the writer has seen.
import { context } from "../api/client";
import { query, sparqlString } from "../api/sparql";
import { kept } from "../api/storage";

export interface ServerDraft {
  name: string;
  text: string;
  saved: string; // when, as xsd:dateTime; names this state of the draft
  base: string; // the deployed text that it began from; empty: not known, or none was deployed
}
export const draftsGraph = "urn:docent:drafts";
const prologue =
  "PREFIX docent: <https://w3id.org/docent#> PREFIX xsd: <http://www.w3.org/2001/XMLSchema#>\n";

export function draftIri(name: string): string {
  return `urn:docent:draft:${encodeURIComponent(name).replace(/[!'()*]/g, (c) => `%${c.charCodeAt(0).toString(16).toUpperCase()}`)}`;
}

// `seen`: the state that the writer has seen; empty: there was none. Where the server has another one, nothing is written.
export function writeUpdate(draft: Omit<ServerDraft, "base"> & { base?: string }, seen: string): string {
  const iri = `<${draftIri(draft.name)}>`;
  const other =
    seen === ""
      ? `${iri} docent:savedAt ?other`
      : `${iri} docent:savedAt ?other FILTER(STR(?other) != ${sparqlString(seen)})`;
  return `${prologue}DELETE { GRAPH <${draftsGraph}> { ${iri} ?p ?o } }
INSERT { GRAPH <${draftsGraph}> { ${iri} a docent:Draft ; docent:draftName ${sparqlString(draft.name)} ; docent:draftText ${sparqlString(draft.text)} ;${draft.base ? ` docent:draftBase ${sparqlString(draft.base)} ;` : ""} docent:savedAt ${sparqlString(draft.saved)}^^xsd:dateTime } }
WHERE { OPTIONAL { GRAPH <${draftsGraph}> { ${iri} ?p ?o } } FILTER NOT EXISTS { GRAPH <${draftsGraph}> { ${other} } } }`;
}

// The state that was written; null: the server has a draft that the writer has not seen.
export async function writeServerDraft(
  name: string,
  text: string,
  base: string,
  seen: string,
): Promise<string | null> {
  const saved = new Date().toISOString();
  const reply = await context.update({ update: writeUpdate({ name, text, base, saved }, seen) });
  return reply.added > 0n ? saved : null;
}
export async function readServerDraft(name: string, signal?: AbortSignal): Promise<ServerDraft | null> {
  const { rows } = await query(
    `${prologue}SELECT ?text ?base (STR(?at) AS ?saved) { GRAPH <${draftsGraph}> { <${draftIri(name)}> docent:draftText ?text ; docent:savedAt ?at OPTIONAL { <${draftIri(name)}> docent:draftBase ?base } } } LIMIT 1`,
    signal,
  );
  const row = rows[0];
  return row?.["text"] && row["saved"]
    ? { name, text: row["text"].text, base: row["base"]?.text ?? "", saved: row["saved"].text }
    : null;
}
export async function listServerDrafts(signal?: AbortSignal): Promise<Omit<ServerDraft, "text" | "base">[]> {
  const { rows } = await query(
    `${prologue}SELECT ?name (STR(?at) AS ?saved) { GRAPH <${draftsGraph}> { ?d a docent:Draft ; docent:draftName ?name ; docent:savedAt ?at } } ORDER BY DESC(?at) LIMIT 500`,
    signal,
  );
  return rows.flatMap((row) =>
    row["name"] && row["saved"] ? [{ name: row["name"].text, saved: row["saved"].text }] : [],
  );
}
export async function dropServerDraft(name: string): Promise<void> {
  await context.update({ update: `DELETE WHERE { GRAPH <${draftsGraph}> { <${draftIri(name)}> ?p ?o } }` });
}

// The newest state of the server's draft that this browser has seen, and its text, from which both go on.
const key = (name: string) => `docent.serverdraft.${name}`;
export function seenState(name: string): string {
  return kept.getItem(key(name)) ?? "";
}
const textKey = (name: string) => `docent.serverdraft.text.${name}`;
export const seenText = (name: string) => kept.getItem(textKey(name));
export function keepSeen(name: string, saved: string, text = "") {
  kept.removeItem(textKey(name));
  if (saved) kept.setItem(key(name), saved);
  else kept.removeItem(key(name));
  if (saved) kept.setItem(textKey(name), text);
}
