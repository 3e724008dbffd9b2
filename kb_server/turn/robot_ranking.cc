#include "kb_server/turn/robot_ranking.h"

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/turn/default_robot_order.h"
#include "workflow/cawl/robot_choice.h"

namespace docent::server {
namespace {

// Queries that are kept prepared; then all are prepared again.
constexpr size_t kPreparedAtMost = 200;
// Rows that are looked at.
constexpr size_t kRowsAtMost = 10000;

bool Mentions(const std::string& text, const std::string& variable) {
  for (size_t at = text.find(variable); at != std::string::npos; at = text.find(variable, at + 1)) {
    const size_t end = at + variable.size();
    const bool ends = end == text.size() || !(absl::ascii_isalnum(text[end]) || text[end] == '_');
    if (at > 0 && (text[at - 1] == '?' || text[at - 1] == '$') && ends) return true;
  }
  return false;
}

}  // namespace

void GraphRobotRanking::BeginRound(const GraphVersion& version, TimeMicros now_us,
                                   Cancellation* cancellation) {
  version_ = &version;
  now_us_ = now_us;
  cancellation_ = cancellation;
}

sparql::PreparedQuery* GraphRobotRanking::Prepared(const Key& key) const {
  if (prepared_.size() >= kPreparedAtMost && !prepared_.contains(key)) prepared_.clear();
  const auto [entry, is_new] = prepared_.try_emplace(key);
  if (!is_new) return entry->second.get();
  cawl::ParsedChoice parsed = cawl::ParseRobotChoice(key.first, limits_);
  if (HasErrors(parsed.diagnostics)) return nullptr;
  sparql::PrepareOptions options;
  options.bound = key.second;
  options.functions = functions_;
  auto prepared = sparql::PreparedQuery::Prepare(std::move(parsed.query), dictionary_, options);
  if (prepared.ok()) entry->second = *std::move(prepared);
  return entry->second.get();
}

std::vector<RobotId> GraphRobotRanking::Order(const std::string& select, std::vector<RobotId> able,
                                              const engine::TermBinding& values) const {
  if (able.size() < 2 || version_ == nullptr) return able;
  if (!select.empty()) return OrderByQuery(select, std::move(able), values);
  const auto goal = values.find("goal");
  const std::optional<TermId> place = goal == values.end() ? std::nullopt : dictionary_.Find(goal->second);
  if (auto ordered = DefaultRobotOrder(*version_, dictionary_, place, able)) return *std::move(ordered);
  return OrderByQuery(std::string(cawl::DefaultRobotChoice()), std::move(able), values);
}

std::vector<RobotId> GraphRobotRanking::OrderByQuery(const std::string& select, std::vector<RobotId> able,
                                                     const engine::TermBinding& values) const {
  Key key{select, {}};
  std::vector<TermId> bound;
  for (const auto& [name, value] : values) {
    if (name == "robot" || !Mentions(select, name)) continue;
    std::optional<TermId> id = dictionary_.Find(value);
    if (!id) id = dictionary_.FindIri(kRdfType);  // the graph says nothing of it, nor of this as a thing
    if (!id) continue;
    key.second.push_back(name);
    bound.push_back(*id);
  }
  sparql::PreparedQuery* query = Prepared(key);
  if (query == nullptr) return able;
  const std::vector<std::string>& columns = query->variables();
  const auto robot = std::find(columns.begin(), columns.end(), "robot");
  if (robot == columns.end()) return able;
  const size_t column = static_cast<size_t>(robot - columns.begin());
  std::vector<RobotId> ordered;
  size_t rows = 0;
  const absl::Status status =
      query->Select({version_, cancellation_, now_us_, 0}, bound, [&](absl::Span<const TermId> row) {
        if (!row[column].IsNone()) {
          const auto found = std::find(able.begin(), able.end(), RobotId(query->Decode(row[column]).lexical));
          if (found != able.end()) {
            ordered.push_back(*found);
            able.erase(found);
          }
        }
        return !able.empty() && ++rows < kRowsAtMost;
      });
  query->Stop();
  // After an error the order is that of the IRIs, as without a query.
  if (!status.ok()) {
    able.insert(able.end(), ordered.begin(), ordered.end());
    std::sort(able.begin(), able.end());
    return able;
  }
  ordered.insert(ordered.end(), able.begin(), able.end());
  return ordered;
}

}  // namespace docent::server
