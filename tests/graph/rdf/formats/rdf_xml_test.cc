// RDF/XML, one part of the grammar at a time. The W3C suite (tests/conformance/rdf) and Raptor
// (tests/property) test it, too.
#include "graph/rdf/formats/rdf_xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "tests/graph/rdf/formats/rdf_xml_texts.h"

namespace docent {
namespace {

using namespace rdf_xml;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::SizeIs;
using testing::UnorderedElementsAre;

TEST(RdfXmlTest, NodesAndProperties) {
  EXPECT_THAT(
      Triples(Document(
          "<e:T rdf:about='http://e/s' e:a='1'><e:p>x</e:p><e:q rdf:nodeID='n'/><e:r><e:U/></e:r></e:T>")),
      ElementsAre("<e:s> <rdf:type> <e:T>", "<e:s> <e:a> \"1\"", "<e:s> <e:p> \"x\"", "<e:s> <e:q> _:n",
                  "<e:s> <e:r> _:b1", "_:b1 <rdf:type> <e:U>"));
  EXPECT_THAT(Triples("<e:T xmlns:e='http://e/' xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#' "
                      "r:about='http://e/s'/>"),
              ElementsAre("<e:s> <rdf:type> <e:T>"))
      << "rdf:RDF may be left out around one node";
  EXPECT_THAT(Triples(Document("<rdf:Description about='http://e/s' type='http://e/T'><e:p "
                               "resource='http://e/o'/></rdf:Description>")),
              ElementsAre("<e:s> <rdf:type> <e:T>", "<e:s> <e:p> <e:o>"))
      << "section 6.1.4: some words need no prefix";
  EXPECT_THAT(
      Triples(Node("<e:p rdf:datatype='http://e/d'>1</e:p><e:p rdf:datatype='http://e/d'/><e:q></e:q>")),
      ElementsAre("<e:s> <e:p> \"1\"^^<e:d>", "<e:s> <e:p> \"\"^^<e:d>", "<e:s> <e:q> \"\""));
  EXPECT_THAT(Triples(Node("<e:p e:a='1' rdf:type='http://e/T'/><e:q rdf:resource='http://e/o' e:b='2'/>")),
              ElementsAre("<e:s> <e:p> _:b1", "_:b1 <e:a> \"1\"", "_:b1 <rdf:type> <e:T>",
                          "<e:s> <e:q> <e:o>", "<e:o> <e:b> \"2\""));
}

TEST(RdfXmlTest, ContainersCollectionsAndReification) {
  EXPECT_THAT(
      Triples(Document("<rdf:Seq rdf:about='http://e/s'><rdf:li>1</rdf:li><rdf:_7>7</rdf:_7><rdf:li "
                       "rdf:resource='http://e/o'/>"
                       "<e:p rdf:parseType='Resource'><rdf:li>1</rdf:li></e:p><rdf:li>3</rdf:li></rdf:Seq>")),
      ElementsAre("<e:s> <rdf:type> <rdf:Seq>", "<e:s> <rdf:_1> \"1\"", "<e:s> <rdf:_7> \"7\"",
                  "<e:s> <rdf:_2> <e:o>", "<e:s> <e:p> _:b1", "_:b1 <rdf:_1> \"1\"", "<e:s> <rdf:_3> \"3\""));
  EXPECT_THAT(
      Triples(Node("<e:p rdf:parseType='Collection'><rdf:Description rdf:about='http://e/a'/> <e:T/></e:p>"
                   "<e:q rdf:parseType='Collection'> </e:q>")),
      UnorderedElementsAre("<e:s> <e:p> _:b1", "_:b1 <rdf:first> <e:a>", "_:b1 <rdf:rest> _:b3",
                           "_:b2 <rdf:type> <e:T>", "_:b3 <rdf:first> _:b2", "_:b3 <rdf:rest> <rdf:nil>",
                           "<e:s> <e:q> <rdf:nil>"));
  ParseRdfOptions options;
  options.base_iri = "http://e/base";
  EXPECT_THAT(Triples(Node("<e:p rdf:ID='x'>1</e:p>"), options),
              ElementsAre("<e:s> <e:p> \"1\"", "<e:base#x> <rdf:type> <rdf:Statement>",
                          "<e:base#x> <rdf:subject> <e:s>", "<e:base#x> <rdf:predicate> <e:p>",
                          "<e:base#x> <rdf:object> \"1\""));
  for (const char* property :
       {"<e:p rdf:ID='x' rdf:resource='http://e/o'/>", "<e:p rdf:ID='x'><e:T/></e:p>", "<e:p rdf:ID='x'/>",
        "<e:p rdf:ID='x' rdf:parseType='Resource'/>", "<e:p rdf:ID='x' rdf:parseType='Literal'/>",
        "<e:p rdf:ID='x' rdf:parseType='Collection'/>"}) {
    EXPECT_THAT(Triples(Node(property), options), Contains("<e:base#x> <rdf:predicate> <e:p>")) << property;
  }
}

TEST(RdfXmlTest, WhiteSpaceOfAttributesIsKeptAsXmlSays) {
  EXPECT_THAT(
      Triples(Node("", "e:p='l1&#10;l2&#9;t  two' e:q=' lead' e:r='a\n\tb\r\nc'")),
      ElementsAre("<e:s> <e:p> \"l1\\nl2\\tt  two\"", "<e:s> <e:q> \" lead\"", "<e:s> <e:r> \"a  b c\""));
  EXPECT_THAT(Triples(Node("<e:p> a\r\n b\r</e:p><e:q>&#13;&#x41;</e:q>")),
              ElementsAre("<e:s> <e:p> \" a\\n b\\n\"", "<e:s> <e:q> \"\\rA\""));
  EXPECT_THAT(
      Triples("<!DOCTYPE a [<!ATTLIST rdf:Description e:p NMTOKENS #IMPLIED>]>" + Node("", "e:p='  a   b '")),
      ElementsAre("<e:s> <e:p> \"a b\""))
      << "what the document type declares as tokens";
}

TEST(RdfXmlTest, LanguageOfPropertyAttributesAndTexts) {
  EXPECT_THAT(
      Triples(
          Node("<e:q xml:lang='de' e:r='y' rdf:resource='http://e/b'/><e:p>x</e:p><e:p xml:lang=''>x</e:p>"
               "<e:p rdf:datatype='http://e/d'>x</e:p><e:p rdf:parseType='Literal'>x</e:p><e:p><e:T "
               "xml:lang='en' e:a='1'/></e:p>",
               "xml:lang='fr' e:p='x'")),
      ElementsAre("<e:s> <e:p> \"x\"@fr", "<e:s> <e:q> <e:b>", "<e:b> <e:r> \"y\"@de", "<e:s> <e:p> \"x\"@fr",
                  "<e:s> <e:p> \"x\"", "<e:s> <e:p> \"x\"^^<e:d>", "<e:s> <e:p> \"x\"^^<rdf:XMLLiteral>",
                  "<e:s> <e:p> _:b1", "_:b1 <rdf:type> <e:T>", "_:b1 <e:a> \"1\"@en"));
  EXPECT_THAT(Mistakes(Node("", "xml:lang='en_GB'")), HasSubstr("'en_GB' is not a language tag"));
}

TEST(RdfXmlTest, BasesFollowRfc3986) {
  struct Case {
    const char *base, *reference, *expected;
  };
  for (const Case& c :
       {Case{"http://b/d/f?x=1", "", "http://b/d/f?x=1"},
        Case{"http://b/d/f?x=1", "#f", "http://b/d/f?x=1#f"}, Case{"http://b/d/f?x=1", "g", "http://b/d/g"},
        Case{"http://b/d/f?x=1", "?y", "http://b/d/f?y"}, Case{"http://b", "g", "http://b/g"},
        Case{"http://b", "#f", "http://b#f"}, Case{"http://b", "", "http://b"},
        Case{"http://b/d#frag", "", "http://b/d"}, Case{"http://b/d#frag", "#f", "http://b/d#f"},
        Case{"http://b/c/d", "../../../g", "http://b/g"}, Case{"http://b/c/d/", "./x/../g", "http://b/c/d/g"},
        Case{"http://b/c", "//h/x/./y", "http://h/x/y"}, Case{"urn:x:y", "#f", "urn:x:y#f"},
        Case{"http://b/a/b?q=/x/y", "c", "http://b/a/c"},
        Case{"file:///a/b.owl", "#c", "file:///a/b.owl#c"}}) {
    const std::string expected = absl::StrCat("<", c.expected, "> <e:p> <", c.expected, ">");
    const std::string node = absl::StrCat("<rdf:Description rdf:about='", c.reference,
                                          "'><e:p rdf:resource='", c.reference, "'/></rdf:Description>");
    const auto e = [](const std::string& line) { return absl::StrReplaceAll(line, {{"<http://e/", "<e:"}}); };
    EXPECT_THAT(Triples(Document(node, absl::StrCat("xml:base='", c.base, "'"))), ElementsAre(e(expected)))
        << c.base << " " << c.reference;
    ParseRdfOptions options;
    options.base_iri = c.base;
    EXPECT_THAT(Triples(Document(node), options), ElementsAre(e(expected))) << c.base << " " << c.reference;
  }
  EXPECT_THAT(Triples(Document("<rdf:Description rdf:ID='s' xml:base='c/'><e:p xml:base='http://f/g' "
                               "rdf:resource='o'/><e:q rdf:resource='o'/></rdf:Description>"
                               "<rdf:Description rdf:about='t' e:r='1'/>",
                               "xml:base='http://e/b'")),
              ElementsAre("<e:c/#s> <e:p> <http://f/o>", "<e:c/#s> <e:q> <e:c/o>", "<e:t> <e:r> \"1\""))
      << "on any element, against the one around it";
  EXPECT_THAT(Mistakes(Document("<rdf:Description rdf:about='x'/>")),
              HasSubstr("2:18: error: <x> is relative and the document has no base IRI"));
  EXPECT_THAT(Mistakes(Document("<rdf:Description rdf:ID='x'/>")), HasSubstr("no base IRI"));
  EXPECT_THAT(Mistakes(Document("<e:T xml:base='x'/>")), HasSubstr("xml:base is the relative IRI <x>"));
}

std::string Literal(const std::string& content, const std::string& attributes = "") {
  const ParsedRdf parsed =
      ParseRdf(Document("<rdf:Description rdf:about='http://e/s'><e:p rdf:parseType='Literal'>" + content +
                            "</e:p></rdf:Description>",
                        attributes),
               RdfFormat::kRdfXml);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  return parsed.ok() ? parsed.quads.at(0).object.lexical : "";
}

TEST(RdfXmlTest, XmlLiteralsAreExclusiveCanonicalXml) {
  EXPECT_EQ(Literal("<b t='x&#10;y'>t</b><!--c--><?pi d?>"), "<b t=\"x&#xA;y\">t</b><!--c--><?pi d?>");
  EXPECT_EQ(Literal("a &lt; b &amp;&amp; c &gt; d <![CDATA[<x>&]]> &#13;"),
            "a &lt; b &amp;&amp; c &gt; d &lt;x&gt;&amp; &#xD;");
  EXPECT_EQ(Literal("<e:x/>"), "<e:x xmlns:e=\"http://e/\"></e:x>")
      << "of the prefixes in scope those that are used";
  EXPECT_EQ(Literal("<z b='2' a='1' e:c='3' xml:lang='en'/>"),
            "<z xmlns:e=\"http://e/\" a=\"1\" b=\"2\" e:c=\"3\" xml:lang=\"en\"></z>");
  EXPECT_EQ(Literal("<x><e:y/><e:z/></x>"),
            "<x><e:y xmlns:e=\"http://e/\"></e:y><e:z xmlns:e=\"http://e/\"></e:z></x>");
  EXPECT_EQ(Literal("<e:x><e:y e:a='1'/></e:x>"), "<e:x xmlns:e=\"http://e/\"><e:y e:a=\"1\"></e:y></e:x>")
      << "once";
  EXPECT_EQ(Literal("<x xmlns='http://d/'><y xmlns=''/><z/></x>"),
            "<x xmlns=\"http://d/\"><y xmlns=\"\"></y><z></z></x>");
  EXPECT_EQ(Literal("<x/>", "xmlns='http://d/'"), "<x xmlns=\"http://d/\"></x>");
  EXPECT_EQ(Literal("<x a='&quot;&#9;&lt;>'/>"), "<x a=\"&quot;&#x9;&lt;>\"></x>");
  EXPECT_EQ(Literal("<f:x xmlns:f='http://f/'><f:x xmlns:f='http://g/'/><f:y/></f:x>"),
            "<f:x xmlns:f=\"http://f/\"><f:x xmlns:f=\"http://g/\"></f:x><f:y></f:y></f:x>");
  EXPECT_EQ(Literal("<rdf:RDF rdf:about='x'/>"),
            "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" rdf:about=\"x\"></rdf:RDF>")
      << "is no RDF inside";
  EXPECT_THAT(Warnings(Node("<e:p rdf:parseType='Other'><b/></e:p>")), HasSubstr("is read as \"Literal\""));
}

TEST(RdfXmlTest, TextWhereNoneMayBeIsAnError) {
  EXPECT_THAT(Mistakes(Node("\n <e:p>before<rdf:Description rdf:about='http://e/b'/>after</e:p>")),
              HasSubstr("3:13: error: an element after the text 'before'"));
  EXPECT_THAT(
      Mistakes(Node("<e:p><rdf:Description rdf:about='http://e/b'/>\n  after</e:p>")),
      HasSubstr("3:3: error: the text 'after' is at a place where no text is allowed: after the node"));
  EXPECT_THAT(
      Mistakes(Node("\n stray<e:p/> more")),
      HasSubstr(
          "3:2: error: the text 'stray' is at a place where no text is allowed: between the properties"));
  EXPECT_THAT(Mistakes(Document("\n<e:T/>x")),
              HasSubstr("3:7: error: the text 'x' is at a place where no text is allowed: between nodes"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Collection'>x</e:p>")), HasSubstr("the text 'x'"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Resource'>x</e:p>")), HasSubstr("the text 'x'"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:resource='http://e/o'>x</e:p>")),
              HasSubstr("the attributes of this property give its value"));
  EXPECT_THAT(Mistakes(Node("<![CDATA[x]]>")), HasSubstr("the text 'x'"));
  EXPECT_THAT(Mistakes(Node("&#120;")), HasSubstr("the text 'x'"));
  EXPECT_THAT(
      Triples(Node("<!-- text --> <?pi text?><e:p> <e:T/>\n</e:p><e:p rdf:resource='http://e/o'> </e:p>")),
      SizeIs(3));
}

TEST(RdfXmlTest, WhatIsNoRdfXmlIsAnError) {
  EXPECT_THAT(Mistakes("<profiles version='12'><profile kind='x'><setting id='a'/></profile></profiles>"),
              AllOf(HasSubstr("1:11: error: the attribute version has no namespace"),
                    HasSubstr("is this document RDF/XML?")));
  EXPECT_THAT(Mistakes("<a><b/></a>"), HasSubstr("1:1: error: the element <a> has no namespace"));
  EXPECT_THAT(
      Mistakes(
          "<feed "
          "xmlns='http://www.w3.org/2005/Atom'>\n<title>A</title><author><name>J</name></author></feed>"),
      AllOf(HasSubstr("2:31: error: the text 'J'"), HasSubstr("no element here is of the RDF namespace")));
  EXPECT_THAT(Mistakes("<html xmlns='http://www.w3.org/1999/xhtml' lang='en'/>"),
              HasSubstr("the attribute lang has no namespace"));
  EXPECT_THAT(Mistakes(Node("<p>1</p>")), HasSubstr("the element <p> has no namespace"));
  EXPECT_THAT(Mistakes(Node("<e:p a='1'/>")), HasSubstr("the attribute a has no namespace"));
  EXPECT_THAT(Mistakes(Node("<f:p/>")), HasSubstr("prefix f on p is not defined"));
  EXPECT_THAT(Mistakes(Node("<e:p xmlns:e='rel#'/>")), HasSubstr("which is not an absolute IRI"));
  EXPECT_THAT(Mistakes(Document("<e:T rdf:about='http://e/a b'/>")), HasSubstr("not allowed in an IRI"));
  EXPECT_THAT(Triples(Node("<e:p xsi:type='x' xmlns:xsi='http://x/'/>", "xml:space='preserve' xmlfoo='1'")),
              SizeIs(2))
      << "section 6.1.2";
  EXPECT_THAT(
      Triples(Document("<e:T/>",
                       "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xsi:schemaLocation='a b'")),
      SizeIs(1));
}

TEST(RdfXmlTest, NamesThatMayNotStandThere) {
  EXPECT_THAT(Mistakes(Document("<rdf:RDF/>")), HasSubstr("rdf:RDF may not be a node element"));
  for (const char* name :
       {"ID", "about", "parseType", "resource", "nodeID", "datatype", "li", "aboutEach", "bagID"}) {
    EXPECT_THAT(Mistakes(Document(absl::StrCat("<rdf:", name, "/>"))), HasSubstr("may not be a node element"))
        << name;
  }
  for (const char* name : {"ID", "about", "parseType", "resource", "nodeID", "datatype", "RDF", "Description",
                           "aboutEachPrefix"}) {
    EXPECT_THAT(Mistakes(Node(absl::StrCat("<rdf:", name, "/>"))), HasSubstr("may not be a property element"))
        << name;
  }
  for (const char* name : {"RDF", "Description", "li", "aboutEach", "aboutEachPrefix", "bagID"}) {
    EXPECT_THAT(Mistakes(Node("", absl::StrCat("rdf:", name, "='x'"))), HasSubstr(absl::StrCat("rdf:", name)))
        << name;
  }
  EXPECT_THAT(Mistakes(Document("<e:T/>", "e:x='1'")), HasSubstr("e:x is an attribute of rdf:RDF"));
  EXPECT_THAT(Mistakes(Node("", "rdf:nodeID='x'")),
              HasSubstr("more than one of rdf:about, rdf:ID and rdf:nodeID"));
  EXPECT_THAT(Mistakes(Node("", "about='http://e/s'")), HasSubstr("rdf:about is given twice"));
  EXPECT_THAT(Mistakes(Node("", "rdf:resource='http://e/o'")), HasSubstr("did you mean rdf:about?"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:about='http://e/o'/>")), HasSubstr("did you mean rdf:resource?"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:resource='http://e/o' rdf:nodeID='n'/>")),
              HasSubstr("rdf:nodeID and rdf:resource"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:resource='http://e/o' rdf:datatype='http://e/d'/>")),
              HasSubstr("rdf:datatype"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:datatype='http://e/d'><e:T/></e:p>")),
              HasSubstr("inside of a property with rdf:datatype"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:resource='http://e/o'><e:T/></e:p>")),
              HasSubstr("that its attributes give its value"));
  EXPECT_THAT(Mistakes(Node("<e:p><e:T/><e:T/></e:p>")), HasSubstr("a second node inside of a property"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Literal' rdf:resource='http://e/o'/>")),
              HasSubstr("rdf:resource and rdf:parseType"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Resource' e:a='1'/>")), HasSubstr("e:a and rdf:parseType"));
  EXPECT_THAT(
      Mistakes(Node("<e:p rdf:datatype='http://www.w3.org/1999/02/22-rdf-syntax-ns#langString'>x</e:p>")),
      HasSubstr("langString"));
  EXPECT_THAT(Warnings(Node("<e:p rdf:resorce='x'/>")), HasSubstr("did you mean rdf:resource?"));
  EXPECT_EQ(Warnings(Node("<rdf:_12/><rdf:value/><rdf:type rdf:resource='http://e/T'/>")), "");
}

TEST(RdfXmlTest, IdsAndNodeIdsAreNames) {
  ParseRdfOptions options;
  options.base_iri = "http://e/b";
  EXPECT_THAT(Triples(Document("<e:T rdf:ID='a'/><e:T rdf:ID='b' xml:base='http://e/c'/><e:T rdf:ID='a' "
                               "xml:base='http://e/c'/>"),
                      options),
              SizeIs(3))
      << "an ID is named once against one base";
  EXPECT_THAT(Mistakes(Document("<e:T rdf:ID='a'/>\n<e:T><e:p rdf:ID='a'>1</e:p></e:T>"), options),
              HasSubstr("3:11: error: rdf:ID='a' occurs twice"));
  for (const char* odd : {"", "1a", "a:b", "a b", "-a", "a/b"}) {
    EXPECT_THAT(Mistakes(Document(absl::StrCat("<e:T rdf:ID='", odd, "'/>")), options),
                HasSubstr("which is not an XML name"))
        << odd;
    EXPECT_THAT(Mistakes(Document(absl::StrCat("<e:T rdf:nodeID='", odd, "'/>")), options),
                HasSubstr("which is not an XML name"))
        << odd;
    EXPECT_THAT(Mistakes(Node(absl::StrCat("<e:p rdf:nodeID='", odd, "'/>")), options),
                HasSubstr("which is not an XML name"))
        << odd;
  }
  const std::vector<std::string> dots =
      Triples(Document("<e:T rdf:nodeID='n.'><e:p rdf:nodeID='n.'/><e:q rdf:nodeID='m'/></e:T>"));
  EXPECT_THAT(dots, ElementsAre("_:b1 <rdf:type> <e:T>", "_:b1 <e:p> _:b1", "_:b1 <e:q> _:m"))
      << "a name that ends with a dot is no label of other syntaxes, and still one node";
}

TEST(RdfXmlTest, WhatIsOfRdf12IsNotTakenForSomethingElse) {
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Triple'/>")),
              HasSubstr("triple terms are of RDF 1.2, which is not read"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:annotation='http://e/a'>1</e:p>")),
              HasSubstr("rdf:annotation is of RDF 1.2"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:annotationNodeID='a'>1</e:p>")),
              HasSubstr("rdf:annotationNodeID is of RDF 1.2"));
  EXPECT_THAT(Mistakes(Document("", "rdf:version='1.2'")), HasSubstr("RDF 1.2 is not read"));
  EXPECT_THAT(Triples(Document("<e:T/>", "rdf:version='1.1'")), SizeIs(1));
}

TEST(RdfXmlTest, NotWellFormed) {
  EXPECT_THAT(Mistakes(Document("<e:T>\n<unclosed></e:T>")), HasSubstr("3:"));
  EXPECT_THAT(Mistakes(""), HasSubstr("error"));
  EXPECT_THAT(Mistakes("<!-- c -->"), HasSubstr("error"));
  EXPECT_THAT(Mistakes(Document("") + "<e:T/>"), HasSubstr("3:11: error: XML: Extra content"));
  EXPECT_THAT(Mistakes(Node("", "e:p='1' e:p='2'")), HasSubstr("e:p redefined"));
  EXPECT_THAT(Mistakes(Node("", "e:p='1' xmlns:f='http://e/' f:p='2'")), HasSubstr("error"));
  EXPECT_THAT(Mistakes(Node("", "e:p='<'")), HasSubstr("error"));
  EXPECT_THAT(Mistakes(Node("&#0;")), HasSubstr("error"));
  EXPECT_THAT(Mistakes("<!DOCTYPE rdf:RDF [<!ENTITY a \"a\"" + Document("")), HasSubstr("error"));
  EXPECT_THAT(Mistakes(std::string("<a>\0</a>", 8)),
              HasSubstr("1:4: error: the character U+0000 is not allowed in XML"));
  const ParsedRdf many =
      ParseRdf(Node(absl::StrCat("<e:p a='1'/>", std::string(30, ' '), "x<e:p rdf:about='x'/><p/>")),
               RdfFormat::kRdfXml);
  EXPECT_THAT(many.diagnostics, SizeIs(4))
      << "all mistakes are found at once: " << Render(many.diagnostics, "");
  std::string hundred;
  for (int i = 0; i < 100; ++i) hundred += "<p/>";
  EXPECT_THAT(ParseRdf(Node(hundred), RdfFormat::kRdfXml).diagnostics, SizeIs(Limits().document_diagnostics));
}

TEST(RdfXmlTest, PrefixesAreThoseDeclared) {
  const ParsedRdf parsed = ParseRdf(
      Node("<f:p xmlns:f='http://f/1'/><f:p xmlns:f='http://f/2' xmlns='http://d/'/>"), RdfFormat::kRdfXml);
  EXPECT_THAT(parsed.prefixes, ElementsAre(Pair("rdf", std::string(kRdfNs)), Pair("e", "http://e/"),
                                           Pair("f", "http://f/2"), Pair("", "http://d/")));
  const auto with = [](const std::string& attribute) {
    return ParseRdf(Node("", "\n" + attribute + "=\"http://f/\""), RdfFormat::kRdfXml);
  };
  EXPECT_THAT(with("xmlns:\xC3\xA9").prefixes, Contains(Pair("\xC3\xA9", "http://f/")));
  EXPECT_THAT(with("xmlns\xC3\xA9").prefixes, SizeIs(2));
  const ParsedRdf colons = with("xmlns:a:b");
  ASSERT_FALSE(colons.ok());
  EXPECT_EQ(colons.diagnostics[0].span.line, 3);
}

}  // namespace
}  // namespace docent
