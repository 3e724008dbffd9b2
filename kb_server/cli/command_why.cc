// docent why: who told a fact, or which rules and facts it follows from. docent whynot: what is missing.
#include <iostream>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "graph/base/cut_text.h"
#include "graph/rdf/term.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/run_name.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {
namespace {

struct WhyArguments {
  ClientOptions client;
  std::vector<std::string> question;
  std::vector<std::string> prefixes;
  std::string run, node, as_of;
  uint32_t sets = 0;
  bool prov = false;
};

bool IsQuery(const std::string& text) {
  const std::string start = absl::AsciiStrToUpper(absl::StripLeadingAsciiWhitespace(text.substr(0, 200)));
  for (const char* word : {"ASK", "SELECT", "PREFIX", "BASE"}) {
    if (absl::StartsWith(start, word)) return true;
  }
  return false;
}

// The query, or the fact with both an empty query.
struct Question {
  std::string query;
  TermQuad fact;
};

absl::StatusOr<Question> Read(const WhyArguments& arguments, FactArguments& facts) {
  const std::vector<std::string>& words = arguments.question;
  Question question;
  if (words.size() == 2 && absl::EqualsIgnoreCase(words[0], "ask")) {
    question.query = IsQuery(words[1]) ? words[1] : absl::StrCat("ASK ", words[1]);
    return question;
  }
  if (words.size() != 1)
    return absl::InvalidArgumentError("ask about one fact ('S P O') or one query (ask 'ASK { … }')");
  if (IsQuery(words[0])) {
    question.query = words[0];
    return question;
  }
  auto quads = facts.Parse(words[0], "fact");
  if (!quads.ok()) return quads.status();
  if (quads->size() != 1) return absl::InvalidArgumentError("ask about one fact at a time");
  question.fact = (*quads)[0];
  return question;
}

std::string AskOf(const TermQuad& fact) {
  return absl::StrCat("ASK { ", ToNTriples(fact.subject), " ", ToNTriples(fact.predicate), " ",
                      ToNTriples(fact.object), " }");
}

void Print(const v1::ExplainReply& reply, const WhyArguments& arguments, const Presenter& presenter) {
  if (arguments.client.json) return PrintJson(reply);
  if (arguments.prov && !reply.prov().empty())
    PrintForPrograms(reply.prov());
  else
    std::cout << presenter.names().InText(reply.text());
  std::cerr << "revision " << reply.revision() << "\n";
}

// Of each node that opened: the facts that made it.
std::string OpenedBecause(const v1::Run& run, const std::string& only) {
  std::string text;
  for (const v1::Node& node : run.nodes()) {
    if (!only.empty() && node.name() != only) continue;
    if (node.fired_because().empty() && node.reason().empty()) continue;
    absl::StrAppend(&text, "  ", node.name(), " is ", node.state(),
                    node.reason().empty() ? "" : absl::StrCat(": ", OneLine(node.reason())), "\n");
    for (absl::string_view fact : absl::StrSplit(node.fired_because(), '\n', absl::SkipEmpty()))
      absl::StrAppend(&text, "    opened because ", fact, "\n");
  }
  return text;
}

// What a run waits for, or why it ended. `why`: also why its nodes opened.
int ExplainRun(const WhyArguments& arguments, bool why) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  v1::ExplainRunRequest request;
  request.set_run(arguments.run);
  request.set_node(arguments.node);
  request.set_as_of(arguments.as_of);
  v1::ExplainRunReply reply;
  grpc::ClientContext context;
  grpc::Status status = stub->Explain(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    PrintJson(reply);
    return kExitOk;
  }
  std::string text = reply.text();
  if (why && arguments.as_of.empty()) {
    v1::GetRunRequest get;
    get.set_run(arguments.run);
    v1::Run run;
    grpc::ClientContext of_get;
    status = stub->Get(&of_get, get, &run);
    if (!status.ok()) return Fail(status, arguments.client);
    absl::StrAppend(&text, OpenedBecause(run, arguments.node));
  }
  std::cout << Presenter(arguments.client).names().InText(text);
  return kExitOk;
}

int RunWhy(const WhyArguments& arguments, bool why) {
  if (!arguments.run.empty()) return ExplainRun(arguments, why);
  if (arguments.question.empty())
    return Fail(absl::InvalidArgumentError(
        "ask about a fact ('S P O'), a query (ask 'ASK { … }') or a run (--run ID)"));
  const IriNames known = ServerNames(arguments.client);
  FactArguments facts([&] { return known; });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  auto question = Read(arguments, facts);
  if (!question.ok()) return Fail(question.status());
  v1::ExplainRequest request;
  AddPrefixes(known, facts.given(), request.mutable_prefixes());
  request.set_full(arguments.client.full || arguments.client.json);
  request.set_sets(arguments.sets);
  request.set_as_of(arguments.as_of);
  if (!why) {
    request.set_why_not(question->query.empty() ? AskOf(question->fact) : question->query);
  } else if (!question->query.empty()) {
    request.set_why_ask(question->query);
  } else {
    google::protobuf::RepeatedPtrField<v1::Quad> quads;
    AddQuads({question->fact}, &quads);
    *request.mutable_why_fact() = quads[0];
  }
  v1::ExplainReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::Context::NewStub(Connect(arguments.client))->Explain(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  Print(reply, arguments, Presenter(arguments.client, facts.given(), known));
  const bool answered = why ? reply.holds() : !reply.holds() && reply.sets_size() > 0;
  return answered ? kExitOk : kExitNegative;
}

void AddCommon(CLI::App* command, WhyArguments* arguments) {
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  CLI::Option* question =
      command
          ->add_option("question", arguments->question,
                       "A fact in Turtle ('S P O'), or the word ask and a query ('ASK { … }')")
          ->expected(1, 2);
  CLI::Option* run =
      TakesRunName(command->add_option("--run", arguments->run,
                                       "Ask about a run: what it waits for, or why it ended so"))
          ->type_name("ID")
          ->excludes(question);
  command->add_option("--node", arguments->node, "Of the run only this node")->type_name("NAME")->needs(run);
  command
      ->add_option("--as-of", arguments->as_of,
                   "Ask about a past version of the graph: a revision number, or a time such as "
                   "2026-01-31T12:00:00Z. The rules are those of now")
      ->type_name("REVISION|TIME");
  AddPrefixOption(command, &arguments->prefixes);
}

}  // namespace

void AddWhyCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WhyArguments>();
  CLI::App* command = app->add_subcommand(
      "why", "Explain why a fact or an ASK holds: its rules and facts, down to who told what and when");
  AddCommon(command, arguments.get());
  command->add_flag("--prov", arguments->prov, "Print the proof as PROV-O in Turtle");
  command->footer(
      "Exit code 1: it does not hold.\n"
      "Examples:\n"
      "  docent why 'expo:John docent:isNear expo:R01'\n"
      "  docent why ask 'ASK { ?robot a docent:AvailableRobot }'\n"
      "  docent why --run BoothGuide-1");
  command->callback([arguments, exit_code] { *exit_code = RunWhy(*arguments, true); });
}

void AddWhyNotCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WhyArguments>();
  CLI::App* command = app->add_subcommand("whynot",
                                          "Explain why a fact or an ASK does not hold: the smallest sets of "
                                          "facts that are missing or in the way");
  AddCommon(command, arguments.get());
  command->add_option("--sets", arguments->sets, "Print at most this number of sets (default: 3)")
      ->type_name("N");
  command->footer(
      "Exit code 1: it holds, or no set was found.\n"
      "Examples:\n"
      "  docent whynot ask 'ASK { ?robot a docent:AvailableRobot }'\n"
      "  docent whynot --run BoothGuide-1 --node Move2User");
  command->callback([arguments, exit_code] { *exit_code = RunWhy(*arguments, false); });
}

}  // namespace docent::server
