#include "kb_server/writer/server_state.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/random_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Lines;
using test::RandomWorld;
using test::Tell;

// Stages with a dictionary of their own.
struct Side {
  explicit Side(const Limits& limits) : stages(std::make_unique<Stages>(&dictionary, &functions, limits)) {}

  absl::StatusOr<TurnResult> Turn(const WriteBatch& batch) {
    auto result = RunTurn(stages.get(), batch, head + 1);
    if (!result.ok()) return result;
    ++head;
    requests.Remember(batch.request_id, {.offset = head}, batch.request_digest);
    return result;
  }
  std::string Encode(TimeMicros time_us) {
    auto bytes =
        EncodeState(TakeState(*stages, requests, stages->writer.Freeze(Revision(head)), time_us), dictionary);
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.ok() ? *bytes : "";
  }
  absl::Status Become(const std::string& bytes, const Limits& limits) {
    auto state = DecodeState(bytes, &dictionary, &functions, limits);
    if (!state.ok()) return state.status();
    stages = std::move(state->stages);
    head = state->offset;
    requests.Clear();
    for (const RememberedRequestPtr& request : state->requests)
      requests.Remember(request->id, request->outcome, request->digest);
    return absl::OkStatus();
  }

  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  std::unique_ptr<Stages> stages;
  RequestMemory requests{50};
  uint64_t head = 0;
};

// Checks that both made the same decisions.
void ExpectSame(const absl::StatusOr<TurnResult>& a, const absl::StatusOr<TurnResult>& b) {
  ASSERT_EQ(a.status(), b.status());
  if (!a.ok()) return;
  EXPECT_EQ(a->record, b->record) << log::DecisionDifference(a->record, b->record).value_or("");
  EXPECT_EQ(a->cancels, b->cancels);
  EXPECT_EQ(a->started, b->started);
  EXPECT_EQ(a->inferred, b->inferred);
  EXPECT_EQ(a->delta.size(), b->delta.size());
}

class ServerStateTest : public ::testing::TestWithParam<uint32_t> {};

// One pair of stages runs on; the other is restored to the first one's state repeatedly, as at a start from a
// snapshot. Both must make the same decisions.
TEST_P(ServerStateTest, RestoredStagesDecideAsTheOriginal) {
  Limits limits;
  limits.runs_kept = 5;
  RandomWorld world(GetParam());
  Side original(limits);
  auto other = std::make_unique<Side>(limits);
  size_t transitions = 0, live_runs = 0;
  for (int step = 0; step < 400; ++step) {
    SCOPED_TRACE(absl::StrCat("step ", step));
    const WriteBatch batch = world.Next(*original.stages);
    const auto a = original.Turn(batch);
    const auto b = other->Turn(batch);
    ExpectSame(a, b);
    ASSERT_FALSE(HasFatalFailure() || HasNonfatalFailure());
    if (a.ok()) transitions += a->record.transitions.size();
    live_runs = std::max(live_runs, original.stages->engine.live_runs());
    if (world.Below(20) != 0) continue;
    const std::string bytes = original.Encode(batch.time_us);
    other = std::make_unique<Side>(limits);
    const bool strange_ids = world.Below(3) == 0;  // a dictionary that knows other terms already
    for (int i = 0; strange_ids && i < 5; ++i) other->dictionary.InternIri(absl::StrCat("urn:other:", i));
    const absl::Status restored = other->Become(bytes, limits);
    ASSERT_TRUE(restored.ok()) << restored;
    ASSERT_EQ(other->head, original.head);
    ASSERT_EQ(Lines(other->dictionary, other->stages->writer.current()),
              Lines(original.dictionary, original.stages->writer.current()));
    if (!strange_ids) {
      EXPECT_EQ(other->Encode(batch.time_us), bytes);
    }
    EXPECT_EQ(other->stages->NextDeadline(), original.stages->NextDeadline());
    EXPECT_EQ(other->stages->engine.OpenCommands(), original.stages->engine.OpenCommands());
    other->stages->writer.current().CheckInvariants();
  }
  EXPECT_GT(transitions, 300u);
  EXPECT_GT(live_runs, 3u);
}
INSTANTIATE_TEST_SUITE_P(Seeds, ServerStateTest, ::testing::Range(1u, 9u));

// The language tag of an unused literal is kept, so that a start from a snapshot gives the same text as the
// log.
TEST(ServerStateTest, LanguageTagsStayAsFirstToldOverASnapshot) {
  const auto tell = [](const char* tag, QuadOperation::Kind kind) {
    WriteBatch batch;
    TermQuad fact = Fact("a", "label", "x");
    fact.object = Term::LangString("colour", tag);
    batch.operations.push_back({kind, fact});
    return batch;
  };
  Side one({});
  ASSERT_TRUE(one.Turn(tell("en-GB", QuadOperation::Kind::kAdd)).ok());
  ASSERT_TRUE(one.Turn(tell("EN-gb", QuadOperation::Kind::kRemove)).ok());
  EXPECT_EQ(one.stages->writer.current().size(), 0u);
  Side two({});
  ASSERT_TRUE(two.Become(one.Encode(1), {}).ok());
  for (Side* side : {&one, &two}) {
    ASSERT_TRUE(side->Turn(tell("en-gb", QuadOperation::Kind::kAdd)).ok());
    const std::optional<TermId> label = side->dictionary.Find(Term::LangString("colour", "en-gb"));
    ASSERT_TRUE(label.has_value());
    EXPECT_EQ(side->dictionary.Language(*label), "en-GB");
  }
}

TEST(ServerStateTest, RequestIdsAreRememberedInTheirOrder) {
  Side one({});
  WriteBatch batch = Tell({Fact("a", "b", "c")});
  for (int i = 0; i < 60; ++i) {
    batch.request_id = absl::StrCat("id-", i);
    batch.request_digest = static_cast<uint64_t>(i) << 40;
    ASSERT_TRUE(one.Turn(batch).ok());
  }
  Side two({});
  ASSERT_TRUE(two.Become(one.Encode(1), {}).ok());
  EXPECT_EQ(two.requests.Find("id-9"), nullptr);
  ASSERT_NE(two.requests.Find("id-10"), nullptr);
  EXPECT_EQ(two.requests.Find("id-10")->outcome.offset, 11u);
  EXPECT_EQ(two.requests.Find("id-10")->digest, uint64_t{10} << 40);
  two.requests.Remember("more", {});
  EXPECT_EQ(two.requests.Find("id-10"), nullptr);
  EXPECT_NE(two.requests.Find("id-11"), nullptr);
}

TEST(ServerStateTest, BytesThatAreNoStateAreRefused) {
  Side one({});
  RandomWorld world(3);
  for (int i = 0; i < 60; ++i) one.Turn(world.Next(*one.stages)).status().IgnoreError();
  const std::string bytes = one.Encode(1);
  for (size_t size : {size_t{0}, size_t{1}, bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
    Dictionary dictionary;
    EXPECT_FALSE(DecodeState(bytes.substr(0, size), &dictionary, &one.functions, {}).ok()) << size;
  }
  std::string newer = bytes;
  newer[0] = 99;
  Dictionary dictionary;
  const absl::Status status = DecodeState(newer, &dictionary, &one.functions, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("format 99"));
}

}  // namespace
}  // namespace docent::server
