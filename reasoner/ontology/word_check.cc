#include "reasoner/ontology/word_check.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/values/text.h"

namespace docent::ontology {
namespace {

using Kind = Vocabulary::Kind;

std::string_view NameOf(Kind kind) {
  return kind == Kind::kClass ? "class" : kind == Kind::kProperty ? "property" : "resource";
}

// A namespace without the parts that people often get wrong.
std::string Plain(std::string_view name_space) {
  std::string text = sparql::LowerAscii(name_space);
  for (const std::string_view start : {"http://", "https://"}) {
    if (text.starts_with(start)) text.erase(0, start.size());
  }
  if (text.starts_with("www.")) text.erase(0, 4);
  while (!text.empty() && (text.back() == '#' || text.back() == '/')) text.pop_back();
  return text;
}

// Check of the words of one document, each once.
class WordCheck {
 public:
  WordCheck(const Vocabulary& vocabulary, Findings& findings) : vocabulary_(vocabulary), findings_(findings) {
    for (const std::string& name_space : vocabulary.covered()) plain_.emplace(Plain(name_space), name_space);
  }

  void Use(const Term& term, Kind kind, const SourceSpan& span) {
    if (!term.IsIri() || !seen_.insert({term.lexical, kind}).second) return;
    const std::string& iri = term.lexical;
    const std::string_view name_space = NamespaceOf(iri);
    if (!vocabulary_.Covers(name_space)) return CheckNamespace(name_space, span);
    if (name_space == iri || IsContainerMember(iri)) return;
    if (kind == Kind::kClass && !IsClass(iri) && vocabulary_.IsProperty(iri))
      return WrongKind(iri, kind, span);
    if (kind == Kind::kProperty && !vocabulary_.IsProperty(iri) && IsClass(iri))
      return WrongKind(iri, kind, span);
    const bool defined = kind == Kind::kClass      ? IsClass(iri)
                         : kind == Kind::kProperty ? vocabulary_.IsProperty(iri)
                                                   : vocabulary_.IsKnown(iri);
    if (!defined) Undefined(iri, kind, span);
  }

 private:
  bool IsClass(const std::string& iri) const {
    return vocabulary_.IsClass(iri) || vocabulary_.IsDatatype(iri);
  }
  static bool IsContainerMember(std::string_view iri) {
    return iri.starts_with(kRdfNs) && iri.size() > kRdfNs.size() + 1 && iri[kRdfNs.size()] == '_';
  }

  void Undefined(const std::string& iri, Kind kind, const SourceSpan& span) {
    // a word undefined both as a class and as a resource is reported once
    if (!undefined_.insert(iri).second) return;
    const std::string nearest = vocabulary_.NearestWord(iri, kind);
    const std::string any = nearest.empty() ? vocabulary_.NearestWord(iri, Kind::kAny) : nearest;
    findings_.Error(
        "undefined-term", span,
        Concat("the ", NameOf(kind), " ", ToDisplay(Term::Iri(iri)), " is not defined"),
        any.empty() ? Concat("declare it in the ontology of <", NamespaceOf(iri), ">, or use one that it has")
                    : Concat("did you mean ", ToDisplay(Term::Iri(any)), "?"));
  }

  void WrongKind(const std::string& iri, Kind kind, const SourceSpan& span) {
    const bool to_class = kind == Kind::kClass;
    const std::string nearest = vocabulary_.NearestWord(iri, kind);
    findings_.Error("wrong-kind", span,
                    Concat(ToDisplay(Term::Iri(iri)), to_class ? " is a property, and a class is meant here"
                                                               : " is a class, and a property is meant here"),
                    nearest.empty() ? Concat("use a ", NameOf(kind), " here")
                                    : Concat("did you mean ", ToDisplay(Term::Iri(nearest)), "?"));
  }

  void CheckNamespace(std::string_view name_space, const SourceSpan& span) {
    if (!namespaces_.insert(std::string(name_space)).second) return;
    const auto known = plain_.find(Plain(name_space));
    if (known == plain_.end()) return;
    findings_.Warning("namespace", span, Concat("nothing is known of the namespace <", name_space, ">"),
                      Concat("did you mean <", known->second, ">?"));
  }

  const Vocabulary& vocabulary_;
  Findings& findings_;
  std::map<std::string, std::string> plain_;  // covered namespaces
  std::set<std::pair<std::string, Kind>> seen_;
  std::set<std::string> undefined_, namespaces_;
};

// The kind of word that such a property takes as object.
Kind ObjectKind(std::string_view predicate) {
  static const std::set<std::string, std::less<>>* classes =
      new std::set<std::string, std::less<>>{std::string(kRdfType),
                                             Concat(kRdfsNs, "subClassOf"),
                                             Concat(kRdfsNs, "domain"),
                                             Concat(kRdfsNs, "range"),
                                             Concat(kOwlNs, "equivalentClass"),
                                             Concat(kOwlNs, "disjointWith"),
                                             Concat(kOwlNs, "complementOf"),
                                             Concat(kOwlNs, "onClass"),
                                             Concat(kOwlNs, "someValuesFrom"),
                                             Concat(kOwlNs, "allValuesFrom"),
                                             "http://www.w3.org/ns/shacl#class",
                                             "http://www.w3.org/ns/shacl#targetClass",
                                             "http://www.w3.org/ns/shacl#datatype"};
  static const std::set<std::string, std::less<>>* properties =
      new std::set<std::string, std::less<>>{Concat(kRdfsNs, "subPropertyOf"),
                                             Concat(kOwlNs, "onProperty"),
                                             Concat(kOwlNs, "inverseOf"),
                                             Concat(kOwlNs, "equivalentProperty"),
                                             "http://www.w3.org/ns/shacl#path",
                                             "http://www.w3.org/ns/shacl#targetSubjectsOf",
                                             "http://www.w3.org/ns/shacl#targetObjectsOf"};
  if (classes->contains(predicate)) return Kind::kClass;
  return properties->contains(predicate) ? Kind::kProperty : Kind::kAny;
}

// Ontologies and their versions have IRIs of their own, often the namespace without its last character.
bool NamesOntology(std::string_view predicate) {
  static const std::set<std::string, std::less<>>* words = new std::set<std::string, std::less<>>{
      Concat(kOwlNs, "versionIRI"), Concat(kOwlNs, "imports"), Concat(kOwlNs, "priorVersion"),
      Concat(kOwlNs, "backwardCompatibleWith"), Concat(kOwlNs, "incompatibleWith")};
  return words->contains(predicate);
}

void UseTriple(const Term& subject, const Term& predicate, const Term& object, const SourceSpan& subject_at,
               const SourceSpan& predicate_at, const SourceSpan& object_at, bool described,
               WordCheck& check) {
  if (!described) check.Use(subject, Kind::kAny, subject_at);
  check.Use(predicate, Kind::kProperty, predicate_at);
  if (!NamesOntology(predicate.lexical)) check.Use(object, ObjectKind(predicate.lexical), object_at);
}

void UsePattern(const sparql::TriplePattern& t, WordCheck& check) {
  static const Term* none = new Term(Term::Literal(""));
  const auto term = [](const sparql::PatternTerm& p) -> const Term& {
    return p.IsVariable() ? *none : p.term();
  };
  UseTriple(term(t.subject), term(t.predicate), term(t.object), t.subject.span, t.predicate.span,
            t.object.span, false, check);
}

void UsePath(const sparql::Path& path, const SourceSpan& span, WordCheck& check) {
  if (path.kind == sparql::Path::Kind::kIri) check.Use(path.iri, Kind::kProperty, span);
  for (const sparql::Path& child : path.children) UsePath(child, span, check);
}

void UseAlgebra(const sparql::Algebra& algebra, WordCheck& check) {
  sparql::AnyNode(algebra, [&check](const sparql::Algebra& node) {
    for (const sparql::TriplePattern& t : node.triples) UsePattern(t, check);
    if (node.kind == sparql::Algebra::Kind::kPath) UsePath(node.path, node.subject.span, check);
    return false;
  });
}

}  // namespace

void CheckWords(const LocatedRdf& document, const Vocabulary& vocabulary, Findings& findings) {
  WordCheck check(vocabulary, findings);
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    const TermQuad& q = document.rdf.quads[i];
    const QuadPlace& at = document.places[i];
    UseTriple(q.subject, q.predicate, q.object, at.subject, at.predicate, at.object, true, check);
  }
  CheckPrefixes(document.prefixes, findings);
}

void CheckPrefixes(const std::vector<PrefixPlace>& prefixes, Findings& findings) {
  for (const PrefixPlace& prefix : prefixes) {
    if (prefix.uses > 0) continue;
    findings.Warning("unused-prefix", prefix.span, Concat("the prefix ", prefix.prefix, ": is not used"),
                     "remove its declaration");
  }
}

void CheckWords(const rules::ParsedRules& rules, const Vocabulary& vocabulary, Findings& findings) {
  WordCheck check(vocabulary, findings);
  for (const rules::Rule& rule : rules.rules) {
    for (const sparql::TriplePattern& t : rule.head) UsePattern(t, check);
    if (rule.body.algebra) UseAlgebra(*rule.body.algebra, check);
  }
}

void CheckWords(const sparql::Query& query, const Vocabulary& vocabulary, Findings& findings) {
  WordCheck check(vocabulary, findings);
  if (query.algebra) UseAlgebra(*query.algebra, check);
  for (const sparql::TriplePattern& t : query.construct_template) UsePattern(t, check);
}

}  // namespace docent::ontology
