// What the user does to a flow, from the canvas, the palette or the keys; each one is one edit of the text.
import { shorten } from "../api/sparql";
import {
  flowOf,
  prefixesOf,
  type CawlDocument,
  type Flow,
  type Invoke,
  type Link,
  readCawl,
  type Step,
  viewNamespace,
} from "../cawl/document";
import { Edits, type LinkKind } from "../cawl/edits";
import { applyChanges } from "../cawl/layout_of_text";
import { literally, uniqueName } from "../cawl/names";
import { leadsTo } from "../cawl/shown";
import { freePlace, placed, placeSteps, stepHeight } from "../cawl/placing";
import { toast } from "../ui/toasts";
import { type PaletteEntry, withInputs } from "../flow/palette_data";
import type { Session } from "./session";

export interface AddWhere {
  after?: string; // key of a step that leads to the new one
  link?: string; // key of a link that the new step is put into
  position?: { x: number; y: number };
}
export type NewKind = PaletteEntry | { kind: "empty"; title: string };

export class Actions {
  constructor(
    private readonly session: Session,
    private readonly flowKey: string,
    private readonly select: (keys: string[]) => void,
    private readonly selectLink: (key: string) => void,
    private readonly palette: readonly PaletteEntry[] = [], // tells what is invoked with which values
  ) {}

  private edit<T>(make: (edits: Edits, flow: Flow) => T, said = ""): T | undefined {
    return this.session.edit(this.flowKey, make, said);
  }
  private flow(): Flow | undefined {
    return flowOf(this.session.document, this.flowKey) ?? this.session.document.flows[0];
  }

  // Adds a step, joins it to where it was put, and declares the variables that it takes.
  add(what: NewKind, where: AddWhere = {}) {
    if (what.kind === "workflow" && what.inputs.length === 0)
      void withInputs(what).then((whole) => this.addNow(whole, where));
    else this.addNow(what, where);
  }
  private addNow(what: NewKind, where: AddWhere) {
    const name = this.edit((edits, flow) => {
      const link = flow.links.find((l) => l.key === where.link) ?? this.onlyWayOut(flow, where.after);
      const before = flow.steps.find((s) => s.key === where.after);
      const position =
        where.position && (placed(flow.steps) || (!link && !before))
          ? freePlace(where.position, flow.steps, placeSteps(flow.steps, flow.links), 80)
          : placed(flow.steps)
            ? this.placeFor(flow, link, before)
            : undefined;
      if (position && !placed(flow.steps)) this.pinAll(edits, flow);
      const added = edits.addStep(flow, {
        name: what.kind === "empty" ? what.title || "Step" : what.title,
        ...(what.kind !== "empty" && {
          invoke: {
            kind: what.kind === "workflow" ? ("subflow" as const) : ("operation" as const),
            target: what.id,
          },
        }),
        ...(position && { position }),
      });
      if (link) edits.splice(flow, link, added);
      else if (before) edits.addLink(flow, before.name, added);
      if (what.kind !== "empty") this.declare(edits, flow, what.inputs);
      return added;
    }, `Added ${what.title}`);
    if (name !== undefined) this.select([name]);
  }

  // The one plain link out of a step: what is added after the step goes into it.
  private onlyWayOut(flow: Flow, key: string | undefined): Link | undefined {
    const step = flow.steps.find((s) => s.key === key);
    const out = step ? flow.links.filter((l) => l.from === step.name) : [];
    return out.length === 1 && out[0]?.kind === "plain" ? out[0] : undefined;
  }

  private placeFor(flow: Flow, link: Link | undefined, before: Step | undefined) {
    const places = placeSteps(flow.steps, flow.links);
    const from = before ?? flow.steps.find((s) => s.name === link?.from) ?? flow.steps.at(-1);
    const at = from ? places.get(from.key) : undefined;
    const wanted = at && from ? { x: at.x, y: at.y + stepHeight(from) + 52 } : { x: 0, y: 0 };
    return freePlace(wanted, flow.steps, places, 80);
  }

  // Declares the values that the flow does not have yet.
  private declare(edits: Edits, flow: Flow, inputs: PaletteEntry["inputs"]) {
    const known = new Set([...flow.variables, ...this.session.document.variables].map((v) => v.name));
    for (const input of inputs)
      if (!known.has(input.name))
        edits.addVariable(flow, input.name, shorten(input.type, prefixesOf(this.session.document)));
  }
  // What the step gives to what it does; empty: the value that the run has.
  setInput(invoke: Invoke, input: PaletteEntry["inputs"][number], expression: string) {
    this.edit((edits) => edits.setInput(invoke, input.name, expression));
  }
  // Something more that a step does, with the values that it takes.
  addInvoke(step: Step, entry: PaletteEntry) {
    this.edit((edits, flow) => {
      edits.addInvoke(step, entry.kind === "workflow" ? "subflow" : "operation", entry.id);
      this.declare(edits, flow, entry.inputs);
    });
  }

  // A link that leads back has to say while what: the rest of the language has no loops.
  connect(fromKey: string, toKey: string) {
    const flow = this.flow();
    const from = flow?.steps.find((s) => s.key === fromKey);
    const to = flow?.steps.find((s) => s.key === toKey);
    if (!flow || !from || !to) return;
    const back = leadsTo(flow, to.name, from.name);
    const kind: LinkKind = back ? "while" : "plain";
    const subject = flow.variables[0] ? `$${flow.variables[0].name}` : "?user";
    this.edit(
      (edits, f) => edits.addLink(f, from.name, to.name, kind, `${subject} docent:isAt ?place`),
      `Connected ${from.name} ${back ? "back " : ""}to ${to.name}`,
    );
    const made = this.flow()?.links.findLast((l) => l.from === from.name && l.to === to.name);
    if (back && made) this.selectLink(made.key);
  }

  // A step that exists already is led into a link, where it was dropped on it.
  spliceExisting(linkKey: string, stepKey: string) {
    this.edit((edits, flow) => {
      const link = flow.links.find((l) => l.key === linkKey);
      const step = flow.steps.find((s) => s.key === stepKey);
      if (link && step) edits.splice(flow, link, step.name);
    });
  }

  remove(stepKeys: readonly string[], linkKeys: readonly string[]) {
    const flow = this.flow();
    if (!flow) return;
    const steps = flow.steps.filter((s) => stepKeys.includes(s.key));
    const gone = new Set(steps.map((s) => s.name));
    const links = flow.links.filter((l) => linkKeys.includes(l.key) && !gone.has(l.from) && !gone.has(l.to));
    if (steps.length + links.length === 0) return;
    this.edit(
      (edits, f) => {
        edits.removeSteps(f, steps, true);
        edits.removeLinks(links);
      },
      `Removed ${[...steps.map((s) => s.name), ...links.map((l) => `the link from ${l.from} to ${l.to}`)].join(", ")}`,
    );
    this.select([]);
  }

  rename(step: Step, name: string) {
    const done = this.edit((edits, flow) => (edits.renameStep(flow, step, name), true));
    if (done) this.select([name.trim()]);
  }

  // Steps were moved by hand. From the first move on, all of the flow's steps have places, and nothing moves by itself.
  move(moves: readonly { key: string; x: number; y: number }[]) {
    this.edit((edits, flow) => {
      const moved = new Map(moves.map((m) => [m.key, m]));
      if (!placed(flow.steps)) return this.pinAll(edits, flow, moved);
      edits.moveSteps(
        flow.steps.flatMap((step) => {
          const to = moved.get(step.key);
          return to && (Math.round(to.x) !== step.position?.x || Math.round(to.y) !== step.position?.y)
            ? [{ step, x: to.x, y: to.y }]
            : [];
        }),
      );
    });
  }
  private pinAll(edits: Edits, flow: Flow, moved = new Map<string, { x: number; y: number }>()) {
    const places = placeSteps(flow.steps, flow.links);
    edits.moveSteps(
      flow.steps.flatMap((step) => {
        const place = moved.get(step.key) ?? places.get(step.key);
        return place ? [{ step, ...place }] : [];
      }),
    );
  }

  tidy() {
    const flow = this.flow();
    if (flow && !placed(flow.steps))
      return toast("good", "It is tidy already", "No step of this flow was moved by hand.");
    this.edit((edits, f) => edits.clearPlaces(f), "Tidied up");
    this.session.refreshed++;
  }

  // ---- copy and paste: the XML of the steps, of the links between them, and of the variables that they use ----

  copied(stepKeys: readonly string[]): string {
    const { document } = this.session;
    const flow = this.flow();
    const steps = flow?.steps.filter((s) => stepKeys.includes(s.key) && s.kind === "node") ?? [];
    if (!flow || steps.length === 0) return "";
    const names = new Set(steps.map((s) => s.name));
    const links = flow.links.filter((l) => names.has(l.from) && names.has(l.to));
    const scope = [...(document.root?.scope ?? [])].filter(([prefix]) => prefix !== "xml" && prefix !== "");
    const xml = [...steps, ...links]
      .map((part) => document.text.slice(part.element.from, part.element.to))
      .join("\n");
    const taken = new Set(
      steps.flatMap((s) =>
        s.invokes.flatMap(
          (i) => this.palette.find((e) => e.id === i.target)?.inputs.map((input) => input.name) ?? [],
        ),
      ),
    );
    const variables = [...flow.variables, ...document.variables].filter(
      (v, i, all) =>
        v.name && all.findIndex((w) => w.name === v.name) === i && (taken.has(v.name) || uses(xml, v.name)),
    );
    const parts = [...variables, ...steps, ...links].map(
      (part) => `  ${outdented(document, part.element.from, part.element.to)}`,
    );
    return `<flow name="copied"${scope.map(([prefix, iri]) => ` xmlns:${prefix}="${iri}"`).join("")}>\n${parts.join("\n")}\n</flow>\n`;
  }

  paste(text: string) {
    const fragment = readCawl(`<CAWL name="pasted">\n${text}\n</CAWL>`);
    const source = fragment.flows[0];
    if (!source || fragment.problems.length > 0 || !source.steps.some((s) => s.kind === "node"))
      return toast(
        "bad",
        "There is no step to paste",
        "Copy steps on the canvas first, or the XML of <node> elements.",
      );
    const names = this.edit((edits, flow) => {
      const taken = new Set(flow.steps.map((s) => s.name));
      const renamed = new Map<string, string>();
      for (const [prefix, iri] of source.element.scope)
        if (prefix !== "" && prefix !== "xml" && iri !== viewNamespace) edits.declare(prefix, iri);
      const known = new Set([...flow.variables, ...this.session.document.variables].map((v) => v.name));
      for (const variable of source.variables)
        if (variable.name && !known.has(variable.name))
          edits.addVariableText(flow, outdented(fragment, variable.element.from, variable.element.to));
      for (const step of source.steps.filter((s) => s.kind === "node")) {
        const name = uniqueName(taken, step.name);
        taken.add(name);
        renamed.set(step.name, name);
        const own = readCawl(
          `<CAWL name="x">${scoped(source, outdented(fragment, step.element.from, step.element.to))}</CAWL>`,
        );
        const copy = own.flows[0]?.steps[0];
        if (!copy) continue;
        const inner = new Edits(own);
        inner.set(copy.element, "name", name);
        for (const a of copy.element.attributes)
          if (/^\w+:[xy]$/.test(a.name) && copy.position) inner.set(copy.element, a.name, null);
        const text = applyChanges(own.text, inner.changes);
        const after = readCawl(text).flows[0]?.steps[0];
        if (after) edits.addStepText(flow, text.slice(after.element.from, after.element.to));
      }
      for (const link of source.links) {
        const from = renamed.get(link.from);
        const to = renamed.get(link.to);
        if (from && to) edits.addLinkUnchecked(flow, from, to, link.kind, link.whileText);
      }
      return [...renamed.values()];
    });
    if (names) this.select(names);
  }
}

// "$user", or variable="user", in the text of steps.
function uses(xml: string, name: string): boolean {
  return new RegExp(`[$?]${literally(name)}(?![\\w-])|\\bvariable=["']${literally(name)}["']`).test(xml);
}
function scoped(source: Flow, content: string): string {
  const scope = [...source.element.scope]
    .filter(([prefix]) => prefix !== "" && prefix !== "xml")
    .map(([prefix, iri]) => ` xmlns:${prefix}="${iri}"`)
    .join("");
  return `<flow name="f"${scope}>${content}</flow>`;
}
// The text of an element without the indentation that it has where it stands.
function outdented(document: CawlDocument, from: number, to: number): string {
  const indent = /[ \t]*$/.exec(document.text.slice(0, from))?.[0] ?? "";
  return document.text
    .slice(from, to)
    .replace(/\r\n/g, "\n")
    .split("\n")
    .map((line, i) => (i > 0 && line.startsWith(indent) ? line.slice(indent.length) : line))
    .join("\n");
}
