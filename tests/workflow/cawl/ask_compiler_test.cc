#include "workflow/cawl/ask_compiler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "graph/base/workflow_limits.h"
#include "graph/sparql/syntax/parser.h"
#include "tests/workflow/cawl/documents.h"
#include "workflow/cawl/check/check.h"

namespace docent::cawl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

VariableValues Values(std::map<std::string, Term> values) {
  return [values](const std::string& name) -> std::optional<Term> {
    auto it = values.find(name);
    return it == values.end() ? std::nullopt : std::optional<Term>(it->second);
  };
}

DocumentPtr Parse(const std::string& text) {
  ParsedCawl parsed = ParseCawl(text, "");
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return parsed.document;
}

const Condition& ConditionOfNode(const Document& document, size_t node = 0) {
  return *document.flows[0].nodes[node].condition;
}

TEST(AskCompiler, PutsValuesInPlaceOfVariables) {
  DocumentPtr document = Parse(WithNode(ConditionOf(ConstraintText("c", "$robot", "docent:isAt", "?place") +
                                                    ConstraintText("d", "$user", "docent:isAt", "?place"))));
  auto asks = CompileCondition(*document, ConditionOfNode(*document),
                               Values({{"robot", Term::Iri("https://w3id.org/docent/expo#R01")}}), {});
  ASSERT_TRUE(asks.ok());
  ASSERT_THAT(*asks, SizeIs(1));
  const CompiledAsk& ask = asks->front();
  EXPECT_EQ(ask.ask,
            "PREFIX docent: <https://w3id.org/docent#>\n"
            "PREFIX expo: <https://w3id.org/docent/expo#>\n"
            "ASK {\n"
            "  expo:R01 docent:isAt ?place .\n"
            "  ?user docent:isAt ?place .\n"
            "}");
  EXPECT_THAT(ask.free_variables, ElementsAre("place", "user"));
  EXPECT_THAT(ask.unset, ElementsAre("user"));
  EXPECT_FALSE(ask.by_event());
}

TEST(AskCompiler, LiteralValuesAreEscaped) {
  DocumentPtr document = Parse(WithNode(ConditionOf(ConstraintText("c", "?x", "schema:name", "$user"))));
  auto asks = CompileCondition(*document, ConditionOfNode(*document),
                               Values({{"user", Term::Literal("a\"} ?s ?p ?o #\n")}}), {});
  ASSERT_TRUE(asks.ok());
  EXPECT_THAT(asks->front().ask, HasSubstr("?x schema:name \"a\\\"} ?s ?p ?o #\\n\" ."));
  EXPECT_TRUE(sparql::ParseQuery(asks->front().ask).ok());
}

TEST(AskCompiler, WhatCannotBeSaidIsAnError) {
  DocumentPtr document = Parse(WithNode(ConditionOf(ConstraintText("c", "?x", "$robot", "$user"))));
  auto blank =
      CompileCondition(*document, ConditionOfNode(*document), Values({{"user", Term::Blank("b")}}), {});
  EXPECT_EQ(blank.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(blank.status().message()), HasSubstr("$user is a blank node"));
  auto literal =
      CompileCondition(*document, ConditionOfNode(*document), Values({{"robot", Term::Literal("l")}}), {});
  EXPECT_THAT(std::string(literal.status().message()), HasSubstr("cannot be a verb"));
}

TEST(AskCompiler, NegatedVariablesAreNotBound) {
  DocumentPtr document =
      Parse(WithNode(ConditionOf(ConstraintText("a", "?r", "docent:isAt", "?p") +
                                     ConstraintText("b", "?r", "docent:currentCommand", "?c"),
                                 "a and not b")));
  auto asks = CompileCondition(*document, ConditionOfNode(*document), Values({}), {});
  ASSERT_TRUE(asks.ok());
  EXPECT_THAT(asks->front().free_variables, ElementsAre("r", "p"));
}

TEST(AskCompiler, ContextsAreTriedByPriorityThenOrderAndCasesLast) {
  auto context = [](const std::string& name, const std::string& priority) {
    return "<context name=\"" + name + "\" priority=\"" + priority + "\"><rule>" +
           ConstraintText("c", "?r", "docent:isAt", "?p") + "</rule></context>";
  };
  DocumentPtr document =
      Parse(WithNode("<condition><case name=\"E\"><event operation=\"bell\"/></case>" + context("B", "2") +
                     context("A", "1") + context("B2", "2") + "</condition>"));
  auto asks = CompileCondition(*document, ConditionOfNode(*document), Values({}), {});
  ASSERT_TRUE(asks.ok());
  ASSERT_THAT(*asks, SizeIs(4));
  EXPECT_EQ((*asks)[0].name, "A");
  EXPECT_EQ((*asks)[1].name, "B");
  EXPECT_EQ((*asks)[2].name, "B2");
  EXPECT_EQ((*asks)[3].name, "E");
  EXPECT_THAT((*asks)[3].event_variables, ElementsAre("_event_1"));
  EXPECT_THAT((*asks)[3].free_variables, IsEmpty());
}

TEST(AskCompiler, AConditionWithoutChildrenHoldsAtOnce) {
  DocumentPtr document = Parse(WithNode("<condition/>"));
  auto asks = CompileCondition(*document, ConditionOfNode(*document), Values({}), {});
  ASSERT_TRUE(asks.ok());
  EXPECT_THAT(*asks, IsEmpty());
}

TEST(AskCompiler, AlternativesAreLimited) {
  auto document_of = [](int pairs) {
    std::string constraints, expression;
    for (int i = 0; i < 2 * pairs; ++i) {
      constraints += ConstraintText("c" + std::to_string(i), "?r", "docent:x", std::to_string(i));
      expression += i == 0       ? "(c0"
                    : i % 2 == 1 ? " or c" + std::to_string(i) + ")"
                                 : " and (c" + std::to_string(i);
    }
    return Parse(WithNode(ConditionOf(constraints, expression)));
  };
  DocumentPtr fits = document_of(8), over = document_of(9);  // 2^8 = 256
  EXPECT_TRUE(CompileCondition(*fits, ConditionOfNode(*fits), Values({}), {}).ok());
  auto refused = CompileCondition(*over, ConditionOfNode(*over), Values({}), {});
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("more than 256 alternatives"));
}

// `names` of constraints, each "?r docent:x NUMBER"; all must hold.
DocumentPtr DocumentOfConstraints(int count) {
  std::string constraints;
  for (int i = 0; i < count; ++i) constraints += ConstraintText("", "?r", "docent:x", std::to_string(i));
  return Parse(WithNode(ConditionOf(constraints)));
}

TEST(AskCompiler, PartsOfAllAlternativesAreLimited) {
  constexpr int kMost = kWorkflowLimits.condition_parts;
  const DocumentPtr fits = DocumentOfConstraints(kMost), over = DocumentOfConstraints(kMost + 1);
  EXPECT_TRUE(CompileCondition(*fits, ConditionOfNode(*fits), Values({}), {}).ok());
  const auto refused = CompileCondition(*over, ConditionOfNode(*over), Values({}), {});
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("the limit condition_parts is 10000"));
}

TEST(AskCompiler, TheTextIsLimited) {
  const DocumentPtr document = DocumentOfConstraints(40);
  Limits limits;
  limits.query_text_bytes =
      CompileCondition(*document, ConditionOfNode(*document), Values({}), {})->front().ask.size();
  EXPECT_TRUE(CompileCondition(*document, ConditionOfNode(*document), Values({}), limits).ok());
  limits.query_text_bytes /= 2;
  const auto refused = CompileCondition(*document, ConditionOfNode(*document), Values({}), limits);
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("the limit query_text_bytes is"));
}

TEST(AskCompiler, ALongValueInManyPlacesDoesNotGrowBeyondTheLimit) {
  std::string constraints;
  for (int i = 0; i < 1000; ++i)
    constraints += ConstraintText("", "?r", "docent:x" + std::to_string(i), "$user");
  const DocumentPtr document = Parse(WithNode(ConditionOf(constraints)));
  const auto refused = CompileCondition(*document, ConditionOfNode(*document),
                                        Values({{"user", Term::Literal(std::string(600'000, 'x'))}}), {});
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("the limit query_text_bytes is"));
}

TEST(AskCompiler, WhatSparqlDoesNotTakeIsRefusedBeforeItIsArmed) {
  const std::string constraint = ConstraintText("c", "?r", "docent:isAt", "expo:B01");
  const DocumentPtr document =
      Parse(WithNode(ConditionOf(constraint, "not (c and not (c and not (c and not c)))")));
  auto asks = CompileCondition(*document, ConditionOfNode(*document), Values({}), {});
  ASSERT_TRUE(asks.ok()) << asks.status();
  Limits limits;
  limits.query_nesting = 3;
  const absl::Status refused = ParseAsks(limits, &asks->front());
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("the limit query_nesting"));
  EXPECT_EQ(asks->front().query, nullptr);
  EXPECT_TRUE(ParseAsks({}, &asks->front()).ok());
  EXPECT_NE(asks->front().query, nullptr);
}

TEST(AskCompiler, KeyVariablesAreTheActivatorsOwn) {
  auto with = [](const std::string& variables) {
    return Parse("<CAWL name=\"T\"><activator>" + variables + "<activate flow=\"F\"/>" +
                 ConditionOf(ConstraintText("c", "?user", "docent:isAt", "?place")) +
                 "</activator><flow name=\"F\"><source name=\"s\"/><sink name=\"e\"/><link from=\"s\" "
                 "to=\"e\"/></flow></CAWL>");
  };
  for (const auto& [variables, keys] : std::map<std::string, std::vector<std::string>>{
           {"", {"user", "place"}},
           {"<variable name=\"user\"/>", {"user"}},
           {"<variable name=\"greeting\"/>", {"user", "place"}}}) {
    DocumentPtr document = with(variables);
    auto asks = CompileCondition(*document, document->activator->condition, Values({}), {});
    ASSERT_TRUE(asks.ok());
    EXPECT_EQ(KeyVariables(*document->activator, asks->front()), keys);
  }
}

// All ASKs compiled from the golden documents are valid SPARQL.
TEST(AskCompiler, WhatItWritesParses) {
  int parsed = 0;
  for (const char* name : {"expressions_good", "events", "extensions", "messages_good"}) {
    std::string path = std::string("tests/golden/cawl/") + name + "/input.xml";
    CheckReport report = CheckDocument(RepositoryFile(path), path, nullptr);
    ASSERT_TRUE(report.ok()) << path;
    for (const ConditionText& condition : report.conditions) {
      sparql::ParsedQuery query = sparql::ParseQuery(condition.ask);
      EXPECT_TRUE(query.ok()) << condition.ask << "\n" << Render(query.diagnostics, condition.ask);
      EXPECT_TRUE(query.query.form == sparql::Query::Form::kAsk);
      ++parsed;
    }
  }
  EXPECT_GT(parsed, 8);
}

}  // namespace
}  // namespace docent::cawl
