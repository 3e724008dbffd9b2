// What is said of a condition that does not hold.
import { fromJson, type JsonObject } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { readMiss } from "../../../src/compose/nearest_miss";
import { matchWords } from "../../../src/compose/condition_states";
import { readCawl } from "../../../src/cawl/document";
import { ExplainReplySchema } from "../../../src/gen/docent/v1/context_pb";

const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const prefixes = new Map([
  ["expo", expo],
  ["docent", docent],
]);
const iri = (name: string) => ({ iri: name });
const status = (robot: string): JsonObject => ({
  missing: [`expo:${robot} docent:status docent:Standby`],
  add: [{ subject: iri(expo + robot), predicate: iri(`${docent}status`), object: iri(`${docent}Standby`) }],
  bindings: [{ name: "robot", value: iri(expo + robot) }],
  holds: [{}],
});
const reply = (sets: JsonObject[], more = "0") =>
  fromJson(ExplainReplySchema, { sets, more, text: "in words" });

describe("the nearest miss", () => {
  it("names what lacks, what is there instead, and how many other ways there are", () => {
    const miss = readMiss(
      reply([status("R01"), status("R02")], "3"),
      new Map([[`${expo}R01 ${docent}status`, "docent:Busy"]]),
      prefixes,
    );
    expect(miss).toMatchObject({
      where: "robot = R01",
      holds: 1,
      others: 4,
      lacks: [{ pattern: "expo:R01 docent:status docent:Standby", now: "docent:Busy" }],
    });
    expect(miss.add).toHaveLength(1);
  });
  it("is the one of which most is known, among those that lack equally much", () => {
    const known = new Map([[`${expo}R02 ${docent}status`, "docent:Busy"]]);
    expect(readMiss(reply([status("R01"), status("R02")]), known, prefixes).where).toBe("robot = R02");
    const larger = { ...status("R02"), missing: ["a", "b"], add: [] };
    expect(readMiss(reply([status("R01"), larger]), known, prefixes).where).toBe("robot = R01");
  });
  it("says what must not be, and whole IRIs by their prefixes", () => {
    const miss = readMiss(
      reply([
        {
          missing: [`<${expo}R01> <${docent}isAt> ?x .`],
          remove: [
            {
              subject: iri(`${expo}Door`),
              predicate: iri(`${docent}isAt`),
              object: { literal: { lexical: "a <b>" } },
            },
          ],
          inTheWay: ["the same in words"],
          conditions: ["?x > 3"],
        },
      ]),
      new Map(),
      prefixes,
    );
    expect(miss.lacks).toEqual([{ pattern: "expo:R01 docent:isAt ?x", now: "" }]);
    expect(miss.tooMuch).toEqual(['expo:Door docent:isAt "a <b>"', "?x > 3"]);
  });
  it("is a text where the server can say it in words alone", () => {
    expect(readMiss(reply([]), new Map(), prefixes)).toMatchObject({ lacks: [], text: "in words" });
  });
});

describe("one match in words", () => {
  const row = (subject: string, verb: string, object: string) => {
    const constraint = readCawl(
      `<CAWL name="x"><flow name="f"><node name="n"><condition><context name="c"><rule name="r"><constraint name="k"><subject>${subject}</subject><verb>${verb}</verb><object>${object}</object></constraint></rule></context></condition></node></flow></CAWL>`,
    ).flows[0]?.steps[0]?.condition?.contexts[0]?.rules[0]?.constraints[0];
    if (!constraint) throw new Error("no row");
    return constraint;
  };
  it("has what was found in the place of what is free", () => {
    expect(matchWords(row("?robot", "docent:status", "docent:Standby"), { robot: "R01" })).toBe(
      "R01 status Standby",
    );
    expect(matchWords(row("$user", "docent:isAt", "?where"), { user: "John", where: "Entrance" })).toBe(
      "John is at Entrance",
    );
  });
  it("is nothing where nothing is free", () => {
    expect(matchWords(row("expo:John", "docent:selected", "expo:B05"), {})).toBe("");
  });
});
