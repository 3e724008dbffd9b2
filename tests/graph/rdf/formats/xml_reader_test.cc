// XML as RDF/XML uses it: entities, encodings, limits, ends.
#include "graph/rdf/formats/xml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/graph/rdf/formats/rdf_xml_texts.h"

namespace docent {
namespace {

using namespace rdf_xml;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(XmlReaderTest, EntitiesAndDeclarationsOfTheDocumentType) {
  const auto with = [](const std::string& declarations, const std::string& text) {
    return "<?xml version='1.0'?>\n<!-- c --><!DOCTYPE rdf:RDF [" + declarations + "]>\n" + text;
  };
  EXPECT_THAT(
      Triples(with(
          "<!-- c --><!ENTITY base 'http://e/bfo'>\n<!ENTITY snap \"&base;/snap#\" ><!ENTITY base 'second'>",
          Document("<rdf:Description rdf:about='&snap;X'><e:p>&base;&lt;&#65;</e:p></rdf:Description>"))),
      ElementsAre("<e:bfo/snap#X> <e:p> \"http://e/bfo<A\""));
  EXPECT_THAT(
      Triples(with("<!ENTITY nbsp '&#160;'><!ENTITY lt2 '&#38;#60;'>", Node("<e:p>a&nbsp;b&lt2;</e:p>"))),
      ElementsAre("<e:s> <e:p> \"a\u00A0b<\""));
  EXPECT_THAT(Triples(with("<!ENTITY p '<e:p>1</e:p>'>", Node("&p;&p;<e:q>&lt;</e:q>"))),
              ElementsAre("<e:s> <e:p> \"1\"", "<e:s> <e:p> \"1\"", "<e:s> <e:q> \"<\""))
      << "with markup";
  EXPECT_THAT(
      Triples(
          with("<!ELEMENT rdf:RDF ANY><!ELEMENT e:p (#PCDATA|e:q)*><!NOTATION gif PUBLIC 'x'><?pi x?>"
               "<!ATTLIST e:p xml:lang CDATA 'de' rdf:ID ID #IMPLIED><!ENTITY pic SYSTEM 'x.gif' NDATA gif>",
               Node("<e:p>x</e:p><e:p xml:lang='fr'>x</e:p>"))),
      ElementsAre("<e:s> <e:p> \"x\"@de", "<e:s> <e:p> \"x\"@fr"))
      << "the default of an attribute counts where it is left out, XML 1.0 section 3.3.2";
  EXPECT_THAT(Triples(with("<!ENTITY % more '<!ENTITY c \"C\">'> %more; <!ENTITY % far SYSTEM 'http://e/x'> "
                           "%far; <!ENTITY d 'D'>",
                           Node("<e:p>&c;&d;</e:p>"))),
              ElementsAre("<e:s> <e:p> \"CD\""));
}

TEST(XmlReaderTest, NothingIsFetched) {
  const std::string text = Node("<e:p>1</e:p>");
  for (const char* external :
       {"SYSTEM 'file:///etc/passwd'", "PUBLIC '-//DC//DTD' 'http://127.0.0.1:1/x.dtd'"}) {
    EXPECT_THAT(Triples(absl::StrCat("<!DOCTYPE rdf:RDF ", external, ">", text)), SizeIs(1))
        << "it is not needed";
    EXPECT_THAT(Triples(absl::StrCat("<!DOCTYPE rdf:RDF ", external, " [<!ENTITY a 'b'>]>", text)),
                SizeIs(1));
    EXPECT_THAT(
        Mistakes(absl::StrCat("<!DOCTYPE rdf:RDF ", external, ">\n", Node("<e:p>&x;</e:p>"))),
        AllOf(HasSubstr("3:47: error: the entity &x; is not declared"), HasSubstr("the external subset <")));
    EXPECT_THAT(Triples(absl::StrCat("<!DOCTYPE rdf:RDF [<!ENTITY x ", external, ">]>", text)), SizeIs(1));
    EXPECT_THAT(
        Mistakes(absl::StrCat("<!DOCTYPE rdf:RDF [<!ENTITY x ", external, ">]>", Node("<e:p>&x;</e:p>"))),
        HasSubstr("its text lies in another file, and nothing is fetched"));
    EXPECT_FALSE(
        ParseRdf(absl::StrCat("<!DOCTYPE rdf:RDF [<!ENTITY x ", external, ">]>", Node("", "e:p='&x;'")),
                 RdfFormat::kRdfXml)
            .ok());
  }
  EXPECT_THAT(Mistakes(Node("<e:p>&nbsp;</e:p>")), HasSubstr("the entity &nbsp; is not declared"));
}

TEST(XmlReaderTest, EntitiesGrowToTheirLimitsAndNoFurther) {
  const auto doubled = [](int levels, const std::string& first) {
    std::string text = "<!DOCTYPE rdf:RDF [<!ENTITY e0 '" + first + "'>";
    for (int i = 1; i <= levels; ++i)
      absl::StrAppend(&text, "<!ENTITY e", i, " '&e", i - 1, ";&e", i - 1, ";'>");
    return text + "]>";
  };
  ParseRdfOptions options;
  EXPECT_THAT(
      Triples(doubled(options.document_limits.xml_entity_nesting - 1, "x") +
              Node(absl::StrCat("<e:p>&e", options.document_limits.xml_entity_nesting - 1, ";</e:p>"))),
      SizeIs(1));
  const std::string last = absl::StrCat("&e", options.document_limits.xml_entity_nesting, ";");
  EXPECT_THAT(
      Mistakes(doubled(options.document_limits.xml_entity_nesting, "x") + Node("<e:p>" + last + "</e:p>")),
      HasSubstr("deeper than the limit xml_entity_nesting = 16"));
  EXPECT_THAT(
      Mistakes(doubled(options.document_limits.xml_entity_nesting, "x") + Node("", "e:p='" + last + "'")),
      HasSubstr("xml_entity_nesting"));
  for (const char* loop : {"<!ENTITY a '&b;'><!ENTITY b '&a;'>", "<!ENTITY a '&a;'>"}) {
    EXPECT_THAT(Mistakes(absl::StrCat("<!DOCTYPE rdf:RDF [", loop, "]>", Node("<e:p>&a;</e:p>"))),
                HasSubstr("or itself"));
    EXPECT_THAT(Mistakes(absl::StrCat("<!DOCTYPE rdf:RDF [", loop, "]>", Node("", "e:p='&a;'"))),
                HasSubstr("or itself"));
  }
  for (const char* first : {"ha", "", "<e:p/>"}) {
    EXPECT_THAT(Mistakes(absl::StrReplaceAll(doubled(12, first), {{";&", ";&e0;&e0;&e0;&e0;&"}}) +
                         Node(absl::StrCat(*first == '<' ? "" : "<e:p>",
                                           "&e12;&e12;&e12;&e12;&e12;&e12;&e12;&e12;&e12;&e12;&e12;&e12;",
                                           *first == '<' ? "" : "</e:p>"))),
                HasSubstr("xml_entity_growth = 100"))
        << first;
  }
  std::string many = "<!DOCTYPE rdf:RDF [<!ENTITY e \"" + std::string(1000, 'a') + "\">]>", uses;
  for (int i = 0; i < 500; ++i) uses += "&e;";
  many += Node("<e:p>" + uses + "</e:p>");
  options.limits.document_bytes = 500 * 1000;
  EXPECT_TRUE(ParseRdf(many, RdfFormat::kRdfXml, options).ok());
  options.limits.document_bytes -= 1;
  EXPECT_THAT(Mistakes(many, options), HasSubstr("document_bytes allow"));
}

TEST(XmlReaderTest, LimitsAtAndOnePast) {
  ParseRdfOptions options;
  options.document_limits.rdf_xml_nesting = 4;
  EXPECT_THAT(Triples(Node("<e:p><e:T/></e:p>"), options), SizeIs(2));
  EXPECT_THAT(Mistakes(Node("<e:p><e:T><e:q/></e:T></e:p>"), options), HasSubstr("rdf_xml_nesting = 4"));
  options = {};
  options.document_limits.xml_attributes = 4;  // about, and two declarations in scope
  EXPECT_THAT(Triples(Node("", "e:a='1' e:b='2' e:c=\"3\""), options), SizeIs(3));
  EXPECT_THAT(Mistakes(Node("", "e:a='1' e:b='2' e:c='3' e:d='4'"), options),
              HasSubstr("xml_attributes = 4"));
  EXPECT_THAT(Triples(Node("<e:p xmlns:f='http://f/'/>", "xmlns:g='http://g/'"), options), SizeIs(1));
  EXPECT_THAT(
      Mistakes(Node("<e:p xmlns:f='http://f/' xmlns:h='http://h/'/>", "xmlns:g='http://g/'"), options),
      HasSubstr("more prefixes are in scope"));
  EXPECT_THAT(
      Mistakes("<!DOCTYPE a [<!ENTITY e \"<e:p e:a='1' e:b='2' e:c='3' e:d='4' e:f='5'/>\">]>" + Node("&e;"),
               options),
      HasSubstr("xml_attributes = 4"));
  EXPECT_THAT(Mistakes("<!DOCTYPE a [<!ATTLIST e:p e:a CDATA '1' e:b CDATA '1' e:c CDATA '1'><!ATTLIST e:p "
                       "e:d CDATA '1' e:f CDATA '1'>]>" +
                           Node("<e:p/>"),
                       options),
              HasSubstr("xml_attributes = 4"));
  options = {};
  options.document_limits.xml_declarations = 2;
  EXPECT_TRUE(ParseRdf("<!DOCTYPE a [<!ENTITY a '1'><!ATTLIST e:p e:a CDATA '1'>]>" + Node(""),
                       RdfFormat::kRdfXml, options)
                  .ok());
  EXPECT_THAT(Mistakes("<!DOCTYPE a [<!ENTITY a '1'><!ENTITY b '1'><!ENTITY c '1'>]>" + Node(""), options),
              HasSubstr("xml_declarations = 2"));
  options = {};
  options.limits.term_bytes = 60;
  const std::string sixty(60, 'x');
  EXPECT_THAT(Triples(Node("<e:p>" + sixty + "</e:p>", "e:q='" + sixty + "'"), options), SizeIs(2));
  EXPECT_THAT(Mistakes(Node("<e:p>" + sixty + "x</e:p>"), options), HasSubstr("term_bytes = 60"));
  EXPECT_THAT(Mistakes(Node("", "e:q='x" + sixty + "'"), options), HasSubstr("term_bytes is 60"));
  EXPECT_THAT(Mistakes(Node("<e:p rdf:parseType='Literal'><b>" + sixty + "</b></e:p><e:p>1</e:p>"), options),
              HasSubstr("term_bytes = 60"));
  EXPECT_THAT(Mistakes(Document("<e:T/>", "xml:base='http://" + sixty + "'"), options),
              HasSubstr("term_bytes is 60"));
  options = {};
  options.limits.document_bytes = Node("").size();
  EXPECT_TRUE(ParseRdf(Node(""), RdfFormat::kRdfXml, options).ok());
  EXPECT_THAT(Mistakes(Node(" "), options), HasSubstr("document_bytes is"));
}

TEST(XmlReaderTest, LongNamesUnderLongBasesDoNotGrowWithoutEnd) {
  ParseRdfOptions options;
  options.limits.document_bytes = 100000;  // 1.6 MB of terms
  const std::string base = "xml:base='http://e/" + std::string(10000, 'b') + "/'";
  std::string nodes, ids;
  for (int i = 0; i < 1000; ++i) {
    absl::StrAppend(&nodes, "<rdf:Description rdf:about='x", i, "' e:a='1'/>");
    absl::StrAppend(&ids, "<rdf:Description rdf:ID='x", i, "'/>");
  }
  EXPECT_THAT(Mistakes(Document(nodes, base), options),
              HasSubstr("16 for each byte of the limit document_bytes"));
  EXPECT_THAT(Mistakes(Document(ids, base), options),
              HasSubstr("16 for each byte of the limit document_bytes"));
  std::string nested, end;
  for (int i = 0; i < 100; ++i) {
    nested += "<e:T xml:base='c/'><e:p>";
    end += "</e:p></e:T>";
  }
  EXPECT_THAT(Mistakes(Document(nested + end, base), options), HasSubstr("xml:base has"));
}

TEST(XmlReaderTest, LargeDocumentsAreReadAndPartsOfThem) {
  std::string nodes;
  for (int i = 0; nodes.size() < (11u << 20); ++i) {
    absl::StrAppend(&nodes, "<rdf:Description rdf:about=\"urn:x", i, "\"><e:p>some text of a large document",
                    std::string(800, '-'), "</e:p></rdf:Description>\n");
  }
  EXPECT_TRUE(ParseRdf(Document(nodes), RdfFormat::kRdfXml).ok())
      << "above the 10 MB that libxml2 takes by itself";
  ParseRdfOptions options;
  options.limits.term_bytes = 30u << 20;
  const std::string text(11u << 20, 'x');
  EXPECT_THAT(
      ParseRdf(Node("<e:p>" + text + "</e:p>", "e:q='" + text + "'"), RdfFormat::kRdfXml, options).quads,
      SizeIs(2));
}

std::string Utf16(std::string_view ascii, bool big, bool mark) {
  std::string out = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : ascii) {
    if (big) out += '\0';
    out += c;
    if (!big) out += '\0';
  }
  return out;
}

TEST(XmlReaderTest, Encodings) {
  const std::string text = "<?xml version='1.0' encoding='UTF-16'?>" + Node("<e:p>x</e:p>");
  for (const bool big : {false, true}) {
    for (const bool mark : {false, true})
      EXPECT_THAT(Triples(Utf16(text, big, mark)), SizeIs(1)) << big << mark;
  }
  std::string pair = Utf16(Node("<e:p>"), false, true);
  pair.resize(pair.find(std::string("<\0/\0", 4)));  // before the end of the property
  const std::string face("\x3D\xD8\x00\xDE", 4),
      end = Utf16("</e:p></rdf:Description></rdf:RDF>", false, false);
  EXPECT_THAT(Triples(pair.substr(0, pair.rfind(std::string("<\0e\0:\0p\0>\0", 10)) + 10) + face + end),
              SizeIs(1));
  EXPECT_THAT(Mistakes(Utf16(text, false, true) + "x"), HasSubstr("ends within a character"));
  EXPECT_THAT(Mistakes(Utf16(text, false, true) + std::string("\x00\xDC", 2)),
              HasSubstr("surrogate pair, 0xDC00"));
  EXPECT_THAT(Triples("\xEF\xBB\xBF" + Node("<e:p>\xC3\xA9</e:p>")), ElementsAre("<e:s> <e:p> \"\xC3\xA9\""));
  const std::string latin = Node("<e:p>\xE9</e:p>");
  EXPECT_THAT(Triples("<?xml version='1.0' encoding=\"ISO-8859-1\"?>" + latin),
              ElementsAre("<e:s> <e:p> \"\xC3\xA9\""));
  EXPECT_THAT(Triples("<?xml version='1.0' encoding='iso-8859-15'?>" + Node("<e:p>\xA4</e:p>")),
              ElementsAre("<e:s> <e:p> \"€\""));
  EXPECT_THAT(Triples("<?xml version='1.0' encoding='windows-1252'?>" + Node("<e:p>\x80</e:p>")),
              ElementsAre("<e:s> <e:p> \"€\""));
  EXPECT_THAT(Mistakes("<?xml version='1.0' encoding='windows-1252'?>\n" + Node("<e:p>\x81</e:p>")),
              HasSubstr("3:47: error: the byte 0x81 here is not a character of windows-1252"));
  EXPECT_THAT(Mistakes(latin), HasSubstr("the byte 0xE9 here is not UTF-8"));
  EXPECT_THAT(Mistakes("<?xml version='1.0' encoding='UTF-7'?>" + Node("")),
              HasSubstr("1:31: error: the encoding \"utf-7\" is not read"));
  EXPECT_THAT(Mistakes("<?xml version='1.0' encoding='UTF-16'?>" + Node("")),
              HasSubstr("says that it is in utf-16, and is not"));
  EXPECT_THAT(Mistakes(std::string("\xFF\xFE\0\0<\0\0\0", 8)), HasSubstr("UTF-32"));
  ParseRdfOptions options;
  options.charset = "ISO-8859-1";
  EXPECT_THAT(Triples(latin, options), SizeIs(1)) << "what the transport says";
  options.charset = "utf-8";
  EXPECT_THAT(Triples("<?xml version='1.0' encoding='UTF-16'?>" + Node("<e:p>x</e:p>"), options), SizeIs(1));
}

TEST(XmlReaderTest, TheTimeLimitAndACallerWhoLeavesEndIt) {
  std::string nodes;
  for (int i = 0; i < 200000; ++i) nodes += "<e:T/>";
  Cancellation cancelled, late(std::chrono::milliseconds(1));
  cancelled.Cancel();
  ParseRdfOptions options;
  options.cancellation = &cancelled;
  EXPECT_EQ(ParseRdf(Document(nodes), RdfFormat::kRdfXml, options).stopped.code(),
            absl::StatusCode::kCancelled);
  options.cancellation = &late;
  const ParsedRdf parsed = ParseRdf(Document(nodes), RdfFormat::kRdfXml, options);
  EXPECT_EQ(parsed.stopped.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_FALSE(parsed.ok());
  EXPECT_THAT(parsed.quads, IsEmpty());
  EXPECT_THAT(parsed.diagnostics, IsEmpty()) << Render(parsed.diagnostics, "");
}

}  // namespace
}  // namespace docent
