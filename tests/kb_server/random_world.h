// A world with random events, for tests that compare two ways to the same state: robots that come and go,
// visitors, workflows that are deployed, replaced and removed, runs with subflows, loops and retries,
// lifetimes, rules. Deterministic for a seed.
#ifndef DOCENT_TESTS_KB_SERVER_RANDOM_WORLD_H_
#define DOCENT_TESTS_KB_SERVER_RANDOM_WORLD_H_

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server::test {

// Greets all present visitors at once, then calls the other workflow, and loops while a visitor is sad.
inline constexpr char kRound[] = R"(<?xml version="1.0"?>
<CAWL name="Round" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#"
      xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Tour">
    <variable name="person"/>
    <source name="start"/>
    <node name="All" ext:forEach="?person" ext:retry="1" ext:timeout="50s">
      <condition><context name="Here"><rule name="here"><constraint name="here">
        <subject>?person</subject><verb>docent:isAt</verb><object>&lt;urn:w:Hall&gt;</object>
      </constraint></rule></context></condition>
      <invoke operation="greet" ext:retry="1" ext:timeout="20s"/>
      <invoke operation="greetTwice"/>
    </node>
    <node name="Sub"><invoke subflow="Greeting"/></node>
    <sink name="end"/>
    <link from="start" to="All"/>
    <link from="All" to="Sub"/>
    <link from="Sub" to="All" ext:while="?x docent:feels docent:Sad"/>
    <link from="Sub" to="end"/>
  </flow>
</CAWL>
)";

class RandomWorld {
 public:
  explicit RandomWorld(uint32_t seed) : random_(seed) {}

  // The next batch, for the current state of the stages. Some are refused.
  WriteBatch Next(const Stages& stages) {
    WriteBatch batch = step_++ < 6 ? Beginning(step_) : Anything(stages);
    now_us_ += static_cast<TimeMicros>(Below(3'000'000));
    if (Below(10) == 0) now_us_ += 30'000'000;
    batch.time_us = now_us_;
    if (Below(4) == 0) {
      batch.request_id = absl::StrCat("request-", step_);
      batch.request_digest = step_;
    }
    return batch;
  }
  uint32_t Below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }

 private:
  static WriteBatch Beginning(int step) {
    switch (step) {
      case 1: {
        WriteBatch batch = WorldFacts();
        for (int i = 2; i <= 4; ++i) {
          const std::string robot = absl::StrCat("R", i);
          for (const TermQuad& fact :
               {Fact(robot, "a", "docent:Robot"), Fact(robot, "docent:incarnation", Term::Literal("i1")),
                Fact(robot, "docent:status", "docent:Standby"), Fact(robot, "docent:isAt", "Hall"),
                Fact(robot, "docent:offers", "urn:docent:operation:greet")}) {
            batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
          }
        }
        return batch;
      }
      case 2:
        return Put(Document::Kind::kRules, "near.rules", kRules);
      case 3:
        return Put(Document::Kind::kCawl, "greeting.xml", kGreeting);
      case 4:
        return Put(Document::Kind::kRsel, "services.xml", kServices);
      case 5:
        return Put(Document::Kind::kCawl, "called.xml", kCalled);
      default:
        return Put(Document::Kind::kCawl, "round.xml", kRound);
    }
  }

  std::string Person() { return absl::StrCat("P", Below(6)); }
  std::string Robot() { return absl::StrCat("R", 1 + Below(4)); }

  WriteBatch Anything(const Stages& stages) {
    const std::vector<engine::CommandUnderWay> open = stages.engine.OpenCommands();
    if (!open.empty() && Below(3) != 0)
      return ReportOf(open[Below(static_cast<uint32_t>(open.size()))].command);
    switch (Below(16)) {
      case 0:
      case 1:
        return Tell({Fact(Person(), "docent:isAt", Below(3) == 0 ? "Yard" : "Hall")});
      case 2: {
        WriteBatch batch = Tell({Fact(Person(), "docent:isAt", "Hall")});
        batch.lifetime_ms = 1000 + Below(20000);
        batch.source = "urn:w:Camera";
        return batch;
      }
      case 3:
        return Tell({}, {Fact(Person(), "docent:isAt", "Hall")});
      case 4: {
        const TermQuad call = Fact(Person(), "docent:calls", Robot());
        return Below(2) == 0 ? Tell({call}) : Tell({}, {call});
      }
      case 5:
        return Tell({Fact(Person(), "docent:feels", Below(2) == 0 ? "docent:Glad" : "docent:Sad")});
      case 6:
        return Tell({}, {Fact(Person(), "docent:feels", Below(2) == 0 ? "docent:Glad" : "docent:Sad")});
      case 7:
        return Tell({Fact(Robot(), "docent:status", Below(3) == 0 ? "docent:Offline" : "docent:Standby")});
      case 8:
        return Start("Greeting", {{"person", Iri(Person())}});
      case 9:
        return Start("Round");
      case 10: {
        WriteBatch batch;
        batch.run_requests.push_back({RunRequest::Kind::kInvokeService, "greetTwice", {}});
        return batch;
      }
      case 11: {
        WriteBatch batch;  // often there is no such run
        batch.run_requests.push_back({RunRequest::Kind::kCancel, absl::StrCat("Greet-", Below(40)), {}});
        return batch;
      }
      case 12:
        return Documents();
      case 13:
        return Reading(Below(2) == 0 ? "tag-17" : "nobody");
      case 14:
        return Tell({Fact(Person(), "docent:says", Term::Literal(absl::StrCat("word ", Below(1000))))});
      default: {
        WriteBatch tick;
        tick.clock_tick = true;
        return tick;
      }
    }
  }

  WriteBatch Documents() {
    switch (Below(7)) {
      case 0:  // another version of a workflow whose runs go on with the one before
        return Put(Document::Kind::kCawl, "greeting.xml",
                   absl::StrReplaceAll(kGreeting, {{"Goodbye", absl::StrCat("Farewell", Below(3))}}));
      case 1:
        return Put(Document::Kind::kCawl, "called.xml", kCalled);
      case 2: {
        WriteBatch batch;
        batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Called", ""});
        return batch;
      }
      case 3: {
        WriteBatch batch;
        batch.documents.push_back({Document::Kind::kRsel, Document::Action::kRemove, "Services", ""});
        return batch;
      }
      case 4:
        return Put(Document::Kind::kRsel, "services.xml", kServices);
      case 5:
        return Put(Document::Kind::kRules, "near.rules",
                   absl::StrReplaceAll(kRules,
                                       {{"docent:isNear", Below(2) == 0 ? "docent:isNear" : "docent:sees"}}));
      default:
        return Put(Document::Kind::kCawl, "broken.xml", "<CAWL>");
    }
  }

  WriteBatch ReportOf(const RobotCommand& command) {
    using Outcome = CommandReport::Outcome;
    static constexpr Outcome kOutcomes[] = {Outcome::kSucceeded, Outcome::kSucceeded, Outcome::kSucceeded,
                                            Outcome::kFailed,    Outcome::kProgress,  Outcome::kUnreachable,
                                            Outcome::kUnknown,   Outcome::kCancelled};
    WriteBatch batch;
    batch.reports.push_back(
        {command.id, kOutcomes[Below(8)], Below(2) == 0 ? "why" : "", 0.5, "i2", {{"at", Iri("Hall")}}});
    return batch;
  }

  std::mt19937 random_;
  int step_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

// All facts in the graph of the stages, as text.
inline std::vector<std::string> Lines(const Dictionary& dictionary, const GraphVersion& graph) {
  std::vector<std::string> lines;
  graph.ForEach({}, [&](const Quad& quad) {
    lines.push_back(absl::StrCat(
        ToNTriples(dictionary.Decode(quad.subject)), " ", ToNTriples(dictionary.Decode(quad.predicate)), " ",
        ToNTriples(dictionary.Decode(quad.object)), " ", ToNTriples(dictionary.Decode(quad.graph))));
    return true;
  });
  std::sort(lines.begin(), lines.end());
  return lines;
}

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_RANDOM_WORLD_H_
