#include "graph/redland/buffered_store.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/hash/hash.h"

namespace docent::redland {
namespace {

constexpr QuadOperation::Kind kAdd = QuadOperation::Kind::kAdd;

}  // namespace

absl::StatusOr<bool> BufferedStore::InBase(const TermQuad& quad) {
  auto stream = base_.Find({quad.subject, quad.predicate, quad.object, quad.graph});
  if (!stream.ok()) return stream.status();
  TermQuad found;
  return (*stream)->Next(&found);
}

absl::StatusOr<std::unique_ptr<QuadStream>> BufferedStore::Find(const QuadQuery& query) {
  auto base = base_.Find(query);
  if (!base.ok() || changes_.empty()) return base;
  std::vector<TermQuad> quads;
  TermQuad quad;
  while ((*base)->Next(&quad)) {
    if (!changes_.contains(quad)) quads.push_back(quad);
  }
  for (const auto& [changed, kind] : changes_) {
    if (kind == kAdd && query.Matches(changed)) quads.push_back(changed);
  }
  SortByTriple(&quads);
  return StreamOf(std::move(quads));
}

absl::StatusOr<uint64_t> BufferedStore::Size() {
  auto size = base_.Size();
  if (!size.ok()) return size;
  for (const auto& [quad, kind] : changes_) {
    auto there = InBase(quad);
    if (!there.ok()) return there.status();
    if (kind == kAdd && !*there) ++*size;
    if (kind != kAdd && *there) --*size;
  }
  return size;
}

absl::StatusOr<std::vector<Term>> BufferedStore::Graphs() {
  auto graphs = base_.Graphs();
  if (!graphs.ok() || changes_.empty()) return graphs;
  std::set<Term> all(graphs->begin(), graphs->end()), touched;
  for (const auto& [quad, kind] : changes_) {
    if (kind == kAdd) {
      all.insert(quad.graph);
    } else {
      touched.insert(quad.graph);
    }
  }
  for (const Term& graph : touched) {  // may have lost its last quad
    auto stream = Find({std::nullopt, std::nullopt, std::nullopt, graph});
    if (!stream.ok()) return stream.status();
    TermQuad quad;
    if (!(*stream)->Next(&quad)) all.erase(graph);
  }
  return std::vector<Term>(all.begin(), all.end());
}

absl::Status BufferedStore::Apply(std::vector<QuadOperation> operations) {
  for (QuadOperation& operation : operations) {
    changes_.insert_or_assign(std::move(operation.quad), operation.kind);
  }
  return absl::OkStatus();
}

std::vector<QuadOperation> BufferedStore::Operations() const {
  std::vector<QuadOperation> operations;
  operations.reserve(changes_.size());
  for (const auto& [quad, kind] : changes_) operations.push_back({kind, quad});
  std::sort(operations.begin(), operations.end(), [](const QuadOperation& a, const QuadOperation& b) {
    return TripleOrder(a.quad, b.quad);  // an order that does not depend on the hash
  });
  return operations;
}

absl::Status BufferedStore::Commit() {
  std::vector<QuadOperation> operations = Operations();
  changes_.clear();
  return operations.empty() ? absl::OkStatus() : base_.Apply(std::move(operations));
}

}  // namespace docent::redland
