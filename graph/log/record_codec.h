// Encoding of TurnRecord as the bytes in the log (record.proto): each distinct term of a record is written
// once and then named by its number, so a batch of poses of one robot costs a few bytes a quad. Any thread.
#ifndef DOCENT_GRAPH_LOG_RECORD_CODEC_H_
#define DOCENT_GRAPH_LOG_RECORD_CODEC_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/log/turn_record.h"

namespace docent::log {

// The format version that this code writes, and the newest that it reads (record.proto, Turn.min_reader).
inline constexpr uint32_t kRecordReader = 3;

// `record.offset` is not encoded: the log assigns it. INVALID_ARGUMENT if the record would be larger than 2
// GiB, the maximum size of a protobuf message.
absl::StatusOr<std::string> EncodeTurnRecord(const TurnRecord& record);

// Decodes bytes that `EncodeTurnRecord` made and fills in `offset`. DATA_LOSS naming the offset if the bytes
// are no record; FAILED_PRECONDITION if a newer Docent wrote a record that this version would misread. Never
// crashes, whatever the bytes.
absl::StatusOr<TurnRecord> DecodeTurnRecord(uint64_t offset, std::string_view data);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_RECORD_CODEC_H_
