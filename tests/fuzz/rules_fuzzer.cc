// Any bytes as a rule set: sound diagnostics; or rules with the same inferred facts whether the facts are
// asserted together, one by one, or with others that are withdrawn later. Withdrawing all facts leaves none.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

Limits SmallLimits() {
  Limits limits;
  limits.rule_rounds = 50;
  limits.inferred_per_turn = 2000;
  return limits;
}

// A dictionary, a graph and the rules over it.
struct World {
  Dictionary dictionary;
  GraphWriter writer{nullptr};
  rules::RuleEngine engine{dictionary, SmallLimits()};

  std::vector<Quad> Facts() {
    std::vector<Quad> facts;
    const TermId graph = dictionary.InternIri(kDefaultGraph);
    const auto iri = [this](const std::string& text) { return dictionary.InternIri(text); };
    for (int i = 0; i < 6; ++i) {
      const TermId node = iri("http://example.org/n" + std::to_string(i));
      facts.push_back({node, iri(std::string(kRdfType)), iri(DocentIri(i % 2 ? "Robot" : "Visitor")), graph});
      facts.push_back(
          {node, iri(DocentIri("isAt")), iri("http://example.org/n" + std::to_string(i * 2 % 6)), graph});
      facts.push_back({node, iri("http://example.org/p"), *InlineLiteral(Term::Integer(i)), graph});
    }
    const auto axiom = [&](const std::string& s, const std::string& p, const std::string& o) {
      facts.push_back({iri(s), iri(p), iri(o), graph});
    };
    const std::string rdfs(kRdfsNs), owl(kOwlNs), at = DocentIri("isAt"), p = "http://example.org/p";
    axiom(DocentIri("Visitor"), rdfs + "subClassOf", DocentIri("Agent"));
    axiom(at, rdfs + "subPropertyOf", "http://example.org/q");
    axiom(p, rdfs + "domain", DocentIri("Robot"));
    axiom(at, owl + "inverseOf", p);
    axiom(at, std::string(kRdfType), owl + "TransitiveProperty");
    axiom("http://example.org/n1", owl + "sameAs", "http://example.org/n4");
    return facts;
  }
  // False if refused: at a limit, or if axioms make negation depend on itself.
  bool Tell(const std::vector<Quad>& add, const std::vector<Quad>& remove) {
    const absl::Status status = engine.Update(writer, writer.Apply(add, remove)).status();
    const bool by_axioms =
        status.code() == absl::StatusCode::kFailedPrecondition &&
        std::string(status.message()).find("the batch was not applied") != std::string::npos;
    fuzz::Require(status.ok() || by_axioms || status.code() == absl::StatusCode::kResourceExhausted,
                  "an update that ends with " + status.ToString());
    if (!status.ok()) return false;
    engine.Commit();
    writer.Freeze(Revision(++revision));
    return true;
  }
  std::set<std::string> Inferred() {
    std::set<std::string> out;
    writer.current().ForEach({{}, {}, {}, dictionary.InternIri(kInferredGraph)}, [&](const Quad& quad) {
      out.insert(ToNTriples(dictionary.Decode(quad.subject)) + ToNTriples(dictionary.Decode(quad.predicate)) +
                 ToNTriples(dictionary.Decode(quad.object)));
      return true;
    });
    return out;
  }
  uint64_t revision = 0;
};

// False for rules that count, draw random values or create names: their results differ each time.
bool Repeats(std::string_view text) {
  std::string upper;
  for (const char c : text) upper += static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c);
  for (const char* word : {"RAND", "UUID", "NOW", "BNODE", "\\U"}) {
    if (upper.find(word) != std::string::npos) return false;
  }
  return true;
}

void CheckOne(std::string_view text) {
  World at_once;
  const Diagnostics diagnostics = at_once.engine.PutRules("f", text);
  fuzz::RequireSound(diagnostics, text);
  if (HasErrors(diagnostics)) {
    fuzz::Require(at_once.engine.rule_count() == 0, "rules of a text with mistakes");
    return;
  }
  const std::vector<Quad> facts = at_once.Facts();
  if (!at_once.Tell(facts, {})) return;
  at_once.writer.current().CheckInvariants();
  const std::set<std::string> all = at_once.Inferred();
  if (!Repeats(text)) return;
  World one_by_one;
  (void)one_by_one.engine.PutRules("f", text);
  for (const Quad& fact : one_by_one.Facts()) {
    if (!one_by_one.Tell({fact}, {})) return;
  }
  fuzz::Require(one_by_one.Inferred() == all, "other facts inferred one by one than at once");
  World half;
  (void)half.engine.PutRules("f", text);
  const std::vector<Quad> same = half.Facts();  // ids may differ
  std::vector<Quad> even, odd;
  for (size_t i = 0; i < same.size(); i += 2) even.push_back(same[i]);
  for (size_t i = 1; i < facts.size(); i += 2) odd.push_back(facts[i]);
  if (!half.Tell(even, {}) || !at_once.Tell({}, odd)) return;
  fuzz::Require(at_once.Inferred() == half.Inferred(),
                "other facts inferred where half of them were withdrawn");
  if (!at_once.Tell(odd, {})) return;
  fuzz::Require(at_once.Inferred() == all, "other facts inferred where half of them were told again");
  World nothing;
  (void)nothing.engine.PutRules("f", text);
  if (!nothing.Tell({}, {}) || !at_once.Tell({}, facts)) return;
  fuzz::Require(at_once.Inferred() == nothing.Inferred(), "facts stay inferred from nothing");
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
