#include "kb_server/http/long_answer.h"

#include <utility>

namespace docent::server {
namespace {

constexpr size_t kShortBytes = 1u << 20;

}  // namespace

bool LongAnswer::Send(std::string* piece) {
  bool there = true;
  if (exchange_.begun()) {
    if (exchange_.full()) {
      WorkerPool::Waiting waiting(WorkerPool::Waiting::What::kClient);
      there = exchange_.Write(*piece, [&waiting] { return waiting.Crowded(); });
    } else {
      there = exchange_.Write(*piece);
    }
  } else {
    head_.body.swap(*piece);
    exchange_.Begin(std::move(head_));
  }
  piece->clear();
  return there;
}

bool LongAnswer::End(std::string piece) {
  if (!exchange_.begun()) {
    head_.body = std::move(piece);
    exchange_.Respond(std::move(head_));
    return true;
  }
  const bool there = Send(&piece);
  exchange_.End();
  return there;
}

absl::Status LongAnswer::SendAll(std::string text, Cancellation* cancellation) {
  if (text.size() <= kShortBytes || exchange_.request().method == "HEAD") {
    End(std::move(text));
    return absl::OkStatus();
  }
  std::string piece;
  for (size_t at = 0; at < text.size(); at += kPieceBytes) {
    absl::Status status = cancellation->CheckNow();
    piece.assign(text, at, kPieceBytes);
    if (status.ok() && !Send(&piece)) status = absl::CancelledError("the client went away");
    if (status.ok()) continue;
    exchange_.Abort();
    return status;
  }
  exchange_.End();
  return absl::OkStatus();
}

}  // namespace docent::server
