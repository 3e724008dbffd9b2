// Syntax tree of a regular expression, made by the parser. Values; any thread reads.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_TREE_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_TREE_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "graph/sparql/regex/character_set.h"

namespace docent::sparql {

struct RegexNode {
  enum class Kind : uint8_t {
    kEmpty,          //                nothing: the expression "", a branch of (a|)
    kCharacter,      // a              character
    kSet,            // [a-z-[aeiou]] \d . ; or `a` with its case variants under flag i
    kStart,          // ^
    kEnd,            // $
    kSequence,       // ab             children, two or more
    kAlternatives,   // a|b            children, two or more
    kGroup,          // (a)            children[0]; number. (?:a) is its child alone
    kRepeat,         // a{2,3}? a* a+  children[0]; least, most, greedy
    kBackReference,  // \1             number
  };
  static constexpr uint64_t kNoMost = UINT64_MAX;

  Kind kind = Kind::kEmpty;
  bool greedy = true;
  char32_t character = 0;
  int number = 0;  // of a group, from 1
  uint64_t least = 0;
  uint64_t most = kNoMost;
  uint64_t size = 1;  // number of its instructions as RegexLimits counts them, with those of its children
  std::shared_ptr<const CharacterSet> set;
  std::vector<RegexNode> children;
};

struct RegexTree {
  RegexNode root;
  int groups = 0;
  bool multi_line = false;   // flag m: ^ and $ are of lines
  bool ignore_case = false;  // flag i; the sets already include the variants; needed for back-references
  bool literal = false;      // flag q
  bool has_anchors = false;
  bool has_back_references = false;
};

// True if the expression matches the empty string.
bool MatchesEmptyText(const RegexNode& node);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_TREE_H_
