#include "graph/rdf/docent_iris.h"

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/utf8.h"

namespace docent {
namespace {

constexpr std::string_view kOperation = "urn:docent:operation:";
constexpr std::string_view kService = "urn:docent:service:";
constexpr std::string_view kWorkflow = "urn:docent:workflow:";
constexpr std::string_view kRun = "urn:docent:run:";

bool IsHex(char c) {
  return absl::ascii_isxdigit(static_cast<unsigned char>(c));
}

// True for general category Cc, line and paragraph separators, and characters that change the direction of
// the text after them (Unicode Bidirectional Algorithm, section 2).
bool IsControl(char32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x2028 || c == 0x2029 || (c >= 0x202A && c <= 0x202E) ||
         (c >= 0x2066 && c <= 0x2069);
}

}  // namespace

std::string IriSegment(std::string_view name) {
  std::string out;
  out.reserve(name.size());
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool stands = byte >= 0x80 || (!IsForbiddenInIri(byte) && byte != 0x7F &&
                                         std::string_view("%/?#$@").find(c) == std::string_view::npos);
    if (stands)
      out += c;
    else
      absl::StrAppendFormat(&out, "%%%02X", byte);
  }
  return out;
}

std::string NameOfSegment(std::string_view segment) {
  std::string out;
  for (size_t i = 0; i < segment.size(); ++i) {
    const bool encoded =
        segment[i] == '%' && i + 2 < segment.size() && IsHex(segment[i + 1]) && IsHex(segment[i + 2]);
    if (encoded) {
      out += absl::HexStringToBytes(ToAbsl(segment.substr(i + 1, 2)));
      i += 2;
    } else {
      out += segment[i];
    }
  }
  return out;
}

std::optional<std::string> NameFault(std::string_view name) {
  if (name.size() > kWorkflowLimits.name_bytes) {
    return absl::StrCat("has ", name.size(), " bytes; the limit name_bytes is ", kWorkflowLimits.name_bytes);
  }
  if (FindInvalidUtf8(name)) return "is not UTF-8";
  for (size_t at = 0, end = 0; at < name.size(); at = end) {
    const char32_t c = NextCodePoint(name, &end);
    if (IsControl(c)) return absl::StrFormat("holds the control character U+%04X", static_cast<uint32_t>(c));
  }
  return std::nullopt;
}

std::optional<std::string> DocumentNameFault(std::string_view name) {
  if (name.find_first_not_of(" \t\r\n") == std::string_view::npos) return "is empty";
  if (std::optional<std::string> fault = NameFault(name)) return fault;
  if (name.front() == ' ' || name.back() == ' ') return "begins or ends with a blank";
  for (const absl::string_view part : absl::StrSplit(ToAbsl(name), '/')) {
    if (part == "." || part == "..")
      return absl::StrCat("has the part ", part, ", which stands for another folder in an IRI");
  }
  return std::nullopt;
}

std::string OperationIri(std::string_view name) {
  return Concat(kOperation, IriSegment(name));
}

std::string ServiceIri(std::string_view name) {
  return Concat(kService, IriSegment(name));
}

std::string ServiceDocumentIri(std::string_view name) {
  return Concat("urn:docent:service-document:", IriSegment(name));
}

std::string WorkflowIri(std::string_view name) {
  return Concat(kWorkflow, IriSegment(name));
}

std::optional<std::string> OperationOfIri(std::string_view iri) {
  if (!iri.starts_with(kOperation)) return std::nullopt;
  return NameOfSegment(iri.substr(kOperation.size()));
}

std::optional<std::string> WorkflowOfIri(std::string_view iri) {
  if (!iri.starts_with(kWorkflow)) return std::nullopt;
  return NameOfSegment(iri.substr(kWorkflow.size()));
}

std::string ReservationIri(std::string_view id) {
  return Concat("urn:docent:reservation:", id);
}

std::string RunIri(const RunId& run) {
  return Concat(kRun, run.value());
}

std::optional<RunId> RunOfIri(std::string_view iri) {
  if (!iri.starts_with(kRun)) return std::nullopt;
  return RunId(std::string(iri.substr(kRun.size())));
}

}  // namespace docent
