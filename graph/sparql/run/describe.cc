#include "graph/sparql/run/describe.h"

#include <algorithm>
#include <string>

#include "absl/container/flat_hash_set.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"

namespace docent::sparql {
namespace {

// The resources to describe, each once, in order.
class Resources {
 public:
  // False: beyond the memory limit of the query.
  bool Add(TermId id, PreparedQuery& query) {
    if (!(id.IsIri() || id.IsBlank()) || !seen_.insert(id).second) return true;
    list_.push_back(id);
    return query.Charge(4 * sizeof(TermId));
  }
  bool empty() const { return next_ == list_.size(); }
  TermId Take() { return list_[next_++]; }

 private:
  std::vector<TermId> list_;
  size_t next_ = 0;
  absl::flat_hash_set<TermId> seen_;
};

// The graphs of the data set's default graph; empty with `all`: every graph.
std::vector<TermId> DefaultGraphs(const Query& query, const Dictionary& dictionary, DefaultGraph mode,
                                  bool* all) {
  std::vector<TermId> graphs;
  const bool is_explicit = !query.from.empty() || !query.from_named.empty();
  *all = !is_explicit && mode == DefaultGraph::kUnion;
  if (is_explicit) {
    for (const Term& graph : query.from) {
      if (const std::optional<TermId> id = dictionary.Find(graph)) graphs.push_back(*id);
    }
  } else if (const std::optional<TermId> id = dictionary.FindIri(kDefaultGraph)) {
    graphs.push_back(*id);
  }
  return graphs;
}

}  // namespace

absl::StatusOr<std::vector<TermQuad>> Describe(PreparedQuery& prepared, const Query& query,
                                               const Dictionary& dictionary, const PrepareOptions& options,
                                               const RunOptions& run) {
  Resources resources;
  std::vector<size_t> columns;
  for (const PatternTerm& target : query.describe) {
    if (!target.IsVariable()) continue;
    const auto& names = prepared.variables();
    const auto it = std::find(names.begin(), names.end(), target.variable().name);
    if (it != names.end()) columns.push_back(static_cast<size_t>(it - names.begin()));
  }
  bool any = false;
  const absl::Status status = prepared.Select(run, {}, [&](absl::Span<const TermId> row) {
    any = true;
    // For IRIs alone one solution is enough.
    return !columns.empty() && std::all_of(columns.begin(), columns.end(), [&](size_t column) {
      return resources.Add(row[column], prepared);
    });
  });
  if (!status.ok()) return status;
  for (const PatternTerm& target : query.describe) {
    if (target.IsVariable() || !any) continue;
    if (const std::optional<TermId> id = dictionary.Find(target.term())) resources.Add(*id, prepared);
  }

  bool all = false;
  const std::vector<TermId> graphs = DefaultGraphs(query, dictionary, options.default_graph, &all);
  std::vector<TermQuad> out;
  absl::Status stopped = prepared.status();
  while (!resources.empty() && stopped.ok()) {
    if (run.cancellation != nullptr) stopped = run.cancellation->Check();
    Quad last;
    run.version->ForEach({resources.Take(), {}, {}, {}}, [&](const Quad& quad) {
      if (run.cancellation != nullptr) stopped = run.cancellation->Check();
      if (!stopped.ok()) return false;
      if (!all && std::find(graphs.begin(), graphs.end(), quad.graph) == graphs.end()) return true;
      const bool copy = quad.predicate == last.predicate && quad.object == last.object;  // in another graph
      last = quad;
      if (copy) return true;
      if (quad.object.IsBlank()) resources.Add(quad.object, prepared);
      out.push_back({dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                     dictionary.Decode(quad.object), Term{}});
      if (!prepared.Charge(2 * (sizeof(TermQuad) + TextBytes(out.back())))) stopped = prepared.status();
      return stopped.ok();
    });
  }
  if (!stopped.ok()) return stopped;
  return out;
}

absl::StatusOr<std::vector<TermQuad>> AnswerGraph(PreparedQuery& prepared, const Query& query,
                                                  const Dictionary& dictionary, const PrepareOptions& options,
                                                  const RunOptions& run) {
  if (query.form == Query::Form::kDescribe) return Describe(prepared, query, dictionary, options, run);
  return prepared.Construct(run);
}

}  // namespace docent::sparql
