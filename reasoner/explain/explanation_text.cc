#include "reasoner/explain/explanation_text.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/display.h"

namespace docent::explain {
namespace {

// "now 0.1, 0.2": what the same subject has now.
std::string NowText(const ToTell& tell, const Display& display) {
  return absl::StrCat("now ", absl::StrJoin(tell.now, ", ", [&](std::string* text, const Term& term) {
                        absl::StrAppend(text, display.Of(term));
                      }));
}

std::string TimeText(TimeMicros time_us) {
  return absl::FormatTime("%Y-%m-%d %H:%M:%E*S UTC", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
}

std::string BindingsText(const std::vector<std::pair<std::string, Term>>& bindings, const Display& display) {
  return absl::StrJoin(bindings, ", ", [&](std::string* out, const auto& binding) {
    absl::StrAppend(out, "?", binding.first, " = ", display.Of(binding.second));
  });
}

constexpr size_t kDeepestIndent = 40;  // lines of deeper levels say their level

class ProofWriter {
 public:
  ProofWriter(const Proof& proof, const Display& display)
      : proof_(proof), display_(display), shown_(proof.steps.size(), false) {}

  // The step and all below it, depth first. Without recursion: a proof may be thousands of steps deep.
  void Write(size_t root) {
    std::vector<std::pair<size_t, size_t>> open = {{root, 0}};  // steps and their levels
    while (!open.empty()) {
      const auto [number, level] = open.back();
      open.pop_back();
      if (!WriteStep(number, level)) continue;
      const std::vector<size_t>& premises = proof_.steps[number].premises;
      for (auto premise = premises.rbegin(); premise != premises.rend(); ++premise)
        open.emplace_back(*premise, level + 1);
    }
  }

  // True if its premises follow.
  bool WriteStep(size_t number, size_t indent) {
    const ProofStep& step = proof_.steps[number];
    Line(indent, display_.Fact(step.fact));
    for (const Told& told : step.told) {
      const bool by_graph = !told.graph.lexical.empty();
      std::string line =
          by_graph ? absl::StrCat("told by ", display_.Of(told.graph)) : absl::StrCat("told ", told.by);
      if (told.graph.lexical == kRunsGraph) line = "told by the workflow engine";
      if (by_graph && !told.by.empty()) absl::StrAppend(&line, ", ", told.by);
      if (told.offset > 0) absl::StrAppend(&line, ", ", TimeText(told.time_us), ", log offset ", told.offset);
      Line(indent + 1, line);
    }
    if (!step.told.empty()) return false;
    if (step.rule.empty()) {
      Line(indent + 1, "inferred by a rule set that is not explained here");
      return false;
    }
    std::string line = absl::StrCat("by ", step.rule);
    if (!step.bindings.empty()) absl::StrAppend(&line, ", ", BindingsText(step.bindings, display_));
    Line(indent + 1, line);
    if (shown_[number]) {
      if (!step.premises.empty()) Line(indent + 1, "(shown above)");
      return false;
    }
    shown_[number] = true;
    for (const std::string& condition : step.conditions) Line(indent + 1, absl::StrCat("and ", condition));
    return true;
  }

  void Line(size_t level, const std::string& text) {
    absl::StrAppend(&out_, std::string(2 * std::min(level, kDeepestIndent), ' '),
                    level > kDeepestIndent ? absl::StrCat("(level ", level, ") ") : "", text, "\n");
  }
  std::string& out() { return out_; }

 private:
  const Proof& proof_;
  const Display& display_;
  std::vector<bool> shown_;
  std::string out_;
};

std::string Count(size_t count, const char* one, const char* many) {
  return absl::StrCat(count, " ", count == 1 ? one : many);
}

void WriteRepair(const Repair& repair, const Display& display, std::string* out) {
  std::vector<std::string> heads;
  if (!repair.tell.empty())
    heads.push_back(Count(repair.tell.size(), "fact is missing", "facts are missing"));
  if (!repair.in_the_way.empty())
    heads.push_back(Count(repair.in_the_way.size(), "fact is in the way", "facts are in the way"));
  absl::StrAppend(out, absl::StrJoin(heads, ", "));
  if (!repair.bindings.empty()) absl::StrAppend(out, " with ", BindingsText(repair.bindings, display));
  absl::StrAppend(out, "\n");
  for (const ToTell& tell : repair.tell) {
    absl::StrAppend(out, "  missing     ", display.Fact(tell.fact));
    if (!tell.graph.lexical.empty()) absl::StrAppend(out, " in graph ", display.Of(tell.graph));
    if (!tell.absence.empty()) absl::StrAppend(out, "   (for there to be no ", tell.absence, ")");
    if (!tell.now.empty()) absl::StrAppend(out, "   (", NowText(tell, display), ")");
    absl::StrAppend(out, "\n");
  }
  for (const std::string& condition : repair.conditions)
    absl::StrAppend(out, "  where       ", condition, "\n");
  for (const InTheWay& way : repair.in_the_way) {
    const std::string fact = display.Fact(way.fact);
    std::map<std::string, std::vector<std::string>> graphs;  // by triple
    for (const TermQuad& quad : way.withdraw) graphs[display.Fact(quad)].push_back(display.Of(quad.graph));
    const auto told_by = [&graphs, &display](const std::string& triple) {
      const std::vector<std::string>& names = graphs[triple];
      const bool plain =
          names.empty() || names == std::vector{display.Of(Term::Iri(std::string(kDefaultGraph)))};
      return plain ? "" : absl::StrCat("; told by ", absl::StrJoin(names, ", "));
    };
    absl::StrAppend(out, "  in the way  ", fact, "   (there must be no ", way.absence, told_by(fact), ")\n");
    for (const auto& [triple, names] : graphs) {
      if (triple != fact)
        absl::StrAppend(out, "  withdraw    ", triple, "   (it is inferred from this", told_by(triple),
                        ")\n");
    }
  }
  for (auto it = repair.inferred.rbegin(); it != repair.inferred.rend(); ++it)
    absl::StrAppend(out, "  then        ", display.Fact(it->second), "   by ", it->first, "\n");
  for (const TermQuad& fact : repair.holds) absl::StrAppend(out, "  holds       ", display.Fact(fact), "\n");
}

Term ProvIri(std::string_view local) {
  return Term::Iri(Concat(kProvNs, local));
}

}  // namespace

std::string ToText(const Proof& proof, const Prefixes& prefixes) {
  const Display display(prefixes);
  ProofWriter writer(proof, display);
  if (!proof.bindings.empty()) writer.Line(0, BindingsText(proof.bindings, display));
  for (const std::string& condition : proof.conditions) writer.Line(0, absl::StrCat("and ", condition));
  for (size_t root : proof.roots) writer.Write(root);
  return std::move(writer.out());
}

std::string ChangesText(const Repair& repair, const Prefixes& prefixes) {
  const Display display(prefixes);
  std::vector<std::string> facts;
  for (const ToTell& tell : repair.tell) facts.push_back(absl::StrCat(display.Fact(tell.fact), " ."));
  for (const InTheWay& way : repair.in_the_way)
    facts.push_back(absl::StrCat("not ", display.Fact(way.fact), " ."));
  return absl::StrJoin(facts, " ");
}

std::string RemarksText(const Repair& repair, const Prefixes& prefixes) {
  const Display display(prefixes);
  std::vector<std::string> remarks;
  for (const ToTell& tell : repair.tell) {
    if (!tell.now.empty()) remarks.push_back(NowText(tell, display));
  }
  for (const std::string& condition : repair.conditions) remarks.push_back(absl::StrCat("where ", condition));
  return absl::StrJoin(remarks, "; ");
}

std::string ToText(const WhyNotAnswer& answer, const Prefixes& prefixes) {
  if (answer.holds) return "It holds.\n";
  const Display display(prefixes);
  std::string out;
  if (answer.repairs.empty()) {
    out = "No set of facts was found that would make it true";
    if (!answer.failed_part.empty()) {
      absl::StrAppend(&out, ": nothing gives a solution of\n  ", answer.failed_part, "\n");
    } else {
      absl::StrAppend(&out, answer.whole ? "" : " within the limits of the search", ".\n");
    }
    if (answer.forbidden > 0)
      absl::StrAppend(&out, Count(answer.forbidden, "set is", "sets are"),
                      " left out: shapes, or what their properties may have, forbid it.\n");
    return out;
  }
  for (size_t i = 0; i < answer.repairs.size(); ++i) {
    if (i > 0) absl::StrAppend(&out, "or: ");
    WriteRepair(answer.repairs[i], display, &out);
  }
  if (answer.more > 0) absl::StrAppend(&out, "and ", answer.more, " more of this size\n");
  return out;
}

std::vector<TermQuad> ToProv(const Proof& proof) {
  std::vector<TermQuad> out;
  const Term type = Term::Iri(std::string(kRdfType));
  const auto add = [&out](Term s, Term p, Term o) {
    out.push_back({std::move(s), std::move(p), std::move(o), Term()});
  };
  const auto node = [](size_t number) { return Term::Blank(absl::StrCat("f", number)); };
  const auto rdf = [](std::string_view local) { return Term::Iri(Concat(kRdfNs, local)); };
  for (size_t i = 0; i < proof.steps.size(); ++i) {
    const ProofStep& step = proof.steps[i];
    add(node(i), type, ProvIri("Entity"));
    add(node(i), type, rdf("Statement"));
    add(node(i), rdf("subject"), step.fact.subject);
    add(node(i), rdf("predicate"), step.fact.predicate);
    add(node(i), rdf("object"), step.fact.object);
    for (const Told& told : step.told) {
      add(node(i), ProvIri("wasAttributedTo"), told.graph);
      if (told.offset == 0) continue;
      add(node(i), ProvIri("generatedAtTime"),
          Term::Literal(absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", absl::FromUnixMicros(told.time_us),
                                         absl::UTCTimeZone()),
                        std::string(kXsdDateTime)));
      add(node(i), Term::Iri(DocentIri("logOffset")), Term::Integer(static_cast<int64_t>(told.offset)));
    }
    if (step.rule.empty()) continue;
    const Term activity = Term::Blank(absl::StrCat("r", i));
    add(node(i), ProvIri("wasGeneratedBy"), activity);
    add(activity, type, ProvIri("Activity"));
    add(activity, Term::Iri(Concat(kRdfsNs, "label")), Term::Literal(step.rule));
    for (size_t premise : step.premises) {
      add(node(i), ProvIri("wasDerivedFrom"), node(premise));
      add(activity, ProvIri("used"), node(premise));
    }
  }
  return out;
}

}  // namespace docent::explain
