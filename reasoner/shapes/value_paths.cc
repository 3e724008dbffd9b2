// Value nodes: property paths evaluated on the data graph (SHACL section 2.3.1; SPARQL 1.1 section 18.4).
#include <algorithm>
#include <utility>

#include "reasoner/shapes/evaluation.h"

namespace docent::shapes {
namespace {

void SortUnique(std::vector<TermId>* nodes) {
  std::sort(nodes->begin(), nodes->end());
  nodes->erase(std::unique(nodes->begin(), nodes->end()), nodes->end());
}

}  // namespace

std::vector<TermId> Evaluation::ValueNodes(const Path& path, TermId node) {
  std::vector<TermId> out;
  Step(path, false, {node}, &out);
  SortUnique(&out);
  return out;
}

// Appends the nodes that the path reaches from each node of `from` to `to`; repeats are possible.
void Evaluation::Step(const Path& path, bool backwards, const std::vector<TermId>& from,
                      std::vector<TermId>* to) {
  switch (path.kind) {
    case Path::Kind::kPredicate:
      for (const TermId node : from) {
        const TermId subject = backwards ? TermId() : node, object = backwards ? node : TermId();
        if (!backwards && node.IsLiteral()) continue;
        data_.ForEach(subject, path.predicate, object, [&](const Quad& q) {
          to->push_back(backwards ? q.subject : q.object);
          return Poll();
        });
      }
      return;
    case Path::Kind::kInverse:
      return Step(path.children[0], !backwards, from, to);
    case Path::Kind::kAlternative:
      for (const Path& child : path.children) Step(child, backwards, from, to);
      return;
    case Path::Kind::kSequence:
      return StepSequence(path, backwards, from, to);
    case Path::Kind::kZeroOrOne:
      to->insert(to->end(), from.begin(), from.end());
      return Step(path.children[0], backwards, from, to);
    case Path::Kind::kZeroOrMore:
      to->insert(to->end(), from.begin(), from.end());
      return StepRepeated(path.children[0], backwards, from, to);
    case Path::Kind::kOneOrMore:
      return StepRepeated(path.children[0], backwards, from, to);
  }
}

void Evaluation::StepSequence(const Path& path, bool backwards, const std::vector<TermId>& from,
                              std::vector<TermId>* to) {
  std::vector<TermId> at = from;
  for (size_t i = 0; i < path.children.size(); ++i) {
    const Path& child = path.children[backwards ? path.children.size() - 1 - i : i];
    std::vector<TermId> next;
    Step(child, backwards, at, &next);
    SortUnique(&next);
    at = std::move(next);
    if (at.empty()) return;
  }
  to->insert(to->end(), at.begin(), at.end());
}

// One step or more.
void Evaluation::StepRepeated(const Path& path, bool backwards, const std::vector<TermId>& from,
                              std::vector<TermId>* to) {
  absl::flat_hash_set<TermId> seen;
  std::vector<TermId> frontier = from;
  while (!frontier.empty() && Poll()) {
    std::vector<TermId> next, fresh;
    Step(path, backwards, frontier, &next);
    for (const TermId node : next) {
      if (seen.insert(node).second) fresh.push_back(node);
    }
    to->insert(to->end(), fresh.begin(), fresh.end());
    frontier = std::move(fresh);
    if (seen.size() * 2 * sizeof(TermId) + memory_ > options_.memory_bytes) {
      Charge(seen.size() * 2 * sizeof(TermId));
      return;
    }
  }
}

}  // namespace docent::shapes
