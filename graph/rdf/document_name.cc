#include "graph/rdf/document_name.h"

#include <filesystem>

#include "absl/strings/str_format.h"
#include "graph/base/fingerprint.h"
#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"

namespace docent {
namespace {

constexpr char32_t kCareOf = 0x2105;  // resembles a percent sign, and is allowed anywhere in a label

// Escapes each byte of a character for which `may_stand(c, at)` is false: `escape` and two hexadecimal
// digits.
template <typename MayStand>
std::string Escaped(std::string_view name, char32_t escape, const MayStand& may_stand) {
  std::string out;
  const size_t valid = FindInvalidUtf8(name).value_or(name.size());
  for (size_t at = 0, end = 0; at < name.size(); at = end) {
    const bool stands = at < valid && may_stand(NextCodePoint(name, &end), at);
    if (at >= valid) end = name.size();
    if (stands) out += name.substr(at, end - at);
    for (; !stands && at < end; ++at) {
      AppendUtf8(escape, &out);
      absl::StrAppendFormat(&out, "%02X", static_cast<unsigned char>(name[at]));
    }
  }
  return out;
}

}  // namespace

std::string NameInIri(std::string_view name) {
  return Escaped(name, '%', [](char32_t c, size_t) { return c != '%' && !IsForbiddenInIri(c); });
}

std::string FileIri(const std::string& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  const std::string name = (error ? std::filesystem::path(path) : absolute.lexically_normal()).string();
  return Concat("file://", name.starts_with('/') ? "" : "/", Escaped(name, '%', [](char32_t c, size_t) {
                  return c != '%' && c != '?' && c != '#' && c != '[' && c != ']' && !IsForbiddenInIri(c);
                }));
}

std::string NameInBlankLabel(std::string_view name) {
  return Escaped(name, kCareOf, [](char32_t c, size_t at) {
    const bool digit = c >= '0' && c <= '9';
    return c != kCareOf && (IsNameStart(c) || digit || (at > 0 && (IsNameChar(c) || c == '.')));
  });
}

std::string BlankLabelStart(std::string_view text) {
  return absl::StrFormat("d%016x_", Fingerprint(text));
}

}  // namespace docent
