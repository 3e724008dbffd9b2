// Simulations: the canvas at a moment, where breakpoints stop, what was told, words.
import { fromJson, type JsonObject } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import {
  advance,
  commandsAfter,
  endOf,
  eventsOf,
  headAfter,
  headAt,
  placesAt,
  statesAt,
  stopsOf,
  type Telling,
  valuesAt,
} from "../../../src/compose/simulation";
import { classesIn, clockWords, eventWords, lacksOf, noteWords } from "../../../src/compose/simulation_words";
import { SimulateReplySchema } from "../../../src/gen/docent/v1/replays_pb";
import { QuadSchema } from "../../../src/gen/docent/v1/term_pb";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const names = {
  short: (iri: string) =>
    iri.startsWith(expo)
      ? `expo:${iri.slice(expo.length)}`
      : iri.startsWith(docent)
        ? `docent:${iri.slice(docent.length)}`
        : "",
};
const step = (afterS: number, node: string, state: string, turn = 10, cause = "") => ({
  node,
  afterS,
  step: { turn: String(turn), state, cause },
});
const command = (afterS: number, node: string, operation: string, turn = 10) => ({
  node,
  afterS,
  step: {
    turn: String(turn),
    operation,
    robot: `${expo}R01`,
    arguments: [{ name: "booth", value: { iri: `${expo}B03` } }],
  },
});
const reply = (steps: JsonObject[], values: JsonObject = {}) =>
  fromJson(SimulateReplySchema, { turn: "10", state: "running", steps, ...values });
const told = (afterS: number, o = "B03"): Telling => ({
  afterS,
  remove: false,
  quad: fromJson(QuadSchema, {
    subject: { iri: `${expo}John` },
    predicate: { iri: `${docent}selected` },
    object: { iri: `${expo}${o}` },
  }),
});
// Come opens at once and drives; Lead waits for a fact, which is told after 20 s.
const guide = [
  step(0, "", "running"),
  step(0, "Come", "waiting"),
  step(0, "Come", "running", 10, `condition Free holds with robot = <${expo}R01>, n = 3, text = "a, b"`),
  command(0, "Come", "come"),
  step(3, "Come", "done"),
  step(3, "Lead", "waiting"),
  step(20, "Lead", "running", 11, `condition Selected holds with booth = <${expo}B03>`),
  command(20, "Lead", "lead", 11),
  step(23, "Lead", "done", 11),
  step(23, "", "done", 11),
];
const steps = [
  { name: "Begin", kind: "source" },
  { name: "Come", kind: "node" },
  { name: "Lead", kind: "node" },
  { name: "End", kind: "sink" },
] as const;
const done = reply(guide, { state: "done", endedS: 23 });
const events = eventsOf(done, [told(20)]);
const statesOf = (afterS: number) =>
  Object.fromEntries(
    [...statesAt(events, headAt(events, afterS).done, steps)].map(([name, s]) => [name, s.state]),
  );

describe("the canvas at a moment", () => {
  it("shows each step's state at that time", () => {
    expect(statesOf(0)).toEqual({ Begin: "done", Come: "running", Lead: "inactive", End: "inactive" });
    expect(statesOf(2.9)).toMatchObject({ Come: "running", Lead: "inactive" });
    expect(statesOf(3)).toMatchObject({ Come: "done", Lead: "waiting" });
    expect(statesOf(22)).toMatchObject({ Lead: "running", End: "inactive" });
    expect(statesOf(23)).toEqual({ Begin: "done", Come: "done", Lead: "done", End: "done" });
  });
  it("before anything has happened, nothing has begun; steps of sub-flows are not the flow's own", () => {
    expect(statesAt(events, 0, steps).get("Begin")?.state).toBe("inactive");
    const nested = eventsOf(reply([step(0, "Visit/Come", "running")]), []);
    expect(statesAt(nested, 1, steps).get("Come")?.state).toBe("inactive");
  });
  it("back and next go event by event, also where several have one time", () => {
    expect(headAfter(events, 2)).toEqual({ afterS: 0, done: 2 });
    expect(statesAt(events, 2, steps).get("Come")?.state).toBe("waiting");
    expect(headAfter(events, -1)).toEqual({ afterS: 0, done: 0 });
    expect(headAfter(events, 99)).toEqual({ afterS: 23, done: events.length });
  });
  it("a run that ends waiting goes on waiting, and the clock can be set behind its last event", () => {
    expect(endOf(done, events)).toEqual({ endS: 23, lengthS: 23 });
    const waiting = reply(guide.slice(0, 6), { endedS: 3 });
    expect(endOf(waiting, eventsOf(waiting, []))).toEqual({ endS: 3, lengthS: 33 });
    expect(endOf(waiting, eventsOf(waiting, [told(40)])).endS).toBe(40);
  });
});

describe("breakpoints", () => {
  const at = (name: string, state: string) =>
    events.findIndex((e) => e.step?.node === name && e.step.step?.state === state);
  it("stop where their step opens, before it sends anything", () => {
    const stops = stopsOf(events, new Set(["Lead"]));
    expect(stops).toEqual([at("Lead", "running")]);
    const moved = advance(events, headAt(events, 5), 60, stops);
    expect(moved).toEqual({
      head: { afterS: 20, done: at("Lead", "running") + 1 },
      stop: at("Lead", "running"),
    });
    expect(commandsAfter(events, moved.head.done, "Lead").map((c) => c.step?.operation)).toEqual(["lead"]);
    expect(advance(events, moved.head, 60, stops)).toEqual({
      head: { afterS: 60, done: events.length },
      stop: -1,
    });
  });
  it("stop where their step comes to wait, if it never opens", () => {
    const waiting = eventsOf(reply(guide.slice(0, 6)), []);
    expect(stopsOf(waiting, new Set(["Lead", "Bye"]))).toEqual([5]);
  });
  it("stop each time that their step opens, in order of time", () => {
    const again = eventsOf(
      reply([step(0, "A", "running"), step(1, "B", "running"), step(2, "A", "running")]),
      [],
    );
    expect(stopsOf(again, new Set(["B", "A"]))).toEqual([0, 1, 2]);
  });
  it("tell the values that conditions have found so far", () => {
    expect([...valuesAt(events, headAt(events, 5).done)]).toEqual([
      ["robot", `<${expo}R01>`],
      ["n", "3"],
      ["text", '"a, b"'],
    ]);
    expect(valuesAt(events, events.length).get("booth")).toBe(`<${expo}B03>`);
  });
});

describe("facts that are told", () => {
  it("stand before what follows from them, and behind what was already there at that time", () => {
    expect(events.findIndex((e) => e.telling)).toBe(6);
    expect(eventWords(events[6] ?? { afterS: 0, telling: told(0) }, names)).toMatchObject({
      what: "told: expo:John docent:selected expo:B03",
    });
    const atOnce = eventsOf(
      reply([step(0, "", "running"), step(0, "Come", "waiting"), step(0, "Come", "running", 11)]),
      [told(0)],
    );
    expect(atOnce.map((e) => e.telling !== undefined)).toEqual([false, false, true, false]);
  });
  it("are in order of time, however they were told", () => {
    const later = eventsOf(reply([step(0, "", "running"), step(9, "Lead", "running", 12)]), [
      told(9, "B03"),
      told(4, "B01"),
    ]);
    expect(later.map((e) => e.afterS)).toEqual([0, 4, 9, 9]);
  });
  it("what lacks becomes rows; a variable has to be chosen, and what stands in the way goes", () => {
    const lacks = lacksOf(
      `<${expo}R01> <${docent}localised> true . ?user <${docent}isAt> ?userRegion . not <${expo}R01> <${docent}status> <${docent}Busy> .`,
      names,
    );
    expect(lacks.map((l) => [l.text, l.open, l.remove])).toEqual([
      ["expo:R01 docent:localised true", false, false],
      ["?user docent:isAt ?userRegion", true, false],
      ["expo:R01 docent:status docent:Busy", false, true],
    ]);
    expect(
      lacksOf(
        "nothing but time: its condition holds, and may open it from 2023-11-15T00:13:21Z on, 2h after it was entered",
        names,
      )[0]?.row,
    ).toBeNull();
    expect(
      lacksOf("<urn:a> <urn:b> <urn:c> . its time comes at 2023-11-15T00:13:21Z", names).map(
        (lack) => lack.row !== null,
      ),
    ).toEqual([true, false]);
    expect(
      lacksOf("nothing but a robot: those with which it holds are held by other runs", names)[0]?.row,
    ).toBeNull();
    expect(
      classesIn("ASK {\n  expo:John docent:selected ?booth .\n  ?booth rdf:type docent:Booth .\n}").get(
        "booth",
      ),
    ).toBe("docent:Booth");
  });
});

describe("robots on the map", () => {
  const poses = reply([], {
    poses: [
      { robot: "r", afterS: 1, x: 1 },
      { robot: "r", afterS: 2, x: 2 },
      { robot: "r", afterS: 50, x: 2, y: 1 },
    ],
  }).poses;
  it("move between their poses, and stand where they have come to", () => {
    expect(placesAt(poses, 1.5).get("r")).toMatchObject({ x: 1.5, y: 0, driving: true });
    expect(placesAt(poses, 30).get("r")).toMatchObject({ x: 2, y: 0, driving: false });
    expect(placesAt(poses, 0).get("r")).toMatchObject({ x: 1, driving: false });
    expect(placesAt(poses, 60).get("r")).toMatchObject({ x: 2, y: 1, driving: false });
  });
});

describe("words", () => {
  it("of the clock and of commands", () => {
    expect([clockWords(3.9), clockWords(83), clockWords(3723)]).toEqual(["00:03", "01:23", "1:02:03"]);
    const event = events[events.findIndex((e) => e.step?.step?.operation === "lead")];
    expect(event && eventWords(event, names)).toMatchObject({ who: "Lead", what: "R01 gets lead(B03)" });
  });
  it("of what was assumed", () => {
    expect(noteWords(`taken to be ready: <${expo}R01>, <${expo}R02>`)).toBe(
      "Taken to be free and ready: R01, R02.",
    );
    expect(noteWords("no robot offers bye, come: a simulated one does (<urn:docent:robot:simulated>)")).toBe(
      "No robot offers bye, come: a simulated robot does it.",
    );
    expect(
      noteWords("activator OnChoice does not fire on these facts; the run is started all the same"),
    ).toBe("OnChoice does not start a run on these facts; this one is started by hand.");
    expect(
      noteWords(
        "activator A does not fire on these facts; the run is started all the same; if they stay so, it fires at 2023-11-14T23:13:21Z",
      ),
    ).toBe(
      "A does not start a run on these facts; this one is started by hand. If they stay so, it fires at 2023-11-14T23:13:21Z.",
    );
    expect(noteWords(`something about <${expo}R01>`)).toBe("Something about R01.");
  });
});
