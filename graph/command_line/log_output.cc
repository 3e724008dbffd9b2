#include "graph/command_line/log_output.h"

#include <spdlog/details/log_msg.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/str_format.h"
#include "graph/rdf/hidden_character.h"
#include "graph/rdf/utf8_text.h"

namespace docent {
namespace {

std::string Escaped(char32_t c) {
  if (c == '\n') return "\\n";
  if (c == '\t') return "\\t";
  if (c < 0x100) return absl::StrFormat("\\x%02x", static_cast<unsigned>(c));
  return absl::StrFormat(c < 0x10000 ? "\\u%04x" : "\\U%08x", static_cast<unsigned>(c));
}

}  // namespace

std::string LogText(std::string_view text) {
  std::string out;
  ForEachCharacter(
      text,
      [&out](char32_t c, std::string_view bytes) {
        out += IsHiddenCharacter(c) ? Escaped(c) : std::string(bytes);
      },
      [&out](unsigned char byte) { out += absl::StrFormat("\\x%02x", byte); });
  return out;
}

void UseLogOutput(const std::string& name, const std::string& pattern) {
  auto sink = std::make_shared<LimitedSink>(std::make_shared<spdlog::sinks::stderr_color_sink_mt>(),
                                            LimitedSink::Limit{});
  if (!pattern.empty()) sink->set_pattern(pattern);
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(name, std::move(sink)));
}

LimitedSink::LimitedSink(std::shared_ptr<spdlog::sinks::sink> to, const Limit& limit,
                         std::function<Clock::time_point()> now)
    : to_(std::move(to)), limit_(limit), now_(std::move(now)), since_(now_()) {}

void LimitedSink::log(const spdlog::details::log_msg& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Clock::time_point now = now_();
  if (now - since_ >= limit_.time) {
    if (left_out_ > 0)
      Pass(message, spdlog::level::warn,
           absl::StrFormat("%u lines were left out: too many came at once", left_out_));
    since_ = now;
    lines_ = left_out_ = 0;
  }
  if (message.level < spdlog::level::err && ++lines_ > limit_.lines) {
    ++left_out_;
    return;
  }
  Pass(message, message.level, LogText({message.payload.data(), message.payload.size()}));
}

void LimitedSink::Pass(const spdlog::details::log_msg& like, spdlog::level::level_enum level,
                       const std::string& text) {
  spdlog::details::log_msg line = like;
  line.level = level;
  line.payload = spdlog::string_view_t(text.data(), text.size());
  to_->log(line);
}

}  // namespace docent
