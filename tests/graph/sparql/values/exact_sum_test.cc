#include "graph/sparql/values/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace docent::sparql {
namespace {

double Sum(const std::vector<double>& values) {
  ExactSum sum;
  for (const double value : values) sum.Add(value);
  return sum.Result();
}

TEST(ExactSumTest, IsRoundedOnce) {
  EXPECT_EQ(Sum({}), 0);
  EXPECT_EQ(Sum({0.1, 0.2, 0.3}), 0.6);
  EXPECT_EQ(Sum({1e16, 1, -1e16}), 1);
  EXPECT_EQ(Sum({1e308, 1, -1e308}), 1);
  EXPECT_EQ(Sum(std::vector<double>(10, 0.1)), 1);
  // 2^53 + 1 lies half way; the lower part decides
  EXPECT_EQ(Sum({9007199254740992.0, 1.0}), 9007199254740992.0);
  EXPECT_EQ(Sum({9007199254740992.0, 1.0, 1e-20}), 9007199254740994.0);
  EXPECT_EQ(Sum({9007199254740992.0, 1.0, -1e-20}), 9007199254740992.0);
}

TEST(ExactSumTest, DoesNotDependOnTheOrder) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> exponent(-60, 60);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> values;
    for (int i = 0; i < 40; ++i) values.push_back(std::ldexp(mantissa(random), exponent(random)));
    const double sum = Sum(values);
    for (int i = 0; i < 5; ++i) {
      std::shuffle(values.begin(), values.end(), random);
      ASSERT_EQ(Sum(values), sum);
    }
  }
}

TEST(ExactSumTest, InfinityAndNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Sum({1, infinity, -1e308}), infinity);
  EXPECT_TRUE(std::isnan(Sum({infinity, 1, -infinity})));
  EXPECT_TRUE(std::isnan(Sum({std::numeric_limits<double>::quiet_NaN(), 1})));
  EXPECT_EQ(Sum({1e308, 1e308}), infinity);
}

}  // namespace
}  // namespace docent::sparql
