// Where steps stand on the canvas. A flow whose text has no places is laid out by dagre; one whose author has moved steps keeps
// them where they are, and steps without a place go below what leads to them.
import dagre from "@dagrejs/dagre";
import type { Link, Step } from "./document";
import { conditionRows } from "./phrases";

export interface Place {
  x: number;
  y: number;
}
export const stepWidth = 236;

// Height of a step's card, as the canvas draws it.
export function stepHeight(step: Step): number {
  if (step.kind !== "node") return 36;
  const rows = step.condition ? Math.min(conditionRows(step.condition).length, 2) : 0;
  const more = step.condition && conditionRows(step.condition).length > 2 ? 1 : 0;
  return (
    44 +
    (step.invokes.length > 0 ? Math.min(step.invokes.length, 3) * 26 + 8 : 0) +
    (rows + more > 0 ? (rows + more) * 19 + 13 : 0)
  );
}

export function placed(steps: readonly Step[]): boolean {
  return steps.some((step) => step.position);
}

export function placeSteps(steps: readonly Step[], links: readonly Link[]): Map<string, Place> {
  if (placed(steps)) return keepPlaces(steps, links);
  return steps.length > tidyLimit ? layers(steps, links) : tidyPlaces(steps, links);
}

const tidyLimit = 500; // dagre takes longer than a key press beyond it

// Layers by the distance from the beginning: a layout for flows that are too large for a better one.
function layers(steps: readonly Step[], links: readonly Link[]): Map<string, Place> {
  const after = new Map<string, string[]>();
  for (const link of links) {
    const known = after.get(link.from);
    if (known) known.push(link.to);
    else after.set(link.from, [link.to]);
  }
  const depth = new Map(steps.filter((s) => s.kind === "source").map((s) => [s.name, 0]));
  const queue = [...depth.keys()];
  for (let at = 0; at < queue.length; at++)
    for (const next of after.get(queue[at] ?? "") ?? [])
      if (!depth.has(next)) {
        depth.set(next, (depth.get(queue[at] ?? "") ?? 0) + 1);
        queue.push(next);
      }
  const columns = Math.ceil(Math.sqrt(steps.length));
  const filled = new Map<number, number>();
  return new Map(
    steps.map((step, index) => {
      const row = depth.get(step.name) ?? Math.floor(index / columns);
      const column = filled.get(row) ?? 0;
      filled.set(row, column + 1);
      return [step.key, { x: column * (stepWidth + 44), y: row * 170 }];
    }),
  );
}

function tidyPlaces(steps: readonly Step[], links: readonly Link[]): Map<string, Place> {
  const graph = new dagre.graphlib.Graph({ multigraph: true });
  graph.setGraph({ rankdir: "TB", nodesep: 44, ranksep: 52, edgesep: 24, marginx: 0, marginy: 0 });
  graph.setDefaultEdgeLabel(() => ({}));
  const byName = new Map<string, Step>();
  for (const step of steps) {
    if (!byName.has(step.name)) byName.set(step.name, step);
    graph.setNode(step.key, { width: step.kind === "node" ? stepWidth : 150, height: stepHeight(step) });
  }
  for (const link of links) {
    const from = byName.get(link.from);
    const to = byName.get(link.to);
    if (from && to && from !== to)
      graph.setEdge(
        from.key,
        to.key,
        {
          weight: link.kind === "plain" ? 3 : 1,
          ...(link.kind !== "plain" && { minlen: 1, width: 90, height: 20, labelpos: "c" }),
        },
        link.key,
      );
  }
  dagre.layout(graph);
  return new Map(
    steps.map((step) => {
      const node = graph.node(step.key) as Place; // its middle
      return [
        step.key,
        { x: Math.round(node.x - stepWidth / 2), y: Math.round(node.y - stepHeight(step) / 2) },
      ];
    }),
  );
}

function keepPlaces(steps: readonly Step[], links: readonly Link[]): Map<string, Place> {
  const places = new Map<string, Place>();
  for (const step of steps) if (step.position) places.set(step.key, step.position);
  for (const step of steps) {
    if (places.has(step.key)) continue;
    const before = steps.find(
      (s) => places.has(s.key) && links.some((l) => l.from === s.name && l.to === step.name),
    );
    const at = before ? places.get(before.key) : undefined;
    const bottom = Math.max(
      0,
      ...steps.flatMap((s) => (places.has(s.key) ? [(places.get(s.key)?.y ?? 0) + stepHeight(s)] : [])),
    );
    const wanted = before && at ? { x: at.x, y: at.y + stepHeight(before) + 52 } : { x: 0, y: bottom + 52 };
    places.set(step.key, freePlace(wanted, steps, places, stepHeight(step)));
  }
  return places;
}

// The wanted place, or the next one to the right that no card covers.
export function freePlace(
  wanted: Place,
  steps: readonly Step[],
  places: ReadonlyMap<string, Place>,
  height: number,
): Place {
  const place = { ...wanted };
  for (let turn = 0; turn < 60; turn++) {
    const covered = steps.some((s) => {
      const other = places.get(s.key);
      return (
        other &&
        Math.abs(other.x - place.x) < stepWidth + 16 &&
        place.y < other.y + stepHeight(s) + 12 &&
        other.y < place.y + height + 12
      );
    });
    if (!covered) break;
    place.x += 40;
  }
  return place;
}
