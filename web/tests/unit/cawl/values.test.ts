// What a step gives to an operation: what is written into the text, and what comes back from it.
import { describe, expect, it } from "vitest";
import { type Flow, readCawl } from "../../../src/cawl/document";
import { Edits } from "../../../src/cawl/edits";
import { applyChanges } from "../../../src/cawl/layout_of_text";
import { shownValue, writtenValue } from "../../../src/cawl/values";

const string = "http://www.w3.org/2001/XMLSchema#string";
const text = `<CAWL name="Two" xmlns:docent="https://w3id.org/docent#">
  <!-- two greetings -->
  <flow name="Two">
    <source name="Begin"/>
    <node name="Hello"><invoke operation="say"/></node>
    <node name="Bye">
      <invoke operation="say"/>
    </node>
    <sink name="End"/>
    <link from="Begin" to="Hello"/>
    <link from="Hello" to="Bye"/>
    <link from="Bye" to="End"/>
  </flow>
</CAWL>
`;
function edited(text: string, make: (edits: Edits, flow: Flow) => void): string {
  const document = readCawl(text);
  const edits = new Edits(document);
  make(edits, document.flows[0]!);
  return applyChanges(text, edits.changes);
}
const say = (words: string, step: string) => (edits: Edits, flow: Flow) =>
  edits.setInput(flow.steps.find((s) => s.name === step)!.invokes[0]!, "text", writtenValue(words, string));

describe("a value of a step's own", () => {
  it("is written into what the step does, and all else keeps its bytes", () => {
    const after = edited(text, say('Say "hi" to John', "Bye"));
    expect(after).toBe(
      text
        .replace('docent#">', 'docent#" xmlns:ext="https://w3id.org/docent/cawl-ext#">')
        .replace(
          '      <invoke operation="say"/>',
          `      <invoke operation="say">\n        <ext:input part="text" expression='"Say \\"hi\\" to John"'/>\n      </invoke>`,
        ),
    );
    expect(
      readCawl(after).flows[0]?.steps[2]?.invokes[0]!.inputs.map((i) => shownValue(i.expression)),
    ).toEqual(['Say "hi" to John']);
  });
  it("is changed and taken away again", () => {
    const hello = edited(text, say("Hello", "Hello"));
    const changed = edited(hello, say("Good morning", "Hello"));
    expect(changed).toBe(hello.replace("Hello\"'", "Good morning\"'"));
    expect(edited(changed, say("", "Hello"))).toBe(
      text.replace('docent#">', 'docent#" xmlns:ext="https://w3id.org/docent/cawl-ext#">'),
    );
  });
  it("keeps each step its own sentence", () => {
    const both = edited(edited(text, say("Hello", "Hello")), say("Goodbye", "Bye"));
    expect(
      readCawl(both).flows[0]?.steps.map((s) =>
        s.invokes.flatMap((i) => i.inputs.map((given) => shownValue(given.expression))).join(),
      ),
    ).toEqual(["", "Hello", "Goodbye", ""]);
  });
});

describe("what somebody types", () => {
  it("is a text, a thing, a number or a value of the run, as the input wants it", () => {
    expect(writtenValue("It's 7 o'clock", string)).toBe(`"It's 7 o'clock"`);
    expect(writtenValue("$booth", string)).toBe("$booth");
    expect(writtenValue("expo:B03", "https://w3id.org/docent#Booth")).toBe("expo:B03");
    expect(writtenValue("7", "")).toBe("7");
    expect(writtenValue("Good morning", "")).toBe('"Good morning"');
    expect(() => writtenValue("the café", "https://w3id.org/docent#Booth")).toThrow("no value here");
  });
});
