// What the canvas shows of a flow: what the text says, and while the text is broken also the last good parts that it hides.
import { type CawlDocument, flowOf, type Flow, type Link, type Step } from "./document";

export interface ShownFlow {
  flow: Flow;
  steps: (Step & { stale: boolean })[]; // stale: from the last good text; not to be edited now
  links: (Link & { stale: boolean })[];
}

export function shownFlow(document: CawlDocument, good: CawlDocument | null, key: string): ShownFlow | null {
  const now = flowOf(document, key) ?? (key === "" ? document.flows[0] : undefined);
  const last =
    document.problems.length > 0 && good ? (flowOf(good, now?.key ?? key) ?? good.flows[0]) : undefined;
  const flow = now ?? last;
  if (!flow) return null;
  const steps = (now?.steps ?? []).map((step) => ({ ...step, stale: false }));
  const links = (now?.links ?? []).map((link) => ({ ...link, stale: false }));
  const there = new Set(steps.map((s) => s.key));
  const linked = new Set(links.map((l) => l.key));
  for (const step of last?.steps ?? []) if (!there.has(step.key)) steps.push({ ...step, stale: true });
  const names = new Set(steps.map((s) => s.name));
  for (const link of last?.links ?? [])
    if (!linked.has(link.key) && names.has(link.from) && names.has(link.to))
      links.push({ ...link, stale: true });
  return { flow, steps, links };
}

// Steps in the order of the flow, for keys and readers: those that others lead to come later.
export function inFlowOrder<T extends Step>(steps: readonly T[], links: readonly Link[]): T[] {
  const byName = new Map(steps.map((step) => [step.name, step]));
  const after = new Map<string, string[]>();
  for (const link of links) {
    const known = after.get(link.from);
    if (known) known.push(link.to);
    else after.set(link.from, [link.to]);
  }
  const done = new Set<T>();
  const order: T[] = [];
  const queue = steps.filter((s) => s.kind === "source");
  let at = 0;
  const visit = () => {
    for (let step = queue[at++]; step; step = queue[at++]) {
      if (done.has(step)) continue;
      done.add(step);
      order.push(step);
      for (const name of after.get(step.name) ?? []) {
        const next = byName.get(name);
        if (next && !done.has(next) && next.kind !== "sink") queue.push(next);
      }
    }
  };
  visit();
  for (const step of steps) {
    if (done.has(step) || step.kind === "sink") continue;
    queue.length = at = 0;
    queue.push(step);
    visit();
  }
  return [...order, ...steps.filter((s) => !done.has(s))];
}

// Whether links lead from one step to the other.
export function leadsTo(flow: Flow, from: string, to: string): boolean {
  const seen = new Set([from]);
  const queue = [from];
  for (let name = queue.pop(); name !== undefined; name = queue.pop()) {
    if (name === to) return true;
    for (const link of flow.links)
      if (link.from === name && !seen.has(link.to)) {
        seen.add(link.to);
        queue.push(link.to);
      }
  }
  return false;
}
