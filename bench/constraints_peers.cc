#include "bench/constraints_peers.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/constraint_pairs.h"
#include "bench/peer_process.h"

namespace docent::bench {
namespace {

constexpr int kTimeoutSeconds = 120;

// One rule for each shape, with the constraints as facts (cj, cn, cf): CLIPS takes minutes to build a rule
// for each constraint. The patterns are in the cheapest order for an update. Each firing is counted, so that
// none is left out.
constexpr char kClips[] = R"clp(
(defglobal ?*fired* = 0)
(deftemplate at (slot v) (slot r))
(deftemplate wants (slot v) (slot t))
(deftemplate badge (slot v) (slot b))
(deftemplate carries (slot v) (slot i))
(deftemplate owned (slot i) (slot o))
(deftemplate other (slot v) (slot t))
(deftemplate cj (slot r) (slot t))
(deftemplate cn (slot v))
(deftemplate cf (slot o))
(defrule join (wants (v ?v) (t ?t)) (at (v ?v) (r ?r)) (cj (t ?t) (r ?r)) => (bind ?*fired* (+ ?*fired* 1)))
(defrule negated (cn (v ?v)) (at (v ?v)) (not (badge (v ?v))) => (bind ?*fired* (+ ?*fired* 1)))
(defrule free (carries (v ?v) (i ?i)) (owned (i ?i) (o ?o)) (cf (o ?o)) => (bind ?*fired* (+ ?*fired* 1)))
(deffunction join (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (wants (v (sym-cat v (+ (* (random 0 63) 64) (mod ?i 64)))) (t (sym-cat t ?i)))))
  (run) (retract ?f) (run))
(deffunction negated (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (badge (v (sym-cat p ?i)) (b (sym-cat b ?k))))) (run) (retract ?f) (run))
(deffunction free (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (carries (v (sym-cat c ?k)) (i (sym-cat i ?i))))) (run) (retract ?f) (run))
(deffunction base-join (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (other (v (sym-cat v (+ (* (random 0 63) 64) (mod ?i 64)))) (t (sym-cat t ?i)))))
  (run) (retract ?f) (run))
(deffunction base-negated (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (other (v (sym-cat p ?i)) (t (sym-cat b ?k))))) (run) (retract ?f) (run))
(deffunction base-free (?n ?k) (bind ?i (random 0 (- ?n 1)))
  (bind ?f (assert (other (v (sym-cat c ?k)) (t (sym-cat i ?i))))) (run) (retract ?f) (run))
(deffunction seconds (?f ?n ?from ?pairs) (bind ?start (time))
  (loop-for-count (?k 1 ?pairs) do (funcall ?f ?n (+ ?from ?k)))
  (- (time) ?start))
(deffunction compared (?f ?base ?n ?blocks ?pairs)
  (loop-for-count (?b 0 ?blocks) do
    (bind ?fired-before ?*fired*)
    (bind ?of-base (seconds ?base ?n (* ?b ?pairs) ?pairs))
    (bind ?of-f (seconds ?f ?n (* ?b ?pairs) ?pairs))
    (printout t ?f "-fired " (- ?*fired* ?fired-before) crlf ?f "-more " (- ?of-f ?of-base) crlf)))
)clp";

// By the CLIPS function that makes a pair.
constexpr std::array<std::pair<ConstraintShape, const char*>, 3> kFunctions = {
    {{ConstraintShape::kJoin, "join"},
     {ConstraintShape::kNegated, "negated"},
     {ConstraintShape::kFree, "free"}}};

void WriteFacts(const std::string& path, size_t constraints) {
  std::ofstream file(path);
  const size_t sixth = constraints / 6;
  for (size_t v = 0; v < 64 * 64; ++v) file << "(at (v v" << v << ") (r r" << v % 64 << "))\n";
  for (size_t n = 0; n < sixth; ++n) {
    file << "(at (v p" << n << ") (r h" << n % 64 << "))\n(owned (i i" << n << ") (o o" << n << "))\n";
    file << "(cn (v p" << n << "))\n(cf (o o" << n << "))\n";
  }
  for (size_t n = 0; n < 2 * sixth; ++n) file << "(cj (r r" << n % 64 << ") (t t" << n << "))\n";
}

}  // namespace

std::string PairNetOf(ConstraintShape shape) {
  return absl::StrCat("pair net, ", NameOf(shape));
}

std::vector<Measurement> MeasureConstraintPeers(size_t constraints) {
  std::vector<Measurement> out;
  const std::string name = absl::StrCat(constraints, " constraints");
  const auto add = [&](const std::string& metric, std::vector<double> runs, const std::string& reason) {
    out.push_back({"constraints", name, "CLIPS", metric, "us", std::move(runs), reason});
  };
  if (!Installed("clips")) {
    add(kPairsNet, {}, "not installed: clips");
    return out;
  }
  const PeerFolder temporary;
  const std::string& folder = temporary.path();
  if (folder.empty()) return out;
  WriteFacts(folder + "/facts.dat", constraints);
  std::ofstream(folder + "/rules.clp") << kClips;
  std::ofstream run(folder + "/run.bat");
  run << "(load \"" << folder << "/rules.clp\")\n(load-facts \"" << folder
      << "/facts.dat\")\n(run)\n(seed 7)\n";
  for (const auto& [shape, function] : kFunctions) {
    const size_t n = ConstraintsOfShape(shape, constraints);
    run << "(compared " << function << " base-" << function << " " << n << " " << kPairBlocks << " "
        << kPairsInBlock << ")\n";
  }
  run << "(exit)\n";
  run.close();
  const std::string text = RunAndRead("clips -f2 '" + folder + "/run.bat'", kTimeoutSeconds);
  double weighted = 0;
  bool whole = true;
  for (const auto& [shape, function] : kFunctions) {
    const std::vector<double> fired = NumbersAfter(text, absl::StrCat(function, "-fired"));
    std::vector<double> differences =
        NumbersAfter(text, absl::StrCat(function, "-more"));  // seconds a block, the first to warm up
    const bool exact =
        std::all_of(fired.begin(), fired.end(), [](double count) { return count == kPairsInBlock; });
    if (differences.size() != 1 + kPairBlocks || !exact) {
      whole = false;
      add(PairNetOf(shape), {}, exact ? "no answer in time" : "did not fire once a pair");
      continue;
    }
    differences.erase(differences.begin());
    const double us = Median(differences) / (2.0 * kPairsInBlock) * 1e6;
    weighted += kPartOfPairs[static_cast<size_t>(shape)] * us;
    add(PairNetOf(shape), {us}, "");
  }
  if (whole) add(kPairsNet, {weighted}, "");
  return out;
}

}  // namespace docent::bench
