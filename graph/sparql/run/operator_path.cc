// Operator of property paths that are not rewritten into patterns: *, +, ? and negated sets (SPARQL 1.1
// section 18.4 and 9.3). Breadth-first search finds the reachable nodes and visits each once. Nested closures
// are one closure: (p*|q+)* steps as (p|q)* does. Between two known nodes the search goes from both ends, the
// smaller frontier first; between two unknown ones it begins at the nodes where the path can begin.
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "graph/sparql/run/operators.h"
#include "graph/sparql/run/pattern_scan.h"

namespace docent::sparql {

using Kind = Path::Kind;

namespace {

// Nodes in the order of discovery. Their memory is charged as long as they are kept.
class Nodes {
 public:
  enum class Repeats { kKept, kLeftOut };
  Nodes(Repeats repeats, EvaluationContext* context)
      : distinct_(repeats == Repeats::kLeftOut), context_(context) {}
  Nodes(Nodes&& other) noexcept { *this = std::move(other); }
  Nodes& operator=(Nodes&& other) noexcept {
    std::swap(list_, other.list_);
    std::swap(seen_, other.seen_);
    std::swap(kept_, other.kept_);
    distinct_ = other.distinct_;
    context_ = other.context_;
    return *this;
  }
  ~Nodes() { kept_.LetGo(*context_); }

  // False for a repeated node, or if the memory limit ends the run.
  bool Add(TermId id) {
    if (distinct_ && !seen_.insert(id).second) return false;
    if (!kept_.Add((distinct_ ? 3 : 1) * sizeof(TermId), *context_)) return false;
    list_.push_back(id);
    return true;
  }
  bool Contains(TermId id) const { return seen_.contains(id); }
  size_t size() const { return list_.size(); }
  TermId operator[](size_t i) const { return list_[i]; }
  auto begin() const { return list_.begin(); }
  auto end() const { return list_.end(); }

 private:
  bool distinct_ = false;
  EvaluationContext* context_ = nullptr;
  std::vector<TermId> list_;
  absl::flat_hash_set<TermId> seen_;
  KeptMemory kept_;
};

class PathOperator final : public Operator {
 public:
  PathOperator(PlanNode& node, const BuildContext& build)
      : node_(node), context_(*build.context), in_(build.slots) {
    for (int i = 0; i < 3; ++i) triple_.terms[i].slot = i;
    triple_.graph.kind = node.graph.kind;
    if (node.graph.kind == GraphRef::Kind::kNamed) triple_.graph.name.slot = 3;
  }

  void Start(const TermId* in) override {
    std::copy(in, in + in_.size(), in_.begin());
    if (node_.graph.kind == GraphRef::Kind::kNamed) {
      graph_ = node_.graph.name.slot >= 0 ? in[node_.graph.name.slot]
                                          : context_.constants[node_.graph.name.constant];
    }
    from_ = node_.subject.slot >= 0 ? in[node_.subject.slot] : context_.Encode(node_.subject_term);
    to_ = node_.object.slot >= 0 ? in[node_.object.slot] : context_.Encode(node_.object_term);
    Forget();
    next_start_ = next_end_ = 0;
    forward_ = !from_.IsNone() || to_.IsNone();
    if (from_.IsNone() && to_.IsNone()) {
      starts_ = Nullable(*node_.path) ? AllNodes() : Beginnings(*node_.path, true, 0);
    } else {
      const TermId start = forward_ ? from_ : to_;
      // Between two variables a path of length zero leads from each node of the graph to itself, and only
      // there.
      const bool variables = node_.subject.slot >= 0 && node_.object.slot >= 0;
      if (!variables || IsNode(start)) starts_.Add(start);
    }
  }

  void Forget() override {
    starts_ = List();
    ends_ = List();
  }

  bool Next(TermId* out) override {
    while (context_.Poll()) {
      if (next_end_ >= ends_.size()) {
        if (next_start_ >= starts_.size()) return false;
        start_ = starts_[next_start_++];
        next_end_ = 0;
        if (IsClosure(*node_.path) && !from_.IsNone() && !to_.IsNone()) {
          ends_ = List();
          if (Reaches(*node_.path, from_, to_)) ends_.Add(to_);
        } else {
          ends_ = Expand(*node_.path, start_, forward_, 0);
        }
        continue;
      }
      const TermId end = ends_[next_end_++];
      const TermId subject = forward_ ? start_ : end;
      const TermId object = forward_ ? end : start_;
      if (!to_.IsNone() && object != to_) continue;
      std::copy(in_.begin(), in_.end(), out);
      if (node_.subject.slot >= 0) out[node_.subject.slot] = subject;
      if (node_.object.slot >= 0) {
        if (node_.object.slot == node_.subject.slot && subject != object) continue;
        out[node_.object.slot] = object;
      }
      ++context_.row_number;
      return true;
    }
    return false;
  }

 private:
  Nodes List() { return Nodes(Nodes::Repeats::kKept, &context_); }
  Nodes Distinct() { return Nodes(Nodes::Repeats::kLeftOut, &context_); }

  // Calls `visit(subject, predicate, object)` for each matching triple; kNone is a wildcard.
  template <typename Visit>
  void ForTriples(TermId subject, TermId predicate, TermId object, Visit visit) {
    TermId row[4] = {subject, predicate, object, graph_};
    PatternScan scan;
    scan.Open(triple_, row, context_);
    while (scan.Next(row)) visit(row[0], row[1], row[2]);
  }
  bool AnyTriple(TermId subject, TermId object) {
    TermId row[4] = {subject, TermId(), object, graph_};
    PatternScan scan;
    scan.Open(triple_, row, context_);
    return scan.Next(row);
  }

  // Number of IRIs in `path`: the constants of a path are in the order of its IRIs.
  static int IriCount(const Path& path) {
    int count = path.kind == Kind::kIri ? 1 : 0;
    for (const Path& child : path.children) count += IriCount(child);
    return count;
  }
  TermId Constant(int number) const { return context_.constants[node_.path_constants[number]]; }

  // The nodes that `path` reaches from `node` (backwards if not forward). `first`: number of its first
  // IRI.
  Nodes Expand(const Path& path, TermId node, bool forward, int first) {
    Nodes out = List();
    if (!context_.Poll()) return out;
    switch (path.kind) {
      case Kind::kIri:
        ForTriples(forward ? node : TermId(), Constant(first), forward ? TermId() : node,
                   [&](TermId s, TermId, TermId o) { out.Add(forward ? o : s); });
        return out;
      case Kind::kInverse:
        return Expand(path.children[0], node, !forward, first);
      case Kind::kSequence:
        return ExpandSequence(path, node, forward, first);
      case Kind::kAlternative:
        for (const Path& child : path.children) {
          for (const TermId id : Expand(child, node, forward, first)) out.Add(id);
          first += IriCount(child);
        }
        return out;
      case Kind::kZeroOrOne: {
        if (IsClosure(path.children[0])) return Closure(path, node, forward, first);
        out = Distinct();
        out.Add(node);
        for (const TermId id : Expand(path.children[0], node, forward, first)) out.Add(id);
        return out;
      }
      case Kind::kZeroOrMore:
      case Kind::kOneOrMore:
        return Closure(path, node, forward, first);
      case Kind::kNegatedSet:
        return ExpandNegated(path, node, forward, first);
    }
    return out;
  }

  Nodes ExpandSequence(const Path& path, TermId node, bool forward, int first) {
    std::vector<int> firsts;
    for (const Path& child : path.children) {
      firsts.push_back(first);
      first += IriCount(child);
    }
    Nodes now = List();
    now.Add(node);
    for (size_t i = 0; i < path.children.size(); ++i) {
      const size_t k = forward ? i : path.children.size() - 1 - i;
      Nodes next = Distinct();
      for (const TermId id : now) {
        for (const TermId to : Expand(path.children[k], id, forward, firsts[k])) next.Add(to);
      }
      now = std::move(next);
    }
    return now;
  }

  static bool IsClosure(const Path& path) {
    return path.kind == Kind::kZeroOrMore || path.kind == Kind::kOneOrMore;
  }
  // True if the path leads from each node to itself.
  static bool Nullable(const Path& path) {
    switch (path.kind) {
      case Kind::kZeroOrMore:
      case Kind::kZeroOrOne:
        return true;
      case Kind::kSequence:
        return std::all_of(path.children.begin(), path.children.end(), Nullable);
      case Kind::kAlternative:
        return std::any_of(path.children.begin(), path.children.end(), Nullable);
      case Kind::kInverse:
      case Kind::kOneOrMore:
        return Nullable(path.children[0]);
      default:
        return false;
    }
  }

  // One step of a closure over `path`; closures inside it are stepped through, too.
  Nodes Step(const Path& path, TermId node, bool forward, int first) {
    switch (path.kind) {
      case Kind::kZeroOrMore:
      case Kind::kOneOrMore:
      case Kind::kZeroOrOne:
        return Step(path.children[0], node, forward, first);
      case Kind::kInverse:
        return Step(path.children[0], node, !forward, first);
      case Kind::kAlternative: {
        Nodes out = List();
        for (const Path& child : path.children) {
          for (const TermId id : Step(child, node, forward, first)) out.Add(id);
          first += IriCount(child);
        }
        return out;
      }
      default:
        return Expand(path, node, forward, first);
    }
  }

  // Function ALP of section 18.4. `path` is a closure, or (…)? around one.
  Nodes Closure(const Path& path, TermId node, bool forward, int first) {
    Nodes out = Distinct();
    if (Nullable(path)) {
      out.Add(node);
    } else {
      for (const TermId id : Step(path, node, forward, first)) out.Add(id);
    }
    for (size_t i = 0; i < out.size() && context_.Poll(); ++i) {
      for (const TermId id : Step(path, out[i], forward, first)) out.Add(id);
    }
    return out;
  }

  // True if a closure leads from one node to another.
  bool Reaches(const Path& path, TermId from, TermId to) {
    if (from == to && Nullable(path)) return true;
    // Forward and backward search; a side's frontier is the part from `next` on.
    Nodes seen[2] = {Distinct(), Distinct()};
    size_t next[2] = {0, 0};
    for (const TermId id : Step(path, from, true, 0)) seen[0].Add(id);
    seen[1].Add(to);
    bool found = seen[0].Contains(to);
    while (!found && next[0] < seen[0].size() && next[1] < seen[1].size() && context_.Poll()) {
      const int side = seen[0].size() - next[0] <= seen[1].size() - next[1] ? 0 : 1;
      for (const size_t end = seen[side].size(); !found && next[side] < end; ++next[side]) {
        for (const TermId id : Step(path, seen[side][next[side]], side == 0, 0)) {
          found = found || seen[1 - side].Contains(id);
          seen[side].Add(id);
        }
      }
    }
    return found && context_.status.ok();
  }

  // Nodes where the path, which is not nullable, can begin (end, if not forward); possibly a few more.
  Nodes Beginnings(const Path& path, bool forward, int first) {
    Nodes out = Distinct();
    switch (path.kind) {
      case Kind::kIri:
        ForTriples(TermId(), Constant(first), TermId(),
                   [&](TermId s, TermId, TermId o) { out.Add(forward ? s : o); });
        return out;
      case Kind::kInverse:
        return Beginnings(path.children[0], !forward, first);
      case Kind::kOneOrMore:
        return Beginnings(path.children[0], forward, first);
      case Kind::kSequence: {
        const Path& end = forward ? path.children.front() : path.children.back();
        if (Nullable(end)) return AllNodes();
        return Beginnings(end, forward, forward ? first : first + IriCount(path) - IriCount(end));
      }
      case Kind::kAlternative:
        for (const Path& child : path.children) {
          for (const TermId id : Beginnings(child, forward, first)) out.Add(id);
          first += IriCount(child);
        }
        return out;
      default:
        return AllNodes();
    }
  }

  Nodes ExpandNegated(const Path& path, TermId node, bool forward, int first) {
    Nodes out = List();
    std::vector<TermId> along, against;
    bool has_along = path.children.empty(), has_against = false;
    for (const Path& child : path.children) {
      const bool inverse = child.kind == Kind::kInverse;
      (inverse ? against : along).push_back(Constant(first++));
      (inverse ? has_against : has_along) = true;
    }
    const auto collect = [&](const std::vector<TermId>& excluded, bool from_subject) {
      ForTriples(from_subject ? node : TermId(), TermId(), from_subject ? TermId() : node,
                 [&](TermId s, TermId p, TermId o) {
                   if (std::find(excluded.begin(), excluded.end(), p) != excluded.end()) return;
                   out.Add(from_subject ? o : s);
                 });
    };
    if (has_along) collect(along, forward);
    if (has_against) collect(against, !forward);
    return out;
  }

  bool IsNode(TermId id) { return AnyTriple(id, TermId()) || AnyTriple(TermId(), id); }

  Nodes AllNodes() {
    Nodes out = Distinct();
    ForTriples(TermId(), TermId(), TermId(), [&](TermId s, TermId, TermId o) {
      out.Add(s);
      out.Add(o);
    });
    return out;
  }

  PlanNode& node_;
  EvaluationContext& context_;
  std::vector<TermId> in_;
  PlanPattern triple_;
  TermId graph_, from_, to_, start_;
  bool forward_ = true;
  Nodes starts_ = List(), ends_ = List();
  size_t next_start_ = 0, next_end_ = 0;
};

}  // namespace

std::unique_ptr<Operator> BuildPath(PlanNode& node, const BuildContext& build) {
  return std::make_unique<PathOperator>(node, build);
}

}  // namespace docent::sparql
