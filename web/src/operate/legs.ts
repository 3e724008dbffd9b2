// How long the ways of a tour are along the hall's routes, where the graph has connections of places.
import { usePoll } from "../api/poll";
import { query, type Row } from "../api/sparql";
import type { Point } from "../hall/layout";

const mostWays = 2000; // of a roadmap
export const roadmapQuery = `PREFIX docent: <https://w3id.org/docent#> PREFIX geo: <http://www.opengis.net/ont/geosparql#>
SELECT ?from ?to (SAMPLE(?l) AS ?length) { ?c a docent:Connection ; docent:fromPlace ?a ; docent:toPlace ?b FILTER NOT EXISTS { ?c docent:closed true } OPTIONAL { ?c docent:length ?l }
  { ?a docent:servicePoint/geo:asWKT ?from } UNION { ?a docent:x ?ax ; docent:y ?ay BIND(CONCAT(STR(?ax), " ", STR(?ay)) AS ?from) }
  { ?b docent:servicePoint/geo:asWKT ?to } UNION { ?b docent:x ?bx ; docent:y ?by BIND(CONCAT(STR(?bx), " ", STR(?by)) AS ?to) }
} GROUP BY ?c ?from ?to LIMIT ${mostWays}`;

// The text that docent:routeLength takes; empty: the hall has no routes.
export function roadmapText(rows: readonly Row[]): string {
  return rows
    .flatMap((row) =>
      row["from"] && row["to"]
        ? [[row["from"].text, row["to"].text, row["length"]?.text ?? ""].join(" ").trim()]
        : [],
    )
    .join("; ");
}

// Metres to each stop from the one before it, or from `from`; undefined: no route is known.
export function useLegs(stops: readonly Point[], from: Point | null): readonly (number | undefined)[] {
  const roadmap = usePoll(
    "roadmap",
    async (signal) => roadmapText((await query(roadmapQuery, signal)).rows),
    60_000,
  );
  const ways = stops.map((to, i) => [i === 0 ? from : stops[i - 1], to] as const);
  const legs = ways.flatMap(([a, b], i) =>
    a && b ? [{ i, text: `docent:routeLength("${a.x} ${a.y}", "${b.x} ${b.y}", ?map)` }] : [],
  );
  const key =
    roadmap.data && legs.length > 0 ? `legs ${roadmap.data.length} ${legs.map((l) => l.text).join(" ")}` : "";
  const lengths = usePoll(
    key,
    async (signal) => {
      const { rows } = await query(
        `PREFIX docent: <https://w3id.org/docent#> SELECT ${legs.map((l) => `?m${l.i}`).join(" ")} { BIND(${JSON.stringify(roadmap.data)} AS ?map) ${legs.map((l) => `BIND(${l.text} AS ?m${l.i})`).join(" ")} }`,
        signal,
      );
      return stops.map((_, i) => (rows[0]?.[`m${i}`] ? Number(rows[0][`m${i}`]?.text) : undefined));
    },
    60_000,
  );
  return lengths.data ?? [];
}
