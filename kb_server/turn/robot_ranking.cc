#include "kb_server/turn/robot_ranking.h"

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "graph/rdf/vocabulary.h"
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

void GraphRobotRanking::BeginRound(const GraphVersion& version, std::initializer_list<const Delta*> deltas,
                                   TimeMicros now_us, Cancellation* cancellation) {
  for (const Delta* delta : deltas) default_.Refresh(*delta);
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

RobotId GraphRobotRanking::Best(const std::string& select, const std::vector<RobotId>& able,
                                const engine::TermBinding& values) const {
  if (able.size() < 2 || version_ == nullptr) return able.front();
  if (!select.empty()) return BestByQuery(select, able, values);
  const auto goal = values.find("goal");
  const std::optional<TermId> place = goal == values.end() ? std::nullopt : dictionary_.Find(goal->second);
  if (std::optional<RobotId> best = default_.Best(*version_, place, able)) return *std::move(best);
  return BestByQuery(std::string(cawl::DefaultRobotChoice()), able, values);
}

RobotId GraphRobotRanking::BestByQuery(const std::string& select, const std::vector<RobotId>& able,
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
  if (query == nullptr) return able.front();
  const std::vector<std::string>& columns = query->variables();
  const auto robot = std::find(columns.begin(), columns.end(), "robot");
  if (robot == columns.end()) return able.front();
  const size_t column = static_cast<size_t>(robot - columns.begin());
  std::optional<RobotId> best;
  size_t rows = 0;
  const absl::Status status =
      query->Select({version_, cancellation_, now_us_, 0}, bound, [&](absl::Span<const TermId> row) {
        if (!row[column].IsNone()) {
          RobotId named(query->Decode(row[column]).lexical);
          if (std::find(able.begin(), able.end(), named) != able.end()) best = std::move(named);
        }
        return !best && ++rows < kRowsAtMost;
      });
  query->Stop();
  // After an error the first by its IRI, as without a query.
  if (!status.ok()) return *std::min_element(able.begin(), able.end());
  return best ? *std::move(best) : able.front();
}

}  // namespace docent::server
