// docent rules: which rules a running server follows, and what a change of them would do.
#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/presenter.h"
#include "nlohmann/json.hpp"
#include "reasoner/rules/rule_sets.h"
#include "reasoner/rules/shacl_rules_import.h"

namespace docent::server {
namespace {

struct RulesArguments {
  ClientOptions client;
  std::vector<std::string> names;
  bool remove = false;
  uint32_t shown = 20;
};

// A built-in set's text, or a file's (rules, or RDF with sh:SPARQLRule); the name that the server knows it
// by.
struct RuleText {
  std::string name;
  std::string text;
};

absl::StatusOr<RuleText> ReadRules(const std::string& name_or_file) {
  if (std::string text = rules::BuiltInRuleSet(name_or_file); !text.empty())
    return RuleText{name_or_file, std::move(text)};
  std::string name = std::filesystem::path(name_or_file).filename().string();
  if (!FormatOfFile(name_or_file)) {
    auto text = ReadText(name_or_file, kDocumentText);
    if (!text.ok()) return text.status();
    return RuleText{std::move(name), *std::move(text)};
  }
  auto rdf = ReadRdf(name_or_file, "", "", kDocumentText);
  if (!rdf.ok()) return rdf.status();
  const LocatedRdf parsed = ParseLocatedRdf(rdf->text, rdf->format, rdf->Options(name_or_file));
  if (!parsed.rdf.ok()) return ToStatus(parsed.rdf, rdf->text);
  rules::ImportedRules imported = rules::ImportShaclRules(parsed, rdf->text, name_or_file);
  if (!imported.ok()) return ToStatus(imported.diagnostics, rdf->text);
  if (imported.rules == 0)
    return absl::InvalidArgumentError(absl::StrCat(name_or_file, " holds no sh:SPARQLRule"));
  std::cerr << Render(imported.diagnostics, rdf->text);
  return RuleText{std::move(name), std::move(imported.text)};
}

class RulesClient {
 public:
  explicit RulesClient(const RulesArguments& arguments)
      : arguments_(arguments), stub_(v1::Ontologies::NewStub(Connect(arguments.client))) {}

  int List() {
    v1::ListOntologiesReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->List(&context, {}, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    Table table({"rule set", "rules", "since revision"});
    table.KeepWhole({0});
    for (const auto& module : reply.modules()) {
      if (module.kind() != v1::LoadRequest::RULES) continue;
      if (arguments_.client.json)
        Report({{"name", module.name()}, {"rules", module.size()}, {"revision", module.revision()}});
      else
        table.Add({module.name(), absl::StrCat(module.size()), absl::StrCat(module.revision())});
    }
    if (table.rows() > 0) std::cout << table.Render(Terminal::OfOutput(arguments_.client.colours));
    return kExitOk;
  }

  int Use(const std::string& name_or_file) {
    const auto rules = ReadRules(name_or_file);
    if (!rules.ok()) return Fail(rules.status());
    v1::LoadRequest request;
    request.set_name(rules->name);
    request.set_kind(v1::LoadRequest::RULES);
    request.set_text(rules->text);
    v1::LoadReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->Load(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json)
      return Report({{"name", rules->name}, {"inferred", reply.inferred()}, {"revision", reply.revision()}});
    std::cout << rules->name << ": in use, " << reply.inferred() << " inferred facts changed, revision "
              << reply.revision() << "\n";
    return kExitOk;
  }

  int Remove(const std::string& name) {
    v1::RemoveOntologyRequest request;
    request.set_name(name);
    request.set_kind(v1::LoadRequest::RULES);
    v1::LoadReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->Remove(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json)
      return Report({{"name", name}, {"inferred", reply.inferred()}, {"revision", reply.revision()}});
    std::cout << name << ": removed, " << reply.inferred() << " inferred facts changed, revision "
              << reply.revision() << "\n";
    return kExitOk;
  }

  int Preview(const std::string& name_or_file) {
    v1::PreviewRulesRequest request;
    request.set_remove(arguments_.remove);
    request.set_shown(arguments_.shown);
    if (arguments_.remove) {
      request.set_name(name_or_file);
    } else {
      const auto rules = ReadRules(name_or_file);
      if (!rules.ok()) return Fail(rules.status());
      request.set_name(rules->name);
      request.set_text(rules->text);
    }
    v1::PreviewRulesReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->PreviewRules(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json) {
      PrintJson(reply);
      return kExitOk;
    }
    const IriNames names = arguments_.client.full ? IriNames() : ServerNames(arguments_.client);
    std::cout << request.name() << ": " << reply.added() << " facts would be added, " << reply.removed()
              << " removed (at revision " << reply.revision() << "; nothing is changed)\n";
    Print("+ ", reply.added_triples(), reply.added(), names);
    Print("- ", reply.removed_triples(), reply.removed(), names);
    return kExitOk;
  }

 private:
  static int Report(const nlohmann::json& object) {
    std::cout << PrintableJson(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) << "\n";
    return kExitOk;
  }

  static void Print(const char* sign, const google::protobuf::RepeatedPtrField<std::string>& triples,
                    uint64_t all, const IriNames& names) {
    for (const std::string& triple : triples) std::cout << sign << names.InText(triple) << "\n";
    const auto shown = static_cast<uint64_t>(triples.size());
    if (shown < all) std::cout << sign << "… and " << all - shown << " more\n";
  }

  const RulesArguments& arguments_;
  std::unique_ptr<v1::Ontologies::Stub> stub_;
};

using Action = int (RulesClient::*)(const std::string&);

CLI::App* AddAction(CLI::App* rules, const std::shared_ptr<RulesArguments>& arguments, int* exit_code,
                    const char* name, const char* what, const char* of, Action action) {
  CLI::App* command = rules->add_subcommand(name, what);
  AddClientOptions(command, &arguments->client);
  command->add_option("names", arguments->names, of)->required();
  command->callback([arguments, exit_code, action] {
    RulesClient client(*arguments);
    for (const std::string& each : arguments->names) {
      *exit_code = (client.*action)(each);
      if (*exit_code != kExitOk) return;
    }
  });
  return command;
}

}  // namespace

void AddRulesCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<RulesArguments>();
  CLI::App* rules = app->add_subcommand("rules", "List, use, remove and preview the server's rule sets");
  rules->group(kDocumentsGroup);
  rules->require_subcommand(1);
  rules->footer("Examples:\n  docent rules list\n  docent rules use owl2rl");
  CLI::App* list = rules->add_subcommand("list", "List the rule sets in use");
  AddClientOptions(list, &arguments->client);
  AddShowOptions(list, &arguments->client);
  list->footer("Example:\n  docent rules list");
  list->callback([arguments, exit_code] { *exit_code = RulesClient(*arguments).List(); });
  constexpr char kNames[] =
      "The built-in sets rdfs and owl2rl, .rules files, or RDF files with sh:SPARQLRule";
  AddAction(rules, arguments, exit_code, "use", "Use rule sets; one of the same name is replaced", kNames,
            &RulesClient::Use)
      ->footer("Example:\n  docent rules use owl2rl guide.rules");
  AddAction(rules, arguments, exit_code, "remove", "Remove rule sets",
            "Names of rule sets, as `docent rules list` prints them", &RulesClient::Remove)
      ->footer("Example:\n  docent rules remove guide.rules");
  CLI::App* preview =
      AddAction(rules, arguments, exit_code, "preview",
                "Tell what rule sets would add to the graph and remove from it; nothing is changed", kNames,
                &RulesClient::Preview);
  AddShowOptions(preview, &arguments->client);
  preview->add_flag("--remove", arguments->remove, "Preview the removal of the named rule sets");
  preview->add_option("--shown", arguments->shown, "Number of facts printed of each kind")
      ->type_name("N")
      ->capture_default_str();
  preview->footer("Example:\n  docent rules preview owl2rl --shown 5");
}

}  // namespace docent::server
