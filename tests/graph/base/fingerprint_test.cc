#include "graph/base/fingerprint.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

// Values of the published test vectors of FNV-1a. Documents contain fingerprints (names of inconsistencies,
// labels of blank nodes), so they must not change.
TEST(Fingerprint, HasThePublishedValues) {
  EXPECT_EQ(Fingerprint(""), 0xCBF29CE484222325u);
  EXPECT_EQ(Fingerprint("a"), 0xAF63DC4C8601EC8Cu);
  EXPECT_EQ(Fingerprint("foobar"), 0x85944171F73967E8u);
}

TEST(Fingerprint, OfPartsIsThatOfTheWhole) {
  EXPECT_EQ(Fingerprint("bar", Fingerprint("foo")), Fingerprint("foobar"));
}

TEST(Fingerprint, BytesAboveAsciiCountAsUnsigned) {
  EXPECT_EQ(Fingerprint("\xFF"), 0xAF64724C8602EB6Eu);
}

}  // namespace
}  // namespace docent
