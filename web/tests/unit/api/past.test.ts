// The past: times in addresses, runs and robots read from facts, marks of the time bar.
import { describe, expect, it } from "vitest";
import { readTime, serverIsAhead, shownNow, timeText } from "../../../src/api/past";
import type { Row, Value } from "../../../src/api/sparql";
import { nextMark, readMarks, usualSpan } from "../../../src/operate/marks";
import { readRobots } from "../../../src/facts/past_robots";
import { readRuns, runQuery } from "../../../src/operate/past_runs";
import { readWays, restOf } from "../../../src/hall/ways";

const docent = "https://w3id.org/docent#";
const prov = "http://www.w3.org/ns/prov#";
const iri = (text: string): Value => ({ kind: "iri", text });
const word = (text: string): Value => ({ kind: "literal", text });
const fact = (s: string, p: string, o: Value): Row => ({
  s: iri(s),
  p: iri(p.includes("#") ? p : docent + p),
  o,
});

const run = "urn:docent:run:Guide-1";
const facts = [
  fact(run, "runState", word("running")),
  fact(run, "workflow", word("Guide")),
  fact(run, "flow", word("Guide")),
  fact(run, `${prov}startedAtTime`, word("2026-11-26T10:40:16.829Z")),
  fact(run, "hasVariable", iri(`${run}/$user`)),
  fact(`${run}/$user`, "variableName", word("user")),
  fact(`${run}/$user`, "variableValue", iri("urn:John")),
  fact(`${run}/B`, "ofRun", iri(run)),
  fact(`${run}/B`, "nodeName", word("B")),
  fact(`${run}/B`, "position", word("2")),
  fact(`${run}/B`, "nodeState", word("waiting")),
  fact(`${run}/B`, "waitsFor", word("ASK {}")),
  fact(`${run}/A`, "ofRun", iri(run)),
  fact(`${run}/A`, "nodeName", word("A")),
  fact(`${run}/A`, "position", word("1")),
  fact(`${run}/A`, "nodeState", word("done")),
  fact(`${run}/A/10`, "ofNode", iri(`${run}/A`)),
  fact(`${run}/A/10`, "operation", word("say")),
  fact(`${run}/A/10`, "invocationState", word("done")),
  fact(`${run}/A/2`, "ofNode", iri(`${run}/A`)),
  fact(`${run}/A/2`, "operation", word("drive")),
  fact(`${run}/A/2`, "invocationState", word("done")),
  fact(`${run}/A/2`, "robot", iri("urn:R01")),
];

describe("the past", () => {
  it("a time stands in the address as text; what is no time is now", () => {
    expect(readTime(`?at=R01&t=${encodeURIComponent(timeText(1795689616830))}`)).toBe(1795689616830);
    expect(readTime("?t=yesterday")).toBe(null);
    expect(readTime("")).toBe(null);
  });
  it("times of now go by the server's clock, where it is another one", () => {
    serverIsAhead(400); // the way of an answer
    expect(Math.abs(shownNow() - Date.now())).toBeLessThan(200);
    serverIsAhead(-86_400_000);
    expect(Math.abs(shownNow() - Date.now() + 86_400_000)).toBeLessThan(200);
    serverIsAhead(0);
  });
  it("a run is read from its facts, steps and what they do in order", () => {
    const [read, ...more] = readRuns(facts);
    expect(more).toEqual([]);
    expect(read).toMatchObject({
      id: "Guide-1",
      workflow: "Guide",
      state: "running",
      startedUs: 1795689616829000n,
      endedUs: 0n,
      paused: false,
    });
    expect(read?.nodes.map((n) => [n.name, n.state, n.waitsFor])).toEqual([
      ["A", "done", ""],
      ["B", "waiting", "ASK {}"],
    ]);
    expect(read?.nodes[0]?.invocations.map((i) => [i.operation, i.robot])).toEqual([
      ["drive", "urn:R01"],
      ["say", ""],
    ]);
    expect(read?.variables.map((v) => [v.name, v.value?.kind.value])).toEqual([["user", "urn:John"]]);
  });
  it("facts of nothing known make no run", () => {
    expect(readRuns([fact("urn:x", "nodeState", word("done")), {}])).toEqual([]);
  });
  it("the id of a run stays inside the query's IRI", () => {
    expect(runQuery("x> } DROP")).not.toContain("x> }");
  });
  it("robots are read with what they did", () => {
    const { robots } = readRobots([
      {
        r: iri("urn:R01"),
        x: word("1.5"),
        y: word("2"),
        heading: word("-1.5"),
        status: iri(`${docent}Busy`),
        region: iri("urn:B03"),
        run: iri(run),
        operation: word("drive"),
        node: word("A"),
      },
      { r: iri("urn:x/R02") },
    ]);
    expect(robots[0]).toMatchObject({
      robot: "urn:R01",
      state: "busy",
      hasPose: true,
      xM: 1.5,
      regions: ["urn:B03"],
      heldBy: "Guide-1",
    });
    expect(robots[0]?.heldFor[0]).toMatchObject({ run: "Guide-1", node: "A", operation: "drive" });
    expect(robots[1]).toMatchObject({ label: "R02", state: "offline", hasPose: false, outOfService: false });
  });
  it("marks are in order, just after what happened, and lead from one to the next", () => {
    const mark = (t: string, what: string, node?: string): Row => ({
      t: word(t),
      r: iri(run),
      what: word(what),
      ...(node && { node: word(node) }),
    });
    const marks = readMarks([
      mark("2026-11-26T10:40:20.5Z", "done"),
      mark("2026-11-26T10:40:16Z", "begins"),
      mark("2026-11-26T10:40:18Z", "opens", "A"),
      mark("no time", "done"),
    ]);
    expect(marks.map((m) => m.words)).toEqual(["Guide-1 begins", "A of Guide-1 opens", "Guide-1 is done"]);
    const at = Date.parse("2026-11-26T10:40:18.001Z");
    expect(marks[1]?.ms).toBe(at);
    expect(nextMark(marks, at, -1)?.words).toBe("Guide-1 begins");
    expect(nextMark(marks, at, 1)?.ends).toBe(true);
    expect(nextMark(marks, marks[2]!.ms, 1)).toBe(undefined);
    expect(usualSpan(marks, at + 10_000)).toBe(5 * 60_000);
    expect(usualSpan(marks, at + 3600_000 * 30)).toBe(7 * 24 * 3600_000);
    expect(usualSpan([], at)).toBe(5 * 60_000);
  });
});

describe("ways of robots", () => {
  it("are read as points, and shorten as the robot drives", () => {
    const ways = readWays([
      { r: iri("urn:R01"), path: word("LINESTRING(0 0, 4 0, 4 3)"), deviation: word("0.10") },
      { r: iri("urn:R02"), deviation: word("x") },
      { r: iri("urn:R03"), path: word("nonsense") },
    ]);
    const way = ways.get("urn:R01");
    expect(way?.deviationM).toBe(0.1);
    expect(restOf(way?.path ?? [], { x: 2, y: 0.1 })).toEqual([
      { x: 2, y: 0.1 },
      { x: 4, y: 0 },
      { x: 4, y: 3 },
    ]);
    expect(restOf(way?.path ?? [], { x: 4, y: 1 })).toEqual([
      { x: 4, y: 1 },
      { x: 4, y: 3 },
    ]);
    expect(ways.get("urn:R02")).toEqual({ path: [], deviationM: null });
    expect(restOf(ways.get("urn:R03")?.path ?? [], { x: 0, y: 0 })).toEqual([]);
  });
});
