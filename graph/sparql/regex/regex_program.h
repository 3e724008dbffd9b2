// Program of a regular expression for our own matcher, with one instruction for a character or a class of any
// size. Private to this folder. Values; any thread reads.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_

#include <cstdint>
#include <vector>

#include "graph/sparql/regex/regex_tree.h"

namespace docent::sparql {

struct RegexInstruction {
  enum class Kind : uint8_t {
    kCharacter,      // the next character is `character`; then, as after most instructions, the following one
    kSet,            // the next character is in `set`
    kStart,          // ^
    kEnd,            // $
    kSplit,          // continues at `next`; if that fails, at `other`. `number`: of this split
    kJump,           // continues at `next`
    kSave,           // stores the place as capture `number`: 2n at the begin of group n, 2n+1 at its end
    kMark,           // stores the place where a round of a loop begins, as mark `number`
    kLeaveIfEmpty,   // continues at `next` if the round of mark `number` was empty, to avoid an endless loop
    kBackReference,  // matches the text of group `number` again
    kMatch,
  };
  Kind kind = Kind::kMatch;
  char32_t character = 0;
  int next = 0;
  int other = 0;
  int number = 0;
  const CharacterSet* set = nullptr;  // of the tree
};

struct RegexProgram {
  std::vector<RegexInstruction> instructions;
  int groups = 0;
  int splits = 0;
  int marks = 0;
  bool multi_line = false;
  bool ignore_case = false;
  bool has_back_references = false;
  bool matches_empty_text = false;
  bool only_at_start = false;  // it begins with ^ that stands for the start of the whole text
};

// The tree must outlive the program.
RegexProgram CompileRegexProgram(const RegexTree& tree);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_
