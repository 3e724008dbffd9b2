import { nameOf } from "../api/labels";
import { termWords } from "../cawl/phrases";

// What a term of a document is called for people: "expo:John" is John, "$user" is user.
export function termName(term: string, prefixes: ReadonlyMap<string, string>): string {
  const named = /^([A-Za-z][\w-]*):(\S+)$/.exec(term.trim());
  const namespace = prefixes.get(named?.[1] ?? "");
  const iri = named && namespace ? namespace + named[2] : /^<([^<>\s]+)>$/.exec(term.trim())?.[1];
  return iri ? nameOf(iri) : termWords(term);
}
