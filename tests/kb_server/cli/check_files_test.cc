// Inconsistencies that `docent check` finds: every kind of rule set owl2rl, each at an asserted fact and with
// its proof.
#include "kb_server/cli/check_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "kb_server/cli/consistency_check.h"

namespace docent::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kPrefixes[] =
    "@prefix : <http://e/> . @prefix owl: <http://www.w3.org/2002/07/owl#> . "
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: "
    "<http://www.w3.org/2001/XMLSchema#> .\n";

std::string Text(const std::vector<ontology::Finding>& findings) {
  std::string text;
  for (const ontology::Finding& f : findings) {
    if (f.diagnostic.severity == Diagnostic::Severity::kError || f.rule == "consistency") {
      absl::StrAppend(&text, f.rule, " ", Render({f.diagnostic}, ""), f.proof);
    }
  }
  return text;
}

// The errors of one document.
std::string Check(const std::string& turtle) {
  FileChecker checker;
  checker.AddRdf("f.ttl", RdfText{kPrefixes + turtle}, false);
  return Text(checker.CheckRdf("f.ttl"));
}

TEST(CheckFilesTest, DocumentsThatTakeTooMuchAreRefused) {
  CheckLimits limits;
  limits.check_memory_bytes = 2 << 20;
  FileChecker checker(limits);
  std::string text = "<u:a> <u:b> 0";
  for (int i = 0; i < 2000; ++i) absl::StrAppend(&text, ",\n", i);
  const RdfText fits{text + " ."}, larger{absl::StrCat(text, text.substr(13), " .")};
  checker.AddRdf("one.ttl", fits, false);
  EXPECT_EQ(Text(checker.CheckRdf("one.ttl")), "");
  for (const bool only_words : {false, true}) {
    const Diagnostics read = checker.AddRdf("two.ttl", larger, only_words);
    ASSERT_TRUE(HasErrors(read));
    EXPECT_THAT(read[0].message, HasSubstr("check_memory_bytes = 2097152"));
    EXPECT_GT(read[0].span.line, 1) << "where it was too much";
  }
  EXPECT_THAT(Text(checker.CheckRdf("two.ttl")), HasSubstr("check_memory_bytes"));
  EXPECT_FALSE(HasErrors(checker.AddRdf("three.ttl", {"<u:a> <u:b> 1 ."}, false)));
}

TEST(CheckFilesTest, EveryKindOfContradictionIsFound) {
  const std::pair<const char*, const char*> cases[] = {
      {"cax-dw", ":A a owl:Class ; owl:disjointWith :B . :B a owl:Class .\n:i a :A , :B ."},
      {"cax-adc",
       ":A a owl:Class . :B a owl:Class . [] a owl:AllDisjointClasses ; owl:members ( :A :B ) .\n:i a :A , "
       ":B ."},
      {"cls-com", ":A a owl:Class . :N a owl:Class ; owl:complementOf :A .\n:i a :A , :N ."},
      {"eq-diff1",
       ":p a owl:ObjectProperty , owl:FunctionalProperty .\n:i :p :j , :k . :j owl:differentFrom :k ."},
      {"dt-diff", ":p a owl:DatatypeProperty , owl:FunctionalProperty .\n:i :p 1 , 2 ."},
      {"prp-irp", ":p a owl:ObjectProperty , owl:IrreflexiveProperty .\n:i :p :i ."},
      {"prp-asyp", ":p a owl:ObjectProperty , owl:AsymmetricProperty .\n:i :p :j . :j :p :i ."},
      {"prp-pdw",
       ":p a owl:ObjectProperty ; owl:propertyDisjointWith :q . :q a owl:ObjectProperty .\n:i :p :j ; :q :j "
       "."},
      {"cls-maxc1",
       ":p a owl:ObjectProperty . :Z a owl:Class ; rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :p ; "
       "owl:maxCardinality \"0\"^^xsd:nonNegativeInteger ] .\n:i a :Z ; :p :j ."},
      {"cls-nothing2", "\n:i a owl:Nothing ."},
      {"prp-npa1",
       ":p a owl:ObjectProperty .\n[] a owl:NegativePropertyAssertion ; owl:sourceIndividual :i ; "
       "owl:assertionProperty :p ; owl:targetIndividual :j . :i :p :j ."},
  };
  for (const auto& [rule, turtle] : cases) {
    const std::string text = Check(turtle);
    EXPECT_THAT(text, HasSubstr("inconsistency f.ttl:3:")) << rule << "\n" << text;
    EXPECT_THAT(text, HasSubstr(absl::StrCat("contradict each other, by owl2rl ", rule, " "))) << text;
    EXPECT_THAT(text, HasSubstr("told in f.ttl:3:")) << rule << "\n" << text;
    EXPECT_EQ(text.find("inconsistency "), text.rfind("inconsistency "))
        << "the same facts are told once: " << text;
  }
}

TEST(CheckFilesTest, GoodDocumentsAreConsistent) {
  EXPECT_EQ(Check(":A a owl:Class ; owl:disjointWith :B . :B a owl:Class . :p a owl:ObjectProperty , "
                  "owl:FunctionalProperty .\n"
                  ":i a :A ; :p :j . :j a :B . :k a :A ; :p :j ."),
            "");
}

TEST(CheckFilesTest, WhatRulesDeriveFromOtherFilesIsLookedAt) {
  const std::string rules = "PREFIX : <http://e/>\nRULE { ?x a :Machine } WHERE { ?x a :Human }";
  FileChecker checker;
  checker.AddRdf("o.ttl",
                 RdfText{absl::StrCat(
                     kPrefixes, ":Human a owl:Class ; owl:disjointWith :Machine . :Machine a owl:Class .")},
                 false);
  checker.AddRdf("hum.ttl", RdfText{absl::StrCat(kPrefixes, ":h a :Human .")}, false);
  checker.AddRules("cls.rules", rules);
  EXPECT_EQ(Text(checker.CheckRdf("o.ttl")), "");
  EXPECT_EQ(Text(checker.CheckRules("cls.rules", rules)), "");
  const std::string text = Text(checker.CheckRdf("hum.ttl"));
  EXPECT_THAT(
      text, HasSubstr("inconsistency hum.ttl:2:6: error: the facts contradict each other, by owl2rl cax-dw"));
  EXPECT_THAT(text, HasSubstr(":h a :Machine\n  by cls.rules rule 1 (line 2), ?x = :h\n  :h a :Human\n    "
                              "told in hum.ttl:2:6\n"));
  EXPECT_THAT(text, HasSubstr("told in o.ttl:2:"));
}

TEST(CheckFilesTest, UnusedPrefixesOfRulesAndQueriesAreNamed) {
  FileChecker checker;
  const auto all_of = [](const std::vector<ontology::Finding>& findings) {
    std::string text;
    for (const ontology::Finding& f : findings)
      absl::StrAppend(&text, f.rule, " ", Render({f.diagnostic}, ""));
    return text;
  };
  EXPECT_THAT(
      all_of(checker.CheckRules(
          "f.rules", "PREFIX : <http://e/>\nPREFIX x: <http://x/>\nRULE { ?a :p 1 } WHERE { ?a :q 1 }")),
      HasSubstr("unused-prefix f.rules:2:8: warning: the prefix x: is not used"));
  EXPECT_THAT(all_of(checker.CheckQuery("f.rq", "PREFIX x: <http://x/> ASK { ?a ?b 1 }")),
              HasSubstr("unused-prefix f.rq:1:8: warning"));
  EXPECT_THAT(all_of(checker.CheckQuery("g.rq", "PREFIX x: <http://x/> ASK { ?a x:b 1 }")),
              Not(HasSubstr("unused-prefix")));
}

TEST(CheckFilesTest, ACheckAmongTheGivenRulesIsFollowed) {
  const std::string rules = "PREFIX : <http://e/>\nRULE { } WHERE { ?x :speed ?v FILTER(?v > 3) }";
  FileChecker checker;
  checker.AddRdf("d.ttl", RdfText{absl::StrCat(kPrefixes, ":r :speed 2 .\n:s :speed 4 .")}, false);
  checker.AddRules("c.rules", rules);
  const std::string text = Text(checker.CheckRdf("d.ttl"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "inconsistency d.ttl:3:11: error: the facts contradict each other, by c.rules rule 1 (line 2)"));
  EXPECT_THAT(text, Not(HasSubstr(":r :speed")));
}

TEST(CheckFilesTest, RulesThatCannotBeFollowedBesideOwl2rlAreNamed) {
  const std::string rules =
      "PREFIX : <http://e/>\nRULE { ?x a :Free } WHERE { ?x a :Robot FILTER NOT EXISTS { ?x a :Busy } "
      "}\nRULE { ?x a :Busy } WHERE { ?x a :Free }";
  const std::string alone =
      "PREFIX : <http://e/> PREFIX owl: <http://www.w3.org/2002/07/owl#>\n"
      "RULE { ?x owl:sameAs :y } WHERE { ?x a :Robot FILTER NOT EXISTS { ?x a :Busy } }";
  FileChecker checker;
  checker.AddRdf("d.ttl", RdfText{absl::StrCat(kPrefixes, ":r a :Robot ; :speed 1 .\n:s a owl:Nothing .")},
                 false);
  checker.AddRules("bad.rules", rules);
  checker.AddRules("alone.rules", alone);
  checker.AddRules("good.rules", "PREFIX : <http://e/> RULE { } WHERE { ?x :speed 1 }");
  EXPECT_THAT(Text(checker.CheckRules("alone.rules", alone)),
              HasSubstr("consistency alone.rules: warning: consistency was checked without"));
  EXPECT_THAT(Text(checker.CheckRdf("d.ttl")),
              AllOf(HasSubstr("cls-nothing2"), HasSubstr("good.rules rule 1")));
}

TEST(CheckFilesTest, TheRulesOfShapesAreLookedAt) {
  const std::string shapes =
      "@prefix sh: <http://www.w3.org/ns/shacl#> .\n:A a owl:Class ; owl:disjointWith :B . :B a owl:Class .\n"
      ":S sh:targetClass :A ; sh:rule [ sh:construct \"\"\"PREFIX : <http://e/>\n  CONSTRUCT { $this a :B "
      "}\n";
  const std::string bad = Check(shapes +
                                "  WHERE { $this :p ?p OPTIONAL { $this :q ?q } }\"\"\" ] .\n:p a "
                                "owl:ObjectProperty . :q a owl:ObjectProperty .");
  EXPECT_THAT(bad, HasSubstr("syntax f.ttl:6:23: error: a rule body cannot contain OPTIONAL"));
  const std::string words = Check(shapes +
                                  "  WHERE { $this a :Aa }\"\"\" ] .\n"
                                  ":U sh:targetClass :A ; sh:rule [ sh:construct \"PREFIX : <http://e/> "
                                  "CONSTRUCT { $this a :Aa } WHERE { }\" ] .");
  EXPECT_THAT(words, HasSubstr("undefined-term f.ttl:6:19: error: the class <http://e/Aa> is not defined"));
  EXPECT_EQ(words.find("undefined-term"), words.rfind("undefined-term")) << "a word is told once: " << words;
  const std::string facts = Check(shapes + "  WHERE { }\"\"\" ] . :i a :A .");
  EXPECT_THAT(facts, HasSubstr("inconsistency f.ttl:6:"));
  EXPECT_THAT(facts, HasSubstr(":i a :B\n  by f.ttl rule 1 (line 4), ?this = :i"));
}

TEST(CheckFilesTest, AClashIsToldOnceWithItsProof) {
  const std::string text = Check(
      ":Robot a owl:Class ; owl:disjointWith :Place . :Place a owl:Class . :isAt a owl:ObjectProperty ; "
      "rdfs:domain :Robot .\n"
      ":hall a :Place ; :isAt :yard . :yard a :Place .");
  EXPECT_THAT(text, HasSubstr("domain-clash f.ttl:3:1: error: <http://e/hall> cannot be <http://e/Robot>"));
  EXPECT_THAT(text, HasSubstr("  :hall :isAt :yard\n    told in f.ttl:3:24\n"));
  EXPECT_THAT(text, Not(HasSubstr("inconsistency")));
}

TEST(CheckFilesTest, BlankNodesOfTwoFilesAreTwo) {
  FileChecker checker;
  const std::string restriction = "a owl:Class ; rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :p ; ";
  checker.AddRdf("onto.ttl",
                 RdfText{absl::StrCat(kPrefixes, ":p a owl:ObjectProperty . :Z ", restriction,
                                      "owl:maxCardinality \"0\"^^xsd:nonNegativeInteger ] .")},
                 true);
  checker.AddRdf("more.ttl",
                 RdfText{absl::StrCat(kPrefixes, ":X ", restriction, "owl:someValuesFrom owl:Thing ] .")},
                 true);
  checker.AddRdf("d.ttl",
                 RdfText{absl::StrCat(kPrefixes, ":Y ", restriction,
                                      "owl:someValuesFrom owl:Thing ] .\n:i a :Y ; :p :i .")},
                 false);
  EXPECT_EQ(Text(checker.CheckRdf("d.ttl")), "");
}

TEST(CheckFilesTest, WhatWasNotCheckedIsSaidAtAFileThatIs) {
  std::string many = kPrefixes;
  for (int i = 0; i < 103; ++i) absl::StrAppend(&many, ":i", i, " a owl:Nothing .\n");
  FileChecker checker;
  checker.AddRdf("words.ttl", RdfText{absl::StrCat(kPrefixes, ":A a owl:Class .")}, true);
  checker.AddRdf("d.ttl", RdfText{many}, false);
  EXPECT_THAT(Text(checker.CheckRdf("d.ttl")), HasSubstr("3 more inconsistencies are reported"));
}

TEST(CheckFilesTest, OnlyTheRulesThatAnErrorNamesAreLeftOut) {
  const std::string alone =
      "PREFIX : <http://e/> PREFIX owl: <http://www.w3.org/2002/07/owl#>\n"
      "RULE { ?x owl:sameAs :y } WHERE { ?x a :Robot FILTER NOT EXISTS { ?x a :Busy } }";
  const std::string good = "PREFIX : <http://e/> RULE { } WHERE { ?x :speed 1 }";
  FileChecker checker;
  checker.AddRdf("d.ttl", RdfText{absl::StrCat(kPrefixes, ":r a :Robot ; :speed 1 .")}, false);
  checker.AddRules("data.rules", alone);
  checker.AddRules("a.rules", good);
  EXPECT_THAT(Text(checker.CheckRdf("d.ttl")), HasSubstr("a.rules rule 1"));
  EXPECT_THAT(Text(checker.CheckRules("data.rules", alone)),
              AllOf(HasSubstr("consistency was checked without"), Not(HasSubstr("batch"))));
  EXPECT_EQ(Text(checker.CheckRules("a.rules", good)), "");
}

TEST(CheckFilesTest, FactsOfFilesThatAreNotCheckedAreBackground) {
  FileChecker checker;
  checker.AddRdf("words.ttl", RdfText{absl::StrCat(kPrefixes, ":A owl:disjointWith :B .\n:i a :A , :B .")},
                 true);
  checker.AddRdf("d.ttl", RdfText{absl::StrCat(kPrefixes, ":j a :A .")}, false);
  const std::string text = Text(checker.CheckRdf("d.ttl"));
  EXPECT_THAT(text, HasSubstr("inconsistency d.ttl: error: the facts contradict each other"));
  EXPECT_THAT(text, HasSubstr("told in words.ttl:3:"));
}

// One past each limit the unchecked part is reported; at the limit nothing is.
class ConsistencyLimitsTest : public testing::Test {
 protected:
  std::string Run(const CheckLimits& limits, const std::string& turtle) {
    ConsistencyCheck check(limits, nullptr);
    LocatedRdf document = ParseLocatedRdf(kPrefixes + turtle, RdfFormat::kTurtle, {});
    check.AddDocument("f.ttl", document, true);
    std::vector<ontology::Finding> findings;
    auto results = check.Run();
    for (const ConsistencyCheck::Result& result : results["f.ttl"]) findings.push_back(result.finding);
    return Text(findings);
  }
};

TEST_F(ConsistencyLimitsTest, TooManyFacts) {
  CheckLimits limits;
  limits.check_facts = 2;
  EXPECT_THAT(Run(limits, ":a :p :b , :c , :d ."),
              HasSubstr("consistency was not checked: there are more facts than the limit check_facts = 2"));
  EXPECT_THAT(Run(limits, ":p a owl:SymmetricProperty . :a :p :b ."),
              HasSubstr("consistency was not checked: more follows than the limit check_facts = 2"));
}

TEST_F(ConsistencyLimitsTest, TooLong) {
  CheckLimits limits;
  limits.check_consistency_ms = 1;
  std::string turtle = ":p a owl:TransitiveProperty .\n";
  for (int i = 0; i < 400; ++i) absl::StrAppend(&turtle, ":n", i, " :p :n", i + 1, " .\n");
  EXPECT_THAT(Run(limits, turtle), HasSubstr("it takes longer than the limit check_consistency_ms = 1"));
}

TEST_F(ConsistencyLimitsTest, TooManyInconsistencies) {
  CheckLimits limits;
  limits.check_inconsistencies = 2;
  EXPECT_THAT(Run(limits, ":a a owl:Nothing . :b a owl:Nothing ."), Not(HasSubstr("more inconsistencies")));
  EXPECT_THAT(Run(limits, ":a a owl:Nothing . :b a owl:Nothing . :c a owl:Nothing ."),
              HasSubstr("1 more inconsistencies are reported"));
}

}  // namespace
}  // namespace docent::server
