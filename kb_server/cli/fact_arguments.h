// Facts and IRIs that people write on a command line, with prefixes known beforehand. One thread.
#ifndef DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_
#define DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/term.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {

// Known are the well-known prefixes, those of --prefix, and, where these do not do, those of the server: what it prints can
// be given back to it.
class FactArguments {
 public:
  // `ask_server` is called at most once, when a prefix is not known otherwise.
  explicit FactArguments(std::function<IriNames()> ask_server) : ask_server_(std::move(ask_server)) {}

  // "NAME=IRI", "NAME:=IRI" or ":=IRI", as --prefix takes them. INVALID_ARGUMENT: it is none of these.
  absl::Status AddPrefixes(const std::vector<std::string>& given);
  const PrefixList& given() const { return given_; }

  // Turtle → quads. A missing last full stop is added: people forget it on a command line. `name`: for diagnostics.
  absl::StatusOr<std::vector<TermQuad>> Parse(std::string text, const std::string& name);

  // An IRI where no Turtle is expected: a name with a known prefix, <…>, or the IRI itself.
  std::string Iri(const std::string& text);
  // A line for each text given to Iri whose prefix is unknown, so that it was taken as a whole IRI: says so, and how to declare the
  // prefix. For commands that do not find the thing with that IRI.
  const std::string& taken_whole() const { return taken_whole_; }

  // What a prefix stands for; nullopt: the server does not know it, either.
  std::optional<std::string> Namespace(std::string_view prefix);

 private:
  std::string Prologue() const;
  const std::string* NamespaceOf(const std::string& prefix) const;
  // False: it was asked before.
  bool AskServer();

  const std::function<IriNames()> ask_server_;
  bool asked_ = false;
  PrefixList given_;
  std::string taken_whole_;
  IriNames known_ = IriNames::WellKnown();
};

void AddQuads(const std::vector<TermQuad>& quads, google::protobuf::RepeatedPtrField<v1::Quad>* out);

// Where facts that are withdrawn from one graph are told or inferred as well, a line each with how to withdraw them there;
// empty where nowhere, or where the server does not say.
std::string WhereElse(v1::Context::Stub& server, const google::protobuf::RepeatedPtrField<v1::Quad>& facts,
                      const Presenter& presenter);

// Names for the texts of an answer: the known ones, then those given, which win.
void AddPrefixes(const IriNames& known, const PrefixList& given,
                 google::protobuf::Map<std::string, std::string>* out);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_FACT_ARGUMENTS_H_
