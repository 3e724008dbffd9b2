#include "kb_server/http/http_multipart.h"

#include <gtest/gtest.h>

namespace docent::server {
namespace {

constexpr char kType[] = "multipart/form-data; boundary=xyz";

TEST(HttpMultipart, PartsWithTheirTypes) {
  const std::string body =
      "preamble\r\n--xyz\r\nContent-Disposition: form-data; name=\"a\"; filename=\"a.nt\"\r\nContent-Type: "
      "text/turtle\r\n\r\n<a> <b> <c> .\r\n"
      "--xyz\r\n\r\ntwo\r\nlines\r\n--xyz--\r\n";
  const auto parts = ParseMultipart(kType, body);
  ASSERT_TRUE(parts.ok()) << parts.status();
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
  ASSERT_TRUE(parts.ok()) << parts.status();
  ASSERT_EQ(parts->size(), 1u);
  EXPECT_EQ((*parts)[0].body, "body");
}

TEST(HttpMultipart, AnEmptyPartAndNoPart) {
  const auto parts = ParseMultipart(kType, "--xyz\r\n\r\n--xyz--");
  ASSERT_TRUE(parts.ok()) << parts.status();
  ASSERT_EQ(parts->size(), 1u);
  EXPECT_EQ((*parts)[0].body, "");
  EXPECT_TRUE(ParseMultipart(kType, "--xyz--")->empty());
}

TEST(HttpMultipart, WhatDoesNotEndIsRefused) {
  EXPECT_FALSE(ParseMultipart("multipart/form-data", "--xyz--").ok());
  EXPECT_FALSE(ParseMultipart(kType, "").ok());
  EXPECT_FALSE(ParseMultipart(kType, "--xyz").ok());
  EXPECT_FALSE(ParseMultipart(kType, "--xyz\r\nContent-Type: a/b").ok());
  EXPECT_FALSE(ParseMultipart(kType, "--xyz\r\n\r\nbody").ok());
}

TEST(HttpMultipart, ManySmallPartsEndAtTheirLimit) {
  std::string body;
  for (int i = 0; i < 3; ++i) body += "--xyz\r\n\r\n\r\n";
  body += "--xyz--";
  EXPECT_EQ(ParseMultipart(kType, body, 3)->size(), 3u);
  const auto refused = ParseMultipart(kType, body, 2);
  EXPECT_EQ(refused.status().message(),
            "the multipart body has more parts than the limit http_parameters = 2");
}

}  // namespace
}  // namespace docent::server
