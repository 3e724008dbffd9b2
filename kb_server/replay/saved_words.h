// The words of saved runs for kinds and outcomes. Part of the format: a word never changes its meaning. Private to this folder.
#ifndef DOCENT_KB_SERVER_REPLAY_SAVED_WORDS_H_
#define DOCENT_KB_SERVER_REPLAY_SAVED_WORDS_H_

#include <optional>
#include <string>

#include "graph/store/write_batch.h"

namespace docent::server {

std::string WordOf(Document::Kind kind);
std::string WordOf(CommandReport::Outcome outcome);
std::string WordOf(RunRequest::Kind kind);

// nullopt: no word of these.
template <typename Value>
std::optional<Value> ValueOfWord(const std::string& word);
template <>
std::optional<Document::Kind> ValueOfWord(const std::string& word);
template <>
std::optional<CommandReport::Outcome> ValueOfWord(const std::string& word);
template <>
std::optional<RunRequest::Kind> ValueOfWord(const std::string& word);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_SAVED_WORDS_H_
