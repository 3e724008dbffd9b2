// Two texts that began as the same one, put together by lines. Null where both changed the same place otherwise, or where what
// comes out is no XML any more: then somebody has to choose.
import { readCawl } from "../cawl/document";
import { type Hunk, hunksOf } from "./text_diff";

// Two insertions at one place touch, and an insertion inside of what the other one replaced, or at its border.
function touch(a: Hunk, b: Hunk): boolean {
  if (a.from === a.to || b.from === b.to) return a.from <= b.to && b.from <= a.to;
  return a.from < b.to && b.from < a.to;
}
const same = (a: Hunk, b: Hunk) =>
  a.from === b.from && a.to === b.to && a.lines.join("\n") === b.lines.join("\n");

export function mergeLines(base: string, mine: string, other: string): string | null {
  if (mine === other || other === base) return mine;
  if (mine === base) return other;
  const lines = base.split("\n");
  const a = hunksOf(lines, mine.split("\n"));
  const b = hunksOf(lines, other.split("\n")).filter((h) => !a.some((m) => same(m, h)));
  if (b.some((h) => a.some((m) => touch(m, h)))) return null;
  for (const hunk of [...a, ...b].sort((x, y) => y.from - x.from || y.to - x.to))
    lines.splice(hunk.from, hunk.to - hunk.from, ...hunk.lines);
  return lines.join("\n");
}

export function mergeTexts(base: string, mine: string, other: string): string | null {
  const merged = mergeLines(base, mine, other);
  if (merged === null || merged === mine || merged === other) return merged;
  const broken = (text: string) => readCawl(text).problems.length > 0;
  return broken(merged) && !broken(mine) && !broken(other) ? null : merged;
}
