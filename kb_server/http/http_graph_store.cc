#include "kb_server/http/http_graph_store.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/base/diagnostic.h"
#include "graph/base/gzip.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/history_port.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/http/http_body.h"
#include "kb_server/http/http_formats.h"
#include "kb_server/http/http_guard.h"
#include "kb_server/http/http_multipart.h"
#include "kb_server/http/http_sparql.h"
#include "kb_server/http/http_sparql_request.h"
#include "kb_server/http/long_answer.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/update_runner.h"

namespace docent::server {
namespace {

constexpr std::string_view kRoot = "/rdf-graphs";
constexpr char kAcceptPatch[] = "Accept-Patch";  // RFC 5789 section 3.1
constexpr char kPatchType[] = "application/sparql-update";
constexpr size_t kTextOfQuad = 200;  // of a graph that is read, roughly, without what its terms say
constexpr size_t kSlowestBytesASecond =
    size_t{1} << 20;  // at which a client may take a graph, beyond the time of a query

using Exchange = std::shared_ptr<HttpExchange>;
using Operation = sparql::UpdateOperation;

// Which graph a request is about.
struct Address {
  std::optional<HttpResponse> refusal;
  Term graph;
  bool is_default = false;
  bool is_new = false;  // POST to the store itself
  std::string as_of;    // GET and HEAD: the past
  Revision min_revision;
};

Address ReadAddress(const HttpRequest& http) {
  Address address;
  int named = 0;
  const bool reads = http.method == "GET" || http.method == "HEAD";
  const bool below = http.path.size() > kRoot.size() + 1;
  for (const auto& [name, value] : http.parameters) {
    if (name == "as-of" || name == "min-revision") {
      uint64_t number = 0;
      if (!reads) {
        address.refusal = TextResponse(400, name + " goes with GET and HEAD alone");
      } else if (name == "as-of" && value.empty()) {
        address.refusal = TextResponse(400, "as-of is empty; give a revision number or an xsd:dateTime");
      } else if (name == "as-of") {
        address.as_of = value;
      } else if (absl::SimpleAtoi(value, &number)) {
        address.min_revision = Revision(number);
      } else {
        address.refusal = TextResponse(400, "min-revision must be a revision number, not \"" + value + "\"");
      }
    }
    if (address.refusal) return address;
    if (name == "as-of" || name == "min-revision") continue;
    if (name != "default" && name != "graph") {
      address.refusal = MisspeltParameter(name, {"default", "graph", "as-of", "min-revision"});
      if (!address.refusal && below) {  // two addresses would be one graph
        address.refusal =
            TextResponse(400, "there is no parameter \"" + name +
                                  "\" below /rdf-graphs/, and it is no part of a graph's address; "
                                  "name such a graph with /rdf-graphs?graph=IRI");
      }
      if (address.refusal) return address;
      continue;
    }
    ++named;
    address.is_default = name == "default";
    address.graph = Term::Iri(address.is_default ? std::string(kDefaultGraph) : value);
  }
  if (below) {
    ++named;
    address.graph = Term::Iri(AddressOf(http));
  }
  if (named == 0 && http.method == "POST") {
    address.is_new = true;
  } else if (named != 1) {
    address.refusal =
        TextResponse(400, "name one graph: ?default, ?graph=IRI, or an address below /rdf-graphs/");
  } else if (!IsValidTermIri(address.graph.lexical)) {
    address.refusal =
        TextResponse(400, "graph must be an absolute IRI, not \"" + address.graph.lexical + "\"");
  } else if (!reads) {  // a PATCH may take away alone; what it adds is looked at when it is read
    const bool removes = http.method == "DELETE" || http.method == "PATCH";
    const std::string why = removes ? RefuseRemoval(address.graph) : RefuseGraph(address.graph);
    if (!why.empty()) address.refusal = TextResponse(403, why);
  }
  return address;
}

// Answers with a whole graph.
void ReadGraph(const ReadPorts& ports, const Address& address, Cancellation* cancellation,
               HttpExchange& exchange) {
  const std::string accept = exchange.request().Header("accept");
  if (ChooseGraphType(accept) == nullptr) return exchange.Respond(NoGraphType());
  absl::StatusOr<QueryGraph> read = GraphForQuery(ports, address.as_of, cancellation);
  if (!read.ok()) return exchange.Respond(ErrorResponse(read.status()));
  const std::shared_ptr<const Dictionary> dictionary = read->dictionary;
  GraphVersionPtr version = std::move(read->version);
  const std::optional<TermId> graph = dictionary->Find(address.graph);
  const uint64_t count = graph ? version->Count({{}, {}, {}, *graph}) : 0;
  if (count == 0 && !address.is_default) {
    HttpResponse missing = TextResponse(404, "there is no graph " + ToDisplay(address.graph));
    missing.headers.emplace_back(kAcceptPatch, kPatchType);
    return exchange.Respond(std::move(missing));
  }
  const size_t limit = ports.limits.query_memory_bytes;
  MemoryUse memory(limit, ports.query_memory);  // until the client has it
  const auto too_long = [&] {
    exchange.Respond(ErrorResponse(memory.Refusal(absl::ResourceExhaustedError(absl::StrCat(
        "the graph has ", count, " triples, more than fit into the limit query_memory_bytes = ", limit,
        "; ask for parts of it with CONSTRUCT")))));
  };
  if (!memory.Add(count * (sizeof(TermQuad) + kTextOfQuad))) return too_long();
  std::vector<TermQuad> triples;
  triples.reserve(count);
  bool fits = true;
  if (graph) {
    version->ForEach({{}, {}, {}, *graph}, [&](const Quad& quad) {
      triples.push_back({dictionary->Decode(quad.subject), dictionary->Decode(quad.predicate),
                         dictionary->Decode(quad.object), Term{}});
      fits = memory.Add(2 * TextBytes(triples.back()));  // as a term, and as text
      return fits;
    });
  }
  if (!fits) return too_long();
  HttpResponse head;
  head.headers = {{"Docent-Revision", absl::StrCat(version->revision().value())},
                  {"Cache-Control", "no-cache"},
                  {"Vary", "Accept"},
                  {kAcceptPatch, kPatchType}};
  version.reset();
  GraphText answer = WriteGraph(std::move(triples), accept, sparql::WellKnownPrefixes());
  if (answer.refusal) return exchange.Respond(*std::move(answer.refusal));
  head.content_type = answer.told;
  memory.Release(memory.used() - std::min(memory.used(), answer.text.size()));
  const size_t seconds = answer.text.size() / kSlowestBytesASecond;
  Cancellation sending(std::chrono::milliseconds(ports.limits.query_timeout_ms) +
                       std::chrono::seconds(seconds));
  LongAnswer(std::move(head), &exchange).SendAll(std::move(answer.text), &sending).IgnoreError();
}

// What a body says.
struct Content {
  std::optional<HttpResponse> refusal;
  std::vector<TermQuad> triples;
  std::shared_ptr<MemoryUse> memory;  // counts them
};

// What relative IRIs of a body are relative to. The default graph has a name of the server's own, which is no base: with it
// they would become words of Docent's ontology.
std::string BaseOf(const Address& address) {
  return address.graph.lexical == kDefaultGraph ? std::string() : address.graph.lexical;
}

// `number`: of the part among several. `memory`: of the request.
void ReadPart(const ReadPorts& ports, const HttpPart& part, const Address& address, size_t number,
              MemoryUse* memory, Cancellation* cancellation, Content* content) {
  const std::string type = MediaTypeOnly(part.content_type);
  std::optional<RdfFormat> format = FormatOfMediaType(type);
  const bool untyped = type.empty() || type == "application/octet-stream" || type == "application/gzip";
  if (untyped) format = FormatOfFile(part.file);  // of clients that know no better
  if (type.empty() && !format) format = RdfFormat::kTurtle;
  if (!format) {
    content->refusal = TextResponse(415, UnknownMediaType(type));
    return;
  }
  const std::string charset = CharsetOf(part.content_type);
  // RDF/XML may be in other encodings (RFC 7303); the parser says which it reads
  if (*format != RdfFormat::kRdfXml && (content->refusal = RefuseCharset(part.content_type))) return;
  ParseRdfOptions options;
  options.refuse_graph = RefuseGraph;
  options.base_iri = BaseOf(address);
  options.charset = charset;
  options.blank_node_scope = absl::StrCat("p", number);
  options.limits = ports.limits;
  options.cancellation = cancellation;
  options.memory = content->memory.get();
  absl::StatusOr<std::string> unpacked;
  std::string_view text = part.body;
  if (IsGzip(text)) {  // a .gz file as it is
    unpacked = Gunzip(text, ports.limits.http_body_bytes, "http_body_bytes", memory, cancellation);
    if (!unpacked.ok()) {
      content->refusal = ErrorResponse(unpacked.status());
      return;
    }
    text = *unpacked;
  }
  ParsedRdf parsed = ParseRdf(text, *format, options);
  if (!parsed.ok()) content->refusal = ErrorResponse(ToStatus(parsed, text));
  if (unpacked.ok() && memory != nullptr) memory->Release(unpacked->size());
  if (content->refusal) return;
  for (TermQuad& quad : parsed.quads) {
    if (!quad.graph.lexical.empty() && quad.graph != address.graph) {
      content->refusal = TextResponse(400, "the body names the graph " + ToDisplay(quad.graph) +
                                               "; what is sent to one graph cannot name others");
      return;
    }
    quad.graph = Term();
  }
  if (content->triples.empty()) {
    content->triples = std::move(parsed.quads);
    return;
  }
  // The array grows: what it leaves may be as large.
  if (!content->memory->Add(parsed.quads.size() * sizeof(TermQuad))) {
    content->refusal = ErrorResponse(content->memory->Refusal(absl::ResourceExhaustedError(
        absl::StrCat("the parts together say more than fits into the limit query_memory_bytes = ",
                     ports.limits.query_memory_bytes))));
    return;
  }
  std::move(parsed.quads.begin(), parsed.quads.end(), std::back_inserter(content->triples));
}

Content ReadContent(const ReadPorts& ports, const HttpExchange& exchange, const Address& address,
                    Cancellation* cancellation) {
  const HttpRequest& http = exchange.request();
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  Content content;
  content.memory = MemoryOfRequest(ports);
  const std::string type = http.Header("content-type");
  // RFC 9110 section 14.5: a part of a graph is not put in place of the graph.
  if (!http.Header("content-range").empty()) {
    content.refusal =
        TextResponse(400, "Content-Range: a graph is sent whole; POST adds to one that is there");
    return content;
  }
  HttpBody body;
  UnpackBody(http, ports.limits.http_body_bytes, "http_body_bytes", exchange.memory(), cancellation, &body);
  if ((content.refusal = std::move(body.refusal))) return content;
  if (MediaTypeOnly(type) != "multipart/form-data") {
    ReadPart(ports, {type, "", body.text}, address, 1, exchange.memory(), cancellation, &content);
    return content;
  }
  const absl::StatusOr<std::vector<HttpPart>> parts =
      ParseMultipart(type, body.text, ports.limits.http_parameters);
  if (!parts.ok()) {
    content.refusal = ErrorResponse(parts.status());
    return content;
  }
  for (size_t i = 0; i < parts->size() && !content.refusal; ++i) {
    ReadPart(ports, (*parts)[i], address, i + 1, exchange.memory(), cancellation, &content);
  }
  return content;
}

// An update about one graph, on its way: remembers whether the graph was there.
struct Change {
  UpdateRequest request;
  Address address;
  bool existed = false;
  bool condition_failed = false;  // of If-Match or If-None-Match
};

// RFC 9110 section 13.1, of a graph that is there or not. Graphs have no entity tags, so that none that is named can match.
bool ConditionHolds(const HttpRequest& http, bool exists) {
  const std::string match = http.Header("if-match");
  if (!match.empty() && (match != "*" || !exists)) return false;
  return http.Header("if-none-match") != "*" || !exists;
}

// Ends what is done for the request at the time limit and when the client leaves.
std::shared_ptr<Cancellation> CancellationOf(const ReadPorts& ports, const Exchange& exchange) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports.limits.query_timeout_ms));
  exchange->OnGone([cancellation] { cancellation->Cancel(); });
  return cancellation;
}

void Submit(const WritePorts& ports, std::shared_ptr<Change> change, Exchange exchange) {
  change->request.timeout = absl::Milliseconds(ports.limits.query_timeout_ms);
  change->request.client = exchange->client();
  const bool must_exist = exchange->request().method == "DELETE" && !change->address.is_default;
  change->request.precondition = [&ports, must_exist, exchange,
                                  weak = std::weak_ptr(change)](const GraphVersion& version) {
    const std::shared_ptr<Change> c = weak.lock();
    if (c == nullptr) return absl::OkStatus();
    const std::optional<TermId> graph = ports.dictionary->Find(c->address.graph);
    c->existed = c->address.is_default || (graph && version.Count({{}, {}, {}, *graph}) > 0);
    c->condition_failed = !ConditionHolds(exchange->request(), c->existed);
    if (c->condition_failed)
      return absl::FailedPreconditionError("the graph is not as If-Match or If-None-Match want it");
    if (c->existed || !must_exist) return absl::OkStatus();
    return absl::NotFoundError("there is no graph " + ToDisplay(c->address.graph));
  };
  UpdateRequest request = std::move(change->request);
  ports.updates->Submit(std::move(request), [change, exchange](const absl::StatusOr<BatchOutcome>& outcome) {
    if (change->condition_failed)
      return exchange->Respond(TextResponse(412, std::string(outcome.status().message())));
    if (!outcome.ok()) return exchange->Respond(ErrorResponse(outcome.status()));
    const bool made = !change->existed && outcome->added > 0;  // a graph without triples does not exist
    HttpResponse response = OutcomeResponse(made ? 201 : 200, *outcome);
    if (made && change->address.is_new)
      response.headers.emplace_back("Location", change->address.graph.lexical);
    exchange->Respond(std::move(response));
  });
}

Operation MakeOperation(Operation::Kind kind, const Address& address) {
  Operation operation;
  operation.kind = kind;
  operation.silent = kind == Operation::Kind::kDrop;
  operation.target.kind =
      address.is_default ? sparql::GraphTarget::Kind::kDefault : sparql::GraphTarget::Kind::kGraph;
  operation.target.graph = address.graph;
  return operation;
}

// PUT and POST: DROP where it replaces, then LOAD of the body.
void Write(const WritePorts& ports, Address address, std::shared_ptr<Cancellation> cancellation,
           const Exchange& exchange) {
  const HttpRequest& http = exchange->request();
  auto change = std::make_shared<Change>();
  change->request.cancellation = std::move(cancellation);
  Content content = ReadContent(ports, *exchange, address, change->request.cancellation.get());
  if (content.refusal) return exchange->Respond(*std::move(content.refusal));
  std::vector<Operation>& operations = change->request.update.operations;
  if (http.method == "PUT") operations.push_back(MakeOperation(Operation::Kind::kDrop, address));
  operations.push_back(MakeOperation(Operation::Kind::kLoad, address));
  change->request.load = [triples =
                              std::make_shared<const std::vector<TermQuad>>(std::move(content.triples))](
                             const std::string&) -> absl::StatusOr<sparql::DocumentQuads> { return triples; };
  change->request.memory = std::move(content.memory);
  change->address = std::move(address);
  Submit(ports, std::move(change), exchange);
}

// GRAPH around a part of a pattern, EXISTS and sub-SELECT included. What another server is asked is about its graphs.
bool NamesAGraph(const sparql::Algebra& pattern) {
  if (pattern.kind == sparql::Algebra::Kind::kGraph) return true;
  if (pattern.kind == sparql::Algebra::Kind::kService) return false;
  bool named = std::any_of(pattern.children.begin(), pattern.children.end(),
                           [](const sparql::AlgebraPtr& child) { return NamesAGraph(*child); });
  sparql::ForEachExpression(pattern, [&named](const sparql::Expression& expression) {
    named = named || (expression.pattern && NamesAGraph(*expression.pattern));
  });
  return named;
}

// The update's default graph becomes the graph of the request; an update that is about others is refused.
absl::Status BindToGraph(const Term& graph, sparql::Update* update) {
  const auto names_a_graph = [](const sparql::QuadTemplates& quads) {
    return std::any_of(quads.begin(), quads.end(), [](const auto& quad) { return quad.graph != nullptr; });
  };
  for (Operation& operation : update->operations) {
    const bool quads = operation.kind == Operation::Kind::kInsertData ||
                       operation.kind == Operation::Kind::kDeleteData ||
                       operation.kind == Operation::Kind::kModify;
    if (!quads || operation.with || !operation.from.empty() || !operation.from_named.empty() ||
        names_a_graph(operation.insert) || names_a_graph(operation.remove) ||
        (operation.where != nullptr && NamesAGraph(*operation.where))) {
      return absl::InvalidArgumentError(
          "a PATCH reads and changes its own graph alone: INSERT and DELETE without GRAPH, WITH or USING, "
          "and no "
          "GRAPH in WHERE; POST others to /sparql");
    }
    operation.with = graph;
  }
  return absl::OkStatus();
}

void Patch(const WritePorts& ports, Address address, std::shared_ptr<Cancellation> cancellation,
           const Exchange& exchange) {
  const HttpRequest& http = exchange->request();
  const std::string type = http.Header("content-type");
  if (std::optional<HttpResponse> refusal = RefuseCharset(type))
    return exchange->Respond(*std::move(refusal));
  if (MediaTypeOnly(type) != kPatchType) {
    HttpResponse refusal = TextResponse(415, absl::StrCat("PATCH a graph with ", kPatchType));
    refusal.headers.emplace_back(kAcceptPatch, kPatchType);
    return exchange->Respond(std::move(refusal));
  }
  if (http.body.size() > ports.limits.update_text_bytes) {
    return exchange->Respond(TextResponse(
        413, absl::StrCat("the update has ", http.body.size(), " bytes; the limit update_text_bytes is ",
                          ports.limits.update_text_bytes)));
  }
  const auto known = KnownNames(ports);
  sparql::ParseOptions options = sparql::ParseOptionsWith(ports.limits, ports.functions);
  options.known = known.get();
  options.base_iri = BaseOf(address);
  auto change = std::make_shared<Change>();
  change->request.memory = MemoryOfRequest(ports);
  change->request.cancellation = std::move(cancellation);
  options.memory = change->request.memory.get();
  options.cancellation = change->request.cancellation.get();
  HttpBody body;
  sparql::ParsedUpdate parsed;
  {
    const WorkerPool::SharedWork shared(ports.workers, options.cancellation);
    UnpackBody(http, ports.limits.update_text_bytes, "update_text_bytes", exchange->memory(),
               options.cancellation, &body);
    if (!body.refusal) parsed = sparql::ParseUpdate(body.text, options);
  }
  if (body.refusal) return exchange->Respond(*std::move(body.refusal));
  if (!parsed.ok()) return exchange->Respond(ErrorResponse(ToStatus(parsed, body.text)));
  if (absl::Status status = BindToGraph(address.graph, &parsed.update); !status.ok()) {
    return exchange->Respond(TextResponse(422, std::string(status.message())));
  }
  change->request.update = std::move(parsed.update);
  change->address = std::move(address);
  Submit(ports, std::move(change), exchange);
}

// On a worker.
void Answer(const WritePorts& ports, Address address, std::shared_ptr<Cancellation> cancellation,
            const Exchange& exchange) {
  const std::string& method = exchange->request().method;
  if (method == "GET" || method == "HEAD") {
    return ReadGraph(ports, address, cancellation.get(), *exchange);
  }
  if (method == "PATCH") return Patch(ports, std::move(address), std::move(cancellation), exchange);
  if (method != "DELETE") return Write(ports, std::move(address), std::move(cancellation), exchange);
  auto change = std::make_shared<Change>();
  change->request.cancellation = std::move(cancellation);
  change->request.update.operations.push_back(MakeOperation(Operation::Kind::kDrop, address));
  change->address = std::move(address);
  Submit(ports, std::move(change), exchange);
}

void Handle(const WritePorts& ports, Exchange exchange) {
  if (std::optional<HttpResponse> refusal = RefuseAnotherSite(exchange->request()))
    return exchange->Respond(*std::move(refusal));
  Address address = ReadAddress(exchange->request());
  if (address.refusal) return exchange->Respond(*std::move(address.refusal));
  if (address.is_new) {
    address.graph = Term::Iri(absl::StrCat(AddressOf(exchange->request()),
                                           absl::EndsWith(exchange->request().raw_path, "/") ? "" : "/", "g",
                                           ports.clock->Now(), "n", ports.updates->NextNumber()));
  }
  const Revision revision = address.min_revision;
  const std::shared_ptr<Cancellation> cancellation = CancellationOf(ports, exchange);
  SubmitOnVersion(ports, revision,
                  {.run = [&ports, exchange, cancellation,
                           address = std::move(address)] { Answer(ports, address, cancellation, exchange); },
                   .refuse = [exchange](const absl::Status& why) { exchange->Respond(ErrorResponse(why)); },
                   .client = exchange->client(),
                   .until = absl::Now() + absl::Milliseconds(ports.limits.query_timeout_ms),
                   .cancellation = cancellation});
}

}  // namespace

void AddGraphStoreRoutes(HttpRoutes* routes, const WritePorts* ports) {
  for (const char* method : {"GET", "PUT", "POST", "DELETE", "PATCH"}) {
    for (const char* path : {"/rdf-graphs", "/rdf-graphs/*"}) {
      routes->Add(method, path, [ports](Exchange exchange) { Handle(*ports, std::move(exchange)); });
    }
  }
}

}  // namespace docent::server
