// Large documents: a check takes time in proportion to them, and ends when it is told to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "workflow/cawl/check/check.h"
#include "workflow/xml/xml_document.h"

namespace docent::cawl {
namespace {

double CpuSeconds(const std::function<void()>& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  };
  const double begin = now();
  work();
  return now() - begin;
}

std::string Document(const std::string& flows) {
  return absl::StrCat("<CAWL name=\"W\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" ",
                      "xmlns:expo=\"https://w3id.org/docent/expo#\">", flows, "</CAWL>");
}

std::string Link(const std::string& from, const std::string& to, const std::string& more = "") {
  return absl::StrCat("<link from=\"", from, "\" to=\"", to, "\" ", more, "/>");
}

std::string Name(int i) {
  return absl::StrCat("n", i);
}

// A chain of nodes, each with `content` of its number, and `links` beside.
std::string Chain(int nodes, const std::function<std::string(int)>& content, const std::string& links) {
  std::string out = "<flow name=\"F\"><source name=\"s\"/>", chain = Link("s", "n0");
  for (int i = 0; i < nodes; ++i) {
    absl::StrAppend(&out, "<node name=\"", Name(i), "\">", content(i), "</node>");
    absl::StrAppend(&chain, Link(Name(i), i + 1 < nodes ? Name(i + 1) : "t"));
  }
  return Document(absl::StrCat(out, "<sink name=\"t\"/>", chain, links, "</flow>"));
}

std::string Empty(int) {
  return "";
}

// So many links from each node on to nodes behind the next one.
std::string Onward(int nodes, int links, const std::string& more = "") {
  std::string out;
  for (int i = 0; i < nodes; ++i) {
    for (int to = i + 2; to < std::min(nodes, i + 2 + links); ++to) out += Link(Name(i), Name(to), more);
  }
  return out;
}

std::string Joins(int nodes, int joins) {
  return Chain(
      nodes,
      [joins](int i) {
        std::string names;
        for (int j = std::max(0, i - joins); j < i; ++j)
          absl::StrAppend(&names, names.empty() ? "" : " and ", Name(j));
        return names.empty() ? names : absl::StrCat("<wait joinCondition=\"", names, "\"/>");
      },
      Onward(nodes, joins - 1));
}

// Every second node of `nodes` follows from each, and two of them set each variable.
std::string Forks(int nodes) {
  std::string variables, out = "<source name=\"s\"/>", links;
  for (int i = 0; i < nodes; ++i) {
    if (i % 2 == 0) absl::StrAppend(&variables, "<variable name=\"v", i / 2, "\"/>");
    absl::StrAppend(&out, "<node name=\"", Name(i), "\"><invoke operation=\"go\"><ext:output part=\"r\" ",
                    "variable=\"v", i / 2, "\"/></invoke></node>");
    absl::StrAppend(&links, Link("s", Name(i)), Link(Name(i), "t"));
    for (int to = i + 2; to < nodes; to += 2) links += Link(Name(i), Name(to));
  }
  return Document(absl::StrCat("<flow name=\"F\">", variables, out, "<sink name=\"t\"/>", links, "</flow>"));
}

std::string Subflows(int flows, int each) {
  std::string out;
  for (int i = 0; i < flows; ++i) {
    absl::StrAppend(&out, "<flow name=\"F", i, "\"><source name=\"s\"/><node name=\"n\">");
    for (int sub = i + 1; sub < std::min(flows, i + each); ++sub)
      absl::StrAppend(&out, "<invoke subflow=\"F", sub, "\"/>");
    absl::StrAppend(&out, "</node><sink name=\"t\"/>", Link("s", "n"), Link("n", "t"), "</flow>");
  }
  return Document(out);
}

std::string Loops(int nodes) {
  std::string links;
  for (int i = 1; i < nodes; ++i) links += Link(Name(i), "n0", "ext:while=\"expo:a expo:b 1\"");
  return Chain(nodes, Empty, links);
}

// Conditions of 128 alternatives each.
std::string Alternatives(int nodes) {
  std::string constraints, expression;
  for (int i = 0; i < 7; ++i) {
    for (const char* side : {"a", "b"})
      absl::StrAppend(&constraints, "<constraint name=\"", side, i, "\"><subject>?x</subject>",
                      "<verb>docent:isAt</verb><object>expo:", side, i, "</object></constraint>");
    absl::StrAppend(&expression, expression.empty() ? "" : " and ", "(a", i, " or b", i, ")");
  }
  const std::string condition = absl::StrCat("<condition><context name=\"c\"><rule name=\"r\" expression=\"",
                                             expression, "\">", constraints, "</rule></context></condition>");
  return Chain(
      nodes, [&](int) { return condition; }, "");
}

std::map<std::string, std::string> Documents() {
  return {
      {"joins", Joins(2000, 20)},
      {"links followed on an interrupt", Chain(2000, Empty, Onward(2000, 18, "ext:onInterrupt=\"true\""))},
      {"nodes that fail", Chain(
                              2000, [](int) { return "<ext:fail reason=\"x\"/>"; }, Onward(2000, 18))},
      {"nodes behind a cycle", Chain(2000, Empty, Onward(2000, 18) + Link("n1", "n0"))},
      {"a ring", Chain(2000, Empty, Link("n1999", "n0"))},
      {"loops", Loops(2000)},
      {"forks", Forks(300)},
      {"flows in flows", Subflows(800, 20)},
  };
}

TEST(CheckCost, IsInProportionToTheText) {
  for (const auto& [name, text] : Documents()) {
    const double reading = CpuSeconds([&] { xml::ParseXml(text, "f"); });
    const double checking = CpuSeconds([&] { CheckDocument(text, "f", nullptr); });
    EXPECT_LT(checking, 12 * reading) << name << ", " << text.size() << " bytes: " << reading << " s";
  }
}

TEST(CheckCost, EndsWhenItsCallerGoesAway) {
  for (const std::string& text : {Joins(200, 20), Forks(60), Subflows(60, 10), Alternatives(20)}) {
    Cancellation counting;
    int looks = 0;
    counting.OnLook([&looks](const Cancellation&) { ++looks; });
    EXPECT_TRUE(CheckDocument(text, "f", nullptr, {}, {}, &counting).ok());
    for (const int last : {1, looks / 3, looks / 2}) {
      Cancellation cancellation;
      int look = 0;
      cancellation.OnLook([&](const Cancellation&) {
        if (++look == last) cancellation.Cancel();
      });
      const CheckReport report = CheckDocument(text, "f", nullptr, {}, {}, &cancellation);
      EXPECT_EQ(report.stopped.code(), absl::StatusCode::kCancelled);
      EXPECT_FALSE(report.ok());
      EXPECT_LT(look, last + 20) << "one look of each check that has not begun";
    }
  }
}

TEST(CheckCost, LooksAgainAfterEachCondition) {
  Cancellation cancellation;
  int looks = 0;
  cancellation.OnLook([&looks](const Cancellation&) { ++looks; });
  EXPECT_TRUE(CheckDocument(Alternatives(40), "f", nullptr, {}, {}, &cancellation).ok());
  EXPECT_GT(looks, 2 * 40) << "as a text, and for what it says";
}

TEST(CheckCost, EndsAtItsDeadline) {
  Cancellation cancellation(std::chrono::milliseconds(1));
  const CheckReport report = CheckDocument(Joins(2000, 20), "f", nullptr, {}, {}, &cancellation);
  EXPECT_EQ(report.stopped.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_THAT(std::string(report.stopped.message()), ::testing::HasSubstr("query_timeout_ms = 1"));
}

}  // namespace
}  // namespace docent::cawl
