#include "kb_server/http/http_head_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using State = HttpHeadReader::State;

struct Result {
  State state;
  HttpHead head;
  int status = 0;
  std::string message;
  std::string rest;
};

Result ReadInPieces(std::string_view text, size_t piece, HttpHeadLimits limits = {}) {
  HttpHeadReader reader(limits);
  Result result{State::kMore};
  while (!text.empty() && result.state == State::kMore) {
    std::string_view input = text.substr(0, piece);
    text.remove_prefix(input.size());
    result.state = reader.Read(&input);
    result.rest = std::string(input) + std::string(text);
  }
  if (result.state == State::kDone) result.head = reader.head();
  if (result.state == State::kRefused) {
    result.status = reader.refusal().status;
    result.message = reader.refusal().body;
  }
  return result;
}

Result Read(std::string_view text, HttpHeadLimits limits = {}) {
  const Result whole = ReadInPieces(text, text.size(), limits);
  for (const size_t piece : {1, 2, 7}) {
    const Result result = ReadInPieces(text, piece, limits);
    EXPECT_EQ(result.state, whole.state) << text;
    EXPECT_EQ(result.status, whole.status) << text;
    EXPECT_EQ(result.head.fields, whole.head.fields) << text;
    if (result.state == State::kDone) {
      EXPECT_EQ(result.rest, whole.rest) << text;
    }
  }
  return whole;
}

std::string Post(const std::string& fields) {
  return "POST /x HTTP/1.1\r\nHost: h\r\n" + fields + "\r\nGET /smuggled HTTP/1.1\r\n\r\n";
}

TEST(HttpHeadReader, ReadsRequestLineAndFields) {
  const Result result = Read(
      "\r\nPOST /a?b=%20c HTTP/1.1\r\nHost: localhost:1\r\nX-Empty:\r\nX-Two:\t one  two \t\r\n"
      "x-b\xc3\xbc: no\r\n\r\n");
  EXPECT_EQ(result.status, 400) << "a name is a token";
  const Result good = Read(
      "\r\nPOST /a?b=%20c HTTP/1.1\r\nHost: localhost:1\r\nX-Empty:\r\nX-Two:\t one  two "
      "\t\r\nContent-Length: "
      "12\r\n\r\nbody");
  ASSERT_EQ(good.state, State::kDone);
  EXPECT_EQ(good.head.method, "POST");
  EXPECT_EQ(good.head.target, "/a?b=%20c");
  EXPECT_EQ(good.head.minor_version, 1);
  EXPECT_EQ(good.head.fields,
            (HttpFields{
                {"host", "localhost:1"}, {"x-empty", ""}, {"x-two", "one  two"}, {"content-length", "12"}}));
  EXPECT_EQ(good.head.length, 12u);
  EXPECT_FALSE(good.head.chunked);
  EXPECT_TRUE(good.head.keep_alive);
  EXPECT_EQ(good.rest, "body");
}

TEST(HttpHeadReader, ConnectionsAreKeptAsTheVersionSays) {
  EXPECT_TRUE(Read("GET / HTTP/1.1\r\nHost: h\r\n\r\n").head.keep_alive);
  EXPECT_FALSE(Read("GET / HTTP/1.1\r\nHost: h\r\nConnection: TE, Close\r\n\r\n").head.keep_alive);
  EXPECT_FALSE(Read("GET / HTTP/1.0\r\n\r\n").head.keep_alive);
  EXPECT_TRUE(Read("GET / HTTP/1.0\r\nConnection: Keep-Alive\r\n\r\n").head.keep_alive);
  EXPECT_FALSE(Read("GET / HTTP/1.0\r\nConnection: keep-alive\r\nConnection: close\r\n\r\n").head.keep_alive);
}

TEST(HttpHeadReader, ChunkedAloneIsTheCodingThatIsRead) {
  for (const char* coding : {"chunked", "Chunked", " chunked \t"}) {
    const Result result = Read(Post(absl::StrCat("Transfer-Encoding:", coding, "\r\n")));
    EXPECT_EQ(result.state, State::kDone) << coding;
    EXPECT_TRUE(result.head.chunked) << coding;
  }
}

// RFC 9112 sections 6.1 and 6.3: the end of such a body is not known, or differs between servers.
TEST(HttpHeadReader, FramingThatTwoServersCouldReadDifferentlyIsRefused) {
  for (const char* fields : {"Transfer-Encoding: xchunked\r\n",
                             "Transfer-Encoding: identity\r\n",
                             "Transfer-Encoding: gzip\r\n",
                             "Transfer-Encoding: chunked, identity\r\n",
                             "Transfer-Encoding: chunked, gzip\r\n",
                             "Transfer-Encoding: chunked, chunked\r\n",
                             "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
                             "Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n",
                             "Transfer-Encoding:\r\n",
                             "Transfer-Encoding: ,chunked\r\n",
                             "Transfer-Encoding: chunked,\r\n",
                             "Transfer-Encoding: \"chunked\"\r\n",
                             "Transfer-Encoding: chunked;q=1\r\n",
                             "Transfer-Encoding: chunked;\r\n",
                             "Transfer-Encoding: chunked x\r\n",
                             "Transfer-Encoding: \x0b"
                             "chunked\r\n",
                             "Transfer-Encoding: chunked\xc2\xa0\r\n",
                             "Transfer-Encoding: c\r\n hunked\r\n",
                             "Transfer-Encoding:\r\n chunked\r\n",
                             "Transfer-Encoding : chunked\r\n",
                             " Transfer-Encoding: chunked\r\n",
                             "Transfer-Encoding\r\n",
                             "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n",
                             "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n",
                             "Content-Length: 0\r\nTransfer-Encoding: chunked\r\n",
                             "Content-Length: 4\r\nContent-Length: 4\r\n",
                             "Content-Length: 4\r\nContent-Length: 5\r\n",
                             "Content-Length: 4, 4\r\n",
                             "Content-Length: 4,5\r\n",
                             "Content-Length:\r\n",
                             "Content-Length: +5\r\n",
                             "Content-Length: -5\r\n",
                             "Content-Length: 0x5\r\n",
                             "Content-Length: 5 5\r\n",
                             "Content-Length: 5a\r\n",
                             "Content-Length: 5.0\r\n",
                             "Content-Length: 1_0\r\n",
                             "Content-Length: 18446744073709551616\r\n",
                             "Content-Length : 5\r\n",
                             "Content-Length:\r\n 5\r\n",
                             "Content-Length: \xd9\xa5\r\n"}) {
    const Result result = Read(Post(fields));
    EXPECT_EQ(result.state, State::kRefused) << fields;
    EXPECT_EQ(result.status, 400) << fields;
  }
  EXPECT_EQ(Read("POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n").status, 400);
}

TEST(HttpHeadReader, CodingsThatAreNotReadAreNamed) {
  for (const char* fields :
       {"Transfer-Encoding: gzip, chunked\r\n", "Transfer-Encoding: gzip\r\nTransfer-Encoding: chunked\r\n",
        "Transfer-Encoding: x;a=b,chunked\r\n"}) {
    const Result result = Read(Post(fields));
    EXPECT_EQ(result.status, 501) << fields;
    EXPECT_THAT(result.message, HasSubstr("is not read; send the body as it is"));
  }
}

TEST(HttpHeadReader, LinesEndWithCrLfAlone) {
  for (const std::string& text :
       {std::string("GET / HTTP/1.1\nHost: h\n\n"), std::string("GET / HTTP/1.1\r\nHost: h\n\r\n"),
        std::string("GET / HTTP/1.1\rHost: h\r\r"), std::string("GET / HTTP/1.1\r\nHost: h\rX: y\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: h\r\r\n\r\n"), std::string("GET / HTTP/1.1\r\nHost: h\r\n\n"),
        std::string("\nGET / HTTP/1.1\r\nHost: h\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: h\r\nX: a\0b\r\n\r\n", 35),
        std::string("GET /\0 HTTP/1.1\r\nHost: h\r\n\r\n", 28),
        std::string("GET / HTTP/1.1\r\nHost: h\r\nX: \x7f\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: h\r\nX: \x1b[0m\r\n\r\n")}) {
    const Result result = Read(text);
    EXPECT_EQ(result.status, 400) << text;
    EXPECT_THAT(result.message, HasSubstr("does not end with CR LF")) << text;
  }
  EXPECT_EQ(ReadInPieces("GET / HTTP/1.1\n", 100).status, 400) << "at once, not when the head ends";
}

TEST(HttpHeadReader, BrokenRequestLinesAndFields) {
  for (const char* text : {"nonsense\r\n",
                           "GET /hello\r\n",
                           "GET  /hello HTTP/1.1\r\n",
                           "GET /hello  HTTP/1.1\r\n",
                           " GET / HTTP/1.1\r\n",
                           "GET /a b HTTP/1.1\r\n",
                           "GET / http/1.1\r\n",
                           "GET / HTTP/1\r\n",
                           "GET / HTTP/1.10\r\n",
                           "GET / HTTP/11\r\n",
                           "GET / HTTP/1.1 \r\n",
                           "G\xc3T / HTTP/1.1\r\n",
                           "GET\t/\tHTTP/1.1\r\n",
                           "GET /#part HTTP/1.1\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nnothing\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\n: x\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nA B: x\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nA\t: x\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\n\tfolded\r\n",
                           "GET / HTTP/1.1\r\n Host: h\r\n"}) {
    EXPECT_EQ(Read(text).status, 400) << text;
  }
  EXPECT_EQ(Read("GET / HTTP/2.0\r\n").status, 505);
  EXPECT_EQ(Read("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n").status, 505);
  EXPECT_EQ(Read("GET / HTTP/1.2\r\nHost: h\r\n\r\n").state, State::kDone);
}

TEST(HttpHeadReader, OneHostIsWanted) {
  EXPECT_THAT(Read("GET / HTTP/1.1\r\n\r\n").message, HasSubstr("no Host header"));
  EXPECT_EQ(Read("GET / HTTP/1.0\r\n\r\n").state, State::kDone);
  EXPECT_THAT(Read("GET / HTTP/1.1\r\nHost: h\r\nHost: h\r\n\r\n").message, HasSubstr("more than one Host"));
  EXPECT_EQ(Read("GET / HTTP/1.0\r\nHost: h\r\nHost: h\r\n\r\n").status, 400);
}

TEST(HttpHeadReader, ExpectationsThatAreNotMetAreRefused) {
  EXPECT_TRUE(Read(Post("Expect: 100-Continue\r\n")).head.expects_continue);
  EXPECT_EQ(Read(Post("Expect: wonders\r\n")).status, 417);
  EXPECT_EQ(Read(Post("Expect: 100-continue\r\nExpect: 100-continue\r\n")).status, 417);
  EXPECT_FALSE(Read("POST / HTTP/1.0\r\nExpect: 100-continue\r\n\r\n").head.expects_continue);
}

TEST(HttpHeadReader, LimitsHoldAtTheLimitAndBeyond) {
  const std::string head = "GET / HTTP/1.1\r\nHost: h\r\nX: y\r\n\r\n";
  EXPECT_EQ(Read(head, {head.size(), 2}).state, State::kDone);
  EXPECT_EQ(Read(head, {head.size() - 1, 2}).status, 431);
  const Result many = Read(head, {head.size(), 1});
  EXPECT_EQ(many.status, 431);
  EXPECT_THAT(many.message, HasSubstr("the limit http_header_fields = 1"));
  EXPECT_EQ(Read("GET /" + std::string(100, 'x'), {50, 2}).status, 414);
  EXPECT_EQ(Read("\r\n\r\n\r\n\r\n\r\n\r\n", {10, 2}).status, 414) << "empty lines are counted";
}

}  // namespace
}  // namespace docent::server
