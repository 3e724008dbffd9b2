// Small CAWL documents for tests.
#ifndef DOCENT_TESTS_WORKFLOW_CAWL_DOCUMENTS_H_
#define DOCENT_TESTS_WORKFLOW_CAWL_DOCUMENTS_H_

#include <fstream>
#include <iterator>
#include <string>

#include "workflow/cawl/parser.h"

namespace docent::cawl {

// A document of one flow F (variables user, robot) with one node N whose content is `node`.
inline std::string WithNode(const std::string& node) {
  return "<CAWL name=\"T\" xmlns:expo=\"https://w3id.org/docent/expo#\" "
         "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">"
         "<flow name=\"F\"><variable name=\"user\"/><variable name=\"robot\"/><source name=\"s\"/>"
         "<node name=\"N\">" +
         node +
         "</node><sink name=\"e\"/><link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>"
         "</flow></CAWL>";
}

// <constraint> with these words.
inline std::string ConstraintText(const std::string& name, const std::string& s, const std::string& v,
                                  const std::string& o) {
  return "<constraint name=\"" + name + "\"><subject>" + s + "</subject><verb>" + v + "</verb><object>" + o +
         "</object></constraint>";
}

// A condition of one context with one rule over these constraints.
inline std::string ConditionOf(const std::string& constraints, const std::string& expression = "") {
  return "<condition><context name=\"C\"><rule name=\"R\"" +
         (expression.empty() ? "" : " expression=\"" + expression + "\"") + ">" + constraints +
         "</rule></context></condition>";
}

inline std::string RepositoryFile(const std::string& path) {
  std::ifstream in(std::string(DOCENT_SOURCE_DIR) + "/" + path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace docent::cawl

#endif  // DOCENT_TESTS_WORKFLOW_CAWL_DOCUMENTS_H_
