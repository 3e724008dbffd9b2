// Conditions with expressions: what must be, what must not be, and how it is said.
import { describe, expect, it } from "vitest";
import { eachWayHas, neededRows, senseInRule, senseOfContext } from "../../../src/cawl/condition_logic";
import { type Condition, readCawl } from "../../../src/cawl/document";
import { readExpression, senses } from "../../../src/cawl/expression";
import { conditionRows } from "../../../src/cawl/phrases";
import { rowWords } from "../../../src/compose/condition_states";
import { wishesOf } from "../../../src/visit/offers";

const row = (name: string, subject: string, verb: string, object: string) =>
  `<constraint name="${name}"><subject>${subject}</subject><verb>${verb}</verb><object>${object}</object></constraint>`;
const lies = row("lies", "?patient", "docent:lies", "true");
const asleep = row("asleep", "?patient", "docent:asleep", "true");
const away = row("away", "?patient", "docent:away", "true");
const rule = (expression: string, ...rows: string[]) =>
  `<rule name="r"${expression && ` expression="${expression}"`}>${rows.join("")}</rule>`;
const context = (name: string, ...rules: string[]) => `<context name="${name}">${rules.join("")}</context>`;
const document = (inner: string, expression = "") =>
  readCawl(
    `<CAWL name="x" xmlns:ext="https://w3id.org/docent/cawl-ext#"><flow name="f"><node name="n"><condition${expression && ` expression="${expression}"`}>${inner}</condition></node></flow></CAWL>`,
  );
const read = (inner: string, expression = ""): Condition =>
  document(inner, expression).flows[0]!.steps[0]!.condition!;
const words = (condition: Condition) => conditionRows(condition).map((r) => r.words);

describe("an expression", () => {
  it("is read as the server reads it: not before and before or, names in quotes, words in any case", () => {
    expect(readExpression("a or b AND not c")).toEqual({
      kind: "or",
      of: [
        { kind: "leaf", leaf: "a" },
        {
          kind: "and",
          of: [
            { kind: "leaf", leaf: "b" },
            { kind: "not", of: { kind: "leaf", leaf: "c" } },
          ],
        },
      ],
    });
    expect(readExpression("'Tour A' and not 'it\\'s not'")).toEqual({
      kind: "and",
      of: [
        { kind: "leaf", leaf: "Tour A" },
        { kind: "not", of: { kind: "leaf", leaf: "it's not" } },
      ],
    });
    expect(readExpression("not not a")).toEqual({ kind: "leaf", leaf: "a" });
    for (const wrong of ["", "a and", "(a", "a)", "a b", "and", "not", "'a", "()", "(".repeat(5000) + "a"])
      expect(readExpression(wrong), wrong.slice(0, 9)).toBe(null);
  });
  it("tells what must be and what must not, through brackets", () => {
    expect([...senses(readExpression("a and not (b or (c and not d)) and (e or not e)")!)]).toEqual([
      ["a", "must"],
      ["b", "must not"],
      ["c", "must not"],
      ["d", "must"],
      ["e", "both"],
    ]);
  });
});

describe("a condition on a card", () => {
  it("says what must not be", () => {
    const condition = read(context("c", rule("lies and not asleep", lies, asleep)));
    expect(conditionRows(condition)).toEqual([
      { words: "patient lies true", isNot: false },
      { words: "not (patient asleep true)", isNot: true },
    ]);
  });
  it("has a row for each thing that has to hold, and alternatives in one", () => {
    expect(words(read(context("c", rule("lies and (asleep or not away)", lies, asleep, away))))).toEqual([
      "patient lies true",
      "patient asleep true or not (patient away true)",
    ]);
    expect(words(read(context("c", rule("not (asleep or away)", asleep, away))))).toEqual([
      "not (patient asleep true)",
      "not (patient away true)",
    ]);
    expect(words(read(context("c", rule("not (asleep and away)", asleep, away))))).toEqual([
      "not (patient asleep true and patient away true)",
    ]);
    expect(words(read(context("a", rule("", lies)) + context("b", rule("", asleep, away))))).toEqual([
      "patient lies true",
      "or patient asleep true and patient away true",
    ]);
  });
  it("knows expressions of situations and of events, and times", () => {
    const condition = read(
      `<case name="rang" expression="bell or knock"><event operation="bell"/><event operation="knock"/></case>${context("in", rule("", lies))}${context("out", rule("", away))}`,
      "rang and in and not out",
    );
    expect(words(condition)).toEqual([
      "event bell or event knock",
      "patient lies true",
      "not (patient away true)",
    ]);
    expect(condition.contexts.map((c) => senseOfContext(condition, c))).toEqual(["must", "must not"]);
    expect(
      words(
        read(
          context(
            "c",
            rule("lies and not night", lies, '<ext:time name="night" between="22:00-06:00" missed="skip"/>'),
          ),
        ),
      ),
    ).toEqual(["patient lies true", "not (between 22:00-06:00)"]);
  });
  it("shows all rows while an expression is broken, and a name that is nothing", () => {
    expect(words(read(context("c", rule("lies and (", lies, asleep))))).toEqual([
      "patient lies true",
      "patient asleep true",
    ]);
    expect(words(read(context("c", rule("lies and nobody", lies))))).toEqual(["patient lies true", "nobody"]);
  });
});

describe("a row of a condition", () => {
  const condition = read(context("c", rule("lies and not asleep", lies, asleep, away)));
  const {
    contexts: [{ rules: [only] = [] } = { rules: [] }],
  } = condition;
  it("knows what its rule's expression says of it", () => {
    expect(only?.constraints.map((c) => senseInRule(only, c))).toEqual(["must", "must not", undefined]);
    expect(
      read(context("c", rule("", lies))).contexts[0]!.rules.map((r) => senseInRule(r, r.constraints[0]!)),
    ).toEqual(["must"]);
  });
  it("is good where what must not be is not there, and never good where it is", () => {
    const live = (matches: number) => ({
      matches,
      witness: "",
      found: { patient: "Ann" },
      miss: null,
      note: "",
    });
    const [, sleeps] = only!.constraints;
    const doc = document("");
    expect(rowWords(live(0), sleeps!, doc, "must not")).toEqual({
      good: true,
      words: "no match now, as it must be",
    });
    expect(rowWords(live(1), sleeps!, doc, "must not")).toEqual({
      good: false,
      words: "must not be: 1 match: Ann asleep true",
    });
    expect(rowWords(live(1), sleeps!, doc, "must")).toEqual({
      good: true,
      words: "1 match: Ann asleep true",
    });
    expect(rowWords(live(1), sleeps!, doc, undefined).good).toBe(false);
    expect(rowWords(live(0), sleeps!, doc, "must").good).toBe(false);
  });
});

describe("what must not be", () => {
  it("gives nothing a value", () => {
    const condition = read(
      context("c", rule("lies and not away", lies, row("away", "?nurse", "docent:away", "true"))),
    );
    expect(neededRows(condition).map((r) => r.name)).toEqual(["lies"]);
    const has = (name: string) => eachWayHas(condition, (r) => r.subject.text === name);
    expect([has("?patient"), has("?nurse")]).toEqual([true, false]);
    const either = read(
      context("c", rule("lies or asleep", lies, row("asleep", "?nurse", "docent:asleep", "true"))),
    );
    expect(eachWayHas(either, (r) => r.subject.text === "?patient")).toBe(false);
  });
  it("is no wish of a visitor", async () => {
    const activated = (expression: string) =>
      `<CAWL name="x"><activator name="a"><activate flow="f"/><condition>${context("c", rule(expression, row("tour", "?user", "docent:chose", "docent:Tour"), row("talk", "?user", "docent:chose", "docent:Talk")))}</condition></activator><flow name="f"/></CAWL>`;
    expect((await wishesOf(activated("tour and not talk"))).map((w) => w.service)).toEqual([
      "https://w3id.org/docent#Tour",
    ]);
  });
});
