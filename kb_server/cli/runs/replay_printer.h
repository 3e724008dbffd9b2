// Prints replays for people. One thread.
#ifndef DOCENT_KB_SERVER_CLI_RUNS_REPLAY_PRINTER_H_
#define DOCENT_KB_SERVER_CLI_RUNS_REPLAY_PRINTER_H_

#include "docent/v1/replays.pb.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {

// Node by node, the one that differs first in front.
void PrintReplay(const v1::ReplayReply& reply, const Presenter& presenter);
// Likewise the differences alone, each line behind `indent`.
void PrintDifferences(const v1::ReplayReply& reply, const Presenter& presenter, const char* indent);

void PrintTrial(const v1::TryNodeRequest& request, const v1::TryNodeReply& reply, const Presenter& presenter);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RUNS_REPLAY_PRINTER_H_
