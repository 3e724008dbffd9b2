#include "reasoner/rules/negation_order.h"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/container/inlined_vector.h"
#include "absl/strings/str_cat.h"
#include "reasoner/rules/stratification.h"

namespace docent {
namespace {

constexpr size_t kManyPatterns = 1000;  // from here on they forget their objects
constexpr size_t kItself = ~size_t{0};
constexpr uint32_t kNone = ~uint32_t{0};

// A pattern of a body, with what an instance puts into it.
struct Taker {
  uint32_t rule;
  uint32_t trigger;
  uint32_t instance;  // kNone: the rule as it is
  QuadPattern pattern;
  bool of_axioms;  // it is not a fact that the rule takes, but an axiom
};

// What a conclusion leads to, and through which rule.
struct Reached {
  QuadPattern pattern;
  size_t from = kItself;  // number of the one before; kItself: a conclusion of the rule itself
  uint32_t by = 0;
  uint32_t instance = kNone;  // of it
};

// A step of a way: a rule, and which of its instances.
struct Step {
  uint32_t rule;
  uint32_t instance;  // kNone: it has none
};

class Order {
 public:
  Order(const RuleProgram& program, const SchemaIndex& schema, const Dictionary& dictionary)
      : program_(program), schema_(schema), dictionary_(dictionary), place_(program.rules.size(), -1) {
    for (size_t i = 0; i < program.ordered.size(); ++i) place_[program.ordered[i]] = static_cast<int>(i);
    for (uint32_t r = 0; r < program.rules.size(); ++r) {
      if (program.IsEntangled(r)) AddTakers(r, kNone);
    }
    schema.ForEach([this](uint32_t id, const SchemaIndex::Instance& instance) {
      if (program_.IsEntangled(instance.rule)) AddTakers(instance.rule, id);
    });
  }

  absl::StatusOr<NegationOrder> Find() {
    for (size_t i = 0; i < program_.ordered.size(); ++i) Follow(static_cast<uint32_t>(i));
    if (!status_.ok()) return status_;
    const auto count = static_cast<uint32_t>(program_.ordered.size());
    const Stratification strata = Stratify(count, dependencies_);
    if (!strata.negative_cycle.empty()) return Refusal(strata.negative_cycle);
    std::vector<int> of_component(static_cast<size_t>(strata.count), 1);
    for (int component = 0; component < strata.count; ++component) {
      for (const RuleDependency& d : dependencies_) {
        if (strata.stratum[d.from] != component || strata.stratum[d.to] == component) continue;
        of_component[component] = std::max(of_component[component], of_component[strata.stratum[d.to]] + (d.negative ? 1 : 0));
      }
    }
    NegationOrder order;
    for (uint32_t i = 0; i < count; ++i) order.of_rules.push_back(of_component[strata.stratum[i]]);
    for (const auto& [pattern, number] : led_to_) {
      int& level = order.of_facts[pattern];
      level = std::max(level, order.of_rules[number]);
    }
    return order;
  }

 private:
  using Key = absl::InlinedVector<TermId, 8>;

  // Of a rule with a schema part: its axioms; its facts are taken by its instances.
  void AddTakers(uint32_t rule, uint32_t instance) {
    const CompiledRule& compiled = program_.rules[rule];
    const std::vector<Trigger>& triggers = compiled.body->triggers();
    for (uint32_t i = 0; i < triggers.size(); ++i) {
      const bool of_axioms = triggers[i].pattern >= 0 && (compiled.schema & (1u << triggers[i].pattern)) != 0;
      if (compiled.schema != 0 && of_axioms != (instance == kNone)) continue;
      QuadPattern pattern = triggers[i].match.constants;
      if (instance != kNone) {
        const std::vector<TermId>& row = schema_.instance(instance).row;
        pattern = compiled.body->Instantiate(triggers[i], row).constants;
        if (!IsOther(rule, i, pattern, row)) continue;
      }
      by_predicate_[pattern.predicate].push_back(takers_.size());
      takers_.push_back({rule, i, instance, pattern, of_axioms});
    }
  }

  // Of instances that differ in subjects alone, as those of two things that are the same as others, one is enough.
  bool IsOther(uint32_t rule, uint32_t trigger, const QuadPattern& pattern, const std::vector<TermId>& row) {
    Key key = {TermId(rule), TermId(trigger), pattern.predicate, pattern.object};
    for (const HeadTriple& head : program_.rules[rule].head) {
      for (const int i : {1, 2}) key.push_back(head.columns[i] == Trigger::kNoColumn ? TermId() : row[head.columns[i]]);
    }
    return instances_.insert(std::move(key)).second;
  }

  // All that the conclusions of a rule lead to.
  void Follow(uint32_t number) {
    reached_.clear();
    seen_.clear();
    const uint32_t rule = program_.ordered[number];
    const std::vector<TermId> nothing(program_.rules[rule].body->columns().size());
    Conclude(rule, kNone, nothing, kItself);
    for (size_t i = 0; i < reached_.size(); ++i) {
      const TermId predicate = reached_[i].pattern.predicate;
      if (predicate.IsNone()) {
        for (const Taker& taker : takers_) Take(number, taker, i);
        continue;
      }
      for (const TermId key : {predicate, TermId()}) {
        const auto found = by_predicate_.find(key);
        if (found == by_predicate_.end()) continue;
        for (const size_t taker : found->second) Take(number, takers_[taker], i);
      }
    }
    for (const Reached& each : reached_) led_to_.emplace_back(std::pair(each.pattern.predicate, each.pattern.object), number);
  }

  void Take(uint32_t number, const Taker& taker, size_t from) {
    const QuadPattern pattern = reached_[from].pattern;  // reached_ grows
    if (!CanUnify(taker.pattern, pattern)) return;  // pattern has no subject
    if (taker.of_axioms) return RefuseAxioms(number, taker.rule);
    const Body& body = *program_.rules[taker.rule].body;
    const Trigger& trigger = body.triggers()[taker.trigger];
    if (place_[taker.rule] >= 0) {
      const bool negative = trigger.polarity != Polarity::kPositive;
      if (known_.insert({static_cast<uint32_t>(place_[taker.rule]), number, negative}).second) {
        dependencies_.push_back({static_cast<uint32_t>(place_[taker.rule]), number, negative, true});
      }
      if (negative) ways_.try_emplace({static_cast<uint32_t>(place_[taker.rule]), number}, Way(from));
      if (trigger.polarity == Polarity::kNegative) return;
    }
    row_.assign(body.columns().size(), TermId());
    if (taker.instance != kNone) row_ = schema_.instance(taker.instance).row;
    const std::array<TermId, 3> terms = {pattern.subject, pattern.predicate, pattern.object};
    for (int i = 0; i < 3; ++i) {
      if (trigger.columns[i] != Trigger::kNoColumn && !terms[i].IsNone()) row_[trigger.columns[i]] = terms[i];
    }
    Conclude(taker.rule, taker.instance, row_, from);
  }

  // `from`: the pattern that a body takes.
  void Conclude(uint32_t rule, uint32_t instance, const std::vector<TermId>& row, size_t from) {
    for (const HeadTriple& head : program_.rules[rule].head) {
      const auto at = [&](int i) { return head.columns[i] == Trigger::kNoColumn ? head.constants[i] : row[head.columns[i]]; };
      QuadPattern made;
      made.predicate = at(1);
      if (reached_.size() < kManyPatterns) made.object = at(2);
      const bool known = seen_.contains({made.predicate, made.object}) || seen_.contains({made.predicate, TermId()}) ||
                         seen_.contains({TermId(), made.object}) || seen_.contains({TermId(), TermId()});
      if (known) continue;
      seen_.insert({made.predicate, made.object});
      reached_.push_back({made, from, rule, instance});
    }
  }

  // The rules on the way to a pattern, the first that is not the rule itself first.
  std::vector<Step> Way(size_t reached) const {
    std::vector<Step> way;
    for (; reached_[reached].from != kItself; reached = reached_[reached].from) {
      way.push_back({reached_[reached].by, reached_[reached].instance});
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

  void RefuseAxioms(uint32_t number, uint32_t rule) {
    if (!status_.ok()) return;
    status_ = absl::FailedPreconditionError(
        absl::StrCat(program_.rules[program_.ordered[number]].label, " negates or aggregates, and what it makes may be an axiom for ",
                     program_.rules[rule].label, ", on which the order of rules with negation depends; the batch was not applied"));
  }

  absl::Status Refusal(const std::vector<uint32_t>& cycle) const {
    std::string text = "negation through recursion, by the axioms that are there: ";
    for (size_t i = 0; i < cycle.size(); ++i) {
      const uint32_t next = cycle[(i + 1) % cycle.size()];
      absl::StrAppend(&text, i > 0 ? "; " : "", program_.rules[program_.ordered[cycle[i]]].label);
      const auto way = ways_.find({cycle[i], next});
      absl::StrAppend(&text, way == ways_.end() ? " needs what follows from " : " negates what follows from ",
                      next == cycle[i] ? "itself" : program_.rules[program_.ordered[next]].label);
      if (way == ways_.end()) continue;
      for (size_t k = 0; k < way->second.size(); ++k) {
        absl::StrAppend(&text, k == 0 ? " by " : ", ", program_.rules[way->second[k].rule].label, Axioms(way->second[k]));
      }
    }
    return absl::FailedPreconditionError(
        text + "; the batch was not applied. Take one of these axioms away, or let a rule negate something that does not follow from it");
  }

  // " (ex:Available rdfs:subClassOf ex:Broken)"
  std::string Axioms(const Step& step) const {
    if (step.instance == kNone) return "";
    const CompiledRule& rule = program_.rules[step.rule];
    std::string text;
    for (size_t i = 0; i < rule.body->patterns().size(); ++i) {
      if ((rule.schema & (1u << i)) == 0) continue;
      const Triple axiom = rule.Premise(i, schema_.instance(step.instance).row);
      absl::StrAppend(&text, text.empty() ? " (" : " . ", Shown(axiom.subject), " ", Shown(axiom.predicate), " ", Shown(axiom.object));
    }
    return text.empty() ? text : text + ")";
  }
  std::string Shown(TermId id) const { return ToDisplay(dictionary_.Decode(id)); }

  const RuleProgram& program_;
  const SchemaIndex& schema_;
  const Dictionary& dictionary_;
  std::vector<int> place_;  // of a rule in program_.ordered; -1: it is none of them
  std::vector<Taker> takers_;
  absl::flat_hash_set<Key> instances_;
  absl::flat_hash_map<TermId, std::vector<size_t>> by_predicate_;  // none: a variable
  std::vector<Reached> reached_;
  absl::flat_hash_set<std::pair<TermId, TermId>> seen_;  // predicate and object of reached_
  std::vector<TermId> row_;
  std::vector<RuleDependency> dependencies_;  // among program_.ordered
  absl::flat_hash_set<std::tuple<uint32_t, uint32_t, bool>> known_;
  std::vector<std::pair<std::pair<TermId, TermId>, uint32_t>> led_to_;  // patterns, by what (its number there)
  absl::Status status_;
  absl::flat_hash_map<std::pair<uint32_t, uint32_t>, std::vector<Step>> ways_;
};

}  // namespace

absl::StatusOr<NegationOrder> OrderNegation(const RuleProgram& program, const SchemaIndex& schema, const Dictionary& dictionary) {
  return Order(program, schema, dictionary).Find();
}

}  // namespace docent
