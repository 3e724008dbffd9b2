// Questions about the facts of a replay: whether the activator fires, and what a condition lacks. One thread, that of the stages.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAY_QUESTIONS_H_
#define DOCENT_KB_SERVER_REPLAY_PLAY_QUESTIONS_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "kb_server/clock/wait_times.h"
#include "kb_server/replay/case_player.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"
#include "workflow/cawl/ast.h"

namespace docent::server {

struct Activation {
  bool fires = false;
  std::map<std::string, Term> values;  // with which it starts a run
  std::string why_not;                 // for people
  std::string ask;                     // what does not hold, with the values in it
  std::string note;                    // what could not be asked, for people
  // Its condition holds with the values, and will have held for long enough (ext:for) then, if it goes on.
  std::optional<TimeMicros> fires_us;
};
// Whether the document's activator fires for the key `values` on the graph that the stages have now. `held`: since when rules
// with ext:for have held; of others that begins now. Null: that they hold counts.
absl::StatusOr<Activation> FindActivation(Stages* stages, const cawl::Document& document,
                                          const NamedTerms& values, TimeMicros now_us,
                                          const std::vector<HeldSince>* held = nullptr);

// Whether the activators of two documents fire for the same, and start the flow of the same name.
bool FiresAlike(const cawl::Document& a, const cawl::Document& b, const Limits& limits);
// IRIs of the times that the condition of the document's activator asks for (graph/calendar/time_spec.h).
std::vector<std::string> TimesOfActivator(const cawl::Document& document, const Limits& limits);

class PlayQuestions {
 public:
  // The stages and the cancellation must outlive it; `version` is theirs.
  PlayQuestions(const Stages* stages, GraphVersionPtr version, TimeMicros now_us, Cancellation* cancellation)
      : stages_(*stages), version_(std::move(version)), now_us_(now_us), cancellation_(cancellation) {}

  // What an ASK lacks, for people: facts, or a time that is to come; empty: that is not known. `node`: that waits with it, if one
  // does.
  std::string Missing(const std::string& ask, const WaitingNode& node = {});
  // The nodes of the tree that wait, once for each alternative of their conditions.
  void AddWaits(const RunTree& tree, std::vector<PlayedWait>* waits);
  // Why the first invocation that is pending has no robot, or when it is tried again; empty: none is.
  std::string Pending(const RunTree& tree) const;

 private:
  // Of an ASK that holds.
  std::string LacksBesideFacts(const std::string& ask, const WaitingNode& node, bool has_robot) const;
  bool IsByEvent(const std::string& ask) const;

  const Stages& stages_;
  const GraphVersionPtr version_;
  const TimeMicros now_us_;
  Cancellation* const cancellation_;
  int asked_ = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAY_QUESTIONS_H_
