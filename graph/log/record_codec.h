// TurnRecord ↔ the bytes that the log keeps (record.proto): each distinct term of a record is written once
// and named by number, so a batch of poses of one robot costs a few bytes a quad. Any thread.
#ifndef DOCENT_GRAPH_LOG_RECORD_CODEC_H_
#define DOCENT_GRAPH_LOG_RECORD_CODEC_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/log/turn_record.h"

namespace docent::log {

// What this code writes, and the newest that it can read (record.proto, Turn.min_reader).
inline constexpr uint32_t kRecordReader = 1;

// `record.offset` is not part of the bytes: the log gives it. INVALID_ARGUMENT when the record would be
// larger than 2 GiB, the most that one protobuf message can hold.
absl::StatusOr<std::string> EncodeTurnRecord(const TurnRecord& record);

// The record that `EncodeTurnRecord` made these bytes of, with `offset` filled in. DATA_LOSS naming the
// offset for bytes that are no record; FAILED_PRECONDITION for a record that a newer Docent wrote and this
// one must not misread. Never crashes, whatever the bytes.
absl::StatusOr<TurnRecord> DecodeTurnRecord(uint64_t offset, std::string_view data);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_RECORD_CODEC_H_
