#include "graph/sparql/run/federation.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/base/memory_part.h"
#include "graph/base/overload.h"
#include "graph/rdf/term_check.h"
#include "graph/sparql/syntax/algebra_memory.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::sparql {
namespace {

using Kind = Algebra::Kind;

bool IsService(const Algebra& a) {
  return a.kind == Kind::kService;
}

// UNKNOWN for an answer with what is no RDF term, RESOURCE_EXHAUSTED for a term over term_bytes. Blank node labels
// are of no grammar: they become labels of ours.
absl::Status CheckAnswer(const ServiceAnswer& answer) {
  for (size_t i = 0; i < answer.rows.size(); ++i) {
    const auto& row = answer.rows[i];
    for (size_t k = 0; k < row.size() && k < answer.variables.size(); ++k) {
      if (!row[k] || row[k]->IsBlank()) continue;
      const absl::Status status = CheckTerm(*row[k], Limits{}.term_bytes);
      if (status.ok()) continue;
      const std::string place = absl::StrCat("row ", i + 1, " of the answer, ?", answer.variables[k], ": ");
      return absl::IsResourceExhausted(status) ? WithMessage(status, absl::StrCat(place, status.message()))
                                               : absl::UnknownError(absl::StrCat(place, status.message()));
    }
  }
  return absl::OkStatus();
}

constexpr size_t kBytesOfLabel = 100;  // of a blank node, beside its text, in a table

class Resolver {
 public:
  Resolver(const Query& query, ServiceClient* client, const Dictionary& dictionary,
           const PrepareOptions& options, const RunOptions& run)
      : query_(query),
        client_(client),
        dictionary_(dictionary),
        options_(options),
        run_(run),
        own_(options.memory_bytes),
        use_(options.memory != nullptr ? options.memory : &own_) {}

  // `beside`: the patterns joined with `*a`, without SERVICE in them.
  absl::Status Resolve(AlgebraPtr* a, const std::vector<const Algebra*>& beside) {
    Algebra& node = **a;
    if (node.kind == Kind::kService) return Ask(a, beside);
    const bool joins = node.kind == Kind::kJoin || node.kind == Kind::kLeftJoin || node.kind == Kind::kMinus;
    std::vector<bool> asks;
    for (const AlgebraPtr& child : node.children) asks.push_back(AnyNode(*child, IsService));
    for (size_t i = 0; i < node.children.size(); ++i) {
      if (!asks[i]) continue;
      std::vector<const Algebra*> inner = beside;
      for (size_t k = 0; k < node.children.size() && joins; ++k) {
        const bool before = k < i || node.kind == Kind::kJoin;
        if (k != i && before && !asks[k]) inner.push_back(node.children[k].get());
      }
      if (absl::Status status = Resolve(&node.children[i], inner); !status.ok()) return status;
    }
    return ResolveExpressions(node);
  }

 private:
  // EXISTS { SERVICE … }
  absl::Status ResolveExpressions(Algebra& node) {
    absl::Status status;
    ForEachExpression(node, [&](Expression& e) {
      if (e.pattern && status.ok()) status = Resolve(&e.pattern, {});
    });
    return status;
  }

  absl::Status Ask(AlgebraPtr* a, const std::vector<const Algebra*>& beside) {
    const Algebra& service = **a;
    auto values = std::make_unique<Algebra>(Kind::kValues, service.span);
    const bool open = service.name.IsVariable();
    for (const Variable& v : InScopeVariables(*service.children[0])) {
      if (!v.IsHidden() && (!open || v != service.name.variable())) values->variables.push_back(v);
    }
    std::vector<std::string> endpoints;
    if (!open) {
      endpoints.push_back(service.name.term().lexical);
    } else {
      absl::StatusOr<std::vector<std::string>> found = EndpointsOf(service.name.variable(), beside);
      if (!found.ok()) return At(service, found.status());
      endpoints = *std::move(found);
    }
    const std::string text = TextOf(service, values->variables);
    if (open) values->variables.push_back(service.name.variable());
    for (const std::string& endpoint : endpoints) {
      absl::StatusOr<ServiceAnswer> answer = Select(endpoint, text, service.silent);
      if (answer.ok()) {
        const absl::Status added = AddRows(&*answer, open ? &endpoint : nullptr, values.get());
        use_->Release(answer->counted);
        if (!added.ok()) return At(service, added);
      } else if (service.silent && answer.status().code() != absl::StatusCode::kCancelled) {
        values->rows.emplace_back(values->variables.size());
        if (open) values->rows.back().back() = Term::Iri(endpoint);
      } else {
        return At(service, WithMessage(answer.status(), absl::StrCat("SERVICE <", endpoint,
                                                                     ">: ", answer.status().message())));
      }
    }
    *a = std::move(values);
    return absl::OkStatus();
  }

  absl::StatusOr<ServiceAnswer> Select(const std::string& endpoint, const std::string& text, bool silent) {
    if (client_ == nullptr) return absl::PermissionDeniedError("no other endpoint may be asked here");
    absl::StatusOr<ServiceAnswer> answer = client_->Select(endpoint, text, silent, run_.cancellation, use_);
    if (!answer.ok()) return answer;
    if (absl::Status status = CheckAnswer(*answer); !status.ok()) {
      use_->Release(answer->counted);
      return status;
    }
    return answer;
  }

  static absl::Status At(const Algebra& service, const absl::Status& status) {
    return WithMessage(status, absl::StrCat("line ", service.span.line, ", column ", service.span.column,
                                            ": ", status.message()));
  }

  // The pattern as a SELECT, without prefixes: the endpoint does not know ours.
  static std::string TextOf(const Algebra& service, const std::vector<Variable>& variables) {
    std::string head = "SELECT";
    for (const Variable& v : variables) head += " ?" + v.name;
    if (variables.empty()) head += " *";
    return head + " WHERE " + PrintPattern(*service.children[0]);
  }

  // While what does not fit is still counted.
  absl::Status TooMuch() const {
    return use_->Refusal(absl::ResourceExhaustedError(
        absl::StrCat("the answers of other endpoints are more than fit into the limit query_memory_bytes = ",
                     options_.memory_bytes)));
  }

  // Moves the answer's rows.
  absl::Status AddRows(ServiceAnswer* answer, const std::string* endpoint, Algebra* values) {
    ++answers_;
    absl::flat_hash_map<std::string, size_t> blanks;  // numbers of the labels of this answer
    MemoryPart labels(use_);
    std::vector<size_t> columns;
    for (const Variable& v : values->variables) {
      const auto it = std::find(answer->variables.begin(), answer->variables.end(), v.name);
      columns.push_back(static_cast<size_t>(it - answer->variables.begin()));
    }
    for (ServiceRow& given : answer->rows) {
      const size_t given_bytes = std::min(answer->counted, MemoryOf(given));
      ServiceRow row;
      row.reserve(columns.size());
      for (const size_t column : columns) {
        row.push_back(column < given.size() ? std::move(given[column]) : std::nullopt);
        std::optional<Term>& term = row.back();
        // Blank nodes of the endpoint differ from all of ours; their labels may be anything.
        if (!term || !term->IsBlank()) continue;
        const auto [label, is_new] = blanks.try_emplace(std::move(term->lexical), blanks.size());
        if (is_new && !labels.Add(label->first.size() + kBytesOfLabel)) return TooMuch();
        term->lexical = absl::StrCat("s", run_.seed, "a", answers_, "b", label->second);
      }
      if (endpoint != nullptr) row.back() = Term::Iri(*endpoint);
      given = ServiceRow();
      answer->counted -= given_bytes;
      use_->Release(given_bytes);
      if (!use_->Add(MemoryOf(row))) return TooMuch();
      values->rows.push_back(std::move(row));
    }
    return absl::OkStatus();
  }

  // The IRIs that the patterns joined with SERVICE ?x bind to ?x.
  absl::StatusOr<std::vector<std::string>> EndpointsOf(const Variable& variable,
                                                       const std::vector<const Algebra*>& beside) {
    Query query;
    query.from = query_.from;
    query.from_named = query_.from_named;
    query.with = query_.with;
    query.base_iri = query_.base_iri;
    query.projection = {variable};
    auto join = std::make_unique<Algebra>(Kind::kJoin);
    MemoryPart copies(use_);
    for (const Algebra* pattern : beside) {
      if (!copies.Add(MemoryBytes(*pattern))) {
        return use_->Refusal(absl::ResourceExhaustedError(
            absl::StrCat("the patterns beside SERVICE ?", variable.name,
                         " are more than fit into the limit query_memory_bytes = ", options_.memory_bytes)));
      }
      join->children.push_back(pattern->Clone());
    }
    const std::vector<Variable> bound = InScopeVariables(*join);
    if (std::find(bound.begin(), bound.end(), variable) == bound.end()) {
      return absl::InvalidArgumentError("SERVICE ?" + variable.name +
                                        ": nothing beside it says which endpoints are meant; bind ?" +
                                        variable.name);
    }
    AlgebraPtr pattern = join->children.size() == 1 ? std::move(join->children[0]) : std::move(join);
    query.algebra = std::make_unique<Algebra>(Kind::kDistinct);
    query.algebra->children.push_back(std::make_unique<Algebra>(Kind::kProject));
    query.algebra->children[0]->variables = {variable};
    query.algebra->children[0]->children.push_back(std::move(pattern));
    auto prepared = PreparedQuery::Prepare(std::move(query), dictionary_, options_);
    if (!prepared.ok()) return prepared.status();
    std::vector<std::string> endpoints;
    absl::Status status = (*prepared)->Select(run_, {}, [&](absl::Span<const TermId> row) {
      if (row[0].IsNone()) return true;
      const Term term = (*prepared)->Decode(row[0]);
      if (term.IsIri()) endpoints.push_back(term.lexical);
      return true;
    });
    if (!status.ok()) return status;
    return endpoints;
  }

  const Query& query_;
  ServiceClient* client_;
  const Dictionary& dictionary_;
  const PrepareOptions& options_;
  const RunOptions& run_;
  int answers_ = 0;
  MemoryUse own_;         // where the request has none
  MemoryUse* const use_;  // of all answers
};

}  // namespace

size_t MemoryOf(const ServiceRow& row) {
  size_t bytes = 2 * sizeof(row);  // in an array that grows
  for (const std::optional<Term>& term : row) bytes += sizeof(term) + (term ? TextMemory(*term) : 0);
  return bytes;
}

bool HasService(const Query& query) {
  return query.algebra && AnyNode(*query.algebra, IsService);
}

bool HasService(const Update& update) {
  return std::any_of(update.operations.begin(), update.operations.end(),
                     [](const UpdateOperation& o) { return o.where && AnyNode(*o.where, IsService); });
}

absl::Status ResolveServices(Query* query, ServiceClient* client, const Dictionary& dictionary,
                             const PrepareOptions& options, const RunOptions& run) {
  if (!HasService(*query)) return absl::OkStatus();
  return Resolver(*query, client, dictionary, options, run).Resolve(&query->algebra, {});
}

absl::Status ResolveServices(Update* update, ServiceClient* client, const Dictionary& dictionary,
                             const PrepareOptions& options, const RunOptions& run) {
  for (UpdateOperation& operation : update->operations) {
    if (!operation.where || !AnyNode(*operation.where, IsService)) continue;
    Query scope;
    scope.base_iri = update->base_iri;
    scope.from = operation.from;
    scope.from_named = operation.from_named;
    if (scope.from.empty() && scope.from_named.empty()) scope.with = operation.with;
    absl::Status status = Resolver(scope, client, dictionary, options, run).Resolve(&operation.where, {});
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace docent::sparql
