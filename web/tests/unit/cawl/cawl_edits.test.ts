// What single edits write, byte for byte.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { type CawlDocument, type Flow, partAt, readCawl } from "../../../src/cawl/document";
import { EditRefused, Edits } from "../../../src/cawl/edits";
import { applyChanges } from "../../../src/cawl/layout_of_text";

const guide = readFileSync(
  join(import.meta.dirname, "../../../../scenarios/s01_booth_guide/booth_guide.cawl.xml"),
  "utf8",
);

function edited(text: string, make: (edits: Edits, flow: Flow, document: CawlDocument) => void): string {
  const document = readCawl(text);
  const edits = new Edits(document);
  const flow = document.flows[0];
  if (!flow) throw new Error("no flow");
  make(edits, flow, document);
  return applyChanges(text, edits.changes);
}
// Lines that went, with "-", and that came, with "+".
function difference(before: string, after: string): string[] {
  const [a, b] = [before.split("\n"), after.split("\n")];
  let head = 0;
  while (head < Math.min(a.length, b.length) && a[head] === b[head]) head++;
  let tail = 0;
  while (tail < Math.min(a.length, b.length) - head && a.at(-1 - tail) === b.at(-1 - tail)) tail++;
  return [
    ...a.slice(head, a.length - tail).map((l) => `-${l}`),
    ...b.slice(head, b.length - tail).map((l) => `+${l}`),
  ];
}
const step = (flow: Flow, name: string) => flow.steps.find((s) => s.name === name)!;

describe("the booth guide", () => {
  const document = readCawl(guide);
  it("is read", () => {
    expect(document).toMatchObject({
      name: "BoothGuide",
      version: "1.0",
      problems: [],
      activator: { flow: "BoothGuide", name: "OnChoice" },
    });
    expect(document.flows[0]?.steps.map((s) => s.name)).toEqual([
      "Arrived",
      "Move2User",
      "Move2Booth",
      "InfoBooth",
      "Presented",
    ]);
    expect(document.flows[0]?.links).toHaveLength(4);
    expect(step(document.flows[0]!, "InfoBooth").invokes.map((i) => i.target)).toEqual([
      "displayInformation",
      "briefInformation",
    ]);
    expect(
      step(document.flows[0]!, "Move2Booth").condition?.contexts[0]?.rules[1]?.constraints[0]?.object,
    ).toMatchObject({ text: "?booth", type: "docent:Booth" });
    expect(partAt(document, guide.indexOf("knowsItsPlace"))?.step?.name).toBe("Move2User");
  });
  it("gets an attribute by one word", () => {
    const after = edited(guide, (e, flow) => e.setExt(step(flow, "Move2User").element, "timeout", "5min"));
    expect(difference(guide, after)).toEqual([
      '-    <node name="Move2User" state="deActivate">',
      '+    <node name="Move2User" state="deActivate" ext:timeout="5min">',
    ]);
  });
  it("gets a step in the author's layout", () => {
    const after = edited(guide, (e, flow) =>
      e.addStep(flow, { name: "Goodbye", invoke: { kind: "operation", target: "say" } }),
    );
    expect(difference(guide, after)).toEqual([
      '+    <node name="Goodbye">',
      '+      <invoke operation="say"/>',
      "+    </node>",
      "+",
    ]);
  });
  it("loses a step and its links, and is joined up", () => {
    const after = edited(guide, (e, flow) => e.removeSteps(flow, [step(flow, "Move2Booth")], true));
    const flow = readCawl(after).flows[0]!;
    expect(flow.links.map((l) => `${l.from}>${l.to}`)).toEqual([
      "Arrived>Move2User",
      "Move2User>InfoBooth",
      "InfoBooth>Presented",
    ]);
    expect(after).not.toMatch(/\n\s*\n\s*\n/);
  });
  it("is moved by attributes of the canvas alone", () => {
    const after = edited(guide, (e, flow) => e.moveSteps([{ step: step(flow, "Arrived"), x: 10.2, y: 20 }]));
    expect(after).toContain('<source name="Arrived" view:x="10" view:y="20"/>');
    expect(after).toContain(
      '      xmlns:ext="https://w3id.org/docent/cawl-ext#"\n      xmlns:view="urn:cawl-view">',
    );
    expect(edited(after, (e, flow) => e.moveSteps([{ step: step(flow, "Arrived"), x: 11, y: 20 }]))).toBe(
      after.replace('view:x="10"', 'view:x="11"'),
    );
  });
  it("renames in links and joins", () => {
    const joined = guide.replace(
      '<node name="InfoBooth" state="deActivate">',
      `<node name="InfoBooth"><wait joinCondition="Move2Booth and not 'Move2User'"/>`,
    );
    const after = edited(joined, (e, flow) => e.renameStep(flow, step(flow, "Move2Booth"), "To booth"));
    expect(after).toContain(`joinCondition="'To booth' and not 'Move2User'"`);
    expect(after).toContain('<link from="To booth" to="InfoBooth"/>');
  });
  it("changes a term and keeps the comment beside it", () => {
    const commented = guide.replace("<object>true</object>", "<object> true <!-- sure --></object>");
    const after = edited(commented, (e, flow) =>
      e.setSlot(step(flow, "Move2User").condition!.contexts[0]!.rules[0]!.constraints[1]!, "object", "< 3"),
    );
    expect(after).toContain("<object> &lt; 3 <!-- sure --></object>");
  });
  it("refuses what can't be, with words", () => {
    const refused = (make: (e: Edits, f: Flow) => void) => () => edited(guide, make);
    expect(refused((e, f) => e.addLink(f, "Presented", "Move2User"))).toThrow(/nothing comes after/);
    expect(refused((e, f) => e.addLink(f, "Arrived", "Move2User"))).toThrow(/already/);
    expect(refused((e, f) => e.renameStep(f, step(f, "Arrived"), "Move2User"))).toThrow(EditRefused);
  });
});

describe("other layouts", () => {
  it("one line, CRLF and prefixes are kept", () => {
    const line =
      '<c:CAWL name="A" xmlns:c="urn:x"><c:flow name="F"><c:source name="s"/><c:sink name="t"/></c:flow></c:CAWL>';
    expect(edited(line, (e, f) => e.addStep(f, { name: "N" }))).toBe(
      line.replace("<c:sink", '<c:node name="N"/><c:sink'),
    );
    const crlf = guide.replace(/\n/g, "\r\n");
    const after = edited(crlf, (e, f) => e.addStep(f, { name: "N" }));
    expect(after.replace(/\r\n/g, "")).not.toContain("\n");
    expect(
      edited(crlf, (e, f) => e.removeSteps(f, [step(f, "Move2Booth")])).replace(/\r\n/g, ""),
    ).not.toMatch(/[\r\n]/);
  });
  it("an empty flow is opened", () => {
    const after = edited('<CAWL name="A">\n\t<flow name="F" />\n</CAWL>', (e, f) =>
      e.addEnd(f, "source", "Begin"),
    );
    expect(after).toBe('<CAWL name="A">\n\t<flow name="F">\n\t\t<source name="Begin"/>\n\t</flow>\n</CAWL>');
  });
});

describe("broken text", () => {
  it("keeps the good steps and marks the place", () => {
    const broken = guide.replace('<invoke operation="moveToBooth"/>', "<invoke operation=>");
    const document = readCawl(broken);
    expect(document.flows[0]?.steps.map((s) => s.name)).toContain("InfoBooth");
    expect(document.problems.length).toBeGreaterThan(0);
    const at = broken.indexOf("<invoke operation=>");
    expect(document.problems.some((p) => p.from <= at + 19 && p.to >= at)).toBe(true);
    expect(step(document.flows[0]!, "InfoBooth").whole).toBe(true);
    expect(step(document.flows[0]!, "Move2Booth").whole).toBe(false);
  });
  it("is never an exception, wherever it is cut or scrambled", () => {
    for (let at = 0; at < guide.length; at += 31) {
      readCawl(guide.slice(0, at));
      readCawl(guide.slice(0, at) + "<&\"'" + guide.slice(at + 9));
    }
  });
  it("of 5,000 steps is read again in the time of a key press", () => {
    const steps = Array.from(
      { length: 5000 },
      (_, i) => `    <node name="n${i}"><invoke operation="say"/></node>`,
    ).join("\n");
    const text = `<CAWL name="A">\n  <flow name="F">\n${steps}\n  </flow>\n</CAWL>`;
    expect(readCawl(text).flows[0]?.steps).toHaveLength(5000);
  });
});
