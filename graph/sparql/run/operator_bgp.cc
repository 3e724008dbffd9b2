// Operator of basic graph patterns: nested lookups, one level for each pattern, each filter at the first
// level that binds its variables. A level looks up the index. It switches to a hash table of its pattern's
// matches when the lookups still to come cost more than the table, and the lookups made so far nearly as
// much: so the cost is at worst a few times that of the better method, whatever the estimate was.
// Lookups with rising keys walk along the index instead of descending (QuadTree::Iterator::Restart), as in a
// merge join. Also here: GRAPH over other patterns.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/operators.h"
#include "graph/sparql/run/pattern_scan.h"
#include "graph/sparql/run/pattern_table.h"

namespace docent::sparql {
namespace {

// An index lookup costs about as much as putting this many matches into a table (measured with `docent-bench
// kb`): a lookup beside the last one, and one that descends the tree.
constexpr double kMatchesALookup = 1, kMatchesADescent = 6;
// Allowed cost of a table for each lookup made so far, since the estimate of further lookups may be wrong.
constexpr double kMatchesALookupMade = 8;
constexpr uint64_t kFewLookups = 3;  // below this number a table never pays

class BgpOperator final : public Operator {
 public:
  BgpOperator(PlanNode& node, const BuildContext& build)
      : node_(node), context_(*build.context), row_(build.slots), levels_(node.patterns.size()) {
    constexpr size_t kNone = ~size_t{0};
    std::vector<size_t> level_of(build.slots, kNone);  // the first that binds the slot
    double rows = 1;
    for (size_t level = 0; level < node.patterns.size(); ++level) {
      levels_[level].pattern = &node.patterns[level];
      levels_[level].expected = rows;
      rows *= node.patterns[level].estimate;
      for (const PlanTerm& term : node.patterns[level].terms) {
        if (term.slot >= 0 && level_of[term.slot] == kNone) level_of[term.slot] = level;
      }
    }
    for (size_t f = 0; f < node.filters.size(); ++f) {
      size_t last = kNone;
      for (const int slot : node.filter_slots[f].And(node.certain).List()) {
        const size_t level = level_of[slot] == kNone ? levels_.size() - 1 : level_of[slot];
        if (last == kNone || level > last) last = level;
      }
      // Slots outside the patterns are initial bindings.
      (last == kNone || levels_.empty() ? filters_ : levels_[last].filters).push_back(node.filters[f].get());
      PrepareExpression(*node.filters[f], build);
    }
  }

  void Forget() override {
    for (const PlanExpressionPtr& filter : node_.filters) ForgetExpression(*filter);
    for (Level& level : levels_) {
      level.scan.Forget();
      if (level.tried) level.table->Forget();
      level.tried = false;
      level.lookups = 0;
    }
  }

  void Start(const TermId* in) override {
    std::copy(in, in + row_.size(), row_.begin());
    state_ = State::kFresh;
  }

  bool Next(TermId* out) override {
    if (state_ == State::kDone) return false;
    const bool fresh = state_ == State::kFresh;
    if (fresh && !Pass(filters_)) return Done();
    state_ = levels_.empty() ? State::kDone : State::kRunning;
    if (levels_.empty()) return Emit(out);
    return Match(&levels_.back(), fresh) ? Emit(out) : Done();
  }

  // Counts the matches of the last pattern without producing them.
  uint64_t Count(TermId* scratch) override {
    if (state_ != State::kFresh || levels_.empty() || !levels_.back().filters.empty())
      return Operator::Count(scratch);
    state_ = State::kDone;
    if (!Pass(filters_)) return 0;
    Level& last = levels_.back();
    if (levels_.size() == 1) return CountMatches(last);
    uint64_t count = 0;
    for (bool fresh = true; Match(&last - 1, fresh); fresh = false) count += CountMatches(last);
    return count;
  }

 private:
  enum class State { kFresh, kRunning, kDone };
  struct Level {
    PlanPattern* pattern = nullptr;
    PatternScan scan;
    std::unique_ptr<PatternTable> table;   // null: not built yet
    std::vector<PlanExpression*> filters;  // evaluated on each match
    double expected = 0;                   // expected lookups of one start
    uint64_t lookups = 0;                  // of the index in this run
    bool tried = false;                    // a table was attempted and may exist
    bool hashed = false;                   // the table is open, not `scan`
  };

  // Moves to the next match of the patterns up to `last`.
  bool Match(Level* last, bool fresh) {
    Level* const first = &levels_.front();
    Level* now = fresh ? first : last;
    if (fresh) Open(*now);
    while (true) {
      if (!(now->hashed ? now->table->Next(row_.data(), context_) : now->scan.Next(row_.data()))) {
        if (now == first) return false;
        --now;
        continue;
      }
      ++now->pattern->rows;
      if (!Pass(now->filters)) continue;
      if (now == last) return true;
      Open(*++now);
    }
  }

  uint64_t CountMatches(Level& level) {
    Open(level);
    uint64_t count = 0;
    if (level.hashed) {
      while (level.table->Next(row_.data(), context_)) ++count;
    } else {
      count = level.scan.Count(row_.data());
    }
    level.pattern->rows += count;
    return count;
  }

  void Open(Level& level) {
    PlanPattern& pattern = *level.pattern;
    level.hashed = level.tried && level.table->Fits(row_.data());
    if (!level.hashed && ++level.lookups > kFewLookups && TablePays(level)) {
      level.tried = true;
      if (!level.table) level.table = std::make_unique<PatternTable>();
      level.lookups = 0;  // no table possible: try again much later
      level.hashed = level.table->Build(pattern, row_.data(), row_.size(), context_);
      pattern.hashed = level.hashed;
    }
    if (level.hashed) {
      level.table->Open(row_.data());
    } else {
      level.scan.Open(pattern, row_.data(), context_);
    }
  }

  static bool TablePays(const Level& level) {
    const double made = static_cast<double>(level.lookups);
    const double to_come = std::abs(level.expected - made);  // far beyond the estimate: as many again
    const double descending = std::min(1.0, static_cast<double>(level.scan.descents()) / made);
    const double lookup = kMatchesALookup + (kMatchesADescent - kMatchesALookup) * descending;
    return made * kMatchesALookupMade > level.pattern->matches && to_come * lookup > level.pattern->matches;
  }

  bool Done() {
    state_ = State::kDone;
    return false;
  }
  bool Emit(TermId* out) {
    std::copy(row_.begin(), row_.end(), out);
    ++context_.row_number;
    return true;
  }
  bool Pass(const std::vector<PlanExpression*>& filters) {
    for (PlanExpression* filter : filters) {
      if (!Passes(*filter, row_.data(), context_)) return false;
    }
    return true;
  }

  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<TermId> row_;
  std::vector<Level> levels_;
  std::vector<PlanExpression*> filters_;  // evaluated before the first pattern
  State state_ = State::kDone;
};

// GRAPH name { … }: the inner plan once for each graph, with the graph in a slot of its own.
class GraphOperator final : public Operator {
 public:
  GraphOperator(PlanNode& node, const BuildContext& build)
      : node_(node),
        context_(*build.context),
        outer_base_(build.base),
        base_(build.slots),
        in_(build.slots),
        child_(BuildOperator(*node.children[0], {build.context, build.slots, base_.data(), build.measure})) {}

  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    graphs_.clear();
    next_ = 0;
    running_ = false;
    const TermId bound =
        node_.name.constant >= 0 ? context_.constants[node_.name.constant] : in[node_.name.slot];
    const DatasetIds& dataset = context_.dataset;
    if (!bound.IsNone()) {
      const bool named = !dataset.is_explicit ||
                         std::find(dataset.named_graphs.begin(), dataset.named_graphs.end(), bound) !=
                             dataset.named_graphs.end();
      const bool is_default = !dataset.is_explicit && dataset.strict && bound == dataset.unnamed_graph;
      const bool exists =
          bound.tag() != TermId::Tag::kLocal && context_.version->Count({{}, {}, {}, bound}) > 0;
      if (named && !is_default && exists) graphs_.push_back(bound);
      return;
    }
    for (const TermId graph : context_.version->graphs()) {
      const bool named = dataset.is_explicit
                             ? std::find(dataset.named_graphs.begin(), dataset.named_graphs.end(), graph) !=
                                   dataset.named_graphs.end()
                             : !dataset.strict || graph != dataset.unnamed_graph;
      if (named) graphs_.push_back(graph);
    }
  }

  bool Next(TermId* out) override {
    while (context_.Poll()) {
      if (!running_) {
        if (next_ >= graphs_.size()) return false;
        std::copy(outer_base_, outer_base_ + base_.size(), base_.begin());
        base_[node_.graph_slot] = graphs_[next_];
        in_[node_.graph_slot] = graphs_[next_];
        ++next_;
        child_->Start(in_.data());
        running_ = true;
      }
      while (child_->Next(out)) {
        const TermId graph = in_[node_.graph_slot];
        if (node_.name.slot >= 0) {
          TermId& name = out[node_.name.slot];
          if (!name.IsNone() && name != graph) continue;
          name = graph;
        }
        out[node_.graph_slot] = TermId();
        return true;
      }
      running_ = false;
    }
    return false;
  }
  void Forget() override { child_->Forget(); }

 private:
  PlanNode& node_;
  EvaluationContext& context_;
  const TermId* outer_base_;
  std::vector<TermId> base_, in_;
  std::unique_ptr<Operator> child_;
  std::vector<TermId> graphs_;
  size_t next_ = 0;
  bool running_ = false;
};

}  // namespace

std::unique_ptr<Operator> BuildBgp(PlanNode& node, const BuildContext& build) {
  return std::make_unique<BgpOperator>(node, build);
}

std::unique_ptr<Operator> BuildGraph(PlanNode& node, const BuildContext& build) {
  return std::make_unique<GraphOperator>(node, build);
}

}  // namespace docent::sparql
