// Runs as they were: the facts of the graph docent:runs, as the server tells of runs now.
import { create } from "@bufbuild/protobuf";
import { runIri, runOf } from "../api/iris";
import { query, type Row, type Value } from "../api/sparql";
import { type Term, TermSchema } from "../gen/docent/v1/term_pb";
import { type ListRunsReply, ListRunsReplySchema, type Run, RunSchema } from "../gen/docent/v1/workflows_pb";

const docent = "https://w3id.org/docent#";
const prov = "http://www.w3.org/ns/prov#";
const prologue = `PREFIX docent: <${docent}>\n`;
const mostRows = 60_000;

// Of one run all; `id` as it is in IRIs.
export function runQuery(id: string): string {
  const run = `<${runIri}${id.replace(/[<>"{}|^`\\\s]/g, encodeURIComponent)}>`;
  return `${prologue}SELECT ?s ?p ?o { GRAPH docent:runs { { ${run} ?p ?o BIND(${run} AS ?s) } UNION { ?s docent:ofRun ${run} ; ?p ?o } UNION { ?n docent:ofRun ${run} . ?s docent:ofNode ?n ; ?p ?o } UNION { ${run} docent:hasVariable|docent:hasResult ?s . ?s ?p ?o } } } LIMIT ${mostRows}`;
}
// Of all runs; steps and what they do only where the run is live.
export const runsQuery = `${prologue}SELECT ?s ?p ?o { GRAPH docent:runs { { ?s a docent:Run ; ?p ?o } UNION { ?r docent:runState "running" . ?s docent:ofRun ?r ; ?p ?o } UNION { ?r docent:runState "running" . ?n docent:ofRun ?r . ?s docent:ofNode ?n ; ?p ?o } } } LIMIT ${mostRows}`;

type Facts = ReadonlyMap<string, readonly Value[]>; // of one thing, by predicate

function gathered(rows: readonly Row[]): Map<string, Map<string, Value[]>> {
  const things = new Map<string, Map<string, Value[]>>();
  for (const row of rows) {
    const [s, p, o] = [row["s"]?.text, row["p"]?.text, row["o"]];
    if (s === undefined || p === undefined || !o) continue;
    const facts = things.get(s) ?? new Map<string, Value[]>();
    things.set(s, facts.set(p, [...(facts.get(p) ?? []), o]));
  }
  return things;
}
const all = (facts: Facts | undefined, name: string): string[] =>
  facts?.get(name.includes("#") ? name : docent + name)?.map((v) => v.text) ?? [];
const one = (facts: Facts | undefined, name: string) => all(facts, name)[0] ?? "";
const micros = (time: string) => (time ? BigInt(Date.parse(time)) * 1000n : 0n);
const numberAtEnd = (iri: string) => Number(iri.slice(iri.lastIndexOf("/") + 1)) || 0;

function termOf(value: Value): Term {
  if (value.kind === "literal")
    return create(TermSchema, {
      kind: {
        case: "literal",
        value: { lexical: value.text, datatype: value.datatype ?? "", language: value.language ?? "" },
      },
    });
  return create(TermSchema, { kind: { case: value.kind, value: value.text } });
}

export function readRuns(rows: readonly Row[]): Run[] {
  const things = gathered(rows);
  const under = (property: string) => {
    const found = new Map<string, string[]>();
    for (const [iri, facts] of things)
      for (const of of all(facts, property)) found.set(of, [...(found.get(of) ?? []), iri]);
    return found;
  };
  const nodes = under("ofRun");
  const invocations = under("ofNode");
  const values = (iris: readonly string[]) =>
    iris
      .flatMap((iri) => {
        const value = things.get(iri)?.get(`${docent}variableValue`)?.[0];
        return value ? [{ name: one(things.get(iri), "variableName"), value: termOf(value) }] : [];
      })
      .sort((a, b) => a.name.localeCompare(b.name));
  const runs = [...things]
    .filter(([, facts]) => facts.has(`${docent}runState`))
    .map(([iri, facts]) =>
      create(RunSchema, {
        id: runOf(iri),
        workflow: one(facts, "workflow"),
        flow: one(facts, "flow"),
        state: one(facts, "runState"),
        reason: one(facts, "reason"),
        parent: runOf(one(facts, "parentRun")),
        paused: facts.has(`${docent}pausedAt`),
        startedUs: micros(one(facts, `${prov}startedAtTime`)),
        endedUs: micros(one(facts, `${prov}endedAtTime`)),
        variables: values(all(facts, "hasVariable")),
        results: values(all(facts, "hasResult")),
        nodes: (nodes.get(iri) ?? [])
          .sort((a, b) => Number(one(things.get(a), "position")) - Number(one(things.get(b), "position")))
          .map((node) => {
            const of = things.get(node);
            return {
              name: one(of, "nodeName"),
              state: one(of, "nodeState"),
              waitsFor: one(of, "waitsFor"),
              firedBecause: one(of, "firedBecause"),
              reason: one(of, "reason"),
              sinceUs: micros(one(of, "since")),
              invocations: (invocations.get(node) ?? [])
                .sort((a, b) => numberAtEnd(a) - numberAtEnd(b))
                .map((i) => {
                  const done = things.get(i);
                  return {
                    operation: one(done, "operation"),
                    state: one(done, "invocationState"),
                    robot: one(done, "robot"),
                    step: one(done, "step"),
                    reason: one(done, "reason"),
                    progress: Number(one(done, "progress")) || 0,
                  };
                }),
            };
          }),
      }),
    );
  return runs.sort((a, b) => Number(b.startedUs - a.startedUs));
}

// Undefined: there was no such run yet, or no longer.
export const askRun = async (id: string, asOf: string, signal: AbortSignal) =>
  readRuns((await query(runQuery(id), signal, asOf)).rows).find((run) => run.id === id);
export const askRuns = async (asOf: string, signal: AbortSignal): Promise<ListRunsReply> =>
  create(ListRunsReplySchema, { runs: readRuns((await query(runsQuery, signal, asOf)).rows) });
