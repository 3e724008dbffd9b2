// What a flow takes from the run that runs it as a step, and what of that nothing gives.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { calledFlow, sourceOf, unsetInputs } from "../../../src/cawl/called";
import { readCawl } from "../../../src/cawl/document";
import { Edits } from "../../../src/cawl/edits";
import { applyChanges } from "../../../src/cawl/layout_of_text";
import { unsetFindings } from "../../../src/compose/called_flows";

const docent = "https://w3id.org/docent#";
const guide = calledFlow(
  readCawl(
    readFileSync(
      join(import.meta.dirname, "../../../../scenarios/s01_booth_guide/booth_guide.cawl.xml"),
      "utf8",
    ),
  ),
  "",
  () => [],
);
const row = (s: string, o = "expo:B05") =>
  `<context name="c"><rule><constraint><subject type="docent:Visitor">${s}</subject><verb>docent:isAt</verb><object>${o}</object></constraint></rule></context>`;
const service = (
  situation: string,
  variable = '<variable name="user" type="docent:Visitor"/>',
  before = "",
  input = "",
) =>
  readCawl(`<CAWL name="S" xmlns:docent="${docent}" xmlns:expo="https://w3id.org/docent/expo#" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  ${situation && `<activator name="A"><activate flow="S"/><condition>${situation}</condition></activator>`}
  <flow name="S">
    ${variable}
    <source name="Begin"/>
    <node name="First">${before}</node>
    <node name="Guide"><invoke subflow="BoothGuide">${input}</invoke></node>
    <sink name="End"/>
    <link from="Begin" to="First"/><link from="First" to="Guide"/><link from="Guide" to="End"/>
  </flow>
</CAWL>`);
const called = new Map([["BoothGuide", guide ?? { takes: [], gives: [] }]]);
const unset = (document: ReturnType<typeof service>, gives: () => readonly string[] | undefined = () => []) =>
  unsetInputs(document, called, gives, () => false).map((u) => u.input.name);

describe("a flow that is a step", () => {
  it("takes what nothing in it gives, and says what it gives back", () => {
    expect(guide?.takes).toEqual([
      { name: "user", type: `${docent}Visitor`, matched: true },
      { name: "robot", type: `${docent}Robot`, optional: true, matched: true },
    ]);
    expect(guide?.gives).toEqual(["booth", "guide"]);
  });
  it("takes what its activator binds and it uses: a step that runs it has no match of the activator", () => {
    const inner = readCawl(
      `<CAWL name="I"><activator name="A"><variable name="who"/><variable name="other"/><activate flow="I"/></activator><flow name="I"><node name="n"><condition>${row("$who")}</condition></node></flow></CAWL>`,
    );
    expect(calledFlow(inner, "", () => [])?.takes.map((t) => t.name)).toEqual(["who"]);
  });
  it("may have variables of any name while it is written", () => {
    const draft = readCawl(
      `<CAWL name="D"><flow name="D"><source name="s"/><node name="n"><assign variable="b">SELECT ?b { }</assign><invoke subflow="E"/></node><node name="m"><invoke subflow="E"/></node><link from="s" to="n"/><link from="n" to="m"/></flow><flow name="E"><variable name="a("/></flow></CAWL>`,
    );
    const [d, e] = draft.flows;
    const own = new Map([["E", calledFlow(draft, "E", () => []) ?? { takes: [], gives: [] }]]);
    expect(e && own.get("E")?.takes.map((t) => t.name)).toEqual(["a("]);
    expect(
      unsetInputs(
        draft,
        own,
        () => [],
        () => false,
      ).map((u) => [u.flow, u.step.name, u.input.name]),
    ).toEqual([
      [d, "n", "a("],
      [d, "m", "a("],
    ]);
  });
  it("lacks a value that the situation names instead of finding", () => {
    expect(unset(service(row("?user")))).toEqual([]);
    expect(unset(service(row("expo:John")))).toEqual(["user"]);
    expect(unset(service(row("?user") + row("expo:John")))).toEqual(["user"]); // one of the ways
    expect(unset(service(""))).toEqual([]); // given at the start
    expect(unset(service("", ""))).toEqual(["user"]); // nobody can give it
  });
  it("has a value by what it begins with, by a step before, or of its own", () => {
    const named = row("expo:John");
    expect(
      unset(
        service(
          named,
          '<variable name="user"><initialize><from expression="expo:John"/></initialize></variable>',
        ),
      ),
    ).toEqual([]);
    expect(unset(service(named, undefined, `<condition>${row("?user", "?place")}</condition>`))).toEqual([]);
    expect(unset(service(named, undefined, '<ext:assign variable="user" expression="expo:John"/>'))).toEqual(
      [],
    );
    expect(unset(service(named, undefined, "", '<ext:input part="user" expression="expo:John"/>'))).toEqual(
      [],
    );
    expect(unset(service(named, undefined, '<invoke operation="ask"/>'), () => ["user"])).toEqual([]);
    expect(unset(service(named, undefined, '<invoke operation="ask"/>'), () => undefined)).toEqual([]); // its results are not known
    expect(unset(service(named, undefined, '<invoke operation="ask"/>'))).toEqual(["user"]);
  });
  it("says where a value comes from", () => {
    const from = (document: ReturnType<typeof service>) =>
      sourceOf(document, document.flows[0]!, document.flows[0]!.steps[2]!, "user", () => []);
    expect(from(service(row("?user")))).toEqual({ from: "activator" });
    expect(
      from(service(row("expo:John"), undefined, `<condition>${row("$user", "?p")}</condition>`)),
    ).toEqual({ from: "step", step: "First" });
    expect(from(service(""))).toEqual({ from: "start" });
  });
  it("is offered the one that the situation names, and has no finding then", () => {
    const document = service(row("expo:John"));
    const findings = (d: typeof document) =>
      unsetFindings(d, called, [], { verbs: [], classes: [], things: [] });
    const [finding] = findings(document);
    expect(finding?.message).toBe("The value user is never set before: Booth guide then takes any Visitor.");
    expect(finding?.remedy).toBe("Set user to John");
    const mended = readCawl(applyChanges(document.text, finding?.fix ?? []));
    expect(mended.flows[0]?.variables[0]).toMatchObject({
      name: "user",
      type: "docent:Visitor",
      initial: "expo:John",
    });
    expect(findings(mended)).toEqual([]);
    expect(findings(service(row("expo:John") + row("expo:Mary")))[0]?.fix).toEqual([]); // which one is not said
  });
  it("has its first value taken away again", () => {
    const document = service("", '<variable name="user" type="docent:Visitor"/>');
    const set = (d: typeof document, to: string) => {
      const edits = new Edits(d);
      edits.setInitial(d.flows[0]!, "user", to);
      return readCawl(applyChanges(d.text, edits.changes));
    };
    const begun = set(document, "expo:John");
    expect(set(begun, "expo:Mary").flows[0]?.variables[0]?.initial).toBe("expo:Mary");
    expect(set(begun, "").text).toBe(document.text);
  });
});
