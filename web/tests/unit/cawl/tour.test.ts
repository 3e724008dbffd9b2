// A tour from the map: its text, and its estimated time.
import { describe, expect, it } from "vitest";
import { readCawl } from "../../../src/cawl/document";
import { tourChoices, type TourOffer, tourSeconds, tourText } from "../../../src/cawl/tour";
import { newTour, readTour } from "../../../src/operate/tour_draft";
import { roadmapText } from "../../../src/operate/legs";

const stop = (name: string, x: number, more = {}) => ({
  iri: `urn:${name}`,
  term: `expo:${name}`,
  name,
  x,
  y: 0,
  ...more,
});
const plan = {
  name: "Tour",
  travel: "moveToBooth",
  present: ["display", "brief"],
  waitForVisitor: true,
  speak: "say",
};
const prefixes = new Map([["expo", "urn:"]]);

describe("a tour", () => {
  it("does at each stop what was chosen there, or for the whole tour", () => {
    const text = tourText(
      {
        ...plan,
        stayNear: true,
        stops: [
          stop("B1", 0),
          stop("B2", 5, { present: ["brief"], say: 'It\'s <here> & "there",\nwhere \\ is' }),
        ],
      },
      prefixes,
    );
    const document = readCawl(text);
    expect(document.problems).toEqual([]);
    expect(document.flows[0]?.steps.map((s) => [s.name, s.invokes.map((i) => i.target)])).toEqual([
      ["Begin", []],
      ["To B1", ["moveToBooth"]],
      ["At B1", ["display", "brief"]],
      ["To B2", ["moveToBooth"]],
      ["At B2", ["say", "brief"]],
      ["End", []],
    ]);
    expect(text).toContain(`expression="'It\\'s &lt;here> &amp; &quot;there&quot;, where \\\\ is'"`);
    expect(document.flows[0]?.steps.map((s) => s.whileHolds)).toEqual([
      "",
      "",
      "",
      "$user docent:isNear $robot",
      "",
      "",
    ]);
    expect(document.flows[0]?.variables.map((v) => v.name)).toContain("text");
  });
  it("has no text where nothing is said, or nothing can speak", () => {
    for (const text of [
      tourText({ ...plan, stops: [stop("B1", 0, { say: "  " })] }, prefixes),
      tourText({ ...plan, speak: "", stops: [stop("B1", 0, { say: "Hello" })] }, prefixes),
    ]) {
      expect(text).not.toContain("ext:input");
      expect(text).not.toContain('name="text"');
    }
  });
  it("takes longer by what is said, and by the ways that routes tell", () => {
    const stops = [stop("B1", 6), stop("B2", 12)];
    const straight = tourSeconds(stops, { x: 0, y: 0 });
    expect(straight).toBeCloseTo((12 * 1.3) / 0.6 + 50);
    expect(tourSeconds(stops, { x: 0, y: 0 }, [undefined, 30])).toBeCloseTo((6 * 1.3 + 30) / 0.6 + 50);
    expect(tourSeconds([stops[0]!, { ...stops[1]!, say: "x".repeat(140) }], { x: 0, y: 0 })).toBeCloseTo(
      straight + 10,
    );
  });
  it("reads the roadmap of the hall", () => {
    const row = (from: string, to: string, length = "") => ({
      from: { kind: "literal" as const, text: from },
      to: { kind: "literal" as const, text: to },
      ...(length && { length: { kind: "literal" as const, text: length } }),
    });
    expect(roadmapText([row("0 0", "POINT(4 0)"), row("POINT(4 0)", "4 3", "12.5"), {}])).toBe(
      "0 0 POINT(4 0); POINT(4 0) 4 3 12.5",
    );
    expect(roadmapText([])).toBe("");
  });
  const offer = (
    kind: TourOffer["kind"],
    id: string,
    inputs: string[] = [],
    uses: string[] = [],
  ): TourOffer => ({ kind, id, title: id, inputs: inputs.map((name) => ({ name, type: "" })), uses });
  it("presents each thing once: services, and operations that no service is made of", () => {
    const world = [
      offer("service", "moveToUser", ["user"], ["moveToUser"]),
      offer("service", "moveToBooth", ["booth"], ["moveToBooth"]),
      offer("service", "displayInformation", ["booth"], ["displayBoothInfo"]),
      offer("service", "briefInformation", ["booth"], ["briefBoothInfo"]),
      offer("operation", "briefBoothInfo", ["booth"]),
      offer("operation", "displayBoothInfo", ["booth"]),
      offer("operation", "showVideo", ["booth"]),
      offer("operation", "say", ["text"]),
      offer("workflow", "presentAll", ["booth"]),
    ];
    const choices = tourChoices(world);
    expect(choices.present).toEqual(["displayInformation", "briefInformation", "showVideo"]);
    expect([choices.travelBy, choices.travel.map((e) => e.id), choices.speak]).toEqual([
      "moveToBooth",
      ["moveToBooth"],
      "say",
    ]);
    expect(choices.at.map((e) => e.id)).toEqual([
      "displayInformation",
      "briefInformation",
      "briefBoothInfo",
      "displayBoothInfo",
      "showVideo",
    ]);
  });
  it("offers all where robots do not say what their operations take, and speaks by what takes a text alone", () => {
    const choices = tourChoices([
      offer("operation", "goTo"),
      offer("operation", "wave"),
      offer("operation", "announce"),
    ]);
    expect([
      choices.travel.map((e) => e.id),
      choices.travelBy,
      choices.at.map((e) => e.id),
      choices.present,
      choices.speak,
    ]).toEqual([["goTo"], "goTo", ["wave", "announce"], [], ""]);
    expect(tourChoices([])).toEqual({ travel: [], at: [], travelBy: "", present: [], speak: "" });
  });
  it("is kept as it was; what is broken is none", () => {
    const tour = {
      ...newTour,
      name: "Mine",
      stops: [stop("B1", 0, { say: "Hello" })],
      present: ["say"],
      wait: false,
    };
    expect(readTour(JSON.stringify(tour))).toEqual(tour);
    expect(readTour('{"stops":[{"iri":1},null]}')).toEqual(newTour);
    expect([readTour(null), readTour("{"), readTour('{"name":"x"}')]).toEqual([null, null, null]);
  });
});
