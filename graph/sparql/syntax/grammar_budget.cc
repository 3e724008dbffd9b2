// What a text may have and keep: limits of its parts, memory, deadline and cancellation.
#include <algorithm>
#include <utility>

#include "graph/base/text.h"
#include "graph/sparql/syntax/grammar.h"

namespace docent::sparql {

bool Grammar::CountElement(const SourceSpan& span) {
  const size_t limit = options_.limits.query_elements;
  if (++elements_ <= limit) return !ended_;
  return PastLimit(span, Concat("more parts than the limit query_elements = ", std::to_string(limit)),
                   "use VALUES for long lists of alternatives");
}

bool Grammar::CountTriple(bool template_mode) {
  // A pattern is kept in an array that grows, a quad of an update in one of its own.
  Charge(template_mode ? sizeof(QuadTemplate) + kBytesOfChild : 2 * sizeof(TriplePattern) + kBytesOfChild);
  if (!template_mode && !CountPattern()) return false;
  if (++triples_ <= kFewTriples) return !ended_;
  const size_t limit = std::max(kFewTriples, options_.limits.update_text_bytes / kBytesOfTriple);
  if (triples_ <= limit) return !ended_;
  return PastLimit(Peek().span,
                   Concat("more than ", std::to_string(limit), " triples: one for each ",
                          std::to_string(kBytesOfTriple), " bytes of the limit update_text_bytes"),
                   "send several updates, or load a file");
}

bool Grammar::CountExpanded(const SourceSpan& span, size_t bytes) {
  Charge(bytes + kBytesOfAllocation);
  expanded_bytes_ += bytes;
  const size_t limit = options_.limits.update_text_bytes * kGrowth;
  if (expanded_bytes_ <= limit) return true;
  return PastLimit(span,
                   Concat("the IRIs of this text have more than ", std::to_string(limit),
                          " bytes, written out: ", std::to_string(kGrowth),
                          " for each byte of the limit update_text_bytes"),
                   "declare shorter prefixes, or send several updates");
}

bool Grammar::CountPathStep() {
  Charge(2 * sizeof(Path) + kBytesOfAllocation);
  const size_t limit = options_.query_limits.query_path_steps;
  if (++path_steps_ <= limit) return !ended_;
  return PastCount("steps in property paths", "query_path_steps", limit, "split the path");
}

bool Grammar::CountOperation() {
  constexpr size_t kBytesOfDeque = 640;  // without elements
  Charge(2 * sizeof(UpdateOperation) + 2 * kBytesOfDeque);
  const size_t limit = options_.query_limits.update_operations;
  if (++operations_ <= limit) return !ended_;
  return PastCount("operations", "update_operations", limit, "send several updates");
}

bool Grammar::PastPatterns() {
  return PastCount("patterns", "query_patterns", options_.query_limits.query_patterns, "split the query");
}

bool Grammar::PastListElements() {
  return PastCount("members of lists and arguments", "query_list_elements",
                   options_.query_limits.query_list_elements, "use VALUES for long lists");
}

bool Grammar::PastValues() {
  return PastCount("values in VALUES", "query_values", options_.query_limits.query_values,
                   "send the data in parts, or load them as a graph");
}

bool Grammar::PastCount(std::string_view what, std::string_view name, size_t limit, std::string hint) {
  return PastLimit(LastSpan(), Concat("more ", what, " than the limit ", name, " = ", std::to_string(limit)),
                   std::move(hint));
}

// Of what is past several limits, the first is told.
bool Grammar::PastLimit(const SourceSpan& span, std::string message, std::string hint) {
  if (ended_) return false;
  if (stopped_.ok()) stopped_ = absl::ResourceExhaustedError(message);
  Error(span, std::move(message), std::move(hint));
  ended_ = true;
  return false;
}

void Grammar::BeginCounts() {
  elements_ = patterns_ = path_steps_ = list_elements_ = values_ = 0;
}

SourceSpan Grammar::LastSpan() const {
  return ahead_[0].span.offset >= ahead_[1].span.offset ? ahead_[0].span : ahead_[1].span;
}

bool Grammar::Look() {
  const size_t kept = lexer_.kept_bytes();
  const size_t bytes = std::exchange(uncounted_, 0) + kept - std::exchange(kept_by_lexer_, kept);
  if (!memory_->Add(bytes)) {
    return Stop(memory_->Refusal(absl::ResourceExhaustedError(
        Concat("the text says more than fits into the limit query_memory_bytes = ",
               std::to_string(options_.limits.query_memory_bytes)))));
  }
  if (options_.cancellation == nullptr) return !ended_;
  absl::Status status = options_.cancellation->CheckNow();
  return status.ok() ? !ended_ : Stop(std::move(status));
}

bool Grammar::Stop(absl::Status status) {
  Error(LastSpan(), std::string(status.message()));
  if (stopped_.ok()) stopped_ = std::move(status);
  ended_ = true;
  return false;
}

}  // namespace docent::sparql
