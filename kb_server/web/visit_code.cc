#include "kb_server/web/visit_code.h"

#include <qrencode.h>

#include <memory>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"

namespace docent::server {
namespace {

constexpr int kQuietModules = 4;        // ISO/IEC 18004 section 5.3.8
constexpr int kLabelModules = 5;        // height of the line below the code
constexpr double kLetterModules = 1.9;  // width of a letter of the label, at its full size

absl::Status TooLong(size_t bytes, const WebLimits& limits) {
  return absl::ResourceExhaustedError(absl::StrCat("the text of the code has ", bytes,
                                                   " bytes; the limit visit_code_bytes is ",
                                                   limits.visit_code_bytes, ". Give a shorter address"));
}

// RFC 3986 section 2.3: what stays as it is in a query.
std::string PercentEncoded(std::string_view text) {
  std::string encoded;
  for (const unsigned char c : text) {
    if (absl::ascii_isalnum(c) || c == '-' || c == '.' || c == '_' || c == '~' || c == ':')
      encoded.push_back(static_cast<char>(c));
    else
      absl::StrAppend(&encoded, absl::StrFormat("%%%02X", c));
  }
  return encoded;
}

std::string XmlText(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped.append("&amp;");
        break;
      case '<':
        escaped.append("&lt;");
        break;
      case '>':
        escaped.append("&gt;");
        break;
      default:
        escaped.push_back(static_cast<unsigned char>(c) < 0x20 ? ' ' : c);
    }
  }
  return escaped;
}

// The dark modules, row by row, each run as one rectangle: "M4 4h7v1h-7z".
std::string DarkModules(const QRcode& code) {
  std::string path;
  for (int y = 0; y < code.width; ++y) {
    for (int x = 0; x < code.width; ++x) {
      int length = 0;
      while (x + length < code.width && (code.data[y * code.width + x + length] & 1) != 0) ++length;
      if (length == 0) continue;
      absl::StrAppend(&path, "M", x + kQuietModules, " ", y + kQuietModules, "h", length, "v1h-", length,
                      "z");
      x += length;
    }
  }
  return path;
}

}  // namespace

absl::StatusOr<std::string> VisitAddress(std::string_view base, std::string_view place,
                                         const WebLimits& limits) {
  for (std::string_view text : {base, place}) {
    if (FindInvalidUtf8(text)) return absl::InvalidArgumentError("the address or the place is not UTF-8");
  }
  const std::string_view scheme = base.starts_with("https://") ? "https://" : "http://";
  const std::string_view host = base.starts_with(scheme) ? base.substr(scheme.size()) : "";
  const bool has_other = host.find_first_of(" \t\r\n\"<>?#\\@") != std::string_view::npos;
  if (host.empty() || host.front() == '/' || has_other) {
    return absl::InvalidArgumentError(
        Concat("\"", base, "\" is no address of a server; give one such as https://expo.example.org"));
  }
  if (place.empty())
    return absl::InvalidArgumentError("the place is empty; give the name of a booth, such as B05");
  while (base.ends_with('/')) base.remove_suffix(1);
  std::string address = Concat(base, "/visit?at=", PercentEncoded(place));
  if (address.size() > limits.visit_code_bytes) return TooLong(address.size(), limits);
  return address;
}

absl::StatusOr<std::string> QrCodeSvg(const std::string& text, std::string_view label,
                                      const WebLimits& limits) {
  if (text.size() > limits.visit_code_bytes) return TooLong(text.size(), limits);
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code(
      QRcode_encodeData(static_cast<int>(text.size()), reinterpret_cast<const unsigned char*>(text.data()),
                        /*version=*/0, QR_ECLEVEL_M),
      QRcode_free);
  if (code == nullptr) return absl::InternalError("libqrencode makes no code of this text");
  const int width = code->width + 2 * kQuietModules;
  const int height = width + (label.empty() ? 0 : kLabelModules);
  std::string svg = absl::StrFormat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%dmm\" "
      "height=\"%dmm\" shape-rendering=\"crispEdges\">"
      "<title>%s</title><rect width=\"%d\" height=\"%d\" fill=\"#fff\"/><path d=\"%s\"/>",
      width, height, 2 * width, 2 * height, XmlText(text), width, height, DarkModules(*code));
  if (!label.empty()) {
    const double wide = static_cast<double>(label.size()) * kLetterModules;
    absl::StrAppendFormat(&svg,
                          "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\" font-family=\"sans-serif\" "
                          "font-size=\"%.2f\">%s</text>",
                          width / 2.0, width + 1, wide > width ? 3.2 * width / wide : 3.2, XmlText(label));
  }
  svg.append("</svg>\n");
  return svg;
}

}  // namespace docent::server
