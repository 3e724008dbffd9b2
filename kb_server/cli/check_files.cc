#include "kb_server/cli/check_files.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/sparql/syntax/prefix_places.h"
#include "graph/store/server_graphs.h"
#include "kb_server/turn/spatial_functions.h"
#include "reasoner/ontology/meaning_check.h"
#include "reasoner/ontology/word_check.h"
#include "reasoner/rules/rule_parser.h"
#include "reasoner/shapes/shape_reader.h"

namespace docent::server {
namespace {

constexpr char kGraph[] = "urn:docent:checked";

std::vector<ontology::Finding> TakeAll(const std::string& file, ontology::Findings& findings) {
  const size_t left_out = findings.left_out();
  std::vector<ontology::Finding> out = findings.Take();
  if (left_out > 0) {
    out.push_back({"limit",
                   {file,
                    {},
                    absl::StrCat("and ", left_out, " more; the limit check_diagnostics is ", out.size()),
                    "correct these first",
                    Diagnostic::Severity::kWarning},
                   ""});
  }
  return out;
}

Diagnostic TooMuch(const std::string& file, const CheckLimits& limits) {
  return {
      file,
      {1, 1},
      absl::StrCat("the RDF documents of this check say more than fits into the limit check_memory_bytes = ",
                   limits.check_memory_bytes),
      "check fewer files at a time, or split the document"};
}

// The name by which a server knows a rule set.
std::string NameOf(const std::string& file) {
  return std::string(NameWithoutGz(std::filesystem::path(file).filename().string()));
}

// A clash is told as what it is, with the proof of the inconsistency that rests on the same fact.
bool IsProvedBy(const ontology::Finding& finding, const ConsistencyCheck::Result& result) {
  const bool domain = finding.rule == "domain-clash", range = finding.rule == "range-clash";
  const bool of_classes = result.check == "cax-dw" || result.check == "cax-adc" || result.check == "cls-com";
  if (!finding.proof.empty() ||
      !((domain && of_classes) || (range && (of_classes || result.check == "dt-not-type"))))
    return false;
  return std::any_of(result.told.begin(), result.told.end(), [&](const auto& told) {
    const SourceSpan& at = domain ? told.second.subject : told.second.object;
    const SourceSpan& found = finding.diagnostic.span;
    return told.first == finding.diagnostic.file && at.line == found.line && at.column == found.column;
  });
}

}  // namespace

std::vector<ontology::Finding> AsFindings(const std::string& rule, const Diagnostics& diagnostics) {
  std::vector<ontology::Finding> findings;
  for (const Diagnostic& diagnostic : diagnostics)
    findings.push_back({diagnostic.rule.empty() ? rule : diagnostic.rule, diagnostic, ""});
  return findings;
}

FileChecker::FileChecker(const CheckLimits& limits) : limits_(limits) {
  RegisterSpatialFunctions(&functions_);
}

Diagnostics FileChecker::AddRdf(const std::string& file, const RdfText& rdf, bool only_words) {
  const size_t before = memory_.used();
  ParseRdfOptions options = rdf.Options(file);
  options.memory = &memory_;
  options.blank_node_scope = absl::StrCat("f", ++texts_, "_");
  if (!only_words) options.refuse_graph = RefuseGraph;
  LocatedRdf document = ParseLocatedRdf(rdf.text, rdf.format, options);
  if (!document.rdf.stopped.ok()) {
    Diagnostic too_much = TooMuch(file, limits_);
    if (!document.rdf.diagnostics.empty()) too_much.span = document.rdf.diagnostics.back().span;
    document.rdf.diagnostics = {too_much};
  }
  if (!document.rdf.ok() || only_words) memory_.Release(memory_.used() - before);
  if (document.rdf.ok()) {
    vocabulary_.Add(document.rdf.quads);
    for (const auto& [prefix, name_space] : document.rdf.prefixes) names_.Add(prefix, name_space);
    if (!only_words) graph_.Add(file, document, kGraph);
    consistency_.AddDocument(file, document, !only_words);
    rules::ImportedRules imported = rules::ImportShaclRules(document, rdf.text, file, &functions_);
    RehearseData(file, document.rdf.quads);
    if (imported.ok() && imported.rules > 0) consistency_.AddRules(file, imported.text, !only_words);
    if (!only_words) imported_[file] = std::move(imported);
  }
  Diagnostics read = document.rdf.diagnostics;
  if (!only_words) documents_[file] = std::move(document);
  return read;
}

void FileChecker::AddRules(const std::string& file, const std::string& text) {
  refused_[file] =
      rehearsal_.LoadDocument({Document::Kind::kRules, Document::Action::kPut, NameOf(file), text, nullptr});
  // Rules beyond a limit of the server are beyond those of a check, too.
  if (!absl::IsResourceExhausted(refused_[file])) consistency_.AddRules(file, text, true);
}

void FileChecker::RehearseData(const std::string& file, const std::vector<TermQuad>& quads) {
  if (rehearsal_.facts() + quads.size() > limits_.check_facts) return;
  refused_[file] = rehearsal_.LoadData(quads);
}

void FileChecker::AddRefusal(const std::string& file, const std::string& text,
                             ontology::Findings& findings) const {
  const auto found = refused_.find(file);
  if (found == refused_.end() || found->second.ok()) return;
  if (findings.Find([](const ontology::Finding& f) {
        return f.diagnostic.severity == Diagnostic::Severity::kError;
      }) != nullptr)
    return;
  const std::string message(found->second.message());
  SourceSpan span;
  int number = 0;
  const rules::ParsedRules parsed = rules::ParseRules(text, NameOf(file), {}, &functions_);
  for (const rules::Rule& rule : parsed.rules) {
    if (absl::StartsWith(message, rules::RuleLabel(NameOf(file), rule, ++number))) span = rule.span;
  }
  findings.Error("load", span, absl::StrCat("a server refuses to load this: ", message), "");
}

std::vector<ontology::Finding> FileChecker::Rehearse(const Document& document) {
  refused_[document.name] = rehearsal_.LoadDocument(document);
  ontology::Findings findings(document.name, limits_.check_diagnostics);
  AddRefusal(document.name, "", findings);
  return TakeAll(document.name, findings);
}

void FileChecker::CheckImported(const std::string& file, ontology::Findings& findings) {
  const rules::ImportedRules& imported = imported_[file];
  for (const Diagnostic& d : imported.diagnostics) {
    findings.Add({d.severity == Diagnostic::Severity::kError ? "syntax" : "rule", d, ""});
  }
  for (const rules::ImportedConstruct& construct : imported.constructs) {
    ontology::Findings in_query(file, limits_.check_diagnostics);
    ontology::CheckWords(construct.query, vocabulary_, in_query);
    for (ontology::Finding& finding : in_query.Take()) {
      // a word is judged at its first place in the document
      if (findings.Find([&](const ontology::Finding& f) {
            return f.diagnostic.message == finding.diagnostic.message;
          }) != nullptr)
        continue;
      finding.diagnostic.span = construct.InDocument(finding.diagnostic.span);
      findings.Add(std::move(finding));
    }
  }
}

void FileChecker::AddInconsistencies(const std::string& file, ontology::Findings& findings) {
  if (!consistency_checked_) inconsistencies_ = consistency_.Run();
  consistency_checked_ = true;
  for (const ConsistencyCheck::Result& result : inconsistencies_[file]) {
    ontology::Finding* same =
        findings.Find([&](const ontology::Finding& f) { return IsProvedBy(f, result); });
    if (same != nullptr) {
      same->proof = result.finding.proof;
    } else {
      findings.Add(result.finding);
    }
  }
}

void FileChecker::CheckShapes() {
  shapes_read_ = true;
  const shapes::GraphView view = graph_.View(kGraph);
  for (Diagnostic& d :
       shapes::ReadShapes(view, graph_.dictionary(), limits_, &graph_.Places(kGraph), &functions_)
           .diagnostics) {
    of_shapes_[d.file].push_back(std::move(d));
  }
}

std::vector<ontology::Finding> FileChecker::CheckRdf(const std::string& file) {
  if (!shapes_read_) CheckShapes();
  const LocatedRdf& document = documents_[file];
  if (!document.rdf.ok()) return AsFindings("syntax", document.rdf.diagnostics);
  ontology::Findings findings(file, limits_.check_diagnostics);
  for (const Diagnostic& warning : document.rdf.diagnostics) {
    findings.Warning("syntax", warning.span, warning.message, warning.hint);
  }
  ontology::CheckWords(document, vocabulary_, findings);
  ontology::CheckMeaning(document, vocabulary_, &cycles_, findings);
  CheckImported(file, findings);
  AddInconsistencies(file, findings);
  AddRefusal(file, "", findings);
  for (const Diagnostic& d : of_shapes_[file]) {
    if (d.severity == Diagnostic::Severity::kError) {
      findings.Error("shape", d.span, d.message, d.hint);
    } else {
      findings.Warning("shape", d.span, d.message, d.hint);
    }
  }
  return TakeAll(file, findings);
}

std::vector<ontology::Finding> FileChecker::CheckRules(const std::string& file, const std::string& text) {
  const Diagnostics diagnostics = rules_.PutRules(file, text);
  if (HasErrors(diagnostics)) return AsFindings("syntax", diagnostics);
  ontology::Findings findings(file, limits_.check_diagnostics);
  for (const Diagnostic& d : diagnostics) findings.Warning("rule", d.span, d.message, d.hint);
  ontology::CheckWords(rules::ParseRules(text, file, {}, &functions_), vocabulary_, findings);
  ontology::CheckPrefixes(sparql::PrefixPlaces(text), findings);
  AddRefusal(file, text, findings);
  AddInconsistencies(file, findings);
  return TakeAll(file, findings);
}

std::vector<ontology::Finding> FileChecker::CheckQuery(const std::string& file, const std::string& text) {
  sparql::ParseOptions options = sparql::ParseOptionsWith({}, &functions_);
  options.file = file;
  const sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) return AsFindings("syntax", parsed.diagnostics);
  ontology::Findings findings(file, limits_.check_diagnostics);
  ontology::CheckWords(parsed.query, vocabulary_, findings);
  ontology::CheckPrefixes(sparql::PrefixPlaces(text), findings);
  return TakeAll(file, findings);
}

}  // namespace docent::server
