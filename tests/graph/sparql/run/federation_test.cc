#include "graph/sparql/run/federation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "graph/rdf/term_check.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

// Answers each endpoint's queries from a table, and records them.
class FakeClient final : public ServiceClient {
 public:
  absl::StatusOr<ServiceAnswer> Select(const std::string& endpoint, const std::string& query, bool,
                                       Cancellation*, MemoryUse*) override {
    asked.push_back(endpoint + " " + query);
    const auto it = answers.find(endpoint);
    if (it == answers.end()) return absl::UnknownError("nobody there");
    return it->second;
  }
  std::map<std::string, ServiceAnswer> answers;
  std::vector<std::string> asked;
};

class Federation : public testing::Test {
 protected:
  // The rows as "x=… y=…".
  absl::StatusOr<std::vector<std::string>> Select(const std::string& text) {
    Query query = graph.Parse(text);
    if (absl::Status s = ResolveServices(&query, &client, graph.dictionary, {}, graph.Run()); !s.ok())
      return s;
    auto prepared = PreparedQuery::Prepare(query, graph.dictionary, {});
    if (!prepared.ok()) return prepared.status();
    std::vector<std::string> rows;
    absl::Status status = (*prepared)->Select(graph.Run(), {}, [&](absl::Span<const TermId> row) {
      std::string line;
      for (size_t i = 0; i < row.size(); ++i) {
        if (i > 0) line += " ";
        const Term t = row[i].IsNone() ? Term::Literal("-") : (*prepared)->Decode(row[i]);
        line += t.lexical.substr(t.lexical.find_last_of('/') + 1);
      }
      rows.push_back(line);
      return true;
    });
    if (!status.ok()) return status;
    std::sort(rows.begin(), rows.end());
    return rows;
  }
  static Term Ex(const std::string& name) { return Term::Iri("http://example.org/" + name); }

  TestGraph graph{"ex:a ex:p ex:b . ex:a ex:at <http://one/> . ex:c ex:at <http://two/> ."};
  FakeClient client;
};

TEST_F(Federation, AnAnswerIsJoined) {
  client.answers["http://one/"] = {{"b", "n"}, {{Ex("b"), Term::Integer(1)}, {Ex("x"), Term::Integer(2)}}};
  EXPECT_THAT(*Select("SELECT ?a ?n { ?a ex:p ?b SERVICE <http://one/> { ?b ex:n ?n FILTER(?n > 0) } }"),
              ElementsAre("a 1"));
  ASSERT_THAT(client.asked, SizeIs(1));
  EXPECT_THAT(client.asked[0], HasSubstr("SELECT ?b ?n WHERE {"));
  const ParsedQuery sent = ParseQuery(client.asked[0].substr(client.asked[0].find(' ')));
  EXPECT_TRUE(sent.ok()) << client.asked[0];
}

TEST_F(Federation, AVariableEndpointIsAskedAtEachOfItsValues) {
  client.answers["http://one/"] = {{"n"}, {{Term::Integer(1)}}};
  client.answers["http://two/"] = {{"n"}, {{Term::Integer(2)}, {Term::Integer(3)}}};
  EXPECT_THAT(*Select("SELECT ?s ?n { ?s ex:at ?e SERVICE ?e { ?x ex:n ?n } }"),
              ElementsAre("a 1", "c 2", "c 3"));
  EXPECT_THAT(*Select("SELECT ?s ?n { ?s ex:at ?e OPTIONAL { SERVICE ?e { ?x ex:n ?n } } }"), SizeIs(3));
  EXPECT_THAT(std::string(Select("SELECT * { SERVICE ?e { ?x ex:n ?n } }").status().message()),
              HasSubstr("bind ?e"));
}

TEST_F(Federation, AFailureIsAnErrorUnlessSilent) {
  const absl::Status status =
      Select("SELECT * { ?a ex:p ?b . SERVICE <http://none/> { ?b ex:n ?n } }").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnknown);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("line 1, column 25: SERVICE <http://none/>: nobody there"));
  EXPECT_THAT(*Select("SELECT ?a ?n { ?a ex:p ?b . SERVICE SILENT <http://none/> { ?b ex:n ?n } }"),
              ElementsAre("a -"));
}

TEST_F(Federation, ServicesInsideExistsUnionAndSubSelectAreAsked) {
  client.answers["http://one/"] = {{"b"}, {{Ex("b")}}};
  EXPECT_THAT(*Select("SELECT ?a { ?a ex:p ?b FILTER EXISTS { SERVICE <http://one/> { ?b ex:q 1 } } }"),
              ElementsAre("a"));
  EXPECT_THAT(
      *Select("SELECT ?b { { SERVICE <http://one/> { ?b ex:q 1 } } UNION { SELECT ?b { ?a ex:p ?b } } }"),
      ElementsAre("b", "b"));
}

TEST_F(Federation, BlankNodesOfAnAnswerAreNoneOfOurs) {
  graph.Add("_:n ex:own 1 .");
  client.answers["http://one/"] = {{"x"}, {{Term::Blank("n")}, {Term::Blank("b1")}}};
  EXPECT_THAT(*Select("SELECT ?x { ?x ex:own 1 . SERVICE <http://one/> { ?x ex:q 1 } }"), SizeIs(0));
}

// Endpoints have labels of no grammar of RDF: nodeID://b1.
TEST_F(Federation, LabelsOfAnAnswerBecomeLabelsOfOursOneForEach) {
  client.answers["http://one/"] = {{"x", "y"},
                                   {{Term::Blank("nodeID://b1"), Term::Blank("a b . <x> <y> <z>")},
                                    {Term::Blank(""), Term::Blank("nodeID://b1")}}};
  Query query = graph.Parse("SELECT ?x ?y { SERVICE <http://one/> { ?x ex:q ?y } }");
  ASSERT_TRUE(ResolveServices(&query, &client, graph.dictionary, {}, graph.Run()).ok());
  auto prepared = PreparedQuery::Prepare(query, graph.dictionary, {});
  ASSERT_TRUE(prepared.ok());
  std::vector<Term> terms;
  ASSERT_TRUE((*prepared)
                  ->Select(graph.Run(), {},
                           [&](absl::Span<const TermId> row) {
                             for (const TermId id : row) terms.push_back((*prepared)->Decode(id));
                             return true;
                           })
                  .ok());
  ASSERT_THAT(terms, SizeIs(4));
  for (const Term& term : terms) EXPECT_TRUE(CheckTerm(term, 100).ok()) << term.lexical;
  EXPECT_EQ(terms[0], terms[3]);
  EXPECT_EQ(std::set<Term>(terms.begin(), terms.end()).size(), 3u);
}

TEST_F(Federation, WhatIsNoTermOfAnAnswerIsRefusedByName) {
  Term both = Term::LangString("z", "en");
  both.datatype = "urn:t";
  for (const auto& [term, says] : {std::pair(Term::LangString("z", "en . <x> <y> <z>"), "language tag"),
                                   {Term::Literal("z", "http://e/a b"), "http://e/a b"},
                                   {Term::Literal("z", "t"), "relative"},
                                   {Term::Iri("here"), "relative"},
                                   {Term::Iri("http://e/\x01"), "percent-encoded"},
                                   {Term::Literal("a\xFF"), "0xFF"},
                                   {both, "not both"}}) {
    client.answers["http://one/"] = {{"n"}, {{Term::Integer(1)}, {term}}};
    const absl::Status status = Select("SELECT ?n { SERVICE <http://one/> { ?x ex:n ?n } }").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnknown) << term.lexical;
    EXPECT_THAT(std::string(status.message()), HasSubstr("SERVICE <http://one/>: row 2 of the answer, ?n: "));
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
    EXPECT_THAT(*Select("SELECT ?n { SERVICE SILENT <http://one/> { ?x ex:n ?n } }"), ElementsAre("-"));
  }
}

TEST_F(Federation, ATermOfAnAnswerIsTakenAtItsLimitAndNotOnePast) {
  const size_t limit = Limits{}.term_bytes;
  client.answers["http://one/"] = {{"n"}, {{Term::Literal(std::string(limit, 'x'))}}};
  EXPECT_THAT(*Select("SELECT ?n { SERVICE <http://one/> { ?x ex:n ?n } }"), SizeIs(1));
  client.answers["http://one/"] = {{"n"}, {{Term::Literal(std::string(limit + 1, 'x'))}}};
  EXPECT_THAT(std::string(Select("SELECT ?n { SERVICE <http://one/> { ?x ex:n ?n } }").status().message()),
              HasSubstr("term_bytes"));
}

TEST_F(Federation, AllAnswersTogetherAreBounded) {
  client.answers["http://one/"] = {{"n"}, {{Term::Literal(std::string(600, 'x'))}}};
  client.answers["http://two/"] = client.answers["http://one/"];
  Query query = graph.Parse("SELECT ?s ?n { ?s ex:at ?e SERVICE ?e { ?x ex:n ?n } }");
  PrepareOptions options;
  options.memory_bytes = 1500;
  const absl::Status status = ResolveServices(&query, &client, graph.dictionary, options, graph.Run());
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("query_memory_bytes = 1500"));
  EXPECT_THAT(client.asked, SizeIs(2));  // one was not too much
}

TEST_F(Federation, WithoutAClientNothingIsAsked) {
  Query query = graph.Parse("SELECT * { SERVICE <http://one/> { ?s ?p ?o } }");
  EXPECT_TRUE(HasService(query));
  EXPECT_EQ(ResolveServices(&query, nullptr, graph.dictionary, {}, graph.Run()).code(),
            absl::StatusCode::kPermissionDenied);
}

}  // namespace
}  // namespace docent::sparql
