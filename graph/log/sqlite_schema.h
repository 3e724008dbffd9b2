// The log's database file: tables, format number, settings. Only graph/log includes this.
//
//   ctxlog(seq, epoch, crc, prev_hash, data)           one row a record
//   head(seq, epoch, hash, base_seq, base_hash, crc)   one row: the newest record, the highest epoch,
//        the hash of the newest record, and offset and hash of the last trimmed record (0 and zeros: none)
//
// The format number is the file's user_version; its application_id marks it as a Docent log.
#ifndef DOCENT_GRAPH_LOG_SQLITE_SCHEMA_H_
#define DOCENT_GRAPH_LOG_SQLITE_SCHEMA_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/log/record_chain.h"
#include "graph/log/sqlite_handles.h"

namespace docent::log {

inline constexpr uint64_t kLogFormat = 1;
inline constexpr uint64_t kLogApplicationId = 0x646F634C;  // "docL"

// The row of table head.
struct HeadRow {
  uint64_t offset = 0;
  uint64_t epoch = 0;
  ChainHash hash{};
  uint64_t base_offset = 0;
  ChainHash base_hash{};

  uint32_t Crc() const;
};

// A read-only connection, beside another process that may write. It runs no checkpoint. A folder on a full or
// read-only disk can be read if its server shut down in order; else the error says what to do.
absl::StatusOr<DatabaseHandle> OpenReadOnly(const std::string& path);
// A connection with the settings that the log relies on (WAL, synchronous=FULL, no automatic checkpoint).
absl::StatusOr<DatabaseHandle> OpenConnection(const std::string& path);

// Creates the tables in an empty file, for a log that begins after `start`, or checks the existing tables.
// FAILED_PRECONDITION for a newer format, INVALID_ARGUMENT for a database that is not a Docent log, DATA_LOSS
// for a damaged one.
absl::Status PrepareSchema(sqlite3* db, const std::string& path, const HeadRow& start = {});

// OK if it is a log of a format that this version reads; errors as PrepareSchema.
absl::Status CheckFormat(sqlite3* db, const std::string& path);

// Reads and verifies the head row.
absl::StatusOr<HeadRow> ReadHead(sqlite3* db);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_SQLITE_SCHEMA_H_
