#include "kb_server/door/history_port.h"

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/sparql/values/time_text.h"
#include "kb_server/door/ports.h"

namespace docent::server {

absl::StatusOr<AsOf> ParseAsOf(const std::string& text) {
  uint64_t revision = 0;
  if (std::all_of(text.begin(), text.end(), absl::ascii_isdigit) && absl::SimpleAtoi(text, &revision)) {
    return AsOf(Revision(revision));
  }
  if (const std::optional<sparql::ZonedTime> time = sparql::ParseDateTimeText(text)) {
    return AsOf(time->local_us - TimeMicros{time->zone_minutes.value_or(0)} * 60'000'000);
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "as-of must be a revision number or a time like 2026-01-31T12:00:00Z, not \"", text, "\""));
}

std::optional<TimeMicros> TimeAsOf(const std::string& text) {
  const absl::StatusOr<AsOf> when = ParseAsOf(text);
  if (!when.ok() || !std::holds_alternative<TimeMicros>(*when)) return std::nullopt;
  return std::get<TimeMicros>(*when);
}

absl::StatusOr<QueryGraph> GraphForQuery(const ReadPorts& ports, const std::string& as_of,
                                         Cancellation* cancellation) {
  if (!as_of.empty()) {
    const absl::StatusOr<AsOf> when = ParseAsOf(as_of);
    if (!when.ok()) return when.status();
    if (ports.history == nullptr) return absl::UnimplementedError("this server keeps no history");
    return ports.history->At(*when, cancellation);
  }
  // the server's dictionary outlives all queries
  return QueryGraph{std::shared_ptr<const Dictionary>(std::shared_ptr<void>(), ports.dictionary),
                    ports.queries->Newest()};
}

}  // namespace docent::server
