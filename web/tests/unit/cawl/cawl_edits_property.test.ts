// Random edits of real documents: what an edit does not touch keeps its bytes, undo gives the same bytes again, and the model
// read from the text is the one that was asked for.
import { history, undo, redo } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { type CawlDocument, type Flow, readCawl } from "../../../src/cawl/document";
import { EditRefused, Edits } from "../../../src/cawl/edits";
import { applyChanges } from "../../../src/cawl/layout_of_text";
import { Random } from "../random";

const tree = join(import.meta.dirname, "../../../..");

function documents(folder: string): string[] {
  return readdirSync(folder).flatMap((name) => {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) return documents(path);
    return /\.(cawl|xml)$/.test(name) ? [path] : [];
  });
}
const texts = [...documents(join(tree, "scenarios")), ...documents(join(tree, "tests/golden/cawl"))]
  .map((path) => readFileSync(path, "utf8"))
  .filter((text) => {
    const document = readCawl(text);
    return document.problems.length === 0 && document.flows.length > 0;
  });

const names = ["Greet", "Go & see", "a<b", 'say "hi"', "and", "Tour (A)", "한국어", "it's", "Straße 🤖"];
const terms = ["?x", "$user", "docent:isAt", '"a < b & c"', "< 0.2", "<https://example.org/?a=1&b=2>", "]]>"];

type Shape = { steps: string[]; links: string[]; rows: string[] };
function shape(document: CawlDocument): Shape[] {
  return document.flows.map((flow) => ({
    steps: flow.steps.map(
      (s) =>
        `${s.kind} ${s.name} ${s.invokes.map((i) => `${i.kind} ${i.target}`).join()} ${JSON.stringify(s.position)}`,
    ),
    links: flow.links.map((l) => `${l.from} > ${l.to} ${l.kind} ${l.whileText}`),
    rows: flow.steps.flatMap(
      (s) =>
        s.condition?.contexts.flatMap((c) =>
          c.rules.flatMap((r) =>
            r.constraints.map((k) => `${k.subject.text} ${k.verb.text} ${k.object.text} ${k.object.type}`),
          ),
        ) ?? [],
    ),
  }));
}

// One random edit; returns a check of what the document has to be afterwards.
function edit(edits: Edits, flow: Flow, random: Random): (after: Flow) => void {
  const step = random.pick(flow.steps);
  const nodes = flow.steps.filter((s) => s.kind === "node");
  const node = random.pick(nodes);
  const link = random.pick(flow.links);
  const name = random.pick(names) ?? "N";
  const rows = flow.steps.flatMap(
    (s) =>
      s.condition?.contexts.flatMap((c) =>
        c.rules.flatMap((r) =>
          r.constraints.map((constraint) => ({
            condition: s.condition,
            context: c,
            rule: r,
            constraint,
            step: s,
          })),
        ),
      ) ?? [],
  );
  const row = random.pick(rows);
  const before = flow.steps.length;
  switch (random.below(14)) {
    case 0: {
      const added = edits.addStep(flow, {
        name,
        invoke: { kind: "operation", target: name },
        position: { x: 12.4, y: -7 },
      });
      return (after) => {
        const found = after.steps.find((s) => s.name === added);
        expect(found).toMatchObject({
          kind: "node",
          position: { x: 12, y: -7 },
          invokes: [{ kind: "operation", target: name }],
        });
        expect(after.steps.length).toBe(before + 1);
      };
    }
    case 1:
      if (!node) break;
      edits.removeSteps(flow, [node], random.below(2) === 0);
      return (after) => {
        expect(after.steps.length).toBe(before - 1);
        if (!flow.steps.some((s) => s !== node && s.name === node.name))
          expect(after.links.some((l) => l.from === node.name || l.to === node.name)).toBe(false);
      };
    case 2:
      if (!step) break;
      edits.renameStep(flow, step, name);
      return (after) => {
        expect(after.steps.some((s) => s.name === name)).toBe(true);
        expect(after.links.length).toBe(flow.links.length);
        expect(after.links.filter((l) => l.from === name).length).toBe(
          flow.links.filter((l) => l.from === step.name || l.from === name).length,
        );
      };
    case 3: {
      const to = random.pick(flow.steps);
      if (!step || !to) break;
      const kind = random.pick(["plain", "while", "failure", "interrupt"] as const) ?? "plain";
      edits.addLink(flow, step.name, to.name, kind, "$user docent:wants true");
      return (after) => expect(after.links.at(-1)).toMatchObject({ from: step.name, to: to.name, kind });
    }
    case 4:
      if (!link) break;
      edits.removeLinks([link]);
      return (after) => expect(after.links.length).toBe(flow.links.length - 1);
    case 5:
      if (!link) break;
      edits.setLinkKind(
        link,
        random.pick(["plain", "while", "failure", "interrupt"] as const) ?? "plain",
        "$a b c",
      );
      return () => undefined;
    case 6:
      if (!link || !node) break;
      edits.splice(flow, link, node.name);
      return (after) => expect(after.links.some((l) => l.from === node.name && l.to === link.to)).toBe(true);
    case 7:
      if (!step) break;
      edits.moveSteps([{ step, x: random.below(900), y: random.below(900) }]);
      return (after) => expect(after.steps.find((s) => s.key === step.key)?.position).not.toBeNull();
    case 8: {
      if (!row) break;
      const term = random.pick(terms) ?? "?x";
      const which = random.pick(["subject", "verb", "object"] as const) ?? "object";
      edits.setSlot(row.constraint, which, term);
      return (after) => {
        const found = after.steps
          .find((s) => s.key === row.step.key)
          ?.condition?.contexts.flatMap((c) =>
            c.rules.flatMap((r) => r.constraints.map((k) => k[which].text)),
          );
        expect(found).toContain(term);
      };
    }
    case 9:
      if (!row?.condition) break;
      edits.removeConstraint(row.condition, row.context, row.rule, row.constraint);
      return () => undefined;
    case 10:
      if (!row?.condition) break;
      if (random.below(2))
        edits.addConstraint(row.context, row.rule, {
          subject: "?a",
          verb: "docent:isNear",
          object: "?b",
          subjectType: "docent:Robot",
        });
      else edits.addContext(row.condition, { subject: "?a", verb: "a", object: "docent:Robot" });
      return (after) => expect(shapeRows(after)).toBe(rows.length + 1);
    case 11:
      if (!node) break;
      edits.addInvoke(node, random.below(2) ? "operation" : "subflow", name);
      return (after) =>
        expect(after.steps.find((s) => s.key === node.key)?.invokes.at(-1)?.target).toBe(name);
    case 12:
      if (!step) break;
      edits.setExt(
        step.element,
        random.pick(["timeout", "retry", "forEach"]) ?? "retry",
        random.pick(["30s", "2", "", null]) ?? null,
      );
      return () => undefined;
    case 13:
      if (!node) break;
      edits.setDocumentation(node, random.pick(["Text with <b> & more", "", "Comes to you."]) ?? "");
      if (!node.condition)
        edits.addCondition(node, { subject: "?r", verb: "docent:status", object: "docent:Standby" });
      return () => undefined;
  }
  return () => undefined;
}

function shapeRows(flow: Flow): number {
  return flow.steps.reduce(
    (n, s) =>
      n +
      (s.condition?.contexts.reduce((m, c) => m + c.rules.reduce((k, r) => k + r.constraints.length, 0), 0) ??
        0),
    0,
  );
}

// Comments and processing instructions, which an edit never touches unless they lie in what it removes.
function comments(text: string): string[] {
  return text.match(/<!--[\s\S]*?-->|<\?[\s\S]*?\?>/g) ?? [];
}

describe("random edits", () => {
  it("has documents to edit", () => expect(texts.length).toBeGreaterThan(5));

  for (const seed of [1, 2, 3, 4, 5, 6, 7, 8])
    it(`keep what they do not touch, and undo gives the bytes again (seed ${seed})`, () => {
      const random = new Random(seed);
      for (const original of [texts[seed % 2], ...Array.from({ length: 15 }, () => random.pick(texts))]) {
        if (original === undefined) continue;
        let state = EditorState.create({ doc: original, extensions: [history()] });
        const versions = [original];
        let document = readCawl(original);
        for (let turn = 0; turn < 25; turn++) {
          const flow = random.pick(document.flows);
          if (!flow) break;
          const edits = new Edits(document);
          let check: (after: Flow) => void;
          try {
            check = edit(edits, flow, random);
          } catch (error) {
            if (error instanceof EditRefused) continue;
            throw error;
          }
          if (edits.changes.length === 0) continue;
          const text = applyChanges(document.text, edits.changes);
          const transaction = state.update({ changes: edits.changes.slice(), userEvent: `edit.${turn}` });
          expect(transaction.newDoc.toString()).toBe(text);
          const ranges: { fromA: number; toA: number; fromB: number; toB: number }[] = [];
          transaction.changes.iterChangedRanges((fromA, toA, fromB, toB) =>
            ranges.push({ fromA, toA, fromB, toB }),
          );
          const after = readCawl(text, document, ranges);
          expect(after.problems).toEqual([]);
          expect(shape(after)).toEqual(shape(readCawl(text)));
          const afterFlow = after.flows.find((f) => f.key === flow.key);
          if (afterFlow) check(afterFlow);
          expect(shape(after).filter((_, i) => after.flows[i]?.key !== flow.key)).toEqual(
            shape(document).filter((_, i) => document.flows[i]?.key !== flow.key),
          );
          const removed = edits.changes.map((c) => document.text.slice(c.from, c.to)).join("");
          for (const comment of comments(document.text))
            if (!removed.includes(comment)) expect(text).toContain(comment);
          state = transaction.state;
          document = after;
          versions.push(text);
        }
        const last = versions.at(-1);
        const dispatch = (t: { state: EditorState }) => (state = t.state);
        while (undo({ state, dispatch })) expect(versions).toContain(state.doc.toString());
        expect(state.doc.toString()).toBe(original);
        while (redo({ state, dispatch }));
        expect(state.doc.toString()).toBe(last);
      }
    });
});
