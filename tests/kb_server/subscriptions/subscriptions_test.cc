#include "kb_server/subscriptions/subscriptions.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "tests/property/reasoner_random.h"
#include "tests/reasoner/test_world.h"

namespace docent::server {
namespace {

constexpr char kPrefix[] = "PREFIX : <http://example.org/>\n";

using Bag = std::map<std::string, uint64_t>;

std::string TextOf(const std::vector<std::optional<Term>>& row) {
  std::string text;
  for (const auto& value : row) absl::StrAppend(&text, value ? ToNTriples(*value) : "-", " ");
  return text;
}

// A client that maintains the answer from its changes.
struct Client final : Subscriber {
  void Wake() override { ++wakes; }
  void Fail(const absl::Status& status) override { failed = status; }

  // Takes the available changes and records the answer at each reported revision.
  void TakeAll() {
    while (true) {
      auto next = answer->Get(position + 1);
      if (!next.ok()) {
        lost = true;
        Begin();
        return;
      }
      if (*next == nullptr) return;
      Take(**next);
    }
  }
  void Begin() {
    rows.clear();
    Take(*answer->Whole());
  }
  void Take(const AnswerChange& change) {
    position = change.number;
    boolean = change.boolean;
    for (const CountedRow& row : change.appeared) rows[TextOf(row.values)] += row.count;
    for (const CountedRow& row : change.disappeared) {
      uint64_t& count = rows[TextOf(row.values)];
      EXPECT_GE(count, row.count);
      count -= row.count;
      if (count == 0) rows.erase(TextOf(row.values));
    }
    told[change.revision.value()] = {boolean, rows};
  }

  SubscriptionAnswerPtr answer;
  absl::Status failed;
  std::atomic<int> wakes{0};
  uint64_t position = 0;
  bool boolean = false;
  bool lost = false;
  Bag rows;
  std::map<uint64_t, std::pair<bool, Bag>> told;  // by revision
};

class SubscriptionsTest : public ::testing::Test {
 protected:
  void Make(const SubscriptionLimits& limits = {}) {
    Subscriptions::Settings settings;
    settings.dictionary = &world_.dictionary;
    settings.clock = &clock_;
    settings.subscription_limits = limits;
    settings.epoch = "1";
    subscriptions_ = std::make_unique<Subscriptions>(settings);
    subscriptions_->PublishWhole(world_.writer.Freeze(Revision(revision_)));
  }

  std::shared_ptr<Client> Open(const std::string& query, TimeMicros at_least_us = 0) {
    auto client = std::make_shared<Client>();
    absl::Status status;
    subscriptions_->Open({kPrefix + query, at_least_us}, client,
                         [&](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
                           status = answer.status();
                           if (answer.ok()) client->answer = *answer;
                           return true;
                         });
    subscriptions_->Drain();
    if (client->answer != nullptr) client->Begin();
    if (!status.ok()) client->failed = status;
    return client;
  }

  void Turn(const std::vector<std::string>& add, const std::vector<std::string>& remove = {}) {
    const Delta delta = world_.Apply(add, remove);
    version_ = world_.writer.Freeze(Revision(++revision_));
    subscriptions_->Publish(version_, delta, clock_.Now());
  }

  // The answer from a new run of the query.
  std::pair<bool, Bag> Rerun(const std::string& query) {
    const sparql::Query parsed = world_.Parse(kPrefix + query);
    auto prepared = sparql::PreparedQuery::Prepare(parsed, world_.dictionary);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    sparql::RunOptions run;
    run.version = version_.get();
    if (parsed.form == sparql::Query::Form::kAsk) return {*(*prepared)->Ask(run), {}};
    Bag rows;
    EXPECT_TRUE((*prepared)
                    ->Select(run, {},
                             [&](absl::Span<const TermId> row) {
                               std::vector<std::optional<Term>> values;
                               for (TermId id : row)
                                 values.push_back(id.IsNone() ? std::optional<Term>()
                                                              : (*prepared)->Decode(id));
                               ++rows[TextOf(values)];
                               return true;
                             })
                    .ok());
    return {false, rows};
  }

  TestWorld world_;
  ManualClock clock_;
  uint64_t revision_ = 1;
  GraphVersionPtr version_ = std::make_shared<const GraphVersion>();
  std::unique_ptr<Subscriptions> subscriptions_;
};

TEST_F(SubscriptionsTest, WhoHasGoneBeforeTheAnswerIsClosed) {
  Make();
  auto client = std::make_shared<Client>();
  subscriptions_->Open({"ASK {}"}, client,
                       [](const absl::StatusOr<SubscriptionAnswerPtr>&) { return false; });
  subscriptions_->Drain();
  EXPECT_EQ(subscriptions_->counters().open, 0u);
}

TEST_F(SubscriptionsTest, TellsTheAnswerAndThenItsChanges) {
  world_.Apply({"ann at b1", "bob at b1"});
  Make();
  auto client = Open("SELECT ?who { ?who :at :b1 }");
  EXPECT_EQ(client->rows.size(), 2u);
  Turn({"cid at b1"}, {"ann at b1"});
  Turn({"cid likes ann"});  // nothing of it
  Turn({"cid at b2"});
  subscriptions_->Drain();
  EXPECT_EQ(client->wakes, 1);
  client->TakeAll();
  EXPECT_EQ(client->rows, (Bag{{"<http://example.org/bob> ", 1}, {"<http://example.org/cid> ", 1}}));
  EXPECT_EQ(subscriptions_->counters().evaluations, 3u);  // the first answer; who came and who went
}

TEST_F(SubscriptionsTest, WhoAsksForWhatIsExpensiveOrForTheTimeIsTold) {
  world_.Apply({"ann at b1"});
  Make();
  EXPECT_EQ(Open("SELECT ?who { ?who :at :b1 }")->answer->warning(), "");
  EXPECT_THAT(Open("SELECT (COUNT(*) AS ?n) { ?a ?p ?b . ?c ?q ?d }")->answer->warning(),
              ::testing::ContainsRegex("^it is expensive: .* beginning it took .*s on 1 facts"));
  EXPECT_THAT(Open("ASK { ?who :until ?t FILTER(NOW() > ?t) }")->answer->warning(),
              ::testing::HasSubstr("passing of time alone"));
  EXPECT_GT(subscriptions_->counters().evaluation_ns, 0u);
}

TEST_F(SubscriptionsTest, WhoOpensAfterTurnsThatNobodyFollowedIsAnsweredOnTheNewest) {
  Make();
  for (int n = 0; n < 50; ++n) Turn({absl::StrCat("R", n, " at B", n)});
  const auto client = Open("SELECT * WHERE { ?r :at ?b }");
  EXPECT_EQ(client->rows.size(), 50u);
  EXPECT_EQ(client->told.rbegin()->first, revision_);
  Turn({"R50 at B50"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_EQ(client->rows.size(), 51u);
  EXPECT_EQ(client->told.rbegin()->first, revision_);
}

TEST_F(SubscriptionsTest, AnAskIsNotEvaluatedWhereTheChangeCannotTurnIt) {
  world_.Apply({"ann at b1"});
  Make();
  auto client = Open("ASK { ?who :at :b1 FILTER NOT EXISTS { ?who :busy true } }");
  EXPECT_TRUE(client->boolean);
  Turn({"bob at b1"});
  subscriptions_->Drain();
  EXPECT_EQ(subscriptions_->counters().evaluations, 1u);
  Turn({}, {"ann at b1", "bob at b1"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_FALSE(client->boolean);
}

TEST_F(SubscriptionsTest, AConstantThatNobodyHasTold) {
  Make();
  auto client = Open("SELECT ?x { ?x :unheardOf :neverSeen }");
  Turn({"a p b"});
  Turn({"a unheardOf neverSeen"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_EQ(client->rows.size(), 1u);
}

TEST_F(SubscriptionsTest, AValueThatWasComputedAndIsToldLaterIsTheSameRow) {
  world_.Apply({"a n 5"});
  Make();
  auto client = Open("SELECT ?label { ?x :n ?n BIND(CONCAT(\"n\", STR(?n)) AS ?label) }");
  EXPECT_EQ(client->rows.size(), 1u);
  Turn({"a says 'n5"});
  Turn({"b n 5"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_EQ(client->rows, (Bag{{"\"n5\" ", 2}}));
}

TEST_F(SubscriptionsTest, WhatNobodyNeedsAnyMoreIsNotKeptForAClientThatFellBehind) {
  SubscriptionLimits limits;
  limits.subscription_changes_kept = 3;
  Make(limits);
  auto client = Open("SELECT ?x { ?x :p ?y }");
  for (int i = 0; i < 3; ++i) Turn({absl::StrCat("n", i, " p o")});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_FALSE(client->lost);  // at the limit
  for (int i = 3; i < 7; ++i) Turn({absl::StrCat("n", i, " p o")});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_TRUE(client->lost);  // one past it
  EXPECT_EQ(client->rows.size(), 7u);
}

TEST_F(SubscriptionsTest, LimitsAndRefusals) {
  SubscriptionLimits limits;
  limits.subscription_rows = 3;
  limits.subscriptions_open = 2;
  world_.Apply({"a p 1", "a p 2", "a p 3"});
  Make(limits);
  EXPECT_TRUE(absl::IsInvalidArgument(Open("CONSTRUCT WHERE { ?s ?p ?o }")->failed));
  EXPECT_TRUE(absl::IsInvalidArgument(Open("SELECT {")->failed));
  auto first = Open("SELECT ?x { ?x :p ?y }");
  EXPECT_TRUE(first->failed.ok()) << first->failed;
  auto second = Open("ASK { :a :p 4 }");
  auto third = Open("ASK { :a :p 5 }");
  EXPECT_TRUE(absl::IsResourceExhausted(third->failed)) << third->failed;
  Turn({"a p 4"});
  subscriptions_->Drain();
  EXPECT_TRUE(absl::IsResourceExhausted(first->failed)) << first->failed;
  EXPECT_NE(first->failed.message().find("subscription_rows"), std::string::npos);
  second->TakeAll();
  EXPECT_TRUE(second->boolean);
  EXPECT_EQ(subscriptions_->counters().open, 1u);
}

TEST_F(SubscriptionsTest, ManyClientsOfOneQueryShareItAndAClosedOneIsNotWoken) {
  Make();
  std::vector<std::shared_ptr<Client>> clients;
  for (int i = 0; i < 50; ++i) clients.push_back(Open("ASK { :a :p :b }"));
  EXPECT_EQ(subscriptions_->counters().queries, 1u);
  subscriptions_->Close(clients[0]);
  Turn({"a p b"});
  subscriptions_->Drain();
  EXPECT_EQ(clients[0]->wakes, 0);
  EXPECT_EQ(clients[1]->wakes, 1);
  EXPECT_EQ(subscriptions_->counters().evaluations, 2u);
}

TEST_F(SubscriptionsTest, WhoeverClosesTheOthersAreStillWoken) {
  Make();
  std::vector<std::shared_ptr<Client>> clients;
  for (int i = 0; i < 8; ++i) clients.push_back(Open("ASK { :a :p :b }"));
  int turns = 0;
  for (const size_t closed : {3u, 7u, 0u, 6u, 2u, 1u, 5u, 4u}) {
    subscriptions_->Close(clients[closed]);
    subscriptions_->Close(clients[closed]);  // has gone: nothing happens
    clients[closed]->wakes = -1;
    if (++turns % 2 == 1) {
      Turn({"a p b"});
    } else {
      Turn({}, {"a p b"});
    }
    subscriptions_->Drain();
    for (const auto& client : clients) EXPECT_EQ(client->wakes, client->wakes < 0 ? -1 : turns);
  }
  EXPECT_EQ(subscriptions_->counters().open, 0u);
}

TEST_F(SubscriptionsTest, OfQueriesThatNobodyFollowsTheOldestGoBeyondAThousand) {
  Make();
  std::vector<std::shared_ptr<Client>> clients;
  const auto query = [](size_t i) { return absl::StrCat("ASK { :a", i, " :p :b }"); };
  for (size_t i = 0; i < 1010; ++i) clients.push_back(Open(query(i)));
  const auto follows_again = Open(query(0));
  for (const auto& client : clients) subscriptions_->Close(client);
  for (int i = 0; i < 100 && subscriptions_->counters().queries > 1001; ++i)
    absl::SleepFor(absl::Milliseconds(50));
  EXPECT_EQ(subscriptions_->counters().queries, 1001u);  // a thousand, and the one that is followed
  const auto back = Open(query(1009));
  EXPECT_EQ(back->answer, clients[1009]->answer);  // kept: it goes on
  EXPECT_EQ(follows_again->answer, clients[0]->answer);
  Turn({"a0 p b", "a1009 p b"});
  subscriptions_->Drain();
  EXPECT_EQ(follows_again->wakes, 1);
  EXPECT_EQ(back->wakes, 1);
}

TEST_F(SubscriptionsTest, TheSumOfChangesIsTheirNet) {
  Make();
  auto client = Open("SELECT ?x { ?x :p ?y }");
  Turn({"a p 1"});
  Turn({"a p 2", "b p 1"});
  Turn({}, {"b p 1"});
  subscriptions_->Drain();
  auto sum = client->answer->Sum(1);
  ASSERT_TRUE(sum.ok() && *sum != nullptr);
  ASSERT_EQ((*sum)->appeared.size(), 1u);
  EXPECT_EQ((*sum)->appeared[0].count, 2u);
  EXPECT_TRUE((*sum)->disappeared.empty());
  EXPECT_EQ((*sum)->number, 3u);
}

// The cost of one query does not depend on the number of queries that differ only in constants.
TEST_F(SubscriptionsTest, AlikeQueriesShareWhatAChangeCosts) {
  for (int n = 0; n < 200; ++n) world_.Apply({absl::StrCat("item", n, " ownedBy owner", n)});
  world_.Apply({"ann carries nothing", "sensor reading 0"});
  Make();
  std::vector<std::shared_ptr<Client>> carriers, levels;
  for (int n = 0; n < 200; ++n) {
    carriers.push_back(Open(absl::StrCat("SELECT ?v { ?v :carries ?item . ?item :ownedBy :owner", n, " }")));
    levels.push_back(Open(absl::StrCat("ASK { ?s :reading ?value FILTER(?value > ", n, ") }")));
  }
  const uint64_t before = subscriptions_->counters().evaluations;
  for (int turn = 0; turn < 50; ++turn) {
    Turn({absl::StrCat("bob", turn, " carries item", turn)});
    Turn({absl::StrCat("sensor reading ", turn + 1)});
  }
  subscriptions_->Drain();
  EXPECT_LE(subscriptions_->counters().evaluations - before, 200u);
  for (int n = 0; n < 200; ++n) {
    carriers[n]->TakeAll();
    levels[n]->TakeAll();
    EXPECT_EQ(carriers[n]->rows.size(), n < 50 ? 1u : 0u) << n;
    EXPECT_EQ(levels[n]->boolean, n < 50) << n;
  }
}

// A row of a SELECT without DISTINCT counts once for each solution with it.
TEST_F(SubscriptionsTest, RowsAreCountedWhereVariablesAreHidden) {
  world_.Apply({"ann carries cup", "cup ownedBy bob"});
  Make();
  const auto bag = Open("SELECT ?v { ?v :carries ?item . ?item :ownedBy :bob }");
  const auto set = Open("SELECT DISTINCT ?v { ?v :carries ?item . ?item :ownedBy :bob }");
  const std::string ann = "<http://example.org/ann> ";
  Turn({"ann carries pen", "pen ownedBy bob"});
  subscriptions_->Drain();
  bag->TakeAll();
  set->TakeAll();
  EXPECT_EQ(bag->rows, (Bag{{ann, 2}}));
  EXPECT_EQ(set->rows, (Bag{{ann, 1}}));
  Turn({"ann carries key", "key ownedBy bob"}, {"ann carries pen"});  // one for another: the same answer
  subscriptions_->Drain();
  EXPECT_EQ(bag->wakes, 1);
  Turn({}, {"ann carries cup", "key ownedBy bob"});
  subscriptions_->Drain();
  bag->TakeAll();
  set->TakeAll();
  EXPECT_TRUE(bag->rows.empty());
  EXPECT_TRUE(set->rows.empty());
}

TEST_F(SubscriptionsTest, WhatTakesTooLongIsEndedAndTheOthersGoOn) {
  SubscriptionLimits limits;
  limits.subscription_evaluation_ms = 1;
  world_.Apply({"ann at b1", "a p 1", "a q 2"});
  Make(limits);
  const auto pairs = Open("ASK { ?a :p ?x . ?b :q ?y FILTER(?x * ?y = 0) }");
  const auto light = Open("SELECT ?who { ?who :at :b1 }");
  ASSERT_TRUE(pairs->failed.ok()) << pairs->failed;
  std::vector<std::string> many = {"bob at b1"};
  for (int n = 1; n < 2000; ++n) {
    many.push_back(absl::StrCat("a", n, " p ", n));
    many.push_back(absl::StrCat("a", n, " q ", n));
  }
  Turn(many);
  subscriptions_->Drain();
  EXPECT_TRUE(absl::IsDeadlineExceeded(pairs->failed)) << pairs->failed;
  EXPECT_NE(pairs->failed.message().find("subscription_evaluation_ms"), std::string::npos);
  Turn({"cid at b1"});
  subscriptions_->Drain();
  ASSERT_TRUE(light->failed.ok()) << light->failed;
  light->TakeAll();
  EXPECT_EQ(light->rows.size(), 3u);
}

TEST_F(SubscriptionsTest, ARowIsToldWhenItHasLastedAndGoesAtOnce) {
  world_.Apply({"old at b1"});
  clock_.Set(1'000'000);
  Make();
  clock_.Set(2'000'000);
  const auto client = Open("SELECT ?who { ?who :at :b1 }", 5'000'000);
  const auto at_once = Open("SELECT ?who { ?who :at :b1 }");
  EXPECT_TRUE(client->rows.empty());
  EXPECT_EQ(at_once->rows.size(), 1u);
  Turn({"ann at b1", "bob at b1"});
  clock_.Set(6'000'000);  // old is there since 1, the others since 2
  Turn({"cid likes ann"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_EQ(client->rows, (Bag{{"<http://example.org/old> ", 1}}));
  Turn({}, {"bob at b1"});
  Turn({"bob at b1"});  // whose time begins anew
  clock_.Set(8'000'000);
  Turn({}, {"old at b1"});
  subscriptions_->Drain();
  client->TakeAll();
  EXPECT_EQ(client->rows, (Bag{{"<http://example.org/ann> ", 1}}));
  clock_.Set(11'000'000);  // no turn: the clock alone
  for (int i = 0; i < 200 && client->rows.size() < 2; ++i) {
    absl::SleepFor(absl::Milliseconds(20));
    client->TakeAll();
  }
  EXPECT_EQ(client->rows, (Bag{{"<http://example.org/ann> ", 1}, {"<http://example.org/bob> ", 1}}));
  EXPECT_EQ(client->told.rbegin()->first, revision_);
}

TEST_F(SubscriptionsTest, TurnsLookedAtTogetherMakeNothingLast) {
  SubscriptionLimits limits;
  limits.subscription_backlog = 1;
  world_.Apply({"v0 at b1"});
  Make(limits);
  const auto client = Open("SELECT ?who { ?who :at :b1 }", 5'000'000);
  for (int i = 1; i < 300; ++i) {  // so many at once that some are looked at together
    clock_.Set(clock_.Now() + 4'000'000);
    Turn({absl::StrCat("v", i, " at b1")}, {absl::StrCat("v", i - 1, " at b1")});
  }
  subscriptions_->Drain();
  EXPECT_GT(subscriptions_->counters().coalesced, 0u);
  client->TakeAll();
  EXPECT_EQ(client->position, 0u);
}

TEST_F(SubscriptionsTest, WhatHasBeenSoForLongIsInTheFirstAnswer) {
  world_.Apply({"ann at b1"});
  clock_.Set(1'000'000);
  Make();
  clock_.Set(60'000'000);
  EXPECT_EQ(Open("SELECT ?who { ?who :at :b1 }", 5'000'000)->rows.size(), 1u);
  EXPECT_TRUE(Open("ASK { FILTER NOT EXISTS { ?who :at :b2 } }", 30'000'000)->boolean);
  EXPECT_FALSE(Open("ASK { FILTER NOT EXISTS { ?who :at :b2 } }", 90'000'000)->boolean);
}

TEST_F(SubscriptionsTest, YesIsToldOnceItHasLasted) {
  Make();
  const auto lasting = Open("ASK { :ann :at :b1 }", 5'000'000);
  Turn({"ann at b1"});
  clock_.Set(4'000'000);
  Turn({}, {"ann at b1"});
  Turn({"ann at b1"});
  clock_.Set(8'000'000);
  Turn({"x p y"});
  subscriptions_->Drain();
  EXPECT_EQ(lasting->wakes, 0);
  clock_.Set(9'000'000);
  Turn({}, {"ann at b1"});  // which had lasted
  subscriptions_->Drain();
  ASSERT_TRUE(lasting->answer->Get(1).ok() && lasting->answer->Get(2).ok());
  EXPECT_TRUE((*lasting->answer->Get(1))->boolean);
  EXPECT_EQ((*lasting->answer->Get(1))->revision, Revision(revision_ - 1));
  EXPECT_FALSE((*lasting->answer->Get(2))->boolean);
  EXPECT_EQ((*lasting->answer->Get(2))->revision, Revision(revision_));
}

// Results of running a query again, and the time since which each row is there.
class Reference {
 public:
  void Set(TimeMicros now_us, const std::pair<bool, Bag>& answer) {
    if (answer.first && !answer_.first) since_ = now_us;
    std::map<std::string, TimeMicros> rows;
    for (const auto& [row, count] : answer.second) {
      const auto known = rows_since_.find(row);
      rows[row] = known == rows_since_.end() ? now_us : known->second;
    }
    rows_since_ = std::move(rows);
    answer_ = answer;
  }
  std::pair<bool, Bag> Lasting(TimeMicros now_us, TimeMicros at_least_us) const {
    std::pair<bool, Bag> lasting{answer_.first && now_us - since_ >= at_least_us, {}};
    for (const auto& [row, since_us] : rows_since_) {
      if (now_us - since_us >= at_least_us) lasting.second[row] = answer_.second.at(row);
    }
    return lasting;
  }

 private:
  std::pair<bool, Bag> answer_;
  TimeMicros since_ = 0;
  std::map<std::string, TimeMicros> rows_since_;
};

// Replaying the changes gives, at every revision, the same answer as a new run of the query. If rows must
// last: the lasting part of it, just before the next revision.
class SubscriptionsReplayTest : public SubscriptionsTest, public ::testing::WithParamInterface<TimeMicros> {};
INSTANTIATE_TEST_SUITE_P(AtLeastUs, SubscriptionsReplayTest, ::testing::Values(0, 2'000'000));

TEST_P(SubscriptionsReplayTest, ReplayedChangesAreTheAnswerAtEachRevision) {
  std::vector<std::string> queries = {
      "SELECT ?x ?y { ?x :p0 ?y }",
      "SELECT ?x { ?x :p0 ?y . ?y :p1 ?z }",
      "SELECT DISTINCT ?x ?z { ?x :p0 ?y . ?y :p1 ?z FILTER(?x != ?z) }",
      "SELECT ?x ?v { ?x :p1 ?v FILTER(?v > 2) }",
      "SELECT ?x ?v ?w { ?x :p1 ?v OPTIONAL { ?x :p2 ?w } }",
      "SELECT ?x (COUNT(?y) AS ?n) { ?x :p0 ?y } GROUP BY ?x",
      "SELECT ?x ?s { ?x :p3 ?v BIND(CONCAT(STR(?v), \"!\") AS ?s) }",
      "SELECT ?x { ?x :p0 ?y MINUS { ?y :p1 ?x } }",
      "SELECT ?x ?y { ?x :p0+ ?y }",
      "SELECT ?x ?y { ?x ?p ?y } ORDER BY ?x LIMIT 4",
      "SELECT ?g ?x { GRAPH ?g { ?x :p2 ?y } }",
      "SELECT ?g { GRAPH ?g {} }",
      "SELECT ?g ?k { GRAPH ?g { VALUES ?k { 1 2 } } }",
      "ASK { GRAPH :g1 { BIND(1 AS ?k) } }",
      "SELECT ?g ?n { GRAPH ?g { SELECT (COUNT(*) AS ?n) { ?x :p1 ?y } } }",
      "SELECT ?x { ?x :p0 ?y FILTER NOT EXISTS { GRAPH :g0 { FILTER(true) } } }",
      "SELECT ?x ?k { ?x :p1 ?v OPTIONAL { GRAPH :g1 { VALUES ?k { 1 } } } }",
      "SELECT ?y { GRAPH :g0 { :n1 :p0* ?y } }",
      "ASK { :n0 :p0 ?x . ?x :p1 ?y }",
      "ASK { ?x :p2 ?v FILTER(?v < 3) FILTER NOT EXISTS { ?x :p0 ?v } }",
      "ASK { ?x :p3 :n1 } ",
      "SELECT ?x ?y { { ?x :p0 ?y } UNION { ?y :p3 ?x } }",
      "SELECT DISTINCT ?x ?y { { ?x :p0 ?y } UNION { ?y :p3 ?x } }",
      "SELECT * { ?x :p0 [] . ?x :p3 ?z }",
      "SELECT ?z { ?x :p0 ?y . ?y :p0 ?z FILTER EXISTS { ?z :p1 ?w } }",
      "SELECT REDUCED ?x { ?x :p0 ?y }",
      "SELECT ?y ?x { ?x :p2 ?y } ORDER BY ?x",
  };
  for (int n = 0; n < 10; ++n) {  // so many that differ only in a constant share their work
    queries.push_back(absl::StrCat("ASK { ?x :p1 ?v FILTER(?v > ", n, ") }"));
    queries.push_back(absl::StrCat("SELECT ?x { ?x :p0 ?y . ?y :p3 :n", n, " }"));
    queries.push_back(absl::StrCat("ASK { ?x :p0 :n", n, " FILTER NOT EXISTS { ?x :p2 ?y } }"));
  }
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    RandomWorld random(seed);
    std::set<std::string> told;  // what earlier rounds left is just more data
    subscriptions_.reset();
    Make();
    const GraphVersionPtr opened = world_.writer.Freeze(Revision(revision_));
    std::vector<std::shared_ptr<Client>> clients;
    for (const std::string& query : queries) clients.push_back(Open(query, GetParam()));
    std::vector<std::map<uint64_t, std::pair<bool, Bag>>> truth(queries.size());
    std::vector<Reference> references(queries.size());
    const uint64_t first = revision_;
    version_ = opened;
    for (size_t q = 0; q < queries.size(); ++q) references[q].Set(clock_.Now(), Rerun(queries[q]));
    for (int turn = 0; turn < 40; ++turn) {
      const RandomBatch batch = random.Batch(told);
      clock_.Set(clock_.Now() + random.Pick(4) * TimeMicros{500'000});
      for (size_t q = 0; q < queries.size(); ++q)
        truth[q][revision_] = references[q].Lasting(clock_.Now(), GetParam());
      Turn(batch.add, batch.remove);
      for (size_t q = 0; q < queries.size(); ++q) {
        references[q].Set(clock_.Now(), Rerun(queries[q]));
        truth[q][revision_] = references[q].Lasting(clock_.Now(), GetParam());
      }
      if (random.Chance(30)) subscriptions_->Drain();
    }
    subscriptions_->Drain();
    for (size_t q = 0; q < queries.size(); ++q) {
      SCOPED_TRACE(queries[q]);
      ASSERT_TRUE(clients[q]->failed.ok()) << clients[q]->failed;
      clients[q]->TakeAll();
      for (uint64_t revision = first + 1; revision <= revision_; ++revision) {
        // as of the newest change up to it
        auto known = clients[q]->told.upper_bound(revision);
        ASSERT_NE(known, clients[q]->told.begin());
        ASSERT_EQ(std::prev(known)->second, truth[q][revision]) << "revision " << revision;
      }
    }
  }
}

}  // namespace
}  // namespace docent::server
