// Stable radix sort of many keys by one of their words (least significant byte first). It skips the bytes in
// which all keys agree. Ids are small numbers under a tag, so three or four passes are enough. Pure; any
// thread.
#ifndef DOCENT_GRAPH_STORE_KEY_SORT_H_
#define DOCENT_GRAPH_STORE_KEY_SORT_H_

#include <vector>

#include "graph/store/quad_tree.h"

namespace docent {

// Keys with equal words keep their order. `scratch` is overwritten.
void StableSortByWord(std::vector<QuadTree::Key>& keys, int word, std::vector<QuadTree::Key>& scratch);

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_KEY_SORT_H_
