// Facts that lack, in words: by the class of what is meant where the condition leaves it open. Pure functions.
import { replaceIris, splitFacts } from "../api/iris";
import type { Names } from "../api/prefixes";
import { literally, words } from "../cawl/names";
import { patternWords } from "./term_name";

// "<s> <p> ?o . <s2> …" as patterns with prefixes, one a fact.
export function factsOf(missing: string, names: Pick<Names, "short">): string[] {
  return splitFacts(replaceIris(missing, names.short));
}

type Pattern = readonly [string, string, string];
function patternOf(fact: string): Pattern | undefined {
  const [, s, p, o] = /^(\S+)\s+(\S+)\s+([\s\S]+?)(?:\s*\.)?$/.exec(fact.trim()) ?? [];
  return s && p && o ? [s, p, o] : undefined;
}
const isVariable = (term: string) => /^[?$]/.test(term);
const isType = (verb: string) => verb === "a" || verb === "rdf:type";

// "expo:John docent:selected expo:B01" of a condition with "expo:John docent:selected ?booth . ?booth a docent:Booth" is
// "expo:John docent:selected ?booth": any booth would do. A variable that other patterns have as well stays as it was found.
export function asMeant(fact: string, ask: string): string {
  const found = patternOf(fact);
  if (!found) return fact;
  const pieces = splitFacts(ask.replace(/^[\s\S]*?\{/, "").replace(/\}[^}]*$/, ""));
  const patterns = pieces.map(patternOf).filter((p) => p !== undefined);
  for (const pattern of patterns) {
    if (isType(pattern[1]) || pattern[1] !== found[1]) continue;
    const open = [0, 2].filter((i) => isVariable(pattern[i] ?? "") && pattern[i] !== found[i]);
    if (open.length === 0 || [0, 2].some((i) => !open.includes(i) && pattern[i] !== found[i])) continue;
    const free = (variable: string) =>
      pieces
        .filter((piece) => new RegExp(`${literally(variable)}(?!\\w)`).test(piece))
        .every((piece) => {
          const p = patternOf(piece);
          return p && (p.join(" ") === pattern.join(" ") || (isType(p[1]) && p[0] === variable));
        });
    if (!open.every((i) => free(pattern[i] ?? ""))) continue;
    const named = (i: number) =>
      open.includes(i) ? classNamed(pattern[i] ?? "", patterns) : (found[i] ?? "");
    return [named(0), found[1], named(2)].join(" ");
  }
  return fact;
}
// "?booth", by its class where it has one.
function classNamed(variable: string, patterns: readonly Pattern[]): string {
  const of = patterns.find((p) => isType(p[1]) && p[0] === variable)?.[2];
  return of && /^[\w-]+:\w+$/.test(of)
    ? `?${of.replace(/^.*:/, "").replace(/^\w/, (c) => c.toLowerCase())}`
    : variable;
}

// "John selected a booth"
export function factWords(fact: string, prefixes: ReadonlyMap<string, string>): string {
  const pattern = patternOf(fact);
  if (!pattern) return patternWords(fact, prefixes);
  const [subject, verb, object] = pattern;
  const some = (term: string) => {
    const noun = words(term.slice(1).replace(/^_/, "")).toLowerCase();
    return `${/^[aeiou]/.test(noun) ? "an" : "a"} ${noun}`;
  };
  const text = patternWords(
    [isVariable(subject) ? "?SUBJECT" : subject, verb, isVariable(object) ? "?OBJECT" : object].join(" "),
    prefixes,
  );
  return text.replace("SUBJECT", () => some(subject)).replace("OBJECT", () => some(object));
}
