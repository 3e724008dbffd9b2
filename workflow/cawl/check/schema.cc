#include "workflow/cawl/check/schema.h"

#include <algorithm>
#include <array>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

// Nodes of a list that are followed back to its head.
constexpr size_t kMaxListNodes = 1000;

bool Contains(const std::vector<Term>& terms, const Term& term) {
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

}  // namespace

const Schema::Iris& Schema::Above(const std::string& iri, const std::set<std::string>& predicates,
                                  Memory* memory) const {
  const auto [entry, is_new] = memory->try_emplace(iri);
  if (!is_new) return entry->second;
  Iris& above = entry->second;
  above.insert(iri);
  std::vector<std::string> todo{iri};
  while (!todo.empty() && above.size() < kMaxAbove) {
    const Term here = Term::Iri(std::move(todo.back()));
    todo.pop_back();
    for (const std::string& predicate : predicates) {
      for (const Term& next : environment_.Objects(here, predicate)) {
        if (next.IsIri() && above.insert(next.lexical).second) todo.push_back(next.lexical);
      }
    }
  }
  return above;
}

const Schema::Iris& Schema::ClassesAbove(const std::string& cls) const {
  static const std::set<std::string> predicates = {Concat(kRdfsNs, "subClassOf"),
                                                   Concat(kOwlNs, "equivalentClass")};
  return Above(cls, predicates, &classes_above_);
}

const Schema::Iris& Schema::PropertiesAbove(const std::string& property) const {
  static const std::set<std::string> predicates = {Concat(kRdfsNs, "subPropertyOf"),
                                                   Concat(kOwlNs, "equivalentProperty")};
  return Above(property, predicates, &properties_above_);
}

// [] a owl:AllDisjointClasses ; owl:members ( … cls … )
void Schema::AddGroupMembers(const std::string& cls, Iris* out) const {
  static const std::string first = Concat(kRdfNs, "first"), rest = Concat(kRdfNs, "rest"),
                           members = Concat(kOwlNs, "members");
  const Term all_disjoint = Term::Iri(Concat(kOwlNs, "AllDisjointClasses"));
  for (Term node : environment_.Subjects(first, Term::Iri(cls))) {
    for (size_t steps = 0; steps < kMaxListNodes; ++steps) {
      const std::vector<Term> before = environment_.Subjects(rest, node);
      if (before.empty()) break;
      node = before.front();
    }
    for (const Term& group : environment_.Subjects(members, node)) {
      if (!Contains(environment_.Objects(group, kRdfType), all_disjoint)) continue;
      for (size_t steps = 0; steps < kMaxListNodes; ++steps) {
        for (const Term& member : environment_.Objects(node, first)) {
          if (member.IsIri() && member.lexical != cls) out->insert(member.lexical);
        }
        const std::vector<Term> next = environment_.Objects(node, rest);
        if (next.empty()) break;
        node = next.front();
      }
    }
  }
}

const Schema::Iris& Schema::DisjointWith(const std::string& cls) const {
  const auto [entry, is_new] = disjoint_.try_emplace(cls);
  if (!is_new) return entry->second;
  static const std::string disjoint_with = Concat(kOwlNs, "disjointWith"),
                           complement = Concat(kOwlNs, "complementOf");
  const Term term = Term::Iri(cls);
  for (const std::string& predicate : {disjoint_with, complement}) {
    for (const Term& other : environment_.Objects(term, predicate)) {
      if (other.IsIri()) entry->second.insert(other.lexical);
    }
    for (const Term& other : environment_.Subjects(predicate, term)) {
      if (other.IsIri()) entry->second.insert(other.lexical);
    }
  }
  AddGroupMembers(cls, &entry->second);
  return entry->second;
}

bool Schema::Disjoint(const std::string& a, const std::string& b) const {
  const Iris& above_b = ClassesAbove(b);
  for (const std::string& cls : ClassesAbove(a)) {
    for (const std::string& other : DisjointWith(cls)) {
      if (above_b.contains(other)) return true;
    }
  }
  return false;
}

Schema::Iris Schema::OfProperty(const std::string& property, std::string_view what) const {
  Iris out;
  const std::string predicate = Concat(kRdfsNs, what);
  for (const std::string& above : PropertiesAbove(property)) {
    for (const Term& term : environment_.Objects(Term::Iri(above), predicate)) {
      if (term.IsIri()) out.insert(term.lexical);
    }
  }
  return out;
}

bool Schema::HasType(const std::string& property, std::string_view type) const {
  return Contains(environment_.Objects(Term::Iri(property), kRdfType), Term::Iri(Concat(kOwlNs, type)));
}

Schema::Iris Schema::TypesOf(const std::string& resource) const {
  Iris out;
  for (const Term& type : environment_.Objects(Term::Iri(resource), kRdfType)) {
    if (type.IsIri()) out.insert(type.lexical);
  }
  return out;
}

bool Schema::IsDatatype(const std::string& iri) const {
  return iri.starts_with(kXsdNs) || iri == Concat(kRdfsNs, "Literal") || iri == kRdfLangString ||
         Contains(environment_.Objects(Term::Iri(iri), kRdfType), Term::Iri(Concat(kRdfsNs, "Datatype")));
}

ValueFamily FamilyOf(std::string_view datatype) {
  if (datatype.empty() || datatype == kRdfLangString) return ValueFamily::kText;
  if (!datatype.starts_with(kXsdNs)) return ValueFamily::kUnknown;
  const std::string_view local = datatype.substr(kXsdNs.size());
  static constexpr std::array<std::string_view, 16> numbers = {"decimal",
                                                               "integer",
                                                               "double",
                                                               "float",
                                                               "int",
                                                               "long",
                                                               "short",
                                                               "byte",
                                                               "unsignedInt",
                                                               "unsignedLong",
                                                               "unsignedShort",
                                                               "unsignedByte",
                                                               "nonNegativeInteger",
                                                               "positiveInteger",
                                                               "nonPositiveInteger",
                                                               "negativeInteger"};
  static constexpr std::array<std::string_view, 6> texts = {
      "string", "normalizedString", "token", "language", "Name", "NCName"};
  if (std::find(numbers.begin(), numbers.end(), local) != numbers.end()) return ValueFamily::kNumber;
  if (std::find(texts.begin(), texts.end(), local) != texts.end()) return ValueFamily::kText;
  if (local == "boolean") return ValueFamily::kBoolean;
  if (local == "dateTime" || local == "dateTimeStamp") return ValueFamily::kDateTime;
  if (local == "date") return ValueFamily::kDate;
  if (local == "time") return ValueFamily::kTime;
  return ValueFamily::kUnknown;
}

}  // namespace docent::cawl
