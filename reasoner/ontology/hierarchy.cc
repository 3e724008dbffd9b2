#include "reasoner/ontology/hierarchy.h"

#include <algorithm>
#include <deque>

namespace docent::ontology {

std::vector<std::string> CycleThrough(const std::map<std::string, Words, std::less<>>& edges,
                                      const std::string& from, const std::string& to) {
  if (from == to) return {from};
  std::map<std::string, std::string> before = {{to, from}};
  std::deque<std::string> open = {to};
  while (!open.empty() && !before.contains(from)) {
    const std::string at = std::move(open.front());
    open.pop_front();
    auto next = edges.find(at);
    if (next == edges.end()) continue;
    for (const std::string& word : next->second) {
      if (before.try_emplace(word, at).second) open.push_back(word);
    }
  }
  auto last = before.find(from);
  if (last == before.end()) return {};
  std::vector<std::string> cycle;
  for (std::string at = last->second; at != from; at = before.at(at)) cycle.push_back(at);
  cycle.push_back(from);
  std::reverse(cycle.begin(), cycle.end());
  return cycle;
}

}  // namespace docent::ontology
