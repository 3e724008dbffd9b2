#include "graph/sparql/regex/class_parser.h"

#include <string>
#include <utility>

#include "graph/base/text.h"
#include "graph/sparql/regex/escape_parser.h"

namespace docent::sparql {
namespace {

using Range = CharacterSet::Range;

constexpr char32_t kNone = PatternScanner::kNone;

class ClassParser {
 public:
  ClassParser(PatternScanner* scanner, const ClassOptions& options) : scanner_(*scanner), options_(options) {}

  CharacterSet Read();

 private:
  // One charGroupPart: a character, a range, or an escape of a set.
  void Part();
  // The end of a range, after the hyphen.
  std::optional<char32_t> RangeEnd();
  CharacterSet Subtracted();
  bool Count(size_t ranges);
  // True if the next hyphen makes a range with the character before it (the rules of G.4.1).
  bool HyphenMakesRange() const {
    const char32_t next = scanner_.Peek(1);
    return next != '[' && next != ']' && next != kNone && !(next == '-' && scanner_.Peek(2) == '[');
  }

  PatternScanner& scanner_;
  const ClassOptions& options_;
  std::vector<Range> characters_;  // flag i adds the case variants of these
  std::vector<Range> sets_;        // from escapes; flag i leaves them unchanged
};

bool ClassParser::Count(size_t ranges) {
  const bool enough = ranges <= *options_.ranges_left;
  *options_.ranges_left -= enough ? ranges : 0;
  if (!enough) {
    scanner_.Fail(
        scanner_.offset(),
        "the classes of this pattern have more ranges of characters than the limit regex_ranges = " +
            std::to_string(RegexLimits{}.regex_ranges));
  }
  return enough;
}

std::optional<char32_t> ClassParser::RangeEnd() {
  const size_t start = scanner_.offset();
  if (scanner_.Peek() == '\\') {
    const std::optional<Escape> escape = ReadEscape(&scanner_);
    if (!escape) return std::nullopt;
    if (escape->set == nullptr) return escape->character;
    scanner_.Fail(start, Concat("a range cannot end with ", scanner_.Quoted(start)),
                  "a hyphen that is meant as itself is written \\-");
    return std::nullopt;
  }
  const char32_t c = scanner_.Take();
  if (c != '-') return c;
  scanner_.Fail(start, "a hyphen cannot end a range", "write \\- for the hyphen itself");
  return std::nullopt;
}

void ClassParser::Part() {
  const size_t start = scanner_.offset();
  char32_t first = 0;
  bool plain_hyphen = false;
  if (scanner_.Peek() == '\\') {
    const std::optional<Escape> escape = ReadEscape(&scanner_);
    if (!escape) return;
    if (escape->set != nullptr) {
      const std::vector<Range>& ranges = escape->set->ranges();
      if (Count(ranges.size())) sets_.insert(sets_.end(), ranges.begin(), ranges.end());
      return;
    }
    first = escape->character;
  } else {
    first = scanner_.Take();
    plain_hyphen = first == '-';
  }
  if (!Count(1)) return;
  if (scanner_.Peek() != '-' || !HyphenMakesRange()) return characters_.push_back({first, first});
  scanner_.Take();
  if (plain_hyphen) {
    return scanner_.Fail(start, "a hyphen cannot begin a range", "write \\- for the hyphen itself");
  }
  const std::optional<char32_t> last = RangeEnd();
  if (!last) return;
  if (*last < first) {
    return scanner_.Fail(start,
                         Concat("the range ", scanner_.Quoted(start), " has its ends in the wrong order"),
                         "the character with the smaller number comes first");
  }
  characters_.push_back({first, *last});
}

CharacterSet ClassParser::Subtracted() {
  scanner_.Take();
  ClassOptions inner = options_;
  --inner.nesting;
  CharacterSet set = ReadClass(&scanner_, inner);
  if (scanner_.ok() && scanner_.Peek() != ']') {
    scanner_.Fail(scanner_.offset(), "expected ']' behind the class that is subtracted",
                  "write the subtracted class last: [a-z-[aeiou]]");
  }
  scanner_.Take();
  return set;
}

CharacterSet ClassParser::Read() {
  const size_t start = scanner_.offset();
  scanner_.Take();
  if (options_.nesting <= 0) {
    scanner_.Fail(start, "classes are nested deeper than the limit regex_nesting = " +
                             std::to_string(RegexLimits{}.regex_nesting));
    return {};
  }
  const bool negative = scanner_.Accept('^');
  CharacterSet subtracted;
  bool any = false, closed = false;
  while (scanner_.ok() && !closed) {
    const char32_t c = scanner_.Peek();
    if (c == kNone) {
      scanner_.Fail(start, "the class that begins here is not closed", "a class ends with ']'");
    } else if (c == ']') {
      scanner_.Take();
      closed = true;
      if (!any) scanner_.Fail(start, "the class is empty", "write \\] for the bracket itself");
    } else if (c == '[') {
      const bool posix = scanner_.Peek(1) == ':';
      scanner_.Fail(scanner_.offset(), "'[' inside a class",
                    posix ? "there are no POSIX classes; write \\p{L} for letters, \\p{Nd} for digits, \\s "
                            "for white space"
                          : "write \\[ for the bracket itself; a class is subtracted with -[…] at the end");
    } else if (any && c == '-' && scanner_.Peek(1) == '[') {
      subtracted = Subtracted();
      closed = true;
    } else {
      Part();
      any = true;
    }
  }
  if (!scanner_.ok()) return {};
  CharacterSet set = CharacterSet::Of(std::move(characters_));
  if (options_.ignore_case) set = WithCaseVariants(set);
  if (!sets_.empty()) {
    sets_.insert(sets_.end(), set.ranges().begin(), set.ranges().end());
    set = CharacterSet::Of(std::move(sets_));
  }
  if (negative) set = set.Complement();
  return subtracted.ranges().empty() ? set : set.Minus(subtracted);
}

}  // namespace

CharacterSet ReadClass(PatternScanner* scanner, const ClassOptions& options) {
  return ClassParser(scanner, options).Read();
}

}  // namespace docent::sparql
