#include "kb_server/grpc/possible_changes.h"

#include "kb_server/door/catalog.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {

explain::MayChange MayChangeOf(const RunPorts& ports, const QueryGraph& graph, Cancellation* cancellation) {
  return [&ports, &graph, cancellation](const std::vector<TermQuad>& add,
                                        const std::vector<TermQuad>& remove) -> absl::StatusOr<bool> {
    ReadPorts of_then = ports;
    of_then.dictionary = graph.dictionary.get();
    RuleTexts rules;
    for (const auto& set : ports.catalog->Get()->rules) rules.push_back({set.name, *set.text});
    WriteBatch batch;
    for (const TermQuad& fact : remove) batch.operations.push_back({QuadOperation::Kind::kRemove, fact});
    for (const TermQuad& fact : add) batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
    const absl::StatusOr<LoadVerdict> verdict =
        JudgeLoad(of_then, batch, *graph.version, {}, rules, cancellation);
    if (absl::IsInvalidArgument(verdict.status())) return false;  // the turn would say so
    if (!verdict.ok()) return verdict.status();
    return !verdict->HasViolations();
  };
}

}  // namespace docent::server
