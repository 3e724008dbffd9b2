#include "graph/log/sqlite_handles.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"

namespace docent::log {
namespace {

bool HasNoRoom(sqlite3* db, int code) {
  if ((code & 0xFF) == SQLITE_FULL || code == SQLITE_IOERR_SHMSIZE) return true;
  if ((code & 0xFF) != SQLITE_IOERR || db == nullptr) return false;
  const int reason = sqlite3_system_errno(db);
  return reason == ENOSPC || reason == EDQUOT;
}

}  // namespace

absl::Status SqliteError(sqlite3* db, int code, const std::string& what) {
  // On a full disk SQLite cannot create the index of the write-ahead log and reports an I/O error.
  if (HasNoRoom(db, code)) {
    return OverloadError(
        absl::StrCat(what, ": ", sqlite3_errstr(SQLITE_FULL), "; make room on the disk of the data folder"));
  }
  std::string detail = sqlite3_errstr(code);
  if (db != nullptr && (sqlite3_errcode(db) & 0xFF) == (code & 0xFF)) detail = sqlite3_errmsg(db);
  const std::string message = absl::StrCat(what, ": ", detail);
  switch (code & 0xFF) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_MISMATCH:
      return absl::DataLossError(message);
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
      return absl::PermissionDeniedError(message);
    case SQLITE_IOERR:
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_NOMEM:
      return absl::UnavailableError(message);
    default:
      return absl::InternalError(message);
  }
}

void CreateDatabaseFile(const std::string& path) {
  // Opens only a new file: closing a file that SQLite has open would drop its locks.
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
  if (fd >= 0) close(fd);
}

absl::Status Execute(sqlite3* db, const std::string& sql, const std::string& what) {
  const int code = sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : SqliteError(db, code, what);
}

absl::StatusOr<Statement> Statement::Prepare(sqlite3* db, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v3(db, sql, -1, SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
  // Docent creates the tables: a statement that does not compile means that the schema is not ours.
  if (code == SQLITE_ERROR) {
    return absl::DataLossError(absl::StrCat("the log's tables are damaged: ", sqlite3_errmsg(db)));
  }
  if (code != SQLITE_OK) return SqliteError(db, code, "cannot read the log's tables");
  Statement statement;
  statement.statement_.reset(raw);
  return statement;
}

Statement& Statement::Bind(int index, uint64_t value) {
  sqlite3_bind_int64(statement_.get(), index, static_cast<int64_t>(value));
  return *this;
}

Statement& Statement::Bind(int index, std::string_view bytes) {
  sqlite3_bind_blob64(statement_.get(), index, bytes.data(), bytes.size(), SQLITE_STATIC);
  return *this;
}

absl::StatusOr<bool> Statement::Step(const std::string& what) {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  const absl::Status status = SqliteError(sqlite3_db_handle(statement_.get()), code, what);
  Reset();
  return status;
}

absl::Status Statement::Run(const std::string& what) {
  const absl::StatusOr<bool> row = Step(what);
  if (!row.ok()) return row.status();
  Reset();
  return *row ? absl::InternalError(absl::StrCat(what, ": rows where none were expected")) : absl::OkStatus();
}

void Statement::Reset() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

uint64_t Statement::Integer(int column) const {
  return static_cast<uint64_t>(sqlite3_column_int64(statement_.get(), column));
}

std::string_view Statement::Bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  return {static_cast<const char*>(data),
          static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::string_view Statement::Text(int column) const {
  const auto* text = sqlite3_column_text(statement_.get(), column);
  return {reinterpret_cast<const char*>(text),
          static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

bool Statement::IsInteger(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER;
}

bool Statement::IsBytes(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_BLOB;
}

}  // namespace docent::log
