#include "kb_server/http/http_body_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using State = HttpBodyReader::State;

struct Result {
  State state;
  std::string body;
  int status = 0;
  std::string message;
  std::string rest;
};

Result ReadInPieces(const HttpHead& head, std::string_view text, size_t piece, HttpBodyLimits limits) {
  HttpBodyReader reader(head, limits);
  Result result{reader.state()};
  result.rest = text;
  while (!text.empty() && result.state == State::kMore) {
    std::string_view input = text.substr(0, piece);
    text.remove_prefix(input.size());
    result.state = reader.Read(&input, &result.body);
    result.rest = std::string(input) + std::string(text);
  }
  if (result.state == State::kRefused) {
    result.status = reader.refusal().status;
    result.message = reader.refusal().body;
  }
  return result;
}

Result Read(const HttpHead& head, std::string_view text, HttpBodyLimits limits) {
  const Result whole = ReadInPieces(head, text, text.size(), limits);
  for (const size_t piece : {1, 3, 8}) {
    const Result result = ReadInPieces(head, text, piece, limits);
    EXPECT_EQ(result.state, whole.state) << text;
    EXPECT_EQ(result.status, whole.status) << text;
    if (result.state != State::kRefused) {
      EXPECT_EQ(result.body, whole.body) << text;
    }
    if (result.state == State::kDone) {
      EXPECT_EQ(result.rest, whole.rest) << text;
    }
  }
  return whole;
}

Result ReadLength(uint64_t length, std::string_view text, HttpBodyLimits limits = {}) {
  HttpHead head;
  head.length = length;
  return Read(head, text, limits);
}

Result ReadChunks(std::string_view text, HttpBodyLimits limits = {}) {
  HttpHead head;
  head.chunked = true;
  return Read(head, text, limits);
}

TEST(HttpBodyReader, ReadsSoManyBytes) {
  const Result result = ReadLength(5, "helloGET /");
  EXPECT_EQ(result.state, State::kDone);
  EXPECT_EQ(result.body, "hello");
  EXPECT_EQ(result.rest, "GET /");
  EXPECT_EQ(ReadLength(0, "GET /").state, State::kDone);
  EXPECT_EQ(ReadLength(6, "hello").state, State::kMore);
  EXPECT_EQ(ReadLength(5, "hello", {5, 10}).state, State::kDone);
  EXPECT_EQ(ReadLength(6, "", {5, 10}).status, 413) << "before anything is read";
}

TEST(HttpBodyReader, ReadsChunks) {
  const Result result = ReadChunks("5\r\nhello\r\n00B\r\n, \r\nworld.\n\r\n0\r\n\r\nGET /");
  EXPECT_EQ(result.state, State::kDone);
  EXPECT_EQ(result.body, "hello, \r\nworld.\n");
  EXPECT_EQ(result.rest, "GET /");
  EXPECT_EQ(ReadChunks("0\r\n\r\n").state, State::kDone);
  EXPECT_EQ(ReadChunks("5\r\nhello\r\n0\r\n").state, State::kMore);
}

TEST(HttpBodyReader, ExtensionsAndTrailerFieldsAreDropped) {
  const Result result = ReadChunks("5;a;b=c ; d = \"e;\\\"\r\n\"\r\n");
  EXPECT_EQ(result.status, 400) << "a quoted string does not go over a line's end";
  const Result good = ReadChunks(
      "5;a;b=c ; d = \"e;\\\" f\"\r\nhello\r\n0;last\r\nX-Sum: 1\r\nTransfer-Encoding: gzip\r\n\r\nGET /");
  EXPECT_EQ(good.state, State::kDone);
  EXPECT_EQ(good.body, "hello");
  EXPECT_EQ(good.rest, "GET /");
}

TEST(HttpBodyReader, BrokenChunksAreRefused) {
  for (const char* text : {"\r\n",
                           "x\r\n",
                           "0x5\r\nhello\r\n",
                           "+5\r\nhello\r\n",
                           "-5\r\nhello\r\n",
                           " 5\r\nhello\r\n",
                           "5 \r\nhello\r\n",
                           "5\nhello\r\n",
                           "5\rhello\r\n",
                           "5\r\nhelloX\r\n",
                           "5\r\nhello\n",
                           "5\r\nhello\r\r\n",
                           "5\r\nhello0\r\n\r\n",
                           "5;\r\nhello\r\n",
                           "5;=x\r\nhello\r\n",
                           "5;a=\r\nhello\r\n",
                           "5;a=\"b\r\nhello\r\n",
                           "5;a b\r\nhello\r\n",
                           "5;a=b\"c\"\r\nhello\r\n",
                           "5;a\x01\r\nhello\r\n",
                           "5;a\r;b\r\nhello\r\n",
                           "5,a\r\nhello\r\n",
                           "0\r\nno field\r\n\r\n",
                           "0\r\n folded: x\r\n\r\n",
                           "0\r\nX : y\r\n\r\n",
                           "0\r\nX: y\n\r\n",
                           "0\r\n\n"}) {
    EXPECT_EQ(ReadChunks(text).status, 400) << text;
  }
}

TEST(HttpBodyReader, SizesThatOverflowAreTooLarge) {
  for (const char* text :
       {"10000000000000000\r\n", "ffffffffffffffff\r\n", "fffffffffffffffffffffffffffffffff\r\n",
        "10000000000000005\r\nhello\r\n", "8000000000000000\r\n"}) {
    EXPECT_EQ(ReadChunks(text).status, 413) << text;
  }
  EXPECT_EQ(ReadChunks("5\r\nhello\r\nfffffffffffffffe\r\n").status, 413) << "all chunks together";
  EXPECT_EQ(ReadChunks("000000000000000000000000000000005\r\nhello\r\n0\r\n\r\n").body, "hello");
}

TEST(HttpBodyReader, LimitsHoldAtTheLimitAndBeyond) {
  EXPECT_EQ(ReadChunks("3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n", {5, 100}).state, State::kDone);
  EXPECT_EQ(ReadChunks("3\r\nabc\r\n3\r\n", {5, 100}).status, 413);
  const Result trailer = ReadChunks("0\r\nX: " + std::string(100, 'y') + "\r\n\r\n", {5, 100});
  EXPECT_EQ(trailer.status, 431);
  EXPECT_THAT(trailer.message, HasSubstr("the trailer fields of the request are larger than 100 bytes"));
  EXPECT_EQ(ReadChunks("0\r\nX: " + std::string(95, 'y') + "\r\n\r\n", {5, 100}).state, State::kDone);
  EXPECT_EQ(
      ReadChunks("0\r\nX: " + std::string(50, 'y') + "\r\nX: " + std::string(50, 'y') + "\r\n\r\n", {5, 100})
          .status,
      431)
      << "all fields together";
}

// Bytes between the chunks are not stored, and are still limited.
TEST(HttpBodyReader, AnEndlessExtensionIsRefused) {
  const Result extension = ReadChunks("5;a=" + std::string(1000, 'x'), {5, 100});
  EXPECT_EQ(extension.status, 400);
  EXPECT_THAT(extension.message, HasSubstr("the chunk extensions of the request are larger than 100 bytes"));
  std::string many;
  for (int i = 0; i < 10; ++i) many += "1;a=" + std::string(40, 'x') + "\r\ny\r\n";
  EXPECT_EQ(ReadChunks(many, {500, 100}).status, 400) << "all extensions together";
  EXPECT_EQ(ReadChunks(std::string(1000, '0'), {5, 100}).status, 400) << "digits likewise";
}

}  // namespace
}  // namespace docent::server
