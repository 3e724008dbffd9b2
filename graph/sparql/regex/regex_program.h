// Program of a regular expression for our own matcher: one instruction for a character or a class of any size. Private to
// this folder. Values; any thread reads.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_

#include <cstdint>
#include <vector>

#include "graph/sparql/regex/regex_tree.h"

namespace docent::sparql {

struct RegexInstruction {
  enum class Kind : uint8_t {
    kCharacter,  // the next character is `character`; then the instruction behind this one, as where nothing is said
    kSet,    // it is in `set`
    kStart,  // ^
    kEnd,    // $
    kSplit,  // goes on at `next`; if that fails, at `other`. `number`: of this split
    kJump,   // goes on at `next`
    kSave,   // keeps the place as capture `number`: 2n where group n begins, 2n+1 where it ends
    kMark,   // keeps the place where a round of a loop begins, as mark `number`
    kLeaveIfEmpty,  // goes on at `next` where the round of mark `number` has matched nothing, which would go on for ever
    kBackReference,  // what group `number` matched comes again
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
  bool only_at_start = false;  // it begins with ^, of the whole text
};

// The tree must outlive the program.
RegexProgram CompileRegexProgram(const RegexTree& tree);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_PROGRAM_H_
