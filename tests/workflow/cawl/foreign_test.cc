// What editors write into documents beside the language's own words: it is kept, and nothing looks at it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/base/text.h"
#include "tests/workflow/cawl/documents.h"
#include "workflow/cawl/check/check.h"
#include "workflow/rsel/parser.h"
#include "workflow/xml/xml_document.h"

namespace docent::cawl {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kLayout[] = "urn:example:layout";

// Offsets after each tag inside of the root element, its own start tag included.
void CollectGaps(const xml::Element& element, std::vector<size_t>* gaps) {
  gaps->push_back(element.start_tag.offset + element.start_tag.length);
  for (const auto& child : element.children) {
    if (child->start_tag.length != child->span.length) CollectGaps(*child, gaps);
    gaps->push_back(child->span.offset + child->span.length);
  }
}

void CollectStartTags(const xml::Element& element, std::vector<size_t>* names) {
  names->push_back(element.name_span.offset + element.name_span.length);
  for (const auto& child : element.children) CollectStartTags(*child, names);
}

std::string WithForeign(const std::string& source) {
  const xml::ParsedXml parsed = xml::ParseXml(source, "f");
  std::vector<size_t> gaps, names;
  CollectGaps(*parsed.root, &gaps);
  CollectStartTags(*parsed.root, &names);
  std::vector<std::pair<size_t, std::string>> insertions;
  size_t kind = 0;
  for (const size_t at : gaps) {
    const char* pieces[] = {"<layout:box x='1'><layout:node name='N'>text</layout:node></layout:box>",
                            "<!-- <node name=\"x\"/> -->", "<?editor name='x'?>",
                            "<box xmlns='urn:example:other'>a<flow/>b</box>"};
    insertions.emplace_back(at, pieces[kind++ % 4]);
  }
  for (const size_t at : names) insertions.emplace_back(at, " layout:name='x' layout:unheard='y'");
  const size_t root = parsed.root->name_span.offset + parsed.root->name_span.length;
  insertions.emplace_back(root, Concat(" xmlns:layout='", kLayout, "'"));
  std::stable_sort(insertions.begin(), insertions.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string out = source;
  for (const auto& [at, text] : insertions) out.insert(at, text);
  return out;
}

std::vector<std::string> Asks(const CheckReport& report) {
  std::vector<std::string> asks;
  for (const ConditionText& condition : report.conditions) asks.push_back(condition.place + condition.ask);
  return asks;
}

TEST(ForeignMarkup, AnyPlaceOfAWorkflowMayHoldIt) {
  for (const char* file :
       {"scenarios/s01_booth_guide/booth_guide.cawl.xml", "scenarios/s02_real_robot_log/s02.cawl.xml",
        "tests/golden/cawl/events/input.xml"}) {
    const std::string source = RepositoryFile(file), changed = WithForeign(source);
    const CheckReport plain = CheckDocument(source, "f", nullptr);
    const CheckReport foreign = CheckDocument(changed, "f", nullptr);
    ASSERT_TRUE(foreign.ok()) << Render(foreign.diagnostics, changed);
    EXPECT_THAT(foreign.diagnostics, SizeIs(plain.diagnostics.size())) << file;
    EXPECT_EQ(Asks(foreign), Asks(plain)) << file;
    EXPECT_EQ(foreign.document->source, changed) << "it is kept";
  }
}

TEST(ForeignMarkup, AnyPlaceOfARobotServiceMayHoldIt) {
  const std::string source = RepositoryFile("scenarios/s01_booth_guide/booth_guide.rsel.xml");
  const std::string changed = WithForeign(source);
  const rsel::ParsedRsel foreign = rsel::ParseRsel(changed, "f");
  ASSERT_TRUE(foreign.ok()) << Render(foreign.diagnostics, changed);
  EXPECT_THAT(foreign.diagnostics, IsEmpty());
  EXPECT_THAT(foreign.document->processes, SizeIs(5));
}

std::string Message(const std::string& root_attributes, const std::string& content) {
  const std::string source = Concat("<CAWL name='T' ", root_attributes, ">", content,
                                    "<flow name='F'><source name='s'/><sink name='e'/><link from='s' to='e'/>"
                                    "</flow></CAWL>");
  const CheckReport report = CheckDocument(source, "f", nullptr);
  return Render(report.diagnostics, source);
}

TEST(ForeignMarkup, UnknownElementsOfOurOwnStayErrors) {
  EXPECT_THAT(Message("", "<box/>"), HasSubstr("unknown element <box>"));
  EXPECT_THAT(Message("xmlns:ext='https://w3id.org/docent/cawl-ext#'", "<ext:box/>"),
              HasSubstr("unknown element <box>"));
  EXPECT_THAT(Message("xmlns:expo='https://w3id.org/docent/expo#'", "<expo:box/>"),
              HasSubstr("unknown element <box>"));
  EXPECT_THAT(Message("xmlns='urn:example:cawl'", "<box/>"), HasSubstr("unknown element <box>"))
      << "the root element's namespace is the document's own";
  EXPECT_THAT(Message("", "<box xmlns=''/>"), HasSubstr("unknown element <box>"));
  EXPECT_EQ(Message("xmlns:d='https://w3id.org/docentish'", "<d:box d:x='1'/>"), "");
}

TEST(ForeignMarkup, APrefixMustBeDeclared) {
  EXPECT_THAT(Message("", "<lay:box/>"), HasSubstr("prefix lay: of element <box> is not declared"));
}

TEST(ForeignMarkup, TextBesideForeignElementsIsStillAnError) {
  EXPECT_THAT(Message("xmlns:l='urn:l'", "<l:box/> text"), HasSubstr("text in <CAWL>"));
}

TEST(ForeignMarkup, InsideOfAWordItIsNoPartOfTheWord) {
  const std::string word = "<subject>?ro<l:mark xmlns:l='urn:l'>bot</l:mark>bot<!-- c --></subject>";
  const std::string source = WithNode("<condition><context><rule><constraint>" + word +
                                      "<verb>docent:isAt</verb><object>?x</object></constraint></rule>"
                                      "</context></condition>");
  const CheckReport report = CheckDocument(source, "f", nullptr);
  ASSERT_TRUE(report.ok()) << Render(report.diagnostics, source);
  EXPECT_THAT(report.conditions[0].ask, HasSubstr("?robot docent:isAt ?x"));
}

}  // namespace
}  // namespace docent::cawl
