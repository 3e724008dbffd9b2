#include "graph/redland/client_store.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/rdf/term_check.h"
#include "graph/wire/term_proto.h"

namespace docent::redland {
namespace {

// Retries while a server restarts.
constexpr int kAttempts = 10;
constexpr absl::Duration kPause = absl::Milliseconds(500);

// False if no quad of a graph can have these terms.
bool CanMatch(const QuadQuery& query, size_t term_bytes) {
  for (const auto* term : {&query.subject, &query.predicate, &query.object, &query.graph}) {
    if (*term && !CheckTerm(**term, term_bytes).ok()) return false;
  }
  return !(query.subject && query.subject->IsLiteral()) && !(query.predicate && !query.predicate->IsIri()) &&
         !(query.graph && !query.graph->IsIri());
}

// SELECT ?s ?p ?o ?g for the query; a given term is written into the pattern and not selected (blank nodes
// are).
std::string SelectText(const QuadQuery& query) {
  std::string filter;
  const auto place = [&filter](const std::optional<Term>& term, const char* variable) {
    if (term && !term->IsBlank()) return ToNTriples(*term);
    if (term) absl::StrAppend(&filter, " FILTER(isBlank(", variable, "))");
    return std::string(variable);
  };
  const std::string triple = absl::StrCat(place(query.subject, "?s"), " ", place(query.predicate, "?p"), " ",
                                          place(query.object, "?o"));
  return absl::StrCat("SELECT ?s ?p ?o ?g { GRAPH ", place(query.graph, "?g"), " { ", triple, " }", filter,
                      " }");
}

}  // namespace

ClientStore::ClientStore(std::string address, std::string session, const Limits& limits)
    : address_(std::move(address)), session_(std::move(session)), limits_(limits) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(static_cast<int>(limits.grpc_message_bytes));
  // Short enough to notice a restarted server while a change is still being retried.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);  // time limit of one attempt to connect
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 500);
  stub_ = v1::Context::NewStub(
      grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments));
}

absl::StatusOr<std::unique_ptr<ClientStore>> ClientStore::Open(const std::string& address,
                                                               const std::string& session,
                                                               const Limits& limits) {
  std::unique_ptr<ClientStore> store(new ClientStore(address, session, limits));
  absl::Status status = store->Query("ASK {}", [](const v1::Row&) { return absl::OkStatus(); });
  if (!status.ok()) return status;
  return store;
}

absl::Status ClientStore::Query(const std::string& text, const RowVisitor& visit) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() +
                       std::chrono::milliseconds(limits_.redland_answer_ms));
  v1::QueryRequest request;
  request.set_query(text);
  request.set_min_revision(written_.value());
  request.set_default_graph(v1::QueryRequest::UNION);
  auto reader = stub_->Query(&context, request);
  absl::Status visited;
  v1::QueryReply reply;
  while (reader->Read(&reply)) {
    if (reply.has_header()) revision_ = Revision(reply.header().revision());
    if (!reply.has_row() || !visited.ok()) continue;
    visited = visit(reply.row());
    if (!visited.ok()) context.TryCancel();
  }
  grpc::Status status = reader->Finish();
  if (!visited.ok()) return visited;
  if (status.ok()) return absl::OkStatus();
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) {
    return absl::DeadlineExceededError(absl::StrCat(
        "the server at ", address_, " gave no whole answer within the limit redland_answer_ms = ",
        limits_.redland_answer_ms, " (", status.error_message(), ")"));
  }
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE) {
    return absl::UnavailableError(absl::StrCat("no server answers at ", address_, " (",
                                               status.error_message(), "); start one with `docent serve`"));
  }
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

absl::StatusOr<std::vector<TermQuad>> ClientStore::FindAtMost(const QuadQuery& query, size_t max,
                                                              const std::string& limit_name) {
  std::vector<TermQuad> quads;
  if (!CanMatch(query, limits_.term_bytes)) return quads;
  const std::string text = SelectText(query);
  absl::Status status = Query(text, [&](const v1::Row& row) {
    if (quads.size() == max) {
      return absl::ResourceExhaustedError(
          absl::StrCat("more quads match than the limit ", limit_name, " = ", max));
    }
    const auto part = [&row](int i, const std::optional<Term>& given) {
      return FromProto(row.values(i)).value_or(given.value_or(Term()));
    };
    TermQuad quad = {part(0, query.subject), part(1, query.predicate), part(2, query.object),
                     part(3, query.graph)};
    if (query.Matches(quad)) quads.push_back(std::move(quad));
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return quads;
}

absl::StatusOr<std::unique_ptr<QuadStream>> ClientStore::Find(const QuadQuery& query) {
  auto quads = FindAtMost(query, SIZE_MAX, "");
  if (!quads.ok()) return quads.status();
  if (!query.graph) SortByTriple(&*quads);
  return StreamOf(*std::move(quads));
}

absl::StatusOr<uint64_t> ClientStore::Size() {
  uint64_t size = 0;
  absl::Status status =
      Query("SELECT (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } }", [&size](const v1::Row& row) {
        return absl::SimpleAtoi(row.values(0).literal().lexical(), &size)
                   ? absl::OkStatus()
                   : absl::InternalError("the server's count is not a number");
      });
  if (!status.ok()) return status;
  return size;
}

absl::StatusOr<std::vector<Term>> ClientStore::Graphs() {
  std::vector<Term> graphs;
  absl::Status status = Query("SELECT DISTINCT ?g { GRAPH ?g { ?s ?p ?o } }", [&graphs](const v1::Row& row) {
    graphs.push_back(FromProto(row.values(0)).value_or(Term()));
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  std::sort(graphs.begin(), graphs.end());
  return graphs;
}

absl::Status ClientStore::Apply(std::vector<QuadOperation> operations) {
  v1::AssertRequest request;
  request.set_request_id(absl::StrCat(session_, "-", ++requests_));
  request.set_mode(v1::AssertRequest::LOAD);
  for (const QuadOperation& operation : operations) {
    const bool add = operation.kind == QuadOperation::Kind::kAdd;
    ToProto(operation.quad, add ? request.add_add() : request.add_remove());
  }
  if (request.ByteSizeLong() > limits_.grpc_message_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat(operations.size(), " changes in one call are ", request.ByteSizeLong(),
                     " bytes; the limit grpc_message_bytes is ", limits_.grpc_message_bytes,
                     "; make them in several calls, or use `docent load`. Nothing was changed"));
  }
  return Send(request);
}

absl::Status ClientStore::Send(const v1::AssertRequest& request) {
  grpc::Status status;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (attempt > 0) absl::SleepFor(kPause);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::milliseconds(limits_.redland_answer_ms));
    v1::AssertReply reply;
    status = stub_->Assert(&context, request, &reply);
    if (status.ok()) {
      written_ = Revision(reply.offset());
      return absl::OkStatus();
    }
    if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) break;
    if (status.error_code() != grpc::StatusCode::UNAVAILABLE) {
      return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
    }
  }
  return absl::UnavailableError(
      absl::StrCat("the server at ", address_, " did not acknowledge the change (", status.error_message(),
                   "); if it went away meanwhile, it holds all of it or nothing: look before repeating it"));
}

}  // namespace docent::redland
