// What a step can do: operations of robots, robot services, and other workflows, as the server has them now.
import { useMemo } from "react";
import { fleet, services, workflows } from "../api/client";
import type { PlainError } from "../api/errors";
import { nameOf } from "../api/labels";
import { usePoll } from "../api/poll";
import { query } from "../api/sparql";
import { kept } from "../api/storage";
import { prefixesOf, readCawl } from "../cawl/document";
import { words } from "../cawl/names";
import { needOf, startFlow } from "../cawl/start_values";
import { loadDraft } from "./drafts";

export interface PaletteEntry {
  kind: "operation" | "service" | "workflow";
  id: string; // what an invoke names
  title: string;
  detail: string;
  inputs: { name: string; type: string; optional?: boolean }[]; // types are IRIs
  uses?: readonly string[]; // operations and services that a service is made of
}
export interface PaletteData {
  entries: PaletteEntry[];
  error: PlainError | undefined;
  loading: boolean;
  again: () => void;
}

// What was imported from elsewhere, kept in this browser.
const importedKey = "docent.imported";
export function importedEntries(): PaletteEntry[] {
  try {
    const stored = JSON.parse(kept.getItem(importedKey) ?? "[]") as PaletteEntry[];
    return Array.isArray(stored) ? stored.filter((e) => typeof e.id === "string" && Array.isArray(e.inputs)) : [];
  } catch {
    return [];
  }
}
export function keepImported(entries: readonly PaletteEntry[]) {
  const known = importedEntries().filter((e) => !entries.some((n) => n.id === e.id));
  kept.setItem(importedKey, JSON.stringify([...known, ...entries].slice(-500)));
}

// A workflow with the values that it begins with, so that the flow that reuses it has them, too.
export async function withInputs(entry: PaletteEntry): Promise<PaletteEntry> {
  if (entry.kind !== "workflow" || entry.inputs.length > 0) return entry;
  const text = await workflows.listVersions({ workflow: entry.id, withTexts: true }).then((r) => (r.versions.find((v) => v.live) ?? r.versions.at(-1))?.text, () => undefined) ?? loadDraft(entry.id)?.text;
  if (!text) return entry;
  const document = readCawl(text);
  const flow = startFlow(document);
  const prefixes = prefixesOf(document);
  return {
    ...entry,
    inputs: (flow?.variables ?? []).filter((v) => v.name && ["needed", "any"].includes(needOf(v, flow, text))).map((v) => {
      const colon = v.type.indexOf(":");
      return { name: v.name, type: colon > 0 ? (prefixes.get(v.type.slice(0, colon)) ?? "") + v.type.slice(colon + 1) : "", ...(needOf(v, flow, text) === "any" && { optional: true }) };
    }),
  };
}

// What robots say that their operations take, by the operation's name.
const inputsQuery = `PREFIX docent: <https://w3id.org/docent#> SELECT DISTINCT ?operation ?name ?type { GRAPH ?g { ?operation docent:inputsKnown true ; docent:input ?name OPTIONAL { ?operation docent:inputPart ?part . ?part docent:partName ?name ; docent:partType ?type } } } ORDER BY ?operation ?name LIMIT 2000`;
const operationPrefix = "urn:docent:operation:";
async function operationInputs(signal: AbortSignal): Promise<Map<string, PaletteEntry["inputs"]>> {
  const found = new Map<string, PaletteEntry["inputs"]>();
  for (const row of (await query(inputsQuery, signal)).rows) {
    const operation = decodeURIComponent((row["operation"]?.text ?? "").slice(operationPrefix.length));
    const name = row["name"]?.text ?? "";
    const inputs = found.get(operation) ?? [];
    if (name && !inputs.some((i) => i.name === name)) found.set(operation, [...inputs, { name, type: row["type"]?.text ?? "" }]);
  }
  return found;
}

// "takes user, booth"
function takes(inputs: PaletteEntry["inputs"]): string {
  return inputs.length > 0 ? `takes ${inputs.map((i) => words(i.name).toLowerCase()).join(", ")}` : "";
}

export function usePalette(): PaletteData {
  const operations = usePoll("operation inputs", operationInputs, 6000);
  const polled = usePoll("palette", async (signal) => {
    const [robots, registered, deployed] = await Promise.all([fleet.list({}, { signal }), services.list({}, { signal }), workflows.list({}, { signal })]);
    const taken = new Set(registered.services.map((s) => s.name));
    const operations = new Map<string, string[]>();
    for (const robot of robots.robots) for (const operation of robot.operations) operations.set(operation, [...(operations.get(operation) ?? []), robot.label || nameOf(robot.robot)]);
    const entries: PaletteEntry[] = [];
    for (const s of registered.services) {
      const inputs = s.inputParts.length > 0 ? s.inputParts.map((p) => ({ name: p.name, type: p.type })) : s.inputs.map((name) => ({ name, type: "" }));
      entries.push({ kind: "service", id: s.name, title: words(s.name), inputs, detail: takes(inputs), uses: s.steps.flatMap((step) => [step.operation, step.service]).filter(Boolean) });
    }
    for (const [operation, by] of [...operations].sort(([a], [b]) => a.localeCompare(b))) {
      if (taken.has(operation)) continue;
      entries.push({ kind: "operation", id: operation, title: words(operation), inputs: [], detail: by.length > 2 ? `${by.length} robots` : by.join(", ") });
    }
    for (const e of importedEntries()) if (!entries.some((known) => known.id === e.id)) entries.push(e);
    for (const w of deployed.workflows) entries.push({ kind: "workflow", id: w.name, title: words(w.name), detail: w.version ? `version ${w.version}` : "", inputs: [] });
    return entries;
  }, 6000);
  const entries = useMemo(() => (polled.data ?? []).map((e): PaletteEntry => {
    const inputs = e.kind === "operation" ? (operations.data?.get(e.id) ?? []) : [];
    return inputs.length > 0 ? { ...e, inputs, detail: [takes(inputs), e.detail].filter(Boolean).join(" · ") } : e;
  }), [polled.data, operations.data]);
  return { entries, error: polled.data ? undefined : polled.error, loading: !polled.data && !polled.error, again: polled.again };
}
