// docent reference: what the documentation lists, as JSON, from the program itself. Not shown by --help.
#include <iostream>
#include <nlohmann/json.hpp>

#include "CLI/App.hpp"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "reasoner/ontology/finding_kinds.h"
#include "reasoner/shapes/shape.h"

namespace docent::server {
namespace {

nlohmann::json Reference() {
  nlohmann::json findings = nlohmann::json::array();
  for (const ontology::FindingKind& kind : ontology::FindingKinds()) {
    findings.push_back({{"rule", kind.rule},
                        {"severity", kind.severity},
                        {"files", kind.files},
                        {"meaning", kind.meaning},
                        {"remedy", kind.remedy}});
  }
  nlohmann::json components = nlohmann::json::array();
  for (int i = 0; i <= static_cast<int>(shapes::Component::kIn); ++i) {
    const auto component = static_cast<shapes::Component>(i);
    components.push_back(
        {{"component", shapes::ComponentName(component)}, {"parameter", shapes::ParameterName(component)}});
  }
  return {{"findings", findings}, {"components", components}};
}

}  // namespace

void AddReferenceCommand(CLI::App* app, int* exit_code) {
  CLI::App* command = app->add_subcommand("reference", "What the documentation lists, as JSON");
  command->group("");
  command->callback([exit_code] {
    std::cout << Reference().dump(1) << "\n";
    *exit_code = kExitOk;
  });
}

}  // namespace docent::server
