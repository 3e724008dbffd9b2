#include "kb_server/cli/terminal.h"

#include <iostream>
#include <sstream>

#include "gtest/gtest.h"

namespace docent::server {
namespace {

// What std::cout becomes of what a test writes.
class SafeOutputTest : public ::testing::Test {
 protected:
  SafeOutputTest() : before_(std::cout.rdbuf(text_.rdbuf())), safe_(std::make_unique<SafeOutput>()) {}
  ~SafeOutputTest() override {
    safe_.reset();
    std::cout.rdbuf(before_);
  }
  std::string Text() {
    safe_.reset();
    return text_.str();
  }

  std::ostringstream text_;
  std::streambuf* const before_;
  std::unique_ptr<SafeOutput> safe_;
};

TEST_F(SafeOutputTest, NoTextCommandsTheTerminal) {
  std::cout << "a\x1b[2J" << '\x07' << "\r\n"
            << "b\u202E\xC2\x9B" << std::endl;
  EXPECT_EQ(Text(), "a�[2J��\nb��\n");
}

TEST_F(SafeOutputTest, ACharacterInPiecesIsOne) {
  std::cout << "a\xE2"
            << "\x80"
            << "\xAE"
            << "b\xC3" << std::flush << "\xA4"
            << "\xE5";
  EXPECT_EQ(Text(), "a�bä�");
}

TEST_F(SafeOutputTest, ItsOwnColoursPassWhereTheyAreUsed) {
  const Terminal terminal = Terminal::OfOutput("always");
  std::cout << terminal.In(Style::kBad, "failed") << "\x1b[2J";
  EXPECT_EQ(Text(), "\x1b[31mfailed\x1b[0m�[2J");
}

TEST_F(SafeOutputTest, WhatAProgramReadsStaysAsItIs) {
  PrintForPrograms("a\u202Eb");
  EXPECT_EQ(Text(), "a\u202Eb");
}

}  // namespace
}  // namespace docent::server
