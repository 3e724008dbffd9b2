// Two texts of one beginning put together: nothing of either is lost, or somebody has to choose.
import { describe, expect, it } from "vitest";
import { mergeLines, mergeTexts } from "../../../src/compose/merge";
import { hunksOf } from "../../../src/compose/text_diff";
import { Random } from "../random";

describe("merging", () => {
  it("takes both changes where they are at different places, also at the ends", () => {
    expect(mergeLines("a\nb\nc\nd", "A\nb\nc\nd", "a\nb\nc\nd\ne")).toBe("A\nb\nc\nd\ne");
    expect(mergeLines("a\nb\nc", "a\nc", "a\nb\nx\nc\ny")).toBe(null); // x came at the border of what went
    expect(mergeLines("a\nb\nc\nd", "a\nc\nd", "a\nb\nc\nx\nd")).toBe("a\nc\nx\nd");
    expect(mergeLines("a\nb", "a\nb", "x\ny")).toBe("x\ny");
  });
  it("takes the same change once", () => {
    expect(mergeLines("a\nb\nc", "a\nB\nc\nd", "a\nB\nc")).toBe("a\nB\nc\nd");
    expect(mergeLines("a", "b", "b")).toBe("b");
  });
  it("leaves it to somebody where both changed one place", () => {
    expect(mergeLines("a\nb\nc", "a\nX\nc", "a\nY\nc")).toBe(null);
    expect(mergeLines("a\nc", "a\nx\nc", "a\ny\nc")).toBe(null);
  });
  it("leaves it to somebody where what comes out is no XML", () => {
    const flow = (...lines: string[]) =>
      ['<CAWL name="x">', '<flow name="f">', ...lines, "</flow>", "</CAWL>"].join("\n");
    const base = flow('<node name="A">', "<x/>", "<y/>", "</node>");
    const renamed = flow('<step name="A">', "<x/>", "<y/>", "</step>");
    const split = flow('<node name="A">', "<x/>", "</node>", '<node name="B">', "<y/>", "</node>");
    expect(mergeLines(base, renamed, split)).not.toBe(null);
    expect(mergeTexts(base, renamed, split)).toBe(null);
    expect(mergeTexts(base, renamed, base.replace("<x/>", "<x2/>"))).toBe(renamed.replace("<x/>", "<x2/>"));
  });
  it("200 random pairs of edits: each line that came is there, each that went is gone, or it is a conflict", () => {
    const random = new Random(7);
    let merged = 0;
    for (let round = 0; round < 200; round++) {
      const base = Array.from({ length: 12 }, (_, i) => `line ${i}`);
      const edited = (who: string) => {
        const lines = base.slice();
        for (let k = 0; k <= random.below(3); k++) {
          const at = random.below(lines.length);
          const kind = random.below(3);
          if (kind === 0) lines.splice(at, 0, `${who} ${round} ${k}`);
          else if (kind === 1) lines.splice(at, 1);
          else lines[at] = `${who} ${round} ${k} instead`;
        }
        return lines;
      };
      const [mine, other] = [edited("mine"), edited("other")];
      const both = mergeLines(base.join("\n"), mine.join("\n"), other.join("\n"))?.split("\n");
      if (!both) continue;
      merged++;
      for (const side of [mine, other]) {
        for (const line of side) if (!base.includes(line)) expect(both).toContain(line);
        for (const line of base) if (!side.includes(line)) expect(both).not.toContain(line);
      }
      for (const line of both) expect(mine.includes(line) || other.includes(line)).toBe(true);
    }
    expect(merged).toBeGreaterThan(60);
  });
  it("the pieces of a difference make the one text the other", () => {
    const random = new Random(3);
    for (let round = 0; round < 200; round++) {
      const text = () => Array.from({ length: random.below(8) }, () => "abc"[random.below(3)] ?? "");
      const [a, b] = [text(), text()];
      const lines = a.slice();
      for (const hunk of hunksOf(a, b).reverse()) lines.splice(hunk.from, hunk.to - hunk.from, ...hunk.lines);
      expect(lines).toEqual(b);
    }
  });
});
