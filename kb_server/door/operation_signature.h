// What a workflow's check needs to know of a registered robot service. Function without state; any thread.
#ifndef DOCENT_KB_SERVER_DOOR_OPERATION_SIGNATURE_H_
#define DOCENT_KB_SERVER_DOOR_OPERATION_SIGNATURE_H_

#include "workflow/cawl/check/environment.h"
#include "workflow/rsel/service_registry.h"

namespace docent::server {

// Of a plan of a registry. The types of inputs are those of the parts of the process's input message.
cawl::OperationSignature SignatureOf(const rsel::Plan& plan);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_OPERATION_SIGNATURE_H_
