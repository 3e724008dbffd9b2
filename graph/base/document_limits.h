// Limits of document readers beyond those of limits.h, whose rules hold here; separate, since few include it.
#ifndef DOCENT_GRAPH_BASE_DOCUMENT_LIMITS_H_
#define DOCENT_GRAPH_BASE_DOCUMENT_LIMITS_H_

#include <cstddef>

namespace docent {

struct DocumentLimits {
  // RDF/XML documents
  int rdf_xml_nesting = 4096;    // elements inside each other in RDF/XML, where lists may be nested so
  size_t xml_attributes = 1024;  // attributes of one element, and prefixes in scope
  int xml_entity_nesting = 16;   // entities inside each other
  size_t xml_entity_growth =
      100;  // bytes of entities, written out, for each byte of a document; 1 MiB in any case
  size_t xml_declarations = 10000;  // entities and attributes in a document type definition

  // packed documents
  size_t unpacked_bytes = size_t{2} << 30;  // of a gzip file that a command reads

  // versions of workflows and RSEL documents
  size_t version_texts = 50;              // texts kept of one document, the newest
  size_t version_text_bytes = 16u << 20;  // bytes of these texts together; the newest is kept in any case
  size_t removed_documents = 1000;        // removed documents whose texts are kept, those removed last
};

inline constexpr DocumentLimits kDocumentLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_DOCUMENT_LIMITS_H_
