// Address of a gRPC server or adapter whose services are to be imported, and whether the server may reach it. Pure functions;
// any thread.
#ifndef DOCENT_KB_SERVER_IMPORTS_IMPORT_TARGET_H_
#define DOCENT_KB_SERVER_IMPORTS_IMPORT_TARGET_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {

// HOST:PORT, with a name, an IPv4 address or an IPv6 address in brackets. INVALID_ARGUMENT for anything else, schemes and paths
// included, which gRPC would know.
absl::Status CheckTarget(const std::string& target);

// PERMISSION_DENIED: the target is neither on this machine (localhost, 127.0.0.0/8, [::1]) nor on the allow-list as
// http://HOST:PORT. `remote` may be null: nothing is on the list.
absl::Status CheckMayReach(const std::string& target, const RemoteAccess* remote);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_IMPORTS_IMPORT_TARGET_H_
