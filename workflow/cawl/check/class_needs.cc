#include "workflow/cawl/check/class_needs.h"

#include <algorithm>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {

ClassNeeds::Thing* ClassNeeds::Of(const Word& word) {
  if (word.comparison != Word::Comparison::kNone) return nullptr;
  if (word.kind == Word::Kind::kTerm) {
    if (!word.term.IsIri()) return nullptr;
    const auto [it, is_new] = things_.try_emplace(Concat("<", word.term.lexical));
    if (is_new) {
      it->second.shown = names_.Iri(word.term.lexical);
      for (const std::string& cls : schema_.TypesOf(word.term.lexical))
        NeedClass(&it->second, cls, "as the ontology says", word.span);
    }
    return &it->second;
  }
  if (word.kind != Word::Kind::kFree && word.kind != Word::Kind::kVariable) return nullptr;
  const auto [it, is_new] = things_.try_emplace(word.name);
  if (is_new) {
    it->second.shown = Concat(word.kind == Word::Kind::kFree ? "?" : "$", word.name);
    const Variable* variable = word.kind == Word::Kind::kVariable ? scope_.FindVariable(word.name) : nullptr;
    if (variable != nullptr && variable->type_term && variable->type_term->IsIri()) {
      NeedClass(&it->second, variable->type_term->lexical, "the type of the variable", word.span);
      if (!it->second.needs.empty()) it->second.needs.back().of_declaration = true;
    }
  }
  return &it->second;
}

void ClassNeeds::NeedClass(Thing* thing, const std::string& cls, std::string why, const SourceSpan& span) {
  Need need;
  need.literal = schema_.IsDatatype(cls);
  if (!need.literal) need.cls = cls;
  need.why = std::move(why);
  need.span = span;
  Push(thing, std::move(need));
}

void ClassNeeds::Push(Thing* thing, Need need) {
  const bool known = std::any_of(thing->needs.begin(), thing->needs.end(), [&](const Need& other) {
    return other.cls == need.cls && other.literal == need.literal;
  });
  if (!known) thing->needs.push_back(std::move(need));
}

void ClassNeeds::Add(const Constraint& constraint) {
  for (const Word* word : {&constraint.subject, &constraint.object}) {
    Thing* thing = Of(*word);
    if (thing != nullptr && word->type_term)
      NeedClass(thing, word->type_term->lexical, "by its type", word->type.span);
  }
  Thing* subject = Of(constraint.subject);
  if (subject != nullptr && constraint.subject.kind != Word::Kind::kTerm)
    Push(subject, {"", false, "as a subject", constraint.subject.span, false});
  if (constraint.verb.kind != Word::Kind::kTerm) return;
  const std::string& verb = constraint.verb.term.lexical;
  if (verb == kRdfType) {
    if (subject != nullptr && constraint.object.kind == Word::Kind::kTerm && constraint.object.term.IsIri() &&
        constraint.object.comparison == Word::Comparison::kNone)
      NeedClass(subject, constraint.object.term.lexical, "as said here", constraint.object.span);
    return;
  }
  const std::string shown = names_.Iri(verb);
  if (subject != nullptr) {
    for (const std::string& cls : schema_.Domains(verb))
      NeedClass(subject, cls, Concat("as the subject of ", shown), constraint.subject.span);
  }
  Thing* object = Of(constraint.object);
  if (object == nullptr) return;
  const SourceSpan& span = constraint.object.span;
  for (const std::string& cls : schema_.Ranges(verb)) {
    if (cls == Concat(kRdfsNs, "Resource")) continue;  // literals are resources
    if (constraint.object.kind == Word::Kind::kTerm && schema_.IsDatatype(cls)) continue;  // told as such
    NeedClass(object, cls, Concat("as the object of ", shown), span);
  }
  if (constraint.object.kind == Word::Kind::kTerm) return;
  if (schema_.IsDatatypeProperty(verb))
    Push(object, {"", true, Concat("as the object of ", shown), span, false});
  if (schema_.IsObjectProperty(verb))
    Push(object, {"", false, Concat("as the object of ", shown), span, false});
}

std::optional<NeedClash> ClassNeeds::ClashOf(const Thing& thing) const {
  for (size_t i = 0; i < thing.needs.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const Need &a = thing.needs[j], &b = thing.needs[i];
      const bool kinds = a.literal != b.literal;
      if (!kinds && (a.cls.empty() || b.cls.empty() || !schema_.Disjoint(a.cls, b.cls))) continue;
      const auto what = [&](const Need& need) {
        if (need.literal) return Concat("a literal (", need.why, ")");
        return need.cls.empty() ? Concat("a resource (", need.why, ")")
                                : Concat(names_.Iri(need.cls), " (", need.why, ")");
      };
      return NeedClash{b.span,
                       Concat(thing.shown, " would have to be ", what(a), " and ", what(b),
                              kinds ? "" : ", which are disjoint"),
                       a.of_declaration || b.of_declaration};
    }
  }
  return std::nullopt;
}

std::vector<NeedClash> ClassNeeds::Clashes() const {
  std::vector<NeedClash> out;
  for (const auto& [key, thing] : things_) {
    if (std::optional<NeedClash> clash = ClashOf(thing)) out.push_back(*std::move(clash));
  }
  return out;
}

}  // namespace docent::cawl
