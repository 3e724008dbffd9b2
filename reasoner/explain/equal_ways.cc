#include "reasoner/explain/equal_ways.h"

#include <algorithm>

namespace docent::explain {

std::vector<TermId> EqualWays::NamesOf(TermId term) const {
  std::vector<TermId> names = {term};
  if (term.IsLiteral()) return names;
  for (QuadCursor c = version_.Scan({term, same_as_, TermId(), TermId()}); c.Valid(); c.NextTriple()) {
    const TermId name = c.quad().object;
    if (name != term && !name.IsLiteral()) names.push_back(name);
  }
  return names;
}

void EqualWays::Load(TermId term) {
  if (term.IsLiteral() || nodes_.contains(term)) return;
  const std::vector<TermId> names = NamesOf(term);
  for (const TermId name : names) nodes_[name].parent = name;
  for (const TermId name : names) {
    version_.ForEach({name, same_as_, TermId(), TermId()}, [&](const Quad& q) {
      if (q.graph == inferred_graph_ || q.object == name) return true;
      nodes_[name].beside.push_back(q.object);
      if (!q.object.IsLiteral()) nodes_[q.object].beside.push_back(name);
      return true;
    });
  }
  for (const TermId name : names) {
    if (nodes_.at(name).depth == 0) PlantTree(name);
  }
}

// Breadth first, so that paths to the root are short. Depths begin with 1.
void EqualWays::PlantTree(TermId root) {
  nodes_[root].parent = root;
  nodes_[root].depth = 1;
  std::vector<TermId> queue = {root};
  for (size_t i = 0; i < queue.size(); ++i) {
    const Node at = nodes_[queue[i]];
    for (const TermId next : at.beside) {
      if (next.IsLiteral()) continue;
      Node& node = nodes_[next];
      if (node.depth != 0) continue;
      node.parent = queue[i];
      node.depth = at.depth + 1;
      queue.push_back(next);
    }
  }
}

bool EqualWays::Connect(TermId a, TermId b) {
  if (!Way(a, b).empty()) return false;
  nodes_[a].beside.push_back(b);
  if (b.IsLiteral()) return true;
  nodes_[b].beside.push_back(a);
  const std::vector<TermId> names = NamesOf(a);
  for (const TermId name : names) nodes_[name].depth = 0;
  for (const TermId name : names) {
    if (nodes_[name].depth == 0) PlantTree(name);
  }
  return true;
}

std::vector<TermId> EqualWays::Way(TermId a, TermId b) {
  Load(a);
  if (b.IsLiteral()) {  // from any name that has this literal
    for (const TermId name : NamesOf(a)) {
      const std::vector<TermId>& beside = nodes_[name].beside;
      if (std::find(beside.begin(), beside.end(), b) == beside.end()) continue;
      std::vector<TermId> way = a == name ? std::vector<TermId>{a} : Way(a, name);
      if (way.empty()) continue;
      way.push_back(b);
      return way;
    }
    return {};
  }
  Load(b);
  if (a == b) {
    for (const TermId beside : nodes_[a].beside) {
      if (!beside.IsLiteral()) return {a, beside, a};
    }
    return {};
  }
  std::vector<TermId> from_a = {a}, from_b = {b};
  while (from_a.back() != from_b.back()) {
    const Node& of_a = nodes_[from_a.back()];
    const Node& of_b = nodes_[from_b.back()];
    if (of_a.depth == 1 && of_b.depth == 1) return {};  // two trees
    if (of_a.depth >= of_b.depth) {
      from_a.push_back(of_a.parent);
    } else {
      from_b.push_back(of_b.parent);
    }
  }
  from_a.insert(from_a.end(), from_b.rbegin() + 1, from_b.rend());
  return from_a;
}

}  // namespace docent::explain
