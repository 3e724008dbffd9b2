// SPARQL 1.1 Service Description of the endpoint. Any thread.
#ifndef DOCENT_KB_SERVER_HTTP_SERVICE_DESCRIPTION_H_
#define DOCENT_KB_SERVER_HTTP_SERVICE_DESCRIPTION_H_

#include <string>
#include <string_view>

#include "kb_server/door/ports.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

// The description of the endpoint at `address`, with the graphs of the newest version, in what `accept` asks
// for.
HttpResponse DescribeService(const ReadPorts& ports, const std::string& address, std::string_view accept);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_SERVICE_DESCRIPTION_H_
