#include "graph/sparql/plan/evaluation_context.h"

#include <utility>

#include "graph/sparql/syntax/algebra_memory.h"
#include "graph/store/read_trace.h"

namespace docent::sparql {

bool EvaluationContext::PollNow() {
  if (status.ok() && cancellation != nullptr) {
    cancellation->Spend(TakeSteps());
    status = cancellation->CheckNow();
  }
  polls_left_ = polls_given_ = status.ok() ? kPolls : 1;
  return status.ok();
}

bool EvaluationContext::WorkedNow() {
  PollNow();
  work_bytes_ = status.ok() ? 0 : kBytesAPoll;  // after the end, every call returns false
  return status.ok();
}

bool EvaluationContext::Refuse(size_t more) {
  polls_left_ = 1;  // so the next Poll reports it
  if (status.ok()) {
    status =
        use_->Refusal(absl::ResourceExhaustedError("evaluation stopped at its limit query_memory_bytes = " +
                                                   std::to_string(memory_limit_)),
                      more);
  }
  return false;
}

TermId EvaluationContext::Encode(const Term& term) {
  if (term.IsLiteral()) {
    if (const std::optional<TermId> id = InlineLiteral(term)) return *id;
  }
  const std::optional<TermId> id = FindTerm(term);
  return id ? *id : AddLocal(term);
}

TermId EvaluationContext::EncodeComputed(const Value& value) {
  if (!value.IsExact() || !value.text().empty()) {
    if (value.text().size() > kLongText && !HasRoom(value.text().size())) return TermId();
    Term term = value.ToTerm();
    if (term.IsLiteral()) {
      if (const std::optional<TermId> id = InlineLiteral(term)) return *id;
    }
    const std::optional<TermId> id = FindTerm(term);
    return id ? *id : AddLocal(std::move(term));
  }
  const Decimal number = Normalised(value.decimal());
  const int64_t mantissa = static_cast<int64_t>(number.mantissa);
  std::optional<TermId> id;
  if (mantissa == number.mantissa) {
    id = value.type() == Value::Type::kInteger ? InlineIntegerId(mantissa)
                                               : InlineDecimalId({mantissa, number.scale});
  }
  if (id) return *id;
  Term term = value.ToTerm();
  id = FindTerm(term);
  return id ? *id : AddLocal(std::move(term));
}

std::optional<TermId> EvaluationContext::FindTerm(const Term& term) {
  Worked(term.lexical.size());
  // The local table comes first: a term that the dictionary learns during this run is in no version that the
  // run sees, and must keep its local id.
  if (!local_terms_.empty()) {
    const auto it = local_ids_.find(term);
    if (it != local_ids_.end()) return TermId::Make(TermId::Tag::kLocal, *it);
  }
  return dictionary.Find(term);
}

TermId EvaluationContext::AddLocal(Term term) {
  Charge(2 * sizeof(Term) + TextMemory(term) +
         3 * sizeof(uint32_t));  // in an array that grows, and in a table
  const auto number = static_cast<uint32_t>(local_terms_.size());
  local_terms_.push_back(std::move(term));
  local_ids_.insert(number);
  return TermId::Make(TermId::Tag::kLocal, number);
}

void EvaluationContext::DecodeLocalTo(TermId id, Term* out) const {
  *out = id.payload() < local_terms_.size() ? local_terms_[id.payload()] : Term{};
}

Value EvaluationContext::ValueOf(TermId id) const {
  if (id.tag() != TermId::Tag::kLocal) return Value::OfId(id, dictionary);
  if (id.payload() >= local_terms_.size()) return Value::Error();
  Value value = Value::OfTerm(local_terms_[id.payload()]);
  value.set_id(id);
  return value;
}

std::string_view EvaluationContext::LexicalOf(const Value& value, std::string* scratch) const {
  const TermId id = value.id();
  if (id.InDictionary()) return dictionary.Lexical(id);
  if (id.tag() == TermId::Tag::kLocal) return local_terms_[id.payload()].lexical;
  if (id.IsNone() && !value.text().empty()) return value.text();
  InlineBuffer buffer;
  *scratch = id.IsNone() ? value.CanonicalText() : std::string(WriteInlineText(id, &buffer));
  return *scratch;
}

uint64_t EvaluationContext::Random() {
  ReadTrace::NoteAnything();
  uint64_t z = (random_ += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace docent::sparql
