// Random RDF/XML documents, read by our reader and by Raptor: both give the same graph. Constructs that
// Raptor 2.0.15 reads wrongly (white space in attributes, xml:lang of property attributes, bases with a
// query, a fragment or no path, XML literals with markup) or only warns of are left out.
#include <gtest/gtest.h>
#include <raptor2.h>

#include <random>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "tests/conformance/rdf/isomorphism.h"

namespace docent {
namespace {

constexpr char kBase[] = "http://base/dir/file";

class RandomDocument {
 public:
  explicit RandomDocument(uint32_t seed) : random_(seed) {}

  std::string Text() {
    std::string text = Below(2) == 0 ? "<?xml version='1.0'?>\n" : "";
    if (Below(3) == 0) text += "<!DOCTYPE rdf:RDF [<!ENTITY ns 'http://e/'> <!-- c -->]>\n", entity_ = true;
    absl::StrAppend(&text,
                    "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#' xmlns:e='http://e/' "
                    "xmlns='http://d/'",
                    Scope(), ">");
    for (size_t nodes = 1 + Below(4); nodes > 0; --nodes) text += Space() + Node(3);
    return text + Space() + "</rdf:RDF>\n";
  }

 private:
  size_t Below(size_t n) { return random_() % n; }
  std::string Space() {
    static const char* const kSpaces[] = {"", "\n  ", " ", "<!-- x -->", "<?pi x?>\n", "\t"};
    return kSpaces[Below(6)];
  }
  // Of an element without property attributes, whose language Raptor forgets.
  std::string Scope() {
    std::string out;
    if (Below(6) == 0) out += absl::StrCat(" xml:base='", Below(2) == 0 ? "http://other/a/b" : "sub/", "'");
    if (Below(6) == 0) out += Below(3) == 0 ? " xml:lang=''" : " xml:lang='en'";
    return out;
  }
  std::string Reference() {
    static const char* const kReferences[] = {"http://e/a", "http://e/b", "rel",   "../up",   "#frag",
                                              "",           "?q",         "/root", "urn:x:y", "http://e/%20"};
    if (entity_ && Below(4) == 0) return "&ns;a";
    return kReferences[Below(10)];
  }
  std::string Name() {
    static const char* const kNames[] = {"e:p", "e:q", "local", "e:r-1.x", "rdf:value"};
    return kNames[Below(5)];
  }
  std::string Value() {
    static const char* const kValues[] = {"text", "", "1", "&lt;&amp;&gt;", "&#233;", "é€𝄞", "a]b"};
    return kValues[Below(7)];
  }
  std::string NewId() { return absl::StrCat("id", ++ids_); }
  std::string Subject() {
    switch (Below(5)) {
      case 0:
        return "";
      case 1:
        return absl::StrCat(" rdf:nodeID='n", Below(3), "'");
      case 2:
        return absl::StrCat(" rdf:ID='", NewId(), "'");
      default:
        return absl::StrCat(" rdf:about='", Reference(), "'");
    }
  }
  std::string PropertyAttributes() {
    std::string out;
    if (Below(4) == 0) absl::StrAppend(&out, " e:a='", Value(), "'");
    if (Below(6) == 0) absl::StrAppend(&out, " rdf:type='", Reference(), "'");
    return out;
  }

  std::string Node(int depth) {
    const char* const kTypes[] = {"rdf:Description", "e:T", "Thing", "rdf:Seq"};
    const std::string name = kTypes[Below(4)];
    // A language in scope goes only with nodes that have no property attributes: it ends at xml:lang=''.
    std::string text = absl::StrCat("<", name, Subject());
    if (Below(2) == 0) {
      text += Scope();
    } else {
      text += " xml:lang=''" + PropertyAttributes();
    }
    if (Below(5) == 0) return text + "/>";
    text += ">";
    for (size_t properties = Below(4); properties > 0; --properties) text += Space() + Property(depth - 1);
    return absl::StrCat(text, Space(), "</", name, ">");
  }

  std::string Property(int depth) {
    const std::string name = Below(6) == 0 ? "rdf:li" : Name();
    const std::string start =
        absl::StrCat("<", name, Scope(), Below(6) == 0 ? absl::StrCat(" rdf:ID='", NewId(), "'") : "");
    const std::string end = absl::StrCat("</", name, ">");
    switch (depth <= 0 ? Below(5) : Below(9)) {
      case 0:
        return absl::StrCat(start, ">", Value(), end);
      case 1:
        return absl::StrCat(start, " rdf:datatype='", Reference(), "'>", Value(), end);
      case 2:
        return absl::StrCat(start, " rdf:resource='", Reference(), "'/>");
      case 3:
        return absl::StrCat(start, " rdf:nodeID='n", Below(3), "'></", name, ">");
      case 4:
        return absl::StrCat(start, "><![CDATA[<x>]]>", Value(), end);
      case 5:
        return absl::StrCat(start, ">", Space(), Node(depth), Space(), end);
      case 6:
        return absl::StrCat(start, " rdf:parseType='Resource'>", Property(depth - 1), Space(),
                            Property(depth - 1), end);
      case 7: {
        std::string text = start + " rdf:parseType='Collection'>";
        for (size_t nodes = Below(4); nodes > 0; --nodes) text += Space() + Node(depth - 1);
        return text + end;
      }
      default:
        return absl::StrCat(start, " rdf:parseType='Literal'>", "plain &lt; text", end);
    }
  }

  std::mt19937 random_;
  size_t ids_ = 0;
  bool entity_ = false;
};

Term FromRaptor(const raptor_term& term) {
  const auto text = [](const unsigned char* bytes) {
    return std::string(reinterpret_cast<const char*>(bytes));
  };
  if (term.type == RAPTOR_TERM_TYPE_URI) return Term::Iri(text(raptor_uri_as_string(term.value.uri)));
  if (term.type == RAPTOR_TERM_TYPE_BLANK) return Term::Blank(text(term.value.blank.string));
  const raptor_term_literal_value& literal = term.value.literal;
  if (literal.language != nullptr && *literal.language != 0)
    return Term::LangString(text(literal.string), text(literal.language));
  return Term::Literal(text(literal.string),
                       literal.datatype == nullptr ? "" : text(raptor_uri_as_string(literal.datatype)));
}

class Raptor {
 public:
  Raptor() : world_(raptor_new_world()) {
    raptor_world_set_log_handler(world_, this, [](void* self, raptor_log_message* message) {
      static_cast<Raptor*>(self)->message_ += absl::StrCat(message->text, "\n");
    });
  }
  ~Raptor() { raptor_free_world(world_); }

  std::vector<TermQuad> Read(const std::string& text) {
    std::vector<TermQuad> quads;
    message_.clear();
    raptor_parser* parser = raptor_new_parser(world_, "rdfxml");
    raptor_uri* base = raptor_new_uri(world_, reinterpret_cast<const unsigned char*>(kBase));
    raptor_parser_set_statement_handler(parser, &quads, [](void* to, raptor_statement* s) {
      static_cast<std::vector<TermQuad>*>(to)->push_back(
          {FromRaptor(*s->subject), FromRaptor(*s->predicate), FromRaptor(*s->object), {}});
    });
    raptor_parser_parse_start(parser, base);
    raptor_parser_parse_chunk(parser, reinterpret_cast<const unsigned char*>(text.data()), text.size(), 1);
    raptor_free_uri(base);
    raptor_free_parser(parser);
    return quads;
  }
  const std::string& message() const { return message_; }

 private:
  raptor_world* world_;
  std::string message_;
};

TEST(RdfXmlRaptorTest, BothReadTheSameGraph) {
  Raptor raptor;
  ParseRdfOptions options;
  options.base_iri = kBase;
  size_t triples = 0;
  for (uint32_t seed = 1; seed <= 1000; ++seed) {
    const std::string text = RandomDocument(seed).Text();
    const ParsedRdf ours = ParseRdf(text, RdfFormat::kRdfXml, options);
    const std::vector<TermQuad> theirs = raptor.Read(text);
    ASSERT_EQ(raptor.message(), "") << "seed " << seed << ":\n" << text;
    ASSERT_TRUE(ours.ok()) << "seed " << seed << ":\n" << text << Render(ours.diagnostics, text);
    const auto lines = [](const std::vector<TermQuad>& quads) {
      std::string out;
      for (const TermQuad& q : quads)
        absl::StrAppend(&out, ToNTriples(q.subject), " ", ToNTriples(q.predicate), " ", ToNTriples(q.object),
                        "\n");
      return out;
    };
    ASSERT_TRUE(Isomorphism::Holds(ours.quads, theirs)) << "seed " << seed << ":\n"
                                                        << text << "ours:\n"
                                                        << lines(ours.quads) << "Raptor's:\n"
                                                        << lines(theirs);
    triples += ours.quads.size();
  }
  EXPECT_GT(triples, 5000u);
}

}  // namespace
}  // namespace docent
