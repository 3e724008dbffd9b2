#include "kb_server/http/http_query.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/sparql/results/results.h"
#include "kb_server/http/http_formats.h"
#include "kb_server/http/long_answer.h"
#include "kb_server/work/query_runner.h"

namespace docent::server {
namespace {

using Form = sparql::Query::Form;

// Writes the answer in the format that the client accepts.
class HttpSink final : public QuerySink {
 public:
  HttpSink(std::shared_ptr<HttpExchange> exchange, Cancellation* cancellation)
      : exchange_(std::move(exchange)),
        accept_(exchange_->request().Header("accept")),
        cancellation_(cancellation) {}

  bool OnBegin(Form form, Revision revision) override {
    revision_ = revision;
    if (form == Form::kSelect || form == Form::kAsk) {
      row_type_ = ChooseRowType(accept_);
      if (row_type_ == nullptr) Respond(NoRowType());
      return row_type_ != nullptr;
    }
    const bool accepted = ChooseGraphType(accept_) != nullptr;
    if (!accepted) Respond(NoGraphType());
    return accepted;
  }

  void OnPlan(std::string plan) override { Respond(Head("text/plain; charset=utf-8", std::move(plan))); }

  void OnBoolean(bool answer) override {
    Respond(Head(row_type_->told, sparql::WriteBoolean(answer, row_type_->format)));
  }

  void OnHeader(const std::vector<std::string>& variables) override {
    answer_.emplace(Head(row_type_->told), exchange_.get());
    writer_ = sparql::ResultWriter::Make(row_type_->format, &rows_);
    writer_->Begin(variables);
  }

  absl::Status OnRow(const std::vector<std::optional<Term>>& row) override {
    writer_->Row(row);
    if (rows_.size() < LongAnswer::kPieceBytes || answer_->Send(&rows_)) return absl::OkStatus();
    return absl::CancelledError("the client went away");
  }

  void OnEnd() override {
    writer_->End();
    answer_->End(std::move(rows_));
  }

  absl::Status OnGraph(std::vector<TermQuad> triples,
                       const std::vector<std::pair<std::string, std::string>>& prefixes) override {
    GraphText text = WriteGraph(std::move(triples), accept_, prefixes);
    if (text.refusal) {
      Respond(*std::move(text.refusal));
      return absl::OkStatus();
    }
    return LongAnswer(Head(text.told), exchange_.get()).SendAll(std::move(text.text), cancellation_);
  }

  // The answer is this error, as far as that can still be said.
  void OnError(const absl::Status& error) {
    if (exchange_->begun()) return exchange_->Abort();
    Respond(ErrorResponse(error));
  }

  // The HTTP status that the answer has.
  int status() const { return status_; }

 private:
  HttpResponse Head(std::string_view content_type, std::string body = "") const {
    HttpResponse response;
    response.content_type = content_type;
    response.body = std::move(body);
    response.headers = {{"Docent-Revision", absl::StrCat(revision_.value())},
                        {"Cache-Control", "no-cache"},
                        {"Vary", "Accept"}};
    return response;
  }

  void Respond(HttpResponse response) {
    status_ = response.status;
    exchange_->Respond(std::move(response));
  }

  const std::shared_ptr<HttpExchange> exchange_;
  const std::string accept_;
  Cancellation* const cancellation_;
  Revision revision_;
  int status_ = 200;
  // Of rows.
  const RowType* row_type_ = nullptr;
  std::optional<LongAnswer> answer_;
  std::string rows_;
  std::unique_ptr<sparql::ResultWriter> writer_;
};

}  // namespace

int AnswerQuery(const ReadPorts& ports, const SparqlRequest& request, std::shared_ptr<HttpExchange> exchange,
                Cancellation* cancellation) {
  QueryRequest query;
  query.text = request.text;
  query.base_iri = request.base_iri;
  query.default_graphs = request.default_graphs;
  query.named_graphs = request.named_graphs;
  query.as_of = request.as_of;
  HttpSink sink(std::move(exchange), cancellation);
  const absl::Status status = QueryRunner(&ports).Run(query, cancellation, &sink);
  if (!status.ok()) sink.OnError(status);
  return sink.status();
}

}  // namespace docent::server
