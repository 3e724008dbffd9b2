// Limits of internal entities, which a document type definition declares, as OWL editors do for namespaces:
//
//   <!DOCTYPE rdf:RDF [ <!ENTITY owl "http://www.w3.org/2002/07/owl#" > ]>   … rdf:resource="&owl;Class"
//
// libxml2 expands them. This class bounds the expansion, because an entity that names two others, which again
// name two others, grows exponentially. Private to this folder. One thread.
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
  // The document has `bytes` bytes; the limit is `document_bytes`.
  XmlEntities(const DocumentLimits& limits, size_t document_bytes, size_t bytes);

  // XML 1.0 section 4.2: the first declaration of a name counts.
  void Declare(std::string_view name, std::string_view text);
  // An external entity: it is never fetched.
  void DeclareExternal(std::string_view name);
  bool IsExternal(std::string_view name) const;

  // Counts a use of `name`, also one inside another entity. False: beyond a limit, which why() names.
  bool Use(std::string_view name, size_t bytes);
  const std::string& why() const { return why_; }

 private:
  // Depth of the entities inside `name`, 1 for an entity that names none; more than most_nested_ if `allowed`
  // is not enough. Sets `known` to false if one of them is not declared.
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
