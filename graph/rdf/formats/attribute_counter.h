// Counts the attributes of each start tag in XML text that comes in pieces, before libxml2 sees it. Exact up to the first
// place that is not well-formed, where libxml2 ends. Private to this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_
#define DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_

#include <cstddef>
#include <string_view>

namespace docent {

class AttributeCounter {
 public:
  // `most`: of one element, declarations of namespaces among them.
  explicit AttributeCounter(size_t most) : most_(most) {}

  // The offset in `piece` of the attribute that is one too many; npos: there is none.
  size_t Feed(std::string_view piece);

 private:
  enum class State { kText, kOpen, kTag, kValue, kUntil };
  void Begin();  // at "<"
  // After "<": what it opens, once enough of it is seen.
  void Open(char c);

  const size_t most_;
  State state_ = State::kText;
  char quote_ = 0;         // kValue
  size_t attributes_ = 0;  // of the tag
  char opened_[9];         // what follows "<", kOpen
  size_t opened_size_ = 0;
  std::string_view ending_;  // kUntil
  size_t matched_ = 0;       // of the ending
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_
