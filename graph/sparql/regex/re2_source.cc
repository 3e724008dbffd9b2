#include "graph/sparql/regex/re2_source.h"

#include <algorithm>
#include <string_view>

namespace docent::sparql {
namespace {

using Kind = RegexNode::Kind;

constexpr uint64_t kMostRepeats = 1000;  // RE2's limit for the product of nested quantifiers
// Above this number of RE2 instructions our own program is faster to compile and to run on texts of usual
// length, because it has one instruction for a class of any size: RE2 compiles 200 a millisecond (measured
// 2026-11-24, \w{1,255}).
constexpr uint64_t kMostInstructions = 4000;

// RE2's sets are sets of UTF-8: about this many instructions a range.
uint64_t InstructionsOf(const CharacterSet& set) {
  return 1 + 2 * set.ranges().size();
}

class Writer {
 public:
  Writer(const RegexTree& tree, bool capture) : tree_(tree), capture_(capture) {}

  // The approximate number of RE2 instructions; kMostInstructions or more if RE2 must not be used. `repeats`:
  // product of the enclosing quantifiers.
  uint64_t Measure(const RegexNode& node, uint64_t repeats) const;
  void Write(const RegexNode& node);
  std::string Take() { return std::move(out_); }

 private:
  void WriteCharacter(char32_t c);
  void WriteSet(const CharacterSet& set);
  void WriteQuantifier(const RegexNode& node);

  const RegexTree& tree_;
  const bool capture_;
  std::string out_;
};

uint64_t Writer::Measure(const RegexNode& node, uint64_t repeats) const {
  uint64_t sum = 1;
  switch (node.kind) {
    case Kind::kBackReference:
      return kMostInstructions;
    case Kind::kSet:
      sum = InstructionsOf(*node.set);
      break;
    case Kind::kRepeat: {
      const uint64_t copies = std::max<uint64_t>(1, node.most == RegexNode::kNoMost ? node.least : node.most);
      if (copies > kMostRepeats || copies * repeats > kMostRepeats) return kMostInstructions;
      return copies * Measure(node.children[0], repeats * copies);
    }
    default:
      break;
  }
  for (const RegexNode& child : node.children) {
    sum += Measure(child, repeats);
    if (sum >= kMostInstructions) return kMostInstructions;
  }
  return sum;
}

void Writer::WriteCharacter(char32_t c) {
  if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) {
    out_ += static_cast<char>(c);
    return;
  }
  constexpr char kDigits[] = "0123456789ABCDEF";
  out_ += "\\x{";
  for (int shift = 20; shift >= 0; shift -= 4) {
    if (c >> shift != 0 || shift == 0) out_ += kDigits[(c >> shift) & 15];
  }
  out_ += '}';
}

void Writer::WriteSet(const CharacterSet& set) {
  const auto& ranges = set.ranges();
  if (ranges.empty()) {
    out_ += "[^\\x{0}-\\x{10FFFF}]";
    return;
  }
  out_ += '[';
  for (size_t i = 0; i < ranges.size(); ++i) {
    WriteCharacter(ranges[i].first);
    // Texts have no surrogates: a range that ends before them and one that begins after them are merged.
    if (ranges[i].last == 0xD7FF && i + 1 < ranges.size() && ranges[i + 1].first == 0xE000) ++i;
    out_ += '-';
    WriteCharacter(ranges[i].last);
  }
  out_ += ']';
}

void Writer::WriteQuantifier(const RegexNode& node) {
  if (node.most == RegexNode::kNoMost && node.least <= 1) {
    out_ += node.least == 0 ? '*' : '+';
  } else if (node.least == 0 && node.most == 1) {
    out_ += '?';
  } else {
    out_ += '{' + std::to_string(node.least);
    if (node.most == RegexNode::kNoMost) {
      out_ += ',';
    } else if (node.most != node.least) {
      out_ += ',' + std::to_string(node.most);
    }
    out_ += '}';
  }
  if (!node.greedy) out_ += '?';
}

void Writer::Write(const RegexNode& node) {
  switch (node.kind) {
    case Kind::kEmpty:
      out_ += "(?:)";
      break;
    case Kind::kCharacter:
      WriteCharacter(node.character);
      break;
    case Kind::kSet:
      WriteSet(*node.set);
      break;
    case Kind::kStart:
      out_ += tree_.multi_line ? "(?m:^)" : "\\A";
      break;
    case Kind::kEnd:
      out_ += tree_.multi_line ? "(?m:$)" : "\\z";
      break;
    case Kind::kSequence:
      for (const RegexNode& child : node.children) Write(child);
      break;
    case Kind::kAlternatives:
      out_ += "(?:";
      for (const RegexNode& child : node.children) {
        if (&child != &node.children[0]) out_ += '|';
        Write(child);
      }
      out_ += ')';
      break;
    case Kind::kGroup:
      out_ += capture_ ? "(" : "(?:";
      Write(node.children[0]);
      out_ += ')';
      break;
    case Kind::kRepeat:
      out_ += "(?:";
      Write(node.children[0]);
      out_ += ')';
      WriteQuantifier(node);
      break;
    case Kind::kBackReference:  // Measure refuses it
      break;
  }
}

}  // namespace

std::optional<std::string> Re2Source(const RegexTree& tree, bool capture) {
  Writer writer(tree, capture);
  if (writer.Measure(tree.root, 1) >= kMostInstructions) return std::nullopt;
  writer.Write(tree.root);
  return writer.Take();
}

}  // namespace docent::sparql
