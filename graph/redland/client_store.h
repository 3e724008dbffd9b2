// A quad store over gRPC: the graph of a running server.
//
// Each Find is one query on one version of the graph, fetched whole: a connection that breaks is an error,
// never a short answer. Each Apply is one Assert with an id of its own, so that a repeat after a lost answer
// is not applied twice; it succeeds when the server reports the change as durable.
//
// A blank node cannot be named in a query: a Find with a blank node fetches the quads that match otherwise
// and have a blank node there, and selects the right one.
#ifndef DOCENT_GRAPH_REDLAND_CLIENT_STORE_H_
#define DOCENT_GRAPH_REDLAND_CLIENT_STORE_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "docent/v1/context.grpc.pb.h"
#include "graph/base/ids.h"
#include "graph/base/limits.h"
#include "graph/redland/quad_store.h"

namespace docent::redland {

class ClientStore final : public QuadStore {
 public:
  // `address`: HOST:PORT of a server's gRPC. `session`: a text that no other client uses, the base of request
  // ids. UNAVAILABLE, in one line, if no server answers.
  static absl::StatusOr<std::unique_ptr<ClientStore>> Open(const std::string& address,
                                                           const std::string& session,
                                                           const Limits& limits = {});

  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  // As QuadStore. UNAVAILABLE if the server did not acknowledge the change after several attempts; the
  // message says that the server may have applied it.
  absl::Status Apply(std::vector<QuadOperation> operations) override;

  // The revision of the last answer.
  Revision revision() const { return revision_; }
  // As Find, but with at most `max` quads: RESOURCE_EXHAUSTED naming `limit_name` beyond.
  absl::StatusOr<std::vector<TermQuad>> FindAtMost(const QuadQuery& query, size_t max,
                                                   const std::string& limit_name);

 private:
  using RowVisitor = std::function<absl::Status(const v1::Row& row)>;
  ClientStore(std::string address, std::string session, const Limits& limits);
  absl::Status Query(const std::string& text, const RowVisitor& visit);
  absl::Status Send(const v1::AssertRequest& request);

  const std::string address_;
  const std::string session_;
  const Limits limits_;
  std::unique_ptr<v1::Context::Stub> stub_;
  Revision revision_;
  Revision written_;  // reads are of this revision or a later one
  uint64_t requests_ = 0;
};

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_CLIENT_STORE_H_
