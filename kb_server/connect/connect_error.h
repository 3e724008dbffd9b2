// Errors of the Connect protocol (connectrpc.com/docs/protocol, "Error Codes" and "Error End-Stream"): names of codes, HTTP
// statuses, and the JSON form. Pure functions.
#ifndef DOCENT_KB_SERVER_CONNECT_CONNECT_ERROR_H_
#define DOCENT_KB_SERVER_CONNECT_CONNECT_ERROR_H_

#include <grpcpp/support/status.h>

#include <string>
#include <string_view>

#include "kb_server/work/http_message.h"

namespace docent::server {

// "not_found". Of OK and of numbers that are no code: "unknown".
std::string_view ConnectCodeName(grpc::StatusCode code);
// The HTTP status of a unary call that ends with this code; 200 of OK.
int ConnectHttpStatus(grpc::StatusCode code);

// `text` as a JSON string, with quotes. Bytes that are not UTF-8 become U+FFFD.
std::string JsonString(std::string_view text);

// {"code":"not_found","message":"…","details":[{"type":"google.rpc.RetryInfo","value":"CgIIAQ"}]}. Details are those of
// a google.rpc.Status in error_details(), which is where gRPC has them.
std::string ConnectErrorJson(const grpc::Status& status);

// The answer to a unary call that failed.
HttpResponse ConnectErrorResponse(const grpc::Status& status);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_CONNECT_ERROR_H_
