#include "kb_server/replay/run_course.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"

namespace docent::server {
namespace {

Decision Begin(Decision::Kind kind, const TurnResult& result, uint64_t turn, std::string node) {
  Decision decision;
  decision.kind = kind;
  decision.turn = turn;
  decision.time_us = result.record.time_us;
  decision.node = std::move(node);
  return decision;
}

// Of "RUN/NODE" and "RUN", not of "RUN/NODE/INVOCATION" and "RUN/$variable".
bool IsOfNodeOrRun(const std::string& subject) {
  const size_t slash = subject.find('/');
  if (slash == std::string::npos) return true;
  return subject.find('/', slash + 1) == std::string::npos && subject.compare(slash + 1, 1, "$") != 0;
}

std::map<std::string, Term> ReadNamed(const GraphReader& graph, const RunId& run,
                                      const std::string& property) {
  std::map<std::string, Term> named;
  for (const Term& value : graph.Objects(RunIri(run), DocentIri(property))) {
    const std::vector<Term> terms = graph.Objects(value.lexical, DocentIri("variableValue"));
    if (!terms.empty()) named[graph.Object(value.lexical, DocentIri("variableName"))] = terms.front();
  }
  return named;
}

}  // namespace

void AddDecisions(const TurnResult& result, uint64_t turn, const RunTree& tree,
                  std::vector<Decision>* decisions) {
  for (const Transition& transition : result.record.transitions) {
    std::optional<std::string> node = tree.PathOf(transition.subject);
    if (!node || !IsOfNodeOrRun(transition.subject) || transition.from == transition.to) continue;
    Decision& decision =
        decisions->emplace_back(Begin(Decision::Kind::kState, result, turn, *std::move(node)));
    decision.from = transition.from;
    decision.to = transition.to;
    decision.cause = transition.cause;
  }
  for (const RobotCommand& command : result.record.commands) {
    std::optional<std::string> node = tree.PathOf(command.id.value());
    if (!node) continue;
    Decision& decision =
        decisions->emplace_back(Begin(Decision::Kind::kCommand, result, turn, *std::move(node)));
    decision.command = command.id;
    decision.operation = command.operation;
    decision.robot = command.robot;
    decision.arguments = command.arguments;
  }
  for (const Notification& notification : result.notifications) {
    std::optional<std::string> node = tree.PathOf(notification.id.value());
    if (!node) continue;
    Decision& decision =
        decisions->emplace_back(Begin(Decision::Kind::kCommand, result, turn, *std::move(node)));
    decision.command = notification.id;
    decision.operation = kNotifies;
    decision.robot = RobotId(notification.target);
    for (const auto& [name, value] : notification.data) {
      if (value) decision.arguments.emplace_back(name, *value);
    }
  }
  for (const CommandId& id : result.cancels) {
    std::optional<std::string> node = tree.PathOf(id.value());
    if (!node) continue;
    decisions->emplace_back(Begin(Decision::Kind::kCancel, result, turn, *std::move(node))).command = id;
  }
}

void ReadEnd(const Dictionary& dictionary, const GraphVersion& graph, const RunId& run, Course* course) {
  const GraphReader reader(dictionary, graph);
  course->state = reader.Object(RunIri(run), DocentIri("runState"));
  course->reason = reader.Object(RunIri(run), DocentIri("reason"));
  course->variables = ReadNamed(reader, run, "hasVariable");
  course->results = ReadNamed(reader, run, "hasResult");
}

std::map<std::string, Term> ReadVariables(const Dictionary& dictionary, const GraphVersion& graph,
                                          const RunId& run) {
  return ReadNamed(GraphReader(dictionary, graph), run, "hasVariable");
}

}  // namespace docent::server
