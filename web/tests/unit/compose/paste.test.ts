// Steps that are copied from one workflow into another one.
import { describe, expect, it, vi } from "vitest";
import { flowOf, readCawl } from "../../../src/cawl/document";
import { Edits } from "../../../src/cawl/edits";
import { applyChanges } from "../../../src/cawl/layout_of_text";
import { Actions } from "../../../src/compose/actions";
import type { PaletteEntry } from "../../../src/flow/palette_data";
import type { Session } from "../../../src/compose/session";

vi.stubGlobal("window", { setTimeout });
const palette: PaletteEntry[] = [
  {
    kind: "operation",
    id: "moveToBooth",
    title: "Move to booth",
    detail: "",
    inputs: [{ name: "booth", type: "" }],
  },
];
const flow = (name: string, inner: string) =>
  `<CAWL name="${name}" xmlns:docent="https://w3id.org/docent#">\n  <flow name="${name}">\n${inner}\n    <source name="Begin"/>\n    <sink name="End"/>\n  </flow>\n</CAWL>\n`;

// As much of a session as actions need.
function opened(text: string) {
  const session = {
    document: readCawl(text),
    edit: (key: string, make: (edits: Edits, flow: NonNullable<ReturnType<typeof flowOf>>) => unknown) => {
      const edits = new Edits(session.document);
      const result = make(edits, flowOf(session.document, key) ?? session.document.flows[0]!);
      session.document = readCawl(applyChanges(session.document.text, edits.changes));
      return result;
    },
  };
  return {
    session,
    actions: new Actions(
      session as unknown as Session,
      session.document.flows[0]!.key,
      () => undefined,
      () => undefined,
      palette,
    ),
  };
}

describe("a step that is pasted into another workflow", () => {
  const from = opened(
    flow(
      "One",
      `    <variable name="user" type="docent:Visitor"/>
    <variable name="booth" type="docent:Booth">
      <initialize><from expression="'B01'"/></initialize>
    </variable>
    <variable name="other" type="docent:Robot"/>
    <node name="Guide"><condition><context name="c"><rule name="r"><constraint name="k"><subject>$user</subject><verb>docent:isAt</verb><object>?place</object></constraint></rule></context></condition><invoke operation="moveToBooth"/></node>`,
    ),
  );
  it("brings the variables that it uses, also as inputs of what it invokes, with what they begin with", () => {
    const to = opened(flow("Two", '    <variable name="user"/>'));
    to.actions.paste(
      from.actions.copied([from.session.document.flows[0]!.steps.find((s) => s.name === "Guide")!.key]),
    );
    expect(to.session.document.problems).toEqual([]);
    expect(to.session.document.flows[0]?.steps.map((s) => s.name)).toContain("Guide");
    expect(to.session.document.flows[0]?.variables.map((v) => [v.name, v.type, v.initial])).toEqual([
      ["user", "", ""],
      ["booth", "docent:Booth", "'B01'"],
    ]);
  });
  it("brings none into its own workflow", () => {
    from.actions.paste(from.actions.copied(["Guide"]));
    expect(from.session.document.flows[0]?.variables.map((v) => v.name)).toEqual(["user", "booth", "other"]);
  });
});
