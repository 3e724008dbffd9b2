// Runs one query with both engines on one graph version and makes the answers comparable: rows as text,
// numbers by value, sorted.
#ifndef DOCENT_TESTS_GRAPH_REDLAND_TWO_ENGINES_H_
#define DOCENT_TESTS_GRAPH_REDLAND_TWO_ENGINES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/redland/rasqal_engine.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"

namespace docent::redland {

class TwoEngines {
 public:
  explicit TwoEngines(const std::string& trig) {
    const ParsedRdf parsed = ParseRdf("PREFIX ex: <http://example.org/>\n" + trig, RdfFormat::kTriG);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, trig);
    GraphWriter writer(nullptr);
    for (const TermQuad& q : parsed.quads) {
      writer.Add(
          {dictionary_.Intern(q.subject), dictionary_.Intern(q.predicate), dictionary_.Intern(q.object),
           q.graph.lexical.empty() ? dictionary_.InternIri(kDefaultGraph) : dictionary_.Intern(q.graph)});
    }
    version_ = writer.Freeze(Revision(1));
  }

  sparql::Query Parse(const std::string& text) const {
    sparql::ParseOptions options;
    options.prefixes = sparql::WellKnownPrefixes();
    options.prefixes.emplace_back("ex", "http://example.org/");
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    return std::move(parsed.query);
  }

  // Both: the rows joined by " | ", "yes" or "no", triples; or the error's message.
  std::string Docent(const std::string& text) const {
    const sparql::Query query = Parse(text);
    auto prepared = sparql::PreparedQuery::Prepare(query, dictionary_);
    if (!prepared.ok()) return absl::StrCat("error: ", prepared.status().message());
    const sparql::RunOptions run = {version_.get(), nullptr, TimeMicros{1'700'000'000'000'000}, 7};
    std::vector<std::string> lines;
    if (query.form == sparql::Query::Form::kAsk) return *(*prepared)->Ask(run) ? "yes" : "no";
    if (query.form == sparql::Query::Form::kConstruct) {
      const auto triples = (*prepared)->Construct(run);
      for (const TermQuad& t : *triples) lines.push_back(Line(t));
      return Joined(std::move(lines));
    }
    EXPECT_TRUE((*prepared)
                    ->Select(run, {},
                             [&](absl::Span<const TermId> row) {
                               std::vector<std::optional<Term>> terms;
                               for (TermId id : row) {
                                 terms.push_back(id.IsNone() ? std::nullopt
                                                             : std::optional((*prepared)->Decode(id)));
                               }
                               lines.push_back(Line(terms));
                               return true;
                             })
                    .ok());
    return Joined(std::move(lines));
  }

  std::string Rasqal(const std::string& text) const {
    auto answer = RunRasqal(Parse(text), dictionary_, version_, nullptr);
    if (!answer.ok()) return absl::StrCat("error: ", answer.status().message());
    if (answer->form == sparql::Query::Form::kAsk) return answer->boolean ? "yes" : "no";
    std::vector<std::string> lines;
    for (const TermQuad& t : answer->triples) lines.push_back(Line(t));
    for (const auto& row : answer->rows) lines.push_back(Line(row));
    return Joined(std::move(lines));
  }

  const Dictionary& dictionary() const { return dictionary_; }
  const GraphVersionPtr& version() const { return version_; }

 private:
  // A number by its value, whatever its type and lexical form.
  static std::string Show(const Term& term) {
    const std::string ex = "http://example.org/";
    if (term.IsIri() && term.lexical.starts_with(ex)) return term.lexical.substr(ex.size());
    double value = 0;
    const bool number = term.datatype == kXsdInteger || term.datatype == kXsdDecimal ||
                        term.datatype == kXsdDouble || term.datatype == kXsdFloat;
    if (number && absl::SimpleAtod(term.lexical, &value)) return absl::StrCat(value);
    return ToNTriples(term);
  }
  static std::string Line(const TermQuad& t) {
    return absl::StrCat(Show(t.subject), " ", Show(t.predicate), " ", Show(t.object));
  }
  static std::string Line(const std::vector<std::optional<Term>>& row) {
    return absl::StrJoin(row, " ", [](std::string* out, const std::optional<Term>& term) {
      absl::StrAppend(out, term ? Show(*term) : "-");
    });
  }
  static std::string Joined(std::vector<std::string> lines) {
    std::sort(lines.begin(), lines.end());
    return absl::StrJoin(lines, " | ");
  }

  Dictionary dictionary_;
  GraphVersionPtr version_;
};

}  // namespace docent::redland

#endif  // DOCENT_TESTS_GRAPH_REDLAND_TWO_ENGINES_H_
