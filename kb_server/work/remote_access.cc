#include "kb_server/work/remote_access.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/base/gzip.h"
#include "graph/base/memory_part.h"
#include "graph/base/overload.h"
#include "graph/base/regular_file.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/iri.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/work/service_answer_json.h"
#include "kb_server/work/service_answer_xml.h"

namespace docent::server {
namespace {

constexpr std::string_view kFile = "file://";
constexpr int kRedirects = 5;

std::string PathOf(const HttpUrl& url) {
  return url.target.substr(0, url.target.find('?'));
}

// "/a/b" is below "/a", "/a/" and "/", and is itself.
bool IsBelow(std::string_view path, std::string_view above) {
  if (!path.starts_with(above)) return false;
  return path.size() == above.size() || above.ends_with('/') || path[above.size()] == '/';
}

// ".." or an escape that a server may read as '.', '/' or '\'.
bool IsTricky(std::string_view path) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(path));
  return absl::StrContains(lower, "/../") || absl::EndsWith(lower, "/..") ||
         absl::StrContains(lower, "%2e") || absl::StrContains(lower, "%2f") ||
         absl::StrContains(lower, "%5c") || absl::StrContains(lower, "\\");
}

absl::StatusOr<RegularFile> ReadFile(std::string_view url, size_t max_bytes) {
  const std::optional<std::string> path = PercentDecode(url.substr(kFile.size()), false);
  if (!path) return absl::InvalidArgumentError("a broken %-escape");
  absl::StatusOr<RegularFile> file = ReadRegularFile(*path, max_bytes);
  if (absl::IsNotFound(file.status())) return absl::NotFoundError("it cannot be read");
  if (absl::IsInvalidArgument(file.status()))
    return absl::InvalidArgumentError("it is a folder, a pipe or a device; name a regular file");
  if (file.ok() && file->text.size() > max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("it is larger than the limit remote_bytes = ", max_bytes));
  }
  return file;
}

// Where an entry file:///… leads to.
std::string RealPathOf(std::string_view entry) {
  const std::optional<std::string> path = PercentDecode(entry.substr(kFile.size()), false);
  std::error_code error;
  const auto real = std::filesystem::canonical(path.value_or(""), error);
  return error ? "" : real.string();
}

// While another server is waited for, the worker's place is free.
absl::StatusOr<HttpResponse> Ask(const FetchRequest& request, Cancellation* cancellation) {
  const WorkerPool::Waiting waiting;
  return waiting.status().ok() ? Fetch(request, cancellation) : waiting.status();
}

}  // namespace

absl::Status RemoteAccess::CheckAllowed(const std::string& entry) {
  if (ParseHttpUrl(entry)) return absl::OkStatus();
  if (absl::StartsWith(entry, "file:///") && !IsTricky(entry)) return absl::OkStatus();
  return absl::InvalidArgumentError("\"" + entry +
                                    "\" is not http://HOST[:PORT][/PATH], https://… or file:///FOLDER");
}

bool RemoteAccess::IsAllowed(std::string_view url) const {
  const std::optional<HttpUrl> given = ParseHttpUrl(url);
  return std::any_of(allowed_.begin(), allowed_.end(), [&](const std::string& entry) {
    if (absl::StartsWith(entry, "file:///")) return !IsTricky(url) && IsBelow(url, entry);
    const std::optional<HttpUrl> above = ParseHttpUrl(entry);
    return given && above && given->tls == above->tls && given->host == above->host &&
           given->port == above->port && !IsTricky(PathOf(*given)) && IsBelow(PathOf(*given), PathOf(*above));
  });
}

// Of a file that is open already: nothing can be put in its place meanwhile.
bool RemoteAccess::IsAllowedPath(const std::string& real_path) const {
  return std::any_of(allowed_.begin(), allowed_.end(), [&](const std::string& entry) {
    if (!absl::StartsWith(entry, "file:///")) return false;
    const std::string above = RealPathOf(entry);
    return !above.empty() && IsBelow(real_path, above);
  });
}

absl::Status RemoteAccess::Refuse(std::string_view url) const {
  return absl::PermissionDeniedError(Concat(
      "<", url, "> is not among the addresses that this server may reach; start it with --allow ", url));
}

absl::Status RemoteAccess::TooMuch(const std::string& url, const MemoryUse& memory) const {
  return memory.Refusal(absl::ResourceExhaustedError(absl::StrCat(
      "<", url, "> has more than fits into the limit query_memory_bytes = ", limits_.query_memory_bytes)));
}

absl::StatusOr<HttpResponse> RemoteAccess::Get(FetchRequest* request, Cancellation* cancellation) const {
  request->timeout = std::chrono::milliseconds(limits_.query_timeout_ms);
  request->max_bytes = limits_.remote_bytes;
  for (int redirects = 0;; ++redirects) {
    if (!IsAllowed(request->url)) return Refuse(request->url);
    absl::StatusOr<HttpResponse> response = Ask(*request, cancellation);
    if (absl::IsUnavailable(response.status())) return absl::UnknownError(response.status().message());
    if (!response.ok() || response->status == 200) return response;
    const int status = response->status;
    const auto location = std::find_if(response->headers.begin(), response->headers.end(),
                                       [](const auto& field) { return field.first == "location"; });
    // What is sent is sent again only where the status says so (RFC 9110, section 15.4).
    const bool again = status == 307 || status == 308 ||
                       (request->method == "GET" && (status == 301 || status == 302 || status == 303));
    if (!again || location == response->headers.end() || redirects == kRedirects) {
      return absl::UnknownError(
          absl::StrCat(request->url, " answered with status ", status, ": ",
                       response->body.substr(0, response->body.find('\n')).substr(0, 200)));
    }
    request->url = ResolveIri(location->second, request->url);
  }
}

absl::StatusOr<sparql::ServiceAnswer> RemoteAccess::Select(const std::string& endpoint,
                                                           const std::string& query, bool silent,
                                                           Cancellation* cancellation, MemoryUse* memory) {
  FetchRequest request;
  request.method = "POST";
  request.url = endpoint;
  request.headers = {{"Content-Type", "application/sparql-query"},
                     {"Accept", "application/sparql-results+json, application/sparql-results+xml;q=0.5"}};
  request.body = query;
  request.half_time = silent;
  MemoryPart of_body(memory);
  request.count = [&](size_t more) {
    return of_body.Add(more) ? absl::OkStatus() : TooMuch(endpoint, *memory);
  };
  absl::StatusOr<HttpResponse> response = Get(&request, cancellation);
  if (!response.ok()) return response.status();
  // XML says so itself, which more servers do than name its type.
  const size_t begin =
      std::min(response->body.find_first_not_of("\xEF\xBB\xBF \t\r\n"), response->body.size());
  if (response->body.compare(begin, 1, "<") == 0)
    return ReadXmlAnswer(response->body, limits_, cancellation, memory);
  return ReadJsonAnswer(response->body, limits_, cancellation, memory);
}

absl::StatusOr<std::vector<TermQuad>> RemoteAccess::Load(const std::string& url, Cancellation* cancellation,
                                                         MemoryUse* memory) const {
  // A fragment names a part of the document, which is read whole (RFC 3986, section 3.5).
  const std::string document = url.substr(0, url.find('#'));
  std::string text, base = document, type;
  std::optional<RdfFormat> format;
  MemoryPart of_text(memory);
  const auto count = [&](size_t more) {
    return of_text.Add(more) ? absl::OkStatus() : TooMuch(url, *memory);
  };
  if (absl::StartsWith(document, ToAbsl(kFile))) {
    if (!IsAllowed(document)) return Refuse(document);
    absl::StatusOr<RegularFile> file = ReadFile(document, limits_.remote_bytes);
    if (file.ok() && !IsAllowedPath(file->real_path)) {
      return absl::PermissionDeniedError(
          absl::StrCat("<", url, ">: a symbolic link leads out of what --allow names"));
    }
    if (!file.ok())
      return absl::Status(file.status().code(), absl::StrCat("<", url, ">: ", file.status().message()));
    text = std::move(file->text);
    if (absl::Status room = count(text.size()); !room.ok()) return room;
  } else {
    FetchRequest request;
    request.url = document;
    request.count = count;
    request.headers = {
        {"Accept",
         "text/turtle, application/n-triples, application/trig;q=0.9, application/n-quads;q=0.9, "
         "application/rdf+xml;q=0.8"}};
    absl::StatusOr<HttpResponse> response = Get(&request, cancellation);
    if (!response.ok()) return response.status();
    base = request.url.substr(0, request.url.find('#'));  // of a redirection
    text = std::move(response->body);
    type = response->content_type;
    format = FormatOfMediaType(type);
  }
  if (!format) format = FormatOfFile(base);
  if (IsGzip(text)) {
    absl::StatusOr<std::string> unpacked =
        Gunzip(text, limits_.remote_bytes, "remote_bytes", memory, cancellation);
    if (!unpacked.ok())
      return WithMessage(unpacked.status(), absl::StrCat("<", url, ">: ", unpacked.status().message()));
    text = *std::move(unpacked);
    of_text.Reset();
    memory->Release(text.size());
    if (absl::Status room = count(text.size()); !room.ok()) return room;
  }
  if (!format) {
    if (absl::Status unread = CheckFormatOfFile(base); !unread.ok()) return unread;
    return absl::InvalidArgumentError(absl::StrCat(
        "<", url, ">: neither its type nor its name says which RDF it is; ", UnknownMediaType(type)));
  }
  ParseRdfOptions options;
  options.refuse_graph = RefuseGraph;
  options.file = url;
  options.base_iri = base;
  options.charset = CharsetOf(type);
  options.limits = limits_;
  options.cancellation = cancellation;
  options.memory = memory;
  ParsedRdf parsed = ParseRdf(text, *format, options);
  if (!parsed.ok()) return ToStatus(parsed, text);
  return std::move(parsed.quads);
}

}  // namespace docent::server
