#include "kb_server/door/descriptors.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace docent::server {
namespace {

TEST(Descriptors, OpenOnesAreCounted) {
  const size_t before = OpenDescriptors();
  const int more = dup(0);
  EXPECT_EQ(OpenDescriptors(), before + 1);
  close(more);
  EXPECT_EQ(OpenDescriptors(), before);
}

TEST(Descriptors, ConnectionsLeaveSomeForOthers) {
  const Limits limits;
  for (const size_t limit : {kLeastDescriptors, size_t{64}, size_t{256}, size_t{1024}, size_t{65536}}) {
    const ConnectionShares shares = ShareDescriptors(limit, 28, limits);
    EXPECT_GE(shares.http, 1u) << limit;
    EXPECT_GE(shares.grpc, 1u) << limit;
    EXPECT_LE(28 + shares.http + shares.grpc, limit - limit / 16) << limit;
    EXPECT_LE(shares.http, limits.http_connections);
    EXPECT_LE(shares.grpc, limits.grpc_connections);
  }
  EXPECT_EQ(ShareDescriptors(65536, 28, limits).http, limits.http_connections);
  EXPECT_EQ(ShareDescriptors(65536, 28, limits).grpc, limits.grpc_connections);
  EXPECT_EQ(ShareDescriptors(30, 100, limits).http, 1u) << "however few there are";
}

TEST(Descriptors, TheSoftLimitIsRaised) {
  ASSERT_TRUE(RaiseDescriptorLimit().ok());
  EXPECT_GE(DescriptorLimit(), kLeastDescriptors);
}

}  // namespace
}  // namespace docent::server
