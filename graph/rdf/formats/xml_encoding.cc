#include "graph/rdf/formats/xml_encoding.h"

#include <iconv.h>

#include <array>
#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"

namespace docent {
namespace {

constexpr char kRead[] =
    "UTF-8, UTF-16, US-ASCII, ISO-8859-1 to -16, Windows-1250 to -1258 and KOI8 are read; save it as UTF-8";

Diagnostic Mistake(std::string_view text, size_t offset, std::string message) {
  return {"", SpanAt(text, offset, offset < text.size() ? 1 : 0), std::move(message), kRead};
}

// The encoding name in <?xml version="1.0" encoding="…"?>, as a view into the text; empty: none. ASCII-based
// texts only.
std::string_view DeclaredEncoding(std::string_view text) {
  if (!text.starts_with("<?xml")) return {};
  const std::string_view declaration = text.substr(0, text.find("?>"));
  const size_t word = declaration.find("encoding");
  if (word == std::string_view::npos) return {};
  const size_t open = declaration.find_first_of("\"'", word);
  if (open == std::string_view::npos) return {};
  const size_t close = declaration.find(declaration[open], open + 1);
  return close == std::string_view::npos ? std::string_view()
                                         : declaration.substr(open + 1, close - open - 1);
}

enum class Order { kLittle, kBig };

// RFC 2781.
std::optional<Diagnostic> DecodeUtf16(std::string_view bytes, Order order, std::string* out) {
  const auto unit = [&](size_t at) -> char32_t {
    const unsigned char first = static_cast<unsigned char>(bytes[at]),
                        second = static_cast<unsigned char>(bytes[at + 1]);
    return order == Order::kLittle ? first | second << 8 : first << 8 | second;
  };
  out->reserve(bytes.size());
  for (size_t at = 0; at < bytes.size(); at += 2) {
    if (at + 1 == bytes.size()) return Mistake(*out, out->size(), "the UTF-16 text ends within a character");
    char32_t c = unit(at);
    if (c >= 0xD800 && c < 0xE000) {
      const char32_t low = c < 0xDC00 && at + 3 < bytes.size() ? unit(at + 2) : 0;
      if (low < 0xDC00 || low >= 0xE000) {
        return Mistake(
            *out, out->size(),
            absl::StrFormat("half of a surrogate pair, 0x%04X is alone in UTF-16", static_cast<uint32_t>(c)));
      }
      c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
      at += 2;
    }
    AppendUtf8(c, out);
  }
  return std::nullopt;
}

// The characters of the 256 bytes of a single-byte encoding; 0: none. nullopt: iconv does not know it.
using CodePage = std::array<char32_t, 256>;
std::optional<CodePage> CodePageOf(const std::string& name) {
  const iconv_t converter = iconv_open("UTF-32LE", name.c_str());
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  CodePage page{};
  for (size_t i = 0; i < page.size(); ++i) {
    char byte = static_cast<char>(i);
    unsigned char character[4] = {};
    char* from = &byte;
    char* to = reinterpret_cast<char*>(character);
    size_t from_left = 1, to_left = sizeof(character);
    iconv(converter, nullptr, nullptr, nullptr, nullptr);
    if (iconv(converter, &from, &from_left, &to, &to_left) == static_cast<size_t>(-1) || to_left != 0)
      continue;
    page[i] = character[0] | character[1] << 8 | character[2] << 16;
  }
  iconv_close(converter);
  return page;
}

std::optional<Diagnostic> DecodeBytes(std::string_view bytes, const CodePage& page, std::string_view name,
                                      std::string* out) {
  out->reserve(bytes.size());
  for (const char c : bytes) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (page[byte] == 0 && byte != 0) {
      return Mistake(*out, out->size(),
                     absl::StrFormat("the byte 0x%02X here is not a character of %s", byte, ToAbsl(name)));
    }
    AppendUtf8(page[byte], out);
  }
  return std::nullopt;
}

bool StartsWithAny(std::string_view name, std::initializer_list<std::string_view> starts) {
  for (const std::string_view start : starts) {
    if (name.starts_with(start)) return true;
  }
  return false;
}

}  // namespace

std::optional<Diagnostic> DecodeXml(const std::string& charset, std::string_view* text, std::string* owned) {
  using namespace std::string_view_literals;
  const std::string_view bytes = *text;
  const auto utf16 = [&](size_t skipped, Order order) {
    std::optional<Diagnostic> mistake = DecodeUtf16(bytes.substr(skipped), order, owned);
    *text = *owned;
    return mistake;
  };
  if (bytes.starts_with("\xEF\xBB\xBF"sv)) {
    text->remove_prefix(3);
    return std::nullopt;
  }
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) {
    return Mistake({}, 0, "the document is in UTF-32, which is not read");
  }
  if (bytes.starts_with("\xFF\xFE"sv)) return utf16(2, Order::kLittle);
  if (bytes.starts_with("\xFE\xFF"sv)) return utf16(2, Order::kBig);
  if (bytes.starts_with("<\0"sv)) return utf16(0, Order::kLittle);
  if (bytes.starts_with("\0<"sv)) return utf16(0, Order::kBig);
  const std::string_view declared = DeclaredEncoding(bytes);
  const std::string name =
      absl::AsciiStrToLower(charset.empty() ? ToAbsl(declared) : absl::string_view(charset));
  const size_t at = declared.empty() ? 0 : static_cast<size_t>(declared.data() - bytes.data());
  if (name.empty() || name == "utf-8" || name == "utf8" || name == "us-ascii" || name == "ascii")
    return std::nullopt;
  if (StartsWithAny(name, {"utf-16", "utf16", "iso-10646-ucs-2", "ucs-2"})) {
    return Mistake(bytes, at, Concat("the document says that it is in ", name, ", and is not"));
  }
  const bool read =
      StartsWithAny(name, {"iso-8859-", "iso_8859-", "iso8859-", "latin", "windows-125", "cp125", "koi8-"});
  const std::optional<CodePage> page =
      read && name.find('/') == std::string::npos ? CodePageOf(name) : std::nullopt;
  if (!page) return Mistake(bytes, at, Concat("the encoding \"", name, "\" is not read"));
  std::optional<Diagnostic> mistake = DecodeBytes(bytes, *page, name, owned);
  *text = *owned;
  return mistake;
}

}  // namespace docent
