// What happened and when, for the time bar: beginnings and ends of runs and steps. Reading and choosing are pure functions.
import { useState } from "react";
import { usePoll } from "../api/poll";
import { query, type Row } from "../api/sparql";
import { runOf } from "../api/iris";
import { runWords } from "../ui/states";

export interface Mark {
  ms: number; // just after it: the graph of this time has it
  run: string;
  words: string; // "Move2Booth of BoothGuide-1 opens"
  ends: boolean; // of a run
}
const most = 1000;
const slowMs = 500;
export const marksQuery = `PREFIX docent: <https://w3id.org/docent#> PREFIX prov: <http://www.w3.org/ns/prov#>
SELECT ?t ?r ?node ?what { GRAPH docent:runs {
  { ?r prov:startedAtTime ?t ; docent:runState ?state BIND("begins" AS ?what) } UNION { ?r prov:endedAtTime ?t ; docent:runState ?what } UNION
  { ?n docent:firedAt ?t ; docent:ofRun ?r ; docent:nodeName ?node BIND("opens" AS ?what) } UNION { ?n docent:since ?t ; docent:ofRun ?r ; docent:nodeName ?node ; docent:nodeState ?what }
} } ORDER BY DESC(?t) LIMIT ${most}`;

export function readMarks(rows: readonly Row[]): Mark[] {
  return rows
    .flatMap((row) => {
      const ms = Date.parse(row["t"]?.text ?? "");
      const run = runOf(row["r"]?.text ?? "");
      const node = row["node"]?.text;
      const what = row["what"]?.text ?? "";
      // Times in the graph are cut to milliseconds: the turn itself came within the next one.
      return Number.isFinite(ms) && run
        ? [
            {
              ms: ms + 1,
              run,
              words: node
                ? `${node} of ${runWords(run)}${what === "opens" ? " opens" : ` is ${what}`}`
                : `${runWords(run)} ${what === "begins" ? "begins" : `is ${what}`}`,
              ends: !node && what !== "begins",
            },
          ]
        : [];
    })
    .sort((a, b) => a.ms - b.ms);
}

// The nearest mark before or after a time.
export function nextMark(marks: readonly Mark[], ms: number, direction: 1 | -1): Mark | undefined {
  return direction > 0 ? marks.find((m) => m.ms > ms) : marks.findLast((m) => m.ms < ms);
}

export function useMarks() {
  const [slow, setSlow] = useState(false); // very many runs: the question takes a while, and is asked less often
  return usePoll(
    "marks",
    async (signal) => {
      const begin = performance.now();
      const { rows } = await query(marksQuery, signal);
      if (performance.now() - begin > slowMs) setSlow(true);
      return readMarks(rows);
    },
    slow ? 30_000 : 3000,
  );
}

const minute = 60_000;
export const spans = [
  { ms: 5 * minute, words: "5 minutes" },
  { ms: 15 * minute, words: "15 minutes" },
  { ms: 60 * minute, words: "an hour" },
  { ms: 8 * 60 * minute, words: "8 hours" },
  { ms: 24 * 60 * minute, words: "a day" },
  { ms: 7 * 24 * 60 * minute, words: "a week" },
] as const;

// The shortest span that has the newest things in it, and at least what happened last.
export function usualSpan(marks: readonly Mark[], nowMs: number): number {
  const oldest = marks.at(-Math.min(12, marks.length))?.ms ?? nowMs;
  return (spans.find((s) => nowMs - oldest < s.ms) ?? spans[spans.length - 1]!).ms;
}
