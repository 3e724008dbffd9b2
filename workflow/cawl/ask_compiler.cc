#include "workflow/cawl/ask_compiler.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "absl/algorithm/container.h"
#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/syntax/parser.h"
#include "workflow/cawl/ask_writer.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/lasting_rules.h"

namespace docent::cawl {
namespace {

CompiledAsk Written(AskWriter writer, std::string name, int priority) {
  CompiledAsk out;
  out.name = std::move(name);
  out.priority = priority;
  out.ask = writer.Text();
  out.free_variables = writer.free_variables();
  out.unset = writer.unset();
  out.event_variables = writer.event_variables();
  out.joint_events = writer.joint_events();
  return out;
}

absl::StatusOr<CompiledAsk> Compile(const Document& document, const std::vector<Conjunction>& alternatives,
                                    const VariableValues& values, const Limits& limits, std::string name,
                                    int priority) {
  AskWriter writer(document, values, limits);
  absl::Status status = writer.Write(alternatives);
  if (!status.ok()) return status;
  CompiledAsk written = Written(std::move(writer), std::move(name), priority);
  written.has_alternatives = alternatives.size() > 1;
  return written;
}

absl::StatusOr<CompiledAsk> Compile(const Document& document, const Formula& formula,
                                    const VariableValues& values, const Limits& limits, std::string name,
                                    int priority, Events events = Events::kAsked) {
  absl::StatusOr<std::vector<Conjunction>> alternatives = ToAlternatives(formula);
  if (!alternatives.ok()) return alternatives.status();
  if (events == Events::kHappened) {
    for (Conjunction& alternative : *alternatives) {
      alternative.events.clear();
      std::erase_if(alternative.constraints, [](const Constraint* constraint) {
        return constraint->time == Constraint::Time::kOccurs;
      });
    }
  }
  return Compile(document, *alternatives, values, limits, std::move(name), priority);
}

std::string NameOr(const Text& name, std::string otherwise) {
  return name.empty() ? otherwise : name.value;
}

// Comment lines about the times of `context` that its text does not ask for.
std::string NotesOn(const Context& context) {
  std::string notes;
  for (size_t i = 0; i < context.rules.size(); ++i) {
    const Rule& rule = context.rules[i];
    if (rule.after_ms) absl::StrAppend(&notes, "# after ", rule.after_text.value, " in the node\n");
    if (!rule.at_least_ms) continue;
    absl::StrAppend(&notes, "# ", absl::StrCat("rule ", NameOr(rule.name, absl::StrCat(i + 1))),
                    ": for at least ", rule.for_text.value, "\n");
  }
  return notes;
}

// The rules of `context` that must have held for some time become parts of `ask`, and its text says so.
absl::Status AddLasting(const Document& document, const Context& context, const VariableValues& values,
                        const Limits& limits, CompiledAsk* ask) {
  for (const Rule& rule : context.rules) {
    if (!rule.at_least_ms) continue;
    absl::StatusOr<CompiledAsk> part = Compile(document, FormulaOf(rule), values, limits, "", 0);
    if (!part.ok()) return part.status();
    LastingAsk lasting{std::move(part->ask), nullptr, {}, *rule.at_least_ms};
    const std::set<std::string> bound = CertainVariables(rule);
    std::copy_if(part->free_variables.begin(), part->free_variables.end(),
                 std::back_inserter(lasting.variables),
                 [&bound](const std::string& name) { return bound.contains(name); });
    ask->lasting.push_back(std::move(lasting));
  }
  ask->ask = NotesOn(context) + ask->ask;
  return absl::OkStatus();
}

std::vector<const Context*> ByPriority(const Condition& condition) {
  std::vector<const Context*> contexts;
  for (const Context& context : condition.contexts) contexts.push_back(&context);
  std::stable_sort(contexts.begin(), contexts.end(),
                   [](const Context* a, const Context* b) { return a->priority < b->priority; });
  return contexts;
}

absl::Status Parse(const std::string& text, const Limits& limits, std::shared_ptr<const sparql::Query>* out) {
  sparql::ParseOptions options;
  options.limits = limits;
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (parsed.ok()) {
    *out = std::make_shared<const sparql::Query>(std::move(parsed.query));
    return absl::OkStatus();
  }
  const Diagnostic& first = parsed.diagnostics.front();
  return absl::InvalidArgumentError(absl::StrCat("the condition is not valid as SPARQL: ", first.message,
                                                 first.hint.empty() ? "" : absl::StrCat("; ", first.hint)));
}

SourceSpan PlaceOf(const Text& name, const SourceSpan& element) {
  return name.empty() ? element : name.span;
}

}  // namespace

absl::StatusOr<std::vector<CompiledAsk>> CompileCondition(const Document& document,
                                                          const Condition& condition,
                                                          const VariableValues& values, const Limits& limits,
                                                          SourceSpan* refused, Events events) {
  std::vector<CompiledAsk> out;
  const auto add = [&](const Formula& formula, std::string name, int priority, const SourceSpan& place) {
    absl::StatusOr<CompiledAsk> ask =
        Compile(document, formula, values, limits, std::move(name), priority, events);
    if (ask.ok()) {
      out.push_back(*std::move(ask));
    } else if (refused != nullptr) {
      *refused = place;
    }
    return ask.status();
  };
  if (condition.expression) {
    absl::Status status = add(FormulaOf(condition), ToText(*condition.expression), 0,
                              PlaceOf(condition.expression_text, condition.span));
    if (!status.ok()) return status;
    return out;
  }
  for (const Context* context : ByPriority(condition)) {
    const SourceSpan place = PlaceOf(context->name, context->span);
    absl::Status status =
        add(FormulaOf(*context), NameOr(context->name, absl::StrCat("context ", out.size() + 1)),
            context->priority, place);
    if (status.ok()) status = AddLasting(document, *context, values, limits, &out.back());
    if (!status.ok() && refused != nullptr) *refused = place;
    if (!status.ok()) return status;
  }
  for (const Case& c : condition.cases) {
    absl::Status status =
        add(FormulaOf(c), NameOr(c.name, "case"), 0, PlaceOf(c.expression_text, PlaceOf(c.name, c.span)));
    if (!status.ok()) return status;
  }
  return out;
}

absl::StatusOr<CompiledAsk> CompileConstraint(const Document& document, const Constraint& constraint,
                                              const VariableValues& values, const Limits& limits) {
  Formula formula;
  formula.kind = Formula::Kind::kConstraint;
  formula.constraint = &constraint;
  return Compile(document, formula, values, limits, NameOr(constraint.name, "while"), 0);
}

std::vector<Alternative> AlternativesOf(const Condition& condition) {
  std::vector<Alternative> out;
  size_t ask = 0;
  const auto add = [&](const Formula& formula, const Context* context) {
    absl::StatusOr<std::vector<Conjunction>> parts = ToAlternatives(formula);
    if (parts.ok()) {
      for (Conjunction& part : *parts) out.push_back({ask, context, std::move(part)});
    }
    ++ask;
  };
  if (condition.expression) {
    add(FormulaOf(condition), nullptr);
    return out;
  }
  for (const Context* context : ByPriority(condition)) add(FormulaOf(*context), context);
  for (const Case& c : condition.cases) add(FormulaOf(c), nullptr);
  return out;
}

absl::StatusOr<CompiledAsk> CompileAlternative(const Document& document, const Alternative& alternative,
                                               const VariableValues& values, const Limits& limits) {
  absl::StatusOr<CompiledAsk> ask = Compile(document, {alternative.parts}, values, limits, "", 0);
  if (ask.ok() && alternative.context != nullptr) ask->ask = NotesOn(*alternative.context) + ask->ask;
  return ask;
}

absl::Status ParseAsks(const Limits& limits, CompiledAsk* ask) {
  absl::Status status = Parse(ask->ask, limits, &ask->query);
  for (LastingAsk& part : ask->lasting) {
    if (status.ok()) status = Parse(part.ask, limits, &part.query);
  }
  return status;
}

std::vector<std::string> KeyVariables(const Activator& activator, const CompiledAsk& ask,
                                      const std::map<std::string, std::string>& names) {
  std::vector<std::string> declared;
  for (const std::string& name : ask.free_variables) {
    const auto other = names.find(name);
    const std::string& own = other == names.end() ? name : other->second;
    if (std::any_of(activator.variables.begin(), activator.variables.end(),
                    [&](const Variable& v) { return v.name.value == own; }))
      declared.push_back(name);
  }
  const std::vector<std::string>& keys = declared.empty() ? ask.free_variables : declared;
  std::vector<std::string> out = ask.event_variables;
  out.insert(out.end(), keys.begin(), keys.end());
  return out;
}

namespace {

constexpr char kSplit[] = "split it into several contexts, or into several nodes";

class TextWriter {
 public:
  TextWriter(const Document& document, const Limits& limits, xml::ElementReader* reader)
      : document_(document), limits_(limits), reader_(*reader) {}

  void Add(const std::string& place, const Condition& condition) {
    SourceSpan refused = condition.span;
    absl::StatusOr<std::vector<CompiledAsk>> asks =
        CompileCondition(document_, condition, NoValues, limits_, &refused);
    if (!asks.ok()) return Refuse(refused, asks.status(), kSplit);
    for (size_t i = 0; i < asks->size(); ++i) {  // contexts come before the case
      Add(place,
          condition.expression            ? "condition"
          : i < condition.contexts.size() ? "context"
                                          : "case",
          condition.span, &(*asks)[i]);
    }
  }

  // Of an attribute of that name.
  void Add(const std::string& place, const Constraint& constraint, const std::string& attribute,
           const Text& text) {
    absl::StatusOr<CompiledAsk> ask = CompileConstraint(document_, constraint, NoValues, limits_);
    if (!ask.ok()) return Refuse(text.span, ask.status(), "");
    ask->name = attribute;
    Add(place, attribute, text.span, &*ask);
  }

  std::vector<ConditionText> Take() { return std::move(out_); }

 private:
  static std::optional<Term> NoValues(const std::string&) { return std::nullopt; }

  void Add(const std::string& place, const std::string& what, const SourceSpan& span, CompiledAsk* ask) {
    if (absl::Status status = ParseAsks(limits_, ask); !status.ok()) return Refuse(span, status, kSplit);
    std::string notes;
    for (const std::string& name : ask->unset)
      absl::StrAppend(&notes, "# ?", name, " is the value of $", name, " at run time\n");
    bool says_so = absl::StartsWith(ask->name, what);  // "context 2"
    out_.push_back(
        {absl::StrCat(place, " / ", says_so ? "" : what + " ", ask->name), notes + ask->ask, span});
  }

  void Refuse(const SourceSpan& span, const absl::Status& status, const char* hint) {
    reader_.Error(span, std::string(status.message()), hint);
  }

  const Document& document_;
  const Limits& limits_;
  xml::ElementReader& reader_;
  std::vector<ConditionText> out_;
};

}  // namespace

std::vector<ConditionText> ConditionTexts(const Document& document, const Limits& limits,
                                          xml::ElementReader* reader, Cancellation* cancellation) {
  const auto is_over = [&] { return cancellation != nullptr && !cancellation->CheckNow().ok(); };
  TextWriter writer(document, limits, reader);
  if (document.activator) {
    writer.Add(document.activator->name.empty() ? "activator"
                                                : absl::StrCat("activator ", document.activator->name.value),
               document.activator->condition);
  }
  for (const Flow& flow : document.flows) {
    const std::string place = absl::StrCat("flow ", flow.name.value);
    for (const Node& node : flow.nodes) {
      if (is_over()) return writer.Take();
      const std::string of_node = absl::StrCat(place, " / node ", node.name.value);
      if (node.condition) writer.Add(of_node, *node.condition);
      if (node.hold) writer.Add(of_node, *node.hold, "while-holds", node.hold_text);
    }
    for (const Link& link : flow.links) {
      if (!link.while_constraint) continue;
      if (is_over()) return writer.Take();
      writer.Add(absl::StrCat(place, " / link ", link.from.value, " → ", link.to.value),
                 *link.while_constraint, "while", link.while_text);
    }
  }
  return writer.Take();
}

namespace {

using EventOperations = std::map<std::string, std::string>;  // by the event's variable

// The events of one alternative, and those of its alternatives.
void CollectEvents(const sparql::Algebra& node, const CompiledAsk& ask, EventOperations* own,
                   std::vector<EventOperations>* alternatives) {
  for (const sparql::TriplePattern& triple : node.triples) {
    if (!triple.subject.IsVariable() || triple.predicate.IsVariable() || triple.object.IsVariable() ||
        triple.predicate.term().lexical != DocentIri("operation"))
      continue;
    const std::string& name = triple.subject.variable().name;
    if (absl::c_linear_search(ask.event_variables, name)) (*own)[name] = triple.object.term().lexical;
  }
  for (const auto& child : node.children) {
    if (node.kind != sparql::Algebra::Kind::kUnion) {
      CollectEvents(*child, ask, own, alternatives);
      continue;
    }
    EventOperations of_alternative;
    CollectEvents(*child, ask, &of_alternative, alternatives);
    alternatives->push_back(std::move(of_alternative));
  }
}

}  // namespace

std::vector<std::string> JointEventsOf(const CompiledAsk& ask) {
  std::vector<std::string> operations;
  if (ask.event_variables.size() < 2) return operations;
  const sparql::ParsedQuery parsed = sparql::ParseQuery(ask.ask, {});
  if (!parsed.ok()) return operations;
  std::vector<EventOperations> alternatives(1);
  EventOperations whole;
  CollectEvents(*parsed.query.algebra, ask, &whole, &alternatives);
  alternatives[0] = std::move(whole);
  for (const EventOperations& of_alternative : alternatives) {
    for (const auto& [name, operation] : of_alternative) {
      if (of_alternative.size() > 1 && !absl::c_linear_search(operations, operation))
        operations.push_back(operation);
    }
  }
  return operations;
}

}  // namespace docent::cawl
