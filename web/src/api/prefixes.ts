// Names for IRIs: the prefixes that the server knows.
import { useMemo } from "react";
import { ontologies } from "./client";
import { replaceIris } from "./iris";
import { usePoll } from "./poll";
import { nameIn, useLabels } from "./labels";
import { shorten } from "./sparql";
import { wellKnownPrefixes } from "./well_known";

export interface Names {
  prefixes: ReadonlyMap<string, string>;
  short: (iri: string) => string; // "expo:B03"; empty where no prefix fits
  name: (iri: string) => string; // its label, or the end of its IRI: "B03"
  long: (text: string) => string; // the IRI of "expo:B03"
}

export function useNames(): Names {
  const polled = usePoll("prefixes", (signal) => ontologies.prefixes({}, { signal }), 30_000);
  const labels = useLabels();
  return useMemo(() => {
    const prefixes = new Map(Object.entries(wellKnownPrefixes));
    prefixes.set("expo", "https://w3id.org/docent/expo#");
    for (const p of polled.data?.prefixes ?? []) prefixes.set(p.name, p.namespace);
    const short = (iri: string) => shorten(iri, prefixes);
    return {
      prefixes,
      short,
      name: (iri: string) => nameIn(labels, iri),
      long: (text: string) => {
        const at = text.indexOf(":");
        const namespace = prefixes.get(text.slice(0, at));
        return namespace ? namespace + text.slice(at + 1) : text;
      },
    };
  }, [polled.data, labels]);
}

// N-Triples as rows of short words.
export function readTriples(text: string, short: (iri: string) => string): string[][] {
  const word = (written: string) =>
    replaceIris(written, short)
      .replace(/\^\^xsd:(string|boolean|integer|decimal|double)$/, "")
      .replace(/^"(true|false|[-+]?[\d.]+)"$/, "$1");
  return text.split("\n").flatMap((line) => {
    const match = /^(\S+)\s+(\S+)\s+(.+?)\s*\.?\s*$/.exec(line.trim());
    return match ? [[word(match[1] ?? ""), word(match[2] ?? ""), word(match[3] ?? "")]] : [];
  });
}
