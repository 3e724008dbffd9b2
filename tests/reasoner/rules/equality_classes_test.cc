#include "reasoner/rules/equality_classes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TermId Thing(uint64_t number) {
  return TermId::Make(TermId::Tag::kIri, number);
}
TermId Number(uint64_t number) {
  return TermId::Make(TermId::Tag::kInteger, number);
}

class EqualityClassesTest : public ::testing::Test {
 protected:
  void JoinChain(uint64_t first, uint64_t last) {
    for (uint64_t i = first; i < last; ++i) classes_.Join(Thing(i), Thing(i + 1));
  }
  std::vector<std::vector<TermId>> BlocksOf(uint64_t number) {
    const EqualityClasses::Class& of = *classes_.Find(Thing(number));
    std::vector<std::vector<TermId>> blocks;
    for (size_t i = 0; i < of.blocks.size(); ++i) blocks.emplace_back(of.block(i).begin(), of.block(i).end());
    return blocks;
  }
  EqualityClasses classes_;
};

TEST_F(EqualityClassesTest, WhatIsConnectedIsEqual) {
  EXPECT_TRUE(classes_.Join(Thing(1), Thing(2)));
  EXPECT_TRUE(classes_.Join(Thing(3), Thing(4)));
  EXPECT_FALSE(classes_.AreEqual(Thing(1), Thing(4)));
  EXPECT_TRUE(classes_.Join(Thing(4), Thing(2)));
  EXPECT_TRUE(classes_.AreEqual(Thing(1), Thing(3)));
  EXPECT_FALSE(classes_.Join(Thing(1), Thing(3))) << "known";
  EXPECT_FALSE(classes_.Join(Thing(7), Thing(7)));
  EXPECT_EQ(classes_.Find(Thing(7)), nullptr) << "equal to itself alone";
  EXPECT_EQ(classes_.Representative(Thing(7)), Thing(7));
  EXPECT_EQ(classes_.Representative(Thing(1)), classes_.Representative(Thing(3)));
}

TEST_F(EqualityClassesTest, BlocksAreWhatAClassWasJoinedFrom) {
  JoinChain(1, 3);
  classes_.Settle();
  EXPECT_THAT(classes_.Joined(), IsEmpty());
  classes_.Join(Thing(5), Thing(1));
  classes_.Join(Thing(6), Thing(5));
  EXPECT_THAT(classes_.Joined(), ElementsAre(classes_.Representative(Thing(6))));
  EXPECT_THAT(BlocksOf(6), UnorderedElementsAre(UnorderedElementsAre(Thing(1), Thing(2), Thing(3)),
                                                ElementsAre(Thing(5)), ElementsAre(Thing(6))));
  classes_.Settle();
  EXPECT_EQ(BlocksOf(6).size(), 1u);
  classes_.Unsettle(Thing(2));
  EXPECT_EQ(BlocksOf(6).size(), 5u);
}

TEST_F(EqualityClassesTest, ALiteralNamesSeveralClassesAndJoinsNone) {
  classes_.Join(Thing(1), Number(5));
  classes_.Join(Thing(2), Number(5));
  EXPECT_FALSE(classes_.AreEqual(Thing(1), Thing(2)));
  EXPECT_TRUE(classes_.AreEqual(Thing(1), Number(5)));
  EXPECT_THAT(classes_.ClassesNamed(Number(5)), UnorderedElementsAre(Thing(1), Thing(2)));
  classes_.Join(Thing(1), Thing(2));
  EXPECT_EQ(classes_.ClassesNamed(Number(5)).size(), 1u);
  EXPECT_THAT(classes_.Find(Thing(1))->literals, ElementsAre(Number(5)));
  classes_.Dissolve(Thing(2));
  EXPECT_FALSE(classes_.IsName(Number(5)));
  EXPECT_TRUE(classes_.empty());
}

TEST_F(EqualityClassesTest, ADissolvedClassLeavesTheOthers) {
  JoinChain(1, 4);
  JoinChain(11, 13);
  classes_.Dissolve(Thing(3));
  EXPECT_EQ(classes_.Find(Thing(1)), nullptr);
  EXPECT_TRUE(classes_.AreEqual(Thing(11), Thing(13)));
  JoinChain(1, 2);
  EXPECT_TRUE(classes_.AreEqual(Thing(1), Thing(2)));
  EXPECT_FALSE(classes_.AreEqual(Thing(1), Thing(11)));
}

}  // namespace
}  // namespace docent::rules
