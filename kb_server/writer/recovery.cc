#include "kb_server/writer/recovery.h"

#include <algorithm>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/log/record_codec.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

constexpr size_t kRecordsRead = 2000;  // of the log at a time

absl::Status DecidedOtherwise(const log::TurnRecord& recorded, const std::string& what,
                              absl::string_view difference) {
  const std::string text = absl::StrCat(
      "log offset ", recorded.offset, ": ", what, " (recorded by engine version ", recorded.engine_version,
      ", this is ", kEngineVersion, ")\n", absl::StripTrailingAsciiWhitespace(difference));
  if (recorded.engine_version == kEngineVersion) return absl::DataLossError(text);
  // What was decided stands, and only a snapshot tells what came of it.
  return absl::FailedPreconditionError(absl::StrCat(
      text,
      "\nstart the version that wrote it once more and end it in order: it leaves a snapshot from which this "
      "one goes on"));
}

// A record as it was read.
struct Recorded {
  log::TurnRecord turn;
  size_t bytes = 0;
};

// At least one record of `from` … `to`, more as they fit.
absl::StatusOr<std::vector<Recorded>> ReadRecords(log::ContextLog* log, uint64_t from, uint64_t to) {
  absl::StatusOr<std::vector<log::LogEntry>> entries =
      log->Read(from, std::min<uint64_t>(kRecordsRead, to - from + 1));
  if (!entries.ok()) return entries.status();
  if (entries->empty()) return absl::DataLossError(absl::StrCat("the log has no record at offset ", from));
  std::vector<Recorded> records;
  records.reserve(entries->size());
  for (const log::LogEntry& entry : *entries) {
    absl::StatusOr<log::TurnRecord> turn = log::DecodeTurnRecord(entry.offset, entry.data);
    // those before it can be replayed
    if (!turn.ok() && !records.empty()) break;
    if (!turn.ok()) return turn.status();
    records.push_back({*std::move(turn), entry.data.size()});
  }
  return records;
}

absl::Status ReplayTurn(Recorded recorded, Stages* stages, const ReplayedTurn& done) {
  const uint64_t offset = recorded.turn.offset;
  absl::StatusOr<TurnResult> derived = RunTurn(stages, std::move(recorded.turn.batch), offset);
  if (!derived.ok()) {
    return DecidedOtherwise(recorded.turn, "the recorded batch is refused on replay",
                            derived.status().message());
  }
  if (std::optional<std::string> difference = log::DecisionDifference(recorded.turn, derived->record)) {
    return DecidedOtherwise(recorded.turn, "replay decides otherwise", *difference);
  }
  return done(*std::move(derived), recorded.bytes);
}

}  // namespace

absl::StatusOr<RestoredState> FindStart(log::ContextLog* log, uint64_t target, Dictionary* dictionary,
                                        const sparql::FunctionRegistry* functions, const Limits& limits) {
  const absl::StatusOr<uint64_t> first = log->First();
  if (!first.ok()) return first.status();
  absl::Status bad;
  for (uint64_t at_most = target;;) {
    absl::StatusOr<std::vector<uint64_t>> offsets = log->SnapshotOffsets();
    if (!offsets.ok()) return offsets.status();
    while (!offsets->empty() && offsets->back() > at_most) offsets->pop_back();
    if (offsets->empty() || offsets->back() + 1 < *first) break;
    const uint64_t offset = offsets->back();
    absl::StatusOr<std::optional<log::LogSnapshot>> snapshot = log->SnapshotGet(offset);
    absl::Status status = snapshot.status();
    if (status.ok() && *snapshot && (*snapshot)->offset == offset) {
      absl::StatusOr<RestoredState> state = DecodeState((*snapshot)->data, dictionary, functions, limits);
      if (state.ok() && state->offset == offset) return state;
      status = state.ok() ? absl::DataLossError("it says another offset than its name") : state.status();
    }
    if (!status.ok()) {
      spdlog::error("the snapshot at offset {} is of no use: {}; trying an older one", offset,
                    std::string(status.message()));
      if (bad.ok()) bad = status;
    }
    if (offset == 0) break;
    at_most = offset - 1;
  }
  if (*first > 1) {
    if (!bad.ok()) return bad;
    return absl::OutOfRangeError(absl::StrCat("log records up to ", *first - 1,
                                              " were trimmed away and no snapshot takes their place"));
  }
  RestoredState empty;
  empty.stages = std::make_unique<Stages>(dictionary, functions, limits);
  return empty;
}

absl::Status ReplayTurns(log::ContextLog* log, uint64_t from, uint64_t to, Stages* stages,
                         const ReplayedTurn& done) {
  const bool freezes = std::exchange(stages->freezes, false);
  absl::Status status;
  // The next records are read and decoded while those before them are replayed.
  const auto read = [log, to](uint64_t next) {
    return std::async(std::launch::async, ReadRecords, log, next, to);
  };
  std::future<absl::StatusOr<std::vector<Recorded>>> reading;
  if (from <= to) reading = read(from);
  for (uint64_t next = from; next <= to && status.ok();) {
    absl::StatusOr<std::vector<Recorded>> records = reading.get();
    status = records.status();
    if (!status.ok()) break;
    next += records->size();
    if (next <= to) reading = read(next);
    for (Recorded& recorded : *records) {
      status = ReplayTurn(std::move(recorded), stages, done);
      if (!status.ok()) break;
    }
  }
  stages->freezes = freezes;
  if (status.ok()) stages->writer.Freeze(Revision(to));
  return status;  // what is still being read is waited for
}

}  // namespace docent::server
