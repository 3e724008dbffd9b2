#include "graph/base/gzip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent {
namespace {

using testing::HasSubstr;

std::string Message(const std::string& bytes, size_t most) {
  const auto unpacked = Gunzip(bytes, most, "some_bytes");
  EXPECT_FALSE(unpacked.ok());
  return std::string(unpacked.status().message());
}

TEST(GzipTest, WhatIsPackedIsUnpacked) {
  std::string large;
  for (int i = 0; i < 100000; ++i) large += std::to_string(i) + "\n";
  for (const std::string& text : {std::string(), std::string("abc"), large, std::string(1000000, '\0')}) {
    const std::string packed = Gzip(text);
    EXPECT_TRUE(IsGzip(packed));
    EXPECT_EQ(Gunzip(packed, text.size(), "some_bytes").value_or("?"), text) << "at the limit";
    if (text.empty()) continue;
    EXPECT_THAT(Message(packed, text.size() - 1), HasSubstr("the limit some_bytes = "));
  }
  EXPECT_EQ(Gunzip(Gzip("abc") + Gzip("") + Gzip("def"), 6, "some_bytes").value_or("?"), "abcdef")
      << "a file may have several members";
  EXPECT_FALSE(IsGzip("<rdf:RDF>"));
  EXPECT_FALSE(IsGzip("\x1F\x8B"));
}

TEST(GzipTest, ABombIsUnpackedToItsLimitAlone) {
  const size_t unpacked = 50u << 20;
  const std::string bomb = Gzip(std::string(unpacked, 'x'));
  EXPECT_LT(bomb.size(), unpacked / 200);
  EXPECT_THAT(Message(bomb, 1000), HasSubstr("more bytes than the limit some_bytes = 1000"));
  EXPECT_EQ(Gunzip(bomb, 1000, "some_bytes").status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(GzipTest, UnpackingEndsWhenItIsCancelled) {
  const std::string packed = Gzip(std::string(10u << 20, 'x'));
  Cancellation cancellation;
  int looks = 0;
  cancellation.OnLook([&](const Cancellation&) {
    if (++looks == 20) cancellation.Cancel();
  });
  EXPECT_EQ(Gunzip(packed, 20u << 20, "some_bytes", nullptr, &cancellation).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(looks, 20);
}

TEST(GzipTest, DamagedDataAreAnError) {
  const std::string packed = Gzip("some text that is long enough to be packed, packed, packed");
  for (size_t size = 3; size < packed.size(); ++size) {
    EXPECT_THAT(Message(packed.substr(0, size), 1000), HasSubstr("ends too early")) << size;
  }
  EXPECT_THAT(Message("@prefix : <urn:x> .", 1000), HasSubstr("this is not gzip data"));
  EXPECT_THAT(Message(packed + "x", 1000), HasSubstr("bytes follow the end of the gzip data"));
  std::string flipped = packed;
  flipped[packed.size() / 2] ^= 0x55;
  EXPECT_FALSE(Gunzip(flipped, 1000, "some_bytes").ok());
  std::string sum = packed;
  sum[packed.size() - 5] ^= 1;
  EXPECT_THAT(Message(sum, 1000), HasSubstr("damaged"));
}

}  // namespace
}  // namespace docent
