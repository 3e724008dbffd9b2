#include "graph/rdf/rdf_xml.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/quad_collector.h"
#include "graph/rdf/raptor_world.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"
#include "graph/rdf/xml_entities.h"

namespace docent {
namespace {

// Stands in for a missing base, so that a relative IRI shows in what comes out.
constexpr char kNoBase[] = "x-docent-no-base:///";
constexpr char kUnnamed = '\x01';

std::string_view View(const unsigned char* text, size_t length) {
  return {reinterpret_cast<const char*>(text), length};
}

// The offset where the declared encoding of the XML declaration stands, if it is not UTF-8 (or its part
// ASCII).
std::optional<size_t> FindForeignEncoding(std::string_view text) {
  if (!text.starts_with("<?xml")) return std::nullopt;
  std::string_view declaration = text.substr(0, text.find("?>"));
  size_t at = declaration.find("encoding");
  if (at == std::string_view::npos) return std::nullopt;
  size_t open = declaration.find_first_of("\"'", at);
  if (open == std::string_view::npos) return at;
  size_t close = declaration.find(declaration[open], open + 1);
  if (close == std::string_view::npos) return at;
  std::string name = absl::AsciiStrToLower(ToAbsl(declaration.substr(open + 1, close - open - 1)));
  if (name == "utf-8" || name == "utf8" || name == "us-ascii" || name == "ascii") return std::nullopt;
  return open + 1;
}

// The end of the start tag at `at`: the offset of its '>', outside of quotes.
size_t EndOfTag(std::string_view text, size_t at) {
  for (char quote = 0; at < text.size(); ++at) {
    if (quote != 0) {
      if (text[at] == quote) quote = 0;
    } else if (text[at] == '"' || text[at] == '\'') {
      quote = text[at];
    } else if (text[at] == '>') {
      return at;
    }
  }
  return std::string_view::npos;
}

// The offset of the first element that lies inside `limit` others. Text that is no XML is left to Raptor.
std::optional<size_t> FindTooDeep(std::string_view text, int limit) {
  int depth = 0;
  for (size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    std::string_view end = ">";
    if (rest.starts_with("<!--")) {
      end = "-->";
    } else if (rest.starts_with("<![CDATA[")) {
      end = "]]>";
    } else if (rest.starts_with("<?")) {
      end = "?>";
    } else if (rest.starts_with("</")) {
      --depth;
    } else {
      if (depth >= limit) return at;
      at = EndOfTag(text, at);
      if (at == std::string_view::npos) return std::nullopt;
      if (text[at - 1] != '/') ++depth;
      continue;
    }
    at = text.find(end, at);
    if (at == std::string_view::npos) return std::nullopt;
  }
  return std::nullopt;
}

// Where and what the text is, if it is in one of the syntaxes that are kept under the same endings (.owl, .xml).
std::optional<Diagnostic> FindOtherSyntax(std::string_view text, const std::string& file) {
  const auto found = [&](size_t at, std::string message, std::string hint) {
    return Diagnostic{file, SpanAt(text, at, 1), std::move(message), std::move(hint)};
  };
  constexpr char kSaveAs[] = "save it as RDF/XML or Turtle; Protégé does so by File, Save as";
  size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  at = std::min(text.find_first_not_of(" \t\r\n", at), text.size());
  const std::string_view rest = text.substr(at);
  for (const std::string_view start : {"Prefix(", "Ontology("}) {
    if (rest.starts_with(start))
      return found(at, "this is OWL functional syntax, which is not read", kSaveAs);
  }
  for (const std::string_view start : {"Prefix:", "Ontology:"}) {
    if (rest.starts_with(start))
      return found(at, "this is OWL Manchester syntax, which is not read", kSaveAs);
  }
  const bool iri = rest.starts_with("<") &&
                   rest.substr(0, rest.find_first_of(" \t\r\n>")).find("://") != std::string_view::npos;
  if (iri || (!rest.empty() && !rest.starts_with("<"))) {
    return found(at, "this is not XML", "if it is Turtle, give the file a name that ends with .ttl");
  }
  size_t root = at;
  while (root != std::string_view::npos && (text.substr(root, 2) == "<?" || text.substr(root, 2) == "<!")) {
    if (text.substr(root, 4) == "<!--") root = text.find("-->", root);
    if (root != std::string_view::npos) root = text.find('<', root + 1);
  }
  if (root == std::string_view::npos) return std::nullopt;
  const std::string_view tag = text.substr(root, EndOfTag(text, root) - root);
  if (tag.starts_with("<Ontology") && tag.find("ontologyIRI") != std::string_view::npos) {
    return found(root, "this is OWL/XML, which is not RDF/XML and is not read", kSaveAs);
  }
  return std::nullopt;
}

// One document on its way through Raptor.
class RdfXmlReader {
 public:
  RdfXmlReader(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places)
      : text_(text),
        options_(options),
        places_(places),
        collector_(options.blank_node_scope, options.limits),
        world_([this](const raptor_log_message& message) { OnMessage(message); }) {}

  ParsedRdf Run() {
    raptor_world_set_generate_bnodeid_handler(world_.get(), this, &RdfXmlReader::NameBlank);
    RaptorParser parser(raptor_new_parser(world_.get(), "rdfxml"));
    RaptorUri base(
        raptor_new_uri(world_.get(), Bytes(options_.base_iri.empty() ? kNoBase : options_.base_iri.c_str())));
    parser_ = parser.get();
    raptor_parser_set_option(parser_, RAPTOR_OPTION_NO_NET, nullptr, 1);
    raptor_parser_set_option(parser_, RAPTOR_OPTION_NO_FILE, nullptr, 1);
    raptor_parser_set_option(parser_, RAPTOR_OPTION_LOAD_EXTERNAL_ENTITIES, nullptr, 0);
    raptor_parser_set_statement_handler(parser_, this, [](void* self, raptor_statement* statement) {
      static_cast<RdfXmlReader*>(self)->OnStatement(*statement);
    });
    raptor_parser_set_namespace_handler(parser_, this, [](void* self, raptor_namespace* ns) {
      static_cast<RdfXmlReader*>(self)->OnNamespace(ns);
    });
    int failed = raptor_parser_parse_start(parser_, base.get());
    if (failed == 0) failed = raptor_parser_parse_chunk(parser_, Bytes(text_.data()), text_.size(), 1);
    if (failed != 0 && !HasErrors(parsed_.diagnostics)) Report(nullptr, "this is not RDF/XML", "");
    parsed_.quads = collector_.TakeQuads();
    if (!parsed_.ok()) parsed_.quads.clear();
    return std::move(parsed_);
  }

 private:
  // The span of a place that Raptor names: it counts lines from 1 and columns, if it knows them, in bytes.
  SourceSpan SpanOf(const raptor_locator* locator) const {
    int line = locator == nullptr ? 0 : raptor_locator_line(const_cast<raptor_locator*>(locator));
    if (line <= 0) return SpanAt(text_, 0);
    size_t start = 0;
    for (int i = 1; i < line; ++i) {
      size_t end = text_.find('\n', start);
      if (end == std::string_view::npos) break;
      start = end + 1;
    }
    size_t length = std::min(text_.find('\n', start), text_.size()) - start;
    int column = std::max(raptor_locator_column(const_cast<raptor_locator*>(locator)), 1);
    return SpanAt(text_, start + std::min(static_cast<size_t>(column) - 1, length));
  }

  void Report(const raptor_locator* locator, std::string message, std::string hint,
              Diagnostic::Severity severity = Diagnostic::Severity::kError) {
    if (parsed_.diagnostics.size() >= options_.limits.document_diagnostics) {
      raptor_parser_parse_abort(parser_);
      return;
    }
    parsed_.diagnostics.push_back(
        {options_.file, SpanOf(locator), std::move(message), std::move(hint), severity});
  }

  void OnMessage(const raptor_log_message& message) {
    if (message.level < RAPTOR_LOG_LEVEL_WARN) return;
    std::string text(absl::StripAsciiWhitespace(message.text == nullptr ? "unknown mistake" : message.text));
    // Raptor only warns where it leaves out a part of the document (rdf:aboutEach, an unknown rdf:parseType).
    bool error = message.level >= RAPTOR_LOG_LEVEL_ERROR || text.find("skipping") != std::string::npos;
    Report(message.locator, std::move(text), "",
           error ? Diagnostic::Severity::kError : Diagnostic::Severity::kWarning);
  }

  void OnNamespace(raptor_namespace* ns) {
    const unsigned char* prefix = raptor_namespace_get_prefix(ns);
    raptor_uri* uri = raptor_namespace_get_uri(ns);
    if (uri == nullptr) return;
    size_t length = 0;
    const unsigned char* iri = raptor_uri_as_counted_string(uri, &length);
    std::string name = prefix == nullptr ? "" : reinterpret_cast<const char*>(prefix);
    // Raptor takes every attribute that begins with "xmlns" for a declaration and cuts the byte after it off. Where that
    // was half a character, what is left shows it.
    if (FindInvalidUtf8(name)) return;
    if (name.find(':') != std::string::npos) {
      Report(raptor_parser_get_locator(parser_), absl::StrCat("'xmlns:", name, "' declares no prefix"),
             "a name in XML has at most one colon");
      return;
    }
    std::erase_if(parsed_.prefixes, [&](const auto& known) { return known.first == name; });
    parsed_.prefixes.emplace_back(std::move(name), View(iri, length));
  }

  // Raptor asks for the id of each blank node. One with rdf:nodeID keeps its label, which Raptor checks
  // afterwards; another gets kUnnamed and a number, which no label can be.
  static unsigned char* NameBlank(void* self, unsigned char* label) {
    if (label != nullptr) return label;
    RdfXmlReader* reader = static_cast<RdfXmlReader*>(self);
    std::string id = absl::StrCat(std::string(1, kUnnamed), reader->unnamed_.size());
    reader->unnamed_.push_back(reader->collector_.NewBlank());
    void* copy = raptor_alloc_memory(id.size() + 1);
    std::memcpy(copy, id.c_str(), id.size() + 1);
    return static_cast<unsigned char*>(copy);
  }

  Term BlankOf(std::string_view id) {
    if (!id.starts_with(kUnnamed)) {
      Term named = collector_.NamedBlank(id);
      // One that is too long is refused as such, by CheckLength.
      if (id.size() > options_.limits.term_bytes || CheckTerm(named, options_.limits.term_bytes).ok())
        return named;
      // XML lets a name end with a dot; a label of RDF's other syntaxes cannot.
      const auto [place, fresh] = renamed_.try_emplace(std::string(id));
      if (fresh) place->second = collector_.NewBlank();
      return place->second;
    }
    size_t number = 0;
    std::from_chars(id.data() + 1, id.data() + id.size(), number);
    return number < unnamed_.size() ? unnamed_[number] : collector_.NewBlank();
  }

  void OnStatement(const raptor_statement& statement) {
    TermQuad quad;
    if (!Convert(statement.subject, &quad.subject) || !Convert(statement.predicate, &quad.predicate) ||
        !Convert(statement.object, &quad.object)) {
      return;
    }
    // Raptor lets any language tag pass, "%n" say, which the store would refuse
    absl::Status status =
        quad.object.language.empty() ? absl::OkStatus() : CheckTerm(quad.object, options_.limits.term_bytes);
    if (!status.ok()) {
      Report(raptor_parser_get_locator(parser_), std::string(status.message()), "");
      return;
    }
    if (!collector_.Add(std::move(quad))) {
      Report(raptor_parser_get_locator(parser_), collector_.Refusal(), "split the document");
      raptor_parser_parse_abort(parser_);
      return;
    }
    if (places_ == nullptr) return;
    raptor_locator* locator = raptor_parser_get_locator(parser_);
    places_->AddPlace(
        {std::max(raptor_locator_line(locator), 1), std::max(raptor_locator_column(locator), 1), 0, 0});
  }

  bool Convert(const raptor_term* from, Term* to) {
    size_t length = 0;
    switch (from->type) {
      case RAPTOR_TERM_TYPE_URI: {
        const unsigned char* iri = raptor_uri_as_counted_string(from->value.uri, &length);
        return ConvertIri(View(iri, length), to);
      }
      case RAPTOR_TERM_TYPE_BLANK:
        *to = BlankOf(View(from->value.blank.string, from->value.blank.string_len));
        return CheckLength(*to);
      case RAPTOR_TERM_TYPE_LITERAL: {
        const raptor_term_literal_value& literal = from->value.literal;
        std::string lexical(View(literal.string, literal.string_len));
        if (literal.language != nullptr && literal.language_len > 0) {
          *to =
              Term::LangString(std::move(lexical), std::string(View(literal.language, literal.language_len)));
        } else if (literal.datatype != nullptr) {
          Term datatype;
          const unsigned char* iri = raptor_uri_as_counted_string(literal.datatype, &length);
          if (!ConvertIri(View(iri, length), &datatype)) return false;
          *to = Term::Literal(std::move(lexical), std::move(datatype.lexical));
        } else {
          *to = Term::Literal(std::move(lexical));
        }
        return CheckLength(*to);
      }
      case RAPTOR_TERM_TYPE_UNKNOWN:
        break;
    }
    Report(raptor_parser_get_locator(parser_), "a term of unknown kind", "");
    return false;
  }

  bool ConvertIri(std::string_view iri, Term* to) {
    const raptor_locator* here = raptor_parser_get_locator(parser_);
    if (iri.starts_with(std::string_view(kNoBase, 17)) || !IsAbsoluteIri(iri)) {
      std::string_view relative = iri.starts_with(kNoBase) ? iri.substr(sizeof(kNoBase) - 1) : iri;
      Report(here, Concat("<", relative, "> is relative and the document has no base IRI"),
             "write the whole IRI, or give xml:base on the first element");
      return false;
    }
    if (!IsValidTermIri(iri)) {
      Report(here, Concat("<", iri, "> holds a character that is not allowed in an IRI"),
             "write it percent-encoded, a space as %20");
      return false;
    }
    *to = Term::Iri(std::string(iri));
    return CheckLength(*to);
  }

  bool CheckLength(const Term& term) {
    if (term.lexical.size() <= options_.limits.term_bytes) return true;
    Report(raptor_parser_get_locator(parser_),
           absl::StrCat("this term has ", term.lexical.size(), " bytes, the limit term_bytes is ",
                        options_.limits.term_bytes),
           "");
    return false;
  }

  std::string_view text_;
  const ParseRdfOptions& options_;
  PlaceRecorder* places_;  // may be null
  QuadCollector collector_;
  RaptorWorld world_;
  raptor_parser* parser_ = nullptr;
  std::vector<Term> unnamed_;
  std::map<std::string, Term> renamed_;  // those whose label no other syntax can write
  ParsedRdf parsed_;
};

}  // namespace

ParsedRdf ParseRdfXml(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places) {
  ParsedRdf refused;
  if (std::optional<size_t> at = FindForeignEncoding(text)) {
    refused.diagnostics.push_back({options.file, SpanAt(text, *at, 1), "only the encoding UTF-8 is read",
                                   "save the document as UTF-8 and declare that"});
    return refused;
  }
  if (std::optional<Diagnostic> other = FindOtherSyntax(text, options.file)) {
    refused.diagnostics.push_back(*std::move(other));
    return refused;
  }
  const std::optional<std::string> expanded = ExpandEntities(text, options, &refused.diagnostics);
  if (!refused.ok()) return refused;
  if (expanded) text = *expanded;
  if (std::optional<size_t> at = FindTooDeep(text, options.limits.xml_nesting)) {
    refused.diagnostics.push_back(
        {options.file, SpanAt(text, *at, 1),
         absl::StrCat("elements nested deeper than the limit xml_nesting = ", options.limits.xml_nesting),
         "give inner nodes an rdf:nodeID or rdf:about, and describe them at the top"});
    return refused;
  }
  return RdfXmlReader(text, options, places).Run();
}

}  // namespace docent
