// The words of RDF 1.1, RDF Schema, OWL 2 and XML Schema's datatypes. Constant tables; any thread.
#ifndef DOCENT_REASONER_ONTOLOGY_STANDARD_WORDS_H_
#define DOCENT_REASONER_ONTOLOGY_STANDARD_WORDS_H_

#include <string_view>
#include <vector>

namespace docent::ontology {

enum class StandardKind { kClass, kProperty, kDatatype, kOther };
struct StandardWord {
  std::string_view name_space, local;
  StandardKind kind;
};
const std::vector<StandardWord>& StandardWords();

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_STANDARD_WORDS_H_
