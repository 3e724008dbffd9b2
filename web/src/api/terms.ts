// RDF terms from what people write: "expo:B03", "<https://…>", "text", 7, true.
import { create } from "@bufbuild/protobuf";
import { type Quad, QuadSchema, type Term, TermSchema } from "../gen/docent/v1/term_pb";

const xsd = "http://www.w3.org/2001/XMLSchema#";
const literal = (lexical: string, datatype = "", language = "") =>
  create(TermSchema, { kind: { case: "literal", value: { lexical, datatype, language } } });

export function iriTerm(iri: string): Term {
  return create(TermSchema, { kind: { case: "iri", value: iri } });
}

// Throws RangeError with what is wrong.
export function termOf(text: string, prefixes: ReadonlyMap<string, string>): Term {
  const written = text.trim();
  const iri = /^<([^<>\s]+)>$/.exec(written);
  if (iri) return iriTerm(iri[1] ?? "");
  const quoted = /^(["'])([\s\S]*)\1(?:@([\w-]+)|\^\^(\S+))?$/.exec(written);
  if (quoted) {
    const datatype = quoted[4] ? termOf(quoted[4], prefixes) : undefined;
    return literal(
      quoted[2] ?? "",
      datatype?.kind.case === "iri" ? datatype.kind.value : "",
      quoted[3] ?? "",
    );
  }
  if (/^(true|false)$/.test(written)) return literal(written, `${xsd}boolean`);
  if (/^[+-]?\d+$/.test(written)) return literal(written, `${xsd}integer`);
  if (/^[+-]?\d*\.\d+$/.test(written)) return literal(written, `${xsd}decimal`);
  const named = /^([\w-]*):(\S*)$/.exec(written);
  const namespace = named ? prefixes.get(named[1] ?? "") : undefined;
  if (named && namespace === undefined)
    throw new RangeError(
      `The prefix ${named[1]} of ${written} is not declared. Declare it in the document, or write the whole IRI in < >.`,
    );
  if (named) return iriTerm(namespace + (named[2] ?? ""));
  throw new RangeError(
    `${written} is no value. Write a name with a prefix (expo:B03), a number, or a text in quotes.`,
  );
}

// A term as SPARQL and Turtle write it, with a prefix where one fits.
export function termText(term: Term | undefined, short: (iri: string) => string): string {
  if (term?.kind.case === "iri") return short(term.kind.value) || `<${term.kind.value}>`;
  if (term?.kind.case === "blank") return `_:${term.kind.value}`;
  if (term?.kind.case !== "literal") return "";
  const { lexical, language, datatype } = term.kind.value;
  if (/integer|decimal|boolean|double/.test(datatype)) return lexical;
  return `${JSON.stringify(lexical)}${language ? `@${language}` : datatype && !datatype.endsWith("#string") ? `^^${short(datatype) || `<${datatype}>`}` : ""}`;
}
export function quadText(quad: Quad, short: (iri: string) => string): string {
  return [quad.subject, quad.predicate, quad.object].map((term) => termText(term, short)).join(" ");
}
export function quadOf(quad: Quad): Quad {
  return create(QuadSchema, {
    ...(quad.subject && { subject: quad.subject }),
    ...(quad.predicate && { predicate: quad.predicate }),
    ...(quad.object && { object: quad.object }),
  });
}

export const iriOf = (term: Term | undefined) => (term?.kind.case === "iri" ? term.kind.value : "");
