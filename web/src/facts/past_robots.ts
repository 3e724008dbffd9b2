// Robots as they were: from a past version of the graph, in the form in which the fleet tells of them now.
import { create } from "@bufbuild/protobuf";
import { runOf } from "../api/iris";
import { nameOf } from "../api/labels";
import { localName, query, type Row } from "../api/sparql";
import { ListRobotsReplySchema, type ListRobotsReply, RobotStatusSchema } from "../gen/docent/v1/fleet_pb";

export const robotsQuery = `PREFIX docent: <https://w3id.org/docent#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>
SELECT ?r (SAMPLE(?l) AS ?label) (SAMPLE(?px) AS ?x) (SAMPLE(?py) AS ?y) (SAMPLE(?ph) AS ?heading) (SAMPLE(?s) AS ?status) (SAMPLE(?at) AS ?region) (SAMPLE(?out) AS ?reason) (SAMPLE(?h) AS ?run) (SAMPLE(?o) AS ?operation) (SAMPLE(?n) AS ?node) {
  { ?r a docent:Robot } UNION { ?r docent:adapterAddress ?address }
  OPTIONAL { ?r rdfs:label ?l } OPTIONAL { ?r docent:x ?px ; docent:y ?py } OPTIONAL { ?r docent:heading ?ph } OPTIONAL { ?r docent:status ?s }
  OPTIONAL { ?r docent:isAt ?at } OPTIONAL { ?r docent:outOfService ?out } OPTIONAL { ?r docent:heldBy ?h }
  OPTIONAL { ?r docent:heldFor ?i . ?i docent:operation ?o ; docent:ofNode/docent:nodeName ?n }
} GROUP BY ?r ORDER BY ?r LIMIT 500`;

export function readRobots(rows: readonly Row[]): ListRobotsReply {
  return create(ListRobotsReplySchema, {
    robots: rows.flatMap((row) => {
      const robot = row["r"]?.text;
      if (!robot) return [];
      const text = (name: string) => row[name]?.text ?? "";
      const run = runOf(text("run"));
      return [
        create(RobotStatusSchema, {
          robot,
          label: text("label") || nameOf(robot),
          state: localName(text("status")).toLowerCase() || "offline",
          hasPose: row["x"] !== undefined && row["y"] !== undefined,
          xM: Number(text("x")),
          yM: Number(text("y")),
          headingRad: Number(text("heading")),
          regions: row["region"] ? [text("region")] : [],
          outOfService: row["reason"] !== undefined,
          outOfServiceReason: text("reason"),
          heldBy: run,
          heldFor: row["operation"] ? [{ run, node: text("node"), operation: text("operation") }] : [],
        }),
      ];
    }),
  });
}

export const askRobots = async (asOf: string, signal: AbortSignal) =>
  readRobots((await query(robotsQuery, signal, asOf)).rows);
