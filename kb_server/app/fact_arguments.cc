#include "kb_server/app/fact_arguments.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/parser.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/wire/term_proto.h"

namespace docent {

absl::StatusOr<std::string> FactPrologue(const std::vector<std::string>& prefixes) {
  std::string text;
  for (const auto& [prefix, iri] : kWellKnownPrefixes) {
    absl::StrAppend(&text, "@prefix ", std::string(prefix), ": <", std::string(iri), "> . ");
  }
  for (const std::string& given : prefixes) {
    std::pair<std::string, std::string> parts = absl::StrSplit(given, absl::MaxSplits('=', 1));
    if (parts.first.empty() || parts.second.empty()) {
      return absl::InvalidArgumentError(absl::StrCat("--prefix \"", given, "\" is not NAME=IRI"));
    }
    absl::StrAppend(&text, "@prefix ", parts.first, ": <", parts.second, "> . ");
  }
  return text + "\n";
}

absl::StatusOr<std::vector<TermQuad>> ParseFacts(const std::string& prologue, std::string text,
                                                 const std::string& name) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\n')) text.pop_back();
  if (text.empty()) return std::vector<TermQuad>();
  if (text.back() != '.') text += " .";
  ParseRdfOptions options;
  options.file = name;
  ParsedRdf parsed = ParseRdf(prologue + text, RdfFormat::kTurtle, options);
  if (!parsed.ok()) {
    for (Diagnostic& d : parsed.diagnostics) {
      if (d.span.line > 1) --d.span.line;
      d.span.offset -= std::min(d.span.offset, prologue.size());
    }
    return ToStatus(parsed.diagnostics, text);
  }
  return std::move(parsed.quads);
}

std::string ReadIri(const std::vector<std::string>& prefixes, const std::string& text) {
  if (absl::StartsWith(text, "<") && absl::EndsWith(text, ">")) return text.substr(1, text.size() - 2);
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return text;
  const std::string local = text.substr(colon + 1);
  std::string iri = text;
  for (const auto& [prefix, name_space] : kWellKnownPrefixes) {
    if (prefix == text.substr(0, colon)) iri = Concat(name_space, local);
  }
  // as in Turtle, the last declaration holds
  for (const std::string& given : prefixes) {
    if (absl::StartsWith(given, text.substr(0, colon) + "=")) iri = given.substr(colon + 1) + local;
  }
  return iri;
}

void AddQuads(const std::vector<TermQuad>& quads, google::protobuf::RepeatedPtrField<v1::Quad>* out) {
  for (const TermQuad& quad : quads) ToProto(quad, out->Add());
}

absl::Status AddPrefixes(const std::vector<std::string>& prefixes,
                         google::protobuf::Map<std::string, std::string>* out) {
  for (const std::string& given : prefixes) {
    std::pair<std::string, std::string> parts = absl::StrSplit(given, absl::MaxSplits('=', 1));
    if (parts.second.empty())
      return absl::InvalidArgumentError(absl::StrCat("--prefix \"", given, "\" is not NAME=IRI"));
    (*out)[parts.first] = parts.second;
  }
  return absl::OkStatus();
}

}  // namespace docent
