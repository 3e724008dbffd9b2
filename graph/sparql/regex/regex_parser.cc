#include "graph/sparql/regex/regex_parser.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/utf8.h"
#include "graph/sparql/regex/class_parser.h"
#include "graph/sparql/regex/escape_parser.h"
#include "graph/sparql/regex/pattern_scanner.h"

namespace docent::sparql {
namespace {

using Kind = RegexNode::Kind;

constexpr uint64_t kNoMost = RegexNode::kNoMost;

// Saturating product; counts stay below the square of a limit.
uint64_t Times(uint64_t a, uint64_t b) {
  return b != 0 && a > UINT32_MAX / b ? UINT32_MAX : a * b;
}

class RegexParser {
 public:
  RegexParser(std::string_view pattern, std::string_view flags, const RegexLimits& limits, RegexTree* tree)
      : limits_(limits),
        scanner_(pattern,
                 flags.find('x') != std::string_view::npos && flags.find('q') == std::string_view::npos),
        dot_(flags.find('s') != std::string_view::npos
                 ? std::make_shared<const CharacterSet>(CharacterSet().Complement())
                 : EscapeSet('.')),
        ranges_left_(limits.regex_ranges),
        tree_(*tree) {}

  std::optional<RegexMistake> Read();
  // Flag q: every character stands for itself.
  std::optional<RegexMistake> ReadLiteral();

 private:
  RegexNode Alternatives();  // regExp ::= branch ('|' branch)*
  RegexNode Branch();        // branch ::= piece*
  RegexNode Piece();         // piece ::= atom quantifier?
  RegexNode Atom();
  RegexNode Group();
  RegexNode BackReference(size_t start);
  RegexNode Character(char32_t c);
  RegexNode Set(CharacterSetPtr set);
  RegexNode Anchor(Kind kind);
  bool AtQuantifier() const;
  RegexNode Quantified(RegexNode atom, size_t start);
  bool ReadQuantity(uint64_t* least, uint64_t* most);
  std::optional<uint64_t> ReadNumber();
  // Reports an expression that would take more instructions than allowed.
  void CheckSize(uint64_t size, size_t start);

  const RegexLimits& limits_;
  PatternScanner scanner_;
  const CharacterSetPtr dot_;
  size_t ranges_left_;
  int depth_ = 0;
  std::vector<bool> closed_;  // of each group
  RegexTree& tree_;
};

std::optional<RegexMistake> RegexParser::Read() {
  tree_.root = Alternatives();
  if (scanner_.ok() && !scanner_.AtEnd()) {
    scanner_.Fail(scanner_.offset(), "')' closes no group", "write \\) for the parenthesis itself");
  }
  tree_.groups = static_cast<int>(closed_.size());
  return scanner_.TakeMistake();
}

std::optional<RegexMistake> RegexParser::ReadLiteral() {
  tree_.root = RegexNode{};
  tree_.root.kind = Kind::kSequence;
  while (!scanner_.AtEnd()) tree_.root.children.push_back(Character(scanner_.Take()));
  if (tree_.root.children.empty()) tree_.root.kind = Kind::kEmpty;
  tree_.root.size = std::max<uint64_t>(1, tree_.root.children.size());
  return scanner_.TakeMistake();
}

void RegexParser::CheckSize(uint64_t size, size_t start) {
  if (size <= limits_.regex_instructions) return;
  scanner_.Fail(start,
                "the pattern is larger than the limit regex_instructions = " +
                    std::to_string(limits_.regex_instructions) + ": a part counts as often as it is repeated",
                "use smaller numbers in {…}");
}

RegexNode RegexParser::Alternatives() {
  RegexNode node = Branch();
  if (scanner_.Peek() != '|') return node;
  const size_t start = scanner_.offset();
  RegexNode all;
  all.kind = Kind::kAlternatives;
  all.size = node.size;
  all.children.push_back(std::move(node));
  while (scanner_.ok() && scanner_.Accept('|')) {
    all.children.push_back(Branch());
    all.size += 2 + all.children.back().size;
  }
  CheckSize(all.size, start);
  return all;
}

RegexNode RegexParser::Branch() {
  RegexNode node;
  node.kind = Kind::kSequence;
  node.size = 0;
  while (scanner_.ok() && !scanner_.AtEnd() && scanner_.Peek() != '|' && scanner_.Peek() != ')') {
    const size_t start = scanner_.offset();
    node.children.push_back(Piece());
    node.size += node.children.back().size;
    CheckSize(node.size, start);
  }
  if (node.children.empty()) return RegexNode{};
  if (node.children.size() > 1) return node;
  RegexNode only = std::move(node.children[0]);
  return only;
}

bool RegexParser::AtQuantifier() const {
  const char32_t c = scanner_.Peek();
  return c == '?' || c == '*' || c == '+' || c == '{';
}

RegexNode RegexParser::Piece() {
  const size_t start = scanner_.offset();
  RegexNode atom = Atom();
  if (!scanner_.ok() || !AtQuantifier()) return atom;
  RegexNode repeat = Quantified(std::move(atom), start);
  if (scanner_.ok() && AtQuantifier()) {
    const size_t second = scanner_.offset();
    scanner_.Take();
    scanner_.Fail(second, Concat("a second quantifier, ", scanner_.Quoted(second)),
                  "a quantifier is ?, *, + or {…}, and one '?' behind it makes it reluctant; write (…) "
                  "around what is repeated twice");
  }
  return repeat;
}

std::optional<uint64_t> RegexParser::ReadNumber() {
  const auto digit = [this] { return scanner_.Peek() >= '0' && scanner_.Peek() <= '9'; };
  if (!digit()) return std::nullopt;
  uint64_t number = 0;
  while (digit()) number = std::min<uint64_t>(UINT32_MAX, number * 10 + (scanner_.Take() - '0'));
  return number;
}

// {2} {2,} {2,3}, after the '{'.
bool RegexParser::ReadQuantity(uint64_t* least, uint64_t* most) {
  const std::optional<uint64_t> first = ReadNumber();
  if (!first) return false;
  *least = *most = *first;
  if (scanner_.Accept(',')) *most = ReadNumber().value_or(kNoMost);
  return scanner_.Accept('}');
}

RegexNode RegexParser::Quantified(RegexNode atom, size_t start) {
  RegexNode node;
  node.kind = Kind::kRepeat;
  const size_t at = scanner_.offset();
  switch (scanner_.Take()) {
    case '?':
      node.most = 1;
      break;
    case '*':
      break;
    case '+':
      node.least = 1;
      break;
    default:
      if (!ReadQuantity(&node.least, &node.most)) {
        scanner_.Fail(at, "expected a quantity such as {2}, {2,} or {2,5}", "write \\{ for the brace itself");
      } else if (node.most < node.least) {
        scanner_.Fail(at, Concat("the quantity ", scanner_.Quoted(at), " has its numbers in the wrong order"),
                      "the smaller number comes first");
      }
  }
  node.greedy = !scanner_.Accept('?');
  const uint64_t copies = node.most == kNoMost ? std::max<uint64_t>(1, node.least) : node.most;
  // Each optional copy has a branch before it.
  const uint64_t branches = node.most == kNoMost ? 2 : node.most - std::min(node.least, node.most);
  node.size = std::max<uint64_t>(1, Times(atom.size, copies) + branches);
  CheckSize(node.size, start);
  node.children.push_back(std::move(atom));
  return node;
}

RegexNode RegexParser::Character(char32_t c) {
  if (tree_.ignore_case) {
    CharacterSet variants = WithCaseVariants(CharacterSet::Of({{c, c}}));
    const auto& ranges = variants.ranges();
    if (ranges.size() > 1 || ranges[0].first != ranges[0].last)
      return Set(std::make_shared<const CharacterSet>(std::move(variants)));
  }
  RegexNode node;
  node.kind = Kind::kCharacter;
  node.character = c;
  return node;
}

RegexNode RegexParser::Set(CharacterSetPtr set) {
  RegexNode node;
  node.kind = Kind::kSet;
  node.set = std::move(set);
  return node;
}

RegexNode RegexParser::Anchor(Kind kind) {
  RegexNode node;
  node.kind = kind;
  tree_.has_anchors = true;
  return node;
}

RegexNode RegexParser::Atom() {
  const size_t start = scanner_.offset();
  switch (scanner_.Peek()) {
    case '\\': {
      const char32_t digit = scanner_.Peek(1);
      if (digit >= '1' && digit <= '9') return BackReference(start);
      std::optional<Escape> escape = ReadEscape(&scanner_);
      if (!escape) return {};
      return escape->set == nullptr ? Character(escape->character) : Set(std::move(escape->set));
    }
    case '[': {
      CharacterSet set =
          ReadClass(&scanner_, {tree_.ignore_case, limits_.regex_nesting - depth_, &ranges_left_});
      return Set(std::make_shared<const CharacterSet>(std::move(set)));
    }
    case '(':
      return Group();
    default:
      break;
  }
  const char32_t c = scanner_.Take();
  switch (c) {
    case '.':
      return Set(dot_);
    case '^':
      return Anchor(Kind::kStart);
    case '$':
      return Anchor(Kind::kEnd);
    case '?':
    case '*':
    case '+':
      scanner_.Fail(start, Concat("the quantifier ", scanner_.Quoted(start), " has nothing to repeat"),
                    Concat("write \\", std::string(1, static_cast<char>(c)), " for the character itself"));
      return {};
    case '{':
    case '}':
    case ']':
      scanner_.Fail(start, Concat(scanner_.Quoted(start), " is not allowed here"),
                    Concat("write \\", std::string(1, static_cast<char>(c)), " for the character itself"));
      return {};
    default:
      return Character(c);
  }
}

// The hint for a construct "(?…" of other languages; `next` is the character after the '?'.
std::string HintForGroup(char32_t next) {
  switch (next) {
    case '=':
    case '!':
      return "there is no look-ahead; a FILTER can test two patterns, one of them with '!'";
    case '<':
    case 'P':
    case '\'':
      return "there is no look-behind, and groups have numbers, not names";
    case '>':
      return "there are no atomic groups";
    case '#':
      return "there are no comments";
    default:
      return "flags are the third argument of REGEX, the fourth of REPLACE, and sh:flags of a shape";
  }
}

RegexNode RegexParser::Group() {
  const size_t start = scanner_.offset();
  scanner_.Take();
  int number = 0;
  if (scanner_.Accept('?')) {
    const char32_t next = scanner_.Take();
    if (next != ':') {
      scanner_.Fail(start, Concat(scanner_.Quoted(start), " is not a group of XPath's regular expressions"),
                    HintForGroup(next));
    }
  } else {
    closed_.push_back(false);
    number = static_cast<int>(closed_.size());
  }
  if (++depth_ > limits_.regex_nesting) {
    scanner_.Fail(start, "groups are nested deeper than the limit regex_nesting = " +
                             std::to_string(limits_.regex_nesting));
  }
  if (!scanner_.ok()) return {};
  RegexNode inner = Alternatives();
  --depth_;
  if (!scanner_.Accept(')')) {
    scanner_.Fail(start, "the group that begins here is not closed", "write \\( for the parenthesis itself");
  }
  if (number == 0) return inner;
  closed_[static_cast<size_t>(number) - 1] = true;
  RegexNode node;
  node.kind = Kind::kGroup;
  node.number = number;
  node.size = 2 + inner.size;
  node.children.push_back(std::move(inner));
  return node;
}

RegexNode RegexParser::BackReference(size_t start) {
  scanner_.Take();
  RegexNode node;
  node.kind = Kind::kBackReference;
  node.number = static_cast<int>(scanner_.Take() - '0');
  // Further digits belong to the number as long as that many groups precede it.
  while (scanner_.Peek() >= '0' && scanner_.Peek() <= '9') {
    const size_t longer = static_cast<size_t>(node.number) * 10 + (scanner_.Peek() - '0');
    if (longer > closed_.size()) break;
    node.number = static_cast<int>(longer);
    scanner_.Take();
  }
  tree_.has_back_references = true;
  if (static_cast<size_t>(node.number) > closed_.size()) {
    scanner_.Fail(start, Concat(scanner_.Quoted(start), " refers to a group that is not before it"),
                  "there are " + std::to_string(closed_.size()) + " groups before it");
  } else if (!closed_[static_cast<size_t>(node.number) - 1]) {
    scanner_.Fail(start, Concat(scanner_.Quoted(start), " is inside the group that it refers to"),
                  "a back-reference comes behind the ')' of its group");
  }
  return node;
}

}  // namespace

bool MatchesEmptyText(const RegexNode& node) {
  const auto matches = [](const RegexNode& child) { return MatchesEmptyText(child); };
  switch (node.kind) {
    case Kind::kCharacter:
    case Kind::kSet:
      return false;
    case Kind::kSequence:
      return std::all_of(node.children.begin(), node.children.end(), matches);
    case Kind::kAlternatives:
      return std::any_of(node.children.begin(), node.children.end(), matches);
    case Kind::kGroup:
      return MatchesEmptyText(node.children[0]);
    case Kind::kRepeat:
      return node.least == 0 || MatchesEmptyText(node.children[0]);
    case Kind::kEmpty:
    case Kind::kStart:
    case Kind::kEnd:
    case Kind::kBackReference:  // its group matched the empty text, or did not match
      return true;
  }
  return false;
}

std::optional<RegexMistake> FindFlagMistake(std::string_view flags) {
  for (size_t at = 0; at < flags.size();) {
    const size_t start = at;
    const char32_t flag = NextCodePoint(flags, &at);
    if (flag < 128 && std::string_view("smixq").find(static_cast<char>(flag)) != std::string_view::npos)
      continue;
    return RegexMistake{Concat("'", flags.substr(start, at - start), "' is not a flag"),
                        "flags are s, m, i, x and q", RegexMistake::Where::kFlags, start, at - start};
  }
  return std::nullopt;
}

std::optional<RegexMistake> ParseRegex(std::string_view pattern, std::string_view flags, RegexTree* tree,
                                       const RegexLimits& limits) {
  *tree = RegexTree{};
  if (std::optional<RegexMistake> mistake = FindFlagMistake(flags)) return mistake;
  if (pattern.size() > limits.regex_pattern_bytes) {
    return RegexMistake{"the pattern has " + std::to_string(pattern.size()) +
                            " bytes, the limit regex_pattern_bytes is " +
                            std::to_string(limits.regex_pattern_bytes),
                        "", RegexMistake::Where::kPattern, 0, 1};
  }
  const auto has = [flags](char flag) { return flags.find(flag) != std::string_view::npos; };
  tree->multi_line = has('m');
  tree->ignore_case = has('i');
  tree->literal = has('q');
  RegexParser parser(pattern, flags, limits, tree);
  return tree->literal ? parser.ReadLiteral() : parser.Read();
}

}  // namespace docent::sparql
