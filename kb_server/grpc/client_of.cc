#include "kb_server/grpc/client_of.h"

#include <string>
#include <string_view>

namespace docent::server {

bool IsOverNetwork(std::string_view peer) {
  return peer.starts_with("ipv4:") || peer.starts_with("ipv6:") || peer.starts_with("unix:");
}

ClientPtr ClientOf(const grpc::CallbackServerContext& context, Clients* clients) {
  if (clients == nullptr) return nullptr;
  const std::string peer = context.peer();
  if (IsOverNetwork(peer)) return clients->Of(peer);
  const auto named = context.client_metadata().find(kClientKey);
  if (named == context.client_metadata().end()) return clients->Of(peer);
  return clients->Of(std::string_view(named->second.data(), named->second.size()));
}

}  // namespace docent::server
