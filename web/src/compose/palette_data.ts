// What a step can do: operations of robots, robot services, and other workflows, as the server has them now.
import { fleet, services, workflows } from "../api/client";
import type { PlainError } from "../api/errors";
import { usePoll } from "../api/poll";
import { words } from "../cawl/names";

export interface PaletteEntry {
  kind: "operation" | "service" | "workflow";
  id: string; // what an invoke names
  title: string;
  detail: string;
  inputs: { name: string; type: string }[]; // types are IRIs
}
export interface PaletteData {
  entries: PaletteEntry[];
  error: PlainError | undefined;
  loading: boolean;
}

export function usePalette(): PaletteData {
  const polled = usePoll("palette", async (signal) => {
    const [robots, registered, deployed] = await Promise.all([fleet.list({}, { signal }), services.list({}, { signal }), workflows.list({}, { signal })]);
    const taken = new Set(registered.services.map((s) => s.name));
    const operations = new Map<string, string[]>();
    for (const robot of robots.robots) for (const operation of robot.operations) operations.set(operation, [...(operations.get(operation) ?? []), robot.label || robot.robot]);
    const entries: PaletteEntry[] = [];
    for (const s of registered.services)
      entries.push({
        kind: "service", id: s.name, title: words(s.name), inputs: s.inputParts.length > 0 ? s.inputParts.map((p) => ({ name: p.name, type: p.type })) : s.inputs.map((name) => ({ name, type: "" })),
        detail: s.inputs.length > 0 ? `needs ${s.inputs.join(", ")}` : "",
      });
    for (const [operation, by] of [...operations].sort(([a], [b]) => a.localeCompare(b)))
      if (!taken.has(operation)) entries.push({ kind: "operation", id: operation, title: words(operation), detail: by.length > 3 ? `${by.length} robots` : by.join(", "), inputs: [] });
    for (const w of deployed.workflows) entries.push({ kind: "workflow", id: w.name, title: words(w.name), detail: w.version ? `version ${w.version}` : "", inputs: [] });
    return entries;
  }, 6000);
  return { entries: polled.data ?? [], error: polled.data ? undefined : polled.error, loading: !polled.data && !polled.error };
}
