// What the commands that show results to people share: the names of IRIs, the terminal, tables. One thread.
#ifndef DOCENT_KB_SERVER_CLI_PRESENTER_H_
#define DOCENT_KB_SERVER_CLI_PRESENTER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/term.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/table.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {

using PrefixList = std::vector<std::pair<std::string, std::string>>;

// The prefixes that the server knows, the well-known ones among them. Those alone where it does not say so soon: they are
// only for people.
IriNames ServerNames(const ClientOptions& options);

// Names of IRIs, colours and the width of the terminal, for one result.
class Presenter {
 public:
  // `given`: prefixes of the command line or of the query's text, which come before the server's. Asks the server, unless
  // IRIs are to be whole (--full) or the result is JSON.
  explicit Presenter(const ClientOptions& options, const PrefixList& given = {});
  // The same with prefixes that are known already, instead of the server's.
  Presenter(const ClientOptions& options, const PrefixList& given, const IriNames& known);

  const IriNames& names() const { return names_; }
  const Terminal& terminal() const { return terminal_; }

  std::string Iri(std::string_view iri) const { return names_.Iri(iri); }
  std::string Of(const Term& term) const { return names_.Show(term); }
  std::string Of(const v1::Term& term) const;
  // On one line and cut to `columns`, unless all is to be shown.
  std::string Cut(std::string_view text, size_t columns) const;
  // The same of a text of the server for people, whose IRIs are named.
  std::string Text(std::string_view text, size_t columns) const { return Cut(names_.InText(text), columns); }
  // The same, never cut.
  std::string Line(std::string_view text) const;
  std::string State(std::string_view state) const;

 private:
  const bool full_;
  IriNames names_;
  const Terminal terminal_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_PRESENTER_H_
