#include "kb_server/cli/rehearsal/load_rehearsal.h"

#include <utility>

#include "kb_server/door/inbox.h"

namespace docent::server {

LoadRehearsal::LoadRehearsal(const sparql::FunctionRegistry* functions, const Limits& limits)
    : limits_(limits), stages_(&dictionary_, functions, limits) {
  stages_.freezes = false;
  stages_.cancellation = &cancellation_;
}

absl::Status LoadRehearsal::Turn(WriteBatch batch) {
  if (absl::Status refused = CheckBatch(batch, limits_); !refused.ok()) return refused;
  batch.time_us = static_cast<TimeMicros>(offset_ + 1);
  std::string record;
  const absl::StatusOr<TurnResult> result = RunTurn(&stages_, std::move(batch), offset_ + 1, &record);
  if (result.ok()) ++offset_;
  return result.status();
}

absl::Status LoadRehearsal::LoadData(const std::vector<TermQuad>& facts) {
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.operations.reserve(facts.size());
  for (const TermQuad& fact : facts) batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
  return Turn(std::move(batch));
}

absl::Status LoadRehearsal::LoadDocument(Document document) {
  WriteBatch batch;
  if (document.kind == Document::Kind::kRules) batch.mode = WriteBatch::Mode::kLoad;
  batch.documents.push_back(std::move(document));
  return Turn(std::move(batch));
}

}  // namespace docent::server
