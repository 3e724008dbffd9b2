// Equality classes: a partition of the terms that owl:sameAs connects.
//
// Equality is written out: the graph holds every pair of a class and every fact under all names of its terms.
// With this partition the n² pairs of a class of n terms are written once each, instead of n³ joins by the
// rules eq-sym, eq-trans and eq-rep-* (equality_rules.h).
//
// A class is a sequence of blocks: the classes from which it was joined since the last Settle. If the graph
// held a fact under one name of a block at that time, it held the fact under all names of the block. A
// literal has no class of its own, since no triple has a literal as its subject: it is a further name of a
// class in the position of an object.
// Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_RULES_EQUALITY_CLASSES_H_
#define DOCENT_REASONER_RULES_EQUALITY_CLASSES_H_

#include <cstdint>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/types/span.h"
#include "graph/rdf/term_id.h"

namespace docent::rules {

class EqualityClasses {
 public:
  struct Class {
    std::vector<TermId> members;   // IRIs and blank nodes; the first stands for the class
    std::vector<TermId> literals;  // sorted
    std::vector<size_t> blocks;    // where each block of members begins, the first at 0

    TermId representative() const { return members[0]; }
    absl::Span<const TermId> block(size_t i) const {
      const size_t end = i + 1 < blocks.size() ? blocks[i + 1] : members.size();
      return absl::MakeConstSpan(members).subspan(blocks[i], end - blocks[i]);
    }
  };

  // Records a owl:sameAs b. False: it was known. `a` is no literal.
  bool Join(TermId a, TermId b);
  // The class of a term; null: it equals no other term. Valid until the next change.
  const Class* Find(TermId term) const;
  bool AreEqual(TermId a, TermId b) const;
  // The representatives of the classes that have the literal as a name.
  std::vector<TermId> ClassesNamed(TermId literal) const;
  bool IsName(TermId literal) const { return named_.contains(literal); }
  // The representative of the term's class; a term without a class represents itself.
  TermId Representative(TermId term) const;
  // Representatives of the classes that were joined since the last Settle, each once.
  std::vector<TermId> Joined() const;
  // Makes each class one block: the graph now holds all consequences.
  void Settle();
  // Makes each term of the class of `member` a block of its own.
  void Unsettle(TermId member);
  // Dissolves the class of `member`: its terms equal nothing else.
  void Dissolve(TermId member);
  void Clear();
  bool empty() const { return class_of_.empty(); }

  // Calls `visit(class)` for each. O(terms).
  template <typename Visit>
  void ForEach(Visit visit) const {
    for (const Class& each : classes_) {
      if (!each.members.empty()) visit(each);
    }
  }
  // Increases with every change.
  uint64_t changes() const { return changes_; }

 private:
  uint32_t ClassOf(TermId term);  // created if there is none
  bool AddLiteral(uint32_t to, TermId literal);
  void DropLiterals(uint32_t from);

  absl::flat_hash_map<TermId, uint32_t> class_of_;            // of members
  absl::flat_hash_map<TermId, std::vector<uint32_t>> named_;  // by literal: classes with that name
  std::vector<Class> classes_;                                // empty: free
  std::vector<uint32_t> free_;
  std::vector<uint32_t> unsettled_;
  uint64_t changes_ = 0;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_EQUALITY_CLASSES_H_
