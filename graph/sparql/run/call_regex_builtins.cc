// REGEX and REPLACE (SPARQL 1.1 sections 17.4.3.14 and 17.4.3.15). Mistakes in a constant pattern are found
// when the query is parsed; with a wrong computed pattern the call is an error.
#include <algorithm>
#include <utility>
#include <vector>

#include "graph/sparql/regex/regex.h"
#include "graph/sparql/regex/regex_replacement.h"
#include "graph/sparql/run/expression_evaluator.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

class ContextGuard : public MatchGuard {
 public:
  explicit ContextGuard(EvaluationContext& context) : context_(context) {}
  bool Worked(size_t bytes) override { return context_.Worked(bytes); }
  bool Charge(size_t bytes) override { return context_.Charge(bytes); }
  void Release(size_t bytes) override { context_.Release(bytes); }

 private:
  EvaluationContext& context_;
};

// The compiled expression of this call, cached while pattern and flags stay the same; null if it has a
// mistake.
Regex* Prepared(PlanExpression& e, const Value& pattern, std::string_view flags, EvaluationContext& context) {
  constexpr size_t kBytesAnInstruction = 256;  // compiling one takes about as long as reading them
  std::string source(flags);
  source.push_back('/');
  source += pattern.text();
  if (source == e.regex_source) return e.regex.get();
  std::unique_ptr<Regex> made;
  Regex::Compile(pattern.text(), flags, e.builtin == Builtin::kReplace, &made);
  context.ReleasePlan(std::exchange(e.regex_bytes, (made ? made->bytes() : 0) + source.size()));
  if (!context.ChargePlan(e.regex_bytes)) made = nullptr;
  e.regex = std::move(made);
  e.regex_source = std::move(source);
  context.Worked(kBytesAnInstruction *
                 static_cast<size_t>(e.regex ? e.regex->size() : pattern.text().size()));
  return e.regex.get();
}

// As searches.Find; false, with the context's status set, if a limit ends it.
bool Find(Regex::Searches& searches, size_t at, absl::Span<std::string_view> groups,
          EvaluationContext& context) {
  const absl::StatusOr<bool> found = searches.Find(at, groups);
  if (found.ok()) return *found;
  if (context.status.ok()) context.status = found.status();
  return false;
}

// `text` with all matches replaced; no match is empty. nullopt, with the context's status set, if the
// evaluation has to end meanwhile or the result is too long.
std::optional<std::string> Replaced(std::string_view text, Regex& regex, const RegexReplacement& replacement,
                                    EvaluationContext& context) {
  constexpr size_t kBytesAMatch = 1024;  // a match without groups takes about as long as reading them
  const int highest = replacement.groups.empty()
                          ? 0
                          : *std::max_element(replacement.groups.begin(), replacement.groups.end());
  std::vector<std::string_view> groups(static_cast<size_t>(highest) + 1);
  std::string out;
  MemoryPart counted = context.PartOfMemory();
  // The caller has counted this much memory.
  size_t room = std::max<size_t>(4096, text.size() + text.size() / 2);
  const auto grow = [&](size_t bytes) {
    if (out.size() + bytes <= room) return true;
    room = (out.size() + bytes) * 5 / 4;
    if (!context.HasRoom(2 * room)) return false;
    const size_t old = counted.used();
    if (!counted.Add(room)) return context.HasRoom(0);
    out.reserve(room);
    counted.Release(old);
    return true;
  };
  ContextGuard guard(context);
  Regex::Searches searches(&regex, text, &guard);
  size_t at = 0;
  while (at < text.size() && Find(searches, at, absl::MakeSpan(groups), context)) {
    const auto begin = static_cast<size_t>(groups[0].data() - text.data());
    size_t bytes = begin - at + replacement.text_bytes;
    for (const int group : replacement.groups) bytes += groups[static_cast<size_t>(group)].size();
    // A match may have read all the rest of the text, and yet be short.
    if (!grow(bytes) || !context.Worked(kBytesAMatch + bytes + (text.size() - at) / 16)) return std::nullopt;
    out.append(text, at, begin - at);
    for (size_t i = 0; i < replacement.texts.size(); ++i) {
      out += replacement.texts[i];
      if (i < replacement.groups.size()) out += groups[static_cast<size_t>(replacement.groups[i])];
    }
    at = begin + groups[0].size();
  }
  if (!context.status.ok() || !grow(text.size() - at)) return std::nullopt;
  return out.append(text, at);
}

}  // namespace

Value CallRegexBuiltin(PlanExpression& e, const std::vector<Value>& a, EvaluationContext& context) {
  const size_t flags_at = e.builtin == Builtin::kRegex ? 2 : 3;
  if (!a[0].IsStringLike() || a[1].type() != Type::kString) return Value::Error();
  if (a.size() > flags_at && a[flags_at].type() != Type::kString) return Value::Error();
  const std::string_view flags = a.size() > flags_at ? a[flags_at].text() : std::string_view();
  Regex* regex = Prepared(e, a[1], flags, context);
  if (regex == nullptr) return Value::Error();
  // Charged for each call, so that no row runs far beyond a limit.
  if (!context.Worked(static_cast<size_t>(regex->size()))) return Value::Error();
  if (e.builtin == Builtin::kRegex) {
    ContextGuard guard(context);
    Regex::Searches searches(regex, a[0].text(), &guard);
    const bool found = Find(searches, 0, {}, context);
    return context.status.ok() ? Value::Boolean(found) : Value::Error();
  }
  if (a[2].type() != Type::kString) return Value::Error();
  if (regex->matches_empty_text()) return Value::Error();  // FORX0003
  RegexReplacement replacement;
  if (ReadReplacement(a[2].text(), regex->groups(), regex->literal(), &replacement)) return Value::Error();
  std::optional<std::string> out = Replaced(a[0].text(), *regex, replacement, context);
  if (!out) return Value::Error();
  if (a[0].type() == Type::kLangString)
    return Value::LangString(*std::move(out), std::string(a[0].language()));
  return Value::String(*std::move(out));
}

}  // namespace docent::sparql
