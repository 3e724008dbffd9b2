// CAWL check environment of the server: the words of the live graph's ontologies, the
// operations that robots offer, the registered robot services and workflows.
#ifndef DOCENT_KB_SERVER_WORK_GRAPH_ENVIRONMENT_H_
#define DOCENT_KB_SERVER_WORK_GRAPH_ENVIRONMENT_H_

#include <memory>

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "kb_server/door/catalog.h"
#include "workflow/cawl/check/environment.h"

namespace docent::server {

// Looks things up in `version` when they are asked for, and keeps it. `dictionary` and `functions` must outlive it. One
// thread.
std::unique_ptr<cawl::Environment> GraphEnvironment(const Dictionary& dictionary, GraphVersionPtr version,
                                                    std::shared_ptr<const Catalog> catalog,
                                                    const sparql::FunctionRegistry* functions);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_GRAPH_ENVIRONMENT_H_
