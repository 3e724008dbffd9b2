// From the log to stages: the newest good snapshot, and the turns that the log has after it. Used at start,
// after an append that the log refused, and to make a past graph again. One thread; nothing is shared with
// others but the log.
#ifndef DOCENT_KB_SERVER_WRITER_RECOVERY_H_
#define DOCENT_KB_SERVER_WRITER_RECOVERY_H_

#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/log/context_log.h"
#include "kb_server/writer/server_state.h"

namespace docent::server {

// The state from which to replay to reach offset `target`: that of the newest good snapshot at or before it,
// or the empty one. A snapshot that is damaged is told to people (spdlog) and the one before it taken.
// Errors: OUT_OF_RANGE where the records that follow are no longer all there, else those of the log; they
// name the snapshot.
absl::StatusOr<RestoredState> FindStart(log::ContextLog* log, uint64_t target, Dictionary* dictionary,
                                        const sparql::FunctionRegistry* functions, const Limits& limits);

// Called after each turn of a replay; `record_bytes`: of its record. An error ends the replay.
using ReplayedTurn = std::function<absl::Status(TurnResult result, size_t record_bytes)>;

// Does the turns `from` … `to` of the log again on `stages`, which stand after turn from - 1, and freezes the
// last version. Each must decide what the log says that it decided. DATA_LOSS naming the offset where the log
// is damaged, refuses its own input, or this engine version decides otherwise than it did before;
// FAILED_PRECONDITION where another engine version has decided otherwise.
absl::Status ReplayTurns(log::ContextLog* log, uint64_t from, uint64_t to, Stages* stages,
                         const ReplayedTurn& done);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_RECOVERY_H_
