#include "workflow/cawl/lasting_rules.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/structure_checks.h"

namespace docent::cawl {
namespace {

// Empty for a word that is no variable.
std::string VariableName(const Word& word) {
  if (word.kind != Word::Kind::kFree && word.kind != Word::Kind::kVariable) return "";
  std::string name = word.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

std::array<const Word*, 3> WordsOf(const Constraint& constraint) {
  return {&constraint.subject, &constraint.verb, &constraint.object};
}

bool Mentions(const Rule& rule, const std::string& name) {
  return std::any_of(rule.constraints.begin(), rule.constraints.end(), [&](const Constraint& constraint) {
    const auto words = WordsOf(constraint);
    return std::any_of(words.begin(), words.end(),
                       [&](const Word* word) { return VariableName(*word) == name; });
  });
}

class LastingChecker {
 public:
  explicit LastingChecker(xml::ElementReader* reader) : reader_(*reader) {}

  // `no_values`: no variable has a value when the condition is armed (an activator's), so that $x is like ?x.
  void Check(const Condition& condition, bool no_values) {
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        if (!rule.at_least_ms) continue;
        if (condition.expression) {
          reader_.Error(rule.for_text.span, "a rule with for stands in a condition with an expression",
                        "leave the expression out (contexts are alternatives) and put what must hold "
                        "together into one context");
        }
        CheckShared(context, rule, no_values);
      }
    }
  }

 private:
  void CheckShared(const Context& context, const Rule& rule, bool no_values) {
    const std::set<std::string> bound = CertainVariables(rule);
    std::set<std::string> told;
    for (const Constraint& constraint : rule.constraints) {
      for (const Word* word : WordsOf(constraint)) {
        if (word->kind == Word::Kind::kVariable && !no_values) continue;
        const std::string name = VariableName(*word);
        if (name.empty() || bound.contains(name)) continue;
        const bool shared = std::any_of(context.rules.begin(), context.rules.end(), [&](const Rule& other) {
          return &other != &rule && Mentions(other, name);
        });
        if (!shared || !told.insert(name).second) continue;
        reader_.Error(
            word->span,
            Concat("a rule with for does not bind ?", name, " itself, and another rule has it, too"),
            Concat("repeat in this rule a constraint that binds ?", name, ", outside of not"));
      }
    }
  }

  xml::ElementReader& reader_;
};

}  // namespace

std::set<std::string> CertainVariables(const Rule& rule) {
  const absl::StatusOr<std::vector<Conjunction>> alternatives = ToAlternatives(FormulaOf(rule));
  if (!alternatives.ok()) return {};
  std::set<std::string> certain;
  for (size_t i = 0; i < alternatives->size(); ++i) {
    std::set<std::string> here;
    for (const Constraint* constraint : (*alternatives)[i].constraints) {
      for (const Word* word : WordsOf(*constraint)) {
        if (word->comparison == Word::Comparison::kNone) here.insert(VariableName(*word));
      }
    }
    here.erase("");
    std::set<std::string> both;
    std::set_intersection(certain.begin(), certain.end(), here.begin(), here.end(),
                          std::inserter(both, both.end()));
    certain = i == 0 ? std::move(here) : std::move(both);
  }
  return certain;
}

void CheckLastingRules(const Document& document, xml::ElementReader* reader) {
  LastingChecker checker(reader);
  if (document.activator) checker.Check(document.activator->condition, /*no_values=*/true);
  for (const Flow& flow : document.flows) {
    for (const Node& node : flow.nodes) {
      if (node.condition) checker.Check(*node.condition, /*no_values=*/false);
    }
  }
}

}  // namespace docent::cawl
