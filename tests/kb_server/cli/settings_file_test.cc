#include "kb_server/cli/settings_file.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(SettingsFileTest, SettingsAreRead) {
  const ParsedSettings parsed = ParseSettings(
      "# a comment\n"
      "\n"
      "grpc = \"127.0.0.1:7400\"  # behind a value\r\n"
      "snapshot-records=200_000\n"
      "insecure = true\n"
      "data = '/var/lib/\\docent'\n"
      "rules = [ \"owl2rl\",  # in a list\n"
      "  'my.rules',\n"
      "]\n"
      "allow = []",
      "f");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_EQ(parsed.settings.size(), 6u);
  EXPECT_EQ(parsed.settings[0].name, "grpc");
  EXPECT_THAT(parsed.settings[0].values, ElementsAre("127.0.0.1:7400"));
  EXPECT_EQ(parsed.settings[0].span.line, 3);
  EXPECT_THAT(parsed.settings[1].values, ElementsAre("200000"));
  EXPECT_THAT(parsed.settings[2].values, ElementsAre("true"));
  EXPECT_THAT(parsed.settings[3].values, ElementsAre("/var/lib/\\docent"));
  EXPECT_THAT(parsed.settings[4].values, ElementsAre("owl2rl", "my.rules"));
  EXPECT_THAT(parsed.settings[5].values, IsEmpty());
}

TEST(SettingsFileTest, EscapesAreThoseOfToml) {
  const ParsedSettings parsed = ParseSettings("a = \"x\\\"\\\\\\n\\u00E4\\U0001F916#\"", "f");
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(parsed.settings[0].values, ElementsAre("x\"\\\nä🤖#"));
}

TEST(SettingsFileTest, EveryMistakeIsToldWithItsPlace) {
  const std::string text =
      "grpc \"x\"\n"
      "[serve]\n"
      "data = /var/lib\n"
      "http = \"127.0.0.1\n"
      "a = 1 2\n"
      "b = [1 2]\n"
      "c = \"\\q\"\n"
      "d = \"\\uD800\"\n"
      "good = 1\n";
  const ParsedSettings parsed = ParseSettings(text, "f.toml");
  std::vector<int> lines;
  for (const Diagnostic& d : parsed.diagnostics) lines.push_back(d.span.line);
  EXPECT_THAT(lines, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(parsed.settings.back().name, "good");
  EXPECT_THAT(Render(parsed.diagnostics, text), HasSubstr("f.toml:3:8: error: a value is expected"));
}

TEST(SettingsFileTest, NothingAtAllIsAnEmptyFile) {
  for (const char* text : {"", "\n", "#", "# x", "  \t"})
    EXPECT_TRUE(ParseSettings(text, "f").settings.empty());
}

// A command with options of each kind, and what they are set to.
struct Command {
  CLI::App app{"d", "program"};
  CLI::App* serve = app.add_subcommand("serve", "x");
  std::string data = "here";
  uint64_t records = 7;
  bool insecure = false;
  std::vector<std::string> rules;
  std::string config;

  Command() {
    serve->add_option("--data", data, "The folder")->capture_default_str();
    serve->add_option("--records", records, "How many")->capture_default_str();
    serve->add_flag("--insecure", insecure, "Dare");
    serve->add_option("--rules", rules, "Which");
    serve->add_option("--config", config, "This");
  }

  absl::Status Apply(const std::string& text, std::vector<std::string> arguments) {
    const std::string file = absl::StrCat(testing::TempDir(), "/docent_settings_", getpid(), ".toml");
    std::ofstream(file) << text;
    arguments.emplace_back("serve");
    app.parse(arguments);
    absl::Status status = ApplySettings(file, {"help", "config"}, serve);
    std::remove(file.c_str());
    return status;
  }
};

TEST(SettingsFileTest, AFileGivesWhatTheCommandLineDoesNot) {
  Command command;
  ASSERT_TRUE(command
                  .Apply("data = \"there\"\nrecords = 9\ninsecure = true\nrules = [\"a\", \"b\"]\n",
                         {"8", "--records"})
                  .ok());
  EXPECT_EQ(command.data, "there");
  EXPECT_EQ(command.records, 8u);
  EXPECT_TRUE(command.insecure);
  EXPECT_THAT(command.rules, ElementsAre("a", "b"));
}

TEST(SettingsFileTest, OneTextStandsForAListOfOne) {
  Command command;
  ASSERT_TRUE(command.Apply("rules = \"a\"\ninsecure = false\n", {}).ok());
  EXPECT_THAT(command.rules, ElementsAre("a"));
  EXPECT_FALSE(command.insecure);
}

TEST(SettingsFileTest, WhatIsNoSettingIsRefusedWithTheNearest) {
  Command command;
  const absl::Status status = command.Apply(
      "dato = \"x\"\nzzz = 1\nconfig = \"y\"\ndata = \"1\"\ndata = \"2\"\nrecords = [1, 2]\nrecords = 3\n",
      {});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  const std::string text(status.message());
  EXPECT_THAT(text, HasSubstr("there is no setting dato"));
  EXPECT_THAT(text, HasSubstr("did you mean data?"));
  EXPECT_THAT(text, HasSubstr("there is no setting zzz"));
  EXPECT_THAT(text, HasSubstr("there is no setting config"));
  EXPECT_THAT(text, HasSubstr("data is given a second time"));
  EXPECT_THAT(text, HasSubstr("records takes one value"));
}

TEST(SettingsFileTest, AValueThatTheOptionRefusesIsToldAtItsLine) {
  Command command;
  const absl::Status status = command.Apply("\nrecords = \"many\"\n", {});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr(".toml:2:1: error: "));
  EXPECT_THAT(std::string(status.message()), HasSubstr("--records: give a whole number, not many"));
  Command flag;
  EXPECT_THAT(std::string(flag.Apply("insecure = \"maybe\"\n", {}).message()),
              HasSubstr("give true or false, not maybe"));
}

TEST(SettingsFileTest, ANumberIsNoText) {
  Command command;
  const std::string text(command.Apply("data = 5\nrules = [\"a\", true]\n", {}).message());
  EXPECT_THAT(text, HasSubstr(".toml:1:1: error: data takes a text, and 5 is none"));
  EXPECT_THAT(text, HasSubstr("write it in quotes: \"5\""));
  EXPECT_THAT(text, HasSubstr(".toml:2:1: error: rules takes a text, and true is none"));
  EXPECT_EQ(command.data, "here");
}

TEST(SettingsFileTest, AByteOrderMarkIsNoName) {
  Command command;
  ASSERT_TRUE(command.Apply("\xEF\xBB\xBFrecords = 9\n", {}).ok());
  EXPECT_EQ(command.records, 9u);
}

// As --print-config writes an option without a default.
TEST(SettingsFileTest, AnEmptyDefaultIsNoValue) {
  Command command;
  std::string web = "as it was";
  command.serve->add_option("--web", web, "x");
  ASSERT_TRUE(command.Apply("web = \"\"\n", {}).ok());
  EXPECT_EQ(web, "as it was");
}

TEST(SettingsFileTest, AFileThatIsNotThereIsNamed) {
  Command command;
  command.app.parse(std::vector<std::string>{"serve"});
  EXPECT_THAT(std::string(ApplySettings("/nowhere/docent.toml", {}, command.serve).message()),
              HasSubstr("/nowhere/docent.toml"));
}

TEST(SettingsFileTest, ThePrintedFileHasEveryOptionAndReadsBack) {
  Command command;
  command.app.parse(std::vector<std::string>{"a b\"c", "--rules", "serve"});
  const std::string text = SettingsText(*command.serve, {"help", "config"});
  EXPECT_EQ(text,
            "# The folder\n#data = \"here\"\n\n# How many\n#records = 7\n\n# Dare\n#insecure = false\n\n"
            "# Which; a list\nrules = [\"a b\\\"c\"]\n");
  const ParsedSettings parsed = ParseSettings(text, "f");
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(parsed.settings[0].values, ElementsAre("a b\"c"));
}

}  // namespace
}  // namespace docent::server
