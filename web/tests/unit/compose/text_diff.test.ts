// Versions that a deployment is proposed to have.
import { describe, expect, it } from "vitest";
import { proposedVersion } from "../../../src/compose/text_diff";

describe("the version of a deployment", () => {
  it("is above the live one", () => {
    const proposed = [
      ["1.0", "1.0", "1.1"],
      ["1.0", "1.2", "1.3"],
      ["1.10", "1.9", "1.10"],
      ["1.9", "1.10", "1.11"],
      ["2.0", "1.9", "2.0"],
      ["1.0.1", "1.0", "1.0.1"],
      ["", "1.0", "1.1"],
      ["", "", ""],
      ["spring", "winter", "spring"],
    ];
    for (const [mine = "", live = "", words = ""] of proposed)
      expect(proposedVersion(mine, live)).toBe(words);
  });
});
