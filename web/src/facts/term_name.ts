import { nameOf } from "../api/labels";
import { termWords, verbWords } from "../cawl/phrases";

// What a term of a document is called for people: "expo:John" is John, "$user" is user.
export function termName(term: string, prefixes: ReadonlyMap<string, string>): string {
  const named = /^([A-Za-z][\w-]*):(\S+)$/.exec(term.trim());
  const namespace = prefixes.get(named?.[1] ?? "");
  const iri = named && namespace ? namespace + named[2] : /^<([^<>\s]+)>$/.exec(term.trim())?.[1];
  return iri ? nameOf(iri) : termWords(term);
}

// A pattern as a sentence: "expo:John docent:isAt expo:B10" is "John is at B10".
export function patternWords(pattern: string, prefixes: ReadonlyMap<string, string>): string {
  const [, subject, verb, object] = /^(\S+)\s+(\S+)\s+([\s\S]+)$/.exec(pattern.trim()) ?? [];
  return subject && verb && object
    ? [
        termName(subject, prefixes),
        verb === "rdf:type" ? "is a" : verbWords(verb),
        termName(object, prefixes),
      ].join(" ")
    : pattern;
}
// Several values, as the server lists them.
export function valuesWords(values: string, prefixes: ReadonlyMap<string, string>): string {
  return values.replace(/[^\s,]+/g, (term) => termName(term, prefixes));
}
