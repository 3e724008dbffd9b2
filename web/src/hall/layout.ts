// The hall as shapes: read from the graph, where it is described once for robots and people.
import { useShown } from "../api/as_of";
import { nameChosen, namePatterns } from "../api/labels";
import { query, type Row } from "../api/sparql";
import { usePoll, type Polled } from "../api/poll";

export interface Point {
  x: number;
  y: number;
}
export interface Shape {
  iri: string;
  kind: "hall" | "wall" | "pillar" | "booth" | "region" | "counter" | "boothwall";
  name: string;
  detail: string; // who exhibits, what is shown
  rings: Point[][];
  radius: number; // of a point
  label: Point; // where its name stands best
}
export interface Layout {
  shapes: Shape[];
  min: Point;
  max: Point;
}

const prologue =
  "PREFIX docent: <https://w3id.org/docent#> PREFIX geo: <http://www.opengis.net/ont/geosparql#> PREFIX schema: <https://schema.org/> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n";
export const shapesQuery = (
  language = "en",
) => `${prologue}SELECT ?s ?type ?wkt (${nameChosen} AS ?name) (SAMPLE(?r) AS ?radius) (SAMPLE(?e) AS ?exhibitor) {
  ?s geo:hasGeometry ?g ; a ?type . ?g geo:asWKT ?wkt
  VALUES ?type { docent:Hall docent:Wall docent:Pillar docent:Booth docent:Region docent:Counter docent:BoothWall }
  ${namePatterns("?s", language)} OPTIONAL { ?s docent:radius ?r } OPTIONAL { ?s docent:exhibitor ?x . ?x schema:name ?e }
} GROUP BY ?s ?type ?wkt LIMIT 5000`;

// Rings of a POLYGON or MULTIPOLYGON, the points of a LINESTRING, the point of a POINT; an empty list for what can't be read.
export function readWkt(wkt: string): Point[][] {
  const body = wkt.replace(/^<[^>]*>\s*/, "");
  if (!/^(MULTI)?(POLYGON|LINESTRING|POINT)/i.test(body)) return [];
  return (body.match(/\([^()]+\)/g) ?? [])
    .map((ring) =>
      ring
        .slice(1, -1)
        .split(",")
        .flatMap((pair) => {
          const [x, y] = pair.trim().split(/\s+/).map(Number);
          return x !== undefined && y !== undefined && Number.isFinite(x) && Number.isFinite(y)
            ? [{ x, y }]
            : [];
        }),
    )
    .filter((ring) => ring.length > 0);
}

export function readLayout(rows: readonly Row[]): Layout {
  const shapes = new Map<string, Shape>();
  for (const row of rows) {
    const iri = row["s"]?.text ?? "";
    const kind = (row["type"]?.text.replace(/^.*#/, "").toLowerCase() ?? "region") as Shape["kind"];
    const rings = readWkt(row["wkt"]?.text ?? "");
    const known = shapes.get(iri);
    if (rings.length === 0 || (known && kind === "region")) continue; // a booth is a region as well; it is drawn as a booth
    shapes.set(iri, {
      iri,
      kind,
      rings,
      name: row["name"]?.text ?? iri.replace(/^.*[#/]/, ""),
      detail: row["exhibitor"]?.text ?? "",
      radius: Number(row["radius"]?.text ?? 0.3),
      label: centre(rings[0] ?? []),
    });
  }
  const order: Shape["kind"][] = ["hall", "region", "booth", "boothwall", "counter", "pillar", "wall"];
  const sorted = [...shapes.values()].sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind));
  const solid = sorted.filter((s) => ["booth", "wall", "counter", "pillar"].includes(s.kind));
  const regions = sorted.filter((s) => s.kind === "region");
  if (sorted.length <= labelsPlaced)
    for (const s of sorted) if (s.kind === "region") s.label = roomiest(s, solid, regions);
  const counters = sorted.filter((s) => s.kind === "counter");
  if (sorted.length <= labelsPlaced)
    for (const s of sorted) if (s.kind === "booth") s.label = clearOf(s, counters);
  const points = sorted.flatMap((s) => s.rings.flat());
  const xs = points.map((p) => p.x);
  const ys = points.map((p) => p.y);
  return {
    shapes: sorted,
    min: { x: Math.min(0, ...xs), y: Math.min(0, ...ys) },
    max: { x: Math.max(1, ...xs), y: Math.max(1, ...ys) },
  };
}

const labelsPlaced = 600; // shapes of a layout whose names are placed with care

// The point of a grid over the shape that is farthest from its edges and from what stands in it; names are wider than high.
function roomiest(shape: Shape, solid: readonly Shape[], regions: readonly Shape[]): Point {
  const ring = shape.rings[0] ?? [];
  const [xs, ys] = [ring.map((p) => p.x), ring.map((p) => p.y)];
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const others = regions.filter((s) => s !== shape).flatMap((s) => (s.rings[0] ? [s.rings[0]] : []));
  const near = solid
    .filter(
      (s) =>
        s !== shape &&
        s.rings[0]?.some((p) => p.x >= x0 - 2 && p.x <= x1 + 2 && p.y >= y0 - 2 && p.y <= y1 + 2),
    )
    .flatMap((s) => (s.rings[0] ? [s.rings[0]] : []));
  let best = shape.label;
  let most = -1;
  const cells = 22;
  for (let i = 1; i < cells; i++)
    for (let j = 1; j < cells; j++) {
      const p = { x: x0 + ((x1 - x0) * i) / cells, y: y0 + ((y1 - y0) * j) / cells };
      if (!inside(p, ring) || near.some((other) => inside(p, other))) continue;
      const room =
        Math.min(...[ring, ...near, ...others].map((edges) => distance(p, edges)), 3) -
        Math.hypot(p.x - shape.label.x, p.y - shape.label.y) * 0.02;
      if (room > most) {
        most = room;
        best = p;
      }
    }
  return best;
}

const [nameHigh, letterWide] = [2.4, 0.3]; // of a booth's name with its exhibitor, in metres

// The point nearest to the middle where the name of a booth covers least of the furniture in it.
function clearOf(booth: Shape, counters: readonly Shape[]): Point {
  const edges = (ring: readonly Point[]) => ({
    x0: Math.min(...ring.map((p) => p.x)),
    x1: Math.max(...ring.map((p) => p.x)),
    y0: Math.min(...ring.map((p) => p.y)),
    y1: Math.max(...ring.map((p) => p.y)),
  });
  const own = edges(booth.rings[0] ?? []);
  const near = counters
    .flatMap((c) => (c.rings[0] ? [edges(c.rings[0])] : []))
    .filter((c) => c.x1 > own.x0 && c.x0 < own.x1 && c.y1 > own.y0 && c.y0 < own.y1);
  if (near.length === 0) return booth.label;
  const oneLine = booth.detail.length * letterWide <= own.x1 - own.x0;
  const longest = Math.max(
    booth.name.length * 1.4,
    ...(oneLine ? [booth.detail] : booth.detail.split(" ")).map((word) => word.length),
  );
  const above = booth.detail ? 0.4 : 0; // of the middle of name and exhibitor: there the name stands
  const half = {
    x: Math.min((own.x1 - own.x0) / 2 - 0.1, (longest * letterWide) / 2 + 0.2),
    y: Math.min((own.y1 - own.y0) / 2 - 0.1, nameHigh / 2),
  };
  let best = booth.label;
  let least = Infinity;
  const steps = 12;
  for (let i = 0; i <= steps; i++)
    for (let j = 0; j <= steps; j++) {
      const p = {
        x: own.x0 + half.x + ((own.x1 - own.x0 - 2 * half.x) * i) / steps,
        y: own.y0 + half.y + ((own.y1 - own.y0 - 2 * half.y) * j) / steps,
      };
      const covered = near.reduce(
        (sum, c) =>
          sum +
          Math.max(0, Math.min(c.x1, p.x + half.x) - Math.max(c.x0, p.x - half.x)) *
            Math.max(0, Math.min(c.y1, p.y + half.y) - Math.max(c.y0, p.y - half.y)),
        0,
      );
      const cost = covered * 5 + Math.hypot(p.x - booth.label.x, p.y + above - booth.label.y);
      if (cost < least) [best, least] = [{ x: p.x, y: p.y + above }, cost];
    }
  return best;
}

export function inside(p: Point, ring: readonly Point[]): boolean {
  let odd = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [a, b] = [ring[i], ring[j]];
    if (a && b && a.y > p.y !== b.y > p.y && p.x < ((b.x - a.x) * (p.y - a.y)) / (b.y - a.y) + a.x)
      odd = !odd;
  }
  return odd;
}

// To the nearest edge, with heights counted double.
function distance(p: Point, ring: readonly Point[]): number {
  let least =
    ring.length === 1 && ring[0] ? Math.hypot(p.x - ring[0].x, (p.y - ring[0].y) * 2) - 0.5 : Infinity;
  for (let i = 1; i < ring.length; i++) {
    const [a, b] = [ring[i - 1], ring[i]];
    if (!a || !b) continue;
    const [dx, dy] = [b.x - a.x, (b.y - a.y) * 2];
    const t = Math.max(0, Math.min(1, ((p.x - a.x) * dx + (p.y - a.y) * 2 * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, Math.hypot(p.x - a.x - t * dx, (p.y - a.y) * 2 - t * dy));
  }
  return least;
}

export function useLayout(): Polled<Layout> {
  return usePoll("layout", async (signal) => readLayout((await query(shapesQuery(), signal)).rows), 60_000);
}

export interface Person {
  iri: string;
  name: string;
  at: string; // IRI of a region
  x: number | null;
  y: number | null;
}
const peopleQuery = `${prologue}SELECT ?p (${nameChosen} AS ?name) (SAMPLE(?r) AS ?region) (SAMPLE(?px) AS ?x) (SAMPLE(?py) AS ?y) {
  { ?p a docent:Visitor } UNION { ?p a docent:Person } OPTIONAL { ?p docent:isAt ?r } ${namePatterns("?p")} OPTIONAL { ?p docent:x ?px ; docent:y ?py } FILTER(isIRI(?p))
} GROUP BY ?p LIMIT 500`;

async function askPeople(asOf: string, signal: AbortSignal): Promise<Person[]> {
  return (await query(peopleQuery, signal, asOf)).rows.map((row) => ({
    iri: row["p"]?.text ?? "",
    name: row["name"]?.text ?? "",
    at: row["region"]?.text ?? "",
    x: row["x"] ? Number(row["x"].text) : null,
    y: row["y"] ? Number(row["y"].text) : null,
  }));
}
export function usePeople(): Polled<Person[]> {
  return useShown("people", askPeople, 2000);
}

export function centre(ring: readonly Point[]): Point {
  const xs = ring.map((p) => p.x);
  const ys = ring.map((p) => p.y);
  return { x: (Math.min(...xs) + Math.max(...xs)) / 2, y: (Math.min(...ys) + Math.max(...ys)) / 2 };
}
