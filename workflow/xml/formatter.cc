#include "workflow/xml/formatter.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "workflow/xml/element_reader.h"
#include "workflow/xml/markup.h"
#include "workflow/xml/xml_document.h"

namespace docent::xml {
namespace {

constexpr size_t kIndent = 2;

// A piece of markup with what is inside of it.
struct Piece {
  Markup::Kind kind = Markup::Kind::kText;
  std::string_view open;  // the start tag, or all of it
  std::string_view raw;   // all of it, children and end tag included
  std::string_view close;
  std::vector<Piece> children;
  size_t line_ends = 0;  // before it, after the piece before
  bool as_written = false;

  bool is_element() const { return kind == Markup::Kind::kStartTag || kind == Markup::Kind::kEmptyTag; }
};

// Of each kind: LF, CR LF and CR (XML 1.0 section 2.11).
size_t LineEnds(std::string_view text) {
  size_t count = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))) ++count;
  }
  return count;
}

// Characters after the last line end.
size_t Width(std::string_view text) {
  const size_t end = text.rfind('\n');
  if (end != std::string_view::npos) text.remove_prefix(end + 1);
  return static_cast<size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// Whether text stands in it itself, so that each blank may be meant.
bool HoldsText(const Piece& piece) {
  return std::any_of(piece.children.begin(), piece.children.end(), [](const Piece& child) {
    return child.kind == Markup::Kind::kCharacterData ||
           (child.kind == Markup::Kind::kText && !IsBlank(child.raw));
  });
}

class TreeBuilder {
 public:
  TreeBuilder(const std::vector<Markup>& markup, const Element& root)
      : markup_(markup), own_(root.namespace_iri) {
    Collect(root);
  }

  std::vector<Piece> Build() {
    std::vector<Piece> out;
    while (next_ < markup_.size()) out.push_back(BuildOne());
    DropBlanks(&out);
    return out;
  }

 private:
  void Collect(const Element& element) {
    elements_.push_back(&element);
    for (const auto& child : element.children) Collect(*child);
  }

  Piece BuildOne() {
    const Markup& markup = markup_[next_++];
    Piece piece;
    piece.kind = markup.kind;
    piece.open = piece.raw = markup.text;
    if (!piece.is_element()) return piece;
    const Element& element = *elements_[next_element_++];
    piece.as_written = IsKept(element);
    if (markup.kind == Markup::Kind::kEmptyTag) return piece;
    while (markup_[next_].kind != Markup::Kind::kEndTag) piece.children.push_back(BuildOne());
    piece.close = markup_[next_++].text;
    piece.raw =
        std::string_view(piece.open.data(), piece.close.data() + piece.close.size() - piece.open.data());
    if (HoldsText(piece)) {
      piece.as_written = piece.as_written || piece.children.size() > 1;
    } else {
      DropBlanks(&piece.children);
    }
    return piece;
  }

  bool IsKept(const Element& element) const {
    if (element.name == "documentation" || ElementReader::IsForeign(element, own_)) return true;
    return std::any_of(element.attributes.begin(), element.attributes.end(), [](const Attribute& a) {
      return a.prefix == "xml" && a.name == "space" && a.value.value == "preserve";
    });
  }

  // Text between elements is layout.
  static void DropBlanks(std::vector<Piece>* pieces) {
    size_t line_ends = 0;
    std::vector<Piece> kept;
    for (Piece& piece : *pieces) {
      if (piece.kind == Markup::Kind::kText) {
        line_ends += LineEnds(piece.raw);
        continue;
      }
      piece.line_ends = line_ends;
      line_ends = 0;
      kept.push_back(std::move(piece));
    }
    *pieces = std::move(kept);
  }

  const std::vector<Markup>& markup_;
  const std::string own_;
  std::vector<const Element*> elements_;  // in the order of their start tags
  size_t next_ = 0, next_element_ = 0;
};

class Writer {
 public:
  explicit Writer(std::string_view line_end) : line_end_(line_end) {}

  std::string Write(const std::vector<Piece>& pieces) {
    Lines(pieces, 0, /*inside=*/false);
    out_ += line_end_;
    return std::move(out_);
  }

 private:
  // Each piece on a line of its own, but a comment that stands behind something stays there.
  void Lines(const std::vector<Piece>& pieces, size_t depth, bool inside) {
    for (size_t i = 0; i < pieces.size(); ++i) {
      const Piece& piece = pieces[i];
      const bool first = i == 0 && !inside;
      if (piece.kind == Markup::Kind::kComment && piece.line_ends == 0 && !first) {
        out_ += ' ';
      } else if (!first) {
        out_ += line_end_;
        if (piece.line_ends > 1) out_ += line_end_;
        out_.append(depth * kIndent, ' ');
      }
      One(piece, depth);
    }
  }

  void One(const Piece& piece, size_t depth) {
    if (!piece.is_element() || piece.as_written) {
      out_ += piece.raw;
      return;
    }
    if (piece.children.empty() || HoldsText(piece)) {
      StartTag(piece);
      for (const Piece& child : piece.children) out_ += child.raw;
      if (piece.kind == Markup::Kind::kStartTag) out_ += EndTag(piece);
      return;
    }
    if (LineEnds(piece.raw) == 0) {
      const std::string line = OnOneLine(piece);
      if (depth * kIndent + Width(line) <= kFormatWidth) {
        out_ += line;
        return;
      }
    }
    StartTag(piece);
    Lines(piece.children, depth + 1, /*inside=*/true);
    out_ += line_end_;
    out_.append(depth * kIndent, ' ');
    out_ += EndTag(piece);
  }

  static std::string EndTag(const Piece& piece) { return Concat("</", SplitTag(piece.open).name, ">"); }

  // At the end of the output. A line ends where the author ended it, and before an attribute that would be too far right.
  void StartTag(const Piece& piece) {
    const Tag tag = SplitTag(piece.open);
    out_ += Concat("<", tag.name);
    const size_t column = Width(out_) + 1;
    const std::string_view end = piece.kind == Markup::Kind::kEmptyTag ? "/>" : ">";
    for (size_t i = 0; i < tag.attributes.size(); ++i) {
      const TagAttribute& attribute = tag.attributes[i];
      const std::string text = Concat(attribute.name, "=", attribute.value);
      const size_t first_line = Width(text.substr(0, text.find('\n')));
      const size_t tail = i + 1 == tag.attributes.size() ? end.size() : 0;
      const bool too_far = Width(out_) + 1 + first_line + tail > kFormatWidth;
      if (i > 0 && (attribute.on_new_line || too_far)) {
        out_ += line_end_;
        out_.append(column, ' ');
      } else {
        out_ += ' ';
      }
      out_ += text;
    }
    out_ += end;
  }

  static std::string OnOneLine(const Piece& piece) {
    if (!piece.is_element() || piece.as_written) return std::string(piece.raw);
    const Tag tag = SplitTag(piece.open);
    std::string out = Concat("<", tag.name);
    for (const TagAttribute& attribute : tag.attributes)
      out += Concat(" ", attribute.name, "=", attribute.value);
    if (piece.kind == Markup::Kind::kEmptyTag) return out + "/>";
    out += ">";
    for (const Piece& child : piece.children) {
      if (child.kind == Markup::Kind::kComment) out += ' ';
      out += OnOneLine(child);
    }
    return out + EndTag(piece);
  }

  const std::string_view line_end_;
  std::string out_;
};

// That of the first line that ends between two pieces.
std::string_view LineEndOf(const std::vector<Markup>& markup) {
  for (const Markup& piece : markup) {
    const size_t end = piece.text.find('\n');
    if (piece.kind != Markup::Kind::kText || !IsBlank(piece.text) || end == std::string_view::npos) continue;
    return end > 0 && piece.text[end - 1] == '\r' ? "\r\n" : "\n";
  }
  return "\n";
}

}  // namespace

FormattedXml FormatXml(std::string_view text, const std::string& file, const Limits& limits) {
  FormattedXml out;
  const ParsedXml parsed = ParseXml(text, file, limits);
  out.diagnostics = parsed.diagnostics;
  if (parsed.root == nullptr) return out;
  out.root = parsed.root->name;
  const std::optional<std::vector<Markup>> markup = SplitMarkup(text);
  if (!markup) {
    out.diagnostics.push_back(
        {file, SpanAt(text, 0), "XML of a form that is not understood", "report this document"});
    return out;
  }
  if (text.starts_with("\xEF\xBB\xBF")) out.text = "\xEF\xBB\xBF";
  out.text += Writer(LineEndOf(*markup)).Write(TreeBuilder(*markup, *parsed.root).Build());
  return out;
}

}  // namespace docent::xml
