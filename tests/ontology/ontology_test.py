#!/usr/bin/env python3
"""Every term of the ontology is explained, and scenarios use only terms that it has."""
import pathlib
import re
import unittest

import rdf_triples

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODULES = sorted((ROOT / "ontology").glob("*.ttl"))
PROPERTY_TYPES = {"owl:ObjectProperty", "owl:DatatypeProperty", "rdf:Property"}


class Ontology(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.triples = [t for m in MODULES for t in rdf_triples.read(m)]
        cls.by_subject = {}
        for s, p, o in cls.triples:
            cls.by_subject.setdefault(s, {}).setdefault(p, []).append(o)
        cls.terms = {s for s in cls.by_subject if s.startswith("docent:")}
        cls.properties = {s for s in cls.terms if PROPERTY_TYPES & set(cls.by_subject[s]["rdf:type"])}

    def test_each_term_has_type_label_and_comment(self):
        for term in sorted(self.terms):
            with self.subTest(term):
                about = self.by_subject[term]
                self.assertEqual(len(about.get("rdfs:label", [])), 1)
                self.assertGreater(len(about.get("rdfs:comment", [""])[0]), 15)
                self.assertIn("rdf:type", about)

    def test_each_property_has_one_domain_and_one_range(self):
        self.assertGreater(len(self.properties), 40)
        for term in sorted(self.properties):
            with self.subTest(term):
                for side in ("rdfs:domain", "rdfs:range"):
                    values = self.by_subject[term].get(side, [])
                    self.assertEqual(len(values), 1, side)
                    known = values[0] in self.by_subject or values[0].startswith(("xsd:", "rdfs:", "rdf:"))
                    self.assertTrue(known, f"{side} {values[0]} is declared nowhere")

    def test_every_mentioned_term_is_declared(self):
        declared = set(self.by_subject)
        for s, p, o in self.triples:
            for term in (s, p, o):
                if re.fullmatch(r"(docent|sosa|prov|geo|schema):\w+", term):
                    self.assertIn(term, declared, f"in {s} {p} {o}")

    def test_no_term_is_defined_in_two_modules(self):
        where = {}
        for module in MODULES:
            for s in {s for s, p, _ in rdf_triples.read(module) if p == "rdfs:comment"}:
                self.assertNotIn(s, where, f"in {module.name} and {where.get(s)}")
                where[s] = module.name

    def test_modules_are_versioned_ontologies_and_imported(self):
        imported = self.by_subject["https://w3id.org/docent/ontology"]["owl:imports"]
        ontologies = {s for s in self.by_subject if "owl:Ontology" in self.by_subject[s].get("rdf:type", [])}
        self.assertEqual(ontologies - {"https://w3id.org/docent/ontology"}, set(imported))
        self.assertEqual(len(ontologies), len(MODULES))
        for ontology in ontologies:
            self.assertRegex(self.by_subject[ontology]["owl:versionInfo"][0], r"^\d+\.\d+\.\d+$")

    def test_each_component_of_rois_is_a_class_of_operations(self):
        triples = rdf_triples.read(ROOT / "ontology/mappings/rois.ttl")
        equivalent = {s: o for s, p, o in triples if p == "owl:equivalentClass"}
        self.assertEqual(len(equivalent), 17)
        self.assertEqual(len(set(equivalent.values())), 17)
        for component, name in equivalent.items():
            with self.subTest(component):
                self.assertTrue(component.startswith("urn:x-rois:def:HRIComponent:OMG::"))
                above = name
                while above != "docent:Capability":
                    above = self.by_subject[above]["rdfs:subClassOf"][0]
                self.assertTrue(any(s == component and p == "rdfs:label" for s, p, _ in triples))

    def test_aligned_with_the_standard_vocabularies(self):
        parents = {(s, o.split(":")[0]) for s, p, o in self.triples
                   if p in ("rdfs:subClassOf", "rdfs:subPropertyOf") and s.startswith("docent:")}
        for vocabulary in ("sosa", "prov", "geo", "schema"):
            self.assertTrue(any(v == vocabulary for _, v in parents), vocabulary)

    def test_scenarios_use_only_declared_terms(self):
        for file in sorted((ROOT / "scenarios").glob("*/*.ttl")):
            for triple in rdf_triples.read(file):
                for term in triple:
                    if re.fullmatch(r"docent:\w+", term):
                        self.assertIn(term, self.terms, f"{file.name}: {' '.join(triple)}")

    def test_code_uses_only_declared_terms(self):
        mention = re.compile(r'(?:DocentIri|SayDocent)\("(\w+)"|"https://w3id\.org/docent#(\w+)"')
        found = 0
        for top in ("kb_server", "reasoner", "workflow", "maps", "robot_adapters"):
            for file in sorted((ROOT / top).rglob("*.cc")) + sorted((ROOT / top).rglob("*.h")):
                for number, line in enumerate(file.read_text(errors="replace").splitlines(), 1):
                    for match in [] if line.lstrip().startswith("//") else mention.finditer(line):
                        found += 1
                        term = "docent:" + (match[1] or match[2])
                        with self.subTest(place=f"{file.relative_to(ROOT)}:{number}"):
                            self.assertIn(term, self.terms)
        self.assertGreater(found, 10)

    def test_state_properties_are_those_the_server_relies_on(self):
        states = {t for t in self.properties if "docent:StateProperty" in self.by_subject[t]["rdf:type"]}
        self.assertLessEqual({"docent:x", "docent:y", "docent:heading", "docent:isAt", "docent:status", "docent:incarnation",
                              "docent:adapterAddress", "docent:localised", "docent:currentCommand", "docent:progress"}, states)


if __name__ == "__main__":
    unittest.main()
