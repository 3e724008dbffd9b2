#include "kb_server/cli/run_name.h"

#include "gtest/gtest.h"

namespace docent::server {
namespace {

TEST(RunNameTest, AnIdIsTakenAsItIsShownAndAsItIsMeant) {
  for (const char* text : {"My guide-9", "My%20guide-9"}) EXPECT_EQ(RunIdOf(text), "My%20guide-9");
  EXPECT_EQ(RunIdOf("Führung-1"), "Führung-1");
  EXPECT_EQ(RunIdOf("50% off/now-2"), "50%25%20off%2Fnow-2");
  EXPECT_EQ(RunIdOf("50%25%20off%2Fnow-2"), "50%25%20off%2Fnow-2");
  EXPECT_EQ(RunIdOf("BoothGuide-1"), "BoothGuide-1");
  EXPECT_EQ(RunIdOf("a%"), "a%25");
}

TEST(RunNameTest, OptionsAndListsTakeEither) {
  CLI::App app;
  std::string one;
  std::vector<std::string> many;
  TakesRunName(app.add_option("--run", one));
  TakesRunName(app.add_option("runs", many));
  app.parse("--run 'a b-1' 'c d-2' e-3");
  EXPECT_EQ(one, "a%20b-1");
  EXPECT_EQ(many, (std::vector<std::string>{"c%20d-2", "e-3"}));
}

}  // namespace
}  // namespace docent::server
