#include <cstdint>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/raptor_world.h"
#include "graph/rdf/formats/rdf_xml.h"
#include "graph/rdf/utf8.h"

namespace docent {
namespace {

// XML 1.0 section 2.2, Char: the characters that a document can hold, escaped or not.
bool IsXmlChar(char32_t c) {
  return c == '\t' || c == '\n' || c == '\r' || (c >= 0x20 && c != 0xFFFE && c != 0xFFFF);
}

class RdfXmlWriter {
 public:
  RdfXmlWriter()
      : world_([this](const raptor_log_message& message) {
          if (message.level >= RAPTOR_LOG_LEVEL_ERROR && message_.empty() && message.text != nullptr) {
            message_ = message.text;
          }
        }) {}

  absl::StatusOr<std::string> Write(const std::vector<TermQuad>& quads,
                                    const std::vector<std::pair<std::string, std::string>>& prefixes) {
    RaptorSerializer serializer(raptor_new_serializer(world_.get(), "rdfxml"));
    for (const auto& [name, iri] : prefixes) {
      RaptorUri uri(raptor_new_uri(world_.get(), Bytes(iri.c_str())));
      const unsigned char* prefix = name.empty() ? nullptr : Bytes(name.c_str());
      raptor_serializer_set_namespace(serializer.get(), uri.get(), prefix);
    }
    void* text = nullptr;
    size_t length = 0;
    RaptorStream stream(raptor_new_iostream_to_string(world_.get(), &text, &length, nullptr));
    raptor_serializer_start_to_iostream(serializer.get(), nullptr, stream.get());
    absl::Status status;
    for (const TermQuad& quad : quads) {
      status = WriteOne(serializer.get(), quad);
      if (!status.ok()) break;
    }
    raptor_serializer_serialize_end(serializer.get());
    stream.reset();  // sets text and length
    std::string out;
    if (text != nullptr) {
      out.assign(static_cast<const char*>(text), length);
      raptor_free_memory(text);
    }
    if (!status.ok()) return status;
    return out;
  }

 private:
  absl::Status WriteOne(raptor_serializer* serializer, const TermQuad& quad) {
    if (absl::Status s = CheckCharacters(quad.object.lexical); !s.ok()) return s;
    RaptorStatement statement(raptor_new_statement(world_.get()));
    statement->subject = Convert(quad.subject);
    statement->predicate = Convert(quad.predicate);
    statement->object = Convert(quad.object);
    message_.clear();
    if (raptor_serializer_serialize_statement(serializer, statement.get()) == 0 && message_.empty()) {
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError(Concat("RDF/XML can't say the predicate ", ToNTriples(quad.predicate),
                                             ": ", message_, "; use Turtle"));
  }

  static absl::Status CheckCharacters(std::string_view text) {
    for (size_t at = 0; at < text.size();) {
      char32_t c = NextCodePoint(text, &at);
      if (IsXmlChar(c)) continue;
      return absl::InvalidArgumentError(
          absl::StrFormat("XML can't hold the character U+%04X; use Turtle", static_cast<uint32_t>(c)));
    }
    return absl::OkStatus();
  }

  raptor_term* Convert(const Term& term) {
    raptor_world* world = world_.get();
    if (term.IsIri()) return raptor_new_term_from_uri_string(world, Bytes(term.lexical.c_str()));
    if (term.IsBlank()) {
      // A generated XML name: labels of RDF may begin with a digit.
      std::string& name = blanks_[term.lexical];
      if (name.empty()) name = absl::StrCat("b", blanks_.size());
      return raptor_new_term_from_blank(world, Bytes(name.c_str()));
    }
    RaptorUri datatype(term.datatype.empty() ? nullptr : raptor_new_uri(world, Bytes(term.datatype.c_str())));
    return raptor_new_term_from_literal(world, Bytes(term.lexical.c_str()), datatype.get(),
                                        term.language.empty() ? nullptr : Bytes(term.language.c_str()));
  }

  std::string message_;
  RaptorWorld world_;
  absl::flat_hash_map<std::string, std::string> blanks_;
};

}  // namespace

absl::StatusOr<std::string> WriteRdfXml(const std::vector<TermQuad>& quads,
                                        const std::vector<std::pair<std::string, std::string>>& prefixes) {
  return RdfXmlWriter().Write(quads, prefixes);
}

}  // namespace docent
