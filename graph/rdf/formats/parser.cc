#include "graph/rdf/formats/parser.h"

#include <array>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/gzip.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/line_parser.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/rdf/formats/place_recorder.h"
#include "graph/rdf/formats/rdf_xml.h"
#include "graph/rdf/formats/turtle_parser.h"
#include "graph/rdf/formats/xml_encoding.h"
#include "graph/rdf/utf8.h"

namespace docent {
namespace {

struct FormatName {
  std::string_view text;
  RdfFormat format;
};

constexpr std::array<FormatName, 7> kEndings = {{{".ttl", RdfFormat::kTurtle},
                                                 {".trig", RdfFormat::kTriG},
                                                 {".nt", RdfFormat::kNTriples},
                                                 {".nq", RdfFormat::kNQuads},
                                                 {".rdf", RdfFormat::kRdfXml},
                                                 {".owl", RdfFormat::kRdfXml},
                                                 {".xml", RdfFormat::kRdfXml}}};

constexpr std::array<FormatName, 9> kMediaTypes = {{{"text/turtle", RdfFormat::kTurtle},
                                                    {"application/x-turtle", RdfFormat::kTurtle},
                                                    {"application/trig", RdfFormat::kTriG},
                                                    {"application/n-triples", RdfFormat::kNTriples},
                                                    {"text/plain", RdfFormat::kNTriples},
                                                    {"application/n-quads", RdfFormat::kNQuads},
                                                    {"application/rdf+xml", RdfFormat::kRdfXml},
                                                    {"application/xml", RdfFormat::kRdfXml},
                                                    {"text/xml", RdfFormat::kRdfXml}}};

constexpr char kEndingsRead[] =
    "Turtle (.ttl), TriG (.trig), N-Triples (.nt), N-Quads (.nq) and RDF/XML (.rdf, .owl, .xml) are";
constexpr char kTypesRead[] =
    "text/turtle, application/trig, application/n-triples, application/n-quads and application/rdf+xml are";

// Formats of RDF that Docent does not read.
struct OtherFormat {
  std::string_view ending, media_type, name;
};
constexpr std::array<OtherFormat, 8> kOtherFormats = {{{".jsonld", "application/ld+json", "JSON-LD"},
                                                       {".json", "application/json", "JSON or JSON-LD"},
                                                       {".n3", "text/n3", "Notation3"},
                                                       {".n3", "text/rdf+n3", "Notation3"},
                                                       {".rj", "application/rdf+json", "RDF/JSON"},
                                                       {".trix", "application/trix", "TriX"},
                                                       {".html", "text/html", "HTML"},
                                                       {".hdt", "application/vnd.hdt", "HDT"}}};

ParsedRdf Mistake(std::string_view text, const ParseRdfOptions& options, size_t offset, std::string message,
                  std::string hint) {
  ParsedRdf parsed;
  SourceSpan span = SpanAt(text, offset, offset < text.size() ? 1 : 0);
  parsed.diagnostics.push_back({options.file, span, std::move(message), std::move(hint)});
  return parsed;
}

// The document in UTF-8.
struct SourceText {
  std::string_view text;
  std::string decoded;  // owns the text of `text` if it was in another encoding
};

// Checks made before a parser sees the text; removes a byte order mark, which is not part of the text.
std::optional<ParsedRdf> Refused(SourceText* document, RdfFormat format, const ParseRdfOptions& options) {
  std::string_view& text = document->text;
  if (text.size() > options.limits.document_bytes) {
    return Mistake({}, options, 0,
                   absl::StrCat("the document has ", text.size(), " bytes, the limit document_bytes is ",
                                options.limits.document_bytes),
                   "load it in parts");
  }
  if (IsGzip(text)) {
    return Mistake(
        {}, options, 0,
        "these are gzip data, which are read from files and from HTTP bodies with Content-Encoding: gzip",
        "unpack them before");
  }
  if (format == RdfFormat::kRdfXml) {
    if (std::optional<Diagnostic> mistake = DecodeXml(options.charset, &text, &document->decoded)) {
      ParsedRdf refused;
      mistake->file = options.file;
      refused.diagnostics.push_back(*std::move(mistake));
      return refused;
    }
  } else if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
  }
  if (std::optional<size_t> at = FindInvalidUtf8(text)) {
    return Mistake(
        text, options, *at,
        absl::StrFormat("the byte 0x%02X here is not UTF-8", static_cast<unsigned char>(text[*at])),
        "save the document as UTF-8");
  }
  return std::nullopt;
}

}  // namespace

std::string_view NameWithoutGz(std::string_view file_name) {
  const bool packed = absl::EndsWithIgnoreCase(ToAbsl(file_name), ".gz");
  return file_name.substr(0, file_name.size() - (packed ? 3 : 0));
}

std::optional<RdfFormat> FormatOfFile(std::string_view file_name) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(NameWithoutGz(file_name)));
  for (const FormatName& ending : kEndings) {
    if (lower.ends_with(ending.text)) return ending.format;
  }
  return std::nullopt;
}

absl::Status CheckFormatOfFile(std::string_view file_name) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(NameWithoutGz(file_name)));
  for (const OtherFormat& other : kOtherFormats) {
    if (!lower.ends_with(other.ending)) continue;
    const Diagnostic unread{std::string(file_name),
                            {1, 1},
                            Concat("this is ", other.name, " by its name, which is not read"),
                            kEndingsRead};
    return ToStatus({unread}, "");
  }
  return absl::OkStatus();
}

std::string UnknownMediaType(std::string_view media_type) {
  const absl::string_view type =
      absl::StripAsciiWhitespace(ToAbsl(media_type.substr(0, media_type.find(';'))));
  const std::string lower = absl::AsciiStrToLower(type);
  for (const OtherFormat& other : kOtherFormats) {
    if (lower == other.media_type)
      return Concat("\"", lower, "\" is ", other.name, ", which is not read; ", kTypesRead);
  }
  return Concat("the media type \"", lower, "\" is not known; ", kTypesRead);
}

std::optional<RdfFormat> FormatOfMediaType(std::string_view media_type) {
  absl::string_view type = absl::StripAsciiWhitespace(ToAbsl(media_type.substr(0, media_type.find(';'))));
  std::string lower = absl::AsciiStrToLower(type);
  for (const FormatName& known : kMediaTypes) {
    if (lower == known.text) return known.format;
  }
  return std::nullopt;
}

ParsedRdf ParseRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options) {
  SourceText document{text};
  if (std::optional<ParsedRdf> refused = Refused(&document, format, options)) return *std::move(refused);
  if (format == RdfFormat::kRdfXml) return ParseRdfXml(document.text, options);
  return ParseTurtleFamily(document.text, format, options);
}

absl::Status ToStatus(const ParsedRdf& parsed, std::string_view text) {
  return parsed.stopped.ok() ? ToStatus(parsed.diagnostics, text) : parsed.stopped;
}

LocatedRdf ParseLocatedRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options) {
  LocatedRdf located;
  SourceText document{text};
  if (std::optional<ParsedRdf> refused = Refused(&document, format, options)) {
    located.rdf = *std::move(refused);
    return located;
  }
  PlaceRecorder places;
  located.rdf = format == RdfFormat::kRdfXml ? ParseRdfXml(document.text, options, &places)
                                             : ParseTurtleFamily(document.text, format, options, &places);
  places.Finish(document.text, &located);
  return located;
}

ParsedRdf ParseLines(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                     const std::function<bool(const TermQuad& quad)>& visit) {
  SourceText document{text};
  if (std::optional<ParsedRdf> refused = Refused(&document, format, options)) return *std::move(refused);
  return ParseTurtleLines(document.text, format, options, visit);
}

}  // namespace docent
