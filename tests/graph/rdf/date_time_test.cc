#include "graph/rdf/date_time.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

TEST(DateTimeTerm, IsCanonical) {
  EXPECT_EQ(DateTimeTerm(0).lexical, "1970-01-01T00:00:00Z");
  EXPECT_EQ(DateTimeTerm(500'000).lexical, "1970-01-01T00:00:00.5Z");
  EXPECT_EQ(DateTimeTerm(1'700'000'000'120'999).lexical, "2023-11-14T22:13:20.12Z");
  EXPECT_EQ(DateTimeTerm(0).datatype, "http://www.w3.org/2001/XMLSchema#dateTime");
}

}  // namespace
}  // namespace docent
