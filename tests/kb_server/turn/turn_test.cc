#include "kb_server/turn/turn.h"
#include "reasoner/rules/rule_sets.h"

#include <algorithm>
#include <memory>

#include "gmock/gmock.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Iri;
using test::Put;
using test::Tell;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Stages with their dependencies.
struct World {
  explicit World(const Limits& limits = {}) : stages(&dictionary, &functions, limits) {}

  absl::StatusOr<TurnResult> Turn(WriteBatch batch) {
    batch.time_us = now_us += 1000;
    absl::StatusOr<TurnResult> result = RunTurn(&stages, std::move(batch), head + 1);
    if (result.ok()) ++head;
    return result;
  }
  // A turn that must succeed.
  TurnResult Must(WriteBatch batch) {
    absl::StatusOr<TurnResult> result = Turn(std::move(batch));
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  bool Has(const TermQuad& triple) const {
    auto s = dictionary.Find(triple.subject), p = dictionary.Find(triple.predicate),
         o = dictionary.Find(triple.object);
    return s && p && o && stages.writer.current().Count({*s, *p, *o, {}}) > 0;
  }
  std::string Value(const std::string& subject, const std::string& predicate) const {
    auto s = dictionary.FindIri(test::Name(subject));
    return s ? GraphReader(dictionary, stages.writer.current()).Object(*s, test::Name(predicate)) : "";
  }

  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  Stages stages;
  uint64_t head = 0;
  TimeMicros now_us = 1'700'000'000'000'000;
};

// The id of the command that is open for this run.
CommandId OpenCommandOf(const World& world, const std::string& run) {
  for (const auto& [command, ending, recalled] : world.stages.engine.OpenCommands()) {
    if (command.id.value().starts_with(absl::StrCat(run, "/"))) return command.id;
  }
  return CommandId("none");
}

// All visible state of a world, as text.
std::string Dump(const World& world) {
  std::vector<std::string> lines;
  world.stages.writer.current().ForEach({}, [&](const Quad& quad) {
    const Dictionary& d = world.dictionary;
    lines.push_back(absl::StrCat(ToNTriples(d.Decode(quad.subject)), " ",
                                 ToNTriples(d.Decode(quad.predicate)), " ", ToNTriples(d.Decode(quad.object)),
                                 " ", ToNTriples(d.Decode(quad.graph))));
    return true;
  });
  std::sort(lines.begin(), lines.end());
  for (const std::string& name : world.stages.rules.names()) lines.push_back("rules " + name);
  lines.push_back(absl::StrCat("rule count ", world.stages.rules.rule_count()));
  lines.push_back(absl::StrCat("conditions ", world.stages.standing_conditions.size()));
  lines.push_back(absl::StrCat("live runs ", world.stages.engine.live_runs()));
  for (const auto& document : world.stages.engine.workflows())
    lines.push_back("workflow " + document->name.value);
  for (const auto& plan : world.stages.engine.services().Plans()) lines.push_back("service " + plan->process);
  for (const auto& [command, ending, recalled] : world.stages.engine.OpenCommands())
    lines.push_back("open " + command.id.value());
  std::shared_ptr<const Catalog> catalog = world.stages.documents.MakeCatalog(world.stages.engine);
  for (const ModuleEntry& m : catalog->modules) {
    lines.push_back(absl::StrCat("module ", m.name, " ", m.size, " ", m.revision.value()));
  }
  lines.push_back(absl::StrCat("deadline ", world.stages.NextDeadline().value_or(-1)));
  std::string text;
  for (const std::string& line : lines) absl::StrAppend(&text, line, "\n");
  return text;
}

std::vector<std::string> Steps(const TurnResult& result) {
  std::vector<std::string> steps;
  for (const Transition& t : result.record.transitions)
    steps.push_back(t.subject + " " + t.from + ">" + t.to);
  return steps;
}

void SetUpGreeting(World* world) {
  world->Must(test::WorldFacts());
  world->Must(Put(Document::Kind::kRules, "near.rules", test::kRules));
  world->Must(Put(Document::Kind::kCawl, "greeting.xml", test::kGreeting));
}

TEST(TurnTest, ANewValueOfAStatePropertyReplacesTheOldOneOfTheSameSource) {
  World world;
  world.Must(test::WorldFacts());
  TurnResult result = world.Must(Tell({Fact("R1", "docent:isAt", "Garden")}));
  EXPECT_EQ(result.delta.added.size(), 1u);
  EXPECT_EQ(result.delta.removed.size(), 1u);
  EXPECT_TRUE(world.Has(Fact("R1", "docent:isAt", "Garden")));
  EXPECT_FALSE(world.Has(Fact("R1", "docent:isAt", "Hall")));

  WriteBatch other = Tell({Fact("R1", "docent:isAt", "Cellar")});
  other.source = "urn:w:Camera";
  world.Must(other);
  EXPECT_TRUE(world.Has(Fact("R1", "docent:isAt", "Garden")));
  EXPECT_TRUE(world.Has(Fact("R1", "docent:isAt", "Cellar")));
}

TEST(TurnTest, AReadingBecomesTheFactThatItsMappingMeans) {
  World world;
  world.Must(test::WorldFacts());
  TurnResult result = world.Must(test::Reading("tag-17"));
  EXPECT_TRUE(world.Has(Fact("John", "docent:isAt", "Hall")));
  EXPECT_THAT(result.record.batch.operations, IsEmpty()) << "the log keeps what came in";
  EXPECT_THAT(std::string(world.Turn(test::Reading("tag-99")).status().message()), HasSubstr("readings[0]"));
}

TEST(TurnTest, AReadingARuleAConstraintAndAWorkflowActInOneTurn) {
  World world;
  SetUpGreeting(&world);
  TurnResult started = world.Must(test::Start("Greeting"));
  EXPECT_THAT(started.started, ElementsAre(RunId("Greet-1")));
  EXPECT_THAT(Steps(started), Contains("Greet-1/Hello inactive>waiting"));
  EXPECT_THAT(started.record.commands, IsEmpty());

  TurnResult result = world.Must(test::Reading("tag-17"));
  EXPECT_TRUE(world.Has(Fact("John", "docent:isNear", "R1")));
  EXPECT_THAT(Steps(result), Contains("Greet-1/Hello waiting>running"));
  ASSERT_EQ(result.record.commands.size(), 1u);
  const RobotCommand& command = result.record.commands[0];
  EXPECT_EQ(command.operation, "greet");
  EXPECT_EQ(command.robot, RobotId("urn:w:R1"));
  EXPECT_EQ(command.expected_incarnation, "i1");
  EXPECT_EQ(command.guard_revision, Revision(world.head));
  EXPECT_EQ(world.Value("urn:docent:run:Greet-1/Hello", "docent:firedBecause"),
            "<urn:w:John> <https://w3id.org/docent#isNear> <urn:w:R1> .\n");
  EXPECT_EQ(result.version->revision(), Revision(world.head));
  EXPECT_EQ(result.inferred, 1u);
}

TEST(TurnTest, EvidenceIsOfTheAlternativeThatHoldsAndOfFactsAlone) {
  World world;
  world.Must(test::WorldFacts());
  const auto say = [](const std::string& name, const std::string& subject, const std::string& verb,
                      const std::string& object) {
    return "<constraint name=\"" + name + "\"><subject>" + subject + "</subject><verb>&lt;urn:w:" + verb +
           "&gt;</verb><object>" + object + "</object></constraint>";
  };
  world.Must(test::Put(
      Document::Kind::kCawl, "search.xml",
      "<CAWL name=\"Search\" namespace=\"urn:w:\" version=\"1\"><activator name=\"Act\"><activate "
      "flow=\"F\"/>"
      "<condition><context name=\"C\"><rule name=\"r\" expression=\"(a and b) or c or d or (e and f)\">" +
          say("a", "?who", "likes", "?thing") + say("b", "?thing", "inRoom", "?room") +
          say("c", "?who", "status", "&lt;urn:w:Gone&gt;") + say("d", "?who", "lost", "?why") +
          say("e", "?who", "knows", "?other") + say("f", "?other", "knows", "?who") +
          "</rule></context></condition></activator><flow name=\"F\"><source name=\"s\"/>"
          "<node name=\"n\"/><sink name=\"t\"/><link from=\"s\" to=\"n\"/><link from=\"n\" "
          "to=\"t\"/></flow></CAWL>"));
  world.Must(test::Tell({Fact("t1", "inRoom", "r1"), Fact("t2", "inRoom", "r2")}));
  const auto cause = [&](const std::vector<TermQuad>& facts) {
    const TurnResult result = world.Must(test::Tell(facts));
    const std::vector<Transition>& all = result.record.transitions;
    const auto activated = std::find_if(all.begin(), all.end(),
                                        [](const Transition& t) { return t.cause.starts_with("activator"); });
    return activated == all.end() ? "" : activated->cause;
  };
  EXPECT_EQ(cause({Fact("V1", "likes", "t1")}),
            "activator Act: <urn:w:V1> <urn:w:likes> <urn:w:t1> . <urn:w:t1> <urn:w:inRoom> <urn:w:r1> . ");
  EXPECT_EQ(cause({Fact("V2", "status", "Gone")}),
            "activator Act: <urn:w:V2> <urn:w:status> <urn:w:Gone> . ");
  EXPECT_EQ(cause({Fact("V3", "knows", "V3")}),
            "activator Act: <urn:w:V3> <urn:w:knows> <urn:w:V3> . ");  // two patterns
}

TEST(TurnTest, AConditionThatHoldsAlreadyFiresInTheTurnThatStartsTheRun) {
  World world;
  SetUpGreeting(&world);
  world.Must(test::Reading("tag-17"));
  TurnResult result = world.Must(test::Start("Greeting"));
  EXPECT_EQ(result.record.commands.size(), 1u);
}

TEST(TurnTest, ARunGoesToItsEnd) {
  World world;
  SetUpGreeting(&world);
  world.Must(test::Reading("tag-17"));
  TurnResult hello = world.Must(test::Start("Greeting"));
  ASSERT_EQ(hello.record.commands.size(), 1u);
  world.Must(test::Report(hello.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_EQ(world.Value("urn:docent:run:Greet-1/Goodbye", "docent:nodeState"), "waiting");
  EXPECT_THAT(world.Value("urn:docent:run:Greet-1/Goodbye", "docent:waitsFor"), HasSubstr("urn:w:John"));
  TurnResult goodbye = world.Must(Tell({Fact("John", "docent:feels", "docent:Glad")}));
  ASSERT_EQ(goodbye.record.commands.size(), 1u);
  TurnResult end =
      world.Must(test::Report(goodbye.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_THAT(Steps(end), Contains("Greet-1 running>done"));
  EXPECT_EQ(world.stages.engine.live_runs(), 0u);
  EXPECT_EQ(world.stages.standing_conditions.size(), 0u);
}

TEST(TurnTest, AFactWithALifetimeIsWithdrawnByTheClock) {
  World world;
  SetUpGreeting(&world);
  WriteBatch seen = Tell({Fact("John", "docent:isAt", "Hall")});
  seen.lifetime_ms = 60;
  world.Must(seen);
  EXPECT_TRUE(world.Has(Fact("John", "docent:isNear", "R1")));
  ASSERT_TRUE(world.stages.NextDeadline().has_value());
  world.now_us = *world.stages.NextDeadline();
  WriteBatch tick;
  tick.clock_tick = true;
  world.Must(tick);
  EXPECT_FALSE(world.Has(Fact("John", "docent:isNear", "R1"))) << "what rules derived from it goes too";
  EXPECT_FALSE(world.stages.NextDeadline().has_value());
}

// A failed turn must have no effect: the state after it is compared with the state before, and later turns
// with a twin that never had it.
class FailingTurnTest : public ::testing::Test {
 protected:
  static Limits SmallLimits() {
    Limits limits;
    limits.inferred_per_turn = 200;
    limits.engine_rounds_per_turn = 6;
    limits.steps_per_turn = 100000;
    limits.steps_per_fact = 1;
    return limits;
  }

  FailingTurnTest() : world_(SmallLimits()), twin_(SmallLimits()) {
    for (World* world : {&world_, &twin_}) {
      SetUpGreeting(world);
      world->Must(Put(Document::Kind::kCawl, "called.xml", test::kCalled));
      world->Must(Put(Document::Kind::kRsel, "services.xml", test::kServices));
      world->Must(test::Start("Greeting"));
      WriteBatch seen = Tell({Fact("Mary", "docent:isAt", "Garden")});
      seen.lifetime_ms = 1'000'000;
      world->Must(seen);
    }
  }

  // Applies `batch` in the world only, where it must fail.
  void Fail(WriteBatch batch, absl::StatusCode code, const std::string& message) {
    std::string before = Dump(world_);
    TimeMicros now_us = world_.now_us;
    const size_t terms = world_.dictionary.size();
    absl::StatusOr<TurnResult> result = world_.Turn(std::move(batch));
    world_.now_us = now_us;
    EXPECT_EQ(result.status().code(), code) << result.status();
    EXPECT_THAT(std::string(result.status().message()), HasSubstr(message));
    EXPECT_EQ(Dump(world_), before);
    EXPECT_EQ(world_.dictionary.size(), terms) << "its terms are gone";
  }

  void GoOn() {
    std::vector<WriteBatch> batches;
    batches.push_back(test::Reading("tag-17"));
    batches.push_back(
        Tell({Fact("John", "docent:calls", "R1"), Fact("John", "docent:feels", "docent:Glad")}));
    batches.push_back(test::Report(OpenCommandOf(world_, "Greet-1"), CommandReport::Outcome::kSucceeded));
    batches.push_back(Put(Document::Kind::kRules, "near.rules", test::kRules));
    batches.push_back(test::Start("Greeting"));
    batches.push_back(Tell({}, {Fact("John", "docent:isAt", "Hall")}));
    for (WriteBatch& batch : batches) {
      TurnResult result = world_.Must(batch);
      TurnResult expected = twin_.Must(batch);
      EXPECT_EQ(result.record, expected.record);
      EXPECT_EQ(result.inferred, expected.inferred);
      EXPECT_EQ(Dump(world_), Dump(twin_));
    }
    EXPECT_GE(world_.stages.engine.live_runs(), 2u);
  }

  World world_;
  World twin_;
};

TEST_F(FailingTurnTest, ABadTerm) {
  Fail(Tell({Fact("John", "docent:isAt", "Hall"), {Term::Literal("x"), Iri("p"), Iri("o"), Term()}}),
       absl::StatusCode::kInvalidArgument, "add[1]: subject");
  Fail(Tell({{Iri("s"), Iri("p"), Iri("o"), Term::Iri(std::string(kRunsGraph))}}),
       absl::StatusCode::kInvalidArgument, "graph");
  GoOn();
}

// A logged turn is never refused at replay, which has no cancellation.
TEST_F(FailingTurnTest, ARuleWithACostlyJoin) {
  Cancellation cancellation;
  world_.stages.cancellation = &cancellation;
  WriteBatch batch = Put(Document::Kind::kRules, "cross.rules",
                         "RULE { ?a <urn:w:r> ?b } WHERE { ?a <urn:w:in> ?x . ?b <urn:w:in> ?y . ?c "
                         "<urn:w:in> ?z FILTER(?a = ?z) }");
  for (int i = 0; i < 100; ++i) {
    batch.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "in", "Set")});
  }
  Fail(batch, absl::StatusCode::kResourceExhausted, "steps_per_turn");
  GoOn();
  twin_.Must(batch);
}

// Older versions accepted constructs that XPath's regular expressions do not have: a log with such a rule is
// still replayed.
TEST_F(FailingTurnTest, ARuleWithAPatternThatCannotBeEvaluated) {
  Cancellation cancellation;
  world_.stages.cancellation = &cancellation;
  const WriteBatch batch =
      Put(Document::Kind::kRules, "pattern.rules",
          "RULE { ?a <urn:w:r> ?b } WHERE { ?a <urn:w:in> ?b FILTER(REGEX(STR(?b), \"(?i)hall\")) }");
  Fail(batch, absl::StatusCode::kInvalidArgument, "'(?i' is not a group of XPath's regular expressions");
  GoOn();
  twin_.Must(batch);
}

// Much follows from few facts, and every fact that followed allowed more steps.
TEST_F(FailingTurnTest, TooManyEqualThings) {
  Cancellation cancellation;
  world_.stages.cancellation = &cancellation;
  for (World* world : {&world_, &twin_}) {
    world->stages.cancellation = nullptr;
    world->Must(Put(Document::Kind::kRules, "owl2rl", rules::BuiltInRuleSet("owl2rl")));
  }
  world_.stages.cancellation = &cancellation;
  WriteBatch batch;
  for (int i = 1; i < 200; ++i) {
    const Term same = Term::Iri("http://www.w3.org/2002/07/owl#sameAs");
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd, {Iri("n0"), same, Iri(absl::StrCat("n", i)), Term()}});
  }
  Fail(batch, absl::StatusCode::kResourceExhausted, "owl2rl eq-trans");
  GoOn();
}

// Its place was shown with a line of the other rule set.
TEST_F(FailingTurnTest, ARuleThatClosesACycleWithAnotherSet) {
  for (World* world : {&world_, &twin_}) {
    world->Must(
        Put(Document::Kind::kRules, "w.rules",
            "# free\nRULE { ?x a <urn:w:Free> } WHERE { ?x a <urn:w:Robot> NOT { ?x a <urn:w:Busy> } }"));
  }
  Fail(Put(Document::Kind::kRules, "b.rules",
           "# busy\n\nRULE { ?x a <urn:w:Busy> } WHERE { ?x a <urn:w:Free> }"),
       absl::StatusCode::kInvalidArgument,
       "w.rules:2:1: error: negation through recursion: w.rules rule 1 (line 2) negates the results of "
       "b.rules rule 1 (line 3), "
       "which needs w.rules rule 1 (line 2)\n  RULE { ?x a <urn:w:Free> }");
  GoOn();
}

// As for a rule: the batch that makes it too costly is refused.
TEST_F(FailingTurnTest, AStandingConditionWithACostlyJoin) {
  Cancellation cancellation;
  world_.stages.cancellation = &cancellation;
  std::vector<TermQuad> facts;
  for (int i = 0; i < 100; ++i) facts.push_back(Fact(absl::StrCat("n", i), "in", absl::StrCat("s", i)));
  for (World* world : {&world_, &twin_}) {
    world->Must(Tell(facts));
    ASSERT_TRUE(world->stages.conditions
                    .Arm({{engine::ConditionHandle{1} << 40,
                           "ASK { ?a <urn:w:in> ?x . ?b <urn:w:in> ?y . ?c <urn:w:in> ?z . ?go <urn:w:go> ?d "
                           "FILTER(?a = ?z) }"}},
                         world->stages.writer.current(), world->now_us)
                    .ok());
    world->stages.Commit();
  }
  WriteBatch batch = Tell({Fact("R1", "go", "Hall")});
  Fail(batch, absl::StatusCode::kResourceExhausted, "steps_per_turn");
  GoOn();
  twin_.Must(batch);
}

TEST_F(FailingTurnTest, ARuleThatInfersBeyondTheLimit) {
  WriteBatch batch = Put(Document::Kind::kRules, "pairs.rules",
                         "RULE { ?a <urn:w:pair> ?b } WHERE { ?a <urn:w:in> ?x . ?b <urn:w:in> ?x }");
  for (int i = 0; i < 20; ++i) {
    batch.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "in", "Set")});
  }
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "docent:isAt", "Hall")});
  Fail(batch, absl::StatusCode::kResourceExhausted, "inferred_per_turn");
  GoOn();
}

TEST_F(FailingTurnTest, ARequestForAnUnknownWorkflow) {
  WriteBatch batch = test::Start("Greeting");
  batch.run_requests.push_back({RunRequest::Kind::kStart, "Nobody", {}});
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "docent:isAt", "Hall")});
  Fail(batch, absl::StatusCode::kNotFound, "Nobody");
  GoOn();
}

TEST_F(FailingTurnTest, AGoodDocumentBesideABadOne) {
  WriteBatch batch =
      Put(Document::Kind::kRules, "new.rules", "RULE { ?a <urn:w:p> ?b } WHERE { ?b <urn:w:in> ?a }");
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Called", ""});
  batch.documents.push_back({Document::Kind::kRsel, Document::Action::kRemove, "Services", ""});
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kPut, "bad.xml", "<CAWL name='x'>"});
  Fail(batch, absl::StatusCode::kInvalidArgument, "bad.xml:1:");
  GoOn();
}

TEST_F(FailingTurnTest, DocumentsBesideABadTerm) {
  WriteBatch batch =
      Put(Document::Kind::kRules, "near.rules", "RULE { ?a <urn:w:p> ?b } WHERE { ?b <urn:w:in> ?a }");
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Greeting", ""});
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "docent:isAt", Term::Iri("no IRI"))});
  Fail(batch, absl::StatusCode::kInvalidArgument, "add[");
  GoOn();
}

TEST_F(FailingTurnTest, AnActivatorThatMatchesWhatItsOwnRunsWrite) {
  const std::string everything =
      "<CAWL name=\"E\"><activator name=\"A\"><activate flow=\"F\"/><condition><context><rule><constraint>"
      "<subject>?a</subject><verb>?b</verb><object>?c</object></constraint></rule></context></condition>"
      "</activator><flow name=\"F\"><source name=\"s\"/><sink name=\"e\"/><link from=\"s\" "
      "to=\"e\"/></flow></CAWL>";
  Fail(Put(Document::Kind::kCawl, "e.xml", everything), absl::StatusCode::kResourceExhausted,
       "the activator of E");
  GoOn();
}

TEST_F(FailingTurnTest, WorkflowsThatStartEachOtherInALongRow) {
  // each run is a new binding of the next one's activator
  for (int i = 0; i < 8; ++i) {
    const std::string next = absl::StrCat(
        "<CAWL name=\"W", i,
        "\" namespace=\"urn:w:\" version=\"1.0\" xmlns:docent=\"https://w3id.org/docent#\">",
        "<activator name=\"OnTheOneBefore\"><activate flow=\"F\"/><condition><context name=\"c\"><rule "
        "name=\"r\">",
        "<constraint name=\"k\"><subject>?run</subject><verb>docent:workflow</verb><object>\"W", i - 1,
        "\"</object></constraint></rule></context></condition></activator>",
        "<flow name=\"F\"><source name=\"start\"/><node name=\"N\"><invoke operation=\"nothing\"/></node>"
        "<sink name=\"end\"/><link from=\"start\" to=\"N\"/><link from=\"N\" to=\"end\"/></flow></CAWL>");
    for (World* world : {&world_, &twin_})
      world->Must(Put(Document::Kind::kCawl, absl::StrCat("w", i, ".xml"), next));
  }
  WriteBatch batch = test::Start("W0");
  batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "docent:isAt", "Hall")});
  Fail(batch, absl::StatusCode::kResourceExhausted, "engine_rounds_per_turn");
  GoOn();
}

// Ids of terms differ between a server that started from a snapshot and the replay of its log. No decision may
// depend on them.
TEST(TurnReplayTest, TheSameBatchesGiveTheSameRecordsWhateverTheIdsOfTerms) {
  std::vector<WriteBatch> batches;
  batches.push_back(test::WorldFacts());
  batches.push_back(Put(Document::Kind::kRules, "near.rules", test::kRules));
  batches.push_back(Put(Document::Kind::kCawl, "greeting.xml", test::kGreeting));
  batches.push_back(Put(Document::Kind::kCawl, "called.xml", test::kCalled));
  std::vector<std::string> people = {"Zoe", "Adam", "Mary", "John", "Bert"};
  for (const std::string& person : people) batches.push_back(Tell({Fact(person, "docent:isAt", "Hall")}));
  for (const char* robot : {"R9", "R3", "R5"}) {
    batches.push_back(
        Tell({Fact(robot, "a", "docent:Robot"), Fact(robot, "docent:incarnation", Term::Literal("i1")),
              Fact(robot, "docent:status", "docent:Standby"), Fact(robot, "docent:isAt", "Hall"),
              Fact(robot, "docent:offers", "urn:docent:operation:greet")}));
  }
  for (int i = 0; i < 3; ++i) batches.push_back(test::Start("Greeting"));
  WriteBatch calls;
  for (const std::string& person : people) {
    for (const char* robot : {"R9", "R3", "R1"}) {
      calls.operations.push_back({QuadOperation::Kind::kAdd, Fact(person, "docent:calls", robot)});
    }
  }
  batches.push_back(calls);
  batches.push_back(test::Report(CommandId("of Greet-1"), CommandReport::Outcome::kSucceeded));
  batches.push_back(Tell({Fact("Adam", "docent:feels", "docent:Glad")}));

  World first;
  std::vector<log::TurnRecord> records;
  size_t commands = 0;
  for (WriteBatch& batch : batches) {
    if (!batch.reports.empty()) batch.reports[0].command = OpenCommandOf(first, "Greet-1");
    records.push_back(first.Must(batch).record);
    commands += records.back().commands.size();
  }
  EXPECT_GE(commands, 4u);

  World again;
  World reversed;
  for (const char* name : {"Glad", "R1", "R3", "John", "R5", "Mary", "R9", "Adam", "Zoe", "Bert", "Hall"}) {
    reversed.dictionary.Intern(Iri(name));
  }
  reversed.dictionary.Intern(Iri("docent:isNear"));
  reversed.dictionary.Intern(Iri("urn:docent:operation:greet"));
  for (World* world : {&again, &reversed}) {
    for (size_t i = 0; i < batches.size(); ++i) {
      log::TurnRecord record = world->Must(batches[i]).record;
      EXPECT_EQ(log::DecisionDifference(records[i], record), std::nullopt);
      EXPECT_EQ(record, records[i]);
    }
    EXPECT_EQ(Dump(*world), Dump(first));
  }
}

}  // namespace
}  // namespace docent::server
