#include "graph/base/archive.h"

#include <cmath>
#include <limits>
#include <random>

#include "gtest/gtest.h"

namespace docent {
namespace {

enum class Colour : uint8_t { kRed, kBlue };

struct Inner {
  std::string name;
  std::optional<int64_t> number;
  friend bool operator==(const Inner&, const Inner&) = default;
};
template <class Archive>
void Fields(Archive& a, Inner& v) {
  a(v.name, v.number);
}

struct Everything {
  bool yes = false;
  uint64_t large = 0;
  int64_t negative = 0;
  int small = 0;
  double real = 0;
  Colour colour = Colour::kRed;
  RunId run;
  Revision revision;
  std::vector<Inner> list;
  std::set<RobotId> set;
  std::map<std::string, std::pair<int, std::string>> map;
  friend bool operator==(const Everything&, const Everything&) = default;
};
template <class Archive>
void Fields(Archive& a, Everything& v) {
  a(v.yes, v.large, v.negative, v.small, v.real, v.colour, v.run, v.revision, v.list, v.set, v.map);
}

Everything Example() {
  Everything v;
  v.yes = true;
  v.large = std::numeric_limits<uint64_t>::max();
  v.negative = std::numeric_limits<int64_t>::min();
  v.small = -7;
  v.real = -0.1;
  v.colour = Colour::kBlue;
  v.run = RunId("Greet-1");
  v.revision = Revision(42);
  v.list = {{"a", 5}, {std::string("b\0c", 3), std::nullopt}, {"", -1}};
  v.set = {RobotId("r2"), RobotId("r1")};
  v.map = {{"x", {1, "one"}}, {"", {-2, ""}}};
  return v;
}

std::string Bytes(const Everything& v) {
  ByteWriter writer;
  writer(v);
  return writer.Take();
}

TEST(ArchiveTest, WhatIsWrittenComesBack) {
  for (const Everything& v : {Example(), Everything()}) {
    const std::string bytes = Bytes(v);
    ByteReader reader(bytes);
    Everything back = Example();
    reader(back);
    EXPECT_TRUE(reader.AtEnd());
    EXPECT_EQ(back, v);
  }
}

TEST(ArchiveTest, ATextThatIsCutIsNotRead) {
  const std::string bytes = Bytes(Example());
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::string cut = bytes.substr(0, size);
    ByteReader reader(cut);
    Everything back;
    reader(back);
    EXPECT_FALSE(reader.AtEnd()) << size;
  }
  const std::string longer = bytes + "x";
  ByteReader reader(longer);
  Everything back;
  reader(back);
  EXPECT_TRUE(reader.ok());
  EXPECT_FALSE(reader.AtEnd());
}

TEST(ArchiveTest, RandomBytesNeitherCrashNorFillTheMemory) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = Bytes(Example());
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    ByteReader reader(bytes);
    Everything back;
    reader(back);
    EXPECT_LE(back.list.size(), bytes.size());
  }
}

}  // namespace
}  // namespace docent
