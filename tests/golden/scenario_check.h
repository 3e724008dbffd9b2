// `check` of the documents of the scenarios, beside the ontologies, data and robot services that they come with.
#ifndef DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_
#define DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_

#include <gtest/gtest.h>

#include <string>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "kb_server/door/operation_signature.h"
#include "tests/golden/golden_file.h"
#include "workflow/cawl/check/check.h"
#include "workflow/rsel/parser.h"

namespace docent::golden {

inline std::filesystem::path InTree(const std::string& path) {
  return std::filesystem::path(DOCENT_SOURCE_DIR) / path;
}

inline void AddTurtle(const std::filesystem::path& folder, cawl::QuadEnvironment* environment) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ttl") continue;
    ParseRdfOptions options;
    options.base_iri = "urn:base:";
    options.blank_node_scope = entry.path().stem().string() + "_";
    const ParsedRdf parsed = ParseRdf(ReadFile(entry.path()), RdfFormat::kTurtle, options);
    ASSERT_TRUE(parsed.ok()) << entry.path();
    environment->AddOntology(parsed.quads);
  }
}

// The words of the ontologies, and of the folder where it is named.
inline cawl::QuadEnvironment Ontologies(const std::string& folder = "") {
  cawl::QuadEnvironment environment;
  AddTurtle(InTree("ontology"), &environment);
  if (!folder.empty()) AddTurtle(InTree(folder), &environment);
  return environment;
}

// What is said of `text`, which stands for the file `path` of a scenario.
inline Diagnostics CheckScenarioFile(const std::string& path, const std::string& text) {
  const bool is_service = path.ends_with(".rsel.xml");
  const std::string folder = path.substr(0, path.rfind('/'));
  rsel::ServiceRegistry registry;
  Diagnostics of_services;
  for (const auto& entry : std::filesystem::directory_iterator(InTree(folder))) {
    if (!entry.path().string().ends_with(".rsel.xml")) continue;
    rsel::ParsedRsel parsed = rsel::ParseRsel(is_service ? text : ReadFile(entry.path()), "f");
    of_services = parsed.diagnostics;
    if (!parsed.ok()) continue;
    for (Diagnostic& d : registry.Put(parsed.document)) of_services.push_back(std::move(d));
  }
  if (is_service) return of_services;
  cawl::QuadEnvironment environment = Ontologies(folder);
  for (const rsel::PlanPtr& plan : registry.Plans()) environment.AddOperation(server::SignatureOf(*plan));
  return cawl::CheckDocument(text, "f", &environment).diagnostics;
}

}  // namespace docent::golden

#endif  // DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_
