// Any bytes as a CAWL document: sound diagnostics, or conditions that are SPARQL.
#include <cstddef>
#include <cstdint>

#include "graph/sparql/syntax/parser.h"
#include "tests/fuzz/fuzz_check.h"
#include "workflow/cawl/check/check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace docent;
  std::string_view text(reinterpret_cast<const char*>(data), size);
  static const cawl::QuadEnvironment& environment = *[] {
    auto* out = new cawl::QuadEnvironment;
    out->AddOperation({"moveToUser", {"user"}, true});
    out->AddOperation({"moveToBooth", {"booth"}, true});
    out->AddOntology({{Term::Iri("https://w3id.org/docent#isAt"),
                       Term::Iri("http://www.w3.org/1999/02/22-rdf-syntax-ns#type"),
                       Term::Iri("http://www.w3.org/2002/07/owl#ObjectProperty"), Term()}});
    const auto fact = [out](const char* subject, const char* predicate, const char* object) {
      out->AddOntology({{Term::Iri(subject), Term::Iri(predicate), Term::Iri(object), Term()}});
    };
    fact("https://w3id.org/docent#Robot", "http://www.w3.org/2002/07/owl#disjointWith",
         "https://w3id.org/docent#Visitor");
    fact("https://w3id.org/docent#chose", "http://www.w3.org/2000/01/rdf-schema#domain",
         "https://w3id.org/docent#Visitor");
    fact("https://w3id.org/docent#localised", "http://www.w3.org/2000/01/rdf-schema#range",
         "http://www.w3.org/2001/XMLSchema#boolean");
    fact("https://w3id.org/docent#localised", "http://www.w3.org/1999/02/22-rdf-syntax-ns#type",
         "http://www.w3.org/2002/07/owl#DatatypeProperty");
    fact("https://example.org/guide#at", "http://www.w3.org/1999/02/22-rdf-syntax-ns#type",
         "http://www.w3.org/2002/07/owl#ObjectProperty");
    return out;
  }();
  cawl::CheckReport report = cawl::CheckDocument(text, "f", &environment);
  fuzz::RequireSound(report.diagnostics, text);
  fuzz::RequireSoundFixes(report.diagnostics, text);
  fuzz::Require(report.document != nullptr || HasErrors(report.diagnostics), "refused without a word");
  for (const cawl::ConditionText& condition : report.conditions) {
    if (condition.ask.starts_with("# cannot be compiled")) continue;
    sparql::ParsedQuery query = sparql::ParseQuery(condition.ask);
    fuzz::Require(query.ok(),
                  "not SPARQL: " + condition.ask + "\n" + Render(query.diagnostics, condition.ask));
  }
  return 0;
}
