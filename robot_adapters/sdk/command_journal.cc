#include "robot_adapters/sdk/command_journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace docent::robot {
namespace {

std::string Escape(const std::string& field) {
  std::string out;
  for (char c : field) {
    switch (c) {
      case '\\':
        out += "\\\\";
        break;
      case '\t':
        out += "\\t";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::vector<std::string> SplitLine(std::string_view line) {
  std::vector<std::string> fields(1);
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\t') {
      fields.emplace_back();
    } else if (line[i] == '\\' && i + 1 < line.size()) {
      char c = line[++i];
      fields.back() += c == 't' ? '\t' : c == 'n' ? '\n' : c == 'r' ? '\r' : c;
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

std::string JoinLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) absl::StrAppend(&line, line.empty() ? "" : "\t", Escape(field));
  return line + "\n";
}

std::string_view NameOf(CommandOutcome outcome) {
  switch (outcome) {
    case CommandOutcome::kSucceeded:
      return "succeeded";
    case CommandOutcome::kFailed:
      return "failed";
    case CommandOutcome::kCancelled:
      return "cancelled";
  }
  return "failed";
}

std::string_view NameOf(TermKind kind) {
  return kind == TermKind::kIri ? "iri" : kind == TermKind::kBlank ? "blank" : "literal";
}

std::optional<Term> ReadTerm(const std::string* fields) {
  if (fields[0] == "iri") return Term::Iri(fields[1]);
  if (fields[0] == "blank") return Term::Blank(fields[1]);
  if (fields[0] != "literal") return std::nullopt;
  if (!fields[3].empty()) return Term::LangString(fields[1], fields[3]);
  return Term::Literal(fields[1], fields[2]);
}

std::vector<std::string> FinishedFields(const std::string& time, const std::string& incarnation,
                                        const std::string& command, const JournalEntry& entry) {
  std::vector<std::string> fields = {
      "finished", time, incarnation, command, std::string(NameOf(entry.outcome)), entry.message};
  for (const auto& [name, term] : entry.results) {
    for (std::string field :
         {name, std::string(NameOf(term.kind)), term.lexical, term.datatype, term.language}) {
      fields.push_back(std::move(field));
    }
  }
  return fields;
}

absl::Status SystemError(const std::string& what, const std::string& path) {
  return absl::ErrnoToStatus(errno, absl::StrCat("cannot ", what, " the command journal ", path));
}

absl::Status WriteAll(int file, std::string_view text) {
  while (!text.empty()) {
    ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return absl::ErrnoToStatus(errno, "cannot write the command journal");
    text.remove_prefix(static_cast<size_t>(n));
  }
  return absl::OkStatus();
}

// A new name in a folder is durable only when the folder is.
absl::Status SyncFolderOf(const std::string& path) {
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  int file = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return SystemError("open the folder of", path);
  int result = ::fsync(file);
  ::close(file);
  return result == 0 ? absl::OkStatus() : SystemError("synchronise the folder of", path);
}

}  // namespace

CommandJournal::CommandJournal(const Clock* clock, size_t commands_remembered)
    : clock_(clock), commands_remembered_(commands_remembered) {}

CommandJournal::~CommandJournal() {
  absl::MutexLock lock(&mutex_);
  if (file_ >= 0) ::close(file_);
}

absl::StatusOr<std::unique_ptr<CommandJournal>> CommandJournal::Open(const std::string& path,
                                                                     const Clock* clock,
                                                                     size_t commands_remembered) {
  auto journal = std::unique_ptr<CommandJournal>(new CommandJournal(clock, commands_remembered));
  if (!path.empty()) {
    if (absl::Status status = journal->Load(path); !status.ok()) return status;
  }
  std::random_device device;  // two adapters that share no journal must not get the same incarnation
  journal->incarnation_ = absl::StrFormat("%d-%08x", journal->incarnations_ + 1, device());

  absl::MutexLock lock(&journal->mutex_);
  std::string now = absl::StrCat(clock->Now());
  absl::Status status = journal->Append({"started", now, journal->incarnation_});
  for (const std::string& command : std::deque<std::string>(journal->order_)) {
    JournalEntry& entry = journal->entries_[command];
    if (!status.ok() || entry.state != JournalEntry::State::kBegun) continue;
    status = journal->Append({"lost", now, journal->incarnation_, command});
    entry.state = JournalEntry::State::kLost;
    journal->Retire(command);
  }
  if (!status.ok()) return status;
  return journal;
}

absl::Status CommandJournal::Load(const std::string& path) {
  if (auto folder = std::filesystem::path(path).parent_path(); !folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
  }
  int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) return SystemError("open", path);
  {
    absl::MutexLock lock(&mutex_);
    file_ = file;
  }
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("the command journal ", path, " is in use by another adapter; give each robot its own"));
  }
  std::ostringstream content;
  if (std::ifstream in(path, std::ios::binary); in.peek() != std::ifstream::traits_type::eof())
    content << in.rdbuf();
  const std::string text = content.str();

  size_t start = 0;
  int line = 1;
  for (size_t end; (end = text.find('\n', start)) != std::string::npos; start = end + 1, ++line) {
    absl::Status status = Apply(SplitLine(std::string_view(text).substr(start, end - start)));
    if (!status.ok()) {
      return absl::DataLossError(absl::StrCat(path, ":", line, ": ", status.message(),
                                              "; move the file away to begin a new journal"));
    }
  }
  if (start < text.size() && ::ftruncate(file, static_cast<off_t>(start)) != 0)
    return SystemError("repair", path);
  if (absl::Status status = SyncFolderOf(path); !status.ok()) return status;
  return static_cast<size_t>(line) > 8 * commands_remembered_ ? Rewrite(path) : absl::OkStatus();
}

absl::Status CommandJournal::Apply(const std::vector<std::string>& fields) {
  absl::MutexLock lock(&mutex_);
  const std::string& event = fields[0];
  if (event == "started" && fields.size() == 3) {
    int number = 0;
    if (!absl::SimpleAtoi(fields[2].substr(0, fields[2].find('-')), &number)) {
      return absl::DataLossError(absl::StrCat("\"", fields[2], "\" is not an incarnation"));
    }
    incarnations_ = number;
    return absl::OkStatus();
  }
  if (event == "begun" && fields.size() == 5) {
    JournalEntry entry;
    entry.incarnation = fields[2];
    entry.operation = fields[4];
    entries_[fields[3]] = std::move(entry);
    order_.push_back(fields[3]);
    return absl::OkStatus();
  }
  auto entry = fields.size() > 3 ? entries_.find(fields[3]) : entries_.end();
  if (event == "lost" && fields.size() == 4) {
    if (entry == entries_.end()) return absl::OkStatus();  // forgotten when the journal was shortened
    entry->second.state = JournalEntry::State::kLost;
    Retire(fields[3]);
    return absl::OkStatus();
  }
  if (event == "finished" && fields.size() >= 6 && (fields.size() - 6) % 5 == 0) {
    if (entry == entries_.end()) return absl::OkStatus();
    entry->second.state = JournalEntry::State::kFinished;
    entry->second.outcome = fields[4] == "succeeded"   ? CommandOutcome::kSucceeded
                            : fields[4] == "cancelled" ? CommandOutcome::kCancelled
                                                       : CommandOutcome::kFailed;
    entry->second.message = fields[5];
    for (size_t i = 6; i < fields.size(); i += 5) {
      std::optional<Term> term = ReadTerm(&fields[i + 1]);
      if (!term) return absl::DataLossError(absl::StrCat("\"", fields[i + 1], "\" is not a kind of term"));
      entry->second.results.emplace_back(fields[i], *std::move(term));
    }
    Retire(fields[3]);
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat("not an event of a command journal: \"", event, "\""));
}

// Writes what is still remembered to a new file and puts it in the place of the old one.
absl::Status CommandJournal::Rewrite(const std::string& path) {
  absl::MutexLock lock(&mutex_);
  const std::string temporary = path + ".new";
  int file = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) return SystemError("rewrite", path);
  std::string now = absl::StrCat(clock_->Now());
  std::string text = JoinLine({"started", now, absl::StrCat(incarnations_, "-")});
  for (const std::string& command : order_) {
    const JournalEntry& entry = entries_[command];
    text += JoinLine({"begun", now, entry.incarnation, command, entry.operation});
    if (entry.state == JournalEntry::State::kLost)
      text += JoinLine({"lost", now, entry.incarnation, command});
    if (entry.state == JournalEntry::State::kFinished) {
      text += JoinLine(FinishedFields(now, entry.incarnation, command, entry));
    }
  }
  absl::Status status = WriteAll(file, text);
  if (status.ok() && (::fsync(file) != 0 || ::flock(file, LOCK_EX | LOCK_NB) != 0 ||
                      ::rename(temporary.c_str(), path.c_str()) != 0)) {
    status = SystemError("rewrite", path);
  }
  if (!status.ok()) {
    ::close(file);
    return status;
  }
  ::close(file_);
  file_ = file;
  return SyncFolderOf(path);
}

std::optional<JournalEntry> CommandJournal::Find(const CommandId& command) const {
  absl::MutexLock lock(&mutex_);
  auto entry = entries_.find(command.value());
  if (entry == entries_.end()) return std::nullopt;
  return entry->second;
}

absl::Status CommandJournal::Begin(const CommandId& command, const std::string& operation) {
  absl::MutexLock lock(&mutex_);
  if (entries_.contains(command.value())) {
    return absl::AlreadyExistsError(absl::StrCat("command ", command.value(), " was begun before"));
  }
  absl::Status status =
      Append({"begun", absl::StrCat(clock_->Now()), incarnation_, command.value(), operation});
  if (!status.ok()) return status;
  JournalEntry entry;
  entry.incarnation = incarnation_;
  entry.operation = operation;
  entries_.emplace(command.value(), std::move(entry));
  order_.push_back(command.value());
  return absl::OkStatus();
}

absl::Status CommandJournal::Finish(const CommandId& command, CommandOutcome outcome,
                                    const std::string& message, const NamedTerms& results) {
  absl::MutexLock lock(&mutex_);
  auto found = entries_.find(command.value());
  if (found == entries_.end() || found->second.state != JournalEntry::State::kBegun) {
    return absl::FailedPreconditionError(absl::StrCat("command ", command.value(), " is not running"));
  }
  JournalEntry finished = found->second;
  finished.state = JournalEntry::State::kFinished;
  finished.outcome = outcome;
  finished.message = message;
  finished.results = results;
  absl::Status status =
      Append(FinishedFields(absl::StrCat(clock_->Now()), incarnation_, command.value(), finished));
  if (!status.ok()) return status;
  found->second = std::move(finished);
  Retire(command.value());
  return absl::OkStatus();
}

absl::Status CommandJournal::Append(const std::vector<std::string>& fields) {
  if (file_ < 0) return absl::OkStatus();
  struct stat before;
  if (::fstat(file_, &before) != 0) return absl::ErrnoToStatus(errno, "cannot look at the command journal");
  absl::Status status = WriteAll(file_, JoinLine(fields));
  if (status.ok() && ::fdatasync(file_) != 0) {
    status = absl::ErrnoToStatus(errno, "cannot synchronise the command journal");
  }
  // Half a line must not stay before the next one.
  if (!status.ok() && ::ftruncate(file_, before.st_size) != 0) {
    status = absl::ErrnoToStatus(errno, "cannot repair the command journal after a failed write");
  }
  return status;
}

void CommandJournal::Retire(const std::string& command) {
  retired_.push_back(command);
  while (retired_.size() > commands_remembered_) {
    const std::string oldest = retired_.front();
    retired_.pop_front();
    entries_.erase(oldest);
    order_.erase(std::find(order_.begin(), order_.end(), oldest));  // near the front
  }
}

}  // namespace docent::robot
