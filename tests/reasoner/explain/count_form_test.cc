#include "reasoner/explain/count_form.h"

#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "reasoner/matching/trigger_analysis.h"
#include "tests/reasoner/explain/explain_world.h"

namespace docent {
namespace {

class CountForm : public ExplainWorld {
 protected:
  bool Ask(const sparql::Query& query) {
    const GraphVersionPtr version = writer.Freeze(Revision(1));
    auto prepared = sparql::PreparedQuery::Prepare(query, dictionary);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    const auto answer = (*prepared)->Ask({.version = version.get()});
    EXPECT_TRUE(answer.ok()) << answer.status();
    return answer.ok() && *answer;
  }
  // The query without its counts; nullopt: it has none that can be rewritten.
  std::optional<sparql::Query> Written(const std::string& ask) {
    sparql::Query query = Parse(ask);
    query.algebra = explain::WithoutCounts(matching::WithoutModifiers(*query.algebra));
    if (query.algebra == nullptr) return std::nullopt;
    return query;
  }
};

TEST_F(CountForm, SaysTheSameOfEveryGraph) {
  const std::vector<std::string> texts = {
      "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n $0 $1) }",
      "ASK { ?b a :Booth . { SELECT ?b (COUNT(*) AS ?n) WHERE { ?v :at ?b ; a :Visitor } GROUP BY ?b } "
      "FILTER($1 $0 ?n && ?b != :B0) }",
      "ASK { { SELECT ?b WHERE { ?v :at ?b } GROUP BY ?b HAVING (COUNT(?v) $0 $1) } }",
      "ASK { { SELECT (COUNT(?v) AS ?n) WHERE { ?v :at :B1 } } FILTER(?n $0 $1) }",
      "ASK { ?b a :Booth { SELECT (COUNT(DISTINCT ?b) AS ?n) WHERE { ?v :at ?b } HAVING (COUNT(DISTINCT ?b) "
      "$0 $1) } }",
      "ASK { { SELECT ?v_2 (COUNT(DISTINCT ?v) AS ?n) WHERE { ?v :at ?v_2 ; :at ?v_3 } GROUP BY ?v_2 } "
      "FILTER(?n $0 $1) }",
      "ASK { ?b a :Booth . { SELECT (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n $0 $1) }",
      "ASK { { SELECT ?b (COUNT(?l) AS ?n) WHERE { ?b :load ?l } GROUP BY ?b } FILTER(?n $0 $1) }",
      "ASK { { SELECT (COUNT(?b) AS ?m) WHERE { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY "
      "?b } FILTER(?n >= 2) } } "
      "FILTER(?m $0 $1) }",
      "ASK { ?v a :Visitor { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b FILTER(?v != :V0) } GROUP BY ?b } "
      "FILTER(?n $0 $1) ?v :at ?b }"};
  std::mt19937 random(7);
  int held = 0, failed = 0;
  std::map<std::string, int> written;
  for (int round = 0; round < 40; ++round) {
    std::vector<std::string> add, remove;
    const auto turn = [&](const std::string& fact, unsigned of) {
      (random() % of == 0 ? remove : add).push_back(fact);
    };
    for (int i = 0; i < 3; ++i) {
      const std::string booth = absl::StrCat("B", i);
      turn(booth + " a Booth", 3);
      for (const char* load : {"1", "1.0", "2", "'1"}) turn(booth + " load " + load, 3);
      for (int v = 0; v < 5; ++v) {
        turn(absl::StrCat("V", v, " at ", booth), 2);
        turn(absl::StrCat("V", v, " a Visitor"), 3);
      }
    }
    Apply(add, remove);
    for (const std::string& text : texts) {
      for (const char* op : {"<", "<=", "=", ">=", ">"}) {
        const std::string ask =
            absl::Substitute(text, op, std::vector<std::string>{"0", "1", "2", "3.0", "2.5"}[random() % 5]);
        const auto plain = Written(ask);
        if (!plain) continue;
        ++written[text];
        const bool holds = Ask(Parse(ask));
        ++(holds ? held : failed);
        ASSERT_EQ(Ask(*plain), holds) << ask;
      }
    }
  }
  // the count of counts stays whole, as it asks how many groups there are
  for (const std::string& text : texts)
    EXPECT_EQ(written[text] > 50, text.find("?m") == std::string::npos) << text;
  EXPECT_GT(held, 200);
  EXPECT_GT(failed, 200);
}

TEST_F(CountForm, WhatIsCountedOrUsedOtherwiseStays) {
  EXPECT_TRUE(
      Written("ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n > 3) }"));
  EXPECT_TRUE(
      Written("ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(4 > ?n) }"));
  for (const char* text :
       {"ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n > 4) }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n <= 4) }",
        "ASK { { SELECT ?b WHERE { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n "
        "> 1) } OFFSET 1 } }",
        "ASK { { SELECT ?b WHERE { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } } } "
        "FILTER(?n > 1) }",
        "ASK { { SELECT ?b (COUNT(?w) AS ?n) WHERE { :v1 :at ?b FILTER(!BOUND(?w)) } GROUP BY ?b } FILTER(?n "
        "> 0) }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n != 2) }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v ?p ?b } GROUP BY ?b } FILTER(?n > 1) }",
        "ASK { { SELECT ?b (SUM(?v) AS ?n) WHERE { ?x :load ?v } GROUP BY ?b } FILTER(?n > 1) }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n > 1) ?b :seats ?n }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } FILTER(?n > 1 && ?n / 2 > 0) "
        "}",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at|:in ?b } GROUP BY ?b } FILTER(?n > 1) }",
        "ASK { { SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b } }",
        "ASK { ?v :at ?b FILTER(?b > 1) }"}) {
    EXPECT_FALSE(Written(text)) << text;
  }
}

}  // namespace
}  // namespace docent
