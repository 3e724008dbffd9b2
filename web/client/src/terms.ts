// RDF terms of the API and plain values.
import { create } from "@bufbuild/protobuf";
import {
  type NamedTerm,
  NamedTermSchema,
  type Quad,
  QuadSchema,
  type Term,
  TermSchema,
} from "./gen/docent/v1/term_pb.js";

export type Value = { kind: "iri" | "blank" | "literal"; text: string; datatype?: string; language?: string };

export type Row = Readonly<Record<string, Value | undefined>>;
// What has a term of its own: true, 7, 0.5, "a text", a time.
export type Plain = boolean | number | bigint | string | Date;

const xsd = "http://www.w3.org/2001/XMLSchema#";

export const iri = (value: string): Term => create(TermSchema, { kind: { case: "iri", value } });
// `datatype` and `language` are for texts; other plain values have datatypes of their own. Throws RangeError for a Date that is no time.
export function literal(value: Plain, datatype = "", language = ""): Term {
  if (typeof value === "string") return lexicalTerm(value, datatype, language);
  const own = typed(value);
  return lexicalTerm(own.lexical, datatype || xsd + own.datatype);
}
function lexicalTerm(lexical: string, datatype: string, language = ""): Term {
  return create(TermSchema, { kind: { case: "literal", value: { lexical, datatype, language } } });
}
function typed(value: boolean | number | bigint | Date): { lexical: string; datatype: string } {
  if (typeof value === "boolean") return { lexical: String(value), datatype: "boolean" };
  if (value instanceof Date) return { lexical: value.toISOString(), datatype: "dateTime" };
  if (typeof value === "bigint" || Number.isSafeInteger(value))
    return { lexical: String(value === 0 ? 0 : value), datatype: "integer" };
  // XSD 1.1, 3.3.5: infinities are INF and -INF
  return { lexical: String(value).replace("Infinity", "INF"), datatype: "double" };
}
// A term, or a plain value as one.
export function termOf(value: Term | Plain): Term {
  return typeof value === "object" && !(value instanceof Date) ? value : literal(value);
}
// A function for names of a namespace: namespace("https://w3id.org/docent/expo#")("B05").
export const namespace =
  (prefix: string) =>
  (name: string): Term =>
    iri(prefix + name);
export const docentTerm = namespace("https://w3id.org/docent#");
export const fact = (subject: Term, predicate: Term, object: Term | Plain): Quad =>
  create(QuadSchema, { subject, predicate, object: termOf(object) });
// A value of a start: workflows.start({ workflow: "Tour", variables: [variable("stops", 3)] }).
export const variable = (name: string, value: Term | Plain): NamedTerm =>
  create(NamedTermSchema, { name, value: termOf(value) });

export function valueOf(term: Term | undefined): Value | undefined {
  switch (term?.kind.case) {
    case "iri":
      return { kind: "iri", text: term.kind.value };
    case "blank":
      return { kind: "blank", text: term.kind.value };
    case "literal": {
      const { lexical, datatype, language } = term.kind.value;
      return { kind: "literal", text: lexical, ...(datatype && { datatype }), ...(language && { language }) };
    }
    default:
      return undefined;
  }
}

// Equal for equal terms, and for no others.
export function termKey(term: Term | undefined): string {
  const value = valueOf(term);
  return JSON.stringify(value ? [value.kind, value.text, value.datatype ?? "", value.language ?? ""] : null);
}
