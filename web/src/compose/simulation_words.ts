// What a simulation did, in words; facts that lack as rows that can be told.
import { replaceIris } from "../api/iris";
import type { Names } from "../api/prefixes";
import { localName } from "../api/sparql";
import { quadText, termText } from "../api/terms";
import type { SimulatedStep } from "../gen/docent/v1/replays_pb";
import type { Term } from "../gen/docent/v1/term_pb";
import { look, runWords } from "../ui/states";
import { factsOf } from "../facts/fact_words";
import type { SimulationEvent } from "./simulation";

export const activatorNode = "activator"; // the node under which a reply tells what starts the workflow

type Short = Pick<Names, "short">;

// "00:03", "1:02:03".
export function clockWords(afterS: number): string {
  const s = Math.max(0, Math.floor(afterS));
  const two = (n: number) => String(n).padStart(2, "0");
  return `${s >= 3600 ? `${Math.floor(s / 3600)}:` : ""}${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

export const robotName = (iri: string) =>
  iri.startsWith("urn:docent:robot:") ? `the ${iri.slice("urn:docent:robot:".length)} robot` : localName(iri);
const value = (term: Term | undefined) =>
  term?.kind.case === "iri" ? localName(term.kind.value) : termText(term, () => "");
export const plainIris = (text: string) => replaceIris(text, robotName);

// "R01 gets moveToBooth(B03)"
export function commandWords(step: SimulatedStep, verb = "gets"): string {
  return `${step.step?.robot ? robotName(step.step.robot) : "a robot"} ${verb} ${step.step?.operation}(${step.step?.arguments.map((a) => value(a.value)).join(", ") ?? ""})`;
}

export function eventWords(event: SimulationEvent, names: Short): { who: string; what: string; why: string } {
  if (event.telling)
    return {
      who: "",
      what: `${event.telling.remove ? "no longer known" : "told"}: ${quadText(event.telling.quad, names.short)}`,
      why: "",
    };
  const { node, step } = event.step;
  const who = runWords(node);
  if (step?.operation) return { who, what: commandWords(event.step), why: "" };
  const state = step?.state ?? "";
  const why = ["running", "failed", "incident", "cancelled"].includes(state)
    ? plainIris(step?.cause ?? "")
        .replace(/^asked for$|^after .*$/, "")
        .replace(/^condition (\S+) holds(?: with)?/, "by $1:")
        .replace(/:$/, "")
    : "";
  if (node === "")
    return { who: "", what: state === "running" ? "the run begins" : `the run is ${look(state).words}`, why };
  return {
    who,
    what: state === "running" ? "opens" : state === "waiting" ? "waits" : look(state).words,
    why,
  };
}

const list = (text: string) =>
  text
    .split(/, /)
    .map((word) => plainIris(word))
    .join(", ");
export function noteWords(note: string): string {
  const ready = /^taken to be ready: (.*)$/s.exec(note);
  if (ready) return `Taken to be free and ready: ${list(ready[1] ?? "")}.`;
  const offers = /^no robot offers (.*): a simulated one does/s.exec(note);
  if (offers) return `No robot offers ${list(offers[1] ?? "")}: a simulated robot does it.`;
  const activator =
    /^activator (.*) does not fire on these facts(?:; the run is started all the same)?(?:; (.*))?$/s.exec(
      note,
    );
  if (activator)
    return `${activator[1]} does not start a run on these facts; this one is started by hand.${activator[2] ? ` ${sentenceOf(activator[2])}` : ""}`;
  return sentenceOf(plainIris(note));
}
const sentenceOf = (words: string) =>
  `${words.charAt(0).toUpperCase()}${words.slice(1)}${/[.!?]$/.test(words) ? "" : "."}`;

export interface Lack {
  text: string;
  row: [string, string, string] | null; // null: it is no fact that could be told
  remove: boolean; // it stands in the way
  open: boolean; // a variable has to be chosen
}
// "<s> <p> ?o . not <s> <p> <o> ."
export function lacksOf(missing: string, names: Short): Lack[] {
  return factsOf(missing, names).map((fact): Lack => {
    const remove = fact.startsWith("not ");
    const text = remove ? fact.slice(4) : fact;
    const term = /^(?:\?\w+|<[^>]*>|[\w-]*:\S*)$/;
    const parts = /^(\S+)\s+(\S+)\s+([\s\S]+)$/.exec(text);
    const row =
      parts && term.test(parts[1] ?? "") && term.test(parts[2] ?? "")
        ? ([parts[1] ?? "", parts[2] ?? "", parts[3] ?? ""] as [string, string, string])
        : null;
    return { text, row, remove, open: row?.some((word) => word.startsWith("?")) ?? false };
  });
}

// The classes of variables of a condition: "booth" → "docent:Booth".
export function classesIn(ask: string): Map<string, string> {
  return new Map([...ask.matchAll(/\?(\w+) (?:rdf:type|a) (\S+) ?\./g)].map((m) => [m[1] ?? "", m[2] ?? ""]));
}
