// Why a condition did not hold, for people: which of its facts lack, and which are in its way. Each constraint is asked alone, so
// that what a condition of several needs together is said as well.
#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "workflow/cawl/formula.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

// What is told of one alternative at most.
constexpr size_t kLacksShown = 5;

std::vector<cawl::Formula> AlternativesOf(const cawl::Condition& condition) {
  if (condition.expression) return {FormulaOf(condition)};
  std::vector<cawl::Formula> alternatives;
  for (const cawl::Context& context : condition.contexts) alternatives.push_back(FormulaOf(context));
  for (const cawl::Case& event_case : condition.cases) alternatives.push_back(FormulaOf(event_case));
  return alternatives;
}

class LackFinder {
 public:
  using Holds = std::function<bool(const cawl::Constraint&)>;
  using Show = std::function<std::string(const cawl::Constraint&)>;

  LackFinder(Holds holds, Show show) : holds_(std::move(holds)), show_(std::move(show)) {}

  // What keeps the formula from being so (`wanted`) or from not being so; none: nothing that can be told of one constraint.
  std::vector<std::string> Of(const cawl::Formula& formula, bool wanted) const {
    using Kind = cawl::Formula::Kind;
    switch (formula.kind) {
      case Kind::kConstraint:
        if (holds_(*formula.constraint) == wanted) return {};
        return {wanted ? Concat("it lacks ", show_(*formula.constraint))
                       : Concat("in its way is ", show_(*formula.constraint))};
      case Kind::kEvent:
        if (!wanted) return {};
        return {Concat("it lacks the event ", formula.event->operation.value)};
      case Kind::kNot:
        return Of(formula.children.at(0), !wanted);
      case Kind::kAnd:
      case Kind::kOr:
        break;
    }
    const bool needs_all = (formula.kind == Kind::kAnd) == wanted;
    std::vector<std::string> lacks;
    for (const cawl::Formula& child : formula.children) {
      std::vector<std::string> more = Of(child, wanted);
      if (!needs_all && more.empty()) return {};
      for (std::string& lack : more) {
        if (std::find(lacks.begin(), lacks.end(), lack) == lacks.end()) lacks.push_back(std::move(lack));
      }
    }
    if (needs_all || lacks.size() < 2) return lacks;
    return {absl::StrJoin(lacks, ", or ")};
  }

 private:
  const Holds holds_;
  const Show show_;
};

}  // namespace

std::string RunStepper::Lacks(const cawl::Condition& condition) const {
  if (core_.input->facts == nullptr) return "";
  const auto value = [this](const std::string& name) { return Value(name, nullptr); };
  const auto holds = [&](const cawl::Constraint& constraint) {
    auto ask = cawl::CompileConstraint(*run_.document, constraint, value, core_.limits);
    if (!ask.ok() || !cawl::ParseAsks(core_.limits, &*ask).ok()) return false;
    return core_.input->facts->Holds(*ask->query).value_or(false);
  };
  const auto show = [&](const cawl::Constraint& constraint) {
    std::vector<std::string> words;
    for (const cawl::Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
      const bool variable =
          word->kind == cawl::Word::Kind::kVariable && word->comparison == cawl::Word::Comparison::kNone;
      const std::optional<Term> now = variable ? Value(word->name, nullptr) : std::nullopt;
      words.push_back(now ? ToDisplay(*now) : word->text.value);
    }
    return absl::StrJoin(words, " ");
  };
  const LackFinder finder(holds, show);
  std::vector<std::string> all;
  for (const cawl::Formula& alternative : AlternativesOf(condition)) {
    std::vector<std::string> lacks = finder.Of(alternative, true);
    if (lacks.empty()) lacks = {"each of its facts is there, but not together, or not for long enough"};
    if (lacks.size() > kLacksShown) {
      const size_t more = lacks.size() - kLacksShown;
      lacks.resize(kLacksShown);
      lacks.push_back(absl::StrCat(more, " more"));
    }
    std::string text = absl::StrJoin(lacks, ", ");
    if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(std::move(text));
  }
  return all.empty() ? "" : absl::StrCat(": ", absl::StrJoin(all, "; or "));
}

}  // namespace docent::engine
