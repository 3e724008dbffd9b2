// Runs that are kept as tests of a workflow: facts on the server, so that any browser lives them again after an edit.
import { context } from "../api/client";
import { query, sparqlString } from "../api/sparql";

export const testsGraph = "urn:docent:run-tests";
const prologue =
  "PREFIX docent: <https://w3id.org/docent#> PREFIX xsd: <http://www.w3.org/2001/XMLSchema#>\n";

export function testIri(run: string): string {
  return `urn:docent:run-test:${encodeURIComponent(run).replace(/[!'()*]/g, (c) => `%${c.charCodeAt(0).toString(16).toUpperCase()}`)}`;
}
export function keepUpdate(workflow: string, run: string, keptAt: string): string {
  return `${prologue}INSERT DATA { GRAPH <${testsGraph}> { <${testIri(run)}> a docent:RunTest ; docent:testOf ${sparqlString(workflow)} ; docent:testsRun ${sparqlString(run)} ; docent:keptAt ${sparqlString(keptAt)}^^xsd:dateTime } }`;
}
export async function keepTest(workflow: string, run: string): Promise<void> {
  await context.update({ update: keepUpdate(workflow, run, new Date().toISOString()) });
}
export async function dropTest(run: string): Promise<void> {
  await context.update({ update: `DELETE WHERE { GRAPH <${testsGraph}> { <${testIri(run)}> ?p ?o } }` });
}
// Ids of the runs, the newest first.
export async function listTests(workflow: string, signal?: AbortSignal): Promise<string[]> {
  const { rows } = await query(
    `${prologue}SELECT DISTINCT ?run { GRAPH <${testsGraph}> { ?t a docent:RunTest ; docent:testOf ${sparqlString(workflow)} ; docent:testsRun ?run ; docent:keptAt ?at } } ORDER BY DESC(?at) LIMIT 200`,
    signal,
  );
  return rows.flatMap((row) => row["run"]?.text ?? []);
}
