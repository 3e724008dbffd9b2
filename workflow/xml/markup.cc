#include "workflow/xml/markup.h"

#include <algorithm>

namespace docent::xml {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

// The end of a tag that begins at `at`: past the ">" outside of quotes; npos if there is none.
size_t TagEnd(std::string_view text, size_t at) {
  char quote = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at + 1;
    }
  }
  return std::string_view::npos;
}

size_t PastEnd(std::string_view text, size_t from, std::string_view end) {
  const size_t found = text.find(end, from);
  return found == std::string_view::npos ? found : found + end.size();
}

}  // namespace

bool IsBlank(std::string_view text) {
  return text.find_first_not_of(kBlanks) == std::string_view::npos;
}

std::optional<std::vector<Markup>> SplitMarkup(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  using Kind = Markup::Kind;
  std::vector<Markup> out;
  for (size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    Kind kind = Kind::kText;
    size_t end = 0;
    if (rest[0] != '<') {
      end = std::min(text.find('<', at), text.size());
    } else if (rest.starts_with("<!--")) {
      kind = Kind::kComment;
      end = PastEnd(text, at + 4, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      kind = Kind::kCharacterData;
      end = PastEnd(text, at + 9, "]]>");
    } else if (rest.starts_with("<?")) {
      kind = Kind::kInstruction;
      end = PastEnd(text, at + 2, "?>");
    } else {
      end = TagEnd(text, at);
      if (end == std::string_view::npos) return std::nullopt;
      kind = rest.starts_with("</") ? Kind::kEndTag
             : text[end - 2] == '/' ? Kind::kEmptyTag
                                    : Kind::kStartTag;
    }
    if (end == std::string_view::npos) return std::nullopt;
    out.push_back({kind, text.substr(at, end - at)});
    at = end;
  }
  return out;
}

Tag SplitTag(std::string_view tag) {
  Tag out;
  size_t at = 1;
  const auto name_at = [&] {
    const size_t end = std::min(tag.find_first_of(" \t\r\n=/>", at), tag.size());
    const std::string_view name = tag.substr(at, end - at);
    at = end;
    return name;
  };
  const auto skip_blanks = [&] {
    const size_t end = std::min(tag.find_first_not_of(kBlanks, at), tag.size());
    const std::string_view blanks = tag.substr(at, end - at);
    at = end;
    return blanks.find_first_of("\r\n") != std::string_view::npos;
  };
  out.name = name_at();
  while (at < tag.size()) {
    TagAttribute attribute;
    attribute.on_new_line = skip_blanks();
    if (at >= tag.size() || tag[at] == '>' || tag[at] == '/') break;
    attribute.name = name_at();
    skip_blanks();
    if (at >= tag.size() || tag[at] != '=') break;
    ++at;
    skip_blanks();
    if (at >= tag.size()) break;
    const size_t close = tag.find(tag[at], at + 1);
    if (close == std::string_view::npos) break;
    attribute.value = tag.substr(at, close + 1 - at);
    at = close + 1;
    out.attributes.push_back(attribute);
  }
  return out;
}

}  // namespace docent::xml
