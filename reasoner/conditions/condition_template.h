// Many conditions that differ only in constants: ASK { ?v ex:carries ?i . ?i ex:ownedBy ex:owner1 }, …
// ex:owner2, …
//
// A change that matches a pattern with such a constant finds its condition by hash. A change that matches a
// pattern without one (?v ex:carries ?i) concerns them all: the template watches it once, joins it once with the
// constants left open, and the solutions say which of the waiting conditions they are for. The cost is that
// of the solutions, not of the conditions. Private to this folder. Writer thread only.
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

// A query as a template: constants that are subjects or objects of the patterns that every solution matches are
// variables, there and inside EXISTS. Objects of rdf:type stay: classes make another template.
struct TemplateForm {
  sparql::Query shared;
  std::vector<std::string> parameters;  // the variables, and
  std::vector<Term> constants;          // what they stand for
};
// nullopt: there is no such constant.
std::optional<TemplateForm> SplitConstants(const sparql::Query& query);

class ConditionTemplate {
 public:
  using Constants = absl::InlinedVector<TermId, 2>;

  // `form` with all its members' columns in the order of `member`. nullptr: nothing would be shared. `number`
  // is what references call it, with kIsTemplate.
  static absl::StatusOr<std::unique_ptr<ConditionTemplate>> Make(uint32_t number, const TemplateForm& form,
                                                                 const matching::Body& member,
                                                                 WatchIndexes& indexes,
                                                                 Dictionary& dictionary,
                                                                 const sparql::FunctionRegistry* functions);
  ~ConditionTemplate();
  ConditionTemplate(const ConditionTemplate&) = delete;
  ConditionTemplate& operator=(const ConditionTemplate&) = delete;

  // Whether members need no body of their own: this one with their constants in it is the same. Such a member's
  // columns are the template's.
  bool lends_body() const { return lends_body_; }
  matching::Body& body() { return *body_; }
  // Of members that borrow the body and have these keys.
  ConditionKind& KindWith(const ConditionKind::Keys& keys);
  // The template's columns in the order of those of a member with a body of its own.
  const std::vector<int16_t>& columns() const { return columns_; }

  // Whether the template watches this trigger for its members, or any.
  bool SharesAny() const { return shares_any_; }
  bool Shares(size_t trigger) const { return shared_[trigger]; }

  // The condition waits for a solution with these constants. The first that comes makes the template watch.
  void Join(uint32_t condition, const Constants& constants);
  void Leave(uint32_t condition, const Constants& constants);
  size_t waiting() const { return waiting_; }
  std::vector<uint32_t> Waiting() const;

  // Calls `visit` with each solution that `quad` gives through `trigger` and the conditions that wait for it,
  // the row in the template's columns. False: there are many more solutions than members, it is
  // cheaper to ask them. No quad: all solutions.
  using Visitor = absl::FunctionRef<void(uint32_t condition, absl::Span<const TermId> row)>;
  absl::StatusOr<bool> Probe(uint32_t trigger, const Quad* quad, bool added, const sparql::RunOptions& run,
                             Visitor visit);

  // For the caller's own use: the changes of this update that its watches matched; 0 at first.
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
  std::vector<int16_t> columns_;     // of body_, for each of a member's
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
