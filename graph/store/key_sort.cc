#include "graph/store/key_sort.h"

#include <algorithm>
#include <array>
#include <utility>

namespace docent {
namespace {

// Below this a pass over 256 counters costs more than it saves.
constexpr size_t kFewKeys = 512;

}  // namespace

void StableSortByWord(std::vector<QuadTree::Key>& keys, int word, std::vector<QuadTree::Key>& scratch) {
  if (keys.size() < kFewKeys) {
    std::stable_sort(keys.begin(), keys.end(),
                     [word](const QuadTree::Key& a, const QuadTree::Key& b) { return a[word] < b[word]; });
    return;
  }
  uint64_t differing = 0;
  for (const QuadTree::Key& key : keys) differing |= key[word] ^ keys[0][word];
  scratch.resize(keys.size());
  for (int shift = 0; shift < 64; shift += 8) {
    if ((differing >> shift & 0xff) == 0) continue;
    std::array<size_t, 256> place = {};
    for (const QuadTree::Key& key : keys) ++place[key[word] >> shift & 0xff];
    size_t sum = 0;
    for (size_t& count : place) sum += std::exchange(count, sum);
    for (const QuadTree::Key& key : keys) scratch[place[key[word] >> shift & 0xff]++] = key;
    keys.swap(scratch);
  }
}

}  // namespace docent
