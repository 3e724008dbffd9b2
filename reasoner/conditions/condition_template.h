// Template of many conditions that differ only in constants: ASK { ?v ex:carries ?i . ?i ex:ownedBy ex:owner1
// }, … ex:owner2, …
//
// A change that matches a pattern with such a constant finds its condition by hash. A change that matches a
// pattern without one (?v ex:carries ?i) concerns all conditions: the template watches that pattern once and
// joins it once with the constants open; the solutions then name the waiting conditions. The cost depends on
// the solutions, not on the number of conditions. Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_CONDITIONS_CONDITION_TEMPLATE_H_
#define DOCENT_REASONER_CONDITIONS_CONDITION_TEMPLATE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/conditions/condition_kind.h"
#include "reasoner/conditions/watch_indexes.h"
#include "reasoner/matching/body.h"

namespace docent::conditions {

// A query as a template. Constants that are subjects or objects of the patterns that every solution matches
// become variables, there and inside EXISTS. Objects of rdf:type stay: different classes make different
// templates.
struct TemplateForm {
  sparql::Query shared;
  std::vector<std::string> parameters;  // the new variables, and
  std::vector<Term> constants;          // their constants in this query
};
// nullopt: there is no such constant.
std::optional<TemplateForm> SplitConstants(const sparql::Query& query);

class ConditionTemplate {
 public:
  using Constants = absl::InlinedVector<TermId, 2>;

  // `form`, with the columns of all members in the order of `member`. nullptr: the conditions would share
  // nothing. `number`: its number in references, with kIsTemplate.
  static absl::StatusOr<std::unique_ptr<ConditionTemplate>> Make(uint32_t number, const TemplateForm& form,
                                                                 const matching::Body& member,
                                                                 WatchIndexes& indexes,
                                                                 Dictionary& dictionary,
                                                                 const sparql::FunctionRegistry* functions);
  ~ConditionTemplate();
  ConditionTemplate(const ConditionTemplate&) = delete;
  ConditionTemplate& operator=(const ConditionTemplate&) = delete;

  // True if members need no body of their own, because this body with their constants is the same. The
  // columns of such members are the template's.
  bool lends_body() const { return lends_body_; }
  matching::Body& body() { return *body_; }
  // The kind of the members that borrow the body and have these keys.
  ConditionKind& KindWith(const ConditionKind::Keys& keys);
  // The template's columns, in the column order of a member with a body of its own.
  const std::vector<int16_t>& columns() const { return columns_; }

  // True if the template watches this trigger (any trigger) for its members.
  bool SharesAny() const { return shares_any_; }
  bool Shares(size_t trigger) const { return shared_[trigger]; }

  // Adds a condition that waits for a solution with these constants. With the first one the template starts
  // to watch.
  void Join(uint32_t condition, const Constants& constants);
  void Leave(uint32_t condition, const Constants& constants);
  size_t waiting() const { return waiting_; }
  std::vector<uint32_t> Waiting() const;

  // Calls `visit` with each solution that `quad` gives through `trigger` and each condition that waits for
  // it; the row has the template's columns. False: there are many more solutions than members, so probing the
  // members is cheaper. Without a quad: all solutions.
  using Visitor = absl::FunctionRef<void(uint32_t condition, absl::Span<const TermId> row)>;
  absl::StatusOr<bool> Probe(uint32_t trigger, const Quad* quad, bool added, const sparql::RunOptions& run,
                             Visitor visit);

  // For use by the caller: the changes of this update that matched its watches; 0 at first.
  int& RisesIn(uint64_t update) {
    if (std::exchange(rises_in_, update) != update) rises_ = 0;
    return rises_;
  }

 private:
  ConditionTemplate(uint32_t number, std::unique_ptr<matching::Body> body, WatchIndexes& indexes);
  void Watch();
  void Unwatch();
  bool IsSame(const matching::Body& member, const Constants& constants) const;

  const uint32_t number_;
  const std::unique_ptr<matching::Body> body_;
  const bool all_certain_;  // columns of body_
  WatchIndexes& indexes_;
  std::vector<int16_t> parameters_;  // columns of body_
  std::vector<int16_t> columns_;     // of body_, one for each column of a member
  std::vector<bool> shared_;         // by trigger
  absl::flat_hash_map<Constants, absl::InlinedVector<uint32_t, 1>> members_;
  size_t waiting_ = 0;
  bool lends_body_ = false;
  bool shares_any_ = false;
  uint64_t rises_in_ = 0;
  int rises_ = 0;
  std::vector<WatchIndexes::Watch> watches_;
  std::vector<std::unique_ptr<ConditionKind>> kinds_;  // of borrowers
  std::vector<TermId> seed_;                           // scratch
  Constants found_;                                    // scratch
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_CONDITION_TEMPLATE_H_
