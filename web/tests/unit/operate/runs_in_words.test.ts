// A run in words: its history as sentences, how far it is with what it has started, and its version after the next deployment.
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { words } from "../../../src/cawl/names";
import { nextVersion } from "../../../src/compose/text_diff";
import { RunEventSchema, RunSchema } from "../../../src/gen/docent/v1/workflows_pb";
import { progressOf, stateOf, underWay, whereWords } from "../../../src/operate/runs_within";
import { eventsInWords, factsInWords } from "../../../src/operate/timeline_words";

const names = { name: (iri: string) => iri.replace(/^.*[#/]/, "") };
const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";

describe("the history of a run", () => {
  const said = (...events: MessageInitShape<typeof RunEventSchema>[]) =>
    eventsInWords(
      events.map((e) => create(RunEventSchema, e)),
      names,
    ).map((e) => e && [e.words, e.detail].filter(Boolean).join(": "));
  it("says what happened in sentences", () => {
    const facts = `<${expo}John> <${docent}isAt> <${expo}Entrance> . <${expo}John> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <${docent}Visitor> . `;
    expect(factsInWords(facts, names)).toBe("John is at Entrance, John is a Visitor");
    expect(
      said(
        { kind: "run", to: "running", detail: `activator : ${facts}` },
        {
          kind: "node",
          node: "Greet",
          from: "waiting",
          to: "running",
          detail: `condition Free holds with robot = <${expo}R01>`,
        },
        {
          kind: "invocation",
          node: "Greet",
          from: "pending",
          to: "running",
          detail: `Hello-1/Greet/0: moveToUser on <${expo}R01>`,
        },
        {
          kind: "command",
          node: "Greet",
          to: "sent",
          detail: `Hello-1/Greet/0/0.1/1/1@17 to <${expo}R01>: moveToUser(user=<${expo}John>), guard as of 19, deadline 17 us`,
        },
      ),
    ).toEqual([
      "began by itself: John is at Entrance, John is a Visitor",
      "opens: Free holds with robot = R01",
      "Move to user begins: on R01",
      "R01 gets the command: moveToUser(user=John)",
    ]);
  });
  it("leaves texts as they were spoken, with their markup", () => {
    const text = 'See you <b>soon</b> & (a), <http://x.org/y#z> \\"well\\"';
    expect(
      said({
        kind: "command",
        node: "Say",
        to: "sent",
        detail: `Tiny-1/Say/0/0.1/1/1@17 to <${expo}R01>: say(text="${text}"), guard as of 19, deadline 17 us`,
      }),
    ).toEqual([`R01 gets the command: say(text="${text}")`]);
    expect(factsInWords(`<${expo}R01> <${docent}says> "a <b>b</b> . c" . `, names)).toBe(
      "R01 says a <b>b</b> . c",
    );
  });
  it("says once that an operation of one step is done", () => {
    expect(
      said(
        {
          kind: "invocation",
          from: "pending",
          to: "running",
          detail: `Hello-1/Greet/0: say on <${expo}R01>`,
        },
        { kind: "invocation", from: "running", to: "done", detail: "Hello-1/Greet/0 1/1 say: " },
        { kind: "invocation", from: "running", to: "done", detail: "Hello-1/Greet/0: " },
      ),
    ).toEqual(["Say begins: on R01", null, "Say: done"]);
  });
});

describe("a run within a run", () => {
  const inner = create(RunSchema, {
    id: "BoothGuide-1",
    workflow: "BoothGuide",
    flow: "BoothGuide",
    state: "running",
    parent: "John-1",
    nodes: [
      { name: "a", state: "done" },
      { name: "b", state: "waiting" },
    ],
  });
  const outer = create(RunSchema, {
    id: "John-1",
    workflow: "John",
    flow: "John",
    state: "running",
    nodes: [
      {
        name: "guide",
        state: "running",
        invocations: [{ operation: "BoothGuide", state: "running", progress: 0.02 }],
      },
    ],
  });
  it("is as far as its steps are done, and waits where it waits", () => {
    expect(progressOf(outer, outer.nodes[0]!.invocations[0]!, [outer, inner])).toBe(0.5);
    expect(stateOf(inner, [outer, inner])).toBe("waiting");
    expect(stateOf(outer, [outer, inner])).toBe("waiting");
    expect(stateOf(outer, [outer])).toBe("running");
    expect(whereWords(outer, [outer, inner])).toBe("guide: b waits");
    expect(underWay(outer, [outer, inner])).toEqual([]);
    const driving = create(RunSchema, {
      id: "BoothGuide-1",
      workflow: "BoothGuide",
      flow: "BoothGuide",
      state: "running",
      parent: "John-1",
      nodes: [
        {
          name: "b",
          state: "running",
          invocations: [{ operation: "move", state: "running", robot: `${expo}R01`, command: "c1" }],
        },
      ],
    });
    expect(underWay(outer, [outer, driving])).toEqual([
      { robot: `${expo}R01`, node: "b", operation: "move" },
    ]);
  });
});

it("names that people wrote stay as they are", () => {
  expect([words("moveToUser"), words("John's Service"), words("BoothGuide")]).toEqual([
    "Move to user",
    "John's Service",
    "Booth guide",
  ]);
});
it("the next version is one higher at its end", () => {
  expect(["1.0", "2", "1.0.9", ""].map(nextVersion)).toEqual(["1.1", "3", "1.0.10", ""]);
});
