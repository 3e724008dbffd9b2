// What a deployment changes: new, changed and gone steps and links.
import { describe, expect, it } from "vitest";
import { readCawl } from "../../../src/cawl/document";
import { bothFlows } from "../../../src/cawl/flow_diff";
import { latelyQuery, readLately } from "../../../src/operate/lately";

const document = (...inner: string[]) =>
  readCawl(`<CAWL name="x"><flow name="f"><source name="s"/>${inner.join("")}<sink name="t"/></flow></CAWL>`);

describe("two versions of a flow", () => {
  it("have their new, changed and gone steps, and their links", () => {
    const before = document(
      '<node name="A"/>',
      '<node name="B"/>',
      '<link from="s" to="A"/>',
      '<link from="A" to="B"/>',
      '<link from="B" to="t"/>',
    );
    const after = document(
      '<node name="A"><invoke operation="say"/></node>',
      '<node name="C"/>',
      '<link from="s" to="A"/>',
      '<link from="A" to="C"/>',
      '<link from="C" to="t"/>',
    );
    const both = bothFlows(before.flows[0], after.flows[0]!, (side, step) =>
      (side === "before" ? before : after).text.slice(step.element.from, step.element.to),
    );
    expect([...both.changes].sort()).toEqual([
      ["A", "changed"],
      ["B", "gone"],
      ["C", "new"],
    ]);
    expect(both.steps.map((s) => s.name)).toEqual(["s", "A", "C", "t", "B"]);
    expect(both.links.map(({ link, change }) => `${link.from}-${link.to} ${change}`)).toEqual([
      "s-A ",
      "A-C new",
      "C-t new",
      "A-B gone",
      "B-t gone",
    ]);
    expect(new Set(both.steps.map((s) => s.key)).size).toBe(5);
  });
  it("a flow that was not there is all new", () => {
    const after = document('<node name="A"/>');
    expect([...bothFlows(undefined, after.flows[0]!, () => "").changes.values()]).toEqual([
      "new",
      "new",
      "new",
    ]);
  });
});

describe("the newest runs of a thing", () => {
  it("are read, and what is no run is left out", () => {
    const run = (id: string, began: string) => ({
      run: { kind: "iri" as const, text: id },
      state: { kind: "literal" as const, text: "done" },
      began: { kind: "literal" as const, text: began },
    });
    expect(
      readLately([
        run("urn:docent:run:G-1", "2026-11-26T10:40:16.829Z"),
        run("urn:x", "2026-11-26T10:40:16Z"),
        run("urn:docent:run:G-2", "?"),
      ]),
    ).toEqual([{ run: "G-1", state: "done", beganUs: 1795689616829000n }]);
    expect(latelyQuery("urn:x> } #")).not.toContain("x> }");
  });
});
