#include "graph/wire/message_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "docent/v1/context.pb.h"

namespace docent {
namespace {

constexpr size_t kMost = size_t{1} << 40;

std::optional<size_t> MemoryOf(const google::protobuf::Message& message) {
  return MemoryOfMessage(*message.GetDescriptor(), message.SerializeAsString(), kMost);
}

v1::AssertRequest Facts(int count, const std::string& text) {
  v1::AssertRequest request;
  for (int i = 0; i < count; ++i) {
    v1::Quad* quad = request.add_add();
    quad->mutable_subject()->set_iri(text);
    quad->mutable_predicate()->set_iri("urn:p");
    quad->mutable_object()->mutable_literal()->set_lexical(text);
  }
  return request;
}

TEST(MessageMemoryTest, IsWhatTheParsedMessageTakesOrSomewhatMore) {
  for (const auto& [count, text] :
       {std::pair(0, std::string()), std::pair(1, std::string("x")), std::pair(1000, std::string("urn:a")),
        std::pair(10, std::string(100000, 'y'))}) {
    v1::AssertRequest parsed;
    ASSERT_TRUE(parsed.ParseFromString(Facts(count, text).SerializeAsString()));
    const std::optional<size_t> memory = MemoryOf(parsed);
    ASSERT_TRUE(memory);
    EXPECT_GE(*memory, parsed.SpaceUsedLong()) << count;
    EXPECT_LE(*memory, 3 * parsed.SpaceUsedLong() + 1000) << count;
  }
}

TEST(MessageMemoryTest, EmptyPartsAndMapsCountAsWhatTheyBecome) {
  v1::AssertRequest parts;
  for (int i = 0; i < 10000; ++i) parts.add_add();
  EXPECT_GE(*MemoryOf(parts), parts.SpaceUsedLong());
  v1::WhatIfRequest map;
  for (int i = 0; i < 1000; ++i) (*map.mutable_prefixes())[std::to_string(i)] = "x";
  EXPECT_GE(*MemoryOf(map), map.SpaceUsedLong());
}

// Field 100 of no message here, as a number of one byte: protobuf keeps it.
TEST(MessageMemoryTest, UnknownFieldsCount) {
  std::string bytes;
  for (int i = 0; i < 10000; ++i) bytes += std::string("\xa0\x06\x01", 3);
  v1::AssertRequest parsed;
  ASSERT_TRUE(parsed.ParseFromString(bytes));
  EXPECT_GE(*MemoryOfMessage(*parsed.GetDescriptor(), bytes, kMost), parsed.SpaceUsedLong());
}

TEST(MessageMemoryTest, CountingEndsBeyondWhatIsAskedFor) {
  const std::string bytes = Facts(100000, "urn:a").SerializeAsString();
  const auto& type = *v1::AssertRequest::descriptor();
  const size_t memory = *MemoryOfMessage(type, bytes, kMost);
  EXPECT_EQ(*MemoryOfMessage(type, bytes, memory), memory);
  EXPECT_GT(*MemoryOfMessage(type, bytes, memory - 1), memory - 1);
  EXPECT_LT(*MemoryOfMessage(type, bytes, 1000), 10000u);
}

TEST(MessageMemoryTest, BytesThatAreNoMessageHaveNone) {
  const auto& type = *v1::AssertRequest::descriptor();
  const std::string whole = Facts(2, "urn:a").SerializeAsString();
  for (const std::string& bad : {whole.substr(0, whole.size() - 1), std::string("\x1a\x7f"),
                                 std::string(1, '\0'), std::string("\x1b"), std::string(12, '\xff')})
    EXPECT_EQ(MemoryOfMessage(type, bad, kMost), std::nullopt);
  EXPECT_TRUE(MemoryOfMessage(type, "", kMost));
}

}  // namespace
}  // namespace docent
