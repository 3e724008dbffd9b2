// What somebody means who types in a field with offers, and in which order verbs are offered.
import { describe, expect, it } from "vitest";
import { verbsFor } from "../../../src/facts/vocabulary";
import { type Choice, found, meant } from "../../../src/ui/combo";

const choices: Choice[] = [
  { value: "$booth", label: "docent:Booth" },
  { value: "expo:John", label: "Visitor", use: "Visitor" },
  { value: "expo:B05", label: "Norrgard Lifts", use: "Booth" },
  { value: "expo:B50", label: "B50 · Orchard" },
  { value: "docent:isAt", label: "is at", words: "comes to" },
];
const enter = (typed: string) => meant(typed, choices, found(choices, typed), true);
const leave = (typed: string) => meant(typed, choices, [], false);

describe("a name in a field with offers", () => {
  it("is the offer that has it", () => {
    for (const [typed, value] of [
      ["John", "expo:John"],
      ["john", "expo:John"],
      ["is at", "docent:isAt"],
      ["B05", "expo:B05"],
      ["Norrgard lifts", "expo:B05"],
    ])
      expect([enter(typed!), leave(typed!)]).toEqual([value, value]);
  });
  it("is by Enter the only offer that is left", () => {
    expect(enter("comes")).toBe("docent:isAt");
    expect(enter("Orch")).toBe("expo:B50");
    expect(leave("Orch")).toBe("Orch");
    expect(enter("B")).toBe("B"); // several
    expect(enter("Visitor")).not.toBe(leave("Visitor")); // a class is no name of its things, but finds them
  });
  it("stays what it is where it is a value already", () => {
    for (const typed of ["5", "true", '"John"', "?joh", "$joh", "> 5", "expo:Joh", "", "expo:John"])
      expect(enter(typed)).toBe(typed);
  });
  it("of two things with one name stays as it is typed", () => {
    const two = [{ value: "expo:John" }, { value: "home:John" }];
    expect(meant("John", two, found(two, "John"), true)).toBe("John");
  });
});

describe("verbs", () => {
  const word = (term: string, use = "", above: string[] = []) => ({ term, label: "", use, above });
  const vocabulary = {
    verbs: [
      word("docent:partOf", "900 facts", ["docent:Region"]),
      word("docent:height", "300 facts"),
      word("docent:status", "3 facts", ["docent:Robot"]),
      word("expo:badge", "2 facts"),
      word("docent:chose", "", ["docent:Visitor"]),
      word("docent:isAt", "", ["docent:Agent"]),
      word("rdf:type", "999 facts"),
    ],
    classes: [
      word("docent:Visitor", "", ["docent:Person"]),
      word("docent:Person", "", ["docent:Agent"]),
      word("docent:Agent"),
      word("docent:Robot", "", ["docent:Agent"]),
    ],
  };
  const order = (type: string, used = new Map<string, number>()) =>
    verbsFor(vocabulary, type, used).map((w) => w.term.replace(/^\w+:/, ""));
  it("of a visitor begin with what visitors do", () => {
    expect(order("docent:Visitor", new Map([["expo:badge", 2]]))).toEqual([
      "isAt",
      "chose",
      "badge",
      "status",
      "partOf",
      "height",
      "type",
    ]);
  });
  it("of a robot, and of what is not known", () => {
    expect(order("docent:Robot")).toEqual(
      ["isAt", "status", "expo:badge", "chose", "partOf", "height", "type"].map((t) =>
        t.replace(/^\w+:/, ""),
      ),
    );
    expect(order("").slice(0, 3)).toEqual(["isAt", "chose", "status"]);
  });
});
