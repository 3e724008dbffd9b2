#include "kb_server/cli/client.h"

#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/limits.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/iri.h"
#include "graph/wire/term_proto.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {
namespace {

// What is wrong with the address of a server, for people; empty: nothing. gRPC would take the port 99999 for 34463.
std::string FaultOfAddress(const std::string& address) {
  if (const size_t scheme = address.find("://"); scheme != std::string::npos && address.starts_with("http"))
    return absl::StrCat("write HOST:PORT, without ", address.substr(0, scheme + 3));
  for (const char* scheme : {"unix:", "unix-abstract:", "dns:", "ipv4:", "ipv6:"}) {
    if (address.starts_with(scheme)) return "";  // a name of gRPC's own
  }
  const size_t colon = address.rfind(':');
  const std::string port = colon == std::string::npos ? "" : address.substr(colon + 1);
  const bool digits = !port.empty() && port.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || colon == 0)
    return absl::StrCat("\"", address, "\" is no address; write HOST:PORT, such as 127.0.0.1:7400");
  int number = 0;
  if (absl::SimpleAtoi(port, &number) && number >= 1 && number <= 65535) return "";
  return absl::StrCat("the port ", port, " is not between 1 and 65535");
}

// What a server of this machine is given to begin to listen.
constexpr std::chrono::seconds kStart(2);

bool IsOnLoopback(std::string_view address) {
  const std::string_view host = address.substr(0, address.rfind(':'));
  return host == "localhost" || host == "[::1]" || host.starts_with("127.");
}

}  // namespace

void AddClientOptions(CLI::App* command, ClientOptions* options, bool json) {
  command->add_option("--server", options->server, "gRPC address of the server, HOST:PORT")
      ->type_name("ADDRESS")
      ->envname("DOCENT_SERVER")
      ->check(std::function<std::string(const std::string&)>(FaultOfAddress))
      ->capture_default_str();
  if (json) command->add_flag("--json", options->json, "Print JSON, an object a line, with whole IRIs");
}

void AddShowOptions(CLI::App* command, ClientOptions* options) {
  command->add_flag("--full", options->full, "Print whole IRIs and whole values, not cut to the terminal");
  command->add_option("--color", options->colours, "Use colours: on a terminal (auto), always or never")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
}

void AddPrefixOption(CLI::App* command, std::vector<std::string>* prefixes) {
  command
      ->add_option(
          "--prefix", *prefixes,
          "A prefix beside the well-known ones and those of the server's modules, rules and workflows")
      ->type_name("NAME=IRI")
      ->allow_extra_args(false);
}

std::shared_ptr<grpc::Channel> Connect(const ClientOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(static_cast<int>(Limits().grpc_message_bytes));
  // a server that comes back is found within a second or two, not after minutes of waiting ever longer
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 200);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  auto channel = grpc::CreateCustomChannel(options.server, grpc::InsecureChannelCredentials(), arguments);
  static bool waited = false;
  if (!waited && IsOnLoopback(options.server)) {
    waited = true;
    (void)channel->WaitForConnected(std::chrono::system_clock::now() +
                                    kStart);  // the call says what is wrong
  }
  return channel;
}

int Fail(const grpc::Status& status, const ClientOptions& options) {
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE) {
    std::cerr << "docent: no server answers at " << options.server << " (" << status.error_message()
              << "); start one with `docent serve` or name it with --server\n";
  } else if (status.error_code() == grpc::StatusCode::INTERNAL && status.error_message().empty()) {
    // how gRPC says that protobuf refused to write the message
    std::cerr
        << "docent: nothing was sent: what was given does not fit into a message; is all of it UTF-8?\n";
  } else {
    // Texts of several lines show documents, whose places are marked by columns.
    const std::string& message = status.error_message();
    const bool names_iris = message.find("<") != std::string::npos && message.find('\n') == std::string::npos;
    const bool whole = !names_iris || options.json || options.full;
    std::cerr << "docent: " << (whole ? message : ServerNames(options).InText(message)) << "\n";
  }
  return kExitBad;
}

int Fail(const absl::Status& status) {
  std::cerr << "docent: " << status.message() << "\n";
  return kExitBad;
}

void PrintOutcome(const v1::AssertReply& reply, const ClientOptions& options) {
  if (options.json) {
    std::cout << "{\"revision\":" << reply.offset() << ",\"added\":" << reply.added()
              << ",\"removed\":" << reply.removed() << ",\"inferred\":" << reply.inferred()
              << ",\"repeated\":" << (reply.repeated() ? "true" : "false") << "}\n";
    return PrintDiagnostics(reply.warnings());
  }
  PrintDiagnostics(reply.warnings());
  std::cout << reply.added() << " added, " << reply.removed() << " removed, " << reply.inferred()
            << " inferred, revision " << reply.offset() << (reply.repeated() ? " (told before)" : "") << "\n";
}

void AddBaseOption(CLI::App* command, std::string* base, bool standard_input) {
  const auto check = [](const std::string& text) {
    return IsValidTermIri(text) ? std::string() : absl::StrCat("\"", text, "\" is not an absolute IRI");
  };
  command
      ->add_option(
          "--base", *base,
          absl::StrCat("Base IRI of the RDF files: relative IRIs in them are relative to it. By default the "
                       "file's own IRI (file:///…)",
                       standard_input ? ", and none for standard input" : ""))
      ->type_name("IRI")
      ->check(CLI::Validator(check, "", "IRI"));
}

std::string MediaTypeOf(RdfFormat format) {
  switch (format) {
    case RdfFormat::kTurtle:
      return "text/turtle";
    case RdfFormat::kTriG:
      return "application/trig";
    case RdfFormat::kNTriples:
      return "application/n-triples";
    case RdfFormat::kNQuads:
      return "application/n-quads";
    case RdfFormat::kRdfXml:
      return "application/rdf+xml";
  }
  return "text/turtle";
}

void PauseToReconnect(bool first) {
  if (first) std::cerr << "docent: the connection was lost; trying again every second\n";
  std::this_thread::sleep_for(std::chrono::seconds(1));
}

void PrintJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  // It fails for Any and the like of unknown types alone, which the API does not have.
  (void)google::protobuf::util::MessageToJsonString(message, &json, options);
  std::cout << PrintableJson(json) << std::endl;
}

void PrintDiagnostics(const google::protobuf::RepeatedPtrField<v1::Diagnostic>& diagnostics) {
  for (const v1::Diagnostic& d : diagnostics) {
    if (!d.file().empty()) std::cerr << d.file() << ":" << d.line() << ":" << d.column() << ": ";
    std::cerr << (d.warning() ? "warning: " : "error: ") << d.message() << "\n";
    if (!d.hint().empty()) std::cerr << "  hint: " << d.hint() << "\n";
  }
}

std::string ToNTriples(const v1::Term& term) {
  return ToNTriples(FromProto(term).value_or(Term::Literal("")));
}
}  // namespace docent::server
