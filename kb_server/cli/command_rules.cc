// docent rules: which rules a running server follows, and what a change of them would do.
#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/rdf/located_parser.h"
#include "graph/rdf/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "reasoner/rules/rule_sets.h"
#include "reasoner/rules/shacl_rules_import.h"

namespace docent {
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
  if (std::string text = BuiltInRuleSet(name_or_file); !text.empty())
    return RuleText{name_or_file, std::move(text)};
  auto text = ReadText(name_or_file);
  if (!text.ok()) return text.status();
  std::string name = std::filesystem::path(name_or_file).filename().string();
  const auto format = FormatOfFile(name_or_file);
  if (!format) return RuleText{std::move(name), *std::move(text)};
  ParseRdfOptions options;
  options.file = name_or_file;
  const LocatedRdf parsed = ParseLocatedRdf(*text, *format, options);
  if (!parsed.rdf.ok()) return ToStatus(parsed.rdf.diagnostics, *text);
  ImportedRules imported = ImportShaclRules(parsed, *text, name_or_file);
  if (!imported.ok()) return ToStatus(imported.diagnostics, *text);
  if (imported.rules == 0)
    return absl::InvalidArgumentError(absl::StrCat(name_or_file, " holds no sh:SPARQLRule"));
  std::cerr << Render(imported.diagnostics, *text);
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
    for (const auto& module : reply.modules()) {
      if (module.kind() != v1::LoadRequest::RULES) continue;
      std::cout << module.name() << ": " << module.size() << " rules, since revision " << module.revision()
                << "\n";
    }
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
    std::cout << request.name() << ": " << reply.added() << " facts would be added, " << reply.removed()
              << " removed (at revision " << reply.revision() << "; nothing is changed)\n";
    Print("+ ", reply.added_triples(), reply.added());
    Print("- ", reply.removed_triples(), reply.removed());
    return kExitOk;
  }

 private:
  static void Print(const char* sign, const google::protobuf::RepeatedPtrField<std::string>& triples,
                    uint64_t all) {
    for (const std::string& triple : triples) std::cout << sign << triple << "\n";
    const auto shown = static_cast<uint64_t>(triples.size());
    if (shown < all) std::cout << sign << "… and " << all - shown << " more\n";
  }

  const RulesArguments& arguments_;
  std::unique_ptr<v1::Ontologies::Stub> stub_;
};

using Action = int (RulesClient::*)(const std::string&);

void AddAction(CLI::App* rules, const std::shared_ptr<RulesArguments>& arguments, int* exit_code,
               const char* name, const char* what, const char* of, Action action) {
  CLI::App* command = rules->add_subcommand(name, what);
  AddClientOptions(command, &arguments->client);
  command->add_option("names", arguments->names, of)->required();
  if (std::string(name) == "preview") {
    command->add_flag("--remove", arguments->remove, "What the removal of the rule set NAME would do");
    command->add_option("--shown", arguments->shown, "Facts shown of each kind")->capture_default_str();
  }
  command->callback([arguments, exit_code, action] {
    RulesClient client(*arguments);
    for (const std::string& each : arguments->names) {
      *exit_code = (client.*action)(each);
      if (*exit_code != kExitOk) return;
    }
  });
}

}  // namespace

void AddRulesCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<RulesArguments>();
  CLI::App* rules = app->add_subcommand("rules", "The rules of a running server: list, use, remove, preview");
  rules->require_subcommand(1);
  CLI::App* list = rules->add_subcommand("list", "The rule sets in use");
  AddClientOptions(list, &arguments->client);
  list->callback([arguments, exit_code] { *exit_code = RulesClient(*arguments).List(); });
  constexpr char kNames[] = "rdfs, owl2rl, .rules files, or RDF files with sh:SPARQLRule";
  AddAction(rules, arguments, exit_code, "use", "Follow these rules, too; a set of the same name is replaced",
            kNames, &RulesClient::Use);
  AddAction(rules, arguments, exit_code, "remove", "Follow these rule sets no longer", "Names of rule sets",
            &RulesClient::Remove);
  AddAction(rules, arguments, exit_code, "preview",
            "What using these rules would add to the graph and remove from it; changes nothing", kNames,
            &RulesClient::Preview);
}

}  // namespace docent
