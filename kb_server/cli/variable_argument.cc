#include "kb_server/cli/variable_argument.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "workflow/xml/term_text.h"

namespace docent::server {
namespace {

// The prefix of a word prefix:local; nullopt: it is none, as in "12:30" or "note: two words".
std::optional<std::string> PrefixOf(std::string_view value) {
  const size_t colon = value.find(':');
  if (colon == std::string_view::npos || colon == 0 ||
      !absl::ascii_isalpha(static_cast<unsigned char>(value[0])))
    return std::nullopt;
  const auto is_name = [](unsigned char c) {
    return absl::ascii_isalnum(c) || c >= 0x80 || c == '_' || c == '-' || c == '.';
  };
  if (!std::all_of(value.begin(), value.begin() + static_cast<ptrdiff_t>(colon), is_name))
    return std::nullopt;
  if (std::any_of(value.begin(), value.end(), [](unsigned char c) { return absl::ascii_isspace(c); }))
    return std::nullopt;
  return std::string(value.substr(0, colon));
}

// The prefixes that the value needs, as far as they are known.
xml::Prefixes Needed(std::string_view value, const PrefixLookup& prefixes) {
  xml::Prefixes needed;
  std::string_view word = value;
  if (const size_t datatype = value.rfind("^^");
      !value.empty() && (value[0] == '"' || value[0] == '\'') && datatype != std::string_view::npos)
    word = value.substr(datatype + 2);
  if (const std::optional<std::string> prefix = PrefixOf(word)) {
    if (std::optional<std::string> iri = prefixes(*prefix)) needed.emplace(*prefix, *std::move(iri));
  }
  return needed;
}

absl::Status Refused(const std::string& given, std::string_view why, std::string_view remedy) {
  return absl::InvalidArgumentError(Concat(given, ": ", why, remedy.empty() ? "" : "; ", remedy));
}

}  // namespace

absl::StatusOr<std::pair<std::string, Term>> ParseVariable(const std::string& text,
                                                           const PrefixLookup& prefixes) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    return Refused(text, "it is not NAME=VALUE", "e.g. user=expo:John");
  const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
  const auto with = [&name](Term term) { return std::make_pair(name, std::move(term)); };
  const bool written_out = !value.empty() && (value[0] == '<' || value[0] == '"' || value[0] == '\'');
  const std::optional<std::string> prefix = PrefixOf(value);
  if (!written_out && prefix && !prefixes(*prefix)) {
    if (value.find("://") != std::string::npos || *prefix == "urn") {
      if (IsValidTermIri(value)) return with(Term::Iri(value));
      return Refused(text, "the IRI holds a character that may not stand in one", "");
    }
    return Refused(text, Concat("the prefix ", *prefix, ": is not known"),
                   Concat("declare it with --prefix ", *prefix, "=IRI, write the IRI whole as '", name,
                          "=<…>', or quote a text: '", name, "=\"", value, "\"'"));
  }
  xml::TermError error;
  std::optional<Term> term = xml::ParseTerm(value, Needed(value, prefixes), &error);
  if (term) return with(*std::move(term));
  if (written_out || prefix) return Refused(text, error.message, error.hint);
  return with(Term::Literal(value));
}

}  // namespace docent::server
