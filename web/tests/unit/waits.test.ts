// The board: what runs wait for, grouped by what lacks.
import { fromJson, type JsonObject } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { RunSchema, WaitSchema, type Wait } from "../../src/gen/docent/v1/workflows_pb";
import { factsOf, groupWaits } from "../../src/operate/waits";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const names = { short: (iri: string) => (iri.startsWith(expo) ? `expo:${iri.slice(expo.length)}` : iri.startsWith(docent) ? `docent:${iri.slice(docent.length)}` : ""), name: (iri: string) => iri.replace(/^.*[#/]/, "") };
const run = (id: string, values: JsonObject = {}) => fromJson(RunSchema, { id, state: "running", startedUs: "1000", nodes: [{ name: "n", state: "waiting", sinceUs: "2000", waitsFor: `ASK { ${id} }` }], ...values });
const wait = (values: JsonObject) => fromJson(WaitSchema, { node: "n", ...values });
const group = (runs: ReturnType<typeof run>[], waits: Record<string, Wait[]>) => groupWaits(runs, new Map(Object.entries(waits)), names, () => "10:30");

describe("the board", () => {
  it("100 runs that lack three facts are three rows, and the oldest is first", () => {
    const runs = Array.from({ length: 100 }, (_, i) => run(`r${i}`, { nodes: [{ name: "n", state: "waiting", sinceUs: String(5000 - i), waitsFor: "ASK {}" }] }));
    const waits = Object.fromEntries(runs.map((r, i) => [r.id, [wait({ kind: "fact", missing: `<${expo}R0${i % 3}> <${docent}status> <${docent}Standby> .` })]]));
    const groups = group(runs, waits);
    expect(groups.map((g) => [g.title, g.waiting.length])).toEqual([[["expo:R00 docent:status docent:Standby"], 34], [["expo:R02 docent:status docent:Standby"], 33], [["expo:R01 docent:status docent:Standby"], 33]]);
    expect(groups[0]?.waiting[0]?.run.id).toBe("r99");
    expect(groups[0]?.ask).toBe("ASK {}");
  });
  it("any of several robots will do: they are one thing", () => {
    const groups = group([run("a")], { a: [wait({ kind: "robot", robot: `${expo}R01`, heldBy: "b" }), wait({ kind: "robot", robot: `${expo}R02` })] });
    expect(groups).toMatchObject([{ kind: "robot", title: ["R01", "R02"], heldBy: "b" }]);
  });
  it("what somebody has to decide is first; what is under way is not there", () => {
    const groups = group([run("a"), run("b")], { a: [wait({ kind: "fact", missing: "x" }), wait({ kind: "command" }), wait({ kind: "subflow" }), wait({ kind: "join" }), wait({ kind: "news of tomorrow" })], b: [wait({ kind: "operator", detail: "it failed: no way; settle it: docent runs retry b n" })] });
    expect(groups.map((g) => [g.kind, g.title])).toEqual([["operator", ["no way"]], ["fact", ["x"]]]);
  });
  it("a node of a sub-flow is found in its own run", () => {
    const groups = group([run("outer"), run("inner-1", { parent: "outer", nodes: [{ name: "a/b", state: "incident" }] })], { outer: [wait({ node: "inner-1/a/b", kind: "operator", detail: "it failed: x" })] });
    expect(groups[0]?.waiting[0]).toMatchObject({ run: { id: "inner-1" }, node: { name: "a/b" }, root: { id: "outer" } });
  });
  it("pauses and times are said in words; runs that have ended do not wait", () => {
    const groups = group([run("a"), run("b"), run("c", { state: "done" })], { a: [wait({ node: "", kind: "resume", detail: "run a is paused (lunch); docent runs resume a" })], b: [wait({ kind: "time", untilUs: "5" })], c: [wait({ kind: "fact", missing: "x" })] });
    expect(groups.map((g) => g.title[0]).sort()).toEqual(["run a is paused (lunch)", "until 10:30"]);
  });
  it("several facts that lack are told apart", () => {
    expect(factsOf(`<${expo}R01> <${docent}status> <${docent}Standby> . <${expo}R01> <${docent}localised> true .`, names)).toEqual(["expo:R01 docent:status docent:Standby", "expo:R01 docent:localised true"]);
  });
});
