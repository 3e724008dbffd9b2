#include "kb_server/live/live.h"

#include <pthread.h>

#include <utility>

#include "absl/time/clock.h"
#include "kb_server/live/live_session.h"
#include "kb_server/live/websocket.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLook = absl::Milliseconds(20);  // for new revisions

}  // namespace

Live::Live(LivePorts ports) : ports_(std::move(ports)) {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "live");
    Loop();
  });
}

Live::~Live() {
  Stop();
}

void Live::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  if (thread_.joinable()) thread_.join();
  for (const std::shared_ptr<LiveSession>& session : Sessions()) session->Stop();
}

void Live::AddRoute(HttpRoutes* routes) {
  routes->Add("GET", "/live",
              [this](std::shared_ptr<HttpExchange> exchange) { Accept(std::move(exchange)); });
}

void Live::Accept(std::shared_ptr<HttpExchange> exchange) {
  HttpFields headers;
  std::optional<HttpResponse> refusal = AcceptWebSocket(exchange->request(), &headers);
  if (refusal) return exchange->Respond(*std::move(refusal));
  auto session = std::make_shared<LiveSession>(&ports_, exchange);
  exchange->Upgrade(std::move(headers), session);
  session->Begin();
  bool late = false;
  {
    absl::MutexLock lock(&mutex_);
    std::erase_if(sessions_, [](const std::weak_ptr<LiveSession>& one) { return one.expired(); });
    sessions_.push_back(session);
    late = stopping_;
  }
  if (late) session->Stop();
}

std::vector<std::shared_ptr<LiveSession>> Live::Sessions() {
  std::vector<std::shared_ptr<LiveSession>> sessions;
  absl::MutexLock lock(&mutex_);
  for (const std::weak_ptr<LiveSession>& one : sessions_) {
    if (std::shared_ptr<LiveSession> session = one.lock()) sessions.push_back(std::move(session));
  }
  return sessions;
}

size_t Live::open() {
  return Sessions().size();
}

// While there is no connection it sleeps.
void Live::Loop() {
  const auto has_work = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return stopping_ || !sessions_.empty(); };
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      std::erase_if(sessions_, [](const std::weak_ptr<LiveSession>& one) { return one.expired(); });
      if (sessions_.empty() && ports_.followed != nullptr) ports_.followed->Keep(false);
      mutex_.Await(absl::Condition(&has_work));
      if (stopping_) return;
      if (ports_.followed != nullptr) ports_.followed->Keep(true);
    }
    const absl::Time now = absl::Now();
    const uint64_t revision = ports_.queries->Newest()->revision().value();
    for (const std::shared_ptr<LiveSession>& session : Sessions()) session->Look(now, revision);
    absl::SleepFor(kLook);
  }
}

}  // namespace docent::server
