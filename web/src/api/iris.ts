// IRIs in texts of the server. What stands in quotes is somebody's text: "See you <b>soon</b>" has no IRI in it.
const iriOrText = /"(?:[^"\\]|\\.)*"|<([A-Za-z][\w+.-]*:[^\s<>"{}|^`\\]*)>/g;

// The text with another word for each IRI in it; an empty word leaves the IRI as it is.
export function replaceIris(text: string, word: (iri: string) => string): string {
  return text.replace(iriOrText, (whole, iri: string | undefined) =>
    iri === undefined ? whole : word(iri) || whole,
  );
}

// Triples or patterns that end with " ." each; a text in one of them may have such an end, too.
export function splitFacts(text: string): string[] {
  const facts = [""];
  for (const [part] of text.matchAll(/"(?:[^"\\]|\\.)*"|\s\.(?=\s|$)|[\s\S]/g)) {
    if (/^\s\.$/.test(part)) facts.push("");
    else facts[facts.length - 1] += part;
  }
  return facts.map((fact) => fact.trim()).filter(Boolean);
}

export const runIri = "urn:docent:run:";
// The id of a run, by its IRI.
export const runOf = (iri: string) => (iri.startsWith(runIri) ? iri.slice(runIri.length) : "");
