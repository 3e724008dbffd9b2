#include "robot_adapters/sim/graph_questions.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::robot {
namespace {

constexpr char kPrologue[] =
    "PREFIX docent: <https://w3id.org/docent#>\n"
    "PREFIX schema: <https://schema.org/>\n";
constexpr absl::Duration kQueryTimeout = absl::Seconds(5);
constexpr std::chrono::milliseconds kRetry{200};

bool IsServerAway(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) || absl::IsResourceExhausted(status);
}

absl::StatusOr<QueryAnswer> Ask(ServerLink& server, OperationContext& context, const std::string& query) {
  while (true) {
    auto answer = server.Query(kPrologue + query, kQueryTimeout);
    if (answer.ok() || !IsServerAway(answer.status())) return answer;
    context.ReportProgress(0, "waiting for the server to answer");
    if (!context.SleepFor(kRetry)) return absl::CancelledError("stopped while the server was away");
  }
}

std::string TextOf(const std::optional<Term>& term) {
  return term ? term->lexical : "";
}

}  // namespace

absl::StatusOr<std::string> IriArgument(const OperationContext& context, std::string_view name) {
  auto term = context.Argument(name);
  if (!term.ok()) return term.status();
  // Characters allowed between < and > (SPARQL 1.1, production 139).
  const bool fits = std::none_of(term->lexical.begin(), term->lexical.end(), [](char c) {
    return static_cast<unsigned char>(c) <= ' ' ||
           std::string_view("<>\"{}|^`\\").find(c) != std::string_view::npos;
  });
  if (!term->IsIri() || !fits) {
    return absl::InvalidArgumentError(
        absl::StrCat("the argument \"", ToAbsl(name), "\" has to be an IRI, not ", ToNTriples(*term)));
  }
  return term->lexical;
}

absl::StatusOr<Term> TextArgument(const OperationContext& context) {
  auto term = context.Argument("text");
  if (!term.ok()) return term.status();
  if (term->IsLiteral() && !term->lexical.empty()) return term;
  return absl::InvalidArgumentError(
      absl::StrCat("the argument \"text\" has to be a text that is not empty, not ", ToNTriples(*term)));
}

absl::StatusOr<BoothInfo> AskAboutBooth(ServerLink& server, OperationContext& context,
                                        const std::string& booth_iri) {
  const std::string booth = absl::StrCat("<", booth_iri, ">");
  auto answer = Ask(server, context,
                    absl::StrCat("SELECT ?name ?description ?exhibitor ?slogan ?product ?image WHERE {\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " schema:name ?name }\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " schema:description ?description }\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " docent:exhibitor ?e . ?e schema:name ?exhibitor }\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " docent:exhibitor ?s . ?s schema:slogan ?slogan }\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " docent:shows ?p . ?p schema:name ?product }\n"
                                 "  OPTIONAL { ",
                                 booth,
                                 " schema:image|docent:exhibitor/schema:image ?image }\n"
                                 "} ORDER BY ?product ?image"));
  if (!answer.ok()) return answer.status();
  BoothInfo info;
  info.iri = booth_iri;
  for (const auto& row : answer->rows) {
    if (row.size() != 6) return absl::InternalError("the server's answer has another shape than the query");
    info.name = TextOf(row[0]);
    info.description = TextOf(row[1]);
    info.exhibitor = TextOf(row[2]);
    info.slogan = TextOf(row[3]);
    if (info.image.empty()) info.image = TextOf(row[5]);
    const std::string product = TextOf(row[4]);
    if (!product.empty() &&
        std::find(info.products.begin(), info.products.end(), product) == info.products.end()) {
      info.products.push_back(product);
    }
  }
  return info;
}

absl::StatusOr<Whereabouts> AskWhereIs(ServerLink& server, OperationContext& context,
                                       const std::string& person_iri) {
  const std::string person = absl::StrCat("<", person_iri, ">");
  auto answer = Ask(server, context,
                    absl::StrCat("SELECT ?x ?y ?region WHERE {\n"
                                 "  OPTIONAL { ",
                                 person,
                                 " docent:x ?x ; docent:y ?y }\n"
                                 "  OPTIONAL { ",
                                 person,
                                 " docent:isAt ?region }\n"
                                 "} ORDER BY ?region"));
  if (!answer.ok()) return answer.status();
  Whereabouts found;
  for (const auto& row : answer->rows) {
    if (row.size() != 3) return absl::InternalError("the server's answer has another shape than the query");
    maps::Point2 point;
    if (absl::SimpleAtod(TextOf(row[0]), &point.x_m) && absl::SimpleAtod(TextOf(row[1]), &point.y_m) &&
        std::isfinite(point.x_m) && std::isfinite(point.y_m)) {
      found.point = point;
    }
    const std::string region = TextOf(row[2]);
    if (!region.empty() &&
        std::find(found.regions.begin(), found.regions.end(), region) == found.regions.end()) {
      found.regions.push_back(region);
    }
  }
  if (!found.point && found.regions.empty()) {
    return absl::NotFoundError(absl::StrCat("the graph does not say where <", person_iri,
                                            "> is: it has neither docent:isAt nor docent:x and docent:y"));
  }
  return found;
}

}  // namespace docent::robot
