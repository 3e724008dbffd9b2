// The board: what runs wait for, grouped by what lacks.
import { fromJson, type JsonObject } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { limitWords } from "../../../src/api/errors";
import { replaceIris, splitFacts } from "../../../src/api/iris";
import { RobotStatusSchema } from "../../../src/gen/docent/v1/fleet_pb";
import { RunSchema, WaitSchema, type Wait } from "../../../src/gen/docent/v1/workflows_pb";
import { asMeant, factsOf, factWords } from "../../../src/facts/fact_words";
import { reasonWords } from "../../../src/operate/reason_words";
import { exchangeOf, fitFor } from "../../../src/operate/exchange";
import { groupWaits } from "../../../src/operate/waits";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const names = {
  short: (iri: string) =>
    iri.startsWith(expo)
      ? `expo:${iri.slice(expo.length)}`
      : iri.startsWith(docent)
        ? `docent:${iri.slice(docent.length)}`
        : "",
  name: (iri: string) => iri.replace(/^.*[#/]/, ""),
};
const run = (id: string, values: JsonObject = {}) =>
  fromJson(RunSchema, {
    id,
    state: "running",
    startedUs: "1000",
    nodes: [{ name: "n", state: "waiting", sinceUs: "2000", waitsFor: `ASK { ${id} }` }],
    ...values,
  });
const robot = (local: string, values: JsonObject) =>
  fromJson(RobotStatusSchema, { robot: expo + local, label: local, ...values });
const wait = (values: JsonObject) => fromJson(WaitSchema, { node: "n", ...values });
const group = (runs: ReturnType<typeof run>[], waits: Record<string, Wait[]>) =>
  groupWaits(runs, new Map(Object.entries(waits)), names, () => "10:30");

describe("the board", () => {
  it("100 runs that lack three facts are three rows, and the oldest is first", () => {
    const runs = Array.from({ length: 100 }, (_, i) =>
      run(`r${i}`, {
        nodes: [{ name: "n", state: "waiting", sinceUs: String(5000 - i), waitsFor: "ASK {}" }],
      }),
    );
    const waits = Object.fromEntries(
      runs.map((r, i) => [
        r.id,
        [wait({ kind: "fact", missing: `<${expo}R0${i % 3}> <${docent}status> <${docent}Standby> .` })],
      ]),
    );
    const groups = group(runs, waits);
    expect(groups.map((g) => [g.title, g.waiting.length])).toEqual([
      [["expo:R00 docent:status docent:Standby"], 34],
      [["expo:R02 docent:status docent:Standby"], 33],
      [["expo:R01 docent:status docent:Standby"], 33],
    ]);
    expect(groups[0]?.waiting[0]?.run.id).toBe("r99");
    expect(groups[0]?.ask).toBe("ASK {}");
  });
  it("any of several robots will do: they are one thing", () => {
    const groups = group([run("a")], {
      a: [
        wait({ kind: "robot", robot: `${expo}R01`, heldBy: "b" }),
        wait({ kind: "robot", robot: `${expo}R02` }),
      ],
    });
    expect(groups).toMatchObject([{ kind: "robot", title: ["R01", "R02"], heldBy: "b" }]);
    const waits = new Map([
      ["a", [wait({ kind: "robot", robot: `${expo}R01` }), wait({ kind: "robot", robot: `${expo}R02` })]],
    ]);
    expect(
      groupWaits([run("a")], waits, names, () => "", [
        robot("R01", { state: "offline" }),
        robot("R02", { state: "busy" }),
      ]),
    ).toMatchObject([{ title: ["R01 (offline)", "R02"], noRobot: "" }]);
  });
  it("what somebody has to decide is first; what is under way is not there", () => {
    const groups = group([run("a"), run("b")], {
      a: [
        wait({ kind: "fact", missing: "x" }),
        wait({ kind: "command" }),
        wait({ kind: "subflow" }),
        wait({ kind: "join" }),
        wait({ kind: "news of tomorrow" }),
      ],
      b: [wait({ kind: "operator", detail: "it failed: no way; settle it: docent runs retry b n" })],
    });
    expect(groups.map((g) => [g.kind, g.title])).toEqual([
      ["operator", ["no way"]],
      ["fact", ["x"]],
    ]);
  });
  it("a node of a sub-flow is found in its own run", () => {
    const groups = group(
      [run("outer"), run("inner-1", { parent: "outer", nodes: [{ name: "a/b", state: "incident" }] })],
      { outer: [wait({ node: "inner-1/a/b", kind: "operator", detail: "it failed: x" })] },
    );
    expect(groups[0]?.waiting[0]).toMatchObject({
      run: { id: "inner-1" },
      node: { name: "a/b" },
      root: { id: "outer" },
    });
  });
  it("pauses and times are said in words; runs that have ended do not wait", () => {
    const groups = group([run("a"), run("b"), run("c", { state: "done" })], {
      a: [wait({ node: "", kind: "resume", detail: "run a is paused (lunch); docent runs resume a" })],
      b: [wait({ kind: "time", untilUs: "5" })],
      c: [wait({ kind: "fact", missing: "x" })],
    });
    expect(groups.map((g) => g.title[0]).sort()).toEqual(["run a is paused (lunch)", "until 10:30"]);
  });
  it("several facts that lack are told apart", () => {
    expect(
      factsOf(
        `<${expo}R01> <${docent}status> <${docent}Standby> . <${expo}R01> <${docent}localised> true .`,
        names,
      ),
    ).toEqual(["expo:R01 docent:status docent:Standby", "expo:R01 docent:localised true"]);
  });

  it("facts that a robot tells of itself are not asked of people: why no robot can come is said", () => {
    const missing = `<${expo}R01> <${docent}status> <${docent}Standby> . <${expo}R01> <${docent}localised> true .`;
    const waits = { a: [wait({ kind: "fact", missing })] };
    const off = robot("R01", { state: "offline", lastSeenUs: "1795666891731000", address: "127.0.0.1:1" });
    const [group] = groupWaits([run("a")], new Map(Object.entries(waits)), names, () => "", [off]);
    expect(group).toMatchObject({ kind: "robot", title: [], ask: "" });
    expect(group?.noRobot).toMatch(/^No robot can come: R01 is offline since .*:31/);
    expect(
      groupWaits([run("a")], new Map(Object.entries(waits)), names, () => "", [
        robot("R01", { state: "busy", address: "x:1", heldBy: "Other%20one-3" }),
      ])[0]?.noRobot,
    ).toBe("No robot can come: R01 works for Other one-3");
    // Of one that people play, without an adapter, they tell it.
    expect(
      groupWaits([run("a")], new Map(Object.entries(waits)), names, () => "", [
        robot("R01", { state: "busy" }),
      ])[0],
    ).toMatchObject({ kind: "fact", noRobot: "", ask: "ASK { a }" });
    // What people tell beside it stays.
    const both = {
      a: [wait({ kind: "fact", missing: `${missing} <${expo}John> <${docent}isAt> ?where .` })],
    };
    expect(groupWaits([run("a")], new Map(Object.entries(both)), names, () => "", [off])[0]).toMatchObject({
      kind: "fact",
      title: ["expo:John docent:isAt ?where"],
      ask: "ASK { a }",
      noRobot: expect.stringMatching(/offline/),
    });
  });
  it("a fact of a robot that is away is told by its robot alone: the cause is said, and what people can tell stays", () => {
    const r01 = { case: "iri" as const, value: `${expo}R01` };
    const missing = `<${expo}R01> <${docent}isAt> <${expo}Entrance> . <${expo}John> <${docent}selected> ?booth .`;
    const waits = new Map([["a", [wait({ kind: "fact", missing })]]]);
    const bound = run("a", { variables: [{ name: "robot", value: { iri: r01.value } }] });
    const off = robot("R01", { state: "offline", lastSeenUs: "1795666891731000", address: "127.0.0.1:1" });
    const free = robot("R02", { state: "standby", address: "127.0.0.1:2", hasPose: true });
    const [group] = groupWaits([bound], waits, names, () => "", [off, free]);
    expect(group).toMatchObject({
      kind: "fact",
      title: ["expo:John docent:selected ?booth"],
      robots: [`${expo}R01`],
      ask: "ASK { a }",
    });
    expect(group?.noRobot).toMatch(/^R01 is offline since .*:31/);
    const out = robot("R01", {
      state: "standby",
      address: "127.0.0.1:1",
      outOfService: true,
      outOfServiceReason: "a wheel is loose",
      hasPose: true,
    });
    expect(groupWaits([bound], waits, names, () => "", [out])[0]?.noRobot).toBe(
      "R01 is out of service: a wheel is loose",
    );
    // The robot is there, and only not yet at its place: that lacks, and is not for people to tell.
    const there = robot("R01", { state: "standby", address: "127.0.0.1:1", hasPose: true });
    expect(
      groupWaits(
        [run("a")],
        new Map([
          ["a", [wait({ kind: "fact", missing: `<${expo}R01> <${docent}isAt> <${expo}Entrance> .` })]],
        ]),
        names,
        () => "",
        [there],
      )[0],
    ).toMatchObject({ kind: "fact", title: ["expo:R01 docent:isAt expo:Entrance"], noRobot: "", ask: "" });
  });
  it("a robot that is needed is named with its reason, and so is one that is taken", () => {
    const waits = new Map([
      ["a", [wait({ kind: "robot", robot: `${expo}R01` }), wait({ kind: "robot", robot: `${expo}R02` })]],
    ]);
    const [group] = groupWaits([run("a")], waits, names, () => "", [
      robot("R01", { state: "standby", outOfService: true, outOfServiceReason: "no brakes" }),
      robot("R02", { state: "offline", outOfService: true, lastSeenUs: "0" }),
    ]);
    expect(group).toMatchObject({
      title: ["R01 (out of service: no brakes)", "R02 (out of service, and offline)"],
      robots: [`${expo}R01`, `${expo}R02`],
    });
  });
  it("each alternative is a group with a condition of its own", () => {
    const waiting = run("a", {
      nodes: [{ name: "n", state: "waiting", sinceUs: "2000", waitsFor: "ASK { one }\n# or\nASK { two }" }],
    });
    const lacks = [`<${expo}S1> <${expo}open> true`, `<${expo}S2> <${expo}open> true`].map((missing) =>
      wait({ kind: "fact", missing }),
    );
    expect(groupWaits([waiting], new Map([["a", lacks]]), names, () => "").map((g) => g.ask)).toEqual([
      "ASK { one }",
      "ASK { two }",
    ]);
    const robots = [
      wait({ kind: "robot", robot: `${expo}R01` }),
      wait({ kind: "robot", robot: `${expo}R02` }),
    ];
    expect(
      groupWaits([waiting], new Map([["a", [...robots, lacks[0]!]]]), names, () => "").map((g) => g.ask),
    ).toEqual(["", ""]);
  });
  it("a run hangs whose command's robot is offline", () => {
    const waits = new Map([["a", [wait({ kind: "command", robot: `${expo}R01` })]]]);
    expect(groupWaits([run("a")], waits, names, () => "", [robot("R01", { state: "busy" })])).toEqual([]);
    expect(
      groupWaits([run("a")], waits, names, () => "", [robot("R01", { state: "offline" })]),
    ).toMatchObject([{ kind: "lost", title: ["R01 is offline"], waiting: [{ node: { name: "n" } }] }]);
  });
});

describe("another robot", () => {
  const of = (local: string) => ({ name: "robot", value: { iri: expo + local } });
  const moving = {
    name: "m",
    state: "running",
    invocations: [{ operation: "drive", state: "running", robot: `${expo}R01`, command: "c" }],
  };
  const waiting = { name: "n", state: "waiting", waitsFor: "ASK {}" };
  const causes = [`${expo}R01`];
  it("is for a step that waits for its situation with the robot of its run, in the runs around it, too", () => {
    const outer = run("outer", {
      variables: [of("R01"), of("R09")],
      nodes: [{ name: "o", state: "running", invocations: [{ operation: "inner", state: "running" }] }],
    });
    const inner = run("inner", { parent: "outer", variables: [of("R01")], nodes: [waiting] });
    expect(exchangeOf(inner, inner.nodes[0]!, [outer, inner], causes)).toMatchObject({
      how: "set",
      robot: `${expo}R01`,
      values: [
        { run: "inner", name: "robot" },
        { run: "outer", name: "robot" },
      ],
    });
  });
  it("is not for what has begun with the robot, is open, has ended, or names none", () => {
    const busy = run("a", { variables: [of("R01")], nodes: [waiting, moving] });
    expect(exchangeOf(busy, busy.nodes[0]!, [busy], causes)).toBe(null);
    expect(exchangeOf(busy, busy.nodes[1]!, [busy], causes)).toBe(null);
    const ended = run("b", { variables: [of("R01")], nodes: [waiting], state: "failed" });
    expect(exchangeOf(ended, ended.nodes[0]!, [ended], causes)).toBe(null);
    const free = run("c", { nodes: [waiting] });
    expect(exchangeOf(free, free.nodes[0]!, [free], causes)).toBe(null);
  });
  it("is one that knows the operations, the ready ones first; an incident is tried again with it", () => {
    const failed = run("a", {
      nodes: [
        {
          name: "n",
          state: "incident",
          invocations: [{ operation: "drive", state: "failed", robot: `${expo}R01` }],
        },
      ],
    });
    const exchange = exchangeOf(failed, failed.nodes[0]!, [failed], []);
    expect(exchange).toMatchObject({ how: "retry", robot: `${expo}R01`, operations: ["drive"] });
    const fleet = [
      ["R01", "standby", ["drive"]],
      ["R02", "offline", ["drive"]],
      ["R03", "standby", ["drive", "say"]],
      ["R04", "standby", ["say"]],
      ["R05", "busy", ["drive"]],
    ].map(([name, state, operations]) =>
      robot(String(name), { state: String(state), operations: operations as string[], hasPose: true }),
    );
    expect(fitFor(exchange!, fleet).map((r) => r.label)).toEqual(["R03", "R05", "R02"]);
  });
});

describe("what is missing", () => {
  const ask = `PREFIX docent: <${docent}>\nASK {\n  expo:John docent:isAt ?meeting .\n  expo:R01 docent:isAt ?meeting .\n  expo:John docent:selected ?booth .\n  ?booth rdf:type docent:Booth .\n}`;
  const prefixes = new Map([
    ["expo", expo],
    ["docent", docent],
  ]);
  it("is said by the class of the thing where any would do", () => {
    expect(asMeant("expo:John docent:selected expo:B01", ask)).toBe("expo:John docent:selected ?booth");
    expect(factWords("expo:John docent:selected ?booth", prefixes)).toBe("John selected a booth");
    expect(asMeant("expo:John docent:isAt expo:B01", ask)).toBe("expo:John docent:isAt expo:B01"); // both have to be there
    expect(asMeant("expo:Ann docent:selected expo:B01", ask)).toBe("expo:Ann docent:selected expo:B01");
    expect(asMeant("expo:John docent:selected expo:B01", "")).toBe("expo:John docent:selected expo:B01");
    expect(
      asMeant(
        "expo:John docent:selected expo:B01",
        "ASK { expo:John docent:selected ?b( . ?b( a docent:Booth }",
      ),
    ).toBe("expo:John docent:selected ?booth"); // no pattern of a regular expression
    expect(factWords("?_operator docent:isAt expo:B01", prefixes)).toBe("an operator is at B01");
  });
  it("texts with markup, dots and quotes stay whole", () => {
    expect(splitFacts('<a:b> <c:d> "one . two \\" <b>x</b> ." . <a:b> <c:d> 7 .')).toEqual([
      '<a:b> <c:d> "one . two \\" <b>x</b> ."',
      "<a:b> <c:d> 7",
    ]);
    expect(replaceIris('<http://x.org/y#z> says "see <http://x.org/y#z> <b>bold</b>" <b>', () => "z")).toBe(
      'z says "see <http://x.org/y#z> <b>bold</b>" <b>',
    );
  });
});

it("limits are said without their names in the program", () => {
  expect(limitWords('the name "x" has 300 bytes; the limit name_bytes is 256')).toBe(
    'the name "x" has 300 bytes; at most 256 are allowed',
  );
  expect(
    limitWords("the report is larger than half of the limit grpc_message_bytes = 4194304, ask for less"),
  ).toBe("the report is larger than half of the limit of 4194304, ask for less");
});
it("reasons are said without addresses of programs", () => {
  expect(
    reasonWords(
      "adapter at 127.0.0.1:44367 broke off the feedback of a command that has not ended: recvmsg:Connection reset by peer",
      "R01",
    ),
  ).toEqual({
    words: "the connection to R01 broke off before its command had ended",
    detail: expect.stringContaining("recvmsg"),
  });
  expect(reasonWords("adapter at [::1]:7 refused moveToBooth: no way", "R01").words).toBe(
    "R01 refused moveToBooth: no way",
  );
  expect(reasonWords("the visitor ended it")).toEqual({ words: "the visitor ended it", detail: "" });
});
