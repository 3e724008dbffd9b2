// Context.Explain: why and why not, on the newest version or a past one, beside the writer.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/history_port.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/possible_changes.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/work/known_prefixes.h"
#include "reasoner/explain/display.h"
#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"

namespace docent::server {
namespace {

constexpr size_t kDefaultSets = 3;

void ToProto(const std::vector<std::pair<std::string, Term>>& bindings,
             google::protobuf::RepeatedPtrField<v1::NamedTerm>* out) {
  for (const auto& [name, value] : bindings) {
    v1::NamedTerm* binding = out->Add();
    binding->set_name(name);
    ToProto(value, binding->mutable_value());
  }
}

void ToProto(const explain::Proof& proof, v1::Proof* out) {
  for (const explain::ProofStep& step : proof.steps) {
    v1::ProofStep* s = out->add_steps();
    ToProto(step.fact, s->mutable_fact());
    for (const explain::Told& told : step.told) {
      v1::Telling* t = s->add_told();
      t->set_graph(told.graph.lexical);
      t->set_offset(told.offset);
      t->set_time_us(told.time_us);
      t->set_by(told.by);
    }
    s->set_rule(step.rule);
    ToProto(step.bindings, s->mutable_bindings());
    for (size_t premise : step.premises) s->add_premises(static_cast<uint32_t>(premise));
    for (const std::string& condition : step.conditions) s->add_conditions(condition);
    s->set_depth(static_cast<uint32_t>(step.depth));
  }
  for (size_t root : proof.roots) out->add_roots(static_cast<uint32_t>(root));
  ToProto(proof.bindings, out->mutable_bindings());
  for (const std::string& condition : proof.conditions) out->add_conditions(condition);
}

void ToProto(const explain::Repair& repair, const explain::Display& display, v1::MissingSet* out) {
  for (const explain::ToTell& tell : repair.tell) {
    out->add_missing(display.Fact(tell.fact));
    ToProto(tell.example, out->add_add());
  }
  for (const explain::InTheWay& way : repair.in_the_way) {
    out->add_in_the_way(display.Fact(way.fact));
    for (const TermQuad& quad : way.withdraw) ToProto(quad, out->add_remove());
  }
  for (const std::string& condition : repair.conditions) out->add_conditions(condition);
  for (const TermQuad& fact : repair.holds) ToProto(fact, out->add_holds());
  ToProto(repair.bindings, out->mutable_bindings());
}

absl::Status FillProof(const explain::Proof& proof, const explain::Prefixes& prefixes,
                       v1::ExplainReply* reply) {
  reply->set_holds(true);
  reply->set_whole(true);
  reply->set_text(explain::ToText(proof, prefixes));
  auto turtle = SerializeRdf(explain::ToProv(proof), RdfFormat::kTurtle, prefixes);
  if (!turtle.ok()) return turtle.status();
  reply->set_prov(*std::move(turtle));
  ToProto(proof, reply->mutable_proof());
  return absl::OkStatus();
}

// Those of the question, of the request, and the well-known ones: the first that has a name counts.
explain::Prefixes PrefixesOf(const v1::ExplainRequest& request, const sparql::Query* query) {
  explain::Prefixes prefixes;
  if (request.full()) return prefixes;
  const auto add = [&prefixes](const std::string& name, const std::string& iri) {
    const bool known = std::any_of(prefixes.begin(), prefixes.end(),
                                   [&name](const auto& prefix) { return prefix.first == name; });
    if (!known) prefixes.emplace_back(name, iri);
  };
  if (query != nullptr) {
    for (const auto& [name, iri] : query->prefixes) add(name, iri);
  }
  for (const auto& [name, iri] : request.prefixes()) add(name, iri);
  for (const auto& [name, iri] : sparql::WellKnownPrefixes()) add(name, iri);
  return prefixes;
}

absl::StatusOr<sparql::Query> ParseQuestion(const std::string& text, const v1::ExplainRequest& request,
                                            const ReadPorts& ports, MemoryUse* memory,
                                            Cancellation* cancellation) {
  const Limits& limits = ports.limits;
  if (text.size() > limits.query_text_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the question has ", text.size(), " bytes; the limit query_text_bytes is ", limits.query_text_bytes));
  }
  const auto known = KnownNames(ports);
  sparql::ParseOptions options = sparql::ParseOptionsWith(limits, ports.functions);
  options.known = known.get();
  options.memory = memory;
  options.cancellation = cancellation;
  for (const auto& [name, iri] : request.prefixes()) options.prefixes.emplace_back(name, iri);
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) return ToStatus(parsed, text);
  if (parsed.query.form != sparql::Query::Form::kAsk && parsed.query.form != sparql::Query::Form::kSelect)
    return absl::InvalidArgumentError("ask about an ASK or a SELECT query");
  return std::move(parsed.query);
}

absl::Status Answer(const ServicePorts& ports, const v1::ExplainRequest& request, Cancellation* cancellation,
                    v1::ExplainReply* reply) {
  const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports);
  std::optional<sparql::Query> query;
  TermQuad fact;
  if (request.question_case() == v1::ExplainRequest::kWhyFact) {
    auto given = FromProto(request.why_fact(), "why_fact", ports.limits);
    if (!given.ok()) return given.status();
    fact = *std::move(given);
  } else if (request.question_case() == v1::ExplainRequest::QUESTION_NOT_SET) {
    return absl::InvalidArgumentError("no question; give why_fact, why_ask or why_not");
  } else {
    const bool why = request.question_case() == v1::ExplainRequest::kWhyAsk;
    auto parsed = ParseQuestion(why ? request.why_ask() : request.why_not(), request, ports, memory.get(),
                                cancellation);
    if (!parsed.ok()) return parsed.status();
    query = *std::move(parsed);
  }
  const absl::StatusOr<QueryGraph> graph = GraphForQuery(ports, request.as_of(), cancellation);
  if (!graph.ok()) return graph.status();

  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  explain::Explainer::Settings settings;
  settings.version = graph->version;
  settings.dictionary = graph->dictionary.get();
  settings.rules = ports.catalog->Get()->rules;
  settings.functions = ports.functions;
  settings.history = ports.fact_history;
  settings.cancellation = cancellation;
  settings.now_us = TimeAsOf(request.as_of()).value_or(ports.clock->Now());
  settings.default_graph = ports.default_graph;
  settings.limits = ports.limits;
  settings.explain_limits = ports.explain_limits;
  settings.may_change = MayChangeOf(ports, *graph, cancellation);
  settings.prefixes = PrefixesOf(request, query ? &*query : nullptr);
  auto explainer = explain::Explainer::Make(settings);
  if (!explainer.ok()) return explainer.status();
  reply->set_revision(graph->version->revision().value());

  if (request.question_case() != v1::ExplainRequest::kWhyNot) {
    auto proof = query ? (*explainer)->WhyAsk(*query) : (*explainer)->WhyFact(fact);
    if (!proof.ok()) return proof.status();
    if (*proof) return FillProof(**proof, settings.prefixes, reply);
    reply->set_text(query ? "It does not hold; ask why not.\n" : "The fact is not there; ask why not.\n");
    return absl::OkStatus();
  }
  const size_t sets = request.sets() == 0 ? kDefaultSets : std::min<size_t>(request.sets(), 100);
  auto answer = (*explainer)->WhyNot(*query, sets);
  if (!answer.ok()) return answer.status();
  const explain::Display display(settings.prefixes);
  reply->set_holds(answer->holds);
  reply->set_text(explain::ToText(*answer, settings.prefixes));
  reply->set_more(answer->more);
  reply->set_whole(answer->whole);
  for (const explain::Repair& repair : answer->repairs) ToProto(repair, display, reply->add_sets());
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* ContextService::Explain(grpc::CallbackServerContext* context,
                                                  const v1::ExplainRequest* request,
                                                  v1::ExplainReply* reply) {
  int timeout_ms = ports_.limits.query_timeout_ms;
  if (request->timeout_ms() > 0) timeout_ms = std::min<int64_t>(timeout_ms, request->timeout_ms());
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(timeout_ms));
  // A past version is not followed.
  const auto trace = request->as_of().empty() ? TraceOf(*context, ports_.followed) : nullptr;
  const auto answer = [this, cancellation, request, reply, trace](grpc::ServerUnaryReactor* reactor) {
    reactor->Finish(
        ToGrpc(Traced(trace.get(), [&] { return Answer(ports_, *request, cancellation.get(), reply); })));
  };
  return OnWorker(ports_, context, cancellation, answer, Revision(request->min_revision()));
}

}  // namespace docent::server
