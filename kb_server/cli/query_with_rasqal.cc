#include "kb_server/cli/query_with_rasqal.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "graph/base/limits.h"
#include "graph/redland/client_store.h"
#include "graph/redland/rasqal_engine.h"
#include "graph/redland/rasqal_guard.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "kb_server/cli/answer_printer.h"
#include "kb_server/cli/client.h"

namespace docent::server {
namespace {

constexpr auto kGrace = std::chrono::seconds(5);

// Ends the process if it lives longer than the time that Rasqal has: what it does between two triples cannot
// be interrupted.
class Watchdog {
 public:
  explicit Watchdog(std::chrono::milliseconds timeout)
      : thread_([this, timeout] {
          if (ended_.WaitForNotificationWithTimeout(absl::FromChrono(timeout + kGrace))) return;
          std::cerr << "docent: evaluation stopped at its limit query_timeout_ms = " << timeout.count()
                    << "; Rasqal did not end by itself\n";
          std::_Exit(kExitBad);
        }) {}
  ~Watchdog() {
    ended_.Notify();
    thread_.join();
  }

 private:
  absl::Notification ended_;
  std::thread thread_;
};

struct GraphCopy {
  Dictionary dictionary;
  GraphVersionPtr version;
};

absl::StatusOr<std::unique_ptr<GraphCopy>> CopyGraph(const std::string& address, const Limits& limits) {
  auto client = redland::ClientStore::Open(address, absl::StrCat("query-", getpid()), limits);
  if (!client.ok()) return client.status();
  auto quads = (*client)->FindAtMost({}, limits.rasqal_quads, "rasqal_quads");
  if (!quads.ok()) return quads.status();
  auto copy = std::make_unique<GraphCopy>();
  std::vector<Quad> ids;
  ids.reserve(quads->size());
  for (const TermQuad& quad : *quads) {
    ids.push_back({copy->dictionary.Intern(quad.subject), copy->dictionary.Intern(quad.predicate),
                   copy->dictionary.Intern(quad.object), copy->dictionary.Intern(quad.graph)});
  }
  GraphWriter writer(nullptr);
  writer.AddAll(std::move(ids));
  copy->version = writer.Freeze((*client)->revision());
  return copy;
}

int Print(redland::RasqalAnswer answer, const std::string& format, const Presenter& presenter,
          uint64_t revision) {
  AnswerPrinter printer(format, presenter);
  switch (answer.form) {
    case sparql::Query::Form::kAsk:
      printer.Boolean(answer.boolean);
      break;
    case sparql::Query::Form::kSelect:
      printer.Begin(std::move(answer.variables));
      for (const auto& row : answer.rows) printer.Row(row);
      break;
    default:
      for (TermQuad& triple : answer.triples) printer.Triple(std::move(triple));
  }
  return printer.End(revision);
}

}  // namespace

int QueryWithRasqal(const std::string& query, const std::string& address, const std::string& format,
                    const Presenter& presenter, uint32_t timeout_ms) {
  const Limits limits;
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  sparql::ParsedQuery parsed = sparql::ParseQuery(query, options);
  if (!parsed.ok()) return Fail(ToStatus(parsed.diagnostics, query));
  if (absl::Status status = redland::CheckForRasqal(parsed.query, limits); !status.ok()) return Fail(status);
  auto copy = CopyGraph(address, limits);
  if (!copy.ok()) return Fail(copy.status());

  const std::chrono::milliseconds timeout(
      timeout_ms > 0 ? std::min<int64_t>(timeout_ms, limits.query_timeout_ms) : limits.query_timeout_ms);
  Cancellation cancellation(timeout);
  absl::StatusOr<redland::RasqalAnswer> answer;
  {
    const Watchdog watchdog(timeout);
    answer = redland::RunRasqal(parsed.query, (*copy)->dictionary, (*copy)->version, &cancellation, limits);
  }
  if (!answer.ok()) return Fail(answer.status());
  return Print(*std::move(answer), format, presenter, (*copy)->version->revision().value());
}

}  // namespace docent::server
