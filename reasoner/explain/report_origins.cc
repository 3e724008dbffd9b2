#include "reasoner/explain/report_origins.h"

#include <algorithm>
#include <optional>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/inconsistency.h"
#include "reasoner/rules/rule_program.h"

namespace docent::explain {
namespace {

// The evidence triples of the report, as a graph.
GraphVersionPtr EvidenceOf(TermId report, const GraphVersion& version, Dictionary& dictionary) {
  const auto value = [&](TermId subject, const char* word) {
    const TermId predicate = dictionary.InternIri(Concat(kRdfNs, word));
    const QuadCursor found = version.Scan({subject, predicate, TermId(), TermId()});
    return found.Valid() ? found.quad().object : TermId();
  };
  GraphWriter writer(nullptr);
  version.ForEach(
      {report, dictionary.InternIri(DocentIri("evidence")), TermId(), TermId()}, [&](const Quad& named) {
        const Quad triple{value(named.object, "subject"), value(named.object, "predicate"),
                          value(named.object, "object"), named.graph};
        const bool whole = !triple.subject.IsNone() && !triple.predicate.IsNone() && !triple.object.IsNone();
        if (whole) writer.Add(triple);
        return true;
      });
  return writer.Freeze(Revision(1));
}

}  // namespace

ReportOrigins::ReportOrigins(const GraphVersion& version, Dictionary& dictionary, const RuleBase& rules,
                             const sparql::FunctionRegistry* functions, const sparql::RunOptions& run)
    : version_(version), dictionary_(dictionary), rules_(rules), functions_(functions), run_(run) {}
ReportOrigins::~ReportOrigins() = default;

// The report to which `subject` belongs.
std::optional<TermId> ReportOrigins::ReportOf(TermId subject) const {
  const auto type = dictionary_.FindIri(kRdfType),
             inconsistency = dictionary_.FindIri(DocentIri("Inconsistency"));
  if (!type || !inconsistency) return std::nullopt;
  const auto is_report = [&](TermId id) { return version_.Count({id, *type, *inconsistency, TermId()}) > 0; };
  if (is_report(subject)) return subject;
  for (const char* word : {"evidence", "binding"}) {
    const auto part = dictionary_.FindIri(DocentIri(word));
    if (!part) continue;
    for (QuadCursor c = version_.Scan({TermId(), *part, subject, TermId()}); c.Valid(); c.Next()) {
      if (is_report(c.quad().subject)) return c.quad().subject;
    }
  }
  return std::nullopt;
}

absl::StatusOr<std::vector<ReportOrigins::Origin>> ReportOrigins::Of(const Quad& fact) {
  std::vector<Origin> origins;
  const std::optional<TermId> report = ReportOf(fact.subject);
  if (!report) return origins;
  if (program_ == nullptr) {
    Diagnostics diagnostics;
    program_ = rules::RuleProgram::Build(rules_.sets(), dictionary_, functions_, diagnostics);
    if (program_ == nullptr) return ToStatus(diagnostics, "");
  }
  const GraphVersionPtr evidence = EvidenceOf(*report, version_, dictionary_);
  sparql::RunOptions on_evidence = run_;
  on_evidence.version = evidence.get();
  const TermId said_by = dictionary_.InternIri(DocentIri("rule"));
  rules::InconsistencyFacts reports(dictionary_);
  std::vector<rules::Triple> made;
  for (uint32_t r = 0; r < program_->rules.size(); ++r) {
    const rules::CompiledRule& rule = program_->rules[r];
    if (!rule.check) continue;
    const auto compare = [&](absl::Span<const TermId> row) {
      made.clear();
      reports.Make(rule, row, made);
      if (std::find(made.begin(), made.end(), rules::Triple{fact.subject, fact.predicate, fact.object}) !=
          made.end()) {
        Origin& origin = origins.emplace_back();
        origin.rule = r;
        for (size_t i = 0; i < row.size(); ++i)
          origin.values.emplace_back(rule.body->columns()[i].name, row[i]);
      }
      return std::any_of(
          made.begin(), made.end(), [&](const rules::Triple& t) {  // else the report is from another check
            return t.predicate == said_by && version_.Count({*report, said_by, t.object, TermId()}) > 0;
          });
    };
    const std::vector<TermId> open(rule.body->columns().size());
    // filters may read more than the evidence; the reported solution has passed them
    const absl::Status status =
        rule.body->flat()
            ? rule.body->EvaluateRest(on_evidence, open, 0, matching::Body::Filters::kNone, compare)
            : rule.body->Evaluate(run_, open, compare);
    if (!status.ok()) return status;
  }
  return origins;
}

}  // namespace docent::explain
