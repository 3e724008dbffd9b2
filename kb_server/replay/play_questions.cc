#include "kb_server/replay/play_questions.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_reader.h"
#include "kb_server/replay/played_document.h"
#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"
#include "workflow/cawl/ask_compiler.h"
#include "workflow/cawl/ask_names.h"

namespace docent::server {
namespace {

// Of a condition that is armed only to be asked once; those of the engine count from 1.
constexpr engine::ConditionHandle kAskedOnce = engine::ConditionHandle{1} << 62;
// Number of conditions in which what is missing is looked for.
constexpr int kMostQuestions = 20;

bool Binds(const cawl::CompiledAsk& ask, const std::string& name) {
  const auto has = [&name](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return has(ask.free_variables) || has(ask.event_variables);
}

// The alternatives of the document's activator.
absl::StatusOr<std::vector<cawl::CompiledAsk>> AsksOf(const cawl::Document& document, const Limits& limits) {
  return cawl::CompileCondition(
      document, document.activator->condition, [](const std::string&) { return std::nullopt; }, limits);
}

// Solutions that are looked at to find the one that has held for long enough first.
constexpr size_t kMostSolutions = 1000;

// Solutions of the ask with these values, in term order, at most `limit`.
absl::StatusOr<std::vector<engine::TermBinding>> SolutionsOf(Stages* stages, const cawl::CompiledAsk& ask,
                                                             const engine::TermBinding& given,
                                                             TimeMicros now_us, size_t limit) {
  engine::ConditionRequest request;
  request.handle = kAskedOnce;
  request.ask = ask.ask;
  request.query = ask.query;
  const GraphVersion& graph = stages->writer.current();
  if (absl::Status armed = stages->conditions.Arm({request}, graph, now_us, stages->cancellation);
      !armed.ok())
    return armed;
  stages->conditions.BeginRound(graph, now_us, stages->cancellation);
  auto solutions = stages->conditions.Solutions(kAskedOnce, given, limit);
  stages->conditions.Disarm({kAskedOnce});
  stages->Commit();
  return solutions;
}

// When each rule with ext:for will have held for its time with this solution.
TimeMicros FullAt(const cawl::CompiledAsk& ask, const engine::TermBinding& solution,
                  const std::vector<HeldSince>& held, TimeMicros now_us) {
  TimeMicros full_us = now_us;
  for (const cawl::LastingAsk& part : ask.lasting) {
    std::map<std::string, Term> binding;
    for (const std::string& name : part.variables) {
      if (const auto value = solution.find(name); value != solution.end()) binding.insert(*value);
    }
    const auto known = std::find_if(held.begin(), held.end(), [&](const HeldSince& since) {
      return since.ask == part.ask && since.binding == binding;
    });
    const TimeMicros since_us = known == held.end() ? now_us : known->since_us;
    full_us = std::max(full_us, since_us + part.at_least_ms * 1000);
  }
  return full_us;
}

// The values with which one alternative of the activator fires, or will. False: it has none.
absl::StatusOr<bool> FindValues(Stages* stages, const cawl::Document& document, const cawl::CompiledAsk& ask,
                                const engine::TermBinding& given, TimeMicros now_us,
                                const std::vector<HeldSince>* held, Activation* activation) {
  const bool counts_time = held != nullptr && !ask.lasting.empty();
  const auto solutions = SolutionsOf(stages, ask, given, now_us, counts_time ? kMostSolutions : 1);
  if (!solutions.ok()) return solutions.status();
  if (solutions->empty()) return false;
  const engine::TermBinding* first = &solutions->front();
  TimeMicros full_us = now_us;
  if (counts_time) {
    full_us = FullAt(ask, *first, *held, now_us);
    for (const engine::TermBinding& solution : *solutions) {
      const TimeMicros of_one = FullAt(ask, solution, *held, now_us);
      if (of_one < full_us) full_us = of_one, first = &solution;
    }
  }
  if (activation->fires_us && *activation->fires_us <= full_us) return true;  // another one is earlier
  activation->fires = full_us <= now_us;
  activation->fires_us = full_us;
  activation->values = given;
  activation->values.insert(first->begin(), first->end());
  activation->ask = WithValues(ask.ask, given);
  if (held == nullptr && !ask.lasting.empty()) {
    activation->note =
        absl::StrCat("the time that ext:for of activator ", document.activator->name.value,
                     " asks for is not replayed: its condition holds in this turn, and that counts");
  }
  return true;
}

}  // namespace

absl::StatusOr<Activation> FindActivation(Stages* stages, const cawl::Document& document,
                                          const NamedTerms& values, TimeMicros now_us,
                                          const std::vector<HeldSince>* held) {
  Activation activation;
  if (!document.activator) {
    activation.why_not = "the document has no activator, which started the recorded run";
    return activation;
  }
  auto asks = AsksOf(document, stages->limits);
  if (!asks.ok()) return asks.status();
  const engine::TermBinding all(values.begin(), values.end());
  for (cawl::CompiledAsk& ask : *asks) {
    if (absl::Status parsed = cawl::ParseAsks(stages->limits, &ask); !parsed.ok()) return parsed;
    engine::TermBinding given;
    for (const auto& [name, value] : all) {
      if (Binds(ask, name)) given.emplace(name, value);
    }
    const absl::StatusOr<bool> found = FindValues(stages, document, ask, given, now_us, held, &activation);
    if (!found.ok()) return found.status();
    if (activation.fires) return activation;
    if (activation.ask.empty()) activation.ask = WithValues(ask.ask, given);
  }
  if (asks->empty()) {  // it holds at once
    activation.fires = true;
    activation.values = all;
    return activation;
  }
  activation.why_not = absl::StrCat("activator ", document.activator->name.value, " does not fire for ",
                                    values.empty() ? std::string("these facts")
                                                   : absl::StrJoin(values, ", ",
                                                                   [](std::string* out, const auto& value) {
                                                                     absl::StrAppend(out, value.first, "=",
                                                                                     ToDisplay(value.second));
                                                                   }),
                                    ": no run is started");
  return activation;
}

bool FiresAlike(const cawl::Document& a, const cawl::Document& b, const Limits& limits) {
  if (!a.activator || !b.activator || a.activator->flow.value != b.activator->flow.value) return false;
  const auto of_a = AsksOf(a, limits), of_b = AsksOf(b, limits);
  cawl::NameMap names;
  return of_a.ok() && of_b.ok() &&
         std::equal(of_a->begin(), of_a->end(), of_b->begin(), of_b->end(),
                    [&](const cawl::CompiledAsk& one, const cawl::CompiledAsk& other) {
                      return cawl::AskTheSame(one, other, &names) &&
                             std::all_of(names.begin(), names.end(),
                                         [](const auto& name) { return name.first == name.second; }) &&
                             cawl::KeyVariables(*a.activator, one) == cawl::KeyVariables(*b.activator, other);
                    });
}

std::vector<std::string> TimesOfActivator(const cawl::Document& document, const Limits& limits) {
  std::vector<std::string> times;
  const auto asks = AsksOf(document, limits);
  if (!asks.ok()) return times;
  for (const cawl::CompiledAsk& ask : *asks) {
    const std::vector<std::string> of_ask = calendar::TimeIrisIn(ask.ask);
    times.insert(times.end(), of_ask.begin(), of_ask.end());
  }
  return times;
}

std::string PlayQuestions::Missing(const std::string& text, const WaitingNode& node) {
  if (++asked_ > kMostQuestions) return "";
  sparql::ParsedQuery ask =
      sparql::ParseQuery(text, sparql::ParseOptionsWith(stages_.limits, stages_.functions));
  explain::Explainer::Settings settings;
  settings.version = version_;
  settings.dictionary = &stages_.dictionary;
  settings.rules = stages_.documents.MakeCatalog(stages_.engine)->rules;
  settings.functions = stages_.functions;
  settings.cancellation = cancellation_;
  settings.now_us = now_us_;
  settings.limits = stages_.limits;
  auto explainer = explain::Explainer::Make(settings);
  if (!ask.ok() || !explainer.ok()) return "";
  const auto why_not = (*explainer)->WhyNot(ask.query, 1);
  if (!why_not.ok()) return "";
  if (why_not->holds) {
    const auto proof = (*explainer)->WhyAsk(ask.query);
    const bool proven = proof.ok() && *proof;
    return LacksBesideFacts(text, node,
                            proven && std::any_of((*proof)->bindings.begin(), (*proof)->bindings.end(),
                                                  [](const auto& bound) { return bound.first == "robot"; }));
  }
  std::string missing = why_not->repairs.empty() ? "" : explain::ChangesText(why_not->repairs.front(), {});
  if (const auto next = NextTime(GraphReader(stages_.dictionary, *version_), text, now_us_)) {
    absl::StrAppend(&missing, missing.empty() ? "" : " ", "its time comes at ", DateTimeTerm(*next).lexical);
  }
  return missing;
}

std::string PlayQuestions::LacksBesideFacts(const std::string& ask, const WaitingNode& node,
                                            bool has_robot) const {
  const GraphReader graph(stages_.dictionary, *version_);
  if (!has_robot && IsByEvent(ask)) return "nothing but an event that is told from now on";
  if (const auto time = TimeOfNode(graph, node, ask, now_us_))
    return absl::StrCat("nothing but time: ", time->text);
  if (has_robot) return "nothing but a robot: those with which it holds are held by other runs";
  return absl::StrCat("nothing but time: ", NotYetForLong(ask));
}

// Whether what is armed with the ASK is opened by events alone.
bool PlayQuestions::IsByEvent(const std::string& ask) const {
  const std::vector<engine::ConditionRequest> armed = stages_.conditions.Requests();
  return std::any_of(armed.begin(), armed.end(), [&ask](const engine::ConditionRequest& request) {
    return request.only_new && request.ask == ask;
  });
}

std::string PlayQuestions::Pending(const RunTree& tree) const {
  const GraphReader graph(stages_.dictionary, *version_);
  for (const std::string& invocation :
       graph.Subjects(DocentIri("invocationState"), Term::Literal("pending"))) {
    const std::optional<RunId> subject = RunOfIri(invocation);
    if (!subject || !tree.PathOf(subject->value())) continue;
    const std::string next = graph.Object(invocation, DocentIri("notBefore"));
    return next.empty() ? graph.Object(invocation, DocentIri("reason"))
                        : absl::StrCat("its next attempt begins at ", next);
  }
  return "";
}

void PlayQuestions::AddWaits(const RunTree& tree, std::vector<PlayedWait>* waits) {
  const GraphReader graph(stages_.dictionary, *version_);
  for (const std::string& node : graph.Subjects(DocentIri("nodeState"), Term::Literal("waiting"))) {
    const std::optional<RunId> subject = RunOfIri(node);
    const std::optional<std::string> path = subject ? tree.PathOf(subject->value()) : std::nullopt;
    if (!path) continue;
    const WaitingNode waiting{node, MicrosOfDateTime(graph.Object(node, DocentIri("since")))};
    for (const std::string& ask : AlternativesOf(graph.Object(node, DocentIri("waitsFor")))) {
      PlayedWait wait{*path, ask, ""};
      if (!ask.empty()) wait.missing = Missing(ask, waiting);
      waits->push_back(std::move(wait));
    }
  }
}

}  // namespace docent::server
