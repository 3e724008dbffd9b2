// Entities that a document type definition declares by their text, as OWL editors do for namespaces:
//
//   <!DOCTYPE rdf:RDF [ <!ENTITY owl "http://www.w3.org/2002/07/owl#" > ]>   … rdf:resource="&owl;Class"
//
// libxml2 puts them in their places; this holds them to their limits, since one that names others twice, which name
// others twice, grows without end. Private to this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_XML_ENTITIES_H_
#define DOCENT_GRAPH_RDF_FORMATS_XML_ENTITIES_H_

#include <string>
#include <string_view>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "graph/base/document_limits.h"

namespace docent {

class XmlEntities {
 public:
  // The document has `bytes`, and may have `document_bytes`.
  XmlEntities(const DocumentLimits& limits, size_t document_bytes, size_t bytes);

  // XML 1.0 section 4.2: the first declaration of a name counts.
  void Declare(std::string_view name, std::string_view text);
  // One whose text lies elsewhere: it is never fetched.
  void DeclareExternal(std::string_view name);
  bool IsExternal(std::string_view name) const;

  // A use of `name`, inside another entity's text or not. False: that is too much, and why() says what.
  bool Use(std::string_view name, size_t bytes);
  const std::string& why() const { return why_; }

 private:
  // How deep entities stand inside `name`, 1 for one that names none; more than most_nested_ where `allowed` does not
  // suffice. `known` becomes false where one of them is not declared.
  int NestingOf(std::string_view name, int allowed, bool* known);

  const int most_nested_;
  const size_t most_bytes_, growth_;
  size_t used_bytes_ = 0;
  std::string why_;
  struct Entity {
    std::string text;
    int nesting = 0;  // 0: not known yet
  };
  absl::flat_hash_map<std::string, Entity> entities_;
  absl::flat_hash_set<std::string> external_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_XML_ENTITIES_H_
