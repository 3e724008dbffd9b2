#include "graph/base/overload.h"

#include <gtest/gtest.h>

#include "graph/base/memory_budget.h"

namespace docent {
namespace {

TEST(Overload, IsToldFromALimitOfTheRequest) {
  EXPECT_TRUE(IsOverload(OverloadError("too much work waits")));
  EXPECT_EQ(OverloadError("too much work waits").code(), absl::StatusCode::kResourceExhausted);
  EXPECT_FALSE(IsOverload(absl::ResourceExhaustedError("the query has 2000000 bytes")));
  EXPECT_FALSE(IsOverload(absl::OkStatus()));
  EXPECT_FALSE(IsOverload(absl::UnavailableError("the server ends")));
}

TEST(Overload, StaysWhatItIsUnderAnotherMessage) {
  const absl::Status busy = WithMessage(OverloadError("busy"), "line 3: busy");
  EXPECT_TRUE(IsOverload(busy));
  EXPECT_EQ(busy.message(), "line 3: busy");
  const absl::Status own = WithMessage(absl::ResourceExhaustedError("long"), "line 3: long");
  EXPECT_FALSE(IsOverload(own));
  EXPECT_EQ(own.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(WithMessage(absl::InvalidArgumentError(""), "x").code(), absl::StatusCode::kInvalidArgument);
}

TEST(Overload, WhatOthersHoldIsOneAndWhatAPieceOfWorkHoldsItselfIsNot) {
  MemoryBudget all("queries_memory_bytes", 1 << 20);
  MemoryUse first(8 << 20, &all);
  EXPECT_FALSE(first.Add(4 << 20));
  EXPECT_TRUE(IsOverload(first.Refusal(absl::ResourceExhaustedError("its own"))));
  MemoryUse second(1 << 10, &all);
  EXPECT_FALSE(second.Add(1 << 11));
  EXPECT_FALSE(IsOverload(second.Refusal(absl::ResourceExhaustedError("its own"))));
}

}  // namespace
}  // namespace docent
