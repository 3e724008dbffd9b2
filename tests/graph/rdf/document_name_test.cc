#include "graph/rdf/document_name.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "graph/rdf/term_check.h"

namespace docent {
namespace {

TEST(DocumentNameTest, WhatMayStandThereStaysAsItIs) {
  for (const char* name : {"", "place.ttl", "a-b_c.1.ttl", "2026.nt", "größe.ttl", "地図.ttl"}) {
    EXPECT_EQ(NameInIri(name), name);
    EXPECT_EQ(NameInBlankLabel(name), name);
  }
  for (const char* name : {"o/m.ttl", "a(1)+b@c.ttl", "a#b?c"}) EXPECT_EQ(NameInIri(name), name);
}

TEST(DocumentNameTest, WhatMayNotIsEscaped) {
  EXPECT_EQ(NameInIri("my data (1).ttl"), "my%20data%20(1).ttl");
  EXPECT_EQ(NameInIri("100%.ttl"), "100%25.ttl");
  EXPECT_EQ(NameInIri("a%20b.ttl"), "a%2520b.ttl") << "not what \"a b.ttl\" gives";
  EXPECT_EQ(NameInBlankLabel("data (1).ttl"), "data℅20℅281℅29.ttl");
  EXPECT_EQ(NameInBlankLabel("a℅20b.ttl"), "a℅E2℅84℅8520b.ttl") << "not what \"a b.ttl\" gives";
}

TEST(DocumentNameTest, AnyNameGivesTermsThatMayBeStored) {
  for (const char* name : {"a b", "-a", ".a", "a–b", "a+b@c%d", "o/my onto.ttl", "a\\b|c^`{}<>\"", "\x01",
                           "\xff\xfe.ttl", "ü\xfc.ttl"}) {
    const absl::Status iri =
        CheckTerm(Term::Iri("https://w3id.org/docent/ontology/" + NameInIri(name)), 1000);
    EXPECT_TRUE(iri.ok()) << iri;
    const absl::Status label = CheckTerm(Term::Blank(NameInBlankLabel(name) + "_b1"), 1000);
    EXPECT_TRUE(label.ok()) << label;
  }
}

TEST(DocumentNameTest, FilesHaveIris) {
  EXPECT_EQ(FileIri("/home/x/place.ttl"), "file:///home/x/place.ttl");
  EXPECT_EQ(FileIri("/a b/../c/100%.ttl"), "file:///c/100%25.ttl");
  EXPECT_EQ(FileIri("/größe/a#b?c[1].ttl"), "file:///größe/a%23b%3Fc%5B1%5D.ttl");
  EXPECT_EQ(FileIri("x.ttl"), FileIri(std::filesystem::current_path().string() + "/x.ttl"));
  for (const char* name : {"/a\\b|c^`{}<>\"", "/\x01", "/\xff\xfe.ttl"}) {
    EXPECT_TRUE(CheckTerm(Term::Iri(FileIri(name)), 1000).ok()) << FileIri(name);
  }
}

TEST(DocumentNameTest, TextsHaveLabelStartsOfTheirOwn) {
  EXPECT_EQ(BlankLabelStart(""), "dcbf29ce484222325_");  // as published for FNV-1a
  EXPECT_EQ(BlankLabelStart("foobar"), "d85944171f73967e8_");
  EXPECT_NE(BlankLabelStart("_:a <urn:p> 1 ."), BlankLabelStart("_:a <urn:p> 2 ."));
}

}  // namespace
}  // namespace docent
