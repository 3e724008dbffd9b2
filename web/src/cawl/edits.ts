// Edits of a CAWL document as changes of its text. Each edit replaces as few characters as it can: comments, order and spacing
// outside stay byte for byte. An `Edits` collects changes against one text; they are applied together, as one step of undo.
import {
  type CawlDocument,
  type Condition,
  type Constraint,
  type Context,
  type Flow,
  type Invoke,
  type Link,
  type Rule,
  type Slot,
  type Step,
  extNamespace,
  viewNamespace,
} from "./document";
import { type Change, type Piece, TextLayout } from "./layout_of_text";
import { quoteName, renameInExpression, uniqueName } from "./names";
import { attribute, attributeNs, encodeAttribute, type XmlElement } from "./xml";

// Says why an edit can't be made now, for people.
export class EditRefused extends Error {}

export interface NewStep {
  name: string;
  invoke?: { kind: "operation" | "subflow"; target: string };
  position?: { x: number; y: number };
  documentation?: string;
}
export type LinkKind = Link["kind"];

export class Edits {
  readonly changes: Change[] = [];
  private readonly layout: TextLayout;
  private readonly root: XmlElement;
  private readonly declared = new Map<string, string>();
  private readonly taken = new Map<string, Set<string>>();

  constructor(document: CawlDocument) {
    if (!document.root) throw new EditRefused("The text has no <CAWL> element to edit.");
    this.root = document.root;
    this.layout = new TextLayout(document.text, document.root);
  }

  // ---- steps and links ----

  // Adds a node to the flow and returns its name, which differs from the wanted one where that is taken.
  addStep(flow: Flow, step: NewStep): string {
    this.mustBeWhole(flow.element);
    const name = this.freshName(flow, step.name);
    const children: Piece[] = [];
    if (step.documentation) children.push({ name: "documentation", text: step.documentation });
    if (step.invoke) children.push({ name: "invoke", attributes: [[step.invoke.kind, step.invoke.target]] });
    const attributes: [string, string][] = [["name", name]];
    if (step.position)
      attributes.push(
        [this.prefixed(viewNamespace, "view", "x"), round(step.position.x)],
        [this.prefixed(viewNamespace, "view", "y"), round(step.position.y)],
      );
    this.insertStep(flow, (indent) => this.layout.render({ name: "node", attributes, children }, indent));
    return name;
  }

  // Puts the written XML of a node into the flow, as pasting does.
  addStepText(flow: Flow, written: string) {
    this.mustBeWhole(flow.element);
    this.insertStep(flow, (indent) =>
      written
        .split("\n")
        .map((line, i) => (i === 0 || line.trim() === "" ? line : indent + line))
        .join(this.layout.newline),
    );
  }

  private insertStep(flow: Flow, content: (indent: string) => string) {
    const after =
      flow.steps.findLast((s) => s.kind === "node") ?? flow.steps.find((s) => s.kind === "source");
    const before = flow.steps.find((s) => s.kind === "sink") ?? flow.links[0];
    if (after) this.push(this.layout.insertAfter(after.element, content, true));
    else if (before) this.push(this.layout.insertBefore(before.element, content));
    else this.push(this.insertLast(flow.element, content));
  }

  addEnd(flow: Flow, kind: "source" | "sink", name: string): string {
    this.mustBeWhole(flow.element);
    const fresh = this.freshName(flow, name);
    const content = (indent: string) =>
      this.layout.render({ name: kind, attributes: [["name", fresh]] }, indent);
    const first = flow.steps[0] ?? flow.links[0];
    const last = flow.steps.at(-1);
    if (kind === "sink" && last) this.push(this.layout.insertAfter(last.element, content));
    else if (first) this.push(this.layout.insertBefore(first.element, content));
    else this.push(this.insertLast(flow.element, content));
    return fresh;
  }

  // Removes steps with their links. `heal`: where a removed step had one way in and one out, they are joined.
  removeSteps(flow: Flow, steps: readonly Step[], heal = false) {
    const gone = new Set(steps.map((s) => s.name));
    for (const step of steps) this.removeElement(step.element);
    const removed = new Set<Link>();
    const plain = flow.links.filter((l) => l.kind === "plain");
    if (heal && steps.length === 1) {
      const into = plain.filter((l) => l.to === steps[0]?.name);
      const out = plain.filter((l) => l.from === steps[0]?.name);
      const [a, b] = [into[0], out[0]];
      const every = flow.links.filter((l) => gone.has(l.from) || gone.has(l.to));
      if (
        a &&
        b &&
        into.length === 1 &&
        out.length === 1 &&
        every.length === 2 &&
        a.from !== b.to &&
        !plain.some((l) => l.from === a.from && l.to === b.to)
      ) {
        this.set(a.element, "to", b.to);
        removed.add(a);
      }
    }
    for (const link of flow.links)
      if (!removed.has(link) && (gone.has(link.from) || gone.has(link.to))) this.removeElement(link.element);
  }

  renameStep(flow: Flow, step: Step, name: string) {
    const wanted = name.trim();
    if (wanted === step.name) return;
    if (wanted === "") throw new EditRefused("A step needs a name.");
    if (flow.steps.some((s) => s !== step && s.name === wanted))
      throw new EditRefused(`There is a step ${wanted} already. Choose another name.`);
    this.set(step.element, "name", wanted);
    for (const link of flow.links) {
      if (link.from === step.name) this.set(link.element, "from", wanted);
      if (link.to === step.name) this.set(link.element, "to", wanted);
    }
    for (const wait of flow.steps.flatMap((s) => s.waits)) {
      const join = attribute(wait, "joinCondition");
      if (join) this.set(wait, "joinCondition", renameInExpression(join.value, step.name, wanted));
    }
  }

  addLink(flow: Flow, from: string, to: string, kind: LinkKind = "plain", whileText = "") {
    this.mustBeWhole(flow.element);
    const stepFrom = flow.steps.find((s) => s.name === from);
    const stepTo = flow.steps.find((s) => s.name === to);
    if (stepFrom?.kind === "sink")
      throw new EditRefused(`${from} is where the flow ends; nothing comes after it.`);
    if (stepTo?.kind === "source")
      throw new EditRefused(`${to} is where the flow begins; nothing comes before it.`);
    if (from === to && kind !== "while")
      throw new EditRefused(`A step leads back to itself only by a link with "while".`);
    if (flow.links.some((l) => l.from === from && l.to === to && l.kind === kind))
      throw new EditRefused(`${from} leads to ${to} already.`);
    this.addLinkUnchecked(flow, from, to, kind, whileText);
  }

  // The same between steps that this edit adds, too.
  addLinkUnchecked(flow: Flow, from: string, to: string, kind: LinkKind = "plain", whileText = "") {
    this.insertLink(flow, [["from", from], ["to", to], ...this.kindAttributes(kind, whileText)]);
  }

  private insertLink(flow: Flow, attributes: [string, string][]) {
    const content = (indent: string) => this.layout.render({ name: "link", attributes }, indent);
    const last = flow.links.at(-1) ?? flow.steps.findLast((s) => s.kind === "sink") ?? flow.steps.at(-1);
    this.push(last ? this.layout.insertAfter(last.element, content) : this.insertLast(flow.element, content));
  }

  private kindAttributes(kind: LinkKind, whileText: string): [string, string][] {
    if (kind === "while") return [[this.prefixed(extNamespace, "ext", "while"), whileText || "true"]];
    if (kind === "failure") return [[this.prefixed(extNamespace, "ext", "onFailure"), "true"]];
    return kind === "interrupt" ? [[this.prefixed(extNamespace, "ext", "onInterrupt"), "true"]] : [];
  }

  removeLinks(links: readonly Link[]) {
    for (const link of links) this.removeElement(link.element);
  }

  setLinkKind(link: Link, kind: LinkKind, whileText = "") {
    this.setExt(link.element, "while", kind === "while" ? whileText : null);
    this.setExt(link.element, "onFailure", kind === "failure" ? "true" : null);
    this.setExt(link.element, "onInterrupt", kind === "interrupt" ? "true" : null);
  }

  // Leads a link through a step: from → step → to.
  splice(flow: Flow, link: Link, name: string) {
    if (link.from === name || link.to === name)
      throw new EditRefused(`${name} is an end of this link already.`);
    this.set(link.element, "to", name);
    const content = (indent: string) =>
      this.layout.render(
        {
          name: "link",
          attributes: [
            ["from", name],
            ["to", link.to],
          ],
        },
        indent,
      );
    if (!flow.links.some((l) => l.from === name && l.to === link.to))
      this.push(this.layout.insertAfter(link.element, content));
  }

  moveSteps(moves: readonly { step: Step; x: number; y: number }[]) {
    for (const { step, x, y } of moves) {
      this.setNs(step.element, viewNamespace, "view", { x: round(x), y: round(y) });
    }
  }

  // Forgets where steps stand, so that they are laid out.
  clearPlaces(flow: Flow) {
    for (const step of flow.steps)
      for (const local of ["x", "y"]) {
        const found = attributeNs(step.element, viewNamespace, local);
        if (found) this.set(step.element, found.name, null);
      }
  }

  // ---- what a step does ----

  addInvoke(step: Step, kind: Invoke["kind"], target: string) {
    const content = (indent: string) =>
      this.layout.render({ name: "invoke", attributes: [[kind, target]] }, indent);
    const last = step.invokes.at(-1)?.element ?? step.condition?.element ?? step.element.children.at(-1);
    this.push(last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(step.element, content));
  }
  setInvoke(invoke: Invoke, kind: Invoke["kind"], target: string) {
    if (invoke.kind === kind) return this.set(invoke.element, kind, target);
    const old = attribute(invoke.element, invoke.kind);
    if (old)
      this.changes.push({ from: old.from, to: old.to, insert: `${kind}="${encodeAttribute(target)}"` });
    else this.set(invoke.element, kind, target);
  }
  // What is invoked gets as its input; empty: the variable of that name.
  setInput(invoke: Invoke, part: string, expression: string) {
    const found = invoke.inputs.find((i) => i.part === part);
    if (found && expression === "") return this.push(this.layout.removeAndClose(found.element));
    const [given, other, value] = /^\$[A-Za-z]\w*(\.[A-Za-z]\w*)?$/.test(expression)
      ? ["variable", "expression", expression.slice(1)]
      : ["expression", "variable", expression];
    if (found) {
      const old = attribute(found.element, other);
      if (old)
        this.changes.push({ from: old.from, to: old.to, insert: `${given}="${encodeAttribute(value)}"` });
      else this.set(found.element, given, value);
      return;
    }
    if (expression === "") return;
    const content = (indent: string) =>
      this.layout.render(
        {
          name: this.prefixed(extNamespace, "ext", "input"),
          attributes: [
            ["part", part],
            [given, value],
          ],
        },
        indent,
      );
    const last = invoke.inputs.at(-1)?.element;
    this.push(
      last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(invoke.element, content),
    );
  }
  setDocumentation(part: { element: XmlElement; documentationElement: XmlElement | null }, text: string) {
    const found = part.documentationElement;
    if (found && text.trim() === "") this.removeElement(found);
    else if (found) this.changes.push(...this.layout.setText(found, text));
    else if (text.trim() !== "")
      this.push(
        this.layout.insertFirst(part.element, (indent) =>
          this.layout.render({ name: "documentation", text }, indent),
        ),
      );
  }
  addVariable(flow: Flow, name: string, type = "") {
    if (flow.variables.some((v) => v.name === name))
      throw new EditRefused(`There is a value ${name} already. Choose another name.`);
    const piece: Piece = {
      name: "variable",
      attributes: type
        ? [
            ["name", name],
            ["type", type],
          ]
        : [["name", name]],
    };
    const content = (indent: string) => this.layout.render(piece, indent);
    const last = flow.variables.at(-1);
    this.push(
      last ? this.layout.insertAfter(last.element, content) : this.layout.insertFirst(flow.element, content),
    );
  }

  // The value that a variable of the flow begins with, where nothing gives it another; empty: none. Declares it where it is not.
  setInitial(flow: Flow, name: string, expression: string, type = "") {
    const found = flow.variables.find((v) => v.name === name);
    const initialize = found?.element.children.find((c) => c.local === "initialize");
    const from = initialize?.children.find((c) => c.local === "from");
    if (expression === "")
      return initialize && found ? this.push(this.layout.removeAndClose(initialize)) : undefined;
    if (from) return this.set(from, "expression", expression);
    const begins: Piece = {
      name: "initialize",
      children: [{ name: "from", attributes: [["expression", expression]] }],
    };
    if (found)
      return this.push(
        this.layout.insertFirst(found.element, (indent) => this.layout.render(begins, indent)),
      );
    const piece: Piece = {
      name: "variable",
      attributes: type
        ? [
            ["name", name],
            ["type", type],
          ]
        : [["name", name]],
      children: [begins],
    };
    const last = flow.variables.at(-1);
    const content = (indent: string) => this.layout.render(piece, indent);
    this.push(
      last ? this.layout.insertAfter(last.element, content) : this.layout.insertFirst(flow.element, content),
    );
  }

  // The same as XML, of another document.
  addVariableText(flow: Flow, written: string) {
    const content = (indent: string) =>
      written
        .split("\n")
        .map((line, i) => (i === 0 || line.trim() === "" ? line : indent + line))
        .join(this.layout.newline);
    const last = flow.variables.at(-1);
    this.push(
      last ? this.layout.insertAfter(last.element, content) : this.layout.insertFirst(flow.element, content),
    );
  }

  renameFlow(document: CawlDocument, flow: Flow, name: string) {
    const wanted = name.trim();
    if (wanted === "" || wanted === flow.name) return;
    if (document.flows.some((f) => f.name === wanted))
      throw new EditRefused(`There is a flow ${wanted} already. Choose another name.`);
    this.set(flow.element, "name", wanted);
    for (const step of document.flows.flatMap((f) => f.steps))
      for (const invoke of step.invokes)
        if (invoke.kind === "subflow" && invoke.target === flow.name)
          this.set(invoke.element, "subflow", wanted);
    const activate = document.activator?.element.children.find((child) => child.local === "activate");
    if (activate && document.activator?.flow === flow.name) this.set(activate, "flow", wanted);
  }
  // What starts the flow by itself.
  addActivator(flow: Flow, words: Words) {
    const piece: Piece = {
      name: "activator",
      attributes: [["name", "OnStart"]],
      children: [
        { name: "activate", attributes: [["flow", flow.name]] },
        { name: "condition", children: [this.contextPiece("Begins", words)] },
      ],
    };
    this.push(
      this.layout.insertBefore(
        flow.element,
        (indent) => `${this.layout.render(piece, indent)}${this.layout.newline}`,
      ),
    );
  }

  // ---- conditions ----

  // A first condition for the step or activator, with one row of words.
  addCondition(part: { element: XmlElement; invokes?: Invoke[] }, words: Words) {
    const piece: Piece = { name: "condition", children: [this.contextPiece("Situation", words)] };
    const content = (indent: string) => this.layout.render(piece, indent);
    const invoke = part.invokes?.[0];
    const last = part.element.children.at(-1);
    if (invoke) this.push(this.layout.insertBefore(invoke.element, content));
    else
      this.push(
        last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(part.element, content),
      );
  }
  addContext(condition: Condition, words: Words) {
    const name = uniqueName(new Set(condition.contexts.map((c) => c.name)), "Situation");
    const content = (indent: string) => this.layout.render(this.contextPiece(name, words), indent);
    const last = condition.contexts.at(-1)?.element ?? condition.caseElement;
    this.push(
      last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(condition.element, content),
    );
    if (condition.expression)
      this.set(condition.element, "expression", `${condition.expression} or ${quoteName(name)}`);
  }
  addConstraint(context: Context, rule: Rule | null, words: Words) {
    const taken = new Set(rule?.constraints.map((c) => c.name));
    const name = uniqueName(taken, nameOfVerb(words.verb));
    const last = rule?.constraints.at(-1);
    if (!rule) {
      this.push(
        this.layout.insertFirst(context.element, (indent) =>
          this.layout.render({ name: "rule", children: [this.constraintPiece(name, words)] }, indent),
        ),
      );
      return;
    }
    const content = (indent: string) => this.layout.render(this.constraintPiece(name, words), indent);
    this.push(
      last ? this.layout.insertAfter(last.element, content) : this.layout.insertFirst(rule.element, content),
    );
    if (rule.expression) this.set(rule.element, "expression", `${rule.expression} and ${quoteName(name)}`);
  }
  // Removes a row, and what is empty without it.
  removeConstraint(condition: Condition, context: Context, rule: Rule, constraint: Constraint) {
    if (rule.constraints.length > 1) this.removeElement(constraint.element);
    else if (context.rules.length > 1) this.removeElement(rule.element);
    else this.removeContext(condition, context);
  }
  removeContext(condition: Condition, context: Context) {
    this.removeElement(
      condition.contexts.length > 1 || condition.caseElement ? context.element : condition.element,
    );
  }
  // The words of a subject, verb or object, and its type.
  setSlot(constraint: Constraint, which: "subject" | "verb" | "object", text: string, type?: string) {
    const slot: Slot = constraint[which];
    if (!slot.element) {
      const piece: Piece = { name: which, text, attributes: type ? [["type", type]] : [] };
      const last = constraint.element.children.at(-1);
      const content = (indent: string) => this.layout.render(piece, indent);
      this.push(
        last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(constraint.element, content),
      );
      return;
    }
    if (text !== slot.text) this.changes.push(...this.layout.setText(slot.element, text));
    if (type !== undefined && type !== slot.type) this.set(slot.element, "type", type === "" ? null : type);
  }

  private contextPiece(name: string, words: Words): Piece {
    return {
      name: "context",
      attributes: [["name", name]],
      children: [{ name: "rule", children: [this.constraintPiece(nameOfVerb(words.verb), words)] }],
    };
  }
  private constraintPiece(name: string, words: Words): Piece {
    return {
      name: "constraint",
      attributes: [["name", name]],
      children: [
        {
          name: "subject",
          text: words.subject,
          attributes: words.subjectType ? [["type", words.subjectType]] : [],
        },
        { name: "verb", text: words.verb },
        {
          name: "object",
          text: words.object,
          attributes: words.objectType ? [["type", words.objectType]] : [],
        },
      ],
    };
  }

  // ---- attributes and elements ----

  // Sets an attribute without prefix; null takes it away.
  set(element: XmlElement, name: string, value: string | null) {
    this.push(this.layout.setAttribute(element, name, value));
  }
  // Sets an attribute of the extension namespace; its prefix is declared where it is not yet.
  setExt(element: XmlElement, local: string, value: string | null) {
    if (value !== null && value !== "") return this.setNs(element, extNamespace, "ext", { [local]: value });
    const found = attributeNs(element, extNamespace, local);
    if (found) this.set(element, found.name, null);
  }
  removeElement(element: XmlElement) {
    this.push(this.layout.remove(element));
  }
  // Makes a prefix mean a namespace, unless it does.
  declare(prefix: string, namespace: string) {
    if (this.root.scope.get(prefix) !== namespace && !this.root.scope.has(prefix))
      this.prefixed(namespace, prefix, "");
  }

  private setNs(element: XmlElement, namespace: string, prefix: string, values: Record<string, string>) {
    const added: [string, string][] = [];
    for (const [local, value] of Object.entries(values)) {
      const name = attributeNs(element, namespace, local)?.name ?? this.prefixed(namespace, prefix, local);
      if (attribute(element, name))
        this.set(element, name, value); // also one whose prefix was not declared
      else added.push([name, value]);
    }
    if (added.length === 0) return;
    const at = element.attributes.at(-1)?.to ?? element.nameTo;
    this.changes.push({
      from: at,
      to: at,
      insert: added.map(([name, value]) => ` ${name}="${encodeAttribute(value)}"`).join(""),
    });
  }

  // "ext:while", with the prefix that the document has for the namespace.
  private prefixed(namespace: string, wanted: string, local: string): string {
    for (const [prefix, iri] of this.root.scope)
      if (iri === namespace && prefix !== "") return `${prefix}:${local}`;
    let prefix = this.declared.get(namespace);
    if (!prefix) {
      prefix = uniqueName(new Set([...this.root.scope.keys(), ...this.declared.values()]), wanted);
      this.declared.set(namespace, prefix);
      this.set(this.root, `xmlns:${prefix}`, namespace);
    }
    return `${prefix}:${local}`;
  }

  private insertLast(parent: XmlElement, content: (indent: string) => string): Change | null {
    const last = parent.children.at(-1);
    return last ? this.layout.insertAfter(last, content) : this.layout.insertFirst(parent, content);
  }
  private push(change: Change | null) {
    if (change) this.changes.push(change);
  }
  private freshName(flow: Flow, wanted: string): string {
    const taken = this.taken.get(flow.key) ?? new Set(flow.steps.map((s) => s.name));
    this.taken.set(flow.key, taken);
    const name = uniqueName(taken, wanted.trim() || "Step");
    taken.add(name);
    return name;
  }
  private mustBeWhole(element: XmlElement) {
    if (!element.whole)
      throw new EditRefused("The text has a mistake in this flow. Mend the marked place first.");
  }
}

export interface Words {
  subject: string;
  verb: string;
  object: string;
  subjectType?: string;
  objectType?: string;
}

function nameOfVerb(verb: string): string {
  return verb.replace(/^.*[:#/]/, "").replace(/[<>?$]/g, "") || "is";
}
function round(value: number): string {
  return String(Math.round(value));
}
