// The visitor's run with what it waits for, the robots, and who is before: followed as it changes.
import { useEffect, useRef, useState } from "react";
import { fromJson, toJson, type DescMessage, type JsonValue, type MessageShape } from "@bufbuild/protobuf";
import { fleet, workflows } from "../api/client";
import { useFollow } from "../api/live";
import { usePoll } from "../api/poll";
import { query } from "../api/sparql";
import { kept } from "../api/storage";
import { type ListRobotsReply, ListRobotsReplySchema, type RobotStatus } from "../gen/docent/v1/fleet_pb";
import { ExplainRunReplySchema, type Run, RunSchema, type Wait } from "../gen/docent/v1/workflows_pb";
import { isLive } from "../ui/states";
import { docentNs } from "./offers";
import { change, fulfilled, lapsed, outbox, renewWish, useVisitor, withdraw } from "./visitor";

const prologue = `PREFIX docent: <${docentNs}> PREFIX prov: <http://www.w3.org/ns/prov#>\n`;
// Of the visitor whose IRI is given: its runs, the newest first.
const runsQuery = (visitor: string) =>
  `${prologue}SELECT DISTINCT ?run ?t { ?run docent:hasVariable/docent:variableValue <${visitor}> ; a docent:Run ; prov:startedAtTime ?t FILTER NOT EXISTS { ?run docent:parentRun ?p } } ORDER BY DESC(?t) LIMIT 5`;
// How many live runs of the same workflow began before, and how long the newest ones that are done have taken.
const beforeQuery = (run: string) =>
  `${prologue}SELECT (COUNT(DISTINCT ?r) AS ?n) { <urn:docent:run:${run}> docent:workflow ?w ; prov:startedAtTime ?mine . ?r docent:workflow ?w ; docent:runState "running" ; prov:startedAtTime ?t FILTER(?t < ?mine) FILTER NOT EXISTS { ?r docent:parentRun ?p } }`;
const tookQuery = (run: string) =>
  `${prologue}SELECT ?from ?to { <urn:docent:run:${run}> docent:workflow ?w . ?r docent:workflow ?w ; docent:runState "done" ; prov:startedAtTime ?from ; prov:endedAtTime ?to } ORDER BY DESC(?to) LIMIT 20`;

export interface MyRun {
  run: Run | undefined;
  waits: readonly Wait[];
  robots: readonly RobotStatus[];
  before: number;
  tookS: readonly number[];
}

export function useMyRun(): MyRun {
  const visitor = useVisitor();
  const found = usePoll(
    visitor.run === "" ? `my run ${visitor.id} ${visitor.past}` : "",
    async (signal) => {
      const { rows } = await query(runsQuery(visitor.id), signal);
      return (
        rows
          .map((row) => (row["run"]?.text ?? "").replace(/^urn:docent:run:/, ""))
          .find((run) => run !== "" && run !== visitor.past) ?? ""
      );
    },
    1500,
  );
  useEffect(() => void (found.data && change({ run: found.data })), [found.data]);
  const id = visitor.run;
  const robots = useFollow("robots", {
    call: "docent.v1.Fleet/List",
    request: {},
    reply: ListRobotsReplySchema,
    poll: (signal) => fleet.list({}, { signal }),
    everyMs: 500,
  });
  const run = useFollow(id && `run ${id}`, {
    call: "docent.v1.Workflows/Get",
    request: { run: id },
    reply: RunSchema,
    poll: (signal) => workflows.get({ run: id }, { signal }),
    everyMs: 500,
  });
  const there = run.data !== undefined && isLive(run.data.state);
  const waits = useFollow(id && there ? `waits ${id}` : "", {
    call: "docent.v1.Workflows/Explain",
    request: { run: id },
    reply: ExplainRunReplySchema,
    poll: (signal) => workflows.explain({ run: id }, { signal }),
    everyMs: 1000,
  });
  const queue = usePoll(
    id && there ? `before ${id}` : "",
    async (signal) => {
      const [before, took] = await Promise.all([
        query(beforeQuery(id), signal),
        query(tookQuery(id), signal),
      ]);
      const seconds = took.rows
        .map((row) => (Date.parse(row["to"]?.text ?? "") - Date.parse(row["from"]?.text ?? "")) / 1000)
        .filter((s) => s > 0);
      return { before: Number(before.rows[0]?.["n"]?.text ?? 0), tookS: seconds };
    },
    5000,
  );
  // A run that the server does not keep any more has ended.
  useEffect(() => void (run.error?.kind === "missing" && withdraw()), [run.error?.kind, id]);
  // What was wished is told as long as the page is open and it is not over.
  const ended = run.data !== undefined && !isLive(run.data.state);
  useEffect(() => {
    if (ended) return fulfilled();
    const timer = window.setInterval(renewWish, 15_000);
    document.addEventListener("visibilitychange", renewWish);
    renewWish();
    return () => {
      window.clearInterval(timer);
      document.removeEventListener("visibilitychange", renewWish);
    };
  }, [ended, id]);
  // The lifetime of the wish has ended, and it has started no run.
  useEffect(
    () =>
      void (found.data === "" && lapsed(visitor, Date.now()) && outbox.state.kind === "empty" && withdraw()),
    [found.data, visitor],
  );
  const last = useLast(id, run.data, robots.data);
  return {
    run: last.run,
    waits: waits.data?.waits ?? [],
    robots: last.robots?.robots ?? [],
    before: queue.data?.before ?? 0,
    tookS: queue.data?.tookS ?? [],
  };
}

const lastKey = "docent.visit.last";
const keptEveryMs = 2000;
interface Last {
  run: Run | undefined;
  robots: ListRobotsReply | undefined;
}
// What was known last, for a page that is loaded again without a network.
function useLast(id: string, run: Run | undefined, robots: ListRobotsReply | undefined): Last {
  const [before] = useState<Last & { id: string }>(() => {
    try {
      const stored = JSON.parse(kept.getItem(lastKey) ?? "null") as {
        id: string;
        run: JsonValue;
        robots: JsonValue;
      } | null;
      const read = <D extends DescMessage>(schema: D, json: JsonValue): MessageShape<D> =>
        fromJson(schema, json, { ignoreUnknownFields: true });
      if (stored)
        return {
          id: stored.id,
          run: read(RunSchema, stored.run),
          robots: read(ListRobotsReplySchema, stored.robots),
        };
    } catch {
      // of another version, or broken
    }
    return { id: "", run: undefined, robots: undefined };
  });
  const keptMs = useRef(0);
  useEffect(() => {
    if (!run || !robots || (Date.now() - keptMs.current < keptEveryMs && isLive(run.state))) return;
    keptMs.current = Date.now();
    kept.setItem(
      lastKey,
      JSON.stringify({
        id: run.id,
        run: toJson(RunSchema, run),
        robots: toJson(ListRobotsReplySchema, robots),
      }),
    );
  }, [run, robots]);
  const known = id !== "" && before.id === id ? before : undefined;
  return { run: run ?? known?.run, robots: robots ?? known?.robots };
}
