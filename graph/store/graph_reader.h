// Reader of one graph version by IRIs as text: one value, all values. One thread.
#ifndef DOCENT_GRAPH_STORE_GRAPH_READER_H_
#define DOCENT_GRAPH_STORE_GRAPH_READER_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/store/graph_version.h"

namespace docent {

class GraphReader {
 public:
  // Both must outlive the reader.
  GraphReader(const Dictionary& dictionary, const GraphVersion& version)
      : dictionary_(dictionary), version_(version) {}
  // A reader of what one graph says, whatever others tell; of all graphs again.
  GraphReader In(std::string_view graph) const;
  GraphReader Everywhere() const { return {dictionary_, version_}; }

  // Objects of (subject, predicate, ?), distinct, in term order.
  std::vector<Term> Objects(std::string_view subject, std::string_view predicate) const;
  std::vector<Term> Objects(TermId subject, std::string_view predicate) const;
  // The lexical form of the first of them; empty: none.
  std::string Object(std::string_view subject, std::string_view predicate) const;
  std::string Object(TermId subject, std::string_view predicate) const;
  // IRIs of the subjects of (?, predicate, object), distinct, in order.
  std::vector<std::string> Subjects(std::string_view predicate, const Term& object) const;

 private:
  // Facts of the pattern in the reader's graphs.
  template <typename Each>
  void ForEach(QuadPattern pattern, const Each& each) const;

  const Dictionary& dictionary_;
  const GraphVersion& version_;
  bool in_one_ = false;
  std::optional<TermId> graph_;  // in_one_: the graph; none: it has no facts
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_GRAPH_READER_H_
