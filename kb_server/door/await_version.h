// Read your writes: work on a version that may not be here yet.
#ifndef DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_
#define DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_

#include "graph/base/ids.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// Gives `work` to a worker as soon as the newest version is at least `revision`; until then it has neither a thread nor a place
// in a queue. It is refused as WorkerPool::Submit and QueryPort::Await say. Any thread.
void SubmitOnVersion(const ReadPorts& ports, Revision revision, Work work);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_
