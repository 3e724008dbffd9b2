#include "graph/log/sqlite_schema.h"

#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/log/data_folder.h"

namespace docent::log {
namespace {

// The value of a statement that returns one integer.
absl::StatusOr<uint64_t> OneInteger(sqlite3* db, const char* sql) {
  absl::StatusOr<Statement> statement = Statement::Prepare(db, sql);
  if (!statement.ok()) return statement.status();
  const absl::StatusOr<bool> row = statement->Step("cannot read the log's format");
  if (!row.ok()) return row.status();
  if (!*row) return absl::DataLossError(absl::StrCat("the log is damaged: no answer to ", sql));
  return statement->Integer(0);
}

std::string HexBlob(const ChainHash& hash) {
  const std::string_view bytes = AsBytes(hash);
  return absl::StrCat("x'", absl::BytesToHexString({bytes.data(), bytes.size()}), "'");
}

absl::Status MakeTables(sqlite3* db, const HeadRow& start) {
  absl::Status status =
      Execute(db,
              absl::StrCat(
                  "BEGIN IMMEDIATE;"
                  "CREATE TABLE ctxlog(seq INTEGER PRIMARY KEY, epoch INTEGER NOT NULL, crc INTEGER NOT NULL,"
                  " prev_hash BLOB NOT NULL, data BLOB NOT NULL);"
                  "CREATE TABLE head(seq INTEGER NOT NULL, epoch INTEGER NOT NULL, hash BLOB NOT NULL,"
                  " base_seq INTEGER NOT NULL, base_hash BLOB NOT NULL, crc INTEGER NOT NULL);"
                  "INSERT INTO head VALUES(",
                  start.offset, ", ", start.epoch, ", ", HexBlob(start.hash), ", ", start.base_offset, ", ",
                  HexBlob(start.base_hash), ", ", start.Crc(), "); PRAGMA application_id=", kLogApplicationId,
                  "; PRAGMA user_version=", kLogFormat, "; COMMIT"),
              "cannot make the log");
  return status;
}

// The format marks of a database file.
struct Marks {
  uint64_t tables = 0;
  uint64_t application = 0;
  uint64_t format = 0;
};

absl::StatusOr<Marks> ReadMarks(sqlite3* db) {
  const absl::StatusOr<uint64_t> tables = OneInteger(db, "SELECT count(*) FROM sqlite_master");
  if (!tables.ok()) return tables.status();
  const absl::StatusOr<uint64_t> application = OneInteger(db, "PRAGMA application_id");
  if (!application.ok()) return application.status();
  const absl::StatusOr<uint64_t> format = OneInteger(db, "PRAGMA user_version");
  if (!format.ok()) return format.status();
  return Marks{*tables, *application, *format};
}

absl::StatusOr<DatabaseHandle> OpenToRead(const std::string& name, int flags) {
  sqlite3* raw = nullptr;
  const int code =
      sqlite3_open_v2(name.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | flags, nullptr);
  DatabaseHandle db(raw);
  if (code != SQLITE_OK) return SqliteError(raw, code, absl::StrCat("cannot open the log ", name));
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, 10000);
  return db;
}

// True if no write-ahead log beside the database file `path` holds data, and no server runs.
bool IsAllOfTheLog(const std::string& path) {
  std::error_code absent;
  const uint64_t bytes = std::filesystem::file_size(absl::StrCat(path, "-wal"), absent);
  return (absent || bytes == 0) && !DataFolder::InUse(std::filesystem::path(path).parent_path().string());
}

// The URI by which SQLite opens a file that no process changes (https://www.sqlite.org/uri.html).
std::string AsImmutable(const std::string& path) {
  return absl::StrCat("file:", path.starts_with('/') ? "//" : "",
                      absl::StrReplaceAll(path, {{"%", "%25"}, {"?", "%3f"}, {"#", "%23"}}), "?immutable=1");
}

bool ReadHash(const Statement& row, int column, ChainHash* hash) {
  if (!row.IsBytes(column) || row.Bytes(column).size() != hash->size()) return false;
  std::memcpy(hash->data(), row.Bytes(column).data(), hash->size());
  return true;
}

}  // namespace

uint32_t HeadRow::Crc() const {
  return Crc32c().Add(offset).Add(epoch).Add(AsBytes(hash)).Add(base_offset).Add(AsBytes(base_hash)).value();
}

absl::StatusOr<DatabaseHandle> OpenReadOnly(const std::string& path) {
  absl::StatusOr<DatabaseHandle> db = OpenToRead(path, 0);
  if (!db.ok()) return db;
  const std::string what = absl::StrCat("cannot read the log ", path);
  const absl::Status read = Execute(db->get(), "PRAGMA schema_version", what);
  const bool no_room = absl::IsResourceExhausted(read);
  if (!no_room && !absl::IsPermissionDenied(read)) return db;  // later reads find the damage
  // SQLite reads beside a write-ahead log only if it can create an index file for that log. If there is no
  // such log and no process would begin one, the database file is complete.
  if (IsAllOfTheLog(path)) return OpenToRead(AsImmutable(path), SQLITE_OPEN_URI);
  if (no_room) return read;
  return absl::PermissionDeniedError(absl::StrCat(
      std::string(read.message()), ": this cannot be written, and ", path,
      "-wal may have records that are not carried over; copy the folder to where it can be written"));
}

absl::StatusOr<DatabaseHandle> OpenConnection(const std::string& path) {
  CreateDatabaseFile(path);
  sqlite3* raw = nullptr;
  // A mutex of ours guards each connection.
  const int code = sqlite3_open_v2(path.c_str(), &raw,
                                   SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  DatabaseHandle db(raw);
  const std::string what = absl::StrCat("cannot open the log ", path);
  if (code != SQLITE_OK) return SqliteError(raw, code, what);
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_busy_timeout(raw, 10000);  // ms; only our own connections compete, briefly
  const absl::Status status =
      Execute(raw,
              "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA wal_autocheckpoint=0;"
              "PRAGMA cell_size_check=ON; PRAGMA trusted_schema=OFF; PRAGMA foreign_keys=OFF",
              what);
  if (!status.ok()) return status;
  return db;
}

absl::Status PrepareSchema(sqlite3* db, const std::string& path, const HeadRow& start) {
  const absl::StatusOr<Marks> marks = ReadMarks(db);
  if (!marks.ok()) return marks.status();
  if (marks->tables == 0 && marks->application == 0 && marks->format == 0) return MakeTables(db, start);
  return CheckFormat(db, path);
}

absl::Status CheckFormat(sqlite3* db, const std::string& path) {
  const absl::StatusOr<Marks> marks = ReadMarks(db);
  if (!marks.ok()) return marks.status();
  if (marks->application != kLogApplicationId) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, " is not a Docent log (application id ", marks->application, ")"));
  }
  if (marks->format > kLogFormat) {
    return absl::FailedPreconditionError(
        absl::StrCat("the log ", path, " has format ", marks->format,
                     ", written by a newer Docent; this one knows formats up to ", kLogFormat,
                     ": start the newer version"));
  }
  if (marks->format == 0)
    return absl::DataLossError(absl::StrCat("the log ", path, " is damaged: it has no format number"));
  return absl::OkStatus();
}

absl::StatusOr<HeadRow> ReadHead(sqlite3* db) {
  absl::StatusOr<Statement> row =
      Statement::Prepare(db, "SELECT seq, epoch, hash, base_seq, base_hash, crc FROM head");
  if (!row.ok()) return row.status();
  const absl::StatusOr<bool> found = row->Step("cannot read the log's head");
  if (!found.ok()) return found.status();
  HeadRow head;
  const bool whole = *found && row->IsInteger(0) && row->IsInteger(1) && ReadHash(*row, 2, &head.hash) &&
                     row->IsInteger(3) && ReadHash(*row, 4, &head.base_hash) && row->IsInteger(5);
  if (whole) {
    head.offset = row->Integer(0);
    head.epoch = row->Integer(1);
    head.base_offset = row->Integer(3);
  }
  if (!whole || row->Integer(5) != head.Crc()) return absl::DataLossError("the log's head row is damaged");
  return head;
}

}  // namespace docent::log
