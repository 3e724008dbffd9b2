#include "kb_server/grpc/client_of.h"

#include <string>
#include <string_view>

namespace docent::server {

ClientPtr ClientOf(const grpc::CallbackServerContext& context, Clients* clients) {
  if (clients == nullptr) return nullptr;
  const std::string peer = context.peer();
  if (!peer.starts_with("inproc")) return clients->Of(peer);
  const auto named = context.client_metadata().find(kClientKey);
  if (named == context.client_metadata().end()) return clients->Of(peer);
  return clients->Of(std::string_view(named->second.data(), named->second.size()));
}

}  // namespace docent::server
