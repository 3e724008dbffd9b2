#include "kb_server/replay/saved_words.h"

#include <array>
#include <cstddef>

namespace docent::server {
namespace {

// In the order of the values.
constexpr std::array kDocuments = {"ontology", "rules", "workflow", "services"};
constexpr std::array kOutcomes = {"accepted", "progress",    "succeeded", "failed",   "cancelled",
                                  "unknown",  "unreachable", "refused",   "not begun"};
constexpr std::array kRequests = {"start",     "cancel",         "invoke service",  "pause",
                                  "resume",    "pause workflow", "resume workflow", "retry node",
                                  "skip node", "fail node",      "set variable",    "cancel commands"};
static_assert(kDocuments.size() == static_cast<size_t>(Document::Kind::kRsel) + 1);
static_assert(kOutcomes.size() == static_cast<size_t>(CommandReport::Outcome::kNotBegun) + 1);
static_assert(kRequests.size() == static_cast<size_t>(RunRequest::Kind::kCancelCommands) + 1);

template <typename Value, typename Words>
std::optional<Value> Find(const Words& words, const std::string& word) {
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == word) return static_cast<Value>(i);
  }
  return std::nullopt;
}

}  // namespace

std::string WordOf(Document::Kind kind) {
  return kDocuments[static_cast<size_t>(kind)];
}
std::string WordOf(CommandReport::Outcome outcome) {
  return kOutcomes[static_cast<size_t>(outcome)];
}
std::string WordOf(RunRequest::Kind kind) {
  return kRequests[static_cast<size_t>(kind)];
}

template <>
std::optional<Document::Kind> ValueOfWord(const std::string& word) {
  return Find<Document::Kind>(kDocuments, word);
}
template <>
std::optional<CommandReport::Outcome> ValueOfWord(const std::string& word) {
  return Find<CommandReport::Outcome>(kOutcomes, word);
}
template <>
std::optional<RunRequest::Kind> ValueOfWord(const std::string& word) {
  return Find<RunRequest::Kind>(kRequests, word);
}

}  // namespace docent::server
