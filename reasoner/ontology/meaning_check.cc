#include "reasoner/ontology/meaning_check.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/value.h"
#include "reasoner/ontology/hierarchy.h"
#include "reasoner/rules/rule_sets.h"
#include "reasoner/shapes/datatype_check.h"

namespace docent::ontology {
namespace {

std::string Show(std::string_view iri) {
  return ToDisplay(Term::Iri(std::string(iri)));
}

std::string DatatypeOf(const Term& literal) {
  if (!literal.language.empty()) return std::string(kRdfLangString);
  return literal.datatype.empty() ? std::string(kXsdString) : literal.datatype;
}

// A text that its datatype allows, with a value that queries, rules and conditions cannot compute with.
bool IsBeyondValues(const Term& literal) {
  static constexpr std::string_view kComputed[] = {
      "dateTime",       "date",    "duration",           "yearMonthDuration",  "dayTimeDuration",
      "decimal",        "integer", "nonPositiveInteger", "nonNegativeInteger", "positiveInteger",
      "negativeInteger"};
  if (!literal.datatype.starts_with(kXsdNs)) return false;
  const std::string_view name = std::string_view(literal.datatype).substr(kXsdNs.size());
  return std::find(std::begin(kComputed), std::end(kComputed), name) != std::end(kComputed) &&
         sparql::Value::OfTerm(literal).type() == sparql::Value::Type::kOther;
}

class MeaningCheck {
 public:
  MeaningCheck(const LocatedRdf& document, const Vocabulary& vocabulary, std::set<std::string>* cycles,
               Findings& findings)
      : document_(document), vocabulary_(vocabulary), cycles_(*cycles), findings_(findings) {}

  void Run() {
    for (size_t i = 0; i < document_.rdf.quads.size(); ++i) {
      const TermQuad& q = document_.rdf.quads[i];
      const QuadPlace& at = document_.places[i];
      if (q.object.IsLiteral()) CheckLiteral(q.object, at.object);
      if (q.predicate.lexical == kRdfType) {
        CheckDeclaration(q, at);
      } else if (!IsSchemaWord(q.predicate.lexical)) {
        CheckDomain(q, at);
        CheckRange(q, at);
      }
      CheckEdge(q, at);
      CheckImport(q, at);
      CheckListLength(q, at);
    }
  }

 private:
  // Words about words: their domains and ranges come from RDF Schema and OWL, which declare no literals.
  static bool IsSchemaWord(std::string_view iri) {
    return iri.starts_with(kRdfNs) || iri.starts_with(kRdfsNs) || iri.starts_with(kOwlNs);
  }

  void CheckLiteral(const Term& literal, const SourceSpan& span) {
    if (shapes::IsValidLexicalForm(literal.lexical, DatatypeOf(literal)).value_or(true)) {
      if (!IsBeyondValues(literal)) return;
      return findings_.Warning(
          "value-range", span,
          Concat("\"", literal.lexical.substr(0, 100), "\" is beyond the values of ", Show(literal.datatype),
                 " that the server computes with; it is kept, and equals only the same text"),
          "years are computed from -200000 to 200000, numbers to 38 digits; write a value between, if it is "
          "to "
          "be compared");
    }
    findings_.Error("bad-literal", span,
                    Concat("\"", literal.lexical.substr(0, 100), "\" is not a text that ",
                           Show(literal.datatype), " allows"),
                    "correct the text, or its datatype");
  }

  void CheckDeclaration(const TermQuad& q, const QuadPlace& at) {
    if (!q.subject.IsIri() || !q.object.IsIri()) return;
    const std::string& iri = q.subject.lexical;
    const bool declares = vocabulary_.IsClass(iri) || vocabulary_.IsProperty(iri);
    if (declares && IsSchemaWord(q.object.lexical) && declared_.insert(iri).second) {
      CheckExplained(iri, at.subject);
    }
  }

  void CheckExplained(const std::string& iri, const SourceSpan& span) {
    constexpr std::string_view kLabel = "rdfs:label \"…\", the word that people see";
    constexpr std::string_view kComment = "rdfs:comment \"…\", what it means and when it holds";
    const bool label = vocabulary_.HasLabel(iri), comment = vocabulary_.HasComment(iri);
    if (!label && !comment) {
      findings_.Warning("missing-label", span, Concat(Show(iri), " has neither label nor comment"),
                        Concat("add ", kLabel, ", and ", kComment));
    } else if (!label) {
      findings_.Warning("missing-label", span, Concat(Show(iri), " has no label"), Concat("add ", kLabel));
    } else if (!comment) {
      findings_.Warning("missing-comment", span, Concat(Show(iri), " has no comment"),
                        Concat("add ", kComment));
    }
  }

  void CheckImport(const TermQuad& q, const QuadPlace& at) {
    if (q.predicate.lexical != Concat(kOwlNs, "imports") || !q.object.IsIri() ||
        vocabulary_.HasOntology(q.object.lexical))
      return;
    findings_.Warning("import", at.object,
                      Concat(Show(q.object.lexical), " is imported, but is not an ontology of these files"),
                      "imports are not fetched; name the file that has it, too");
  }

  // A class below two disjoint classes: no inconsistency as long as it has no instance.
  void CheckSatisfiable(const std::string& iri, const SourceSpan& span) {
    if (!judged_.insert(iri).second) return;
    const auto [one, other] = vocabulary_.DisjointAmong({iri});
    if (one.empty()) return;
    findings_.Error("disjoint-types", span,
                    Concat(Show(iri), " is below ", Show(one), " and ", Show(other), ", which are disjoint"),
                    "remove one of them, or the owl:disjointWith");
  }

  // Relation of the types of a resource to a class that it must be in.
  enum class Fit { kUnknown, kIs, kMismatch, kClash };
  Fit FitOf(const Term& node, const std::string& cls, std::string* why) const {
    if (!node.IsIri() || cls == Concat(kOwlNs, "Thing") || cls == Concat(kRdfsNs, "Resource"))
      return Fit::kUnknown;
    const Words& types = vocabulary_.TypesOf(node.lexical);
    Fit fit = Fit::kUnknown;
    for (const std::string& type : types) {
      if (vocabulary_.ClassesAbove(type)->contains(cls)) return Fit::kIs;
      if (type == Concat(kOwlNs, "NamedIndividual")) continue;
      const auto [one, other] = vocabulary_.Disjoint(type, cls);
      if (!one.empty()) {
        *why = Concat(Show(one), " is disjoint with ", Show(other));
        return Fit::kClash;
      }
      *why = Concat("it is ", Show(type));
      fit = Fit::kMismatch;
    }
    return fit;
  }

  void Judge(const Term& node, const std::string& cls, const std::string& property, const char* side,
             const SourceSpan& span) {
    std::string why;
    const Fit fit = FitOf(node, cls, &why);
    const std::string rule = side;
    if (fit == Fit::kClash) {
      findings_.Error(rule + "-clash", span,
                      Concat(ToDisplay(node), " cannot be ", Show(cls), ", the ", side, " of ",
                             Show(property), ": ", why),
                      Concat("use another property, or correct the type of ", ToDisplay(node)));
    } else if (fit == Fit::kMismatch) {
      findings_.Warning(rule + "-mismatch", span,
                        Concat(ToDisplay(node), " is taken for ", Show(cls), ", the ", side, " of ",
                               Show(property), "; ", why),
                        Concat("say that it is ", Show(cls), ", too, or use another property"));
    }
  }

  void CheckDomain(const TermQuad& q, const QuadPlace& at) {
    const PropertyFacts* facts = vocabulary_.Property(q.predicate.lexical);
    if (facts == nullptr) return;
    for (const std::string& domain : facts->domains)
      Judge(q.subject, domain, q.predicate.lexical, "domain", at.subject);
  }

  void CheckRange(const TermQuad& q, const QuadPlace& at) {
    const std::string& property = q.predicate.lexical;
    const PropertyFacts* facts = vocabulary_.Property(property);
    if (facts == nullptr || facts->annotation) return;
    if (q.object.IsLiteral()) {
      CheckLiteralRange(q, *facts, at.object);
      return;
    }
    const bool data_range = std::any_of(facts->ranges.begin(), facts->ranges.end(),
                                        [this](const std::string& r) { return vocabulary_.IsDatatype(r); });
    if ((facts->data && !facts->object) || data_range) {
      findings_.Error(
          "range-clash", at.object,
          Concat(Show(property), " has a literal as value, and ", ToDisplay(q.object), " is a resource"),
          "write a literal, or use a property that leads to resources");
      return;
    }
    for (const std::string& range : facts->ranges) Judge(q.object, range, property, "range", at.object);
  }

  void CheckLiteralRange(const TermQuad& q, const PropertyFacts& facts, const SourceSpan& span) {
    const std::string& property = q.predicate.lexical;
    if (facts.object && !facts.data) {
      findings_.Error(
          "range-clash", span,
          Concat(Show(property), " leads to a resource, and ", ToDisplay(q.object), " is a literal"),
          "name the resource by its IRI, or use a property that has literals");
      return;
    }
    const std::string datatype = DatatypeOf(q.object);
    for (const std::string& range : facts.ranges) {
      const bool any = range == Concat(kRdfsNs, "Literal") || range == Concat(kRdfsNs, "Resource") ||
                       range == Concat(kXsdNs, "anyAtomicType") || range == Concat(kXsdNs, "anySimpleType");
      if (any || shapes::IsDerivedDatatype(datatype, range)) continue;
      if (vocabulary_.IsDatatype(range) && !range.starts_with(kXsdNs)) continue;  // it is defined elsewhere
      if (vocabulary_.IsClass(range)) {
        findings_.Error(
            "range-clash", span,
            Concat(Show(property), " leads to ", Show(range), ", and ", ToDisplay(q.object), " is a literal"),
            "name the resource by its IRI");
      } else if (vocabulary_.IsDatatype(range)) {
        findings_.Error("range-clash", span,
                        Concat(ToDisplay(q.object), " is ", Show(datatype), "; the range of ", Show(property),
                               " is ", Show(range)),
                        Concat("write the value as ", Show(range)));
      }
    }
  }

  // Checks for a class below two disjoint ones, and for cycles, at the first edge in this document.
  void CheckEdge(const TermQuad& q, const QuadPlace& at) {
    if (!q.subject.IsIri() || !q.object.IsIri()) return;
    const bool of_classes = q.predicate.lexical == Concat(kRdfsNs, "subClassOf");
    const bool of_properties = q.predicate.lexical == Concat(kRdfsNs, "subPropertyOf");
    if (!of_classes && !of_properties) return;
    if (of_classes) {
      CheckSatisfiable(q.subject.lexical, at.subject);
    }
    const auto& edges = of_classes ? vocabulary_.super_classes() : vocabulary_.super_properties();
    const std::vector<std::string> cycle = CycleThrough(edges, q.subject.lexical, q.object.lexical);
    if (cycle.empty()) return;
    const std::string& least = *std::min_element(cycle.begin(), cycle.end());
    if (!cycles_.insert(least).second) return;
    std::string text;
    for (const std::string& word : cycle) absl::StrAppend(&text, Show(word), " → ");
    absl::StrAppend(&text, Show(cycle.front()));
    findings_.Warning(
        "cycle", at.object,
        Concat(of_classes ? "classes" : "properties", " that are below each other: ", text),
        Concat("remove one of the ", of_classes ? "rdfs:subClassOf" : "rdfs:subPropertyOf", ", or write ",
               of_classes ? "owl:equivalentClass" : "owl:equivalentProperty", " if they mean the same"));
  }

  void CheckListLength(const TermQuad& q, const QuadPlace& at) {
    const bool chain = q.predicate.lexical == Concat(kOwlNs, "propertyChainAxiom");
    if (!chain && q.predicate.lexical != Concat(kOwlNs, "hasKey")) return;
    const int most = chain ? rules::kChainProperties : rules::kKeyProperties;
    const int length = LengthOf(q.object);
    if (length <= most) return;
    findings_.Warning("long-list", at.predicate,
                      absl::StrCat(chain ? "a chain of " : "a key of ", length,
                                   " properties; rule set owl2rl follows up to ", most,
                                   ", and draws nothing from this one"),
                      chain ? "give a part of the chain a property of its own, and name that in the chain"
                            : "name fewer properties, or write a rule");
  }

  // Length of a list in this document; a cyclic list has none.
  int LengthOf(const Term& list) {
    if (rests_.empty()) {
      for (const TermQuad& q : document_.rdf.quads) {
        if (q.predicate.lexical == Concat(kRdfNs, "rest")) rests_.emplace(q.subject, q.object);
      }
    }
    size_t length = 0;
    for (auto cell = rests_.find(list); cell != rests_.end(); cell = rests_.find(cell->second)) {
      if (++length > rests_.size()) return 0;
    }
    return static_cast<int>(length);
  }

  const LocatedRdf& document_;
  const Vocabulary& vocabulary_;
  std::set<std::string>& cycles_;
  Findings& findings_;
  std::set<std::string> declared_;
  std::map<Term, Term> rests_;    // rdf:rest, by cell
  std::set<std::string> judged_;  // classes already checked
};

}  // namespace

void CheckMeaning(const LocatedRdf& document, const Vocabulary& vocabulary, std::set<std::string>* cycles,
                  Findings& findings) {
  MeaningCheck(document, vocabulary, cycles, findings).Run();
}

}  // namespace docent::ontology
