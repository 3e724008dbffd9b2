// Watch over the leases of robots: has the graph told of those that were lost. Any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_LEASE_WATCH_H_
#define DOCENT_KB_SERVER_ROBOTS_LEASE_WATCH_H_

#include "graph/rdf/dictionary.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/query_port.h"
#include "kb_server/robots/fleet_leases.h"

namespace docent::server {

class LeaseWatch {
 public:
  // All must outlive it, and the writer's last turn.
  LeaseWatch(FleetLeases* leases, Inbox* inbox, const QueryPort* queries, const Dictionary* dictionary)
      : leases_(*leases), inbox_(*inbox), queries_(*queries), dictionary_(*dictionary) {}

  // At the start: robots that the graph has as online get one lease to show themselves.
  void Begin();
  // To be called about once a second: the graph is told that robots whose lease ran out are offline.
  void Look();

 private:
  FleetLeases& leases_;
  Inbox& inbox_;
  const QueryPort& queries_;
  const Dictionary& dictionary_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_LEASE_WATCH_H_
