// What a live run waits for, and of one that ended the robots that have yet to stop, as the graph docent:runs has it: one entry for each thing, runs that are nested in it included.
// Pure; any thread.
#ifndef DOCENT_KB_SERVER_GRPC_RUN_WAITS_H_
#define DOCENT_KB_SERVER_GRPC_RUN_WAITS_H_

#include <functional>
#include <string>
#include <vector>

#include "docent/v1/workflows.pb.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/catalog.h"

namespace docent::server {

// Why a condition has not opened its node.
struct ConditionAnswer {
  bool holds = false;
  std::string missing;  // a pattern without a match, in N-Triples with ?variables; empty: not known
  std::string remarks;  // what else is to be known of that: "now 0.1; where (?b > 0.2)"
  std::vector<std::string> robots;  // it holds: IRIs of ?robot in its matches; none: it has no ?robot
};
using AskCondition = std::function<ConditionAnswer(const std::string& ask)>;

struct WaitSources {
  const GraphReader* graph = nullptr;
  const Catalog* catalog = nullptr;  // null: joins are told without names
  TimeMicros now_us = 0;
  AskCondition ask;  // null: conditions are told without what is missing
};

// Adds to `reply` what the run waits for, or only what its node does (`node` not empty). Of a run that has ended: robots that have not
// yet confirmed that they stopped.
void AddWaits(const WaitSources& sources, const v1::Run& run, const std::string& node,
              v1::ExplainRunReply* reply);

// For people: the run's state, then a line for each wait; of a run that ended, why it did.
std::string TextOf(const v1::Run& run, const v1::ExplainRunReply& reply);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_RUN_WAITS_H_
