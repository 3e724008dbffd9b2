// A graph to reason over, written in short text: Add({"a p b", "a q 5", "a p b @g"}) in the namespace
// http://example.org/.
#ifndef DOCENT_TESTS_REASONER_TEST_WORLD_H_
#define DOCENT_TESTS_REASONER_TEST_WORLD_H_

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"

namespace docent {

inline constexpr std::string_view kExampleNs = "http://example.org/";

class TestWorld {
 public:
  TestWorld() : writer(std::make_shared<const GraphVersion>()) {}

  // "name" → an IRI, "5" and "0.5" → numbers, "5f" → an xsd:float, "'text" → a string, "a" as predicate →
  // rdf:type.
  Term TermOf(const std::string& word) const {
    if (word == "a") return Term::Iri(std::string(kRdfType));
    if (const size_t colon = word.find(':'); colon != std::string::npos) {  // "owl:sameAs"
      for (const auto& [prefix, iri] : kWellKnownPrefixes) {
        if (word.substr(0, colon) == prefix) return Term::Iri(std::string(iri) + word.substr(colon + 1));
      }
    }
    if (word[0] == '\'') return Term::Literal(word.substr(1));
    if (word.back() == 'f' && word.find_first_not_of("-.0123456789f") == std::string::npos) {
      return Term::Literal(word.substr(0, word.size() - 1), "http://www.w3.org/2001/XMLSchema#float");
    }
    if (word.find_first_not_of("-.0123456789") == std::string::npos) {
      return Term::Literal(word,
                           std::string(word.find('.') == std::string::npos ? kXsdInteger : kXsdDecimal));
    }
    return Term::Iri(Concat(kExampleNs, word));
  }
  TermId Id(const std::string& word) { return dictionary.Intern(TermOf(word)); }

  Quad QuadOf(const std::string& text) {
    const std::vector<std::string> words = absl::StrSplit(text, ' ');
    const TermId graph = words.size() > 3 ? Id(words[3].substr(1)) : dictionary.InternIri(kDefaultGraph);
    // "a" stands for rdf:type as predicate only.
    const auto node = [&](const std::string& w) {
      return w == "a" ? dictionary.InternIri("http://example.org/a") : Id(w);
    };
    return {node(words[0]), Id(words[1]), node(words[2]), graph};
  }

  Delta Apply(const std::vector<std::string>& add, const std::vector<std::string>& remove = {}) {
    std::vector<Quad> adds, removes;
    for (const std::string& text : add) adds.push_back(QuadOf(text));
    for (const std::string& text : remove) removes.push_back(QuadOf(text));
    return writer.Apply(adds, removes);
  }

  // The quads of docent:inferred as "s p o", sorted.
  std::vector<std::string> Inferred() const {
    std::vector<std::string> texts;
    const std::optional<TermId> graph = dictionary.FindIri(kInferredGraph);
    if (!graph) return texts;
    writer.current().ForEach({TermId(), TermId(), TermId(), *graph}, [&](const Quad& q) {
      texts.push_back(Text(q.subject) + " " + Text(q.predicate) + " " + Text(q.object));
      return true;
    });
    std::sort(texts.begin(), texts.end());
    return texts;
  }

  std::string Text(TermId id) const {
    const Term term = dictionary.Decode(id);
    if (term.IsIri() && term.lexical == kRdfType) return "a";
    if (term.IsIri() && term.lexical.starts_with(kExampleNs)) return term.lexical.substr(kExampleNs.size());
    if (term.IsLiteral() && term.datatype.ends_with("#float")) return term.lexical + "f";
    return term.IsLiteral() && term.datatype.empty() ? "'" + term.lexical : term.lexical;
  }

  // A query with the prefix : for the example namespace.
  sparql::Query Parse(const std::string& text) const {
    sparql::ParseOptions options;
    options.prefixes = sparql::WellKnownPrefixes();
    options.prefixes.emplace_back("", std::string(kExampleNs));
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    return std::move(parsed.query);
  }

  Dictionary dictionary;
  GraphWriter writer;
};

}  // namespace docent

#endif  // DOCENT_TESTS_REASONER_TEST_WORLD_H_
