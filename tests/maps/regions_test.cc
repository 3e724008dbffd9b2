#include "maps/regions.h"

#include <gtest/gtest.h>

namespace docent::maps {
namespace {

Region Square(const std::string& iri, double x, double y, double edge) {
  Region region;
  region.iri = iri;
  region.outline = {{x, y}, {x + edge, y}, {x + edge, y + edge}, {x, y + edge}};
  return region;
}

class RegionsTest : public ::testing::Test {
 protected:
  std::string At(double x, double y) const {
    const Region* region = index_.Innermost({x, y});
    return region == nullptr ? "-" : region->iri;
  }
  RegionIndex index_{{Square("hall", 0, 0, 10), Square("booth", 2, 2, 3), Square("counter", 3, 3, 1)}};
};

TEST_F(RegionsTest, TheInnermostRegionWins) {
  EXPECT_EQ(At(1, 1), "hall");
  EXPECT_EQ(At(2.5, 2.5), "booth");
  EXPECT_EQ(At(3.5, 3.5), "counter");
  EXPECT_EQ(At(-1, 5), "-");
}

TEST_F(RegionsTest, LeavingOutwardsIsHeldBackByTheMargin) {
  const Region* booth = index_.Innermost({2.5, 2.5});
  EXPECT_EQ(index_.Innermost({1.95, 2.5}, booth, 0.1), booth);
  EXPECT_EQ(index_.Innermost({1.85, 2.5}, booth, 0.1)->iri, "hall");
  EXPECT_EQ(index_.Innermost({3.05, 3.5}, booth, 0.1)->iri, "counter")
      << "a region inside is entered at once";
  EXPECT_EQ(index_.Innermost({1.95, 2.5}, nullptr, 0.1)->iri, "hall");
}

TEST_F(RegionsTest, NoRegions) {
  EXPECT_EQ(RegionIndex(std::vector<Region>()).Innermost({0, 0}), nullptr);
}

}  // namespace
}  // namespace docent::maps
