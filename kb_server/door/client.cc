#include "kb_server/door/client.h"

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::server {

ClientPtr Clients::Of(std::string_view name) {
  absl::MutexLock lock(&mutex_);
  const auto found = clients_.find(ToAbsl(name));
  if (found != clients_.end()) {
    if (ClientPtr client = found->second.lock()) return client;
  }
  return Add(std::string(name));
}

ClientPtr Clients::Make(std::string_view kind) {
  absl::MutexLock lock(&mutex_);
  return Add(absl::StrCat(ToAbsl(kind), ":", ++last_number_));
}

ClientPtr Clients::Add(std::string name) {
  if (clients_.size() >= drop_gone_at_) {
    absl::erase_if(clients_, [](const auto& one) { return one.second.expired(); });
    drop_gone_at_ = 2 * clients_.size() + 64;
  }
  auto client = std::make_shared<Client>(name);
  clients_[std::move(name)] = client;
  return client;
}

size_t Clients::size() {
  absl::MutexLock lock(&mutex_);
  size_t there = 0;
  for (const auto& [name, client] : clients_) there += client.expired() ? 0 : 1;
  return there;
}

}  // namespace docent::server
