// The flows that the steps of the open document run: of the document itself, and of workflows as the server has them now. What they
// take and nothing gives them is a finding: the server checks each document alone.
import { useMemo } from "react";
import { usePoll } from "../api/poll";
import { shorten } from "../api/sparql";
import { useStable } from "../api/stable";
import { type Called, calledFlow, type Gives, unsetInputs, type Unset } from "../cawl/called";
import { type CawlDocument, prefixesOf, readCawl } from "../cawl/document";
import { Edits } from "../cawl/edits";
import { words } from "../cawl/names";
import type { Finding } from "./findings";
import { liveText, type PaletteEntry } from "../flow/palette_data";
import { termName } from "../facts/term_name";
import type { Vocabulary } from "../facts/vocabulary";

const texts = new Map<string, string>(); // of deployed versions: "NAME 3"
const againMs = 60_000;

// By the names that invokes have for them.
export type CalledFlows = ReadonlyMap<string, Called>;

export function useCalledFlows(document: CawlDocument, palette: readonly PaletteEntry[]): CalledFlows {
  const own = useStable(new Set(document.flows.map((f) => f.name)));
  const targets = useStable(
    [
      ...new Set(
        document.flows.flatMap((f) =>
          f.steps.flatMap((s) => s.invokes.filter((i) => i.kind === "subflow").map((i) => i.target)),
        ),
      ),
    ].sort(),
  );
  const deployed = new Map(palette.filter((e) => e.kind === "workflow").map((e) => [e.id, e.deployed ?? 0]));
  const versions = targets
    .filter((target) => !own.has(target) && deployed.has(workflowOf(target)))
    .map((target): [string, string] => [
      workflowOf(target),
      `${workflowOf(target)} ${deployed.get(workflowOf(target))}`,
    ]);
  const wanted = new Map(versions);
  const key = [...wanted.values()].join("\n");
  const polled = usePoll(
    key && `called flows\n${key}`,
    async (signal) => {
      const found = new Map<string, string>();
      for (const [name, version] of wanted) {
        const text = texts.get(version) ?? (await liveText(name, signal).catch(() => undefined));
        if (!text) continue;
        texts.set(version, text);
        found.set(name, text);
      }
      return found;
    },
    againMs,
  );
  const textOf = polled.data;
  return useMemo(() => {
    const gives = givesOf(palette);
    const called = new Map<string, Called>();
    for (const target of targets) {
      const local = own.has(target);
      const text = local ? "" : textOf?.get(workflowOf(target));
      const found = local
        ? calledFlow(document, target, gives)
        : text
          ? calledFlow(readCawl(text), target.split("/")[1] ?? "", gives)
          : undefined;
      if (found) called.set(target, found);
    }
    return called;
  }, [document, palette, own, targets, textOf]);
}

function workflowOf(target: string): string {
  return target.split("/")[0] ?? target;
}
// What an invoke gives, as far as it is known.
export function givesOf(palette: readonly PaletteEntry[], called: CalledFlows = new Map()): Gives {
  return (invoke) =>
    invoke.kind === "subflow"
      ? called.get(invoke.target)?.gives
      : palette.find((e) => e.id === invoke.target && e.kind !== "workflow")?.outputs;
}

export function unsetFindings(
  document: CawlDocument,
  called: CalledFlows,
  palette: readonly PaletteEntry[],
  vocabulary: Vocabulary,
): Finding[] {
  if (document.problems.length > 0) return [];
  const prefixes = prefixesOf(document);
  const isA = (term: string, type: string) =>
    vocabulary.things.some((t) => t.term === term && t.classes?.includes(shorten(type, prefixes)));
  return unsetInputs(document, called, givesOf(palette, called), isA).map((unset): Finding => {
    const { flow, step, invoke, input, named } = unset;
    const target = words(invoke.target);
    const [only, ...more] = named;
    const remedy = only && more.length === 0 ? only : "";
    return {
      id: `unset ${flow.key} ${step.key} ${invoke.element.from} ${input.name}`,
      error: false,
      rule: "unset-input",
      message: `The value ${input.name} is never set before: ${target} then ${thenWords(unset, shorten(input.type, prefixes))}.`,
      hint: remedy
        ? `The situation that starts it names ${termName(remedy, prefixes)}. The run can begin with it.`
        : "Give the step a value, or let the situation that starts the flow find one.",
      from: invoke.element.from,
      to: invoke.element.openTo,
      flow: flow.key,
      step: step.key,
      link: "",
      of: document.text,
      fix: remedy ? begins(document, unset, remedy) : [],
      ...(remedy && { remedy: `Set ${input.name} to ${termName(remedy, prefixes)}` }),
    };
  });
}
function thenWords({ input }: Unset, type: string): string {
  const kind = type ? words(type.replace(/^[\w-]+:/, "")) : "";
  return input.matched ? `takes any ${kind || "that fits"}` : `has none`;
}
function begins(document: CawlDocument, { flow, input }: Unset, term: string): Finding["fix"] {
  const edits = new Edits(document);
  edits.setInitial(flow, input.name, term, shorten(input.type, prefixesOf(document)));
  return edits.changes.map(({ from, to, insert }) => ({ from, to, insert }));
}
