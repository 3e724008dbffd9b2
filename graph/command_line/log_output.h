// The log of a program: lines on standard error. What others sent in cannot forge a line, control a terminal or fill a disk.
#ifndef DOCENT_GRAPH_COMMAND_LINE_LOG_OUTPUT_H_
#define DOCENT_GRAPH_COMMAND_LINE_LOG_OUTPUT_H_

#include <spdlog/sinks/sink.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace docent {

// The text as a part of one line: control characters and other hidden ones (graph/rdf/hidden_character.h) as \n, \x1b or
// \u202e, bytes that are not UTF-8 as \xff.
std::string LogText(std::string_view text);

// Makes the default logger of the program: on standard error, with LogText and LimitedSink. `pattern`: spdlog's; empty: its own.
void UseLogOutput(const std::string& name, const std::string& pattern);

// Passes on to another sink each line as LogText, and of warnings and messages at most so many in a time; the others are
// counted, and their number is told when the time is over and another line comes. Errors pass always. Thread-safe.
class LimitedSink final : public spdlog::sinks::sink {
 public:
  using Clock = std::chrono::steady_clock;
  struct Limit {
    size_t lines = 200;
    std::chrono::milliseconds time{10000};
  };
  LimitedSink(std::shared_ptr<spdlog::sinks::sink> to, const Limit& limit,
              std::function<Clock::time_point()> now = Clock::now);
  void log(const spdlog::details::log_msg& message) override;
  void flush() override { to_->flush(); }
  void set_pattern(const std::string& pattern) override { to_->set_pattern(pattern); }
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override {
    to_->set_formatter(std::move(formatter));
  }

 private:
  void Pass(const spdlog::details::log_msg& like, spdlog::level::level_enum level, const std::string& text);

  const std::shared_ptr<spdlog::sinks::sink> to_;
  const Limit limit_;
  const std::function<Clock::time_point()> now_;
  std::mutex mutex_;
  Clock::time_point since_;
  size_t lines_ = 0;
  size_t left_out_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_COMMAND_LINE_LOG_OUTPUT_H_
