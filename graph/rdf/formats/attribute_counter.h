// Counter of the attributes of each start tag in XML text that comes in pieces, before libxml2 reads it.
// Exact up to the first place that is not well-formed, where libxml2 stops. Private to this folder. One
// thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_
#define DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_

#include <cstddef>
#include <string_view>

namespace docent {

class AttributeCounter {
 public:
  // `most`: the limit for one element; namespace declarations count.
  explicit AttributeCounter(size_t most) : most_(most) {}

  // The offset in `piece` of the first attribute beyond the limit; npos: none.
  size_t Feed(std::string_view piece);

 private:
  enum class State { kText, kOpen, kTag, kValue, kUntil };
  void Begin();  // at "<"
  // After "<": determines the kind of markup, once enough characters are seen.
  void Open(char c);

  const size_t most_;
  State state_ = State::kText;
  char quote_ = 0;         // in kValue
  size_t attributes_ = 0;  // of the current tag
  char opened_[9];         // the characters after "<", in kOpen
  size_t opened_size_ = 0;
  std::string_view ending_;  // awaited in kUntil
  size_t matched_ = 0;       // matched characters of the ending
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_ATTRIBUTE_COUNTER_H_
