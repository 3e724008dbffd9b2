// RDF terms of the API and plain values.
import { create } from "@bufbuild/protobuf";
import { type Quad, QuadSchema, type Term, TermSchema } from "./gen/docent/v1/term_pb.js";

export type Value = { kind: "iri" | "blank" | "literal"; text: string; datatype?: string; language?: string };

export const iri = (value: string): Term => create(TermSchema, { kind: { case: "iri", value } });
export const literal = (lexical: string, datatype = "", language = ""): Term => create(TermSchema, { kind: { case: "literal", value: { lexical, datatype, language } } });
// A function for names of a namespace: namespace("https://w3id.org/docent/expo#")("B05").
export const namespace = (prefix: string) => (name: string): Term => iri(prefix + name);
export const docentTerm = namespace("https://w3id.org/docent#");
export const fact = (subject: Term, predicate: Term, object: Term): Quad => create(QuadSchema, { subject, predicate, object });

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
