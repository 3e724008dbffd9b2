#include "graph/rdf/formats/text_input.h"

#include <algorithm>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/diagnostic.h"
#include "graph/base/gzip.h"
#include "graph/base/regular_file.h"
#include "graph/base/text.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/xml_encoding.h"
#include "graph/rdf/utf8.h"

namespace docent {

namespace {

std::string ShownName(const std::string& path) {
  return path == "-" ? "stdin" : path;
}

absl::Status TooLarge(const std::string& path, const TextLimit& limit) {
  return absl::ResourceExhaustedError(absl::StrCat(ShownName(path), " has more bytes than the limit ",
                                                   ToAbsl(limit.name), " = ", limit.bytes));
}

// At most one byte more than the limit.
std::string ReadUpTo(std::istream& in, const TextLimit& limit) {
  constexpr size_t kPiece = 1u << 20;
  std::string text;
  while (in && text.size() <= limit.bytes) {
    const size_t before = text.size();
    text.resize(before + std::min(kPiece, limit.bytes + 1 - before));
    in.read(text.data() + before, static_cast<std::streamsize>(text.size() - before));
    text.resize(before + static_cast<size_t>(in.gcount()));
  }
  return text;
}

absl::StatusOr<std::string> ReadPacked(const std::string& path, const TextLimit& limit) {
  if (path == "-") return ReadUpTo(std::cin, limit);
  auto file = ReadRegularFile(path, limit.bytes, true);
  if (!file.ok()) return file.status();
  return std::move(file->text);
}

}  // namespace

absl::StatusOr<std::string> ReadBytes(const std::string& path, const TextLimit& limit) {
  auto bytes = ReadPacked(path, limit);
  if (!bytes.ok()) return bytes;
  if (bytes->size() > limit.bytes) return TooLarge(path, limit);
  if (!IsGzip(*bytes)) return bytes;
  auto unpacked = Gunzip(*bytes, limit.bytes, limit.name);
  if (unpacked.ok()) return unpacked;
  return absl::Status(unpacked.status().code(),
                      absl::StrCat(ShownName(path), ": ", unpacked.status().message()));
}

ParseRdfOptions RdfText::Options(const std::string& file) const {
  ParseRdfOptions options;
  options.file = file;
  options.base_iri = base_iri;
  if (is_utf8) options.charset = "utf-8";
  return options;
}

absl::StatusOr<RdfText> ReadRdf(const std::string& path, const std::string& base, const std::string& format,
                                const TextLimit& limit) {
  RdfText rdf;
  const std::string name = format.empty() ? path : absl::StrCat(".", format);
  if (absl::Status unread = CheckFormatOfFile(name); !unread.ok()) return unread;
  rdf.format = FormatOfFile(name).value_or(RdfFormat::kTurtle);
  rdf.base_iri = !base.empty() ? base : path == "-" ? "" : FileIri(path);
  auto bytes = ReadBytes(path, limit);
  if (!bytes.ok()) return bytes.status();
  std::string_view text = *bytes;
  std::string decoded;
  const bool read = rdf.format != RdfFormat::kRdfXml || !DecodeXml("", &text, &decoded);
  rdf.text = read && !decoded.empty() ? std::move(decoded) : *std::move(bytes);
  rdf.is_utf8 = read && !FindInvalidUtf8(rdf.text);
  return rdf;
}

absl::StatusOr<RdfText> ReadRdfToSend(const std::string& path, const std::string& base,
                                      const std::string& format, const TextLimit& limit) {
  auto rdf = ReadRdf(path, base, format, limit);
  if (!rdf.ok() || rdf->is_utf8) return rdf;
  const std::string shown = ShownName(path);
  const ParsedRdf refused = ParseRdf(rdf->text, rdf->format, rdf->Options(shown));
  const bool of_xml = rdf->format == RdfFormat::kRdfXml && !refused.ok();  // its other encodings are read
  return of_xml ? ToStatus(refused, rdf->text) : CheckUtf8(rdf->text, shown);
}

absl::StatusOr<std::string> ReadText(const std::string& path, const TextLimit& limit) {
  auto text = ReadBytes(path, limit);
  if (!text.ok()) return text;
  if (absl::Status status = CheckUtf8(*text, ShownName(path)); !status.ok()) return status;
  return text;
}

absl::Status CheckUtf8(const std::string& text, const std::string& file) {
  const auto bad = FindInvalidUtf8(text);
  if (!bad) return absl::OkStatus();
  // SpanAt counts code points, so it gets only the valid part
  const SourceSpan span = SpanAt(std::string_view(text).substr(0, *bad), *bad);
  const std::string message =
      absl::StrFormat("the byte 0x%02X here is not UTF-8", static_cast<unsigned char>(text[*bad]));
  return ToStatus({{file, span, message, "save the text as UTF-8"}}, text);
}

absl::StatusOr<std::string> GivenText(const std::string& what, const std::string& argument,
                                      const std::string& file, const TextLimit& limit) {
  if (!file.empty()) return ReadText(file, limit);
  if (argument.empty())
    return absl::InvalidArgumentError(
        absl::StrCat("no ", what, " given; pass it as an argument or with --file"));
  if (absl::Status status = CheckUtf8(argument, ""); !status.ok()) return status;
  return argument;
}

}  // namespace docent
