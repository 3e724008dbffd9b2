#include "kb_server/cli/fact_arguments.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/vocabulary.h"
#include "graph/wire/term_proto.h"
#include "kb_server/cli/client.h"

namespace docent::server {
namespace {

// PN_PREFIX of Turtle's grammar, or empty.
bool IsPrefixName(const std::string& name) {
  return name.find_first_of(" \t\r\n:<>#") == std::string::npos &&
         ParseRdf(absl::StrCat("@prefix ", name, ": <urn:docent:x> ."), RdfFormat::kTurtle, {}).ok();
}

// "NAME=IRI", "NAME:=IRI" or ":=IRI".
absl::StatusOr<std::pair<std::string, std::string>> SplitPrefix(const std::string& given) {
  std::pair<std::string, std::string> parts = absl::StrSplit(given, absl::MaxSplits('=', 1));
  if (parts.first.empty() || parts.second.empty())
    return absl::InvalidArgumentError(
        absl::StrCat("--prefix \"", given, "\" is not NAME=IRI, nor :=IRI for the empty prefix"));
  if (parts.first.back() == ':') parts.first.pop_back();
  if (!IsPrefixName(parts.first)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--prefix \"", given, "\": \"", parts.first,
        "\" is not the name of a prefix; it begins with a letter, and letters, digits, \"-\", \"_\" "
        "and \".\" may follow"));
  }
  if (!IsValidTermIri(parts.second)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--prefix \"", given, "\": \"", parts.second, "\" is not an absolute IRI"));
  }
  return parts;
}

// A hint of a Turtle text says how a file declares a prefix; here it is said how a command line does.
std::string ForCommandLine(const std::string& hint) {
  constexpr std::string_view kDeclares = "declare it: @prefix ";
  const size_t at = hint.find(kDeclares);
  if (at == std::string::npos) return hint;
  const std::string declared = hint.substr(at + kDeclares.size());  // "expo: <https://…> ."
  const std::string prefix = declared.substr(0, declared.find(':'));
  const size_t open = declared.find('<'), close = declared.rfind('>');
  std::string iri = open < close ? declared.substr(open + 1, close - open - 1) : "…";
  if (iri == "…") iri = "IRI";
  return absl::StrCat(hint.substr(0, at), "declare it with --prefix ", prefix.empty() ? ":" : prefix, "=",
                      iri, ", or write the IRI whole: <…>");
}

}  // namespace

absl::Status FactArguments::AddPrefixes(const std::vector<std::string>& given) {
  for (const std::string& each : given) {
    auto parts = SplitPrefix(each);
    if (!parts.ok()) return parts.status();
    given_.push_back(*std::move(parts));
  }
  return absl::OkStatus();
}

// All in one line, so that the columns of diagnostics stay right from the second line on. As in Turtle, the last
// declaration of a prefix holds.
std::string FactArguments::Prologue() const {
  std::string text;
  for (const auto& [prefix, name_space] : known_.prefixes())
    absl::StrAppend(&text, "@prefix ", prefix, ": <", name_space, "> . ");
  for (const auto& [prefix, name_space] : given_)
    absl::StrAppend(&text, "@prefix ", prefix, ": <", name_space, "> . ");
  return text + "\n";
}

bool FactArguments::AskServer() {
  if (std::exchange(asked_, true)) return false;
  const IriNames names = ask_server_();
  for (const auto& [prefix, name_space] : names.prefixes()) known_.Add(prefix, name_space);
  return true;
}

absl::StatusOr<std::vector<TermQuad>> FactArguments::Parse(std::string text, const std::string& name) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\n')) text.pop_back();
  if (text.empty()) return std::vector<TermQuad>();
  if (text.back() != '.') text += " .";
  ParseRdfOptions options;
  options.file = name;
  std::string prologue = Prologue();
  ParsedRdf parsed = ParseRdf(prologue + text, RdfFormat::kTurtle, options);
  if (!parsed.ok() && AskServer()) {
    prologue = Prologue();
    parsed = ParseRdf(prologue + text, RdfFormat::kTurtle, options);
  }
  if (!parsed.ok()) {
    for (Diagnostic& d : parsed.diagnostics) {
      d.hint = ForCommandLine(d.hint);
      if (d.span.line > 1) --d.span.line;
      d.span.offset -= std::min(d.span.offset, prologue.size());
    }
    return ToStatus(parsed.diagnostics, text);
  }
  return std::move(parsed.quads);
}

const std::string* FactArguments::NamespaceOf(const std::string& prefix) const {
  for (auto given = given_.rbegin(); given != given_.rend(); ++given) {
    if (given->first == prefix) return &given->second;
  }
  for (const auto& [name, name_space] : known_.prefixes()) {
    if (name == prefix) return &name_space;
  }
  return nullptr;
}

std::optional<std::string> FactArguments::Namespace(std::string_view prefix) {
  const std::string name(prefix);
  const std::string* found = NamespaceOf(name);
  if (found == nullptr && AskServer()) found = NamespaceOf(name);
  return found != nullptr ? std::optional<std::string>(*found) : std::nullopt;
}

std::string FactArguments::Iri(const std::string& text) {
  if (absl::StartsWith(text, "<") && absl::EndsWith(text, ">")) return text.substr(1, text.size() - 2);
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return text;
  const std::string prefix = text.substr(0, colon);
  const std::string local = text.substr(colon + 1);
  const std::string* name_space = NamespaceOf(prefix);
  const bool whole = absl::StartsWith(local, "//") || prefix == "urn";
  if (name_space == nullptr && !whole && AskServer()) name_space = NamespaceOf(prefix);
  if (name_space != nullptr) return *name_space + local;
  if (!whole) {
    absl::StrAppend(&taken_whole_, text, " was taken as a whole IRI: the prefix ", prefix,
                    ": is not known; declare it with --prefix ", prefix.empty() ? ":" : prefix, "=IRI\n");
  }
  return text;
}

void AddQuads(const std::vector<TermQuad>& quads, google::protobuf::RepeatedPtrField<v1::Quad>* out) {
  for (const TermQuad& quad : quads) ToProto(quad, out->Add());
}

std::string WhereElse(v1::Context::Stub& server, const google::protobuf::RepeatedPtrField<v1::Quad>& facts,
                      const Presenter& presenter) {
  v1::QueryRequest request;
  request.set_default_graph(v1::QueryRequest::UNION);
  for (const v1::Quad& fact : facts) {
    if (fact.subject().has_blank() || fact.object().has_blank()) continue;  // no query can name it
    absl::StrAppend(request.mutable_query(), "(", ToNTriples(fact.subject()), " ",
                    ToNTriples(fact.predicate()), " ", ToNTriples(fact.object()), ") ");
  }
  if (request.query().empty()) return "";
  request.set_query(absl::StrCat("SELECT ?s ?p ?o ?g WHERE { VALUES (?s ?p ?o) { ", request.query(),
                                 "} GRAPH ?g { ?s ?p ?o } } LIMIT 10"));
  grpc::ClientContext context;
  const auto reader = server.Query(&context, request);
  std::string text;
  for (v1::QueryReply reply; reader->Read(&reply);) {
    if (reply.row().values_size() != 4) continue;
    const auto word = [&](int i) { return presenter.Of(reply.row().values(i)); };
    const std::string graph = reply.row().values(3).iri();
    absl::StrAppend(&text, word(0), " ", word(1), " ", word(2), " ",
                    graph == kInferredGraph ? "is inferred; docent why tells from what"
                    : graph == kDefaultGraph
                        ? "is told by docent:default; withdraw it there without --source"
                        : absl::StrCat("is told by ", word(3), "; withdraw it there with --source ", word(3)),
                    "\n");
  }
  return reader->Finish().ok() ? text : "";
}

void AddPrefixes(const IriNames& known, const PrefixList& given,
                 google::protobuf::Map<std::string, std::string>* out) {
  for (const auto& [prefix, name_space] : known.prefixes()) (*out)[prefix] = name_space;
  for (const auto& [prefix, name_space] : given) (*out)[prefix] = name_space;
}

}  // namespace docent::server
