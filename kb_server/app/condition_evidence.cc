#include "kb_server/app/condition_evidence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"

namespace docent {

ConditionEvidence::ConditionEvidence(std::shared_ptr<const sparql::Query> query, const Dictionary* dictionary,
                                     const sparql::FunctionRegistry* functions)
    : query_(std::move(query)), dictionary_(dictionary), functions_(functions) {}

// The query's own positive triple patterns as a CONSTRUCT template over its WHERE.
sparql::PreparedQuery* ConditionEvidence::Prepared(std::vector<std::string> bound) {
  if (prepared_ != nullptr && bound == bound_) return prepared_.get();
  sparql::Query query = query_->Clone();
  query.form = sparql::Query::Form::kConstruct;
  for (const sparql::PatternOccurrence& occurrence : sparql::AllTriplePatterns(*query.algebra)) {
    if (occurrence.monotone) query.construct_template.push_back(*occurrence.pattern);
  }
  auto slice = std::make_unique<sparql::Algebra>(sparql::Algebra::Kind::kSlice);
  slice->limit = 1;
  slice->children.push_back(std::move(query.algebra));
  query.algebra = std::move(slice);
  sparql::PrepareOptions options;
  options.functions = functions_;
  options.bound = bound;
  auto prepared = sparql::PreparedQuery::Prepare(std::move(query), *dictionary_, options);
  if (!prepared.ok()) return nullptr;
  prepared_ = *std::move(prepared);
  bound_ = std::move(bound);
  return prepared_.get();
}

std::string ConditionEvidence::Text(const GraphVersion& version, TimeMicros now_us, const TermBinding& binding) {
  const std::vector<sparql::Variable> in_scope = sparql::InScopeVariables(*query_->algebra);
  std::vector<std::string> bound;
  std::vector<TermId> values;
  for (const auto& [name, term] : binding) {
    const std::optional<TermId> id = dictionary_->Find(term);
    if (!id || std::find(in_scope.begin(), in_scope.end(), sparql::Variable{name}) == in_scope.end()) continue;
    bound.push_back(name);
    values.push_back(*id);
  }
  sparql::PreparedQuery* query = Prepared(std::move(bound));
  if (query == nullptr) return "";
  sparql::RunOptions run;
  run.version = &version;
  run.now_us = now_us;
  const auto triples = query->Construct(run, values);
  if (!triples.ok()) return "";
  std::string text;
  for (const TermQuad& triple : *triples) {
    absl::StrAppend(&text, ToNTriples(triple.subject), " ", ToNTriples(triple.predicate), " ",
                    ToNTriples(triple.object), " .\n");
  }
  return text;
}

}  // namespace docent
