// What is kept of an activator's firings: nothing of a key whose runs have ended and of which none waits.
#include "workflow/engine/activations.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Activations::Place kAnn = {"W", "user=<urn:Ann>"}, kBob = {"W", "user=<urn:Bob>"};

TEST(Activations, AKeyIsForgottenWithItsLastRun) {
  Activations activations;
  activations.Started(kAnn, RunId("F-1"));
  activations.Started(kAnn, RunId("F-2"));
  activations.Started(kBob, RunId("F-3"));
  EXPECT_EQ(activations.Ended(RunId("F-1")), kAnn);
  EXPECT_THAT(activations.Find(kAnn)->live, ElementsAre(RunId("F-2")));
  EXPECT_EQ(activations.Ended(RunId("F-2")), kAnn);
  EXPECT_EQ(activations.Find(kAnn), nullptr);
  EXPECT_THAT(activations.KeysOf("W"), ElementsAre(kBob.second));
  EXPECT_EQ(activations.Ended(RunId("F-2")), std::nullopt) << "it is counted no longer";
}

TEST(Activations, AKeyOfWhichAFiringWaitsIsKeptUntilItIsTaken) {
  Activations activations;
  activations.Started(kAnn, RunId("F-1"));
  activations.Wait(kAnn, {{}, "first"});
  activations.Wait(kAnn, {{}, "second"});
  activations.Ended(RunId("F-1"));
  EXPECT_EQ(activations.Waiting("W"), 2u);
  EXPECT_EQ(activations.Next(kAnn).cause, "first");
  EXPECT_EQ(activations.Next(kAnn).cause, "second");
  EXPECT_EQ(activations.Find(kAnn), nullptr);
  EXPECT_EQ(activations.Waiting("W"), 0u);
}

TEST(Activations, ARollbackPutsBackWhatWas) {
  Activations activations;
  activations.Started(kAnn, RunId("F-1"));
  activations.Wait(kAnn, {{}, "first"});
  activations.Commit();
  activations.Ended(RunId("F-1"));
  activations.Next(kAnn);
  activations.Ignored("W");
  activations.Started(kBob, RunId("F-2"));
  activations.Rollback();
  EXPECT_THAT(activations.Find(kAnn)->live, ElementsAre(RunId("F-1")));
  EXPECT_EQ(activations.Waiting("W"), 1u);
  EXPECT_EQ(activations.Find(kBob), nullptr);
  EXPECT_THAT(activations.state().ignored, IsEmpty());
  EXPECT_EQ(activations.Ended(RunId("F-1")), kAnn);
}

}  // namespace
}  // namespace docent::engine
