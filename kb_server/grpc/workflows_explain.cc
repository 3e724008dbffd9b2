// Workflows.Explain: what a run waits for, or why it ended, on the newest version or a past one, beside the writer.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text_limits.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/wire/text_cut.h"
#include "kb_server/door/history_port.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/possible_changes.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/run_waits.h"
#include "kb_server/grpc/unary_reactors.h"
#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"

namespace docent::server {
namespace {

// Number of conditions of one run in which what is missing is looked for; of the others only that they do not hold is told.
constexpr int kMostConditions = 20;
// Number of robots that are named for one condition.
constexpr size_t kMostRobots = 50;

class ConditionAsker {
 public:
  ConditionAsker(const RunPorts& ports, const QueryGraph& graph, TimeMicros now_us,
                 Cancellation* cancellation)
      : limits_(ports.limits), functions_(ports.functions) {
    settings_.version = graph.version;
    settings_.dictionary = graph.dictionary.get();
    settings_.rules = ports.catalog->Get()->rules;
    settings_.functions = ports.functions;
    settings_.cancellation = cancellation;
    settings_.now_us = now_us;
    settings_.default_graph = ports.default_graph;
    settings_.limits = ports.limits;
    settings_.may_change = MayChangeOf(ports, graph, cancellation);
  }

  ConditionAnswer Ask(const std::string& text) {
    ConditionAnswer answer;
    if (++asked_ > kMostConditions) return answer;
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, sparql::ParseOptionsWith(limits_, functions_));
    auto explainer = explain::Explainer::Make(settings_);
    if (!parsed.ok() || !explainer.ok()) return answer;
    auto why_not = (*explainer)->WhyNot(parsed.query, 1);
    if (!why_not.ok()) {
      ReadTrace::NoteAnything();  // it may have been the time
      return answer;
    }
    answer.holds = why_not->holds;
    if (!answer.holds) {
      if (why_not->repairs.empty()) return answer;
      explain::Repair& repair = why_not->repairs.front();
      answer.missing = explain::ChangesText(repair, {});
      // what the compiler of conditions asks of events beside the document's own words
      std::erase_if(repair.conditions,
                    [](const std::string& condition) { return absl::StrContains(condition, "?_event"); });
      answer.remarks = explain::RemarksText(repair, {});
      return answer;
    }
    auto robots = (*explainer)->ValuesOf(parsed.query, "robot", kMostRobots);
    if (!robots.ok()) ReadTrace::NoteAnything();
    if (!robots.ok()) return answer;
    for (const Term& robot : *robots) {
      if (robot.IsIri()) answer.robots.push_back(robot.lexical);
    }
    std::sort(answer.robots.begin(), answer.robots.end());
    return answer;
  }

 private:
  const Limits limits_;
  const sparql::FunctionRegistry* const functions_;
  explain::Explainer::Settings settings_;
  int asked_ = 0;
};

absl::Status Answer(const RunPorts& ports, const v1::ExplainRunRequest& request, Cancellation* cancellation,
                    v1::ExplainRunReply* reply) {
  const absl::StatusOr<QueryGraph> of_then = GraphForQuery(ports, request.as_of(), cancellation);
  if (!of_then.ok()) return of_then.status();
  const TimeMicros now_us = TimeAsOf(request.as_of()).value_or(ports.clock->Now());
  const GraphReader graph(*of_then->dictionary, *of_then->version);
  v1::Run run;
  if (!ReadRun(graph, request.run(), &run))
    return absl::NotFoundError(absl::StrCat("there is no run \"", request.run(), "\""));
  if (!request.node().empty()) {
    std::vector<std::string> names;
    for (const v1::Node& node : run.nodes()) names.push_back(node.name());
    if (std::find(names.begin(), names.end(), request.node()) == names.end()) {
      const std::string near = Nearest(request.node(), names);
      return absl::NotFoundError(absl::StrCat("run ", request.run(), " has no node \"", request.node(), "\"",
                                              near.empty()
                                                  ? absl::StrCat("; it has ", absl::StrJoin(names, ", "))
                                                  : absl::StrCat("; did you mean ", near, "?")));
    }
  }
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  const auto catalog = ports.catalog->Get();
  ConditionAsker asker(ports, *of_then, now_us, cancellation);
  WaitSources sources{&graph, catalog.get(), now_us,
                      [&asker](const std::string& ask) { return asker.Ask(ask); }};
  AddWaits(sources, run, request.node(), reply);
  reply->set_text(TextOf(run, *reply));
  CutToFit(reply, kTextLimits.shown_text_bytes, kTextLimits.listed_bytes);
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* WorkflowsService::Explain(grpc::CallbackServerContext* context,
                                                    const v1::ExplainRunRequest* request,
                                                    v1::ExplainRunReply* reply) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  // A past version is not followed.
  const auto trace = request->as_of().empty() ? TraceOf(*context, ports_.followed) : nullptr;
  const auto answer = [this, cancellation, request, reply, trace](grpc::ServerUnaryReactor* reactor) {
    reactor->Finish(
        ToGrpc(Traced(trace.get(), [&] { return Answer(ports_, *request, cancellation.get(), reply); })));
  };
  return OnWorker(ports_, context, cancellation, answer);
}

}  // namespace docent::server
