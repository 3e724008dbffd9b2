#include "kb_server/app/condition_evidence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/sparql/evaluator.h"

namespace docent {
namespace {

bool HasHidden(const sparql::TriplePattern& pattern) {
  const auto hidden = [](const sparql::PatternTerm& term) { return term.variable && term.variable->IsHidden(); };
  return hidden(pattern.subject) || hidden(pattern.predicate) || hidden(pattern.object);
}

// The value of a position of a pattern; null where `binding` has none.
const Term* ValueOf(const sparql::PatternTerm& term, const TermBinding& binding) {
  if (!term.variable) return &term.term;
  const auto value = binding.find(term.variable->name);
  return value == binding.end() ? nullptr : &value->second;
}

std::string Line(const Term& subject, const Term& predicate, const Term& object) {
  return absl::StrCat(ToNTriples(subject), " ", ToNTriples(predicate), " ", ToNTriples(object), " .\n");
}

bool Holds(const GraphVersion& version, const Dictionary& dictionary, const Term& subject, const Term& predicate,
           const Term& object) {
  const std::optional<TermId> s = dictionary.Find(subject), p = dictionary.Find(predicate), o = dictionary.Find(object);
  return s && p && o && version.Count({*s, *p, *o, TermId()}) > 0;
}

}  // namespace

ConditionEvidence::ConditionEvidence(std::shared_ptr<const sparql::Query> query, const Dictionary* dictionary,
                                     const sparql::FunctionRegistry* functions)
    : query_(std::move(query)), dictionary_(dictionary), functions_(functions) {
  for (const sparql::PatternOccurrence& occurrence : sparql::AllTriplePatterns(*query_->algebra)) {
    if (occurrence.monotone) (HasHidden(*occurrence.pattern) ? steps_ : patterns_).push_back(occurrence.pattern);
  }
}

std::string ConditionEvidence::Text(const GraphVersion& version, TimeMicros now_us, const TermBinding& binding) const {
  std::vector<std::string> lines;
  for (const sparql::TriplePattern* pattern : patterns_) {
    const Term* subject = ValueOf(pattern->subject, binding);
    const Term* predicate = ValueOf(pattern->predicate, binding);
    const Term* object = ValueOf(pattern->object, binding);
    if (subject == nullptr || predicate == nullptr || object == nullptr) continue;  // of an alternative not taken
    if (Holds(version, *dictionary_, *subject, *predicate, *object)) lines.push_back(Line(*subject, *predicate, *object));
  }
  if (!steps_.empty()) {
    for (std::string& line : Steps(version, now_us, binding)) lines.push_back(std::move(line));
  }
  std::string text;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (std::find(lines.begin(), lines.begin() + i, lines[i]) == lines.begin() + i) text += lines[i];
  }
  return text;
}

std::vector<std::string> ConditionEvidence::Steps(const GraphVersion& version, TimeMicros now_us,
                                                  const TermBinding& binding) const {
  sparql::Query query = query_->Clone();
  query.form = sparql::Query::Form::kConstruct;
  for (const sparql::TriplePattern* pattern : steps_) query.construct_template.push_back(*pattern);
  const std::vector<sparql::Variable> in_scope = sparql::InScopeVariables(*query.algebra);
  sparql::PrepareOptions options;
  options.functions = functions_;
  std::vector<TermId> values;
  for (const auto& [name, term] : binding) {
    const std::optional<TermId> id = dictionary_->Find(term);
    if (!id || std::find(in_scope.begin(), in_scope.end(), sparql::Variable{name}) == in_scope.end()) continue;
    options.bound.push_back(name);
    values.push_back(*id);
  }
  std::vector<std::string> lines;
  auto prepared = sparql::PreparedQuery::Prepare(std::move(query), *dictionary_, options);
  if (!prepared.ok()) return lines;
  sparql::RunOptions run;
  run.version = &version;
  run.now_us = now_us;
  const auto triples = (*prepared)->Construct(run, values);
  if (!triples.ok()) return lines;
  for (const TermQuad& triple : *triples) {
    if (!Holds(version, *dictionary_, triple.subject, triple.predicate, triple.object)) continue;
    lines.push_back(Line(triple.subject, triple.predicate, triple.object));
  }
  std::sort(lines.begin(), lines.end());
  if (lines.size() > kStepsShown) lines.resize(kStepsShown);
  return lines;
}

}  // namespace docent
