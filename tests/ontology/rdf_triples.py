"""Reads RDF files for tests, through `rapper` (raptor2-utils)."""
import re
import subprocess

NAMESPACES = {
    "http://www.w3.org/1999/02/22-rdf-syntax-ns#": "rdf:", "http://www.w3.org/2000/01/rdf-schema#": "rdfs:",
    "http://www.w3.org/2002/07/owl#": "owl:", "http://www.w3.org/2001/XMLSchema#": "xsd:",
    "http://www.w3.org/ns/prov#": "prov:", "http://www.w3.org/ns/sosa/": "sosa:",
    "http://www.opengis.net/ont/geosparql#": "geo:", "https://schema.org/": "schema:",
    "https://w3id.org/docent#": "docent:", "https://w3id.org/docent/expo#": "expo:",
}
LINE = re.compile(r'(\S+) (\S+) (.+) \.$')
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')


def short(term):
    """docent:Robot for <https://w3id.org/docent#Robot>, the text of a literal, _:b1 for a blank node."""
    literal = LITERAL.match(term)
    if literal:
        return literal[1].encode().decode("unicode_escape") if "\\" in literal[1] else literal[1]
    if term.startswith("<"):
        term = term[1:-1]
        for namespace, prefix in NAMESPACES.items():
            if term.startswith(namespace):
                return prefix + term[len(namespace):]
    return term


def read(path):
    """The triples of a Turtle file as (subject, predicate, object) of short names. Raises on a syntax error."""
    run = subprocess.run(["rapper", "-q", "-i", "turtle", "-o", "ntriples", str(path)], capture_output=True, text=True)
    if run.returncode != 0:
        raise ValueError(f"{path}: {run.stderr.strip()}")
    tag = path.stem  # keeps blank nodes of different files apart
    triples = []
    for line in run.stdout.splitlines():
        terms = [short(t) for t in LINE.match(line).groups()]
        triples.append(tuple(t + "@" + tag if t.startswith("_:") else t for t in terms))
    return triples
