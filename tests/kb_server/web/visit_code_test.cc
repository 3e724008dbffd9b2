#include "kb_server/web/visit_code.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(VisitCodeTest, AnAddressNamesThePlaceInItsQuery) {
  EXPECT_EQ(*VisitAddress("https://expo.example.org/", "B05"), "https://expo.example.org/visit?at=B05");
  EXPECT_EQ(*VisitAddress("http://10.0.0.7:7480", "expo:B05"), "http://10.0.0.7:7480/visit?at=expo:B05");
  EXPECT_EQ(*VisitAddress("http://h", "https://w3id.org/docent/expo#B05"),
            "http://h/visit?at=https:%2F%2Fw3id.org%2Fdocent%2Fexpo%23B05");
  EXPECT_EQ(*VisitAddress("http://h", "Café & Bar"), "http://h/visit?at=Caf%C3%A9%20%26%20Bar");
}

TEST(VisitCodeTest, WhatIsNoAddressIsRefused) {
  for (const char* base : {"", "expo.example.org", "ftp://h", "http://", "http:///x", "https://h?x",
                           "https://h#x", "https://a@h", "https://h h", "javascript:alert(1)"}) {
    EXPECT_EQ(VisitAddress(base, "B05").status().code(), absl::StatusCode::kInvalidArgument) << base;
  }
  EXPECT_THAT(std::string(VisitAddress("x", "B05").status().message()),
              HasSubstr("https://expo.example.org"));
  EXPECT_EQ(VisitAddress("http://h", "").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(VisitAddress("http://h", "\xff").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(VisitCodeTest, ACodeHasAQuietZoneAndItsLabel) {
  const std::string svg = *QrCodeSvg("http://h/visit?at=B05", "<B05> & co");
  // Version 2 has 25 modules; four at each side are quiet, and five below are the label's.
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 33 38\""));
  EXPECT_THAT(svg, HasSubstr("M4 4h7v1h-7z"));  // the first finder pattern
  EXPECT_THAT(svg, HasSubstr("&lt;B05&gt; &amp; co</text>"));
  EXPECT_THAT(*QrCodeSvg("http://h", ""), Not(HasSubstr("<text")));
}

TEST(VisitCodeTest, TheLimitHolds) {
  WebLimits limits;
  limits.visit_code_bytes = 21;
  EXPECT_TRUE(VisitAddress("http://h", "B05", limits).ok());  // "http://h/visit?at=B05"
  const absl::Status beyond = VisitAddress("http://h", "B055", limits).status();
  EXPECT_EQ(beyond.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(beyond.message()), HasSubstr("visit_code_bytes is 21"));
  EXPECT_TRUE(QrCodeSvg(std::string(21, 'x'), "", limits).ok());
  EXPECT_EQ(QrCodeSvg(std::string(22, 'x'), "", limits).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(QrCodeSvg(std::string(1024, 'x'), "").ok());
}

}  // namespace
}  // namespace docent::server
