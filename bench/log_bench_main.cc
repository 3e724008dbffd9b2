// docent_log_bench [SECONDS] [FOLDER]: how many records a second the durable log takes, by records per
// transaction, beside the same disk's bare write + fdatasync of the same bytes (the floor: no log can commit
// faster). Every commit is one fdatasync. Records are those of a robot's pose update, encoded as the server
// does.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "graph/log/record_codec.h"
#include "graph/log/sqlite_log.h"

namespace docent {
namespace {

using Steady = std::chrono::steady_clock;

TurnRecord PoseRecord(int i) {
  const Term robot = Term::Iri("https://w3id.org/docent/expo#R01");
  const auto decimal = [](int thousandths) {
    return Term{TermKind::kLiteral,
                std::to_string(thousandths / 1000) + "." + std::to_string(thousandths % 1000),
                "http://www.w3.org/2001/XMLSchema#decimal", ""};
  };
  TurnRecord record;
  record.time_us = 1800000000000000 + i * 100000;
  record.engine_version = "0.1.0";
  record.batch.source = "urn:docent:source:R01";
  record.batch.time_us = record.time_us;
  for (const char* property : {"x", "y", "heading"}) {
    record.batch.operations.push_back({QuadOperation::Kind::kAdd,
                                       {robot, Term::Iri(std::string("https://w3id.org/docent#") + property),
                                        decimal(12345 + i % 9000), Term{}}});
  }
  return record;
}

struct Figures {
  double records_per_second;
  double p50_us, p99_us, max_us;
};

// Calls `commit` again and again for `seconds`; it returns false when it fails.
Figures Measure(double seconds, size_t records_per_commit, const std::function<bool()>& commit) {
  std::vector<double> times_us;
  const auto start = Steady::now();
  auto before = start;
  while (before - start < std::chrono::duration<double>(seconds)) {
    if (!commit()) std::exit(1);
    const auto after = Steady::now();
    times_us.push_back(std::chrono::duration<double, std::micro>(after - before).count());
    before = after;
  }
  const double elapsed = std::chrono::duration<double>(before - start).count();
  std::sort(times_us.begin(), times_us.end());
  const auto at = [&](double share) { return times_us[static_cast<size_t>(share * (times_us.size() - 1))]; };
  return {static_cast<double>(times_us.size() * records_per_commit) / elapsed, at(0.5), at(0.99),
          times_us.back()};
}

void Print(const char* system, size_t records, const Figures& f) {
  std::printf("%-16s %8zu %12.0f %10.0f %10.0f %10.0f\n", system, records, f.records_per_second, f.p50_us,
              f.p99_us, f.max_us);
  std::fflush(stdout);
}

int Main(double seconds, const std::string& folder) {
  std::string bytes = *EncodeTurnRecord(PoseRecord(1));
  std::printf("one record: %zu bytes; %.0f s a line\n", bytes.size(), seconds);
  std::printf("%-16s %8s %12s %10s %10s %10s\n", "system", "records", "records/s", "p50 us", "p99 us",
              "max us");
  for (const size_t per_commit : {1u, 10u, 100u, 1000u}) {
    std::filesystem::remove_all(folder);
    {
      auto log = SqliteLog::Open(folder);
      if (!log.ok()) {
        std::fprintf(stderr, "%s\n", std::string(log.status().message()).c_str());
        return 2;
      }
      uint64_t head = 0;
      int i = 0;
      Print("docent log", per_commit, Measure(seconds, per_commit, [&] {
              std::vector<std::string> records(per_commit);
              for (std::string& record : records) record = *EncodeTurnRecord(PoseRecord(++i));
              const auto result = (*log)->Append(records, 1, head);
              if (result.ok()) head = result->head.offset;
              return result.ok();
            }));
      const auto start = Steady::now();
      uint64_t next = 1;
      while (next <= head) {
        const auto entries = (*log)->Read(next, 10000);
        if (!entries.ok()) return 1;
        for (const LogEntry& entry : *entries) {
          if (!DecodeTurnRecord(entry.offset, entry.data).ok()) return 1;
        }
        next += entries->size();
      }
      const double elapsed = std::chrono::duration<double>(Steady::now() - start).count();
      std::printf("%-16s %8zu %12.0f   (read, verified and decoded)\n", "  replay", per_commit,
                  static_cast<double>(head) / elapsed);
    }
    FileHandle file(open((folder + "/plain").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0640));
    const std::string block(bytes.size() * per_commit, 'x');
    Print("write+fdatasync", per_commit, Measure(seconds, per_commit, [&] {
            return write(file.fd(), block.data(), block.size()) == static_cast<ssize_t>(block.size()) &&
                   fdatasync(file.fd()) == 0;
          }));
  }
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace
}  // namespace docent

int main(int argc, char** argv) {
  if (argc > 3 || (argc > 1 && argv[1][0] == '-')) {
    std::fprintf(stderr,
                 "usage: docent_log_bench [SECONDS] [FOLDER]\nThe log is made in FOLDER/docent_log_bench and "
                 "removed.\n");
    return 2;
  }
  const double seconds = argc > 1 ? std::atof(argv[1]) : 2;
  const std::filesystem::path parent = argc > 2 ? argv[2] : std::filesystem::temp_directory_path();
  return docent::Main(seconds, (parent / "docent_log_bench").string());
}
