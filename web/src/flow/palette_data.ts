// What a step can do: operations of robots, robot services, and other workflows, as the server has them now.
import { useMemo } from "react";
import { fleet, services, workflows } from "../api/client";
import type { PlainError } from "../api/errors";
import { nameOf } from "../api/labels";
import { usePoll } from "../api/poll";
import { query } from "../api/sparql";
import { kept } from "../api/storage";
import { calledFlow, type Taken } from "../cawl/called";
import { readCawl } from "../cawl/document";
import { words } from "../cawl/names";
import { loadDraft } from "./drafts";

export interface PaletteEntry {
  kind: "operation" | "service" | "workflow";
  id: string; // what an invoke names
  title: string;
  detail: string;
  inputs: Taken[]; // types are IRIs
  outputs?: readonly string[]; // names of its results; absent: not known
  uses?: readonly string[]; // operations and services that a service is made of
  deployed?: number; // of a workflow: the number of the version that new runs begin with
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
    return Array.isArray(stored)
      ? stored.filter((e) => typeof e.id === "string" && Array.isArray(e.inputs))
      : [];
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
  const text = (await liveText(entry.id).catch(() => undefined)) ?? loadDraft(entry.id)?.text;
  const called = text ? calledFlow(readCawl(text), "", () => []) : undefined;
  return called ? { ...entry, inputs: called.takes } : entry;
}
// The text that new runs of a workflow begin with.
export async function liveText(workflow: string, signal?: AbortSignal): Promise<string | undefined> {
  const { versions } = await workflows.listVersions({ workflow, withTexts: true }, signal ? { signal } : {});
  return (versions.find((v) => v.live) ?? versions.at(-1))?.text;
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
    if (name && !inputs.some((i) => i.name === name))
      found.set(operation, [...inputs, { name, type: row["type"]?.text ?? "" }]);
  }
  return found;
}
const outputsQuery = `PREFIX docent: <https://w3id.org/docent#> SELECT DISTINCT ?operation ?name { GRAPH ?g { ?operation docent:inputsKnown true OPTIONAL { ?operation docent:output ?name } } } ORDER BY ?operation ?name LIMIT 2000`;
async function operationOutputs(signal: AbortSignal): Promise<Map<string, string[]>> {
  const found = new Map<string, string[]>();
  for (const row of (await query(outputsQuery, signal)).rows) {
    const operation = decodeURIComponent((row["operation"]?.text ?? "").slice(operationPrefix.length));
    found.set(operation, [...(found.get(operation) ?? []), ...(row["name"]?.text ? [row["name"].text] : [])]);
  }
  return found;
}

// "takes user, booth"
function takes(inputs: PaletteEntry["inputs"]): string {
  return inputs.length > 0 ? `takes ${inputs.map((i) => words(i.name).toLowerCase()).join(", ")}` : "";
}

export function usePalette(): PaletteData {
  const operations = usePoll("operation inputs", operationInputs, 6000);
  const outputs = usePoll("operation outputs", operationOutputs, 30_000);
  const polled = usePoll(
    "palette",
    async (signal) => {
      const [robots, registered, deployed] = await Promise.all([
        fleet.list({}, { signal }),
        services.list({}, { signal }),
        workflows.list({}, { signal }),
      ]);
      const taken = new Set(registered.services.map((s) => s.name));
      const operations = new Map<string, string[]>();
      for (const robot of robots.robots)
        for (const operation of robot.operations)
          operations.set(operation, [
            ...(operations.get(operation) ?? []),
            robot.label || nameOf(robot.robot),
          ]);
      const entries: PaletteEntry[] = [];
      for (const s of registered.services) {
        const inputs =
          s.inputParts.length > 0
            ? s.inputParts.map((p) => ({ name: p.name, type: p.type }))
            : s.inputs.map((name) => ({ name, type: "" }));
        entries.push({
          kind: "service",
          id: s.name,
          title: words(s.name),
          inputs,
          detail: takes(inputs),
          outputs: s.outputParts.map((p) => p.name),
          uses: s.steps.flatMap((step) => [step.operation, step.service]).filter(Boolean),
        });
      }
      for (const [operation, by] of [...operations].sort(([a], [b]) => a.localeCompare(b))) {
        if (taken.has(operation)) continue;
        entries.push({
          kind: "operation",
          id: operation,
          title: words(operation),
          inputs: [],
          detail: by.length > 2 ? `${by.length} robots` : by.join(", "),
        });
      }
      for (const e of importedEntries()) if (!entries.some((known) => known.id === e.id)) entries.push(e);
      for (const w of deployed.workflows)
        entries.push({
          kind: "workflow",
          id: w.name,
          title: words(w.name),
          detail: w.version ? `version ${w.version}` : "",
          inputs: [],
          deployed: w.deployedVersion,
        });
      return entries;
    },
    6000,
  );
  const entries = useMemo(
    () =>
      (polled.data ?? []).map((e): PaletteEntry => {
        const inputs = e.kind === "operation" ? (operations.data?.get(e.id) ?? []) : [];
        const gives = e.kind === "operation" ? outputs.data?.get(e.id) : undefined;
        return {
          ...e,
          ...(inputs.length > 0 && { inputs, detail: [takes(inputs), e.detail].filter(Boolean).join(" · ") }),
          ...(gives && { outputs: gives }),
        };
      }),
    [polled.data, operations.data, outputs.data],
  );
  return {
    entries,
    error: polled.data ? undefined : polled.error,
    loading: !polled.data && !polled.error,
    again: polled.again,
  };
}
