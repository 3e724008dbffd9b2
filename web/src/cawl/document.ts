// Model of a CAWL document, read from its text. The text is the only truth: a model is never changed, it is read again. Every
// part knows its element, so that an edit (edits.ts) can say which characters it replaces.
import type { ChangedRange } from "@lezer/common";
import { wellKnownPrefixes } from "../api/well_known";
import {
  attribute,
  attributeNs,
  ownText,
  parseXml,
  type TextProblem,
  type XmlElement,
  type XmlText,
} from "./xml";

export const extNamespace = "https://w3id.org/docent/cawl-ext#";
// Where the canvas keeps places of nodes: a namespace of an editor, in which the server looks at nothing.
export const viewNamespace = "urn:cawl-view";

export interface Part {
  element: XmlElement;
}
export interface Variable extends Part {
  name: string;
  type: string;
  initial: string; // its first <from expression>; empty: none
}
// The subject, verb or object of a constraint.
export interface Slot {
  element: XmlElement | null; // null: it is not there
  text: string;
  type: string;
}
export interface Constraint extends Part {
  name: string;
  subject: Slot;
  verb: Slot;
  object: Slot;
}
// <ext:time between="09:00-17:00"/>: what its attributes say, as they are written.
export interface Time extends Part {
  name: string;
  attributes: readonly (readonly [name: string, value: string])[];
}
export interface Rule extends Part {
  name: string;
  expression: string;
  lasting: string; // ext:for
  constraints: Constraint[];
  times: Time[];
}
export interface Context extends Part {
  name: string;
  priority: string;
  rules: Rule[];
  times: Time[]; // beside its rules
}
export interface Condition extends Part {
  expression: string;
  timeout: string;
  contexts: Context[];
  events: string[]; // operations of its case
  caseElement: XmlElement | null;
  caseName: string;
  caseExpression: string;
}
export interface Invoke extends Part {
  kind: "operation" | "subflow";
  target: string;
  timeout: string;
  retry: string;
  inputs: Input[];
}
// What is invoked gets this as its input: <ext:input part="text" expression='"Hello"'/>. Of <ext:input part="place" variable="stand"/>,
// the expression is "$stand".
export interface Input extends Part {
  part: string;
  expression: string;
}
export interface Step extends Part {
  kind: "source" | "node" | "sink";
  key: string; // unique in its flow: the name, with a number where a name stands twice
  name: string;
  documentation: string;
  documentationElement: XmlElement | null;
  invokes: Invoke[];
  condition: Condition | null;
  join: string;
  waits: XmlElement[];
  timeout: string;
  retry: string;
  forEach: string;
  sequential: string;
  whileHolds: string;
  position: { x: number; y: number } | null;
  whole: boolean; // no mistake of the text lies in it
}
export interface Link extends Part {
  key: string;
  from: string; // names of steps
  to: string;
  kind: "plain" | "while" | "failure" | "interrupt";
  whileText: string;
}
export interface Flow extends Part {
  key: string;
  name: string;
  documentation: string;
  variables: Variable[];
  steps: Step[];
  links: Link[];
}
export interface Activator extends Part {
  name: string;
  flow: string;
  variables: Variable[];
  condition: Condition | null;
}
export interface CawlDocument {
  xml: XmlText;
  text: string;
  root: XmlElement | null; // null: no <CAWL> is there
  problems: TextProblem[];
  name: string;
  version: string;
  documentation: string;
  variables: Variable[];
  activator: Activator | null;
  flows: Flow[];
}

export function readCawl(
  text: string,
  before?: CawlDocument,
  changed?: readonly ChangedRange[],
): CawlDocument {
  const xml = parseXml(text, before?.xml, changed);
  const problems = [...xml.problems];
  const root = xml.root && (xml.root.local === "CAWL" || xml.root.local === "cawl") ? xml.root : null;
  if (xml.root && !root && xml.root.whole)
    problems.push({
      from: xml.root.from,
      to: xml.root.openTo,
      message: `The root element is <${xml.root.name}>; a workflow begins with <CAWL name="…">.`,
    });
  if (!root)
    return {
      xml,
      text,
      root,
      problems,
      name: "",
      version: "",
      documentation: "",
      variables: [],
      activator: null,
      flows: [],
    };
  return new Reader(text, root, problems).document(xml);
}

class Reader {
  constructor(
    private readonly text: string,
    private readonly root: XmlElement,
    private readonly problems: TextProblem[],
  ) {}

  document(xml: XmlText): CawlDocument {
    const activator = this.children(this.root, "activator")[0];
    const keys = new Keys();
    return {
      xml,
      text: this.text,
      root: this.root,
      problems: this.problems,
      name: this.get(this.root, "name"),
      version: this.get(this.root, "version"),
      documentation: this.documentation(this.root),
      variables: this.variables(this.root),
      activator: activator ? this.activator(activator) : null,
      flows: this.children(this.root, "flow").map((element) => this.flow(element, keys)),
    };
  }

  // Whether the element is one of CAWL's, and not of an editor or another tool.
  private own(element: XmlElement): boolean {
    return element.namespace === "" || element.namespace === this.root.namespace;
  }
  private children(element: XmlElement, ...locals: string[]): XmlElement[] {
    return element.children.filter((child) => locals.includes(child.local) && this.own(child));
  }
  private get(element: XmlElement, name: string): string {
    return attribute(element, name)?.value.trim() ?? "";
  }
  private ext(element: XmlElement, local: string): string {
    return attributeNs(element, extNamespace, local)?.value.trim() ?? "";
  }
  private documentation(element: XmlElement): string {
    const found = this.children(element, "documentation")[0];
    return found ? ownText(this.text, found).replace(/\s+/g, " ") : "";
  }

  private variables(element: XmlElement): Variable[] {
    return this.children(element, "variable").map((v) => {
      const from = this.children(v, "initialize").flatMap((i) => this.children(i, "from"))[0];
      return {
        element: v,
        name: this.get(v, "name"),
        type: this.get(v, "type"),
        initial: from ? this.get(from, "expression") : "",
      };
    });
  }

  private activator(element: XmlElement): Activator {
    const activate = this.children(element, "activate")[0];
    return {
      element,
      name: this.get(element, "name"),
      flow: activate ? this.get(activate, "flow") : "",
      variables: this.variables(element),
      condition: this.conditionOf(element),
    };
  }

  private conditionOf(element: XmlElement): Condition | null {
    const found = this.children(element, "condition")[0];
    if (!found) return null;
    const caseElement = this.children(found, "case")[0] ?? null;
    return {
      element: found,
      expression: this.get(found, "expression"),
      timeout: this.ext(found, "timeout"),
      caseElement,
      caseName: caseElement ? this.get(caseElement, "name") : "",
      caseExpression: caseElement ? this.get(caseElement, "expression") : "",
      events: caseElement ? this.children(caseElement, "event").map((e) => this.get(e, "operation")) : [],
      contexts: this.children(found, "context").map((context) => ({
        element: context,
        name: this.get(context, "name"),
        priority: this.get(context, "priority"),
        rules: this.children(context, "rule").map((rule) => this.rule(rule)),
        times: this.times(context),
      })),
    };
  }

  private rule(element: XmlElement): Rule {
    return {
      element,
      name: this.get(element, "name"),
      expression: this.get(element, "expression"),
      lasting: this.ext(element, "for"),
      times: this.times(element),
      constraints: this.children(element, "constraint").map((c) => ({
        element: c,
        name: this.get(c, "name"),
        subject: this.slot(c, "subject"),
        verb: this.slot(c, "verb"),
        object: this.slot(c, "object"),
      })),
    };
  }

  private times(element: XmlElement): Time[] {
    return element.children
      .filter((c) => c.local === "time" && c.namespace === extNamespace)
      .map((time) => ({
        element: time,
        name: this.get(time, "name"),
        attributes: time.attributes
          .filter((a) => a.name !== "name")
          .map((a) => [a.name, a.value.trim()] as const),
      }));
  }

  private slot(constraint: XmlElement, local: string): Slot {
    const element = this.children(constraint, local)[0];
    return element
      ? { element, text: ownText(this.text, element), type: this.get(element, "type") }
      : { element: null, text: "", type: "" };
  }

  private flow(element: XmlElement, flowKeys: Keys): Flow {
    const keys = new Keys();
    const linkKeys = new Keys();
    return {
      element,
      key: flowKeys.next(this.get(element, "name")),
      name: this.get(element, "name"),
      documentation: this.documentation(element),
      variables: this.variables(element),
      steps: this.children(element, "source", "node", "sink").map((step) => this.step(step, keys)),
      links: this.children(element, "link").map((link) => this.link(link, linkKeys)),
    };
  }

  private step(element: XmlElement, keys: Keys): Step {
    const waits = this.children(element, "wait");
    const documentationElement = this.children(element, "documentation")[0] ?? null;
    return {
      element,
      kind: element.local as Step["kind"],
      key: keys.next(this.get(element, "name")),
      name: this.get(element, "name"),
      documentation: this.documentation(element),
      documentationElement,
      waits,
      join: waits
        .map((w) => this.get(w, "joinCondition"))
        .filter(Boolean)
        .join(" and "),
      invokes: this.children(element, "invoke").map((i) => this.invoke(i)),
      condition: this.conditionOf(element),
      timeout: this.ext(element, "timeout"),
      retry: this.ext(element, "retry"),
      forEach: this.ext(element, "forEach"),
      sequential: this.ext(element, "sequential"),
      whileHolds: this.ext(element, "while-holds"),
      position: this.position(element),
      whole: !this.problems.some((p) => p.from < element.to && p.to > element.from),
    };
  }

  private position(element: XmlElement): Step["position"] {
    const x = Number(attributeNs(element, viewNamespace, "x")?.value ?? NaN);
    const y = Number(attributeNs(element, viewNamespace, "y")?.value ?? NaN);
    return Number.isFinite(x) && Number.isFinite(y) ? { x, y } : null;
  }

  private invoke(element: XmlElement): Invoke {
    const subflow = this.get(element, "subflow");
    return {
      element,
      kind: subflow ? "subflow" : "operation",
      target: subflow || this.get(element, "operation"),
      timeout: this.ext(element, "timeout"),
      retry: this.ext(element, "retry"),
      inputs: element.children
        .filter((c) => c.local === "input" && c.namespace === extNamespace)
        .map((c) => this.input(c)),
    };
  }

  private input(element: XmlElement): Input {
    const variable = this.get(element, "variable");
    return {
      element,
      part: this.get(element, "part"),
      expression: variable ? `$${variable}` : this.get(element, "expression"),
    };
  }

  private link(element: XmlElement, keys: Keys): Link {
    const from = this.get(element, "from");
    const to = this.get(element, "to");
    const whileText = this.ext(element, "while");
    const kind =
      this.ext(element, "onFailure") === "true"
        ? "failure"
        : this.ext(element, "onInterrupt") === "true"
          ? "interrupt"
          : whileText
            ? "while"
            : "plain";
    return { element, from, to, kind, whileText, key: keys.next(`${from} → ${to}`) };
  }
}

// Makes keys of names: a name that comes again gets a number.
class Keys {
  private readonly seen = new Map<string, number>();
  next(name: string): string {
    const count = (this.seen.get(name) ?? 0) + 1;
    this.seen.set(name, count);
    return count === 1 ? name : `${name} #${count}`;
  }
}

export function flowOf(document: CawlDocument, key: string): Flow | undefined {
  return document.flows.find((flow) => flow.key === key);
}
export function stepOf(flow: Flow, key: string): Step | undefined {
  return flow.steps.find((step) => step.key === key);
}
// Prefixes that may stand in the document's words.
export function prefixesOf(document: CawlDocument): Map<string, string> {
  const prefixes = new Map(Object.entries(wellKnownPrefixes));
  for (const [prefix, iri] of document.root?.scope ?? [])
    if (prefix !== "" && prefix !== "xml" && iri !== viewNamespace && iri !== extNamespace)
      prefixes.set(prefix, iri);
  return prefixes;
}
// The part around an offset, of parts in the order of the text.
function partOf<T extends Part>(parts: readonly T[], offset: number): T | undefined {
  let low = 0;
  let high = parts.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((parts[middle]?.element.to ?? 0) < offset) low = middle + 1;
    else high = middle;
  }
  const found = parts[low];
  return found && found.element.from <= offset ? found : undefined;
}
// The smallest step or link at an offset of the text, for findings and the caret.
export function partAt(
  document: CawlDocument,
  offset: number,
): { flow: Flow; step?: Step; link?: Link } | null {
  for (const flow of document.flows) {
    if (offset < flow.element.from || offset > flow.element.to) continue;
    const step = partOf(flow.steps, offset);
    const link = step ? undefined : partOf(flow.links, offset);
    return { flow, ...(step && { step }), ...(link && { link }) };
  }
  return null;
}
