#include "kb_server/web/app_routes.h"

#include <openssl/rand.h>

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"
#include "kb_server/web/visit_code.h"

namespace docent::server {
namespace {

constexpr size_t kNonceBytes = 16;   // as Content Security Policy Level 3, section 7.1 asks for
constexpr size_t kLabelBytes = 200;  // of a code
constexpr char kForEver[] = "public, max-age=31536000, immutable";

constexpr char kNoApp[] = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Docent</title></head><body>
<h1>Docent</h1>
<p>The server runs; its browser app is not installed. Build it as web/README.md says, or start the server with
<code>docent serve --web FOLDER</code>, where FOLDER holds the built app.</p>
<p>The interfaces are here all the same: <code>/docent.v1.…</code> (the API, Connect protocol), <code>/sparql</code>,
<code>/rdf-graphs</code>, <a href="/healthz">/healthz</a>, <a href="/metrics">/metrics</a>.</p>
</body></html>
)";

HttpFields SecurityHeaders(std::string_view nonce) {
  const std::string by_nonce = nonce.empty() ? "" : Concat(" 'nonce-", nonce, "'");
  return {{"Content-Security-Policy",
           Concat("default-src 'none'; script-src 'self'", by_nonce, "; style-src 'self'", by_nonce,
                  "; img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; media-src 'self'; "
                  "manifest-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'self'; "
                  "frame-ancestors 'none'")},
          {"Referrer-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Permissions-Policy", "camera=(self), geolocation=(), microphone=()"},
          {"X-Frame-Options", "DENY"}};
}

bool ListHas(std::string_view list, std::string_view value) {
  for (absl::string_view one : absl::StrSplit(ToAbsl(list), ',')) {
    const absl::string_view token = absl::StripAsciiWhitespace(one.substr(0, one.find(';')));
    if (absl::EqualsIgnoreCase(token, ToAbsl(value)) &&
        !absl::EndsWith(absl::StripAsciiWhitespace(one), ";q=0"))
      return true;
  }
  return false;
}

// RFC 9110 section 13.1.2; tags are compared weakly.
bool HasCopy(const HttpRequest& http, const std::string& etag) {
  for (absl::string_view one : absl::StrSplit(http.Header("if-none-match"), ',')) {
    one = absl::StripAsciiWhitespace(one);
    if (absl::StartsWith(one, "W/")) one.remove_prefix(2);
    if (one == "*" || one == etag) return true;
  }
  return false;
}

std::string NewNonce() {
  unsigned char bytes[kNonceBytes];
  if (RAND_bytes(bytes, sizeof(bytes)) != 1) return "";  // then no style with a nonce is taken
  return absl::Base64Escape(absl::string_view(reinterpret_cast<const char*>(bytes), sizeof(bytes)));
}

HttpResponse FileResponse(const HttpRequest& http, const AppFile& file) {
  HttpResponse response;
  response.content_type = file.content_type;
  if (file.bytes.find(kNoncePlaceholder) != std::string::npos && file.content_type.starts_with("text/html")) {
    const std::string nonce = NewNonce();
    response.body = absl::StrReplaceAll(file.bytes, {{kNoncePlaceholder, nonce}});
    response.headers = SecurityHeaders(nonce);
    response.headers.emplace_back("Cache-Control", "no-store");  // a nonce is for one answer
    return response;
  }
  const std::string accepted = http.Header("accept-encoding");
  const bool brotli = !file.brotli.empty() && ListHas(accepted, "br");
  const bool gzip = !brotli && !file.gzip.empty() && ListHas(accepted, "gzip");
  const std::string etag = Concat("\"", file.etag, brotli ? "-br" : gzip ? "-gz" : "", "\"");
  response.headers = SecurityHeaders("");
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", file.is_hashed ? kForEver : "no-cache");
  response.headers.emplace_back("Vary", "Accept-Encoding");
  if (HasCopy(http, etag)) {
    response.status = 304;
    response.content_type.clear();
    return response;
  }
  if (brotli || gzip) response.headers.emplace_back("Content-Encoding", brotli ? "br" : "gzip");
  response.body = brotli ? file.brotli : gzip ? file.gzip : file.bytes;
  return response;
}

// A browser that opens an address, rather than a program that asks for data: the last part of the path is no file's name.
bool AsksForView(const HttpRequest& http) {
  return ListHas(http.Header("accept"), "text/html") &&
         http.path.find('.', http.path.rfind('/')) == std::string::npos;
}

// GET /visit/code.svg?at=PLACE&base=ADDRESS: the code of a place. `base` is the address of the page that asks, which knows
// whether a proxy speaks TLS for the server; it names the host that the request is for, so that a code leads nowhere else.
HttpResponse VisitCode(const HttpRequest& http) {
  std::string place, base, label;
  for (const auto& [name, value] : http.parameters) {
    if (name == "at")
      place = value;
    else if (name == "base")
      base = value;
    else if (name == "label")
      label = value;
    else if (auto refusal = MisspeltParameter(name, {"at", "base", "label"}))
      return *std::move(refusal);
  }
  const std::string host = http.Header("host");
  if (base.empty()) base = Concat("http://", host);
  if (base != Concat("http://", host) && base != Concat("https://", host)) {
    return ErrorResponse(absl::InvalidArgumentError(
        Concat("base is \"", base, "\"; give http:// or https:// and the host of this request, ", host)));
  }
  if (FindInvalidUtf8(label)) return ErrorResponse(absl::InvalidArgumentError("label is not UTF-8"));
  const absl::StatusOr<std::string> address = VisitAddress(base, place);
  if (!address.ok()) return ErrorResponse(address.status());
  absl::StatusOr<std::string> svg = QrCodeSvg(*address, label.substr(0, kLabelBytes));
  if (!svg.ok()) return ErrorResponse(svg.status());
  HttpResponse response;
  response.content_type = "image/svg+xml";
  response.body = *std::move(svg);
  response.headers = SecurityHeaders("");
  response.headers.emplace_back("Cache-Control", "no-cache");
  return response;
}

}  // namespace

void AddAppRoutes(HttpRoutes* routes, const AppFiles* app) {
  if (app->empty()) {
    routes->Add("GET", "/", [](std::shared_ptr<HttpExchange> exchange) {
      HttpResponse response;
      response.content_type = "text/html; charset=utf-8";
      response.body = kNoApp;
      response.headers = SecurityHeaders("");
      response.headers.emplace_back("Cache-Control", "no-cache");
      exchange->Respond(std::move(response));
    });
    return;
  }
  routes->Add("GET", "/visit/code.svg", [](std::shared_ptr<HttpExchange> exchange) {
    exchange->Respond(VisitCode(exchange->request()));
  });
  const auto takes = [app](const HttpRequest& http) {
    return app->Find(http.path) != nullptr || AsksForView(http);
  };
  routes->SetFallback(takes, [app](std::shared_ptr<HttpExchange> exchange) {
    const AppFile* file = app->Find(exchange->request().path);
    exchange->Respond(FileResponse(exchange->request(), file != nullptr ? *file : app->index()));
  });
}

}  // namespace docent::server
