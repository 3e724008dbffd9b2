// docent ontology: the modules of a running server, changed while it runs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/result_json.h"
#include "kb_server/door/catalog.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/validation_proto.h"
#include "nlohmann/json.hpp"
#include "reasoner/ontology/module_diff.h"
#include "reasoner/shapes/report.h"

namespace docent::server {
namespace {

struct OntologyArguments {
  ClientOptions client;
  std::vector<std::string> files;  // load, replace, check, diff
  std::string name;                // the module; empty: the file's name
  std::string base;                // IRI; empty: the file's
  std::vector<std::string> names;  // remove
};

std::string NameOf(const OntologyArguments& arguments, const std::string& file) {
  if (!arguments.name.empty()) return arguments.name;
  return std::string(NameWithoutGz(std::filesystem::path(file).filename().string()));
}

std::string VersionText(const std::string& info, const std::string& iri) {
  if (info.empty()) return iri.empty() ? "" : Concat("version <", iri, ">");
  return Concat("version ", info);
}

bool IsRules(const v1::ListOntologiesReply::Module& module) {
  return module.kind() == v1::LoadRequest::RULES;
}

void PrintModuleJson(const v1::ListOntologiesReply::Module& module) {
  nlohmann::json object = {
      {"name", module.name()},           {"kind", IsRules(module) ? "rules" : "ontology"},
      {"size", module.size()},           {"revision", module.revision()},
      {"ontology", module.ontology()},   {"version_iri", module.version_iri()},
      {"version", module.version_info()}};
  object["missing_imports"] =
      std::vector<std::string>(module.missing_imports().begin(), module.missing_imports().end());
  std::cout << PrintableJson(object.dump()) << "\n";
}

int List(const OntologyArguments& arguments) {
  v1::ListOntologiesReply reply;
  grpc::ClientContext context;
  grpc::Status status =
      v1::Ontologies::NewStub(Connect(arguments.client))->List(&context, v1::ListOntologiesRequest(), &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    for (const auto& module : reply.modules()) PrintModuleJson(module);
    return kExitOk;
  }
  const Presenter presenter(arguments.client, {}, IriNames::WellKnown());
  Table table({"module", "size", "since revision", "version", "ontology"});
  table.KeepWhole({0});
  for (const auto& module : reply.modules()) {
    table.Add({module.name(), absl::StrCat(module.size(), IsRules(module) ? " rules" : " triples"),
               absl::StrCat(module.revision()), VersionText(module.version_info(), module.version_iri()),
               module.ontology()});
  }
  if (table.rows() > 0) std::cout << table.Render(presenter.terminal());
  for (const auto& module : reply.modules()) {
    for (const std::string& iri : module.missing_imports())
      std::cout << module.name() << " imports <" << iri << ">, which is not loaded\n";
  }
  return kExitOk;
}

absl::StatusOr<v1::LoadRequest> ToRequest(const OntologyArguments& arguments, const std::string& file) {
  auto rdf = ReadRdfToSend(file, arguments.base);
  if (!rdf.ok()) return rdf.status();
  v1::LoadRequest request;
  request.set_name(NameOf(arguments, file));
  request.set_kind(v1::LoadRequest::ONTOLOGY);
  request.set_text(std::move(rdf->text));
  request.set_media_type(MediaTypeOf(rdf->format));
  request.set_base_iri(rdf->base_iri);
  return request;
}

int Load(const OntologyArguments& arguments, v1::LoadRequest::Mode mode) {
  auto stub = v1::Ontologies::NewStub(Connect(arguments.client));
  for (const std::string& file : arguments.files) {
    auto request = ToRequest(arguments, file);
    if (!request.ok()) return Fail(request.status());
    request->set_mode(mode);
    v1::LoadReply reply;
    grpc::ClientContext context;
    grpc::Status status = stub->Load(&context, *request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    PrintDiagnostics(reply.diagnostics());
    if (arguments.client.json) {
      nlohmann::json object = {{"name", request->name()},
                               {"added", reply.added()},
                               {"removed", reply.removed()},
                               {"inferred", reply.inferred()},
                               {"revision", reply.revision()}};
      std::cout << PrintableJson(object.dump()) << "\n";
      continue;
    }
    std::cout << request->name() << ": " << reply.added() << " added, " << reply.removed() << " removed, "
              << reply.inferred() << " inferred, revision " << reply.revision() << "\n";
  }
  return kExitOk;
}

nlohmann::json PlaceJson(const std::string& file, int line, int column) {
  return {{"file", file}, {"line", line}, {"column", column}};
}

// The results as `docent validate --json` has them.
void PrintCheckJson(const std::string& name, const v1::CheckModuleReply& reply) {
  nlohmann::json object = {{"name", name}, {"conforms", reply.conforms()}, {"revision", reply.revision()}};
  object["results"] = nlohmann::json::array();
  for (const v1::ValidationResult& result : reply.results())
    object["results"].push_back(ResultJson(FromProto(result)));
  object["diagnostics"] = nlohmann::json::array();
  for (const v1::Diagnostic& d : reply.diagnostics()) {
    nlohmann::json diagnostic = PlaceJson(d.file(), d.line(), d.column());
    diagnostic["severity"] = d.warning() ? "warning" : "error";
    diagnostic["message"] = d.message();
    diagnostic["hint"] = d.hint();
    object["diagnostics"].push_back(std::move(diagnostic));
  }
  std::cout << PrintableJson(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) << "\n";
}

int Check(const OntologyArguments& arguments) {
  auto stub = v1::Ontologies::NewStub(Connect(arguments.client));
  int exit_code = kExitOk;
  for (const std::string& file : arguments.files) {
    auto request = ToRequest(arguments, file);
    if (!request.ok()) return Fail(request.status());
    v1::CheckModuleReply reply;
    grpc::ClientContext context;
    grpc::Status status = stub->Check(&context, *request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    if (!reply.conforms()) exit_code = kExitNegative;
    if (arguments.client.json) {
      PrintCheckJson(request->name(), reply);
      continue;
    }
    PrintDiagnostics(reply.diagnostics());
    for (const v1::ValidationResult& r : reply.results()) {
      std::cerr << shapes::Render(FromProto(r));
    }
    std::cout << request->name() << (reply.conforms() ? ": ok" : ": would violate shapes")
              << ", tried on revision " << reply.revision() << "\n";
  }
  return exit_code;
}

int Remove(const OntologyArguments& arguments) {
  auto stub = v1::Ontologies::NewStub(Connect(arguments.client));
  for (const std::string& name : arguments.names) {
    v1::RemoveOntologyRequest request;
    request.set_name(name);
    request.set_kind(v1::LoadRequest::ONTOLOGY);
    v1::LoadReply reply;
    grpc::ClientContext context;
    grpc::Status status = stub->Remove(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    if (arguments.client.json) {
      std::cout << nlohmann::json(
                       {{"name", name}, {"removed", reply.removed()}, {"revision", reply.revision()}})
                       .dump()
                << "\n";
      continue;
    }
    std::cout << name << ": " << reply.removed() << " removed, revision " << reply.revision() << "\n";
  }
  return kExitOk;
}

// Asked where its graph is empty: a module may be.
bool IsListed(const OntologyArguments& arguments, const std::string& name) {
  v1::ListOntologiesReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::Ontologies::NewStub(Connect(arguments.client))->List(&context, v1::ListOntologiesRequest(), &reply);
  return status.ok() && std::any_of(reply.modules().begin(), reply.modules().end(), [&](const auto& module) {
           return module.kind() == v1::LoadRequest::ONTOLOGY && module.name() == name;
         });
}

// The triples of a module as the server has them.
absl::StatusOr<std::vector<TermQuad>> Fetch(const OntologyArguments& arguments, const std::string& name,
                                            int* exit_code) {
  v1::QueryRequest request;
  request.set_query(absl::StrCat("CONSTRUCT { ?s ?p ?o } WHERE { GRAPH ",
                                 ToNTriples(Term::Iri(OntologyGraph(name))), " { ?s ?p ?o } }"));
  grpc::ClientContext context;
  auto reader = v1::Context::NewStub(Connect(arguments.client))->Query(&context, request);
  std::vector<TermQuad> quads;
  v1::QueryReply reply;
  while (reader->Read(&reply)) {
    if (!reply.has_quad()) continue;
    auto quad = FromProto(reply.quad(), "triple", Limits());
    if (!quad.ok()) return quad.status();
    quads.push_back(*std::move(quad));
  }
  grpc::Status status = reader->Finish();
  if (!status.ok()) {
    *exit_code = Fail(status, arguments.client);
    return absl::UnavailableError("");
  }
  if (quads.empty() && !IsListed(arguments, name))
    return absl::NotFoundError(absl::StrCat("the server has no module \"", name, "\""));
  return quads;
}

// The file's prefixes go to the end of `prefixes`.
absl::StatusOr<std::vector<TermQuad>> Parse(const OntologyArguments& arguments, const std::string& file,
                                            PrefixList* prefixes) {
  auto rdf = ReadRdf(file, arguments.base);
  if (!rdf.ok()) return rdf.status();
  ParseRdfOptions options = rdf->Options(file);
  options.blank_node_scope = "file_";
  ParsedRdf parsed = ParseRdf(rdf->text, rdf->format, options);
  if (!parsed.ok()) return ToStatus(parsed, rdf->text);
  prefixes->insert(prefixes->end(), parsed.prefixes.begin(), parsed.prefixes.end());
  return std::move(parsed.quads);
}

void PrintChanges(char sign, const std::vector<TermQuad>& triples, const Presenter& presenter) {
  for (const TermQuad& t : triples) {
    std::cout << sign << " " << presenter.Of(t.subject) << " " << presenter.Of(t.predicate) << " "
              << presenter.Of(t.object) << "\n";
  }
}

nlohmann::json AsJson(const std::vector<TermQuad>& triples) {
  nlohmann::json list = nlohmann::json::array();
  for (const TermQuad& t : triples) {
    list.push_back(
        absl::StrCat(ToNTriples(t.subject), " ", ToNTriples(t.predicate), " ", ToNTriples(t.object)));
  }
  return list;
}

// One file: the server's module against it. Two: the first against the second.
int Diff(const OntologyArguments& arguments) {
  int exit_code = kExitOk;
  PrefixList prefixes;
  auto after = Parse(arguments, arguments.files.back(), &prefixes);
  if (!after.ok()) return Fail(after.status());
  auto before = arguments.files.size() == 1
                    ? Fetch(arguments, NameOf(arguments, arguments.files[0]), &exit_code)
                    : Parse(arguments, arguments.files[0], &prefixes);
  if (exit_code != kExitOk) return exit_code;
  if (!before.ok()) return Fail(before.status());
  const ontology::ModuleDiff diff = ontology::DiffModules(*before, *after);
  const ontology::ModuleVersion old_version = ontology::VersionOf(*before),
                                new_version = ontology::VersionOf(*after);
  if (arguments.client.json) {
    nlohmann::json object = {{"removed", AsJson(diff.removed)},
                             {"added", AsJson(diff.added)},
                             {"version_before", old_version.version_info},
                             {"version_after", new_version.version_info}};
    std::cout << PrintableJson(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) << "\n";
    return diff.empty() ? kExitOk : kExitNegative;
  }
  const std::string from = VersionText(old_version.version_info, old_version.version_iri);
  const std::string to = VersionText(new_version.version_info, new_version.version_iri);
  if (from != to)
    std::cout << "# " << (from.empty() ? "no version" : from) << " → " << (to.empty() ? "no version" : to)
              << "\n";
  const Presenter presenter = arguments.files.size() == 1
                                  ? Presenter(arguments.client, prefixes)
                                  : Presenter(arguments.client, prefixes, IriNames::WellKnown());
  PrintChanges('-', diff.removed, presenter);
  PrintChanges('+', diff.added, presenter);
  std::cout << "# " << diff.removed.size() << " removed, " << diff.added.size() << " added\n";
  return diff.empty() ? kExitOk : kExitNegative;
}

CLI::App* AddPart(CLI::App* command, const std::shared_ptr<OntologyArguments>& arguments, const char* name,
                  const char* help, const std::function<int(const OntologyArguments&)>& run, int* exit_code) {
  CLI::App* part = command->add_subcommand(name, help);
  AddClientOptions(part, &arguments->client);
  part->callback([arguments, run, exit_code] { *exit_code = run(*arguments); });
  return part;
}

}  // namespace

void AddOntologyCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<OntologyArguments>();
  CLI::App* command =
      app->add_subcommand("ontology", "List, load, compare and remove the server's ontology modules");
  command->group(kDocumentsGroup);
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  docent ontology list\n"
      "  docent ontology replace place.ttl");
  const auto part = [&](const char* name, const char* help,
                        const std::function<int(const OntologyArguments&)>& run) {
    return AddPart(command, arguments, name, help, run, exit_code);
  };
  const auto with_files = [&arguments](CLI::App* to, const char* help) {
    to->add_option("files", arguments->files, help)->required();
    to->add_option("--name", arguments->name, "Name of the module; by default the name of the file")
        ->type_name("NAME");
    AddBaseOption(to, &arguments->base);
    return to;
  };
  CLI::App* list = part("list", "List the modules with size, revision and version", List);
  AddShowOptions(list, &arguments->client);
  list->footer("Example:\n  docent ontology list --json");
  with_files(part("load", "Load new modules; refuses a module that the server already has",
                  [](const auto& a) { return Load(a, v1::LoadRequest::ADD); }),
             "RDF files, a module each")
      ->footer("Example:\n  docent ontology load place.ttl robot.ttl");
  with_files(part("replace", "Replace modules by new versions while the server runs",
                  [](const auto& a) { return Load(a, v1::LoadRequest::REPLACE); }),
             "RDF files, a module each")
      ->footer("Example:\n  docent ontology replace place.ttl");
  with_files(part("check", "Tell which of the server's shapes loading the modules would violate", Check),
             "RDF files, a module each")
      ->footer("Exit code 1: shapes would be violated.\nExample:\n  docent ontology check place.ttl");
  CLI::App* remove = part("remove", "Remove modules", Remove);
  remove->add_option("names", arguments->names, "Names of modules, as `docent ontology list` prints them")
      ->required();
  remove->footer("Example:\n  docent ontology remove place.ttl");
  CLI::App* diff = with_files(
      part("diff", "Compare the server's module with a file, or two files, triple by triple", Diff),
      "One file, which is compared with the server's module of that name, or two files");
  AddShowOptions(diff, &arguments->client);
  diff->get_option("files")->expected(1, 2);
  diff->footer("Exit code 1: they are different.\nExample:\n  docent ontology diff place.ttl");
}

}  // namespace docent::server
