#include "graph/command_line/program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "gmock/gmock.h"
#include "graph/command_line/usage_error.h"
#include "gtest/gtest.h"

namespace docent {
namespace {

using ::testing::HasSubstr;

// A program with commands of two levels, and its output on standard error.
struct Program {
  CLI::App app{"A program that is there to be tested and has a description which goes on and on.", "docent"};
  std::string query;
  bool ran = false;

  Program() {
    UseHelpLayout(&app);
    app.set_version_flag("--version", "docent 1.2.3");
    app.require_subcommand(1);
    CLI::App* queries = app.add_subcommand("query", "Query");
    queries->add_option("query", query, "The query")->required();
    queries->add_option("--format", format, "The format")
        ->check(CLI::IsMember({"json", "csv"}))
        ->capture_default_str();
    queries->add_option("--ontology", files, "A file")->type_name("FILE");
    queries->add_option("--count", count, "How many")->check(AtLeast(1))->type_name("N");
    queries->add_option("--rows", rows, "How many")->type_name("N");
    queries->add_option("--change", change, "More or fewer")->type_name("N");
    queries->add_option("--speed", speed, "How fast")->type_name("FACTOR");
    queries->add_option("--height", speed, "How high")->check(CLI::Range(0.1, 100.0))->type_name("M");
    queries->add_option("--reason", reason, "Why")->type_name("TEXT");
    queries->add_flag("--all", all, "All");
    queries->callback([this] { ran = true; });
    queries->footer("Example:\n  docent query 'ASK {}'");
    CLI::App* ontology = app.add_subcommand("ontology", "Modules");
    ontology->require_subcommand(1);
    ontology->add_subcommand("list", "List");
    ontology->add_subcommand("load", "Load");
  }

  std::string Fails(const std::vector<std::string>& arguments) {
    testing::internal::CaptureStderr();
    const auto code = ParseArguments(&app, arguments);
    std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(code, kExitBad) << text;
    return text;
  }

  std::string Prints(const std::vector<std::string>& arguments) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(ParseArguments(&app, arguments), kExitOk);
    return testing::internal::GetCapturedStdout();
  }

  std::string format = "json";
  std::vector<std::string> files;
  uint64_t count = 0;
  uint32_t rows = 0;
  int change = 0;
  double speed = 1;
  bool all = false;
  std::string reason;
};

TEST(ProgramTest, GoodArgumentsRunTheirCommand) {
  Program program;
  EXPECT_EQ(ParseArguments(&program.app, {"query", "ASK {}", "--format", "csv"}), std::nullopt);
  EXPECT_TRUE(program.ran);
  EXPECT_EQ(program.query, "ASK {}");
}

TEST(ProgramTest, AnUnknownWordNamesTheNearestAtEveryLevel) {
  EXPECT_EQ(Program().Fails({"qury"}),
            "docent: there is no command `docent qury`; did you mean `docent query`?\n");
  EXPECT_EQ(Program().Fails({"ontology", "lst"}),
            "docent: there is no command `docent ontology lst`; did you mean `docent ontology list`?\n");
  EXPECT_EQ(Program().Fails({"query", "x", "--fromat=csv"}),
            "docent query: there is no option --fromat; did you mean --format?\n");
  EXPECT_EQ(Program().Fails({"--verson"}), "docent: there is no option --verson; did you mean --version?\n");
}

TEST(ProgramTest, AWordThatNothingIsNearToLeadsToTheHelp) {
  EXPECT_EQ(Program().Fails({"zzzzzz"}),
            "docent: there is no command `docent zzzzzz`; `docent --help` lists them\n");
  EXPECT_EQ(Program().Fails({"query", "x", "--zzzzzz"}),
            "docent query: there is no option --zzzzzz; `docent query --help` lists them\n");
  EXPECT_EQ(Program().Fails({"query", "a", "b"}),
            "docent query: one argument too many: b; `docent query --help` shows its arguments\n");
}

TEST(ProgramTest, AnUnknownWordIsToldAlsoWhereHelpIsAskedFor) {
  EXPECT_THAT(Program().Fails({"qury", "--help"}), HasSubstr("did you mean `docent query`?"));
  EXPECT_THAT(Program().Fails({"ontology", "lst", "--help"}),
              HasSubstr("did you mean `docent ontology list`?"));
}

TEST(ProgramTest, AnOptionInTheWrongPlaceIsSentToTheRightOne) {
  EXPECT_EQ(Program().Fails({"--format", "csv", "query", "x"}),
            "docent: --format belongs behind `docent query`\n");
}

TEST(ProgramTest, WhatIsMissingIsTold) {
  EXPECT_THAT(Program().Fails({}), HasSubstr("`docent --help` tells more"));
  EXPECT_THAT(Program().Fails({"query"}),
              HasSubstr("docent query: QUERY is missing; write `docent query QUERY`; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--format", "yaml"}),
              HasSubstr("--format: give one of json, csv, not yaml; "));
  EXPECT_THAT(Program().Fails({"ontology"}),
              HasSubstr("docent ontology: a command is missing; there are list, load; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--count"}),
              HasSubstr("--count has no value; write --count N; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--format"}), HasSubstr("write --format {json,csv}; "));
}

TEST(ProgramTest, AWrongValueIsToldWithWhatTheOptionTakes) {
  EXPECT_THAT(Program().Fails({"query", "x", "--count", "-5"}),
              HasSubstr("docent query: --count: give a whole number, 1 or more, not -5; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--rows", "-5"}),
              HasSubstr("--rows: give a whole number, 0 or more, not -5; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--change", "1.5"}),
              HasSubstr("--change: give a whole number, not 1.5; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--speed", "fast"}),
              HasSubstr("--speed: give a number, not fast; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--height", "900"}),
              HasSubstr("--height: give a number from 0.1 to 100, not 900; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--all=maybe"}),
              HasSubstr("--all: give true or false, not maybe; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--format", "csv", "--format", "json"}),
              HasSubstr("--format is given 2 times; give it once; "));
}

// An unset variable of a shell: "$GRAPH" is not the same as no graph.
// As long as the system lets an argument be; patterns of std::regex take the stack for each character.
TEST(ProgramTest, AWrongValueOfAnyLengthIsToldAndCut) {
  const std::string digits(120000, '9');
  for (const std::string& value : {"x" + digits, "x" + std::string(120000, '\n'),
                                   ": Value " + digits + " not in {a} not in range 1 to 2"}) {
    for (const char* option :
         {"--format", "--count", "--rows", "--change", "--speed", "--height", "--all="}) {
      const bool joined = std::string_view(option).ends_with('=');
      const std::string text = joined ? Program().Fails({"query", "q", option + value})
                                      : Program().Fails({"query", "q", option, value});
      EXPECT_LT(text.size(), 1000u) << option;
      EXPECT_THAT(text, HasSubstr(joined ? "--all" : option));
    }
  }
  EXPECT_LT(Program().Fails({"query", "q", "--height", digits}).size(), 1000u);
}

TEST(ProgramTest, AnEmptyValueIsNoOptionLeftOut) {
  EXPECT_THAT(Program().Fails({"query", "x", "--ontology", ""}),
              HasSubstr("docent query: --ontology: it is empty; "));
  EXPECT_THAT(Program().Fails({"query", "x", "--ontology="}), HasSubstr("--ontology"));
  EXPECT_THAT(Program().Fails({"query", ""}), HasSubstr("query: it is empty; "));
  Program program;
  EXPECT_EQ(ParseArguments(&program.app, {"query", "x", "--reason", ""}), std::nullopt) << "free text";
}

TEST(ProgramTest, HelpShowsValuesDefaultsAndExamples) {
  const std::string help = Program().Prints({"query", "--help"});
  EXPECT_THAT(help, HasSubstr("Usage: docent query [OPTIONS] QUERY"));
  EXPECT_THAT(help, HasSubstr("--format {"));
  EXPECT_THAT(help, HasSubstr("(default: json)"));
  EXPECT_THAT(help, HasSubstr("A file; may be repeated"));
  EXPECT_THAT(help, HasSubstr("Example:\n  docent query 'ASK {}'\n"));
}

TEST(ProgramTest, HelpIsWrappedAtTheColumnsGiven) {
  setenv("COLUMNS", "40", 1);
  const std::string help = Program().Prints({"--help"});
  unsetenv("COLUMNS");
  EXPECT_THAT(help, HasSubstr("A program that is there to be tested and\nhas a description"));
  EXPECT_THAT(Program().Prints({"--version"}), "docent 1.2.3\n");
}

TEST(ProgramTest, OutputThatCannotBeWrittenIsAnError) {
  EXPECT_EXIT(
      {
        const int full = open("/dev/full", O_WRONLY);
        dup2(full, STDOUT_FILENO);
        std::cout << "an answer";
        CLI::App app("x", "docent");
        _exit(EndOutput(app, kExitOk));
      },
      testing::ExitedWithCode(kExitBad),
      "docent: the result could not be written to standard output: No space left");
}

TEST(ProgramTest, NoFileGetsTheNumberOfAClosedStandardOutput) {
  EXPECT_EXIT(
      {
        close(STDOUT_FILENO);
        PrepareStandardStreams();
        const int next = open("/dev/null", O_WRONLY);
        std::cout << "an answer";
        CLI::App app("x", "docent");
        const bool good = next > STDERR_FILENO && EndOutput(app, kExitOk) == kExitBad;
        _exit(good ? 0 : 1);
      },
      testing::ExitedWithCode(0), "could not be written");
}

TEST(ProgramTest, AReaderThatStopsEndsTheProgramWithoutAWord) {
  EXPECT_EXIT(
      {
        signal(SIGPIPE, SIG_IGN);  // as some parents leave it
        PrepareStandardStreams();
        int pipe_ends[2];
        if (pipe(pipe_ends) != 0) _exit(3);
        dup2(pipe_ends[1], STDOUT_FILENO);
        close(pipe_ends[0]);
        close(pipe_ends[1]);
        std::cout << "an answer" << std::flush;
        _exit(4);
      },
      testing::KilledBySignal(SIGPIPE), "^$");
}

}  // namespace
}  // namespace docent
