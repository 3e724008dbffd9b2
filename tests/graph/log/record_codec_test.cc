#include "graph/log/record_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

using ::testing::HasSubstr;

std::string Encoded(const TurnRecord& record) {
  const absl::StatusOr<std::string> bytes = EncodeTurnRecord(record);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  return bytes.value_or("");
}

TEST(RecordCodecTest, EveryFieldComesBack) {
  TurnRecord record = FullRecord();
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(9, Encoded(record));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  record.offset = 9;
  EXPECT_EQ(*decoded, record);
}

TEST(RecordCodecTest, EveryEnumValueComesBack) {
  TurnRecord record;
  for (int kind = 0; kind <= static_cast<int>(Document::Kind::kRsel); ++kind) {
    record.batch.documents.push_back({static_cast<Document::Kind>(kind), Document::Action::kPut, "n", "t"});
  }
  for (int outcome = 0; outcome <= static_cast<int>(CommandReport::Outcome::kNotBegun); ++outcome) {
    record.batch.reports.push_back(
        {CommandId("c"), static_cast<CommandReport::Outcome>(outcome), "", 0, "", {}});
  }
  for (int kind = 0; kind <= static_cast<int>(RunRequest::Kind::kInvokeService); ++kind) {
    record.batch.run_requests.push_back({static_cast<RunRequest::Kind>(kind), "t", {}});
  }
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(0, Encoded(record));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(*decoded, record);
}

TEST(RecordCodecTest, EmptyRecordComesBack) {
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(0, Encoded(TurnRecord{}));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, TurnRecord{});
}

TEST(RecordCodecTest, TermsAreWrittenOnce) {
  TurnRecord record;
  const Term robot = Term::Iri("https://w3id.org/docent/expo#R01");
  for (int i = 0; i < 1000; ++i)
    record.batch.operations.push_back({QuadOperation::Kind::kAdd, {robot, robot, robot, robot}});
  EXPECT_LT(Encoded(record).size(), 4200u);  // a byte a term and the term itself once
}

TEST(RecordCodecTest, BytesThatAreNoUtf8ComeBackAsTheyAre) {
  TurnRecord record;
  record.batch.reports.push_back({CommandId("c"), CommandReport::Outcome::kFailed, "\xFF\xFE", 0, "", {}});
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(0, Encoded(record));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(*decoded, record);
}

TEST(RecordCodecTest, UnknownFieldsOfLaterVersionsAreSkipped) {
  TurnRecord record = FullRecord();
  // Field 1000 of the record, a string "later": tag (1000 << 3) | 2 as a varint, length, bytes.
  const std::string later = Encoded(record) + std::string("\xC2\x3E\x05later", 8);
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(0, later);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(*decoded, record);
}

TEST(RecordCodecTest, RecordThatNeedsANewerReaderIsRefused) {
  const std::string bytes("\x08\x04", 2);  // min_reader: 4
  const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(12, bytes);
  EXPECT_EQ(decoded.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(decoded.status().message()),
              HasSubstr("log record 12 was written by a newer Docent"));
}

// An earlier reader does not know the outcome.
TEST(RecordCodecTest, ACommandThatWasNotBegunNeedsReader3) {
  TurnRecord record;
  record.batch.reports.push_back({CommandId("c"), CommandReport::Outcome::kNotBegun, "", 0, "", {}});
  EXPECT_TRUE(Encoded(record).starts_with("\x08\x03"));
  record.batch.reports[0].outcome = CommandReport::Outcome::kCancelled;
  EXPECT_TRUE(Encoded(record).starts_with("\x08\x01"));
}

TEST(RecordCodecTest, WrongNumbersAreErrors) {
  // batch (field 5) with quads (field 6, packed): term numbers beyond the table; three numbers instead of
  // four.
  for (const std::string& bytes :
       {std::string("\x2A\x06\x32\x04\x01\x01\x01\x01", 8), std::string("\x2A\x05\x32\x03\x00\x00\x00", 7),
        std::string("\x2A\x02\x18\x09", 4) /* mode 9 */,
        std::string("\x2A\x03\x3A\x01\x05", 5) /* removes operation 5 of none */,
        std::string("\x22\x02\x18\x07", 4) /* a datatype that comes later */,
        std::string("\x22\x02\x08\x07", 4) /* a kind of term that is none */}) {
    const absl::StatusOr<TurnRecord> decoded = DecodeTurnRecord(3, bytes);
    EXPECT_EQ(decoded.status().code(), absl::StatusCode::kDataLoss) << decoded.status();
    EXPECT_THAT(std::string(decoded.status().message()), HasSubstr("log record 3"));
  }
}

TEST(RecordCodecTest, DamagedBytesNeverCrash) {
  const std::string good = Encoded(FullRecord());
  for (size_t length = 0; length < good.size(); ++length)
    DecodeTurnRecord(1, good.substr(0, length)).status().IgnoreError();
  for (size_t i = 0; i < good.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ flip);
      DecodeTurnRecord(1, bad).status().IgnoreError();
    }
  }
  std::mt19937 random(20150401);
  for (int round = 0; round < 2000; ++round) {
    std::string noise(random() % 200, '\0');
    for (char& byte : noise) byte = static_cast<char>(random());
    DecodeTurnRecord(1, noise).status().IgnoreError();
  }
}

TEST(TurnRecordTest, SameDecisionsHaveNoDifference) {
  TurnRecord derived = FullRecord();
  derived.engine_version = "other";
  derived.batch = {};
  EXPECT_EQ(DecisionDifference(FullRecord(), derived), std::nullopt);
}

TEST(TurnRecordTest, DifferenceNamesPlaceAndBothSides) {
  TurnRecord derived = FullRecord();
  derived.transitions[1].to = "failed";
  derived.commands.clear();
  const std::optional<std::string> text = DecisionDifference(FullRecord(), derived);
  ASSERT_TRUE(text.has_value());
  EXPECT_THAT(
      *text,
      HasSubstr(
          "transition 2\n  recorded: BoothGuide-1/Move2Booth waiting → running (because R01 is at B03)\n"
          "  derived:  BoothGuide-1/Move2Booth waiting → failed"));
  EXPECT_THAT(
      *text,
      HasSubstr(
          "command 1\n  recorded: BoothGuide-1/Move2Booth/0/0/0/1 to <https://w3id.org/docent/expo#R01>: "
          "moveToBooth(booth="));
  EXPECT_THAT(*text, HasSubstr("derived:  none"));
}

TEST(TurnRecordTest, EachFieldOfACommandCounts) {
  for (int field = 0; field < 8; ++field) {
    TurnRecord derived = FullRecord();
    RobotCommand& command = derived.commands[0];
    if (field == 0) command.id = CommandId("other");
    if (field == 1) command.robot = RobotId("other");
    if (field == 2) command.operation = "other";
    if (field == 3) command.arguments[0].second = Term::Iri("urn:other");
    if (field == 4) command.expected_incarnation = "other";
    if (field == 5) command.guard_revision = Revision(42);
    if (field == 6) command.deadline_us += 1;
    if (field == 7) command.idempotent = false;
    EXPECT_TRUE(DecisionDifference(FullRecord(), derived).has_value()) << field;
  }
}

TEST(TurnRecordTest, ManyDifferencesAreCountedNotListed) {
  TurnRecord derived;
  for (int i = 0; i < 100; ++i) derived.transitions.push_back({"run", "a", "b", ""});
  const std::optional<std::string> text = DecisionDifference(TurnRecord{}, derived);
  ASSERT_TRUE(text.has_value());
  EXPECT_THAT(*text, HasSubstr("and 95 more transitions"));
}

}  // namespace
}  // namespace docent::log
