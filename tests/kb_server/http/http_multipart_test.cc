#include "kb_server/http/http_multipart.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

constexpr char kType[] = "multipart/form-data; boundary=xyz";

TEST(HttpMultipart, PartsWithTheirTypes) {
  const std::string body =
      "preamble\r\n--xyz\r\nContent-Disposition: form-data; name=\"a\"; filename=\"a.nt\"\r\nContent-Type: "
      "text/turtle\r\n\r\n<a> <b> <c> .\r\n"
      "--xyz\r\n\r\ntwo\r\nlines\r\n--xyz--\r\n";
  const auto parts = ParseMultipart(kType, body);
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2u);
  EXPECT_EQ((*parts)[0].content_type, "text/turtle");
  EXPECT_EQ((*parts)[0].file, "a.nt");
  EXPECT_EQ((*parts)[0].body, "<a> <b> <c> .");
  EXPECT_EQ((*parts)[1].file, "");
  EXPECT_EQ((*parts)[1].content_type, "");
  EXPECT_EQ((*parts)[1].body, "two\r\nlines");
}

TEST(HttpMultipart, LinesMayEndWithLineFeedAloneAndTheBoundaryMayBeQuoted) {
  const auto parts =
      ParseMultipart("multipart/form-data; boundary=\"x z\"", "--x z\nContent-Type: a/b\n\nbody\n--x z--");
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 1u);
  EXPECT_EQ((*parts)[0].body, "body");
}

TEST(HttpMultipart, AnEmptyPartAndNoPart) {
  const auto parts = ParseMultipart(kType, "--xyz\r\n\r\n--xyz--");
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 1u);
  EXPECT_EQ((*parts)[0].body, "");
  EXPECT_TRUE(ParseMultipart(kType, "--xyz--")->empty());
}

TEST(HttpMultipart, WhatDoesNotEndIsRefused) {
  EXPECT_FALSE(ParseMultipart("multipart/form-data", "--xyz--"));
  EXPECT_FALSE(ParseMultipart(kType, ""));
  EXPECT_FALSE(ParseMultipart(kType, "--xyz"));
  EXPECT_FALSE(ParseMultipart(kType, "--xyz\r\nContent-Type: a/b"));
  EXPECT_FALSE(ParseMultipart(kType, "--xyz\r\n\r\nbody"));
}

}  // namespace
}  // namespace docent
