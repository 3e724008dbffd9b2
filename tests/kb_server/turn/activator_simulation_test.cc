// Seeded simulation of one activator under all modes, against a model: events that are told in every way, runs that end,
// documents that are loaded again, restarts, disabling. What it decides replays.
#include <map>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

struct Mode {
  std::string name;  // empty: not written
  int max = 0;       // 0: not written
};

std::string Text(const Mode& mode, int comment) {
  return absl::StrCat(
      "<!-- ", comment, R"( --><CAWL name="Call" xmlns:docent="https://w3id.org/docent#" xmlns:w="urn:w:"
              xmlns:ext="https://w3id.org/docent/cawl-ext#">
           <activator name="OnCall")",
      mode.name.empty() ? "" : absl::StrCat(" ext:mode=\"", mode.name, "\""),
      mode.max == 0 ? "" : absl::StrCat(" ext:max=\"", mode.max, "\""), R"(><variable name="user"/>
             <activate flow="Come"/>
             <condition expression="rang and c"><case name="rang"><event operation="ring"/></case>
               <context name="c"><rule name="r"><constraint name="k">
                 <subject>?event</subject><verb>w:by</verb><object>?user</object>
               </constraint></rule></context></condition></activator>
           <flow name="Come"><variable name="user"/><source name="s"/><node name="N"><condition expression="glad and d">
               <case name="glad"><event operation="glad"/></case>
               <context name="d"><rule name="r"><constraint name="k">
                 <subject>?event</subject><verb>w:of</verb><object>$user</object>
               </constraint></rule></context></condition></node>
           <sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>)");
}

struct Model {
  struct Key {
    int live = 0, waiting = 0;
  };
  Mode mode;
  bool disabled = false;
  std::map<std::string, Key> keys;
  int ignored = 0;

  // How many runs start.
  int Ring(const std::string& who) {
    if (disabled) return Ignore();
    Key& key = keys[who];
    const bool counts = mode.max > 0;
    if (mode.name == "single" && key.live > 0) return Ignore();
    if (mode.name == "queued" && key.live + key.waiting > 0) {
      if (counts && key.waiting >= mode.max) return Ignore();
      ++key.waiting;
      return 0;
    }
    if (mode.name == "restart") key.live = 0;
    if ((mode.name.empty() || mode.name == "parallel") && counts && key.live >= mode.max) return Ignore();
    ++key.live;
    return 1;
  }
  int Glad(const std::string& who) {
    Key& key = keys[who];
    if (key.live == 0) return 0;
    key.live = 0;
    return Next(&key);
  }
  int Enable() {
    disabled = false;
    int started = 0;
    for (auto& [who, key] : keys) {
      if (mode.name == "queued") {
        started += key.live == 0 ? Next(&key) : 0;
        continue;
      }
      for (int left = std::exchange(key.waiting, 0); left > 0; --left)
        started += Ring(who);  // of another mode
    }
    return started;
  }

 private:
  int Next(Key* key) {
    if (key->waiting == 0 || disabled) return 0;
    --key->waiting;
    key->live = 1;
    return 1;
  }
  int Ignore() {
    ++ignored;
    return 0;
  }
};

class ActivatorSimulation : public test::TurnTest, public ::testing::WithParamInterface<uint32_t> {
 protected:
  int Below(int bound) { return static_cast<int>(random_() % static_cast<uint32_t>(bound)); }

  // An event and who it is about, told in one of many ways.
  WriteBatch Event(const std::string& operation, const std::string& about, const std::string& who) {
    WriteBatch batch;
    const Term event = Below(2) == 0 ? Term::Blank("b1") : test::Iri(absl::StrCat("e", Below(2)));
    for (const TermQuad& fact :
         {TermQuad{event, test::Iri("a"), test::Iri("docent:Event"), Term()},
          TermQuad{event, test::Iri("docent:operation"), Term::Literal(operation), Term()},
          TermQuad{event, test::Iri(about), test::Iri(who), Term()}}) {
      batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
    }
    if (Below(3) == 0) batch.source = absl::StrCat("urn:w:Source", Below(2));
    if (Below(3) == 0) batch.mode = WriteBatch::Mode::kLoad;
    if (Below(4) == 0) batch.lifetime_ms = 60000;
    return batch;
  }
  TurnResult Play(WriteBatch batch) {
    TurnResult result = Turn(std::move(batch));
    records_.push_back(result.record);
    return result;
  }

  std::mt19937 random_{GetParam()};
  std::vector<log::TurnRecord> records_;
};

TEST_P(ActivatorSimulation, AgreesWithTheModel) {
  const std::vector<std::string> modes = {"", "single", "queued", "restart", "parallel"};
  Model model;
  int deployed = 0;
  const auto deploy = [&] {
    return Started(Play(Put(Document::Kind::kCawl, "call", Text(model.mode, ++deployed))));
  };
  EXPECT_TRUE(deploy().empty());
  for (int step = 0; step < 150; ++step) {
    const std::string who = absl::StrCat("P", Below(2));
    const int ignored = model.ignored;
    size_t expected = 0;
    TurnResult result;
    switch (Below(9)) {
      case 0:
        model.mode.name = modes[static_cast<size_t>(Below(5))];
        model.mode.max = model.mode.name == "single" || model.mode.name == "restart" ? 0 : Below(4);
        EXPECT_TRUE(deploy().empty()) << "step " << step;
        continue;
      case 1:
        Restart();
        continue;
      case 2: {
        WriteBatch batch;
        model.disabled = !model.disabled;
        batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Call",
                                   model.disabled ? kRemovesStarts : kRemovesDisablement});
        if (!model.disabled) expected = static_cast<size_t>(model.Enable());
        result = Play(std::move(batch));
        break;
      }
      case 3:
      case 4:
        expected = static_cast<size_t>(model.Glad(who));
        result = Play(Event("glad", "of", who));
        break;
      default:
        expected = static_cast<size_t>(model.Ring(who));
        result = Play(Event("ring", "by", who));
        break;
    }
    ASSERT_EQ(Started(result).size(), expected) << "step " << step;
    int said = 0;
    for (const Transition& t : result.record.transitions) said += t.to == "ignored";
    ASSERT_EQ(said, model.ignored - ignored) << "step " << step;
    size_t live = 0;
    for (const auto& [name, key] : model.keys) live += static_cast<size_t>(key.live);
    ASSERT_EQ(stages_->engine.live_runs(), live) << "step " << step;
    if (Below(2) == 0) {
      WriteBatch tick;
      tick.clock_tick = true;
      Play(std::move(tick));
      ASSERT_EQ(Count("by") + Count("of"), 0u) << "an event stays, at step " << step;
    }
  }
  Dictionary dictionary;
  Stages replay(&dictionary, &functions_, Limits());
  for (size_t i = 0; i < records_.size(); ++i) {
    const auto derived = RunTurn(&replay, records_[i].batch, i + 1);
    ASSERT_TRUE(derived.ok()) << derived.status();
    ASSERT_EQ(log::DecisionDifference(records_[i], derived->record), std::nullopt) << "record " << i + 1;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ActivatorSimulation, ::testing::Range(1u, 101u));

}  // namespace
}  // namespace docent::server
