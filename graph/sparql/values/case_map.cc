#include "graph/sparql/values/case_map.h"

#include <unicode/bytestream.h>
#include <unicode/casemap.h>

namespace docent::sparql {
namespace {

using Map = void (*)(const char* locale, uint32_t options, icu::StringPiece text, icu::ByteSink& sink,
                     icu::Edits* edits, UErrorCode& error);

std::string Mapped(std::string_view text, Map map) {
  std::string out;
  icu::StringByteSink<std::string> sink(&out, static_cast<int32_t>(text.size()));
  UErrorCode error = U_ZERO_ERROR;
  map("", 0, icu::StringPiece(text.data(), static_cast<int32_t>(text.size())), sink, nullptr, error);
  return U_SUCCESS(error) ? out : std::string(text);
}

}  // namespace

std::string UpperCase(std::string_view text) {
  return Mapped(text, icu::CaseMap::utf8ToUpper);
}
std::string LowerCase(std::string_view text) {
  return Mapped(text, icu::CaseMap::utf8ToLower);
}

}  // namespace docent::sparql
