// Conditions over time, against a reference that evaluates every query again at every moment of a random
// timeline.
#include "kb_server/turn/condition_port.h"

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

constexpr char kPrefix[] = "PREFIX : <urn:w:> ";

// Presence for 5, a join of it with something that has no time, absence for 7, two times, a number for 3, a part
// without variables.
std::vector<engine::ConditionRequest> Shapes() {
  const auto ask = [](const std::string& where) { return absl::StrCat(kPrefix, "ASK { ", where, " }"); };
  const std::string unseen = "?v a :Visitor . FILTER NOT EXISTS { ?c :sees ?v }";
  const std::string battery = "?r :battery ?b . FILTER(?b < 3)";
  return {
      {0, ask("?v :at :B1"), {}, false, {{ask("?v :at :B1"), {"v"}, 5}}},
      {0, ask("?v :at ?booth . ?r :free ?booth"), {"v"}, false, {{ask("?v :at ?booth"), {"v", "booth"}, 5}}},
      {0, ask(unseen), {"v"}, false, {{ask(unseen), {"v"}, 7}}},
      {0,
       ask("?v :at ?booth . ?r :free ?booth"),
       {"r"},
       false,
       {{ask("?v :at ?booth"), {"v", "booth"}, 4}, {ask("?r :free ?booth"), {"r", "booth"}, 9}}},
      {0, ask(battery), {"r"}, false, {{ask(battery), {"r"}, 3}}},
      {0,
       ask("?v :at :B2 . FILTER NOT EXISTS { ?r :free :B2 }"),
       {"v"},
       false,
       {{ask("FILTER NOT EXISTS { ?r :free :B2 }"), {}, 6}}},
  };
}

// The definition of a condition: every query evaluated again, with the time since which each solution is
// there.
class Reference {
 public:
  explicit Reference(const engine::ConditionRequest& request)
      : request_(request), since_(request.lasting.size()) {}

  void Look(const GraphVersion& version, const Dictionary& dictionary, TimeMicros now_us) {
    for (size_t i = 0; i < request_.lasting.size(); ++i) {
      std::map<engine::TermBinding, TimeMicros> now;
      for (const engine::TermBinding& solution : Select(request_.lasting[i].ask, version, dictionary)) {
        const engine::TermBinding key = Only(solution, request_.lasting[i].variables);
        const auto before = since_[i].find(key);
        now[key] = before == since_[i].end() ? now_us : before->second;
      }
      since_[i] = std::move(now);
    }
    solutions_.clear();
    keys_.clear();
    for (const engine::TermBinding& solution : Select(request_.ask, version, dictionary)) {
      bool open = true;
      for (size_t i = 0; i < request_.lasting.size(); ++i) {
        const engine::LastingPart& part = request_.lasting[i];
        const auto since = since_[i].find(Only(solution, part.variables));
        open = open && since != since_[i].end() && since->second + part.at_least_us <= now_us;
      }
      if (!open) continue;
      solutions_.insert(solution);
      keys_.insert(Only(solution, request_.key_variables));
    }
  }
  const std::set<engine::TermBinding>& solutions() const { return solutions_; }
  const std::set<engine::TermBinding>& keys() const { return keys_; }

 private:
  static engine::TermBinding Only(const engine::TermBinding& solution,
                                  const std::vector<std::string>& names) {
    engine::TermBinding part;
    for (const std::string& name : names) {
      if (const auto found = solution.find(name); found != solution.end()) part.insert(*found);
    }
    return part;
  }
  static std::set<engine::TermBinding> Select(const std::string& ask, const GraphVersion& version,
                                              const Dictionary& dictionary) {
    std::string text = ask;
    text.replace(text.find("ASK"), 3, "SELECT * WHERE");
    sparql::ParsedQuery parsed = sparql::ParseQuery(text);
    EXPECT_TRUE(parsed.ok()) << text;
    auto prepared = sparql::PreparedQuery::Prepare(parsed.query, dictionary);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    std::set<engine::TermBinding> out;
    const std::vector<std::string>& names = (*prepared)->variables();
    const absl::Status status =
        (*prepared)->Select({.version = &version}, {}, [&](absl::Span<const TermId> row) {
          engine::TermBinding solution;
          for (size_t i = 0; i < names.size(); ++i) {
            if (!row[i].IsNone()) solution.emplace(names[i], dictionary.Decode(row[i]));
          }
          out.insert(std::move(solution));
          return true;
        });
    EXPECT_TRUE(status.ok()) << status;
    return out;
  }

  engine::ConditionRequest request_;
  std::vector<std::map<engine::TermBinding, TimeMicros>> since_;
  std::set<engine::TermBinding> solutions_, keys_;
};

// A port with its dependencies.
struct Side {
  explicit Side(Dictionary* dictionary_in)
      : dictionary(dictionary_in), standing(*dictionary), port(dictionary, &standing) {}
  Dictionary* dictionary;
  conditions::StandingConditions standing;
  ConditionPort port;
};

class Timeline {
 public:
  explicit Timeline(uint32_t seed) : random_(seed) {
    graph_ = dictionary_.InternIri("urn:w:graph");
    side_ = std::make_unique<Side>(&dictionary_);
  }

  void Run(int steps) {
    for (int step = 0; step < steps && !::testing::Test::HasFailure(); ++step) {
      SCOPED_TRACE(absl::StrCat("step ", step, " at ", now_us_));
      Step();
    }
  }
  size_t opened() const { return opened_; }

 private:
  struct Followed {
    engine::ConditionRequest request;
    Reference reference;
    std::set<engine::TermBinding> keys;  // from the edges
    bool holds = false;
  };

  uint32_t Below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  TermId Id(const std::string& name, uint32_t n) {
    return dictionary_.InternIri(absl::StrCat("urn:w:", name, n));
  }
  TermId Id(const std::string& name) { return dictionary_.InternIri(absl::StrCat("urn:w:", name)); }

  Quad AnyQuad() {
    switch (Below(5)) {
      case 0:
      case 1:
        return {Id("V", Below(3)), Id("at"), Id("B", 1 + Below(2)), graph_};
      case 2:
        return {Id("R", Below(2)), Id("free"), Id("B", 1 + Below(2)), graph_};
      case 3:
        return Below(2) == 0
                   ? Quad{Id("C", Below(2)), Id("sees"), Id("V", Below(3)), graph_}
                   : Quad{Id("V", Below(3)), dictionary_.InternIri(kRdfType), Id("Visitor"), graph_};
      default:
        return {Id("R", Below(2)), Id("battery"),
                dictionary_.Intern(Term::Literal(absl::StrCat(Below(6)), std::string(kXsdInteger))), graph_};
    }
  }

  Delta Change() {
    std::vector<Quad> add, remove;
    for (uint32_t n = Below(4); n > 0; --n) (Below(2) == 0 ? add : remove).push_back(AnyQuad());
    return writer_.Apply(add, remove);
  }

  // A turn that is rolled back leaves no trace.
  void FailingTurn() {
    const std::optional<TimeMicros> before = side_->port.NextDeadline();
    const Delta delta = Change();
    Take(delta, now_us_ + Below(6));
    if (!conditions_.empty() && Below(2) == 0) side_->port.Disarm({conditions_.begin()->first});
    engine::ConditionRequest request = Shapes()[Below(6)];
    request.handle = next_handle_ + 1000;
    ASSERT_TRUE(side_->port.Arm({request}, writer_.current(), now_us_).ok());
    writer_.Rollback();
    side_->port.Rollback();
    side_->standing.Rollback();
    EXPECT_EQ(side_->port.NextDeadline(), before);
  }

  void Take(const Delta& delta, TimeMicros now_us) {
    auto changes = side_->standing.Update(writer_.current(), delta, now_us);
    ASSERT_TRUE(changes.ok()) << changes.status();
    side_->port.Take(*changes, now_us);
    side_->port.BeginRound(writer_.current(), now_us);
  }

  void Arm() {
    engine::ConditionRequest request = Shapes()[Below(6)];
    request.handle = next_handle_++;
    ASSERT_TRUE(side_->port.Arm({request}, writer_.current(), now_us_).ok());
    Followed followed{request, Reference(request), {}, false};
    followed.reference.Look(writer_.current(), dictionary_, now_us_);
    conditions_.emplace(request.handle, std::move(followed));
  }

  // Another port continues from a snapshot.
  void StartAgain() {
    auto other = std::make_unique<Side>(&dictionary_);
    const absl::Status status =
        other->port.Restore(side_->port.Requests(), side_->port.Times(), writer_.current(), now_us_);
    ASSERT_TRUE(status.ok()) << status;
    other->port.BeginRound(writer_.current(), now_us_);
    EXPECT_TRUE(other->port.edges().empty());
    EXPECT_EQ(other->port.NextDeadline(), side_->port.NextDeadline());
    side_ = std::move(other);
    Commit();
  }

  void Commit() {
    side_->port.Commit();
    side_->standing.Commit();
    writer_.Freeze(Revision(++revision_));
  }

  void Step() {
    if (Below(8) == 0) FailingTurn();
    const std::optional<TimeMicros> due = side_->port.NextDeadline();
    // A tick at exactly that time, or a change before or after it.
    const bool tick = due && Below(3) == 0;
    now_us_ = tick ? std::max(now_us_, *due) : now_us_ + Below(4);
    Take(tick ? Delta() : Change(), now_us_);
    Compare();
    if (tick) {
      EXPECT_NE(side_->port.NextDeadline(), due);
    }
    if (conditions_.size() < 4 && Below(2) == 0) Arm();
    if (!conditions_.empty() && Below(25) == 0) {
      side_->port.Disarm({conditions_.begin()->first});
      conditions_.erase(conditions_.begin());
    }
    Commit();
    if (Below(15) == 0) StartAgain();
  }

  void Compare() {
    for (const engine::ConditionEdge& edge : side_->port.edges()) {
      const auto found = conditions_.find(edge.handle);
      ASSERT_NE(found, conditions_.end());
      Followed& followed = found->second;
      ASSERT_TRUE(!edge.rose || !followed.holds) << "it rises twice";
      if (edge.rose) followed.holds = true, ++opened_;
      if (edge.fell) followed.holds = false;
      for (const engine::TermBinding& key : edge.disappeared) ASSERT_EQ(followed.keys.erase(key), 1u);
      for (const engine::TermBinding& key : edge.appeared) ASSERT_TRUE(followed.keys.insert(key).second);
    }
    for (auto& [handle, followed] : conditions_) {
      SCOPED_TRACE(absl::StrCat("condition ", handle, ": ", followed.request.ask));
      followed.reference.Look(writer_.current(), dictionary_, now_us_);
      const auto solutions = side_->port.Solutions(handle, {}, 1000);
      ASSERT_TRUE(solutions.ok()) << solutions.status();
      const std::set<engine::TermBinding> now(solutions->begin(), solutions->end());
      ASSERT_EQ(now, followed.reference.solutions());
      ASSERT_EQ(side_->port.Holds(handle), !followed.reference.solutions().empty());
      ASSERT_EQ(followed.holds, !followed.reference.solutions().empty());
      if (!followed.request.key_variables.empty()) {
        ASSERT_EQ(followed.keys, followed.reference.keys());
      }
    }
  }

  std::mt19937 random_;
  Dictionary dictionary_;
  GraphWriter writer_{nullptr};
  TermId graph_;
  std::unique_ptr<Side> side_;
  std::map<engine::ConditionHandle, Followed> conditions_;
  engine::ConditionHandle next_handle_ = 1;
  TimeMicros now_us_ = 1000;
  uint64_t revision_ = 0;
  size_t opened_ = 0;
};

TEST(ConditionPortTest, TimesAreAsIfEverythingWereAskedAtEveryMoment) {
  size_t opened = 0;
  for (uint32_t seed = 1; seed <= 300 && !HasFailure(); ++seed) {
    SCOPED_TRACE(absl::StrCat("seed ", seed));
    Timeline timeline(seed);
    timeline.Run(80);
    opened += timeline.opened();
  }
  EXPECT_GT(opened, 500u);
}

}  // namespace
}  // namespace docent::server
