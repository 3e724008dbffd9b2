// What became of notifications. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_NOTIFICATIONS_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_NOTIFICATIONS_H_

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// The final report of a notification in the outbox: it was delivered, or given up.
void TakeDelivery(Engine::Core* core, const CommandReport& report);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_NOTIFICATIONS_H_
