// `check` of the documents of the scenarios, beside the ontologies, data and robot services that they come with.
#ifndef DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_
#define DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "kb_server/door/operation_signature.h"
#include "tests/golden/golden_file.h"
#include "workflow/cawl/check/check.h"
#include "workflow/cawl/check/subflow_names.h"
#include "workflow/cawl/parser.h"
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

// The folders whose documents a scenario uses: its own, after those of the scenarios on which it builds.
inline std::vector<std::string> FoldersOf(const std::string& folder) {
  if (folder == "scenarios/s03_johns_service") return {"scenarios/s01_booth_guide", folder};
  return {folder};
}

// The words of the ontologies and of the folders, and the workflows in them.
inline cawl::QuadEnvironment Ontologies(const std::vector<std::string>& folders = {}) {
  cawl::QuadEnvironment environment;
  AddTurtle(InTree("ontology"), &environment);
  for (const std::string& folder : folders) {
    AddTurtle(InTree(folder), &environment);
    for (const auto& entry : std::filesystem::directory_iterator(InTree(folder))) {
      if (!entry.path().string().ends_with(".cawl.xml")) continue;
      const cawl::ParsedCawl parsed = cawl::ParseCawl(ReadFile(entry.path()), "f");
      if (parsed.document == nullptr) continue;
      for (const std::string& name : cawl::SubflowNames(*parsed.document))
        environment.AddApplicationService(name);
    }
  }
  return environment;
}

// What is said of `text`, which stands for the file `path` of a scenario.
inline Diagnostics CheckScenarioFile(const std::string& path, const std::string& text) {
  const bool is_service = path.ends_with(".rsel.xml");
  const std::string folder = path.substr(0, path.rfind('/'));
  rsel::ServiceRegistry registry;
  Diagnostics of_services;
  for (const std::string& used : FoldersOf(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(InTree(used))) {
      if (!entry.path().string().ends_with(".rsel.xml")) continue;
      const bool is_text = is_service && entry.path() == InTree(path);
      rsel::ParsedRsel parsed = rsel::ParseRsel(is_text ? text : ReadFile(entry.path()), "f");
      Diagnostics said = parsed.diagnostics;
      if (parsed.ok()) {
        for (Diagnostic& d : registry.Put(parsed.document)) said.push_back(std::move(d));
      }
      if (is_text) of_services = std::move(said);
    }
  }
  if (is_service) return of_services;
  cawl::QuadEnvironment environment = Ontologies(FoldersOf(folder));
  for (const rsel::PlanPtr& plan : registry.Plans()) environment.AddOperation(server::SignatureOf(*plan));
  return cawl::CheckDocument(text, "f", &environment).diagnostics;
}

}  // namespace docent::golden

#endif  // DOCENT_TESTS_GOLDEN_SCENARIO_CHECK_H_
