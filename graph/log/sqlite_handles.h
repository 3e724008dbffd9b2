// SQLite's C handles as owned C++ values, and its result codes as statuses. Only graph/log includes this.
#ifndef DOCENT_GRAPH_LOG_SQLITE_HANDLES_H_
#define DOCENT_GRAPH_LOG_SQLITE_HANDLES_H_

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace docent::log {

struct CloseDatabase {
  void operator()(sqlite3* db) const { sqlite3_close_v2(db); }
};
using DatabaseHandle = std::unique_ptr<sqlite3, CloseDatabase>;

// The status of result code `code` while doing `what`: RESOURCE_EXHAUSTED for a full disk, DATA_LOSS for a
// damaged file, PERMISSION_DENIED, UNAVAILABLE for I/O errors and locks, else INTERNAL.
absl::Status SqliteError(sqlite3* db, int code, const std::string& what);

// Creates the file of a new database, readable only by its owner and group (SQLite would let all users read
// it). An existing file stays as it is. Errors appear when the database is opened.
void CreateDatabaseFile(const std::string& path);

// Runs statements without results ("PRAGMA …; CREATE …").
absl::Status Execute(sqlite3* db, const std::string& sql, const std::string& what);

// A prepared statement for repeated use. One thread at a time.
class Statement {
 public:
  Statement() = default;
  static absl::StatusOr<Statement> Prepare(sqlite3* db, const char* sql);

  // Parameters count from 1. Bytes are not copied: they must stay valid until Reset.
  Statement& Bind(int index, uint64_t value);
  Statement& Bind(int index, std::string_view bytes);

  // Steps to the next row: true if there is one, false at the end.
  absl::StatusOr<bool> Step(const std::string& what);
  // Runs to the end, expecting no rows, and resets.
  absl::Status Run(const std::string& what);
  void Reset();

  // Columns of the current row count from 0. Views live until the next Step or Reset.
  uint64_t Integer(int column) const;
  std::string_view Bytes(int column) const;
  std::string_view Text(int column) const;
  // A wrong type is a sign of damage: callers check before they read.
  bool IsInteger(int column) const;
  bool IsBytes(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_SQLITE_HANDLES_H_
