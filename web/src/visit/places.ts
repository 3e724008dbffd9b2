// Booths and regions where visitors are and may go, with the point where a robot stands there.
import { query } from "../api/sparql";
import { type Layout, type Point, readLayout, readWkt, shapesQuery } from "../hall/layout";

export interface Place {
  iri: string;
  name: string;
  detail: string; // who exhibits
  booth: boolean;
  at: Point;
}
export interface Places {
  layout: Layout;
  list: Place[];
}

const pointsQuery = `PREFIX docent: <https://w3id.org/docent#> PREFIX geo: <http://www.opengis.net/ont/geosparql#> SELECT ?s ?wkt { ?s docent:servicePoint ?p . ?p geo:asWKT ?wkt } LIMIT 5000`;

export async function readPlaces(language: string, signal: AbortSignal): Promise<Places> {
  const [shapes, points] = await Promise.all([
    query(shapesQuery(language), signal),
    query(pointsQuery, signal),
  ]);
  const layout = readLayout(shapes.rows);
  const stands = new Map(
    points.rows.map((row) => [row["s"]?.text ?? "", readWkt(row["wkt"]?.text ?? "")[0]?.[0]]),
  );
  const list = layout.shapes
    .filter((s) => s.kind === "booth" || s.kind === "region")
    .map((s): Place => ({
      iri: s.iri,
      name: s.name,
      detail: s.detail,
      booth: s.kind === "booth",
      at: stands.get(s.iri) ?? s.label,
    }));
  return {
    layout,
    list: list.sort(
      (a, b) =>
        Number(b.booth) - Number(a.booth) || a.name.localeCompare(b.name, undefined, { numeric: true }),
    ),
  };
}

// The place that an address names: by its IRI, "expo:B05", "B05", or its name.
export function findPlace(list: readonly Place[], named: string): Place | undefined {
  const wanted = named.trim();
  if (wanted === "") return undefined;
  const local = wanted.replace(/^[\w-]*:(?!\/\/)/, "");
  const ends = (iri: string) => iri.slice(Math.max(iri.lastIndexOf("#"), iri.lastIndexOf("/")) + 1);
  return (
    list.find((p) => p.iri === wanted) ??
    list.find((p) => ends(p.iri) === local) ??
    list.find((p) => p.name.toLowerCase() === wanted.toLowerCase())
  );
}

export function placeWords(place: { name: string; detail: string }): string {
  return place.detail ? `${place.name} · ${place.detail}` : place.name;
}
