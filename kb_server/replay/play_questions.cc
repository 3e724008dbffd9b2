#include "kb_server/replay/play_questions.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/calendar/time_spec.h"
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

// The first solution of the ask with these values, in term order; nullopt: there is none.
absl::StatusOr<std::optional<engine::TermBinding>> FirstSolution(Stages* stages, const cawl::CompiledAsk& ask,
                                                                 const engine::TermBinding& given,
                                                                 TimeMicros now_us) {
  engine::ConditionRequest request;
  request.handle = kAskedOnce;
  request.ask = ask.ask;
  request.query = ask.query;
  const GraphVersion& graph = stages->writer.current();
  if (absl::Status armed = stages->conditions.Arm({request}, graph, now_us, stages->cancellation);
      !armed.ok())
    return armed;
  stages->conditions.BeginRound(graph, now_us, stages->cancellation);
  auto solutions = stages->conditions.Solutions(kAskedOnce, given, 1);
  stages->conditions.Disarm({kAskedOnce});
  stages->Commit();
  if (!solutions.ok()) return solutions.status();
  if (solutions->empty()) return std::optional<engine::TermBinding>();
  return std::optional<engine::TermBinding>(std::move(solutions->front()));
}

}  // namespace

absl::StatusOr<Activation> FindActivation(Stages* stages, const cawl::Document& document,
                                          const NamedTerms& values, TimeMicros now_us) {
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
    auto solution = FirstSolution(stages, ask, given, now_us);
    if (!solution.ok()) return solution.status();
    if (*solution) {
      activation.fires = true;
      activation.values = given;
      activation.values.insert((*solution)->begin(), (*solution)->end());
      if (!ask.lasting.empty())
        activation.note =
            absl::StrCat("the time that ext:for of activator ", document.activator->name.value,
                         " asks for is not replayed: its condition holds in this turn, and that counts");
      return activation;
    }
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

std::string PlayQuestions::Missing(const std::string& text) {
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
  auto why_not = (*explainer)->WhyNot(ask.query, 1);
  if (!why_not.ok()) return "";
  if (why_not->holds) return "nothing but a robot: those with which it holds are held by other runs";
  if (why_not->repairs.empty()) return "";
  return explain::ChangesText(why_not->repairs.front(), {});
}

std::string PlayQuestions::Pending(const RunTree& tree) const {
  const GraphReader graph(stages_.dictionary, *version_);
  for (const std::string& invocation :
       graph.Subjects(DocentIri("invocationState"), Term::Literal("pending"))) {
    const std::optional<RunId> subject = RunOfIri(invocation);
    if (subject && tree.PathOf(subject->value())) return graph.Object(invocation, DocentIri("reason"));
  }
  return "";
}

void PlayQuestions::AddWaits(const RunTree& tree, std::vector<PlayedWait>* waits) {
  const GraphReader graph(stages_.dictionary, *version_);
  for (const std::string& node : graph.Subjects(DocentIri("nodeState"), Term::Literal("waiting"))) {
    const std::optional<RunId> subject = RunOfIri(node);
    const std::optional<std::string> path = subject ? tree.PathOf(subject->value()) : std::nullopt;
    if (!path) continue;
    PlayedWait wait{*path, graph.Object(node, DocentIri("waitsFor")), ""};
    if (!wait.ask.empty()) wait.missing = Missing(wait.ask);
    waits->push_back(std::move(wait));
  }
}

}  // namespace docent::server
