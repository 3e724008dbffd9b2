#include "graph/sparql/values/decimal_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace docent::sparql {
namespace {

// The same in every order of the numbers.
std::string Sum(std::vector<std::string> numbers) {
  std::string text;
  std::sort(numbers.begin(), numbers.end());
  do {
    DecimalSum sum;
    for (const std::string& number : numbers) sum.Add(*Decimal::Parse(number));
    const std::optional<Decimal> result = sum.Result();
    const std::string written = result ? result->ToString() : "none";
    EXPECT_TRUE(text.empty() || text == written) << text << " or " << written;
    text = written;
  } while (std::next_permutation(numbers.begin(), numbers.end()));
  return text;
}

TEST(DecimalSumTest, SumsAreExactInEveryOrder) {
  const std::string most(38, '9');
  EXPECT_EQ(Sum({}), "0");
  EXPECT_EQ(Sum({"1", "-1"}), "0");
  EXPECT_EQ(Sum({"0.5", "-0.75", "-2"}), "-2.25");
  EXPECT_EQ(Sum({most, "0"}), most);
  EXPECT_EQ(Sum({most, "1"}), "none");
  EXPECT_EQ(Sum({"-" + most, "-1"}), "none");
  EXPECT_EQ(Sum({most, most, "-" + most, "1", "-1"}), most);
  EXPECT_EQ(Sum({most, "0.000000000000000000000000000000000001", "-" + most}),
            "0.000000000000000000000000000000000001");
  EXPECT_EQ(Sum({most, "0.1"}), "none");
  EXPECT_EQ(Sum({"1000000000000000000", "-0.000000000000000001"}), "999999999999999999.999999999999999999");
}

}  // namespace
}  // namespace docent::sparql
