// Where robots are on their way to, and how sure they are of where they are: what their adapters tell of it.
import { useShown } from "../api/as_of";
import type { Polled } from "../api/poll";
import { query, type Row } from "../api/sparql";
import { type Point, readWkt } from "./layout";

export interface Way {
  path: Point[]; // from where it began; empty: it does not drive
  deviationM: number | null; // standard deviation of its position
}
export const waysQuery = `PREFIX docent: <https://w3id.org/docent#>
SELECT ?r (SAMPLE(?p) AS ?path) (SAMPLE(?d) AS ?deviation) { { ?r docent:positionDeviation ?d } UNION { ?r docent:plannedPath ?p } } GROUP BY ?r LIMIT 500`;

export function readWays(rows: readonly Row[]): Map<string, Way> {
  return new Map(
    rows.flatMap((row): [string, Way][] => {
      const deviation = Number(row["deviation"]?.text ?? NaN);
      return row["r"]
        ? [
            [
              row["r"].text,
              {
                path: readWkt(row["path"]?.text ?? "")[0] ?? [],
                deviationM: Number.isFinite(deviation) ? deviation : null,
              },
            ],
          ]
        : [];
    }),
  );
}
export function useWays(): Polled<Map<string, Way>> {
  return useShown(
    "ways",
    async (asOf, signal) => readWays((await query(waysQuery, signal, asOf)).rows),
    1000,
  );
}

// What is left of a path for somebody who stands at `at`: from there on, after the part of the path that is nearest.
export function restOf(path: readonly Point[], at: Point): Point[] {
  if (path.length < 2) return [];
  let nearest = 1;
  let least = Infinity;
  for (let i = 1; i < path.length; i++) {
    const [a, b] = [path[i - 1], path[i]];
    if (!a || !b) continue;
    const [dx, dy] = [b.x - a.x, b.y - a.y];
    const t = Math.max(0, Math.min(1, ((at.x - a.x) * dx + (at.y - a.y) * dy) / (dx * dx + dy * dy || 1)));
    const d = Math.hypot(at.x - a.x - t * dx, at.y - a.y - t * dy);
    if (d < least) {
      least = d;
      nearest = i;
    }
  }
  return [at, ...path.slice(nearest)];
}
