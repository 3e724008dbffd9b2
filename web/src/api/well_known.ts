// Prefixes that need no declaration in a document.
export const wellKnownPrefixes: Readonly<Record<string, string>> = {
  rdf: "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
  rdfs: "http://www.w3.org/2000/01/rdf-schema#",
  owl: "http://www.w3.org/2002/07/owl#",
  xsd: "http://www.w3.org/2001/XMLSchema#",
  prov: "http://www.w3.org/ns/prov#",
  sosa: "http://www.w3.org/ns/sosa/",
  geo: "http://www.opengis.net/ont/geosparql#",
  schema: "https://schema.org/",
  docent: "https://w3id.org/docent#",
};
