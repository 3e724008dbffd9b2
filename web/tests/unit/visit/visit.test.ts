// The parts of the visitors' page: what is said of a run, when a robot comes, texts in all languages, what is told once.
import { create, fromJson, type JsonObject } from "@bufbuild/protobuf";
import { describe, expect, it, vi } from "vitest";
import { type PlainError } from "../../../src/api/errors";
import { randomUuid } from "../../../src/api/ids";
import { AssertRequestSchema } from "../../../src/gen/docent/v1/context_pb";
import { RobotStatusSchema } from "../../../src/gen/docent/v1/fleet_pb";
import { RunSchema, WaitSchema } from "../../../src/gen/docent/v1/workflows_pb";
import {
  etaWords,
  secondsInQueue,
  secondsToGo,
  speedOf,
  withSighting,
  type Sighting,
} from "../../../src/visit/estimate";
import { journeyOf, type Naming, readPatterns, type Visit } from "../../../src/visit/journey";
import { Outbox, type OutboxPorts } from "../../../src/visit/outbox";
import { findPlace, type Place } from "../../../src/visit/places";
import { chooseLanguage, languages, sayIn } from "../../../src/visit/words";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const me = "urn:uuid:1";
const naming: Naming = {
  place: (iri) => (/#B\d+$|Entrance/.test(iri) ? iri.slice(iri.indexOf("#") + 1) : ""),
  robot: (iri) => (/#R\d+$/.test(iri) ? iri.slice(-3) : ""),
  property: (iri) => iri.slice(iri.indexOf("#") + 1),
  clock: () => "10:30",
};
const visit: Visit = { visitor: me, at: `${expo}B07`, booth: `${expo}B05`, met: false };
const robot = (values: JsonObject = {}) =>
  fromJson(RobotStatusSchema, {
    robot: `${expo}R01`,
    label: "R01",
    state: "standby",
    hasPose: true,
    ...values,
  });
const node = (name: string, state: string, invocation?: JsonObject): JsonObject => ({
  name,
  state,
  ...(invocation && { invocations: [invocation] }),
});
const run = (nodes: JsonObject[], values: JsonObject = {}) =>
  fromJson(RunSchema, { id: "G-1", state: "running", nodes, ...values });
const fact = (missing: string) => create(WaitSchema, { kind: "fact", missing });
const drives = { state: "running", robot: `${expo}R01` };

describe("how far it is", () => {
  const phase = (r: ReturnType<typeof run>, robots = [robot({ state: "busy", heldBy: "G-1" })], v = visit) =>
    journeyOf(r, [], robots, v, naming).phase;
  it("is told from the run and where the robot is", () => {
    expect(phase(run([node("a", "waiting"), node("b", "inactive")]), [robot()])).toBe("waiting");
    expect(phase(run([node("a", "running", drives), node("b", "inactive")]))).toBe("coming");
    const here = robot({ state: "busy", heldBy: "G-1", regions: [`${expo}B07`] });
    expect(
      phase(run([node("a", "done", { state: "done", robot: `${expo}R01` }), node("b", "waiting")]), [here]),
    ).toBe("here");
    expect(
      phase(
        run([node("a", "done", { state: "done", robot: `${expo}R01` }), node("b", "running", drives)]),
        undefined,
        { ...visit, met: true },
      ),
    ).toBe("guiding");
    const there = robot({ state: "busy", heldBy: "G-1", regions: [`${expo}B05`] });
    const atIt = { ...visit, at: `${expo}B05`, met: true };
    expect(
      phase(
        run([node("a", "done", { state: "done", robot: `${expo}R01` }), node("c", "running", drives)]),
        [there],
        atIt,
      ),
    ).toBe("presenting");
    expect(
      phase(run([node("b", "done", { state: "done", robot: `${expo}R01` }), node("c", "waiting")]), [there], {
        ...visit,
        met: true,
      }),
    ).toBe("ahead");
    expect(phase(run([node("a", "incident")]))).toBe("staff");
    expect(phase(run([], { state: "done" }))).toBe("done");
    expect(phase(run([], { state: "cancelled" }))).toBe("cancelled");
  });
  it("nothing is presented while the visitor is elsewhere: the robot still comes to its place there", () => {
    const there = robot({ state: "busy", heldBy: "G-1", regions: [`${expo}B05`] });
    const met = { ...visit, met: true };
    const last = (values: JsonObject) =>
      run([
        node("a", "done", { state: "done", robot: `${expo}R01` }),
        { ...node("c", "running", drives), ...values },
      ]);
    expect(phase(last({}), [there], met)).toBe("guiding");
    expect(phase(last({ firedBecause: `<${me}> <${docent}isAt> <${expo}B05> .\n` }), [there], met)).toBe(
      "presenting",
    ); // a badge told it
    // The booth is the one where the robot was called to: it comes first.
    expect(
      phase(run([node("a", "running", drives), node("c", "inactive")]), [there], {
        ...visit,
        at: `${expo}B05`,
      }),
    ).toBe("here");
  });
  it("a robot that only passes by is not with the visitor while no step is done", () => {
    expect(
      phase(run([node("a", "running", drives)]), [robot({ state: "busy", regions: [`${expo}B07`] })], {
        ...visit,
        at: "",
      }),
    ).toBe("coming");
  });
});

describe("why it waits", () => {
  const why = (missing: string, robots = [robot()], v = visit) =>
    journeyOf(run([node("a", "waiting")]), [fact(missing)], robots, v, naming).reasons;
  const status = `<${expo}R01> <${docent}status> <${docent}Standby> . <${expo}R01> <${docent}localised> true .`;
  it("is the state of the robots", () => {
    expect(why(status, [robot({ state: "busy", heldBy: "G-0" })])).toEqual([
      { word: "why.busy", values: { robot: "R01" } },
    ]);
    expect(why(status, [robot({ state: "charging" })])).toEqual([
      { word: "why.charging", values: { robot: "R01" } },
    ]);
    expect(why(status, [robot({ outOfService: true, outOfServiceReason: "a wheel squeaks" })])).toEqual([
      { word: "why.outReason", values: { robot: "R01", reason: "a wheel squeaks" } },
    ]);
    expect(why(status, [robot({ state: "offline" })])).toEqual([
      { word: "why.offline", values: { robot: "R01" } },
    ]);
    expect(why(status, [robot({ state: "busy", endingCommands: ["x"] })])).toEqual([
      { word: "why.ending", values: { robot: "R01" } },
    ]);
    expect(why(`?robot <${docent}status> <${docent}Standby> .`, [])).toEqual([{ word: "why.noRobot" }]);
    expect(why(`<${expo}R01> <${docent}localised> true .`)).toEqual([
      { word: "why.lost", values: { robot: "R01" } },
    ]);
  });
  it("the one that is nearest to being free comes first", () => {
    const robots = [
      robot({ state: "offline" }),
      robot({ robot: `${expo}R02`, label: "R02", state: "busy", heldBy: "G-0" }),
    ];
    expect(why(`?robot <${docent}status> <${docent}Standby> .`, robots).map((r) => r.word)).toEqual([
      "why.busy",
      "why.offline",
    ]);
  });
  it("is what the visitor has to do", () => {
    expect(why(`<${me}> <${docent}isAt> ?where .`)).toEqual([{ word: "why.place", remedy: "place" }]);
    expect(why(`<${me}> <${docent}selected> <${expo}B01> .`)).toEqual([
      { word: "why.booth", remedy: "booth" },
    ]);
    expect(why(`<${me}> <${docent}isAt> <${expo}B05> .`)).toEqual([
      { word: "why.follow", values: { place: "B05" }, remedy: "here" },
    ]);
    expect(why(`<${expo}R01> <${docent}isAt> <${expo}B05> .`)).toEqual([
      { word: "why.robotThere", values: { robot: "R01", place: "B05" } },
    ]);
  });
  it("is any other fact in words, never as a program writes it", () => {
    expect(why(`<${expo}Door> <${expo}isOpen> "true"^^<http://www.w3.org/2001/XMLSchema#boolean> .`)).toEqual(
      [{ word: "why.other", values: { fact: "Door isOpen true" } }],
    );
    expect(why('?x <urn:says> "a . b \\" c" .')).toEqual([
      { word: "why.other", values: { fact: '… urn:says a . b " c' } },
    ]);
  });
  it("is the staff, a pause, a time", () => {
    const of = (kind: string, untilUs = 0n) =>
      journeyOf(run([]), [create(WaitSchema, { kind, untilUs })], [], visit, naming).reasons;
    expect(of("resume")).toEqual([{ word: "why.paused" }]);
    expect(of("operator")).toEqual([{ word: "why.staff" }]);
    expect(of("time", 5n)).toEqual([{ word: "why.time", values: { time: "10:30" } }]);
    expect(of("command")).toEqual([]);
    expect(of("something new")).toEqual([]);
  });
  it("patterns are read, also odd ones", () => {
    expect(readPatterns("<a> <b> ?c . ?d <e> true .")).toEqual([
      { subject: "a", property: "b", object: "?c" },
      { subject: "?d", property: "e", object: "true" },
    ]);
    expect(readPatterns("")).toEqual([]);
    expect(readPatterns("not a pattern")).toHaveLength(1);
  });
});

describe("when it comes", () => {
  it("by its way and its own speed, or the usual one", () => {
    let seen: Sighting[] = [];
    for (let i = 0; i <= 8; i++) seen = withSighting(seen, { x: i, y: 0, ms: i * 1000 });
    expect(speedOf(seen)).toBeCloseTo(1);
    expect(secondsToGo({ x: 8, y: 0 }, { x: 18, y: 0 }, seen)).toBeCloseTo(13);
    expect(secondsToGo({ x: 0, y: 0 }, { x: 6, y: 0 }, [])).toBeCloseTo(13);
  });
  it("a robot that stands is not for ever on its way", () => {
    expect(
      speedOf([
        { x: 0, y: 0, ms: 0 },
        { x: 0, y: 0, ms: 8000 },
      ]),
    ).toBeCloseTo(0.6);
  });
  it("what was seen long ago is forgotten", () => {
    expect(withSighting([{ x: 0, y: 0, ms: 0 }], { x: 50, y: 0, ms: 60_000 })).toHaveLength(1);
  });
  it("by who is before, where it is known how long that takes", () => {
    expect(secondsInQueue(0, [])).toBe(0);
    expect(secondsInQueue(2, [])).toBeNull();
    expect(secondsInQueue(2, [100, 60, 4000])).toBe(200);
    expect(etaWords(20)).toEqual({ word: "eta.soon" });
    expect(etaWords(200)).toEqual({ word: "eta.minutes", values: { minutes: 3 } });
  });
});

describe("words", () => {
  it("every language has every text, with the same values in it", () => {
    const english = languages.get("en") as Record<string, string>;
    expect([...languages.keys()].sort()).toEqual(["de", "en", "ko"]);
    const holes = (text = "") => [...text.matchAll(/\{\w+\}/g)].map((m) => m[0]).sort();
    for (const texts of languages.values()) {
      expect(Object.keys(texts).sort()).toEqual(Object.keys(english).sort());
      for (const [word, text] of Object.entries(texts)) {
        expect(text.trim()).not.toBe("");
        expect([word, holes(text)]).toEqual([word, holes(english[word])]);
      }
    }
  });
  it("the language is the first wanted one that is there", () => {
    expect(chooseLanguage(["fr-FR", "de-AT", "en"])).toBe("de");
    expect(chooseLanguage(["", "KO"])).toBe("ko");
    expect(chooseLanguage(["xx"])).toBe("en");
    expect(sayIn("de")("why.busy", { robot: "R1" })).toBe("R1 ist bei einem anderen Besucher.");
    expect(sayIn("xx")("call")).toBe("Call the robot");
  });
});

describe("places", () => {
  const place = (iri: string, name: string): Place => ({
    iri,
    name,
    detail: "",
    booth: true,
    at: { x: 0, y: 0 },
  });
  const list = [place(`${expo}B05`, "B05"), place("https://x.example/halls/B5", "Café & Bar")];
  it("are found by all that a code may say", () => {
    for (const named of [`${expo}B05`, "expo:B05", "B05", "b05"])
      expect(findPlace(list, named)?.iri).toBe(`${expo}B05`);
    expect(findPlace(list, "café & bar")?.name).toBe("Café & Bar");
    expect(findPlace(list, "B5")?.name).toBe("Café & Bar");
    for (const named of ["", "B06", "<b>", "https://w3id.org/docent/expo"])
      expect(findPlace(list, named)).toBeUndefined();
  });
});

describe("what is told", () => {
  const away: PlainError = { kind: "away", title: "away", detail: "" };
  const kept = () => {
    const values = new Map<string, string>();
    return {
      getItem: (key: string) => values.get(key) ?? null,
      setItem: (key: string, value: string) => void values.set(key, value),
    };
  };
  it("is sent in order, again after a failure, and from the page after it is loaded again", async () => {
    vi.useFakeTimers();
    const storage = kept();
    const sent: string[] = [];
    let works = false;
    const ports: OutboxPorts = {
      storage,
      plain: () => away,
      send: async (r) => {
        if (!works) throw new Error("no");
        sent.push(r.requestId);
      },
    };
    const first = new Outbox(ports);
    first.put(create(AssertRequestSchema, { requestId: "1" }));
    first.put(create(AssertRequestSchema, { requestId: "2" }));
    await vi.advanceTimersByTimeAsync(3000);
    expect(first.state.kind).toBe("unsent");
    works = true;
    const second = new Outbox(ports); // the page is loaded again
    expect(second.state.kind).toBe("sending");
    await second.flush();
    expect(sent).toEqual(["1", "2"]);
    expect(second.state.kind).toBe("empty");
    expect(new Outbox(ports).state.kind).toBe("empty");
    vi.useRealTimers();
  });
  it("that the server refuses is said, and does not hold up what comes after", async () => {
    const sent: string[] = [];
    const outbox = new Outbox({
      storage: kept(),
      plain: () => ({ kind: "refused", title: "No", detail: "a bad term" }),
      send: async (r) => {
        if (r.requestId === "bad") throw new Error("no");
        sent.push(r.requestId);
      },
    });
    outbox.put(create(AssertRequestSchema, { requestId: "bad" }));
    await vi.waitFor(() => expect(outbox.state).toEqual({ kind: "refused", reason: "a bad term" }));
    outbox.put(create(AssertRequestSchema, { requestId: "good" }));
    await vi.waitFor(() => expect(outbox.state.kind).toBe("empty"));
    expect(sent).toEqual(["good"]);
  });
  it("what is kept may be broken", () => {
    expect(
      new Outbox({
        storage: { getItem: () => "{", setItem: () => undefined },
        plain: () => away,
        send: async () => undefined,
      }).state.kind,
    ).toBe("empty");
  });
  it("ids are random UUIDs", () => {
    expect(randomUuid()).toMatch(/^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/);
    expect(randomUuid()).not.toBe(randomUuid());
  });
});
