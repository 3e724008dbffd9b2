// Classes of equal things: a partition of the terms that owl:sameAs connects.
//
// Equality is written out: the graph holds every pair of a class and every fact under all names of its terms. This
// partition says which terms those are, so that the pairs of a class of n are written once each, n² of them, and not
// joined n³ times by the rules eq-sym, eq-trans and eq-rep-* (equality_rules.h).
//
// A class is a sequence of blocks: the classes that it was joined from since the last Settle. Of facts that the graph
// held at that time under one name of a block it held all names.
// A literal has no equals of its own, since no triple has a literal as its subject: it is one more name of a class in the
// place of an object.
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

  // a owl:sameAs b. False: that was known. `a` is no literal.
  bool Join(TermId a, TermId b);
  // The class of a term; null: it is equal to nothing else. Good until the next change.
  const Class* Find(TermId term) const;
  bool AreEqual(TermId a, TermId b) const;
  // The representatives of the classes that have the literal as a name.
  std::vector<TermId> ClassesNamed(TermId literal) const;
  bool IsName(TermId literal) const { return named_.contains(literal); }
  // The representative of the class; a term without one stands for itself.
  TermId Representative(TermId term) const;
  // Representatives of the classes that were joined since the last Settle, each once.
  std::vector<TermId> Joined() const;
  // Each class is one block: the graph holds all that follows.
  void Settle();
  // Each term of the class of `member` is a block of its own.
  void Unsettle(TermId member);
  // Takes the class of `member` apart: its terms are equal to nothing.
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
  // Grows with every change.
  uint64_t changes() const { return changes_; }

 private:
  uint32_t ClassOf(TermId term);  // a new one where there is none
  bool AddLiteral(uint32_t to, TermId literal);
  void DropLiterals(uint32_t from);

  absl::flat_hash_map<TermId, uint32_t> class_of_;            // of members
  absl::flat_hash_map<TermId, std::vector<uint32_t>> named_;  // by literal: classes with that name
  std::vector<Class> classes_;                                // an empty one: free
  std::vector<uint32_t> free_;
  std::vector<uint32_t> unsettled_;
  uint64_t changes_ = 0;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_EQUALITY_CLASSES_H_
