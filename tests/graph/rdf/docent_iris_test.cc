#include "graph/rdf/docent_iris.h"

#include <gtest/gtest.h>

#include <set>

#include "graph/rdf/term_check.h"

namespace docent {
namespace {

TEST(DocentIris, AnyNameIsOneSegmentAndComesBack) {
  std::set<std::string> segments;
  const std::string names[] = {"BoothGuide", "Tour A",     "Tour/A",  "Tour%20A", "100 %",
                               "a#b?c",      "say \"hi\"", "Führung", "안내",     "$user",
                               "a@b",        "a:b(c)",     "%",       "%4",       "<x>{y}|^`\\",
                               "tab\there",  ".",          "..",      "\x7f",     "it's me"};
  for (const std::string& name : names) {
    const std::string segment = IriSegment(name);
    EXPECT_EQ(NameOfSegment(segment), name) << segment;
    EXPECT_TRUE(segments.insert(segment).second) << segment;
    EXPECT_EQ(segment.find_first_of("/?#$@ "), std::string::npos) << segment;
    const absl::Status term = CheckTerm(Term::Iri(OperationIri(name)), 1000);
    EXPECT_TRUE(term.ok()) << term;
    EXPECT_EQ(OperationOfIri(OperationIri(name)), name);
  }
  EXPECT_EQ(IriSegment("Tour A/B"), "Tour%20A%2FB");
  EXPECT_EQ(IriSegment("Führung"), "Führung");
  EXPECT_EQ(NameOfSegment("50%_%zz%2"), "50%_%zz%2");
}

TEST(DocentIris, NamesAreAnyTextWithoutControlCharacters) {
  for (const std::string& good :
       {std::string("Tour A/B #1 100%"), std::string("안내"), std::string(256, 'x'), std::string()})
    EXPECT_EQ(NameFault(good), std::nullopt) << good;
  EXPECT_EQ(NameFault(std::string(257, 'x')), "has 257 bytes; the limit name_bytes is 256");
  EXPECT_EQ(NameFault("a\nb"), "holds the control character U+000A");
  EXPECT_EQ(NameFault("a\u202Eb"), "holds the control character U+202E");
  EXPECT_EQ(NameFault("a\u0085b"), "holds the control character U+0085");
  EXPECT_EQ(NameFault("a\xff"), "is not UTF-8");
}

TEST(DocentIris, ADocumentIsNotNamedByWhatMeansAnotherFolderOrNothing) {
  for (const char* good : {"place.ttl", "a b (1).ttl", "robots/arm.ttl", "...", "안내", ".hidden", "a..b"})
    EXPECT_EQ(DocumentNameFault(good), std::nullopt) << good;
  for (const char* bad : {"..", ".", "a/../b", "../a", "a/."})
    EXPECT_NE(DocumentNameFault(bad).value_or("").find("stands for another folder"), std::string::npos)
        << bad;
  EXPECT_EQ(DocumentNameFault(""), "is empty");
  EXPECT_EQ(DocumentNameFault(" \n"), "is empty");
  EXPECT_EQ(DocumentNameFault("a "), "begins or ends with a blank");
  EXPECT_EQ(DocumentNameFault(std::string("a\0b", 3)), "holds the control character U+0000");
  EXPECT_EQ(DocumentNameFault(std::string(257, 'x')), "has 257 bytes; the limit name_bytes is 256");
}

TEST(DocentIris, EachKindHasItsOwn) {
  EXPECT_EQ(OperationIri("move"), "urn:docent:operation:move");
  EXPECT_EQ(ServiceIri("Guide me"), "urn:docent:service:Guide%20me");
  EXPECT_EQ(WorkflowIri("Tour"), "urn:docent:workflow:Tour");
  EXPECT_EQ(RunIri(RunId("Tour%20A-1")), "urn:docent:run:Tour%20A-1");
  EXPECT_EQ(RunOfIri("urn:docent:run:Tour%20A-1")->value(), "Tour%20A-1");
  EXPECT_FALSE(RunOfIri("urn:docent:workflow:Tour"));
  EXPECT_FALSE(OperationOfIri("urn:w:move"));
}

}  // namespace
}  // namespace docent
