// docent check FILES: everything that can be said about files before a server has them. No server is needed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cassert>
#include <deque>
#include <filesystem>
#include <iostream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/data_files.h"
#include "graph/base/source_texts.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/check_files.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/text_file.h"
#include "kb_server/door/operation_signature.h"
#include "kb_server/door/parsed_document.h"
#include "nlohmann/json.hpp"
#include "reasoner/ontology/finding_kinds.h"
#include "workflow/cawl/check/check.h"
#include "workflow/cawl/check/subflow_names.h"
#include "workflow/cawl/parser.h"
#include "workflow/cawl/robot_choice.h"
#include "workflow/rsel/parser.h"
#include "workflow/rsel/service_registry.h"
#include "workflow/rsel/type_checks.h"

namespace docent::server {
namespace {

struct CheckArguments {
  std::vector<std::string> files;
  std::vector<std::string> ontologies;
  std::string base;
  bool ask = false;
  bool json = false;
  bool strict = false;
  bool full = false;
  bool fix = false;
};

// A fix may show what another one can mend.
constexpr int kMaxFixRounds = 10;

enum class Kind { kRdf, kSparql, kRules, kCawl, kRsel, kUnknown };

Kind KindOf(const std::string& packed_file) {
  const std::string file(NameWithoutGz(packed_file));
  if (absl::EndsWith(file, ".rules")) return Kind::kRules;
  if (absl::EndsWith(file, ".rq") || absl::EndsWith(file, ".sparql")) return Kind::kSparql;
  if (absl::EndsWith(file, ".cawl.xml") || absl::EndsWith(file, ".cawl")) return Kind::kCawl;
  if (absl::EndsWith(file, ".rsel.xml") || absl::EndsWith(file, ".rsel")) return Kind::kRsel;
  return FormatOfFile(file) ? Kind::kRdf : Kind::kUnknown;
}

// A text of whole lines.
std::string Indented(const std::string& text, const std::string& by) {
  std::string out;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty()))
    absl::StrAppend(&out, by, line, "\n");
  return out;
}

// How much of a file is read; of an unknown one, enough to say so.
TextLimit LimitOf(const std::string& file) {
  return KindOf(file) == Kind::kSparql ? kQueryText : kDocumentText;
}

bool HasErrorsIn(const std::vector<ontology::Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(), [](const ontology::Finding& f) {
    return f.diagnostic.severity == Diagnostic::Severity::kError;
  });
}

void Append(const std::vector<ontology::Finding>& more, std::vector<ontology::Finding>* findings) {
  findings->insert(findings->end(), more.begin(), more.end());
}

class Checker {
 public:
  explicit Checker(const CheckArguments& arguments) : arguments_(arguments) {
    environment_.SetFunctions(&files_.functions());
  }

  // Ontologies, RSEL processes and the names of workflows first, so that workflows are checked against them whatever the
  // order of the files.
  absl::Status Prepare() {
    const absl::StatusOr<std::vector<std::string>> own = OwnOntology();
    if (!own.ok()) return own.status();
    for (const std::vector<std::string>& files : {*own, arguments_.ontologies}) {
      for (const std::string& file : files) {
        if (absl::Status added = AddOntology(file); !added.ok()) return added;
      }
    }
    for (const std::string& file : arguments_.files) {
      if (KindOf(file) != Kind::kRdf) continue;
      auto rdf = ReadRdf(file, arguments_.base, "", kDocumentText);
      if (!rdf.ok()) return rdf.status();
      files_.AddRdf(file, *rdf, false);
      environment_.AddOntology(files_.QuadsOf(file));
      rdf_texts_[file] = std::move(rdf->text);
    }
    for (const std::string& file : arguments_.files) {
      if (KindOf(file) != Kind::kRules) continue;
      auto text = ReadBytes(file, kDocumentText);
      if (!text.ok()) return text.status();
      files_.AddRules(file, *text);
    }
    rsel::ServiceRegistry registry;
    std::vector<std::pair<std::string, rsel::DocumentPtr>> registered;
    std::map<std::string, std::string> texts;
    for (const std::string& file : arguments_.files) {
      if (KindOf(file) != Kind::kRsel) continue;
      auto text = ReadBytes(file, kDocumentText);
      if (!text.ok()) return text.status();
      rsel::ParsedRsel parsed = rsel::ParseRsel(*text, file);
      if (!parsed.ok()) continue;
      services_[file] = registry.Put(parsed.document);
      texts[file] = *std::move(text);
      registered.emplace_back(file, parsed.document);
    }
    for (const auto& [file, document] : registered) {
      for (Diagnostic& clash : rsel::CheckTypes(*document, registry, {}))
        services_[file].push_back(std::move(clash));
      if (HasErrors(services_[file])) continue;
      for (ontology::Finding& refused :
           files_.Rehearse({Document::Kind::kRsel, Document::Action::kPut, file, texts[file],
                            std::make_shared<const ParsedDocument>(document)}))
        refused_[file].push_back(std::move(refused));
    }
    for (const rsel::PlanPtr& plan : registry.Plans()) {
      environment_.AddOperation(SignatureOf(*plan));
      has_operations_ = true;
    }
    return AddWorkflows();
  }

  absl::Status Check(const std::string& file) {
    if (file == "-")
      return absl::InvalidArgumentError(
          "check does not read standard input: the ending of a file's name tells what is checked; save the "
          "text as "
          "a file, such as text.ttl");
    const auto known = rdf_texts_.find(file);
    absl::StatusOr<std::string> read =
        known != rdf_texts_.end() ? known->second : ReadBytes(file, LimitOf(file));
    if (!read.ok()) return read.status();
    const std::string* text = &read_.emplace_back(*std::move(read));
    for (const std::string& name : {file, std::string()}) texts_.Put(name, *text);
    std::vector<ontology::Finding> findings;
    switch (KindOf(file)) {
      case Kind::kRdf:
        findings = files_.CheckRdf(file);
        break;
      case Kind::kSparql:
        findings = files_.CheckQuery(file, *text);
        break;
      case Kind::kRules:
        findings = files_.CheckRules(file, *text);
        break;
      case Kind::kCawl:
        findings = CheckCawl(file, *text);
        break;
      case Kind::kRsel: {
        Diagnostics diagnostics = rsel::ParseRsel(*text, file).diagnostics;
        if (!HasErrors(diagnostics)) {
          const Diagnostics& of_registry = services_[file];
          diagnostics.insert(diagnostics.end(), of_registry.begin(), of_registry.end());
        }
        findings = AsFindings("service", diagnostics);
        if (!HasErrorsIn(findings)) Append(refused_[file], &findings);
        break;
      }
      case Kind::kUnknown:
        if (absl::Status unread = CheckFormatOfFile(file); !unread.ok()) return unread;
        return absl::InvalidArgumentError(
            absl::StrCat(file,
                         ": unknown file name extension; use .ttl .trig .nt .nq "
                         ".rdf .owl .xml .rq .sparql .rules .cawl.xml or .rsel.xml"));
    }
    if (arguments_.fix) {
      for (const ontology::Finding& finding : findings) fixable_[file].push_back(finding.diagnostic);
    } else {
      Print(file, findings);
    }
    return absl::OkStatus();
  }

  bool failed() const { return failed_; }

  // With --fix: makes the fixes of what was found, and says how many.
  absl::StatusOr<size_t> WriteFixes() const {
    size_t all = 0;
    for (const auto& [file, diagnostics] : fixable_) {
      const absl::StatusOr<std::string> text = ReadBytes(file);
      if (!text.ok()) return text.status();
      size_t applied = 0;
      const std::string fixed = ApplyFixes(*text, diagnostics, &applied);
      if (applied == 0) continue;
      if (NameWithoutGz(file) != file)
        return absl::InvalidArgumentError(absl::StrCat(file, " is packed; unpack it to have it fixed"));
      if (absl::Status status = ReplaceTextFile(file, fixed); !status.ok()) return status;
      std::cerr << file << ": " << applied << (applied == 1 ? " fix made\n" : " fixes made\n");
      all += applied;
    }
    return all;
  }

 private:
  // The modules of Docent's own ontology, but for those that are checked themselves. Without them a word of docent: that is
  // misspelt would not be seen: an error.
  absl::StatusOr<std::vector<std::string>> OwnOntology() const {
    const absl::StatusOr<std::string> core = FindDataFile("ontology/docent.ttl");
    if (!core.ok()) return core.status();
    std::vector<std::string> modules;
    std::error_code error;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(*core).parent_path(), error)) {
      const auto is_module = [&entry](const std::string& file) {
        std::error_code none;
        return std::filesystem::equivalent(file, entry.path(), none);
      };
      if (entry.path().extension() != ".ttl") continue;
      if (std::any_of(arguments_.files.begin(), arguments_.files.end(), is_module)) continue;
      modules.push_back(entry.path().string());
    }
    std::sort(modules.begin(), modules.end());
    return modules;
  }

  absl::Status AddOntology(const std::string& file) {
    auto rdf = ReadRdf(file, arguments_.base, "", kDocumentText);
    if (!rdf.ok()) return rdf.status();
    const Diagnostics read = files_.AddRdf(file, *rdf, true);
    if (HasErrors(read)) return ToStatus(read, rdf->text);
    environment_.AddOntology(ParseScoped(file, *rdf).quads);
    return absl::OkStatus();
  }

  // The workflows among the files, which each of them may name as a sub-flow.
  absl::Status AddWorkflows() {
    for (const std::string& file : arguments_.files) {
      if (KindOf(file) != Kind::kCawl) continue;
      auto text = ReadBytes(file);
      if (!text.ok()) return text.status();
      const cawl::ParsedCawl parsed = cawl::ParseCawl(*text, file);
      if (parsed.document == nullptr) continue;
      for (const std::string& name : cawl::SubflowNames(*parsed.document))
        environment_.AddApplicationService(name);
      workflows_.push_back(parsed.document);
    }
    return absl::OkStatus();
  }

  // Blank nodes of different files are different.
  ParsedRdf ParseScoped(const std::string& file, const RdfText& rdf) {
    ParseRdfOptions options = rdf.Options(file);
    options.blank_node_scope = absl::StrCat("e", ++scopes_, "_");
    return ParseRdf(rdf.text, rdf.format, options);
  }

  std::vector<ontology::Finding> CheckCawl(const std::string& file, const std::string& text) {
    // Where only workflows are given, it is not known which robots, services and other flows there are.
    environment_.SetKnowsServices(has_operations_ || !rdf_texts_.empty() || !arguments_.ontologies.empty());
    const bool knows = environment_.KnowsServices() || environment_.HasWords();
    cawl::CheckReport report =
        cawl::CheckDocument(text, file, knows ? &environment_ : nullptr, {}, workflows_);
    std::vector<ontology::Finding> findings = AsFindings("workflow", report.diagnostics);
    if (report.ok()) {
      Append(files_.Rehearse({Document::Kind::kCawl, Document::Action::kPut, file, text,
                              std::make_shared<const ParsedDocument>(report.document)}),
             &findings);
    }
    if (!arguments_.ask || arguments_.fix) return findings;
    for (const cawl::ConditionText& condition : report.conditions)
      PrintQuery(file, condition.place, "ask", condition.ask);
    if (report.ok()) PrintChoices(file, *report.document);
    return findings;
  }

  void PrintQuery(const std::string& file, const std::string& place, const char* kind,
                  const std::string& text) {
    if (arguments_.json) {
      nlohmann::json object = {{"file", file}, {"place", place}, {kind, text}};
      std::cout << PrintableJson(object.dump()) << "\n";
    } else {
      std::cout << "# " << place << "\n" << text << "\n\n";
    }
  }

  // By which query a robot is chosen, where several are free.
  void PrintChoices(const std::string& file, const cawl::Document& document) {
    bool by_default = false;
    for (const cawl::Flow& flow : document.flows) {
      for (const cawl::Node& node : flow.nodes) {
        for (const cawl::Invoke& invoke : node.invokes) {
          by_default = by_default || (!invoke.operation.empty() && invoke.choose.empty());
          if (invoke.choose.empty()) continue;
          PrintQuery(file,
                     absl::StrCat("flow ", flow.name.value, " / node ", node.name.value,
                                  " / choice of a robot for ", invoke.operation.value),
                     "choose", invoke.choose);
        }
      }
    }
    if (!by_default) return;
    PrintQuery(file, "choice of a robot, where an invoke has no ext:choose and several are free", "choose",
               std::string(cawl::DefaultRobotChoice()));
  }

  // A text for people, by the prefixes of the files.
  std::string Named(const std::string& text) const {
    return arguments_.full ? text : files_.names().InText(text);
  }

  void Print(const std::string& file, const std::vector<ontology::Finding>& findings) {
    Diagnostics diagnostics;
    for (const ontology::Finding& finding : findings) {
      assert(ontology::IsFindingKind(finding.rule));  // so that the documentation lists it
      diagnostics.push_back(finding.diagnostic);
    }
    const bool bad = HasErrors(diagnostics) || (arguments_.strict && !diagnostics.empty());
    failed_ = failed_ || bad;
    if (arguments_.json) {
      for (const ontology::Finding& finding : findings) {
        const Diagnostic& d = finding.diagnostic;
        nlohmann::json object = {
            {"file", d.file.empty() ? file : d.file},
            {"line", d.span.line},
            {"column", d.span.column},
            {"severity", d.severity == Diagnostic::Severity::kError ? "error" : "warning"},
            {"rule", finding.rule},
            {"message", d.message},
            {"hint", d.hint}};
        if (!finding.proof.empty()) object["proof"] = finding.proof;
        for (const TextEdit& edit : d.fix)
          object["fix"].push_back(
              {{"offset", edit.offset}, {"length", edit.length}, {"replacement", edit.replacement}});
        std::cout << PrintableJson(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
                  << "\n";
      }
      return;
    }
    for (const ontology::Finding& finding : findings) {
      Diagnostic shown = finding.diagnostic;
      shown.message = Named(shown.message);
      shown.hint = Named(shown.hint);
      std::cerr << texts_.Render({shown});
      if (!finding.proof.empty()) std::cerr << "  proof:\n" << Indented(Named(finding.proof), "    ");
    }
    if (bad || arguments_.ask) return;
    std::cout << file << ": ok";
    if (!findings.empty())
      std::cout << ", " << findings.size() << (findings.size() == 1 ? " warning" : " warnings");
    std::cout << "\n";
  }

  const CheckArguments& arguments_;
  FileChecker files_;
  std::map<std::string, std::string> rdf_texts_;  // in UTF-8, by file
  std::deque<std::string> read_;
  SourceTexts texts_;  // of them
  cawl::QuadEnvironment environment_;
  bool has_operations_ = false;
  std::vector<cawl::DocumentPtr> workflows_;    // of the files
  std::map<std::string, Diagnostics> fixable_;  // with --fix: what was found, by file
  size_t scopes_ = 0;
  std::map<std::string, Diagnostics> services_;                    // what the registry says of each RSEL file
  std::map<std::string, std::vector<ontology::Finding>> refused_;  // RSEL files that a server refuses
  bool failed_ = false;
};

}  // namespace

namespace {

int CheckFiles(const CheckArguments& arguments) {
  Checker checker(arguments);
  if (absl::Status status = checker.Prepare(); !status.ok()) return Fail(status);
  int exit_code = kExitOk;
  for (const std::string& file : arguments.files) {
    if (absl::Status status = checker.Check(file); !status.ok()) exit_code = Fail(status);
  }
  return exit_code == kExitOk && checker.failed() ? kExitNegative : exit_code;
}

// Makes fixes until there are none, or a file cannot be read or written.
absl::Status FixFiles(CheckArguments arguments) {
  arguments.fix = true;
  for (int round = 0; round < kMaxFixRounds; ++round) {
    Checker checker(arguments);
    if (absl::Status status = checker.Prepare(); !status.ok()) return status;
    for (const std::string& file : arguments.files) {
      if (absl::Status status = checker.Check(file); !status.ok()) return status;
    }
    const absl::StatusOr<size_t> made = checker.WriteFixes();
    if (!made.ok() || *made == 0) return made.status();
  }
  return absl::OkStatus();
}

}  // namespace

void AddCheckCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command =
      app->add_subcommand("check", "Check RDF, SPARQL, rules, CAWL and RSEL files, without a server");
  command->group(kDocumentsGroup);
  command
      ->add_option(
          "files", arguments->files,
          "Files; the ending of the name tells what each is. The words of RDF, rules and queries are checked "
          "against Docent's ontology and the vocabulary of all RDF files that are named; workflows may "
          "invoke each other and the "
          "robot services that are named")
      ->required();
  command
      ->add_option("--ontology", arguments->ontologies,
                   "Ontology file whose words may be used, too; the option stands before each")
      ->type_name("FILE")
      ->allow_extra_args(false);
  AddBaseOption(command, &arguments->base, /*standard_input=*/false);
  command->add_flag(
      "--ask", arguments->ask,
      "Print the SPARQL ASK that each CAWL condition is compiled to, and the query that chooses a robot");
  command->add_flag("--strict", arguments->strict, "Treat warnings as errors");
  command->add_flag(
      "--json", arguments->json,
      "Print JSON, an object a finding; where a remedy is evident, its field fix has it as edits "
      "of the file's bytes");
  command->add_flag("--fix", arguments->fix,
                    "Make the remedies that are evident in the files, and report the rest");
  command->add_flag("--full", arguments->full, "Print whole IRIs, not named by the files' prefixes");
  command->footer(
      "Exit code 1: errors were found.\n"
      "It needs Docent's own ontology, which it looks for beside the program; of a copied program, "
      "DOCENT_DATA_DIR "
      "names the folder in which the folder ontology is.\n"
      "Example:\n"
      "  docent check hall.ttl guide.rules booth_guide.cawl.xml --ontology place.ttl");
  command->callback([arguments, exit_code] {
    if (arguments->fix) {
      if (absl::Status status = FixFiles(*arguments); !status.ok()) {
        *exit_code = Fail(status);
        return;
      }
    }
    arguments->fix = false;
    *exit_code = CheckFiles(*arguments);
  });
}

}  // namespace docent::server
