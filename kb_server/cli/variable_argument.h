// A variable of a run or an argument of a robot service, as the command line gives it: NAME=VALUE. Any thread.
#ifndef DOCENT_KB_SERVER_CLI_VARIABLE_ARGUMENT_H_
#define DOCENT_KB_SERVER_CLI_VARIABLE_ARGUMENT_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "graph/rdf/term.h"

namespace docent::server {

// The namespace of a prefix (without ":"); nullopt: not known.
using PrefixLookup = std::function<std::optional<std::string>(std::string_view prefix)>;

// What --help says of VALUE.
inline constexpr char kVariableValueHelp[] =
    "VALUE is an IRI, a literal or a text:\n"
    "  prefix:name, <IRI>    an IRI; a prefix that neither --prefix nor the server knows is an error\n"
    "  7, 0.5, 1e3, true     a number, a truth value\n"
    "  \"text\", \"text\"@en     a literal; also \"1\"^^xsd:decimal\n"
    "  anything else         a text";

// The value is an IRI for <iri>, prefix:local with a known prefix, and what is an IRI by "://" or "urn:"; a literal for "text",
// "text"@en, "1"^^xsd:decimal (single quotes, too), numbers, true and false; a plain text otherwise. INVALID_ARGUMENT, with
// what to write instead: no NAME=, a prefix that is not known, a malformed term.
absl::StatusOr<std::pair<std::string, Term>> ParseVariable(const std::string& text,
                                                           const PrefixLookup& prefixes);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_VARIABLE_ARGUMENT_H_
