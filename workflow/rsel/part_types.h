// Types of the parts of messages and operations: classes and datatypes by their IRIs. Whether a value, or a value of another
// type, may be given for a type. Pure functions; any thread.
#ifndef DOCENT_WORKFLOW_RSEL_PART_TYPES_H_
#define DOCENT_WORKFLOW_RSEL_PART_TYPES_H_

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/term.h"

namespace docent::rsel {

// Part → IRI of its class or datatype. A part that is not in it may be anything.
using PartTypes = std::map<std::string, std::string>;

// Whether the IRI names a datatype: one of XML Schema, rdf:langString, rdfs:Literal and the like. Any other IRI is a class.
bool IsDatatype(std::string_view type);

// Why `value` is not of `type`, as far as the value itself shows: "is a resource, and xsd:integer is a datatype". Empty: it may
// be. An empty type takes anything. A literal needs a form that its datatype has. Of numbers, a datatype takes those of the
// datatypes that XML Schema derives from it, and xsd:double, xsd:float and xsd:decimal take those that SPARQL 1.1 (section
// 17.1) promotes to them; xsd:string takes text in a language; xsd:anyURI an IRI.
std::string TypeFault(const Term& value, std::string_view type);

// False where no value of type `given` can be one of type `wanted`, as far as their names show. An empty type is anything.
bool MayBeOf(std::string_view given, std::string_view wanted);

// The type in full where it is written with a well-known prefix ("xsd:integer", "docent:Booth"); anything else as it is.
std::string FullType(std::string_view type);
// "xsd:integer", "docent:Booth", "<https://example.org/Lamp>".
std::string TypeName(std::string_view type);

// "booth (docent:Booth), times (xsd:integer) and where"; "nothing" without parts.
std::string PartsText(const std::vector<std::string>& parts, const PartTypes& types);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_PART_TYPES_H_
