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

  // Objects of (subject, predicate, ?), distinct, in term order.
  std::vector<Term> Objects(std::string_view subject, std::string_view predicate) const;
  std::vector<Term> Objects(TermId subject, std::string_view predicate) const;
  // The lexical form of the first of them; empty: none.
  std::string Object(std::string_view subject, std::string_view predicate) const;
  std::string Object(TermId subject, std::string_view predicate) const;
  // IRIs of the subjects of (?, predicate, object), distinct, in order.
  std::vector<std::string> Subjects(std::string_view predicate, const Term& object) const;

 private:
  const Dictionary& dictionary_;
  const GraphVersion& version_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_GRAPH_READER_H_
