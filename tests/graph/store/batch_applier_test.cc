#include "graph/store/batch_applier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class BatchApplierTest : public testing::Test {
 protected:
  BatchApplierTest() : applier_(dictionary_, limits_), writer_(nullptr) {
    WriteBatch ontology = Batch("docent:at a docent:StateProperty .");
    ontology.mode = WriteBatch::Mode::kLoad;
    EXPECT_TRUE(Turn(ontology).ok());
  }

  // A batch that adds the facts of `turtle` (TriG).
  static WriteBatch Batch(const std::string& turtle, TimeMicros time_us = 0) {
    std::string text = "@prefix e: <http://e/> . @prefix docent: <https://w3id.org/docent#> . " + turtle;
    ParsedRdf parsed = ParseRdf(text, RdfFormat::kTriG);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    WriteBatch batch;
    batch.time_us = time_us;
    for (TermQuad& quad : parsed.quads)
      batch.operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    return batch;
  }
  static WriteBatch Removing(const std::string& turtle) {
    WriteBatch batch = Batch(turtle);
    for (QuadOperation& operation : batch.operations) operation.kind = QuadOperation::Kind::kRemove;
    return batch;
  }

  // One whole turn. Returns the added and removed facts as text.
  absl::StatusOr<std::pair<std::vector<std::string>, std::vector<std::string>>> Turn(
      const WriteBatch& batch) {
    absl::StatusOr<Delta> delta = applier_.Apply(batch, writer_);
    if (!delta.ok()) return delta.status();
    applier_.Commit();
    writer_.Freeze(Revision(++revision_));
    return std::pair(Texts(delta->added), Texts(delta->removed));
  }

  std::string Text(const Quad& quad) const {
    auto part = [this](TermId id) { return ToDisplay(dictionary_.Decode(id)); };
    return part(quad.subject) + " " + part(quad.predicate) + " " + part(quad.object) + " " + part(quad.graph);
  }
  std::vector<std::string> Texts(const std::vector<Quad>& quads) const {
    std::vector<std::string> texts;
    for (const Quad& quad : quads) texts.push_back(Text(quad));
    return texts;
  }
  std::set<std::string> All() const {
    std::set<std::string> all;
    writer_.current().ForEach({}, [&](const Quad& quad) { return all.insert(Text(quad)).second; });
    all.erase("docent:at rdf:type docent:StateProperty docent:default");
    return all;
  }
  std::string Refusal(const WriteBatch& batch) {
    uint64_t before = writer_.current().size();
    size_t terms = dictionary_.size();
    absl::StatusOr<Delta> delta = applier_.Apply(batch, writer_);
    EXPECT_FALSE(delta.ok());
    EXPECT_EQ(writer_.current().size(), before);
    EXPECT_EQ(dictionary_.size(), terms);
    return delta.status().ToString();
  }

  Limits limits_;
  Dictionary dictionary_;
  BatchApplier applier_;
  GraphWriter writer_;
  uint64_t revision_ = 0;
};

TEST_F(BatchApplierTest, QuadsLieInTheirGraphTheSourceOrTheDefaultGraph) {
  WriteBatch batch = Batch("e:s e:p 1 . e:g { e:s e:p 2 }");
  ASSERT_TRUE(Turn(batch).ok());
  batch.source = "http://e/robot";
  ASSERT_TRUE(Turn(batch).ok());
  EXPECT_THAT(All(), ElementsAre("<http://e/s> <http://e/p> 1 <http://e/robot>",
                                 "<http://e/s> <http://e/p> 1 docent:default",
                                 "<http://e/s> <http://e/p> 2 <http://e/g>"));
}

TEST_F(BatchApplierTest, ANewStateReplacesTheOldOfTheSameSource) {
  ASSERT_TRUE(
      Turn(Batch("e:r docent:at e:a . e:r e:p e:a . e:r2 docent:at e:a . e:other { e:r docent:at e:z }"))
          .ok());
  auto change = Turn(Batch("e:r docent:at e:b . e:r e:p e:b ."));
  ASSERT_TRUE(change.ok());
  EXPECT_THAT(change->first, UnorderedElementsAre("<http://e/r> docent:at <http://e/b> docent:default",
                                                  "<http://e/r> <http://e/p> <http://e/b> docent:default"));
  EXPECT_THAT(change->second, ElementsAre("<http://e/r> docent:at <http://e/a> docent:default"));
  EXPECT_TRUE(All().contains("<http://e/r> docent:at <http://e/z> <http://e/other>"));
  EXPECT_TRUE(All().contains("<http://e/r2> docent:at <http://e/a> docent:default"));
}

TEST_F(BatchApplierTest, TheLastStateInTheBatchWins) {
  ASSERT_TRUE(Turn(Batch("e:r docent:at e:a .")).ok());
  auto change = Turn(Batch("e:r docent:at e:b . e:r docent:at e:c . e:r docent:at e:a ."));
  ASSERT_TRUE(change.ok());
  EXPECT_TRUE(change->first.empty());  // it was e:a and is e:a
  EXPECT_TRUE(change->second.empty());
  EXPECT_THAT(All(), ElementsAre("<http://e/r> docent:at <http://e/a> docent:default"));
}

TEST_F(BatchApplierTest, LoadingKeepsSetSemantics) {
  WriteBatch load = Batch("e:r docent:at e:a . e:r docent:at e:b .");
  load.mode = WriteBatch::Mode::kLoad;
  ASSERT_TRUE(Turn(load).ok());
  EXPECT_EQ(All().size(), 2u);
}

TEST_F(BatchApplierTest, ALargeLoadIsWhatItsPartsAre) {
  // The same statements once in a batch that is sorted into the indexes, once in small ones.
  std::string text;
  for (int i = 0; i < 700; ++i) {
    const int n = i * 37 % 300;
    text += " <http://e/g" + std::to_string(n % 2) + "> { e:s" + std::to_string(n % 20) + " e:p" +
            std::to_string(n % 3) + " " + std::to_string(n) + " . }";
  }
  text += " e:s1 docent:at e:A . e:s1 docent:at e:B .";  // no state is replaced
  const WriteBatch all = [&] {
    WriteBatch batch = Batch(text);
    batch.mode = WriteBatch::Mode::kLoad;
    batch.source = "http://e/source";
    return batch;
  }();
  auto added = Turn(all);
  ASSERT_TRUE(added.ok()) << added.status();
  Dictionary dictionary;
  BatchApplier applier(dictionary, limits_);
  GraphWriter writer(nullptr);
  std::vector<std::string> expected;
  for (const QuadOperation& operation : all.operations) {
    WriteBatch one = all;
    one.operations = {operation};
    const absl::StatusOr<Delta> delta = applier.Apply(one, writer);
    ASSERT_TRUE(delta.ok()) << delta.status();
    for (const Quad& quad : delta->added) {
      expected.push_back(
          ToDisplay(dictionary.Decode(quad.subject)) + " " + ToDisplay(dictionary.Decode(quad.predicate)) +
          " " + ToDisplay(dictionary.Decode(quad.object)) + " " + ToDisplay(dictionary.Decode(quad.graph)));
    }
  }
  EXPECT_EQ(added->first, expected);
  writer_.current().CheckInvariants();
}

TEST_F(BatchApplierTest, ALargeLoadMakesItsFactsStay) {
  WriteBatch brief = Batch("e:s7 e:p 7 .", 1000);
  brief.lifetime_ms = 1;
  ASSERT_TRUE(Turn(brief).ok());
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "e:s" + std::to_string(i) + " e:p " + std::to_string(i) + " . ";
  WriteBatch all = Batch(text, 1500);
  all.mode = WriteBatch::Mode::kLoad;
  ASSERT_TRUE(Turn(all).ok());
  EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
  auto later = Turn(Batch("", 1'000'000));
  ASSERT_TRUE(later.ok());
  EXPECT_THAT(later->second, testing::IsEmpty());
}

TEST_F(BatchApplierTest, AStreamOfPosesGrowsNeitherDictionaryNorIndex) {
  ASSERT_TRUE(Turn(Batch("docent:x a docent:StateProperty . docent:t a docent:StateProperty .")).ok());
  size_t terms = 0, bytes = 0;
  for (int n = 0; n < 20000; ++n) {
    WriteBatch pose;
    pose.time_us = n;
    const std::string robot = "http://e/r" + std::to_string(n % 100);
    const auto tell = [&](const char* property, std::string value, std::string_view type) {
      pose.operations.push_back({QuadOperation::Kind::kAdd,
                                 {Term::Iri(robot), Term::Iri(DocentIri(property)),
                                  Term::Literal(std::move(value), std::string(type)), Term()}});
    };
    tell("x", std::to_string(n / 1000) + "." + std::to_string(100 + n % 900), kXsdDecimal);
    tell("t", "2026-11-21T12:" + std::to_string(10 + n / 1000) + ":00." + std::to_string(100 + n % 900) + "Z",
         kXsdDateTime);
    ASSERT_TRUE(Turn(pose).ok());
    if (n == 1000) {
      terms = dictionary_.size();
      bytes = writer_.current().bytes();
    }
  }
  EXPECT_EQ(dictionary_.size(), terms);
  EXPECT_LE(writer_.current().bytes(), bytes * 11 / 10);
  EXPECT_EQ(writer_.current().Count({{}, *dictionary_.FindIri(DocentIri("x")), {}, {}}), 100u);
}

TEST_F(BatchApplierTest, StatePropertiesAreThoseOfTheGraphBeforeTheBatch) {
  ASSERT_TRUE(Turn(Batch("e:q a docent:StateProperty . e:r e:q 1 .")).ok());
  ASSERT_TRUE(Turn(Batch("e:r e:q 2 .")).ok());
  EXPECT_TRUE(All().contains("<http://e/r> <http://e/q> 2 docent:default"));
  EXPECT_FALSE(All().contains("<http://e/r> <http://e/q> 1 docent:default"));
  ASSERT_TRUE(Turn(Removing("e:q a docent:StateProperty .")).ok());
  ASSERT_TRUE(Turn(Batch("e:r e:q 3 .")).ok());
  EXPECT_TRUE(All().contains("<http://e/r> <http://e/q> 2 docent:default"));
}

TEST_F(BatchApplierTest, RemovingWhatIsNotThereDoesNothing) {
  size_t terms = dictionary_.size();
  auto change = Turn(Removing("e:never e:heard e:of ."));
  ASSERT_TRUE(change.ok());
  EXPECT_TRUE(change->first.empty() && change->second.empty());
  EXPECT_EQ(dictionary_.size(), terms);
}

TEST_F(BatchApplierTest, LifetimesEndAtTheirTime) {
  WriteBatch batch = Batch("e:s e:p 1 .", 1'000'000);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  EXPECT_EQ(applier_.NextDeadline(), 1'500'000);
  WriteBatch tick;
  tick.clock_tick = true;
  tick.time_us = 1'499'999;
  EXPECT_TRUE(Turn(tick)->second.empty());
  tick.time_us = 1'500'000;
  EXPECT_THAT(Turn(tick)->second, ElementsAre("<http://e/s> <http://e/p> 1 docent:default"));
  EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
}

TEST_F(BatchApplierTest, TellingAgainRenewsALifetimeAndWithoutOneItStays) {
  WriteBatch batch = Batch("e:r docent:at e:a .", 1'000'000);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  batch.time_us = 1'400'000;
  auto again = Turn(batch);
  EXPECT_TRUE(again->first.empty());
  EXPECT_EQ(applier_.NextDeadline(), 1'900'000);
  batch.lifetime_ms = 0;
  ASSERT_TRUE(Turn(batch).ok());
  EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  batch.mode = WriteBatch::Mode::kLoad;  // loaded facts stay, too
  ASSERT_TRUE(Turn(batch).ok());
  EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
}

TEST_F(BatchApplierTest, AReplacedStateLosesItsLifetime) {
  WriteBatch batch = Batch("e:r docent:at e:a .", 1'000'000);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  ASSERT_TRUE(Turn(Batch("e:r docent:at e:b .", 1'100'000)).ok());
  EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
}

TEST_F(BatchApplierTest, AnyLaterBatchEndsLifetimesFirst) {
  WriteBatch batch = Batch("e:s e:p 1 . e:s e:p 2 .", 1'000'000);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  auto change = Turn(Batch("e:s e:p 1 .", 2'000'000));
  EXPECT_TRUE(change->first.empty());  // ended and told again at once: no change
  EXPECT_THAT(change->second, ElementsAre("<http://e/s> <http://e/p> 2 docent:default"));
}

TEST_F(BatchApplierTest, HugeLifetimesNeverEnd) {
  WriteBatch batch = Batch("e:s e:p 1 .", 1'000'000);
  for (uint64_t lifetime_ms : {~uint64_t{0}, uint64_t{1} << 53, uint64_t{9'223'372'036'854'776}}) {
    batch.lifetime_ms = lifetime_ms;
    ASSERT_TRUE(Turn(batch).ok());
    EXPECT_EQ(applier_.NextDeadline(), std::nullopt);
  }
}

TEST_F(BatchApplierTest, RollbackRestoresLifetimesAndStateProperties) {
  WriteBatch batch = Batch("e:s e:p 1 . e:s e:p 2 .", 1'000'000);
  batch.lifetime_ms = 500;
  ASSERT_TRUE(Turn(batch).ok());
  WriteBatch second = Batch("e:s e:p 1 . e:q a docent:StateProperty .", 1'200'000);
  second.lifetime_ms = 900;
  WriteBatch remove = Removing("e:s e:p 2 .");
  ASSERT_TRUE(applier_.Apply(second, writer_).ok());
  ASSERT_TRUE(applier_.Apply(remove, writer_).ok());
  applier_.Rollback();
  writer_.Rollback();
  EXPECT_EQ(applier_.NextDeadline(), 1'500'000);
  ASSERT_TRUE(Turn(Batch("e:r e:q 1 . e:r e:q 2 .", 1'300'000)).ok());
  EXPECT_EQ(All().size(), 4u);  // e:q is no state property
  WriteBatch tick;
  tick.time_us = 1'500'000;
  EXPECT_EQ(Turn(tick)->second.size(), 2u);
}

TEST_F(BatchApplierTest, BadTermsAreNamedAndNothingIsApplied) {
  WriteBatch batch = Batch("e:new e:p 1 . e:new e:p 2 .");
  batch.operations[1].quad.subject = Term::Literal("x");
  EXPECT_THAT(Refusal(batch), HasSubstr("add[1]: subject: the literal \"x\""));
  batch.operations[1].quad.subject = Term::Iri("booth");
  EXPECT_THAT(Refusal(batch), HasSubstr("add[1]: subject: the IRI <booth> is relative"));
  batch.operations[1].quad = {Term::Iri("urn:a"), Term::Blank("b"), Term::Iri("urn:a"), Term()};
  EXPECT_THAT(Refusal(batch), HasSubstr("INVALID_ARGUMENT: add[1]: predicate"));
  batch.operations[1].quad = {Term::Iri("urn:a"), Term::Iri("urn:b"), Term::Iri("urn:a"), Term::Blank("g")};
  EXPECT_THAT(Refusal(batch), HasSubstr("add[1]: graph: a graph of the store is named by an IRI"));
  batch.operations[0].kind = QuadOperation::Kind::kRemove;
  EXPECT_THAT(Refusal(batch), HasSubstr("add[0]: graph")) << "as the client numbers what it adds";
  for (std::string_view graph : {kInferredGraph, kRunsGraph}) {
    batch.operations[1].quad.graph = Term::Iri(std::string(graph));
    EXPECT_THAT(Refusal(batch), HasSubstr("only the server writes"));
    WriteBatch source = Batch("e:new e:p 1 .");
    source.source = std::string(graph);
    EXPECT_THAT(Refusal(source), HasSubstr("source: graph"));
  }
  WriteBatch source = Batch("e:new e:p 1 .");
  source.source = "robot";
  EXPECT_THAT(Refusal(source), HasSubstr("source: the IRI <robot> is relative"));
  WriteBatch large = Batch("e:new e:p 1 .");
  large.operations[0].quad.object = Term::Literal(std::string(limits_.term_bytes + 1, 'x'));
  EXPECT_THAT(Refusal(large), HasSubstr("RESOURCE_EXHAUSTED: add[0]: object"));
}

class ReadingTest : public BatchApplierTest {
 protected:
  ReadingTest() {
    EXPECT_TRUE(
        Turn(Batch("e:in a docent:ReadingMapping ; docent:forSensor e:door ; docent:whenValue \"in\" ;"
                   "  docent:subject e:John ; docent:predicate docent:at ; docent:object e:Hall ."
                   "e:out a docent:ReadingMapping ; docent:forSensor e:door ; docent:whenValue \"out\" ;"
                   "  docent:subject e:John ; docent:predicate docent:at ; docent:object e:Hall ; "
                   "docent:effect docent:Withdraws ."
                   "e:beacon a docent:ReadingMapping ; docent:forSensor e:b3 ; docent:subject "
                   "docent:readingValue ;"
                   "  docent:predicate docent:at ; docent:object e:B03 ;"
                   "  docent:valueMeaning [ docent:readingValue \"tag-17\" ; docent:means e:John ] ."
                   "e:heat a docent:ReadingMapping ; docent:forSensor e:t ; docent:subject e:Hall ; "
                   "docent:predicate e:degrees ;"
                   "  docent:object docent:readingValue . e:broken docent:forSensor e:half ; docent:subject "
                   "e:x ."))
            .ok());
    world_ = All();
  }

  static WriteBatch Reading(const std::string& sensor, Term value) {
    WriteBatch batch;
    batch.source = "http://e/tracking";
    batch.readings.push_back({"http://e/" + sensor, std::move(value), 0});
    return batch;
  }
  std::set<std::string> New() const {
    std::set<std::string> found;
    for (const std::string& text : All()) {
      if (!world_.contains(text)) found.insert(text);
    }
    return found;
  }

  std::set<std::string> world_;
};

TEST_F(ReadingTest, TellsAndWithdraws) {
  ASSERT_TRUE(Turn(Reading("door", Term::Literal("in"))).ok());
  EXPECT_THAT(New(), ElementsAre("<http://e/John> docent:at <http://e/Hall> <http://e/tracking>"));
  ASSERT_TRUE(Turn(Reading("door", Term::Literal("broken beam"))).ok());  // no whenValue matches: no fact
  EXPECT_EQ(New().size(), 1u);
  ASSERT_TRUE(Turn(Reading("door", Term::Literal("out"))).ok());
  EXPECT_TRUE(New().empty());
}

TEST_F(ReadingTest, MeansAnotherTermAndReplacesState) {
  ASSERT_TRUE(Turn(Reading("door", Term::Literal("in"))).ok());
  ASSERT_TRUE(Turn(Reading("b3", Term::Literal("tag-17"))).ok());
  EXPECT_THAT(New(), ElementsAre("<http://e/John> docent:at <http://e/B03> <http://e/tracking>"));
}

TEST_F(ReadingTest, WithoutMeaningTheValueItselfIsUsed) {
  ASSERT_TRUE(Turn(Reading("t", Term::Literal("21.5", std::string(kXsdDecimal)))).ok());
  EXPECT_THAT(New(), ElementsAre("<http://e/Hall> <http://e/degrees> 21.5 <http://e/tracking>"));
  ASSERT_TRUE(Turn(Reading("b3", Term::Iri("http://e/Ann"))).ok());
  EXPECT_TRUE(New().contains("<http://e/Ann> docent:at <http://e/B03> <http://e/tracking>"));
}

TEST_F(ReadingTest, WhatCannotBeMappedIsNamed) {
  EXPECT_THAT(Refusal(Reading("unknown", Term::Literal("x"))),
              HasSubstr("readings[0]: no docent:ReadingMapping"));
  EXPECT_THAT(Refusal(Reading("b3", Term::Literal("tag-99"))), HasSubstr("declare its docent:valueMeaning"));
  EXPECT_THAT(Refusal(Reading("half", Term::Literal("x"))),
              HasSubstr("lacks docent:subject, docent:predicate or docent:object"));
  EXPECT_THAT(Refusal(Reading("t", Term::Iri("relative"))),
              HasSubstr("readings[0]: value: the IRI <relative>"));
  WriteBatch mixed = Reading("door", Term::Literal("in"));
  mixed.readings.push_back({"http://e/unknown", Term::Literal("x"), 0});
  EXPECT_THAT(Refusal(mixed), HasSubstr("readings[1]"));
}

// A robot stayed docent:Busy for ever where no ontology declared docent:status.
TEST_F(BatchApplierTest, StatesThatTheServerReadsReplaceWhateverOntologyIsLoaded) {
  for (const char* state :
       {"status", "currentCommand", "progress", "localised", "x", "outOfService", "heldBy"}) {
    const std::string fact = std::string("e:R docent:") + state;
    ASSERT_TRUE(Turn(Batch(fact + " e:a .")).ok());
    const auto changed = Turn(Batch(fact + " e:b ."));
    ASSERT_TRUE(changed.ok());
    EXPECT_THAT(changed->second, testing::SizeIs(1)) << state;
    ASSERT_TRUE(Turn(Removing(fact + " e:b .")).ok());
  }
  ASSERT_TRUE(Turn(Batch("e:R docent:offers e:a .")).ok());
  EXPECT_THAT(Turn(Batch("e:R docent:offers e:b ."))->second, testing::IsEmpty());
  ASSERT_TRUE(Turn(Batch("docent:status a docent:StateProperty .")).ok());
  ASSERT_TRUE(Turn(Removing("docent:status a docent:StateProperty .")).ok());
  ASSERT_TRUE(Turn(Batch("e:R docent:status e:a .")).ok());
  EXPECT_THAT(Turn(Batch("e:R docent:status e:b ."))->second, testing::SizeIs(1))
      << "an ontology that leaves takes nothing away";
}

}  // namespace
}  // namespace docent
