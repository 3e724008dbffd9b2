#include "robot_adapters/sim/guide_operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_split.h"

namespace docent::robot {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(GuideOperationsTest, TheTableHasALineForEachOperation) {
  const std::vector<Operation> operations = GuideOperations();
  const std::string table = OperationsTable(operations);
  const std::vector<std::string> lines = absl::StrSplit(table, '\n');
  ASSERT_EQ(lines.size(), operations.size() + 2);  // a head, and an end of the last line
  EXPECT_THAT(lines[0], StartsWith("operation         inputs "));
  for (size_t i = 0; i < operations.size(); ++i)
    EXPECT_THAT(lines[i + 1],
                AllOf(StartsWith(operations[i].name + " "), HasSubstr(operations[i].description)));
  EXPECT_THAT(table, HasSubstr("say               text: xsd:string      file: xsd:string  voice     no  "));
  EXPECT_THAT(lines[1], HasSubstr("  -  ")) << "what is empty is a place of its own";
}

}  // namespace
}  // namespace docent::robot
