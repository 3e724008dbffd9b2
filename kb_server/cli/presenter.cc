#include "kb_server/cli/presenter.h"

#include <chrono>

#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/wire/term_proto.h"
#include "kb_server/cli/display_width.h"

namespace docent::server {
namespace {

// Names are for people: a result does not wait longer for them.
constexpr auto kPatience = std::chrono::seconds(2);

Terminal TerminalFor(const ClientOptions& options) {
  Terminal terminal = Terminal::OfOutput(options.colours);
  if (options.full) terminal.columns = 0;
  return terminal;
}

}  // namespace

IriNames ServerNames(const ClientOptions& options) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  v1::PrefixesReply reply;
  IriNames names;
  if (v1::Ontologies::NewStub(Connect(options))->Prefixes(&context, {}, &reply).ok()) {
    for (const v1::PrefixesReply::Prefix& prefix : reply.prefixes())
      names.Add(prefix.name(), prefix.namespace_());
  }
  for (const auto& [prefix, name_space] : IriNames::WellKnown().prefixes()) names.Add(prefix, name_space);
  return names;
}

Presenter::Presenter(const ClientOptions& options, const PrefixList& given)
    : Presenter(options, given, options.full || options.json ? IriNames() : ServerNames(options)) {}

Presenter::Presenter(const ClientOptions& options, const PrefixList& given, const IriNames& known)
    : full_(options.full), terminal_(TerminalFor(options)) {
  if (options.full || options.json) return;
  for (const auto& [prefix, name_space] : given) names_.Add(prefix, name_space);
  for (const auto& [prefix, name_space] : known.prefixes()) names_.Add(prefix, name_space);
}

std::string Presenter::Of(const v1::Term& term) const {
  return names_.Show(FromProto(term).value_or(Term::Literal("")));
}

std::string Presenter::Cut(std::string_view text, size_t columns) const {
  const std::string line = Printable(text);
  return full_ ? line : CutToWidth(line, columns);
}

std::string Presenter::Line(std::string_view text) const {
  return Printable(names_.InText(text));
}

std::string Presenter::State(std::string_view state) const {
  return terminal_.In(StyleOfState(state), state);
}

}  // namespace docent::server
