#include "graph/command_line/log_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>

namespace docent {
namespace {

using ::testing::HasSubstr;

TEST(LogOutputTest, WhatAdaptersSayStaysOnItsLineAndCommandsNoTerminal) {
  EXPECT_EQ(LogText("Zähler 展 \U0001F916"), "Zähler 展 \U0001F916");
  EXPECT_EQ(LogText("a\n12:00:00.000 error forged\r\x1b[2J\x07\x7f"),
            "a\\n12:00:00.000 error forged\\x0d\\x1b[2J\\x07\\x7f");
  EXPECT_EQ(LogText("\xC2\x9B"
                    "31m \u202E\u200B\u00AD\U000E0041"),
            "\\x9b31m \\u202e\\u200b\\xad\\U000e0041");
  EXPECT_EQ(LogText("a\xFF"
                    "b\xC3"),
            "a\\xffb\\xc3");
}

class LimitedSinkTest : public ::testing::Test {
 protected:
  LimitedSinkTest()
      : sink_(std::make_shared<LimitedSink>(std::make_shared<spdlog::sinks::ostream_sink_mt>(text_),
                                            LimitedSink::Limit{3, std::chrono::seconds(10)},
                                            [this] { return now_; })),
        logger_("x", sink_) {
    sink_->set_pattern("%l %v");
  }
  std::ostringstream text_;
  LimitedSink::Clock::time_point now_{std::chrono::hours(1)};
  std::shared_ptr<LimitedSink> sink_;
  spdlog::logger logger_;
};

TEST_F(LimitedSinkTest, EveryLineIsMadeSafe) {
  logger_.warn("{}", "a\nerror forged\x1b[0m");
  EXPECT_EQ(text_.str(), "warning a\\nerror forged\\x1b[0m\n");
}

TEST_F(LimitedSinkTest, OfAFloodTheFirstAreWrittenAndTheOthersCounted) {
  for (int i = 0; i < 1000; ++i) logger_.warn("w{}", i);
  EXPECT_EQ(text_.str(), "warning w0\nwarning w1\nwarning w2\n");
  logger_.error("e");
  EXPECT_THAT(text_.str(), HasSubstr("\nerror e\n")) << "errors pass";
  now_ += std::chrono::seconds(10);
  logger_.info("i");
  EXPECT_THAT(text_.str(),
              HasSubstr("error e\nwarning 997 lines were left out: too many came at once\ninfo i\n"));
  now_ += std::chrono::seconds(10);
  logger_.info("j");
  EXPECT_THAT(text_.str(), HasSubstr("info i\ninfo j\n"));
}

}  // namespace
}  // namespace docent
