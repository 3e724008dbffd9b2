// Context.WhatIf: what a batch would do, told without doing it.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/what_if_port.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "reasoner/explain/display.h"

namespace docent::server {
namespace {

using explain::Display;

std::string BindingText(const std::vector<std::pair<std::string, Term>>& binding, const Display& display) {
  return absl::StrJoin(binding, ", ", [&](std::string* out, const auto& pair) {
    absl::StrAppend(out, "?", pair.first, " = ", display.Of(pair.second));
  });
}

std::string ToText(const WhatIfAnswer& answer, const Display& display) {
  std::string out;
  const auto facts = [&](const std::vector<TermQuad>& quads, const char* sign) {
    for (const TermQuad& quad : quads) {
      absl::StrAppend(&out, sign, " ", display.Fact(quad),
                      quad.graph.lexical == kInferredGraph ? "   (inferred)" : "", "\n");
    }
  };
  facts(answer.added, "+");
  facts(answer.removed, "-");
  for (const ConditionFlip& flip : answer.flips) {
    const std::string once = flip.lasting_us == 0
                                 ? ""
                                 : absl::StrCat(" once it has held for ",
                                                absl::FormatDuration(absl::Microseconds(flip.lasting_us)));
    if (flip.held != flip.holds)
      absl::StrAppend(&out, flip.place,
                      flip.holds ? absl::StrCat(" would open", once) : " would no longer hold", "\n");
    for (const auto& binding : flip.appeared)
      absl::StrAppend(&out, flip.place, ": new ", BindingText(binding, display), once, "\n");
    for (const auto& binding : flip.disappeared)
      absl::StrAppend(&out, flip.place, ": gone ", BindingText(binding, display), "\n");
  }
  for (const Transition& t : answer.transitions)
    absl::StrAppend(&out, t.subject, ": ", t.from.empty() ? "" : absl::StrCat(t.from, " → "), t.to, "\n");
  for (const std::string& command : answer.commands) absl::StrAppend(&out, "command ", command, "\n");
  if (out.empty()) out = "nothing would change\n";
  return out;
}

void Fill(const WhatIfAnswer& answer, const Display& display, v1::WhatIfReply* reply) {
  reply->set_revision(answer.revision.value());
  for (const TermQuad& quad : answer.added) ToProto(quad, reply->add_added());
  for (const TermQuad& quad : answer.removed) ToProto(quad, reply->add_removed());
  for (const ConditionFlip& flip : answer.flips) {
    v1::ConditionFlip* out = reply->add_flips();
    out->set_place(flip.place);
    out->set_ask(flip.ask);
    out->set_holds(flip.holds);
    out->set_lasting_us(flip.lasting_us);
    for (const auto& binding : flip.appeared) out->add_appeared(BindingText(binding, display));
    for (const auto& binding : flip.disappeared) out->add_disappeared(BindingText(binding, display));
  }
  for (const Transition& t : answer.transitions) {
    v1::WhatIfTransition* out = reply->add_transitions();
    out->set_subject(t.subject);
    out->set_from(t.from);
    out->set_to(t.to);
    out->set_cause(t.cause);
  }
  for (const std::string& command : answer.commands) reply->add_commands(command);
  reply->set_text(ToText(answer, display));
}

}  // namespace

grpc::ServerUnaryReactor* ContextService::WhatIf(grpc::CallbackServerContext* context,
                                                 const v1::WhatIfRequest* request, v1::WhatIfReply* reply) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const ClientPtr client = ClientOf(*context, ports_.clients);
  const auto work = [this, client, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    v1::AssertRequest told;
    *told.mutable_add() = request->add();
    *told.mutable_remove() = request->remove();
    told.set_source(request->source());
    auto batch = FromProto(told, ports_.limits);
    if (!batch.ok()) return reactor->Finish(ToGrpc(batch.status()));
    std::vector<std::pair<std::string, std::string>> prefixes;
    if (!request->full()) {
      prefixes.assign(request->prefixes().begin(), request->prefixes().end());
      for (auto& prefix : sparql::WellKnownPrefixes()) prefixes.push_back(std::move(prefix));
    }
    ports_.what_if->Ask(
        *std::move(batch), client, cancellation,
        [reactor, reply, display = Display(std::move(prefixes))](const absl::StatusOr<WhatIfAnswer>& answer) {
          if (answer.ok()) Fill(*answer, display, reply);
          reactor->Finish(ToGrpc(answer.status()));
        });
  };
  return OnWorker(ports_, context, cancellation, work);
}

}  // namespace docent::server
