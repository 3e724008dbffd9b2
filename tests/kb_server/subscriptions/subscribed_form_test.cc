#include "kb_server/subscriptions/subscribed_form.h"

#include <gtest/gtest.h>

#include "graph/sparql/syntax/parser.h"

namespace docent::server {
namespace {

std::optional<SubscribedForm> FormOf(const std::string& text) {
  sparql::ParsedQuery parsed = sparql::ParseQuery("PREFIX : <http://example.org/>\n" + text);
  EXPECT_TRUE(parsed.ok()) << text;
  return SubscribedFormOf(parsed.query,
                          matching::AnalyseTriggers(matching::WithoutModifiers(*parsed.query.algebra)));
}

using Names = std::vector<std::string>;
using Places = std::vector<size_t>;

TEST(SubscribedForm, AnAskNeedsNoKeys) {
  const auto form = FormOf("ASK { ?x :p ?y . ?y :q :a FILTER(?x != ?y) FILTER NOT EXISTS { ?x :r ?z } }");
  ASSERT_TRUE(form);
  EXPECT_TRUE(form->keys.empty());
  EXPECT_TRUE(form->columns.empty());
}

TEST(SubscribedForm, RowsThatAreCountedNeedEveryVariable) {
  const auto form = FormOf("SELECT ?z ?x { ?x :p ?y . ?y :q ?z MINUS { ?z :r ?x } }");
  ASSERT_TRUE(form);
  EXPECT_EQ(form->keys, (Names{"x", "y", "z"}));
  EXPECT_EQ(form->columns, (Places{2, 0}));
}

TEST(SubscribedForm, DistinctRowsNeedTheirOwnVariables) {
  const auto form = FormOf("SELECT DISTINCT ?z ?x { { ?x :p ?z } UNION { ?z :q ?x . ?x :r ?y } }");
  ASSERT_TRUE(form);
  EXPECT_EQ(form->keys, (Names{"z", "x"}));
  EXPECT_EQ(form->columns, (Places{0, 1}));
}

TEST(SubscribedForm, RowsAreHadFromBindingsInTheAnswersOrder) {
  const SubscribedForm form{{"x", "y", "z"}, {2, 0}};
  const auto id = [](uint64_t n) { return TermId::Make(TermId::Tag::kIri, n); };
  const auto rows = form.RowsOf({{{"x", id(1)}, {"y", id(2)}, {"z", id(3)}}});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0], (SubscriptionAnswer::Row{id(3), id(1)}));
}

TEST(SubscribedForm, WhatHasToBeAskedWhole) {
  for (const char* text : {
           "SELECT ?x { { ?x :p ?y } UNION { ?x :q ?y } }",  // a row may come from both
           "SELECT ?x { ?x :p ?y } LIMIT 3",
           "SELECT ?x (COUNT(?y) AS ?n) { ?x :p ?y } GROUP BY ?x",
           "SELECT ?s { ?x :p ?y BIND(STR(?y) AS ?s) }",
           "SELECT ?x ?w { ?x :p ?y OPTIONAL { ?x :q ?w } }",
           "SELECT ?x ?y { ?x :p+ ?y }",
           "SELECT ?x ?nothing { ?x :p ?y }",
           "SELECT ?g ?x { GRAPH ?g { ?x :p ?y } }",
           "SELECT * { :a :p :b }",
           "ASK { ?x :p ?t FILTER(?t < NOW()) }",
           "ASK FROM :g { ?x :p ?y }",
           "ASK { ?x :p ?y FILTER EXISTS { SELECT ?y { ?y :q ?z } LIMIT 1 } }",
       }) {
    EXPECT_FALSE(FormOf(text)) << text;
  }
}

}  // namespace
}  // namespace docent::server
