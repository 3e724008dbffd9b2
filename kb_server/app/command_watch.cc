// docent watch 'SELECT …': the answer of a query, and then what changes of it.
#include <chrono>
#include <iostream>
#include <set>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "docent/v1/context.grpc.pb.h"
#include "kb_server/app/client.h"
#include "kb_server/app/commands.h"

namespace docent {
namespace {

struct WatchArguments {
  ClientOptions client;
  std::string query;
  std::string file;
  uint32_t min_interval_ms = 0;
  uint64_t count = 0;
};

constexpr auto kPause = std::chrono::seconds(1);  // before connecting again

std::string RowText(const v1::CountedRow& row, const std::vector<std::string>& names) {
  std::vector<std::string> cells;
  for (int i = 0; i < row.row().values_size(); ++i) {
    const v1::Term& value = row.row().values(i);
    if (value.kind_case() == v1::Term::KIND_NOT_SET) continue;
    cells.push_back(absl::StrCat("?", i < static_cast<int>(names.size()) ? names[i] : "", " = ",
                                 OneLine(ToDisplay(value), 120)));
  }
  return absl::StrCat(absl::StrJoin(cells, ", "), row.count() > 1 ? absl::StrCat("  ×", row.count()) : "");
}

void Print(const v1::SubscribeReply& reply, std::vector<std::string>* names, bool json) {
  if (json) {
    PrintJson(reply);
    return;
  }
  if (reply.reset()) {
    names->assign(reply.variables().begin(), reply.variables().end());
    std::cout << "revision " << reply.revision() << "\n";
  }
  const std::string when = reply.reset() ? "" : absl::StrCat("   revision ", reply.revision());
  if (reply.is_boolean()) std::cout << (reply.boolean() ? "yes" : "no") << when << "\n";
  for (const v1::CountedRow& row : reply.appeared()) std::cout << "+ " << RowText(row, *names) << when << "\n";
  for (const v1::CountedRow& row : reply.disappeared()) std::cout << "- " << RowText(row, *names) << when << "\n";
  std::cout.flush();
}

int RunWatch(const WatchArguments& arguments) {
  v1::SubscribeRequest request;
  request.set_query(arguments.query);
  if (!arguments.file.empty()) {
    auto text = ReadText(arguments.file);
    if (!text.ok()) return Fail(text.status());
    request.set_query(*text);
  }
  if (request.query().empty())
    return Fail(absl::InvalidArgumentError("no query given; pass it as an argument or with --file"));
  request.set_min_interval_ms(arguments.min_interval_ms);
  auto stub = v1::Context::NewStub(Connect(arguments.client));
  std::vector<std::string> names;
  std::string last_id;
  uint64_t changes = 0;
  while (true) {
    grpc::ClientContext context;
    auto reader = stub->Subscribe(&context, request);
    v1::SubscribeReply reply;
    while (reader->Read(&reply)) {
      if (reply.id() == last_id) continue;  // it came before the connection was lost
      last_id = reply.id();
      Print(reply, &names, arguments.client.json);
      if (!reply.resume().empty()) request.set_resume(reply.resume());
      if (!reply.more() && arguments.count > 0 && ++changes >= arguments.count) return kExitOk;
    }
    const grpc::Status status = reader->Finish();
    // a lost connection is taken up again, if there ever was one
    if (status.error_code() != grpc::StatusCode::UNAVAILABLE || request.resume().empty())
      return status.ok() ? kExitOk : Fail(status, arguments.client);
    std::cerr << "docent: the connection was lost; trying again\n";
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

void AddWatchCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WatchArguments>();
  CLI::App* command =
      app->add_subcommand("watch", "Follow an ASK or SELECT: first its answer, then each change of it");
  AddClientOptions(command, &arguments->client);
  command->add_option("query", arguments->query, "SPARQL ASK or SELECT; well-known prefixes need no PREFIX");
  command->add_option("--file,-f", arguments->file, "Read the query from a file, - for standard input");
  command->add_option("--min-interval-ms", arguments->min_interval_ms, "At most one change in this time; those between "
                                                                       "are added up");
  command->add_option("--count", arguments->count, "End after so many changes, the first answer included");
  command->callback([arguments, exit_code] { *exit_code = RunWatch(*arguments); });
}

}  // namespace docent
