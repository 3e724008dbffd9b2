// What happened in a run as sentences for people. Pure functions.
import { replaceIris, splitFacts } from "../api/iris";
import type { Names } from "../api/prefixes";
import { verbWords } from "../cawl/phrases";
import { words } from "../cawl/names";
import type { RunEvent } from "../gen/docent/v1/workflows_pb";
import { reasonWords } from "./reason_words";
import { look } from "../ui/states";

export interface EventWords {
  words: string; // after the name of the step: "is done"
  detail: string;
}

const type = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
const plainIris = (text: string, names: Pick<Names, "name">) => replaceIris(text, names.name);

// "<John> <isAt> <Entrance> . <John> <type> <Visitor> ." is "John is at Entrance, John is a Visitor".
export function factsInWords(triples: string, names: Pick<Names, "name">): string {
  return splitFacts(triples)
    .map((fact) => {
      const [, subject = "", verb = "", object = ""] = /^(\S+)\s+<([^>]+)>\s+([\s\S]+)$/.exec(fact) ?? [];
      const text = /^"([\s\S]*)"(?:\^\^\S+|@\S+)?$/.exec(object)?.[1];
      return verb
        ? [
            plainIris(subject, names),
            verb === type ? "is a" : verbWords(`<${verb}>`),
            text ?? plainIris(object, names),
          ].join(" ")
        : plainIris(fact, names);
    })
    .join(", ");
}

// In the order of the events. Null: nothing that the event before has not said.
export function eventsInWords(
  events: readonly RunEvent[],
  names: Pick<Names, "name">,
): (EventWords | null)[] {
  const operations = new Map<string, string>(); // what an invocation does, by its id
  return events.map((event) => eventInWords(event, names, operations));
}

function eventInWords(
  event: RunEvent,
  names: Pick<Names, "name">,
  operations: Map<string, string>,
): EventWords | null {
  const plain = reasonWords(plainIris(event.detail, names)).words.replace(/:\s*$/, "").trim();
  const state = look(event.to).words;
  switch (event.kind) {
    case "run": {
      const began = /^activator ([^:]*): ([\s\S]*)$/.exec(event.detail);
      if (began) return { words: "began by itself", detail: factsInWords(began[2] ?? "", names) };
      return event.detail === "asked for"
        ? { words: "was started by hand", detail: "" }
        : { words: state, detail: plain };
    }
    case "node":
      if (event.to === "waiting" && plain.startsWith("after "))
        return { words: "waits for its situation", detail: plain };
      if (event.to === "running" && event.from === "running") return { words: plain, detail: "" };
      if (event.to === "running")
        return { words: "opens", detail: plain.replace(/^condition (.*?) holds/, "$1 holds") };
      return { words: state, detail: plain === "all its invocations are done" ? "" : plain };
    case "invocation": {
      const [, id = "", part = "", rest = ""] =
        /^(\S+\/\d+)(?: (\d+\/\d+) ?)?:?\s*([\s\S]*)$/.exec(plain) ?? [];
      if (part)
        return part === "1/1" && event.to === "done"
          ? null
          : {
              words: `step ${part}, ${words(rest.split(":")[0] ?? "").toLowerCase()}: ${state}`,
              detail: rest.split(": ").slice(1).join(": "),
            };
      const begins = /^(\S+) on (.+)$/.exec(rest);
      if (begins) {
        operations.set(id, words(begins[1] ?? ""));
        return { words: `${words(begins[1] ?? "")} begins`, detail: `on ${begins[2]}` };
      }
      return { words: `${operations.get(id) ?? "The operation"}: ${state}`, detail: rest };
    }
    case "command": {
      const sent = / to ([^:]+): ([^\s(]+\((?:"(?:[^"\\]|\\.)*"|[^")])*\))/.exec(plain);
      return sent
        ? { words: `${sent[1]} gets the command`, detail: sent[2] ?? "" }
        : { words: `command ${state}`, detail: withoutIds(plain) };
    }
    case "report":
      return {
        words:
          event.to === "accepted"
            ? "the robot takes the command"
            : event.to === "succeeded"
              ? "the robot has done it"
              : `the robot reports: ${state}`,
        detail: withoutIds(plain),
      };
    default:
      return { words: `${event.kind} ${state}`.trim(), detail: withoutIds(plain) };
  }
}

// Without the ids of commands, which only the server needs.
function withoutIds(detail: string): string {
  return detail
    .replace(/^\S+@\d+:?\s*/, "")
    .replace(/, guard as of[\s\S]*$/, "")
    .trim();
}
