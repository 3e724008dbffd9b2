// docent watch 'SELECT …' 'ASK …': the answers of queries, and then what changes of them.
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/command_line/usage_error.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {
namespace {

struct WatchArguments {
  ClientOptions client;
  std::vector<std::string> queries;
  std::vector<std::string> files;
  uint32_t min_interval_ms = 0;
  uint32_t at_least_ms = 0;
  uint64_t count = 0;
};

// A value of a row is cut to so many columns.
constexpr size_t kValueColumns = 120;

std::string RowText(const v1::CountedRow& row, const std::vector<std::string>& names,
                    const Presenter& presenter) {
  std::vector<std::string> cells;
  for (int i = 0; i < row.row().values_size(); ++i) {
    const v1::Term& value = row.row().values(i);
    if (value.kind_case() == v1::Term::KIND_NOT_SET) continue;
    cells.push_back(absl::StrCat("?", i < static_cast<int>(names.size()) ? names[i] : "", " = ",
                                 presenter.Cut(presenter.Of(value), kValueColumns)));
  }
  return absl::StrCat(absl::StrJoin(cells, ", "), row.count() > 1 ? absl::StrCat("  ×", row.count()) : "");
}

// A query with what is known of its answer.
struct Watched {
  v1::SubscribeRequest request;
  std::vector<std::string> names;
  std::string last_id;
  bool answered = false;
};

// `label`: which query, where there are several.
void Print(const v1::SubscribeReply& reply, const std::string& label, const Presenter& presenter,
           Watched* watched) {
  if (reply.reset()) {
    const bool again = std::exchange(watched->answered, true);
    watched->names.assign(reply.variables().begin(), reply.variables().end());
    std::cout << label << "revision " << reply.revision() << (again ? ", the whole answer again" : "")
              << "\n";
    if (!again && !reply.warning().empty()) std::cerr << label << "warning: " << reply.warning() << "\n";
  }
  const std::string when = reply.reset() ? "" : absl::StrCat("   revision ", reply.revision());
  if (reply.is_boolean()) std::cout << label << (reply.boolean() ? "yes" : "no") << when << "\n";
  const auto rows = [&](const char* sign, const auto& changed) {
    for (const v1::CountedRow& row : changed)
      std::cout << label << sign << RowText(row, watched->names, presenter) << when << "\n";
  };
  rows("+ ", reply.appeared());
  rows("- ", reply.disappeared());
  std::cout.flush();
}

absl::StatusOr<std::vector<Watched>> ReadQueries(const WatchArguments& arguments) {
  std::vector<std::string> texts = arguments.queries;
  for (const std::string& query : texts) {
    if (absl::Status status = CheckUtf8(query, ""); !status.ok()) return status;
  }
  for (const std::string& file : arguments.files) {
    auto text = ReadText(file, kQueryText);
    if (!text.ok()) return text.status();
    texts.push_back(*std::move(text));
  }
  if (texts.empty())
    return absl::InvalidArgumentError("no query given; pass it as an argument or with --file");
  std::vector<Watched> all(texts.size());
  for (size_t i = 0; i < texts.size(); ++i) {
    all[i].request.set_query(texts[i]);
    all[i].request.set_min_interval_ms(arguments.min_interval_ms);
    all[i].request.set_at_least_ms(arguments.at_least_ms);
  }
  return all;
}

// Those that the queries declare.
PrefixList PrefixesOf(const std::vector<Watched>& all) {
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  PrefixList prefixes;
  for (const Watched& watched : all) {
    const sparql::ParsedQuery parsed = sparql::ParseQuery(watched.request.query(), options);
    prefixes.insert(prefixes.end(), parsed.query.prefixes.begin(), parsed.query.prefixes.end());
  }
  return prefixes;
}

// Begins all, each under its place in the list, from 1, as its tag. False: not all of them could be sent.
bool BeginAll(const std::vector<Watched>& all,
              grpc::ClientReaderWriter<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>* stream) {
  for (size_t i = 0; i < all.size(); ++i) {
    v1::SubscribeStreamRequest begin;
    begin.set_tag(i + 1);
    *begin.mutable_begin() = all[i].request;
    if (!stream->Write(begin)) return false;
  }
  return stream->WritesDone();
}

int RunWatch(const WatchArguments& arguments) {
  absl::StatusOr<std::vector<Watched>> all = ReadQueries(arguments);
  if (!all.ok()) return Fail(all.status());
  const bool several = all->size() > 1;
  const Presenter presenter(arguments.client, PrefixesOf(*all));
  auto stub = v1::Context::NewStub(Connect(arguments.client));
  uint64_t changes = 0;
  bool answered = false, lost = false;
  while (true) {
    grpc::ClientContext context;
    auto stream = stub->SubscribeStream(&context);
    const bool begun = BeginAll(*all, stream.get());
    v1::SubscribeStreamReply reply;
    while (stream->Read(&reply)) {
      for (const v1::SubscribeStreamReply::Part& part : reply.parts()) {
        if (part.has_ended()) {
          const std::string which = several ? absl::StrCat("query ", part.tag(), ": ") : "";
          return Fail(grpc::Status(static_cast<grpc::StatusCode>(part.ended().code()),
                                   which + part.ended().message()),
                      arguments.client);
        }
        Watched& watched = (*all)[part.tag() - 1];
        if (part.reply().id() == watched.last_id) continue;  // it came before the connection was lost
        watched.last_id = part.reply().id();
        if (arguments.client.json) {
          several ? PrintJson(part) : PrintJson(part.reply());
        } else {
          Print(part.reply(), several ? absl::StrCat(part.tag(), "  ") : "", presenter, &watched);
        }
        answered = true;
        lost = false;
        if (!part.reply().resume().empty()) watched.request.set_resume(part.reply().resume());
        if (!part.reply().more() && arguments.count > 0 && ++changes >= arguments.count) return kExitOk;
      }
    }
    const grpc::Status status = stream->Finish();
    // a lost connection is taken up again, if there ever was one
    if (status.error_code() != grpc::StatusCode::UNAVAILABLE || !answered) {
      if (!status.ok()) return Fail(status, arguments.client);
      return begun ? kExitOk : Fail(absl::InternalError("not all queries could be sent"));
    }
    PauseToReconnect(!std::exchange(lost, true));
  }
}

}  // namespace

void AddWatchCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WatchArguments>();
  CLI::App* command =
      app->add_subcommand("watch", "Subscribe to queries: print their answers, then every change of them");
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("query", arguments->queries,
                      "SPARQL ASK or SELECT queries; prefixes that the server knows need no PREFIX. With "
                      "several, each line begins "
                      "with the number of its query");
  command->add_option("--file,-f", arguments->files, "Read a query from a file; - is standard input")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      ->add_option("--min-interval-ms", arguments->min_interval_ms,
                   "Least time between two changes; those in between are merged")
      ->type_name("MS");
  command
      ->add_option("--at-least-ms", arguments->at_least_ms,
                   "Report only what has held for this time without a break")
      ->type_name("MS");
  command->add_option("--count", arguments->count, "End after this number of answers, the first one included")
      ->check(AtLeast(1))
      ->type_name("N");
  command->footer(
      "Examples:\n"
      "  docent watch 'SELECT ?who ?where { ?who docent:isAt ?where }'\n"
      "  docent watch --at-least-ms 5000 'ASK { ?robot a docent:AvailableRobot }'");
  command->callback([arguments, exit_code] { *exit_code = RunWatch(*arguments); });
}

}  // namespace docent::server
