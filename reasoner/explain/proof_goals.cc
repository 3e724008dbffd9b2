// Search for any proof of a fact, where the search for one of minimum depth takes too long.
//
// Goals and ways form an and-or graph: a fact is proven once one of its ways is, a way once all its premises
// are. The graph grows from the fact in question, depth first; proofs spread from the asserted facts upward
// (Dowling and Gallier, Linear-time algorithms for testing the satisfiability of propositional Horn formulae,
// J. Logic Programming 1984). So no fact rests on itself, and no fact is looked at twice.
#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "graph/base/proof_limits.h"
#include "reasoner/explain/proof.h"

namespace docent::explain {
namespace {

constexpr size_t kWaysAtFirst = 256;  // of one goal; more are looked at if these lead nowhere
constexpr size_t kMoreWays = 8;       // times as many
constexpr size_t kMany = 8;           // ways: the one in the middle first

}  // namespace

class Prover::Goals {
 public:
  Goals(Prover& prover, const Quad& root) : prover_(prover), root_(root) {}

  // OK also if there is no proof: the fact is made by rules that are not known here.
  absl::Status Run() {
    stack_.push_back({root_, root_});
    while (!IsProven(root_)) {
      if (stack_.empty() && !Reopen()) return absl::OkStatus();
      const Open open = stack_.back();
      stack_.pop_back();
      if (IsProven(open.fact) || IsProven(open.user)) continue;
      if (absl::Status status = Expand(open.fact); !status.ok()) return status;
      if (prover_.solver().exhausted()) {
        return absl::ResourceExhaustedError(absl::StrCat(
            "the search for a proof took more than proof_steps = ", kProofLimits.proof_steps, " steps"));
      }
    }
    return absl::OkStatus();
  }

 private:
  // A fact to be proven, for the sake of another one.
  struct Open {
    Quad fact, user;
  };
  struct Way {
    Quad head;
    size_t derivation;  // of Known::derivations
    size_t open;        // premises that are not proven
  };
  struct Goal {
    std::vector<size_t> users;  // ways
    size_t looked = 0;          // ways that were looked for; 0: it was not opened
    bool more = false;          // there may be others
  };

  bool IsProven(const Quad& fact) { return prover_.KnownOf(fact).proven >= 0; }
  bool AreProven(const std::vector<Quad>& facts) {
    return std::all_of(facts.begin(), facts.end(), [this](const Quad& fact) { return IsProven(fact); });
  }

  // Looks for more ways of all goals that may have them.
  bool Reopen() {
    for (const auto& [fact, goal] : goals_) {
      if (goal.more && !IsProven(fact)) stack_.push_back({fact, fact});
    }
    return !stack_.empty();
  }

  absl::Status Expand(const Quad& fact) {
    Goal& goal = goals_[fact];
    if (goal.looked > 0 && !goal.more) return absl::OkStatus();
    Known& known = prover_.KnownOf(fact);
    const bool known_before = goal.looked == 0 && known.derived;  // by the search for the shortest
    const size_t first = known_before ? 0 : known.derivations.size();
    goal.looked = goal.looked == 0 ? kWaysAtFirst : goal.looked * kMoreWays;
    if (known_before) {
      goal.looked = std::max(goal.looked, known.derivations.size());
      goal.more = known.derivations.size() >= kDerivationsLooked;
    } else {
      const size_t most = goal.looked;
      std::vector<Derivation> found;
      const auto enough = [&](const std::vector<Derivation>& so_far) {
        if (so_far.size() >= most) return true;
        return !so_far.empty() && so_far.back().row.clause->parts.empty() && AreProven(so_far.back().facts);
      };
      if (absl::Status status = prover_.Derive(fact, enough, found); !status.ok()) return status;
      goal.more = found.size() >= most;
      std::move(found.begin(), found.end(), std::back_inserter(known.derivations));
    }
    AddWays(fact, first, known);
    return absl::OkStatus();
  }

  void AddWays(const Quad& fact, size_t first, const Known& known) {
    std::vector<size_t> added;
    for (size_t i = first; i < known.derivations.size() && known.proven < 0; ++i) {
      const std::vector<Quad>& premises = known.derivations[i].facts;
      const size_t number = ways_.size();
      Way& way = ways_.emplace_back(Way{fact, i, 0});
      for (const Quad& premise : premises) {
        if (IsProven(premise)) continue;
        ++way.open;
        goals_[premise].users.push_back(number);
      }
      if (way.open == 0) return Prove(number);
      added.push_back(number);
    }
    // The one to be tried first is pushed last. With many, as a transitive property has, the one in the middle: it
    // halves what is left to be proven.
    std::stable_sort(added.begin(), added.end(),
                     [this](size_t a, size_t b) { return ways_[a].open < ways_[b].open; });
    if (added.size() >= kMany) std::swap(added.front(), added[MiddleOf(added)]);
    for (auto way = added.rbegin(); way != added.rend(); ++way) {
      const std::vector<Quad>& premises = known.derivations[ways_[*way].derivation].facts;
      for (auto premise = premises.rbegin(); premise != premises.rend(); ++premise) {
        if (!IsProven(*premise) && goals_[*premise].looked == 0) stack_.push_back({*premise, fact});
      }
    }
  }

  // The place of the way in the middle, in the order in which they were found.
  static size_t MiddleOf(const std::vector<size_t>& ways) {
    std::vector<size_t> places(ways.size());
    for (size_t i = 0; i < places.size(); ++i) places[i] = i;
    const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
    std::nth_element(places.begin(), middle, places.end(),
                     [&ways](size_t a, size_t b) { return ways[a] < ways[b]; });
    return *middle;
  }

  // The way is proven, with all that follows from it.
  void Prove(size_t number) {
    std::vector<size_t> done = {number};
    while (!done.empty()) {
      const Way way = ways_[done.back()];
      done.pop_back();
      Known& known = prover_.KnownOf(way.head);
      if (known.proven >= 0) continue;
      int deepest = 0;
      for (const Quad& premise : known.derivations[way.derivation].facts)
        deepest = std::max(deepest, prover_.KnownOf(premise).proven);
      known.proven = deepest + 1;
      known.best = way.derivation;
      for (const size_t user : goals_[way.head].users) {
        if (--ways_[user].open == 0) done.push_back(user);
      }
    }
  }

  Prover& prover_;
  const Quad root_;
  absl::flat_hash_map<Quad, Goal> goals_;
  std::vector<Way> ways_;
  std::vector<Open> stack_;
};

absl::Status Prover::ProveByGoals(const Quad& fact) {
  of_goals_ =
      std::make_unique<Solver>(*seen_by_rules_, dictionary_, functions_, rule_run_, kProofLimits.proof_steps);
  return Goals(*this, fact).Run();
}

}  // namespace docent::explain
