// Pieces of markup of a text that CheckWellFormed accepted, comments and processing instructions included, each with its
// bytes. Any thread.
#ifndef DOCENT_WORKFLOW_XML_MARKUP_H_
#define DOCENT_WORKFLOW_XML_MARKUP_H_

#include <optional>
#include <string_view>
#include <vector>

namespace docent::xml {

struct Markup {
  enum class Kind {
    kStartTag,       // <a x="1">
    kEmptyTag,       // <a x="1"/>
    kEndTag,         // </a>
    kComment,        // <!-- … -->
    kInstruction,    // <?a …?>, and the XML declaration
    kText,           // up to the next "<", references as written
    kCharacterData,  // <![CDATA[…]]>
  };
  Kind kind = Kind::kText;
  std::string_view text;  // all of it, in the source
};

// One after the other, the pieces are the text (without a byte order mark). Nullopt if the text is cut off within one.
std::optional<std::vector<Markup>> SplitMarkup(std::string_view text);

struct TagAttribute {
  bool on_new_line = false;      // a line ends before it
  std::string_view name, value;  // value: with its quotes
};
struct Tag {
  std::string_view name;
  std::vector<TagAttribute> attributes;  // namespace declarations included
};
// Of a kStartTag or kEmptyTag.
Tag SplitTag(std::string_view tag);

// Of nothing but blanks and line ends (XML 1.0, production S).
bool IsBlank(std::string_view text);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_MARKUP_H_
