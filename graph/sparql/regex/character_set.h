// Set of Unicode characters as sorted ranges: the matches of a character class of a regular expression. It
// never contains surrogates. Values; any thread reads.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_CHARACTER_SET_H_
#define DOCENT_GRAPH_SPARQL_REGEX_CHARACTER_SET_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace docent::sparql {

class CharacterSet {
 public:
  struct Range {  // inclusive at both ends
    char32_t first;
    char32_t last;
    friend bool operator==(const Range&, const Range&) = default;
  };

  CharacterSet() = default;  // empty
  // The union of `ranges`, which may overlap and be in any order.
  static CharacterSet Of(std::vector<Range> ranges);

  bool Contains(char32_t c) const { return c < 128 ? (ascii_[c >> 6] >> (c & 63)) & 1 : ContainsLarge(c); }
  // All other characters.
  CharacterSet Complement() const;
  CharacterSet Minus(const CharacterSet& other) const;
  // Sorted; neither overlapping nor adjacent.
  const std::vector<Range>& ranges() const { return ranges_; }

  friend bool operator==(const CharacterSet& a, const CharacterSet& b) { return a.ranges_ == b.ranges_; }

 private:
  bool ContainsLarge(char32_t c) const;

  std::vector<Range> ranges_;
  uint64_t ascii_[2] = {0, 0};
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_CHARACTER_SET_H_
