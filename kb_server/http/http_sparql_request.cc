#include "kb_server/http/http_sparql_request.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/iri.h"
#include "kb_server/http/http_body.h"

namespace docent::server {
namespace {

using Kind = SparqlRequest::Kind;

constexpr char kHowTo[] =
    "give a query: GET /sparql?query=…, or POST it as application/sparql-query; or POST an update as "
    "application/sparql-update";

ReadSparqlRequest Refused(int status, std::string text) {
  ReadSparqlRequest read;
  read.refusal = TextResponse(status, std::move(text));
  return read;
}

// What the parameters say besides the text itself.
std::optional<HttpResponse> ReadOption(const std::string& name, const std::string& value,
                                       const Limits& limits, SparqlRequest* request) {
  const bool query = request->kind != Kind::kUpdate;
  uint64_t number = 0;
  const bool for_query = name == "default-graph-uri" || name == "named-graph-uri";
  const bool for_update = name == "using-graph-uri" || name == "using-named-graph-uri";
  if (for_query || for_update) {
    if (for_query != query)
      return TextResponse(400, name + " does not go with " + (query ? "a query" : "an update"));
    if (!IsValidTermIri(value)) {
      return TextResponse(400, name + " must be an absolute IRI, not \"" + value + "\"");
    }
    const bool named = absl::StrContains(name, "named");
    (named ? request->named_graphs : request->default_graphs).push_back(Term::Iri(value));
  } else if (name == "timeout") {
    if (!absl::SimpleAtoi(value, &number) || number == 0) {
      return TextResponse(400, "timeout must be a whole number of milliseconds, not \"" + value + "\"");
    }
    request->timeout_ms = static_cast<int>(std::min<uint64_t>(number, limits.query_timeout_ms));
  } else if (name == "min-revision") {
    if (!absl::SimpleAtoi(value, &number)) {
      return TextResponse(400, "min-revision must be a revision number, not \"" + value + "\"");
    }
    request->min_revision = Revision(number);
  } else if (name == "request-id") {
    request->request_id = value;
  } else if (name == "as-of") {
    if (!query) return TextResponse(400, "as-of does not go with an update: the past stays as it was");
    if (value.empty()) return TextResponse(400, "as-of is empty; give a revision number or an xsd:dateTime");
    request->as_of = value;
  } else if (name != "query" && name != "update") {
    return MisspeltParameter(name,
                             {"query", "update", "default-graph-uri", "named-graph-uri", "using-graph-uri",
                              "using-named-graph-uri", "timeout", "min-revision", "as-of", "request-id"});
  }
  return std::nullopt;
}

// `body`: the text, where the body is it; its kind is set already then.
ReadSparqlRequest FromParameters(const HttpFields& parameters, bool has_body, SparqlRequest request,
                                 const Limits& limits) {
  int texts = has_body ? 1 : 0;
  for (const auto& [name, value] : parameters) {
    if (name != "query" && name != "update") continue;
    request.kind = name == "update" ? Kind::kUpdate : Kind::kQuery;
    request.text = value;
    ++texts;
  }
  if (texts == 0) return Refused(400, kHowTo);
  if (texts > 1) return Refused(400, "give one query or one update, not several");
  for (const auto& [name, value] : parameters) {
    if (std::optional<HttpResponse> refusal = ReadOption(name, value, limits, &request)) {
      return {std::move(refusal), {}};
    }
  }
  const bool update = request.kind == Kind::kUpdate;
  const size_t limit = update ? limits.update_text_bytes : limits.query_text_bytes;
  if (request.text.size() > limit) {
    return Refused(413, absl::StrCat("the ", update ? "update" : "query", " has ", request.text.size(),
                                     " bytes; the limit ", update ? "update_text_bytes" : "query_text_bytes",
                                     " is ", limit));
  }
  return {std::nullopt, std::move(request)};
}

}  // namespace

std::string AddressOf(const HttpRequest& http) {
  const std::string host = http.Header("host");
  return "http://" + (host.empty() ? "localhost" : host) + http.raw_path;
}

bool IsQuicklyRead(const HttpRequest& http) {
  constexpr size_t kFew = 64u << 10;
  return http.body.size() <= kFew && !IsPacked(http);
}

ReadSparqlRequest ReadSparql(const HttpRequest& http, const Limits& limits, MemoryUse* memory,
                             Cancellation* cancellation) {
  SparqlRequest request;
  request.timeout_ms = limits.query_timeout_ms;
  request.base_iri = AddressOf(http);
  if (http.method != "POST") {
    const auto asks = [&http](const char* name) {
      return std::any_of(http.parameters.begin(), http.parameters.end(),
                         [name](const auto& p) { return p.first == name; });
    };
    if (asks("update")) {
      ReadSparqlRequest read = Refused(405, "an update changes the graph: POST it");
      read.refusal->headers.emplace_back("Allow", "POST");
      return read;
    }
    if (http.parameters.empty()) {
      request.kind = Kind::kDescription;
      return {std::nullopt, std::move(request)};
    }
    return FromParameters(http.parameters, false, std::move(request), limits);
  }
  const std::string given = http.Header("content-type");
  const std::string type = MediaTypeOnly(given);
  if (std::optional<HttpResponse> refusal = RefuseCharset(given)) return {std::move(refusal), {}};
  HttpBody body;
  UnpackBody(http, limits.update_text_bytes, "update_text_bytes", memory, cancellation, &body);
  if (body.refusal) return {std::move(body.refusal), {}};
  if (type == "application/sparql-query" || type == "application/sparql-update") {
    request.kind = type == "application/sparql-update" ? Kind::kUpdate : Kind::kQuery;
    request.text = body.text;
    return FromParameters(http.parameters, true, std::move(request), limits);
  }
  if (type != "application/x-www-form-urlencoded") {
    return Refused(
        415,
        "POST a query as application/sparql-query, an update as application/sparql-update, or either "
        "as application/x-www-form-urlencoded" +
            (type.empty() ? std::string() : ", not as " + type));
  }
  absl::StatusOr<HttpFields> form = ParseForm(body.text, limits.http_parameters);
  if (!form.ok()) return Refused(400, absl::StrCat("the form: ", form.status().message()));
  form->insert(form->end(), http.parameters.begin(), http.parameters.end());
  return FromParameters(*form, false, std::move(request), limits);
}

}  // namespace docent::server
