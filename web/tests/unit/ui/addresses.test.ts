// Addresses of runs, and names of things that have no label.
import { expect, it, vi } from "vitest";
import { nameOf, shortName } from "../../../src/api/labels";
import { parseRoute, paths } from "../../../src/ui/router";
import { patternWords, termName } from "../../../src/facts/term_name";

it("the id of a run is encoded once in its address, and comes back whole", () => {
  expect(paths.run("John's%20Service-6", "Greet")).toBe("/runs/John's%20Service-6?node=Greet");
  for (const id of ["John's%20Service-6", "BoothGuide-1", "a%2Fb%23c-2", "Führung-3", "service%20say-4"]) {
    expect(parseRoute(new URL(paths.run(id), "http://x"))).toMatchObject({ view: "run", run: id });
    expect(parseRoute(new URL(`/runs/${encodeURIComponent(id)}`, "http://x"))).toMatchObject({
      view: "run",
      run: id,
    }); // as older links have it
  }
});
it("a long id without a label is shortened", () => {
  expect(shortName("162c0914-5b1e-4c6e-9d9a-1f6d5f7d0a11")).toBe("162c0914…");
  expect(nameOf("urn:docent:visitor/162c0914-5b1e-4c6e-9d9a-1f6d5f7d0a11")).toBe("162c0914…");
  expect(nameOf("urn:uuid:162c0914-5b1e-4c6e-9d9a-1f6d5f7d0a11")).toBe("162c0914…");
  expect(shortName("B04")).toBe("B04");
});
it("a pattern is a sentence in the property's own words", () => {
  const prefixes = new Map([
    ["expo", "https://w3id.org/docent/expo#"],
    ["docent", "https://w3id.org/docent#"],
  ]);
  expect(patternWords("expo:John docent:isAt expo:B10", prefixes)).toBe("John is at B10");
  expect(termName("$user", prefixes)).toBe("user");
});
it("a key that is a plus has one label", async () => {
  vi.stubGlobal("navigator", { platform: "Linux" });
  const { keyLabels } = await import("../../../src/ui/commands");
  expect([keyLabels("+|="), keyLabels("Mod+K"), keyLabels("G R")]).toEqual([
    ["+"],
    ["Ctrl", "K"],
    ["G", "R"],
  ]);
});
