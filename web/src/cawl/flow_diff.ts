// Two versions of a flow put together, for drawing what changes.
import type { Flow, Step } from "./document";

export type Change = "new" | "changed" | "gone";

// The new flow, and the steps and links of the old one that it no longer has.
export function bothFlows(
  before: Flow | undefined,
  after: Flow,
  textOf: (side: "before" | "after", step: Step) => string,
) {
  const old = new Map(before?.steps.map((s) => [s.name, s]));
  const gone = [...old.values()].filter((s) => !after.steps.some((t) => t.name === s.name));
  const changes = new Map<string, Change>(gone.map((s) => [s.name, "gone"]));
  for (const step of after.steps) {
    const was = old.get(step.name);
    if (!was) changes.set(step.name, "new");
    else if (textOf("before", was) !== textOf("after", step)) changes.set(step.name, "changed");
  }
  const has = (links: Flow["links"], link: Flow["links"][number]) =>
    links.some((l) => l.from === link.from && l.to === link.to && l.kind === link.kind);
  const links = [
    ...after.links.map((link) => ({ link, change: has(before?.links ?? [], link) ? "" : "new" })),
    ...(before?.links ?? []).filter((l) => !has(after.links, l)).map((link) => ({ link, change: "gone" })),
  ];
  return { steps: [...after.steps, ...gone.map((s) => ({ ...s, key: `gone ${s.key}` }))], changes, links };
}
