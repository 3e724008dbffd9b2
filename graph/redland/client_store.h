// A quad store that is a running server's graph, over gRPC.
//
// Each Find is one query on one version of the graph, fetched whole: a connection that breaks is an error,
// never a short answer. Each Apply is one Assert with an id of its own, so that a repeat after a lost answer
// is not applied twice; it is acknowledged when the server says that it is durable.
//
// A blank node cannot be named in a query: a Find with one fetches what matches otherwise and has a blank
// node there, and picks out the one that is meant.
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
  // `address`: HOST:PORT of a server's gRPC. `session`: a text that no other client uses, from which request
  // ids are made. UNAVAILABLE, in one line, where no server answers.
  static absl::StatusOr<std::unique_ptr<ClientStore>> Open(const std::string& address,
                                                           const std::string& session,
                                                           const Limits& limits = {});

  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  // As QuadStore. UNAVAILABLE where the server did not acknowledge the change although it was asked several
  // times; the message says that it may hold it.
  absl::Status Apply(std::vector<QuadOperation> operations) override;

  // The revision that answered last.
  Revision revision() const { return revision_; }
  // As Find, and not more than `max` quads: RESOURCE_EXHAUSTED naming `limit_name` beyond.
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
