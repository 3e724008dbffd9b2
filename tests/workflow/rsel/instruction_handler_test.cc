#include "workflow/rsel/instruction_handler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "workflow/rsel/parser.h"

namespace docent::rsel {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;
using State = InstructionHandler::State;

const Term kUser = Term::Iri("urn:john"), kBooth = Term::Iri("urn:b03");

PlanPtr PlanOf(const std::string& text, const std::string& process) {
  ParsedRsel parsed = ParseRsel(text, "f");
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  ServiceRegistry registry;
  EXPECT_THAT(registry.Put(parsed.document), IsEmpty());
  return registry.Find(process);
}

std::string File(const std::string& path) {
  std::ifstream in(std::string(DOCENT_SOURCE_DIR) + "/" + path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// <process name="P"> with these invokes.
InstructionHandler Started(const std::string& invokes, const Arguments& arguments = {}) {
  PlanPtr plan =
      PlanOf("<rsel name=\"T\" xmlns:ext=\"https://w3id.org/docent/rsel-ext#\"><process name=\"P\">" +
                 invokes + "</process></rsel>",
             "P");
  return *InstructionHandler::Start(plan, arguments);
}

TEST(InstructionHandler, RunsTheBoothGuideInOrder) {
  PlanPtr plan = PlanOf(File("scenarios/s01_booth_guide/booth_guide.rsel.xml"), "BoothGuide");
  auto handler = InstructionHandler::Start(plan, {{"user", kUser}, {"booth", kBooth}, {"more", kUser}});
  ASSERT_TRUE(handler.ok());
  std::vector<std::string> labels;
  while (!handler->ended()) {
    std::vector<Instruction> ready = handler->TakeReady();
    ASSERT_THAT(ready, SizeIs(1));
    EXPECT_THAT(handler->TakeReady(), IsEmpty()) << "an instruction is given once";
    labels.push_back(ready[0].label);
    EXPECT_EQ(ready[0].arguments[0].second, labels.size() == 1 ? kUser : kBooth);
    EXPECT_TRUE(handler->Succeeded(ready[0].step, ready[0].attempt, {}));
  }
  EXPECT_EQ(handler->state(), State::kDone);
  EXPECT_THAT(labels,
              ElementsAre("1/4 moveToUser", "2/4 moveToBooth", "3/4 displayInformation/displayBoothInfo",
                          "4/4 briefInformation/briefBoothInfo"));
}

TEST(InstructionHandler, MissingArgumentsAreNamed) {
  PlanPtr plan = PlanOf(File("scenarios/s01_booth_guide/booth_guide.rsel.xml"), "BoothGuide");
  auto handler = InstructionHandler::Start(plan, {{"user", kUser}});
  EXPECT_EQ(handler.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(handler.status().message()), HasSubstr("BoothGuide needs a value for booth"));
}

TEST(InstructionHandler, ResultsFlowOn) {
  InstructionHandler h = Started(
      "<invoke operation=\"locate\"><output part=\"pose\" to=\"where\"/></invoke>"
      "<invoke operation=\"go\"><input part=\"to\" from=\"where\"/></invoke>");
  h.TakeReady();
  EXPECT_TRUE(h.Succeeded(1, 1, {{"pose", kBooth}}));
  std::vector<Instruction> next = h.TakeReady();
  ASSERT_THAT(next, SizeIs(1));
  EXPECT_THAT(next[0].arguments, ElementsAre(Pair("to", kBooth)));
  h.Succeeded(2, 1, {});
  EXPECT_THAT(h.Results(), ElementsAre(Pair("where", kBooth)));
}

TEST(InstructionHandler, AResultThatWasNotGivenFailsTheStepThatNeedsIt) {
  InstructionHandler h = Started(
      "<invoke operation=\"locate\"><output part=\"pose\" to=\"where\"/></invoke>"
      "<invoke operation=\"go\"><input part=\"to\" from=\"where\"/></invoke>");
  h.TakeReady();
  h.Succeeded(1, 1, {{"other", kBooth}});
  EXPECT_THAT(h.TakeReady(), IsEmpty());
  EXPECT_EQ(h.state(), State::kFailed);
  EXPECT_THAT(h.reason(), HasSubstr("2/2 go: its part to takes result 1.pose"));
}

TEST(InstructionHandler, AStepBesideOneThatCannotBeginIsNotGivenAndNothingOfItIsOut) {
  InstructionHandler h = Started(
      "<invoke operation=\"locate\"><output part=\"pose\" to=\"where\"/></invoke><invoke operation=\"say\"/>"
      "<invoke operation=\"go\" ext:parallel=\"true\"><input part=\"to\" from=\"where\"/></invoke>");
  h.TakeReady();
  h.Succeeded(1, 1, {});
  EXPECT_THAT(h.TakeReady(), IsEmpty());
  EXPECT_EQ(h.state(), State::kFailed);
  EXPECT_THAT(h.RunningSteps(), IsEmpty());
}

TEST(InstructionHandler, RetriesThenFails) {
  InstructionHandler h =
      Started("<invoke operation=\"go\" ext:retry=\"1\" ext:timeout=\"2s\"/><invoke operation=\"never\"/>");
  std::vector<Instruction> first = h.TakeReady();
  ASSERT_THAT(first, SizeIs(1));
  EXPECT_EQ(first[0].timeout_ms, 2000);
  EXPECT_TRUE(h.Failed(1, 1, "blocked"));
  EXPECT_EQ(h.state(), State::kRunning);
  std::vector<Instruction> second = h.TakeReady();
  ASSERT_THAT(second, SizeIs(1));
  EXPECT_EQ(second[0].attempt, 2);
  EXPECT_FALSE(h.Succeeded(1, 1, {})) << "a late report of the first attempt";
  EXPECT_TRUE(h.Failed(1, 2, "blocked again"));
  EXPECT_EQ(h.state(), State::kFailed);
  EXPECT_EQ(h.reason(), "1/2 go: blocked again");
  EXPECT_EQ(h.step_state(2), InstructionHandler::StepState::kCancelled);
  EXPECT_THAT(h.TakeReady(), IsEmpty());
}

TEST(InstructionHandler, AnUnknownOutcomeIsNotTriedAgain) {
  InstructionHandler h = Started("<invoke operation=\"go\" ext:retry=\"5\"/>");
  h.TakeReady();
  EXPECT_TRUE(h.Failed(1, 1, "nobody knows", /*may_retry=*/false));
  EXPECT_EQ(h.state(), State::kFailed);
}

TEST(InstructionHandler, OnFailureContinueGoesOn) {
  InstructionHandler h =
      Started("<invoke operation=\"wave\" ext:onFailure=\"continue\"/><invoke operation=\"go\"/>");
  h.TakeReady();
  h.Failed(1, 1, "no arm");
  std::vector<Instruction> next = h.TakeReady();
  ASSERT_THAT(next, SizeIs(1));
  EXPECT_EQ(next[0].operation, "go");
  h.Succeeded(2, 1, {});
  EXPECT_EQ(h.state(), State::kDone);
}

TEST(InstructionHandler, ParallelStepsRunTogetherAndAreCancelledTogether) {
  InstructionHandler h = Started(
      "<invoke operation=\"a\"/><invoke operation=\"b\"/>"
      "<invoke operation=\"c\" ext:parallel=\"true\"/><invoke operation=\"d\"/>");
  h.TakeReady();
  h.Succeeded(1, 1, {});
  EXPECT_THAT(h.TakeReady(), SizeIs(2));
  InstructionHandler copy = h;
  h.Succeeded(3, 1, {});
  EXPECT_THAT(h.TakeReady(), IsEmpty()) << "d waits for b";
  h.Succeeded(2, 1, {});
  EXPECT_THAT(h.TakeReady(), SizeIs(1));
  // The copy is independent.
  copy.Failed(2, 1, "broken");
  EXPECT_EQ(copy.state(), State::kFailed);
  EXPECT_THAT(copy.RunningSteps(), ElementsAre(Pair(3, 1)));
  EXPECT_FALSE(copy.Succeeded(3, 1, {}));
  EXPECT_THAT(copy.RunningSteps(), IsEmpty());
}

TEST(InstructionHandler, CancelTellsWhatStillRuns) {
  InstructionHandler h = Started("<invoke operation=\"a\"/><invoke operation=\"b\"/>");
  h.TakeReady();
  h.Cancel("the visitor left");
  h.Cancel("again");
  EXPECT_EQ(h.state(), State::kCancelled);
  EXPECT_EQ(h.reason(), "the visitor left");
  EXPECT_THAT(h.RunningSteps(), ElementsAre(Pair(1, 1)));
  EXPECT_THAT(h.TakeReady(), IsEmpty());
}

TEST(InstructionHandler, WhatSucceedsThoughItWasCancelledIsDone) {
  InstructionHandler handler = Started("<invoke operation=\"a\"/><invoke operation=\"b\"/>");
  ASSERT_THAT(handler.TakeReady(), SizeIs(1));
  ASSERT_TRUE(handler.Succeeded(1, 1, {}));
  ASSERT_THAT(handler.TakeReady(), SizeIs(1));
  handler.Cancel("fire");
  InstructionHandler other = handler;
  EXPECT_FALSE(handler.Succeeded(2, 1, {})) << "it no longer waits for it";
  EXPECT_FALSE(handler.SucceededLate(1, {})) << "it is done";
  EXPECT_EQ(handler.state(), State::kCancelled);
  EXPECT_TRUE(handler.SucceededLate(2, {{"booth", kBooth}}));
  EXPECT_EQ(handler.state(), State::kDone);
  EXPECT_EQ(handler.reason(), "");
  EXPECT_FALSE(other.SucceededLate(3, {})) << "there is no such step";
  EXPECT_EQ(other.state(), State::kCancelled);
}

TEST(InstructionHandler, OneStepThatSucceedsLateIsNotAll) {
  InstructionHandler handler = Started("<invoke operation=\"a\"/><invoke operation=\"b\"/>");
  ASSERT_THAT(handler.TakeReady(), SizeIs(1));
  handler.Cancel("fire");
  EXPECT_TRUE(handler.SucceededLate(1, {}));
  EXPECT_EQ(handler.state(), State::kCancelled);
  EXPECT_EQ(handler.step_state(1), InstructionHandler::StepState::kDone);
}

TEST(InstructionHandler, ReportsOfWhatNeverRanAreIgnored) {
  InstructionHandler h = Started("<invoke operation=\"a\"/><invoke operation=\"b\"/>");
  EXPECT_FALSE(h.Succeeded(1, 1, {}));
  EXPECT_FALSE(h.Succeeded(0, 1, {}));
  EXPECT_FALSE(h.Failed(3, 1, "x"));
  h.TakeReady();
  EXPECT_FALSE(h.Succeeded(2, 1, {}));
  EXPECT_FALSE(h.Succeeded(1, 2, {}));
  EXPECT_TRUE(h.Succeeded(1, 1, {}));
  EXPECT_FALSE(h.Succeeded(1, 1, {})) << "repeated";
}

// Any order of reports ends, every step runs at most 1 + retry times, and the same calls give the same
// states.
TEST(InstructionHandler, RandomReportsEndTheSameWayTwice) {
  PlanPtr plan = PlanOf(File("tests/golden/rsel/parallel/input.xml"), "Tour");
  for (uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    InstructionHandler a = *InstructionHandler::Start(plan, {{"first", kBooth}}), b = a;
    std::vector<Instruction> out;
    std::map<int, int> given;
    for (int i = 0; i < 100 && !a.ended(); ++i) {
      std::vector<Instruction> ready = a.TakeReady();
      EXPECT_EQ(ready, b.TakeReady());
      for (const Instruction& instruction : ready) {
        EXPECT_LE(++given[instruction.step], 1 + plan->steps[instruction.step - 1].retry);
        out.push_back(instruction);
      }
      if (out.empty()) break;
      size_t which = random() % out.size();
      Instruction instruction = out[which];
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(which));
      bool good = random() % 3 != 0;
      for (InstructionHandler* h : {&a, &b}) {
        if (good) {
          h->Succeeded(instruction.step, instruction.attempt, {{"pose", kUser}});
        } else {
          h->Failed(instruction.step, instruction.attempt, "random");
        }
      }
      EXPECT_EQ(a.state(), b.state());
    }
    EXPECT_TRUE(a.ended());
    EXPECT_EQ(a.reason(), b.reason());
    EXPECT_EQ(a.Results(), b.Results());
  }
}

}  // namespace
}  // namespace docent::rsel
