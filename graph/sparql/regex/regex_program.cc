#include "graph/sparql/regex/regex_program.h"

namespace docent::sparql {
namespace {

using Op = RegexInstruction::Kind;
using Kind = RegexNode::Kind;

class Compiler {
 public:
  explicit Compiler(const RegexTree& tree) : tree_(tree) {}
  RegexProgram Compile();

 private:
  int here() const { return static_cast<int>(program_.instructions.size()); }
  RegexInstruction& At(int place) { return program_.instructions[static_cast<size_t>(place)]; }
  // Appends an instruction and returns its place.
  int Emit(Op kind, int number = 0);
  int EmitSplit() { return Emit(Op::kSplit, program_.splits++); }
  // Sets the targets of the split at `place`: `body` first if greedy, else `exit` first.
  void Aim(int place, bool greedy, int body, int exit);
  void Append(const RegexNode& node);
  void AppendAlternatives(const RegexNode& node);
  void AppendRepeat(const RegexNode& node);
  void AppendLoop(const RegexNode& body, bool greedy);

  const RegexTree& tree_;
  RegexProgram program_;
};

int Compiler::Emit(Op kind, int number) {
  RegexInstruction instruction;
  instruction.kind = kind;
  instruction.number = number;
  program_.instructions.push_back(instruction);
  return here() - 1;
}

void Compiler::Aim(int place, bool greedy, int body, int exit) {
  At(place).next = greedy ? body : exit;
  At(place).other = greedy ? exit : body;
}

void Compiler::AppendAlternatives(const RegexNode& node) {
  std::vector<int> ends;
  for (size_t i = 0; i < node.children.size(); ++i) {
    const bool last = i + 1 == node.children.size();
    const int split = last ? -1 : EmitSplit();
    Append(node.children[i]);
    if (last) break;
    ends.push_back(Emit(Op::kJump));
    Aim(split, true, split + 1, here());
  }
  for (const int end : ends) At(end).next = here();
}

// body*. An empty round ends the loop; needed only with back-references, since without them no split is tried
// twice at one place.
void Compiler::AppendLoop(const RegexNode& body, bool greedy) {
  const bool guarded = tree_.has_back_references && MatchesEmptyText(body);
  const int split = EmitSplit();
  const int mark = guarded ? Emit(Op::kMark, program_.marks++) : -1;
  Append(body);
  const int leave = guarded ? Emit(Op::kLeaveIfEmpty, At(mark).number) : -1;
  At(Emit(Op::kJump)).next = split;
  Aim(split, greedy, split + 1, here());
  if (guarded) At(leave).next = here();
}

void Compiler::AppendRepeat(const RegexNode& node) {
  const RegexNode& body = node.children[0];
  for (uint64_t i = 0; i < node.least; ++i) Append(body);
  if (node.most == RegexNode::kNoMost) return AppendLoop(body, node.greedy);
  std::vector<int> splits;
  for (uint64_t i = node.least; i < node.most; ++i) {
    splits.push_back(EmitSplit());
    Append(body);
  }
  for (const int split : splits) Aim(split, node.greedy, split + 1, here());
}

void Compiler::Append(const RegexNode& node) {
  switch (node.kind) {
    case Kind::kEmpty:
      break;
    case Kind::kCharacter:
      At(Emit(Op::kCharacter)).character = node.character;
      break;
    case Kind::kSet:
      At(Emit(Op::kSet)).set = node.set.get();
      break;
    case Kind::kStart:
      Emit(Op::kStart);
      break;
    case Kind::kEnd:
      Emit(Op::kEnd);
      break;
    case Kind::kSequence:
      for (const RegexNode& child : node.children) Append(child);
      break;
    case Kind::kAlternatives:
      AppendAlternatives(node);
      break;
    case Kind::kGroup:
      Emit(Op::kSave, 2 * node.number);
      Append(node.children[0]);
      Emit(Op::kSave, 2 * node.number + 1);
      break;
    case Kind::kRepeat:
      AppendRepeat(node);
      break;
    case Kind::kBackReference:
      Emit(Op::kBackReference, node.number);
      break;
  }
}

RegexProgram Compiler::Compile() {
  program_.groups = tree_.groups;
  program_.multi_line = tree_.multi_line;
  program_.ignore_case = tree_.ignore_case;
  program_.has_back_references = tree_.has_back_references;
  program_.matches_empty_text = MatchesEmptyText(tree_.root);
  Append(tree_.root);
  Emit(Op::kMatch);
  program_.only_at_start = !tree_.multi_line && At(0).kind == Op::kStart;
  return std::move(program_);
}

}  // namespace

RegexProgram CompileRegexProgram(const RegexTree& tree) {
  return Compiler(tree).Compile();
}

}  // namespace docent::sparql
