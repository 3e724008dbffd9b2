// The W3C suites about HTTP, over a socket against a whole server: SPARQL 1.1 Protocol, Graph Store Protocol,
// Service Description.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/sparql/results/results.h"
#include "kb_server/server.h"
#include "kb_server/work/http_message.h"
#include "tests/conformance/rdf/isomorphism.h"
#include "tests/conformance/sparql/result_files.h"
#include "tests/conformance/sparql/suite_support.h"
#include "tests/conformance/sparql/w3c_manifest.h"
#include "tests/kb_server/http/http_client.h"

namespace docent {
namespace {

constexpr char kHt[] = "http://www.w3.org/2011/http#";
constexpr char kCnt[] = "http://www.w3.org/2011/content#";
constexpr char kMf[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kUt[] = "http://www.w3.org/2009/sparql/tests/test-update#";
constexpr char kSd[] = "http://www.w3.org/ns/sparql-service-description#";

// A server with an empty data folder and the strict default graph.
class Endpoint {
 public:
  Endpoint() {
    static int number = 0;
    folder_ = std::filesystem::temp_directory_path() / absl::StrCat("docent-w3c-", getpid(), "-", ++number);
    server::ServerSettings settings;
    settings.data_folder = folder_.string();
    settings.grpc_address = settings.http_address = "127.0.0.1:0";
    settings.default_graph = sparql::DefaultGraph::kStrict;
    auto started = server::Server::Start(settings, nullptr);
    EXPECT_TRUE(started.ok()) << started.status();
    if (started.ok()) server_ = *std::move(started);
  }
  ~Endpoint() {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  std::string authority() const { return absl::StrCat("localhost:", port()); }
  uint16_t port() const {
    const std::string& address = server_->http_address();
    return static_cast<uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
  }
  server::HttpReply Ask(const std::string& method, const std::string& target, const std::string& headers = "",
                        const std::string& body = "") {
    return server::HttpClient(port()).Ask(method, target, headers, body);
  }

 private:
  std::filesystem::path folder_;
  std::unique_ptr<server::Server> server_;
};

struct HttpTest {
  std::string name;
  Term entry;
};

std::vector<HttpTest> Tests(const Manifest& manifest, const std::string& folder) {
  std::vector<HttpTest> out;
  for (const Term& entry : manifest.entries) out.push_back({folder + "/" + LocalName(entry.lexical), entry});
  return out;
}

std::string Utf16(const std::string& ascii) {
  std::string out = "\xFE\xFF";
  for (const char c : ascii) out += {'\0', c};
  return out;
}

// One test of the manifests' ht: vocabulary: requests in order, each with its expected answer.
class Exchange {
 public:
  Exchange(const ManifestGraph& graph, Endpoint* endpoint, std::string path_before, std::string path_after)
      : graph_(graph),
        endpoint_(*endpoint),
        path_before_(std::move(path_before)),
        path_after_(std::move(path_after)) {}

  std::string Run(const Term& entry) {
    for (const Term& data : graph_.All(entry, std::string(kUt) + "graphData")) {
      const std::string label = graph_.One(data, Concat(kRdfsNs, "label")).lexical;
      const server::HttpReply reply =
          endpoint_.Ask("PUT", "/rdf-graphs?graph=" + label, "Content-Type: application/n-triples\r\n",
                        ReadText(W3cFile(graph_.One(data, std::string(kUt) + "graph").lexical)));
      if (reply.status >= 300) return "its data: " + reply.body;
    }
    const Term connection = graph_.One(entry, std::string(kMf) + "action");
    const std::vector<Term> requests = graph_.List(graph_.One(connection, std::string(kHt) + "requests"));
    if (requests.empty()) return "no requests";
    for (size_t i = 0; i < requests.size(); ++i) {
      const std::string why = One(requests[i]);
      if (!why.empty()) return absl::StrCat("request ", i + 1, ": ", why);
    }
    return "";
  }

 private:
  std::string Text(const Term& node, const std::string& property) const {
    return Fill(graph_.One(node, property).lexical);
  }
  // Replaces the names of the manifest's host and path by ours.
  std::string Fill(std::string text) const {
    if (!location_.empty()) absl::StrReplaceAll({{"$LOCATION$", location_}}, &text);
    const std::string host = endpoint_.authority();
    std::string escaped = absl::StrReplaceAll(host, {{":", "%3A"}});
    absl::StrReplaceAll({{"www.example%2Fgsp", escaped + "%2Frdf-graphs"},
                         {"www.example/gsp", host + "/rdf-graphs"},
                         {"www.example", host}},
                        &text);
    return text;
  }

  std::map<std::string, std::string> Headers(const Term& node) const {
    std::map<std::string, std::string> out;
    for (const Term& header : graph_.List(graph_.One(node, std::string(kHt) + "headers"))) {
      std::string name = Text(header, std::string(kHt) + "fieldName");
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      out[name] = Text(header, std::string(kHt) + "fieldValue");
    }
    return out;
  }

  std::string One(const Term& request) {
    const std::string ht = kHt, mf = kMf;
    std::string target = Text(request, ht + "absolutePath");
    if (target.starts_with(path_before_)) target = path_after_ + target.substr(path_before_.size());
    std::string headers;
    for (const auto& [name, value] : Headers(request)) headers += name + ": " + value + "\r\n";
    const Term body_node = graph_.One(request, ht + "body");
    std::string body = Text(body_node, std::string(kCnt) + "chars");
    if (Text(body_node, std::string(kCnt) + "characterEncoding") == "UTF-16") body = Utf16(body);
    const std::string method = Text(request, ht + "methodName");
    if (body.empty() && method != "GET" && method != "HEAD") headers += "Content-Length: 0\r\n";
    const server::HttpReply reply = endpoint_.Ask(method, target, headers, body);
    const Term expected = graph_.One(request, ht + "resp");
    std::string why = CheckStatus(expected, reply);
    if (why.empty()) why = CheckAnswer(expected, reply);
    if (why.empty()) why = CheckBody(expected, reply);
    if (!why.empty()) return method + " " + target + ": " + why + "\n" + reply.body;
    if (!graph_.One(expected, mf + "expectedLocation").lexical.empty()) {
      if (reply.headers.count("location") == 0) return "no Location";
      location_ = reply.headers.at("location");
    }
    return "";
  }

  std::string CheckStatus(const Term& expected, const server::HttpReply& reply) const {
    static const std::map<std::string, int> kNames = {
        {"OK", 200}, {"Created", 201}, {"NoContent", 204}, {"NotFound", 404}, {"BadRequest", 400}};
    const std::vector<Term> wanted = graph_.All(expected, std::string(kMf) + "expectedStatus");
    for (const Term& status : wanted) {
      const std::string name = LocalName(status.lexical);
      const auto named = kNames.find(name);
      if (named != kNames.end() ? reply.status == named->second
                                : name == absl::StrCat("StatusCode", reply.status / 100, "xx")) {
        return "";
      }
    }
    return wanted.empty() ? "" : absl::StrCat("status ", reply.status);
  }

  std::string CheckAnswer(const Term& expected, const server::HttpReply& reply) const {
    const std::string type = reply.headers.count("content-type") ? reply.headers.at("content-type") : "";
    const std::string format = graph_.One(expected, std::string(kMf) + "expectedFormat").lexical;
    const bool xml = type.starts_with("application/sparql-results+xml");
    const bool rows = xml || type.starts_with("application/sparql-results+json") ||
                      type.starts_with("text/csv") || type.starts_with("text/tab-separated-values");
    if (format == "RDF" && !FormatOfMediaType(type)) return "no RDF but " + type;
    if ((format == "boolean" || format == "tabular") && !rows) return "no results but " + type;
    const Term boolean = graph_.One(expected, std::string(kMf) + "expectedBoolean");
    if (boolean.lexical.empty()) return "";
    const Answer answer = xml ? ReadXmlResult(reply.body) : ReadJsonResult(reply.body);
    return answer.boolean == (boolean.lexical == "true") ? "" : "not the boolean expected";
  }

  std::string CheckBody(const Term& expected, const server::HttpReply& reply) const {
    const std::map<std::string, std::string> headers = Headers(expected);
    if (headers.contains("content-type") &&
        server::MediaTypeOnly(reply.headers.count("content-type") ? reply.headers.at("content-type") : "") !=
            server::MediaTypeOnly(headers.at("content-type"))) {
      return "not the content type expected";
    }
    const Term body = graph_.One(expected, std::string(kHt) + "body");
    const std::string text = Text(body, std::string(kCnt) + "chars");
    if (text.empty()) return "";
    ParseRdfOptions options;
    options.base_iri = "http://" + endpoint_.authority() + "/";
    const ParsedRdf want = ParseRdf(text, *FormatOfMediaType(headers.at("content-type")), options);
    const ParsedRdf got = ParseRdf(reply.body, *FormatOfMediaType(reply.headers.at("content-type")), options);
    if (!got.ok()) return Render(got.diagnostics, reply.body);
    return Isomorphism::Holds(want.quads, got.quads) ? "" : "another graph than\n" + text;
  }

  const ManifestGraph& graph_;
  Endpoint& endpoint_;
  const std::string path_before_, path_after_;
  std::string location_;
};

bool Missing() {
  return !std::filesystem::exists(W3cRoot() / "sparql11/protocol/manifest.ttl");
}
constexpr char kMissing[] =
    "the W3C suites are not there: clone github.com/w3c/rdf-tests and set DOCENT_W3C_TESTS to it";

TEST(HttpSuites, Protocol) {
  if (Missing()) GTEST_SKIP() << kMissing;
  const std::string folder = "sparql11/protocol";
  const Manifest manifest(std::string(kW3cBase) + folder + "/manifest.ttl");
  RunSuite("http " + folder, Tests(manifest, folder), [&manifest](const HttpTest& test) {
    Endpoint endpoint;
    return Exchange(manifest.graph, &endpoint, "/sparql/", "/sparql").Run(test.entry);
  });
}

TEST(HttpSuites, GraphStore) {
  if (Missing()) GTEST_SKIP() << kMissing;
  const std::string folder = "sparql11/graph-store-protocol";
  for (const char* file : {"manifest-direct", "manifest-indirect"}) {
    const Manifest manifest(std::string(kW3cBase) + folder + "/" + file + ".ttl");
    RunSuite("http " + folder + "/" + file, Tests(manifest, folder), [&manifest](const HttpTest& test) {
      Endpoint endpoint;
      return Exchange(manifest.graph, &endpoint, "/gsp", "/rdf-graphs").Run(test.entry);
    });
  }
}

// The tests are prose: their statements are checked here, once for each format.
std::string CheckDescription(const std::string& test, Endpoint* endpoint) {
  for (const char* accept : {"", "text/turtle", "application/rdf+xml", "application/n-triples"}) {
    const server::HttpReply reply =
        endpoint->Ask("GET", "/sparql", *accept ? absl::StrCat("Accept: ", accept, "\r\n") : std::string());
    const std::optional<RdfFormat> format = FormatOfMediaType(reply.headers.at("content-type"));
    if (reply.status != 200 || !format) return "no RDF";
    const ParsedRdf parsed = ParseRdf(reply.body, *format);
    if (!parsed.ok()) return Render(parsed.diagnostics, reply.body);
    const ManifestGraph graph(parsed.quads);
    const Term service = graph.WithType(std::string(kSd) + "Service");
    const std::string sd = kSd;
    if (service.lexical.empty()) return "no sd:Service";
    const std::string url = "http://" + endpoint->authority() + "/sparql";
    if (test == "has-endpoint-triple" && graph.One(service, sd + "endpoint").lexical != url)
      return "no sd:endpoint";
    if (test != "conforms-to-schema") continue;
    // The properties of the vocabulary that it uses, with the class of their values.
    const std::map<std::string, std::string> known = {{"endpoint", ""},
                                                      {"supportedLanguage", ""},
                                                      {"feature", ""},
                                                      {"resultFormat", ""},
                                                      {"inputFormat", ""},
                                                      {"extensionFunction", "Function"},
                                                      {"defaultDataset", "Dataset"},
                                                      {"defaultGraph", "Graph"},
                                                      {"namedGraph", "NamedGraph"},
                                                      {"name", ""},
                                                      {"graph", "Graph"}};
    for (const TermQuad& quad : parsed.quads) {
      if (!quad.predicate.lexical.starts_with(sd)) continue;
      const auto property = known.find(quad.predicate.lexical.substr(sd.size()));
      if (property == known.end()) return quad.predicate.lexical + " is not of the vocabulary";
      if (quad.object.IsLiteral()) return quad.predicate.lexical + " has a literal";
      bool typed = property->second.empty();
      for (const Term& type : graph.All(quad.object, std::string(kRdfType))) {
        typed |= type.lexical == sd + property->second;
      }
      if (!typed) return quad.predicate.lexical + " has a value that is no sd:" + property->second;
    }
    for (const char* language : {"SPARQL11Query", "SPARQL11Update"}) {
      bool there = false;
      for (const Term& t : graph.All(service, sd + "supportedLanguage")) there |= t.lexical == sd + language;
      if (!there) return std::string("not ") + language;
    }
  }
  return "";
}

TEST(HttpSuites, ServiceDescription) {
  if (Missing()) GTEST_SKIP() << kMissing;
  const std::string folder = "sparql11/service-description";
  const Manifest manifest(std::string(kW3cBase) + folder + "/manifest.ttl");
  Endpoint endpoint;
  endpoint.Ask("PUT", "/rdf-graphs?graph=http://example.org/g", "Content-Type: text/turtle\r\n",
               "<a:a> <a:b> <a:c> .");
  RunSuite("http " + folder, Tests(manifest, folder), [&endpoint](const HttpTest& test) {
    return CheckDescription(LocalName(test.entry.lexical), &endpoint);
  });
}

}  // namespace
}  // namespace docent
