// The stages of a replay as they stand before the first turn of its case. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAY_STAGES_H_
#define DOCENT_KB_SERVER_REPLAY_PLAY_STAGES_H_

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "kb_server/replay/case_player.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/turn/turn.h"
#include "workflow/cawl/ast.h"

namespace docent::server {

class PlayStages {
 public:
  // All must outlive it.
  PlayStages(const RunCase& recorded, const cawl::Document& document, const PlayOptions& options)
      : recorded_(recorded), document_(document), options_(options) {}

  // Those of the recorded server; or of a world, where `document` is deployed, whose activator never fires. Again: as if
  // nothing had been played. INVALID_ARGUMENT: the state or a document is damaged.
  absl::Status SetUp();

  Stages& operator*() { return *stages_; }
  Stages* operator->() { return stages_.get(); }
  const Dictionary& dictionary() const { return *dictionary_; }
  // As a world deploys it.
  absl::StatusOr<Document> Played(const Document& document) const;
  // A turn of the log or of the replay. CANCELLED, DEADLINE_EXCEEDED; other errors name the turn.
  absl::StatusOr<TurnResult> Turn(WriteBatch batch, uint64_t offset, TimeMicros now_us);

 private:
  absl::Status SetUpState();
  absl::Status SetUpWorld();
  absl::Status Load(bool modules);
  void RestoreLifetimes();
  absl::Status PutDocuments(std::vector<const Document*> left);
  absl::Status SetUpTurn(WriteBatch batch);

  const RunCase& recorded_;
  const cawl::Document& document_;
  const PlayOptions& options_;
  std::unique_ptr<Dictionary> dictionary_;
  std::unique_ptr<Stages> stages_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAY_STAGES_H_
