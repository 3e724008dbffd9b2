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
#include "reasoner/rules/schema_words.h"
#include "reasoner/rules/stratification.h"

namespace docent::rules {
namespace {

constexpr size_t kManyPatterns = 1000;  // beyond this number patterns drop their objects
constexpr size_t kManyAxioms = 4000;    // beyond this number those of axioms drop subject and object, too
constexpr size_t kManyAnswers = 100;    // more answers are treated as "any"
constexpr size_t kItself = ~size_t{0};
constexpr uint32_t kNone = ~uint32_t{0};
constexpr uint32_t kFirstEqual = uint32_t{1} << 31;  // numbers from here on are pairs of equal things

// A pattern of a body, with the values of an instance: it takes matching facts.
struct Taker {
  uint32_t rule;
  uint32_t trigger;
  uint32_t instance;  // kNone: the rule itself
  QuadPattern pattern;
  bool of_axioms;      // it matches an axiom, not a fact
  bool names_reports;  // so it also takes late ones (RuleProgram::IsLate)
};

// A pattern reached from a conclusion, and the rule that led to it.
struct Reached {
  FactPattern pattern;
  size_t from = kItself;  // index of the pattern before; kItself: a conclusion of the rule itself
  uint32_t by = 0;
  uint32_t instance = kNone;  // of it
  bool late = false;          // a report of a late check (RuleProgram::IsLate)
};

// A step of a path: a rule, and its instance.
struct Step {
  uint32_t rule;
  uint32_t instance;  // kNone: it has none
};

// The patterns that one rule of program.ordered leads to.
struct Following {
  std::vector<Reached> reached;
  absl::flat_hash_set<FactPattern> seen;  // patterns of reached
  absl::flat_hash_set<FactPattern> seen_late;
  size_t next = 0;  // of reached: the first that is not followed yet
};

// An application of a rule to a pattern.
struct Taking {
  uint32_t number;        // of the Following
  size_t from = kItself;  // index of the pattern in reached
  uint32_t rule = 0;
  uint32_t instance = kNone;
  std::vector<TermId> row;        // of its body; kNone: unknown
  std::vector<bool> of_instance;  // columns that only the instance binds
  std::array<int16_t, 2> same = {matching::Trigger::kNoColumn,
                                 matching::Trigger::kNoColumn};  // two columns with equal unknown values

  bool IsOfInstance(int16_t column) const { return instance != kNone && of_instance[column]; }
};

// A premise of an application whose subject or object is unknown: which values does it have in the existing
// axioms?
struct Question {
  Taking taking;
  FactPattern about;
  int side = 0;                                   // the unknown position: 0: subject, 2: object
  int16_t column = matching::Trigger::kNoColumn;  // its column
  std::array<size_t, 2> next = {0, 0};            // of all reached patterns, by its predicate and by any
};

// A term of a triple of a body: its value, or the column that would give it.
struct Place {
  TermId term;
  int16_t column = matching::Trigger::kNoColumn;
  friend bool operator==(const Place&, const Place&) = default;
};
using Places = std::array<Place, 3>;

// The values of the unknown subject or object of `about`, up to kManyAnswers + 1.
std::vector<TermId> Answers(const GraphVersion& graph, const FactPattern& about) {
  std::vector<TermId> answers;
  for (QuadCursor c = graph.Scan({about.subject, about.predicate, about.object, TermId()});
       c.Valid() && answers.size() <= kManyAnswers; c.Next()) {
    const TermId answer = about.object.IsNone() ? c.quad().object : c.quad().subject;
    if (std::find(answers.begin(), answers.end(), answer) == answers.end()) answers.push_back(answer);
  }
  return answers;
}

void AddNew(const std::vector<TermId>& from, std::vector<TermId>& to) {
  for (const TermId id : from) {
    if (std::find(to.begin(), to.end(), id) == to.end()) to.push_back(id);
  }
}

class Order {
 public:
  Order(const RuleProgram& program, const SchemaIndex& schema, const EqualityClasses& classes,
        const GraphVersion& graph, const Dictionary& dictionary, const AxiomAnswers& before, AskAxioms ask,
        bool late_reports)
      : program_(program),
        schema_(schema),
        graph_(graph),
        dictionary_(dictionary),
        before_(before),
        ask_(ask),
        late_reports_(late_reports),
        place_(program.rules.size(), -1),
        followings_(program.ordered.size()) {
    for (size_t i = 0; i < program.ordered.size(); ++i) place_[program.ordered[i]] = static_cast<int>(i);
    for (uint32_t r = 0; r < program.rules.size(); ++r) {
      if (program.IsEntangled(r)) AddTakers(r, kNone);
    }
    schema.ForEach([this](uint32_t id, const SchemaIndex::Instance& instance) {
      if (!program_.IsEntangled(instance.rule) ||
          MakesNothingNew({.number = 0, .rule = instance.rule, .row = instance.row}))
        return;
      AddTakers(instance.rule, id);
    });
    if (program.equality.by_classes) AddEquals(classes);
  }

  absl::StatusOr<NegationOrder> Find() {
    for (uint32_t i = 0; i < program_.ordered.size(); ++i) {
      const uint32_t rule = program_.ordered[i];
      Conclude({.number = i,
                .rule = rule,
                .row = std::vector<TermId>(program_.rules[rule].body->columns().size())});
      Follow(i);
    }
    while (status_.ok() && AnswerByReached()) {
    }
    if (!status_.ok()) return status_;
    const auto count = static_cast<uint32_t>(program_.ordered.size());
    const Stratification strata = Stratify(count, dependencies_);
    if (!strata.negative_cycle.empty()) return Refusal(strata.negative_cycle);
    std::vector<int> of_component(static_cast<size_t>(strata.count), 1);
    for (int component = 0; component < strata.count; ++component) {
      for (const RuleDependency& d : dependencies_) {
        if (strata.stratum[d.from] != component || strata.stratum[d.to] == component) continue;
        of_component[component] =
            std::max(of_component[component], of_component[strata.stratum[d.to]] + (d.negative ? 1 : 0));
      }
    }
    NegationOrder order;
    for (uint32_t i = 0; i < count; ++i) order.of_rules.push_back(of_component[strata.stratum[i]]);
    for (uint32_t i = 0; i < count; ++i) {
      for (const Reached& each : followings_[i].reached) {
        if (each.late) continue;
        int& level = order.of_facts[each.pattern];
        level = std::max(level, order.of_rules[i]);
        if (each.pattern.KnowsSubject()) order.with_subjects.insert(each.pattern.predicate);
      }
    }
    order.late_reports = late_reports_;
    order.asked = std::move(answers_);
    return order;
  }

 private:
  using Key = absl::InlinedVector<TermId, 8>;

  // The rules of equality have no instances in the index. Pairs from and to the representative are enough:
  // every path between two names leads over it.
  void AddEquals(const EqualityClasses& classes) {
    for (uint32_t r = 0; r < program_.rules.size(); ++r) {
      if (!program_.rules[r].of_equality || program_.rules[r].schema == 0 || !program_.IsEntangled(r))
        continue;
      classes.ForEach([&](const EqualityClasses::Class& each) {
        const TermId first = each.representative();
        for (const std::vector<TermId>* names : {&each.members, &each.literals}) {
          for (const TermId name : *names) {
            if (name == first) continue;
            AddEqual(r, first, name);
            if (!name.IsLiteral()) AddEqual(r, name, first);
          }
        }
      });
    }
  }
  void AddEqual(uint32_t rule, TermId subject, TermId object) {
    const CompiledRule& compiled = program_.rules[rule];
    const auto pair = static_cast<size_t>(__builtin_ctz(compiled.schema));
    const auto& columns = compiled.body->patterns()[pair].columns;
    std::vector<TermId> row(compiled.body->columns().size());
    row[static_cast<size_t>(columns[0])] = subject;
    row[static_cast<size_t>(columns[2])] = object;
    equals_.push_back({.rule = rule, .row = std::move(row), .triggers = {}, .heads = {}});
    AddTakers(rule, kFirstEqual + static_cast<uint32_t>(equals_.size()) - 1);
  }
  const SchemaIndex::Instance& InstanceOf(uint32_t id) const {
    return id < kFirstEqual ? schema_.instance(id) : equals_[id - kFirstEqual];
  }

  // For a rule with a schema part: takers for its axioms; its instances take its facts.
  void AddTakers(uint32_t rule, uint32_t instance) {
    const CompiledRule& compiled = program_.rules[rule];
    const std::vector<matching::Trigger>& triggers = compiled.body->triggers();
    for (uint32_t i = 0; i < triggers.size(); ++i) {
      const bool of_axioms = triggers[i].pattern >= 0 && (compiled.schema & (1u << triggers[i].pattern)) != 0;
      if (compiled.schema != 0 && of_axioms != (instance == kNone)) continue;
      QuadPattern pattern = triggers[i].match.constants;
      if (instance != kNone) {
        const std::vector<TermId>& row = InstanceOf(instance).row;
        pattern = compiled.body->Instantiate(triggers[i], row).constants;
        if (!IsOther(rule, i, pattern, row)) continue;
        pattern.subject = TermId();  // one of many subjects
      }
      by_predicate_[pattern.predicate].push_back(takers_.size());
      takers_.push_back({rule, i, instance, pattern, of_axioms,
                         program_.report_words.AreNamedBy(pattern) && (instance == kNone || !late_reports_)});
    }
  }

  // False for an instance that differs from an earlier one in subjects only: one of them is enough.
  bool IsOther(uint32_t rule, uint32_t trigger, const QuadPattern& pattern, const std::vector<TermId>& row) {
    Key key = {TermId(rule), TermId(trigger), pattern.predicate, pattern.object};
    for (const HeadTriple& head : program_.rules[rule].conclusions()) {
      for (const int i : {1, 2})
        key.push_back(head.columns[i] == matching::Trigger::kNoColumn ? TermId() : row[head.columns[i]]);
    }
    return instances_.insert(std::move(key)).second;
  }

  // Follows the conclusions of a rule, from where it stopped.
  void Follow(uint32_t number) {
    Following& following = followings_[number];
    for (; following.next < following.reached.size() && status_.ok(); ++following.next) {
      const size_t from = following.next;
      const TermId predicate = following.reached[from].pattern.predicate;
      if (predicate.IsNone()) {
        for (const Taker& taker : takers_) Take(number, taker, from);
        continue;
      }
      for (const TermId key : {predicate, TermId()}) {
        const auto found = by_predicate_.find(key);
        if (found == by_predicate_.end()) continue;
        for (const size_t taker : found->second) Take(number, takers_[taker], from);
      }
    }
  }

  // The terms that `taker` binds when it takes `pattern`; false: it takes no fact of the pattern.
  static bool Unify(const QuadPattern& taker, const FactPattern& pattern, std::array<TermId, 3>& terms) {
    if (!CanUnify(taker, {pattern.subject, pattern.predicate, pattern.object, TermId()})) return false;
    terms = {pattern.subject, pattern.predicate, pattern.object};
    if (!pattern.reflexive) return true;
    for (const TermId known : {taker.subject, taker.object}) {
      if (known.IsNone()) continue;
      if (!terms[0].IsNone() && terms[0] != known) return false;
      terms[0] = terms[2] = known;
    }
    return true;
  }

  void Take(uint32_t number, const Taker& taker, size_t from) {
    const FactPattern pattern = followings_[number].reached[from].pattern;  // a copy: reached grows
    if (followings_[number].reached[from].late && !taker.names_reports) return;
    std::array<TermId, 3> terms;
    if (!Unify(taker.pattern, pattern, terms)) return;
    const CompiledRule& rule = program_.rules[taker.rule];
    const matching::Trigger& trigger = rule.body->triggers()[taker.trigger];
    if (place_[taker.rule] >= 0) {
      const bool negative = trigger.polarity != matching::Polarity::kPositive;
      if (known_.insert({static_cast<uint32_t>(place_[taker.rule]), number, negative}).second) {
        dependencies_.push_back({static_cast<uint32_t>(place_[taker.rule]), number, negative, true});
      }
      if (negative) ways_.try_emplace({static_cast<uint32_t>(place_[taker.rule]), number}, Way(number, from));
      if (trigger.polarity == matching::Polarity::kNegative) return;
    }
    Taking taking{.number = number,
                  .from = from,
                  .rule = taker.rule,
                  .instance = taker.instance,
                  .row = {},
                  .of_instance = {}};
    if (taker.instance != kNone) {
      taking.row = InstanceOf(taker.instance).row;
      for (const TermId known : taking.row) taking.of_instance.push_back(!known.IsNone());
    }
    taking.row.resize(rule.body->columns().size());
    taking.of_instance.resize(taking.row.size());
    for (int i = 0; i < 3; ++i) {
      if (trigger.columns[i] == matching::Trigger::kNoColumn || terms[i].IsNone()) continue;
      taking.row[trigger.columns[i]] = terms[i];
      taking.of_instance[trigger.columns[i]] = false;
    }
    if (rule.positive && pattern.reflexive && terms[0].IsNone())
      taking.same = {trigger.columns[0], trigger.columns[2]};
    if (taker.instance == kNone && rule.positive) {
      if (MakesNothingNew(taking) || IsFilteredOut(taking)) return;
      if (taker.of_axioms) return RefuseAxioms(number, taker.rule);
      if (rule.of_schema && ask_ == AskAxioms::kGraph && Ask(taking, trigger.pattern)) return;
    }
    Conclude(taking);
  }

  // ---- the triples of a body and of its head, as far as an application binds them

  static Place At(const Taking& taking, TermId constant, int16_t column) {
    if (column == matching::Trigger::kNoColumn) return {constant};
    if (!taking.row[column].IsNone()) return {taking.row[column]};
    return {TermId(), column == taking.same[1] && taking.same[0] != matching::Trigger::kNoColumn
                          ? taking.same[0]
                          : column};
  }
  template <typename Pattern>  // HeadTriple, Body::Pattern
  static Places PlacesOf(const Taking& taking, const Pattern& pattern) {
    return {At(taking, pattern.constants[0], pattern.columns[0]),
            At(taking, pattern.constants[1], pattern.columns[1]),
            At(taking, pattern.constants[2], pattern.columns[2])};
  }

  // A head triple that equals a premise exists already.
  bool IsPremise(const Taking& taking, const Places& made) const {
    const CompiledRule& rule = program_.rules[taking.rule];
    if (!rule.positive) return false;
    const std::vector<matching::Body::Pattern>& patterns = rule.body->patterns();
    return std::any_of(patterns.begin(), patterns.end(),
                       [&](const matching::Body::Pattern& p) { return PlacesOf(taking, p) == made; });
  }
  bool MakesNothingNew(const Taking& taking) const {
    const std::vector<HeadTriple>& head = program_.rules[taking.rule].conclusions();
    return std::all_of(head.begin(), head.end(),
                       [&](const HeadTriple& h) { return IsPremise(taking, PlacesOf(taking, h)); });
  }

  // True if a FILTER rejects the known terms. (The filter depends on the terms only.)
  bool IsFilteredOut(const Taking& taking) const {
    const CompiledRule& rule = program_.rules[taking.rule];
    if (!rule.body->has_filters()) return false;
    bool passes = false;
    const absl::Status status =
        rule.body->EvaluateRest({.version = &graph_}, taking.row, rule.patterns,
                                matching::Body::Filters::kBound, [&](absl::Span<const TermId>) {
                                  passes = true;
                                  return false;
                                });
    return status.ok() && !passes;
  }

  // ---- rules about axioms only: their result for one axiom depends on other existing axioms

  // True if another premise could be queried; its answers give conclusions. `taken`: the pattern already
  // matched.
  bool Ask(const Taking& taking, int taken) {
    const CompiledRule& rule = program_.rules[taking.rule];
    for (int i = 0; i < static_cast<int>(rule.body->patterns().size()); ++i) {
      const Places premise = PlacesOf(taking, rule.body->patterns()[static_cast<size_t>(i)]);
      const int side = premise[2].term.IsNone() ? 2 : 0;
      const int16_t column = premise[side].column;
      if (i == taken || premise[2 - side].term.IsNone() || premise[1].term.IsNone() ||
          column == matching::Trigger::kNoColumn)
        continue;
      if (column == taking.same[0] || !IsMade(rule, column)) continue;
      Question question{taking, {premise[0].term, premise[1].term, premise[2].term}, side, column};
      const auto [answers, is_new] = answers_.try_emplace(question.about);
      if (is_new) {
        answers->second = Answers(graph_, question.about);
        const auto earlier = before_.find(question.about);
        if (earlier != before_.end()) AddNew(earlier->second, answers->second);
      }
      if (answers->second.size() > kManyAnswers) continue;
      for (const TermId each : answers->second) ConcludeWith(question, each);
      questions_.push_back(std::move(question));
      return true;
    }
    return false;
  }
  static bool IsMade(const CompiledRule& rule, int16_t column) {
    return std::any_of(rule.head.begin(), rule.head.end(), [&](const HeadTriple& head) {
      return std::find(head.columns.begin(), head.columns.end(), column) != head.columns.end();
    });
  }

  // `answer`: kNone: any.
  void ConcludeWith(const Question& question, TermId answer) {
    Taking taking = question.taking;
    taking.row[question.column] = answer;
    if (!MakesNothingNew(taking) && !IsFilteredOut(taking)) Conclude(taking);
  }

  // Rules with negation may make axioms that do not exist yet. True if one was not examined before.
  bool AnswerByReached() {
    bool any = false;
    for (size_t q = 0; q < questions_.size(); ++q) {
      for (const size_t k : {0, 1}) {
        const TermId key = k == 0 ? questions_[q].about.predicate : TermId();
        while (questions_[q].next[k] < all_reached_[key].size() && status_.ok()) {
          any = true;
          const FactPattern pattern = all_reached_[key][questions_[q].next[k]++];
          const FactPattern& about = questions_[q].about;
          std::array<TermId, 3> terms;
          if (!Unify({about.subject, about.predicate, about.object, TermId()}, pattern, terms)) continue;
          const Question question = questions_[q];  // a copy: questions_ grows
          ConcludeWith(question, terms[static_cast<size_t>(question.side)]);
          Follow(question.taking.number);
        }
      }
    }
    return any;
  }

  // ---- conclusions

  void Conclude(const Taking& taking) {
    Following& following = followings_[taking.number];
    const CompiledRule& rule = program_.rules[taking.rule];
    const bool late = rule.check && (rule.negates_itself || late_reports_);
    for (const HeadTriple& head : rule.conclusions()) {
      Places places = PlacesOf(taking, head);
      if (taking.instance == kNone && IsPremise(taking, places)) continue;
      // The subject of an instance may differ in a similar instance.
      if (head.columns[0] != matching::Trigger::kNoColumn && head.columns[0] != head.columns[2] &&
          taking.IsOfInstance(head.columns[0]))
        places[0] = {};
      const TermId predicate = places[1].term, object = places[2].term;
      FactPattern made{TermId(), predicate, object};
      if (IsOfAxioms(predicate, object)) {
        made.reflexive = !rule.check && places[0] == places[2];
        made.subject = places[0].term;
        if (following.reached.size() >= kManyAxioms) made.subject = made.object = TermId();
      } else if (following.reached.size() >= kManyPatterns) {
        made.object = TermId();
      }
      if (AnyWider(made, true, [&](const FactPattern& wider) { return following.seen.contains(wider); }))
        continue;
      if (!(late ? following.seen_late : following.seen).insert(made).second) continue;
      following.reached.push_back({made, taking.from, taking.rule, taking.instance, late});
      if (!late && all_seen_.insert(made).second) all_reached_[made.predicate].push_back(made);
    }
  }

  // For axioms a pattern keeps its subject.
  bool IsOfAxioms(TermId predicate, TermId object) {
    if (predicate.IsNone()) return false;
    const auto [known, is_new] = of_axioms_.try_emplace(std::pair(predicate, object));
    const auto text = [&](TermId id) { return id.IsIri() ? dictionary_.Lexical(id) : std::string_view(); };
    if (is_new) known->second = IsSchemaPattern(text(predicate), text(object));
    return known->second;
  }

  // The rules on the path to a pattern, beginning with the first other rule.
  std::vector<Step> Way(uint32_t number, size_t at) const {
    const std::vector<Reached>& reached = followings_[number].reached;
    std::vector<Step> way;
    for (; reached[at].from != kItself; at = reached[at].from)
      way.push_back({reached[at].by, reached[at].instance});
    std::reverse(way.begin(), way.end());
    return way;
  }

  void RefuseAxioms(uint32_t number, uint32_t rule) {
    if (!status_.ok()) return;
    status_ = absl::FailedPreconditionError(
        absl::StrCat(program_.rules[program_.ordered[number]].label,
                     " negates or aggregates, and its results may be axioms for ", program_.rules[rule].label,
                     ", on which the order of rules with negation depends; the batch was not applied"));
  }

  absl::Status Refusal(const std::vector<uint32_t>& cycle) const {
    std::string text = "negation through recursion, by the existing axioms: ";
    for (size_t i = 0; i < cycle.size(); ++i) {
      const uint32_t next = cycle[(i + 1) % cycle.size()];
      absl::StrAppend(&text, i > 0 ? "; " : "", program_.rules[program_.ordered[cycle[i]]].label);
      const auto way = ways_.find({cycle[i], next});
      absl::StrAppend(&text, way == ways_.end() ? " needs consequences of " : " negates consequences of ",
                      next == cycle[i] ? "itself" : program_.rules[program_.ordered[next]].label);
      if (way == ways_.end()) continue;
      for (size_t k = 0; k < way->second.size(); ++k) {
        absl::StrAppend(&text, k == 0 ? " by " : ", ", program_.rules[way->second[k].rule].label,
                        Axioms(way->second[k]));
      }
    }
    return absl::FailedPreconditionError(text +
                                         "; the batch was not applied. Take one of these axioms away, or let "
                                         "a rule negate something that does not follow from it");
  }

  // " (ex:Available rdfs:subClassOf ex:Broken)"
  std::string Axioms(const Step& step) const {
    if (step.instance == kNone) return "";
    const CompiledRule& rule = program_.rules[step.rule];
    std::string text;
    for (size_t i = 0; i < rule.body->patterns().size(); ++i) {
      if ((rule.schema & (1u << i)) == 0) continue;
      const Triple axiom = rule.Premise(i, InstanceOf(step.instance).row);
      absl::StrAppend(&text, text.empty() ? " (" : " . ", Shown(axiom.subject), " ", Shown(axiom.predicate),
                      " ", Shown(axiom.object));
    }
    return text.empty() ? text : text + ")";
  }
  std::string Shown(TermId id) const { return ToDisplay(dictionary_.Decode(id)); }

  const RuleProgram& program_;
  const SchemaIndex& schema_;
  const GraphVersion& graph_;
  const Dictionary& dictionary_;
  const AxiomAnswers& before_;
  const AskAxioms ask_;
  const bool late_reports_;  // of all checks
  std::vector<SchemaIndex::Instance> equals_;
  std::vector<int> place_;  // of a rule in program_.ordered; -1: not in it
  std::vector<Taker> takers_;
  absl::flat_hash_set<Key> instances_;
  absl::flat_hash_map<TermId, std::vector<size_t>> by_predicate_;  // kNone: a variable
  std::vector<Following> followings_;
  absl::flat_hash_map<std::pair<TermId, TermId>, bool> of_axioms_;
  std::vector<Question> questions_;
  AxiomAnswers answers_;
  absl::flat_hash_map<TermId, std::vector<FactPattern>> all_reached_;  // by predicate
  absl::flat_hash_set<FactPattern> all_seen_;
  std::vector<RuleDependency> dependencies_;  // among program_.ordered
  absl::flat_hash_set<std::tuple<uint32_t, uint32_t, bool>> known_;
  absl::Status status_;
  absl::flat_hash_map<std::pair<uint32_t, uint32_t>, std::vector<Step>> ways_;
};

}  // namespace

absl::StatusOr<NegationOrder> OrderNegation(const RuleProgram& program, const SchemaIndex& schema,
                                            const EqualityClasses& classes, const GraphVersion& graph,
                                            const Dictionary& dictionary, const AxiomAnswers& before,
                                            AskAxioms ask) {
  const auto find = [&](bool late_reports) {
    return Order(program, schema, classes, graph, dictionary, before, ask, late_reports).Find();
  };
  absl::StatusOr<NegationOrder> order = find(false);
  const bool has_checks = !program.report_words.inconsistency.IsNone();
  return order.ok() || !has_checks ? std::move(order) : find(true);
}

bool KnowsAnswers(const NegationOrder& order, const GraphVersion& graph) {
  return std::all_of(order.asked.begin(), order.asked.end(), [&](const auto& asked) {
    if (asked.second.size() > kManyAnswers) return true;
    const std::vector<TermId> now = Answers(graph, asked.first);
    return std::all_of(now.begin(), now.end(), [&](TermId id) {
      return std::find(asked.second.begin(), asked.second.end(), id) != asked.second.end();
    });
  });
}

}  // namespace docent::rules
