// Golden cases of tests/golden/explain: situations of the booth-guide hall (scenario 1) and their
// explanations.
//
// situation.ttl: facts in addition to the hall, world.ttl and the ontologies. question.txt: "why" or "whynot"
// in the first line, then the query. expected.txt: the text for people.
#include <gtest/gtest.h>

#include <filesystem>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"
#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"
#include "reasoner/rules/rule_engine.h"
#include "tests/golden/golden_file.h"

namespace docent {
namespace {

constexpr char kExpo[] = "https://w3id.org/docent/expo#";

class Hall {
 public:
  Hall() : writer_(std::make_shared<const GraphVersion>()), rules_(dictionary_) {
    const std::filesystem::path root(DOCENT_SOURCE_DIR);
    for (const auto& file : std::filesystem::directory_iterator(root / "ontology")) {
      if (file.path().extension() == ".ttl")
        Load(golden::ReadFile(file.path()), file.path().filename().string());
    }
    for (const char* name : {"hall.ttl", "world.ttl"})
      Load(golden::ReadFile(root / "scenarios/s01_booth_guide" / name), name);
    rule_text_ =
        std::make_shared<const std::string>(golden::ReadFile(root / "scenarios/s01_booth_guide/guide.rules"));
    EXPECT_FALSE(HasErrors(rules_.PutRules("guide.rules", *rule_text_)));
  }

  void Load(const std::string& text, const std::string& name) {
    ParseRdfOptions options;
    options.file = name;
    options.blank_node_scope = name + "_";
    const ParsedRdf parsed = ParseRdf(text, RdfFormat::kTurtle, options);
    ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    for (const TermQuad& quad : parsed.quads) {
      writer_.Add({dictionary_.Intern(quad.subject), dictionary_.Intern(quad.predicate),
                   dictionary_.Intern(quad.object), dictionary_.InternIri(kDefaultGraph)});
    }
  }

  std::unique_ptr<explain::Explainer> Explain(const explain::Prefixes& prefixes) {
    EXPECT_TRUE(rules_.Update(writer_, Delta()).ok());
    explain::Explainer::Settings settings;
    settings.version = writer_.Freeze(Revision(1));
    settings.dictionary = &dictionary_;
    settings.rules = {{"guide.rules", rule_text_}};
    settings.prefixes = prefixes;
    auto made = explain::Explainer::Make(settings);
    EXPECT_TRUE(made.ok()) << made.status();
    return *std::move(made);
  }

 private:
  Dictionary dictionary_;
  GraphWriter writer_;
  rules::RuleEngine rules_;
  std::shared_ptr<const std::string> rule_text_;
};

class ExplainGolden : public testing::TestWithParam<std::string> {};

TEST_P(ExplainGolden, SaysWhatAPersonWould) {
  const std::filesystem::path folder =
      std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/explain" / GetParam();
  Hall hall;
  hall.Load("@prefix docent: <https://w3id.org/docent#> . @prefix expo: <" + std::string(kExpo) + "> .\n" +
                golden::ReadFile(folder / "situation.ttl"),
            "situation.ttl");
  const std::string question = golden::ReadFile(folder / "question.txt");
  const size_t line = question.find('\n');
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  options.prefixes.emplace_back("expo", kExpo);
  const sparql::ParsedQuery parsed = sparql::ParseQuery(question.substr(line + 1), options);
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, question);
  auto explainer = hall.Explain(options.prefixes);
  std::string text;
  if (question.substr(0, line) == "why") {
    const auto proof = explainer->WhyAsk(parsed.query);
    ASSERT_TRUE(proof.ok()) << proof.status();
    text = proof->has_value() ? explain::ToText(**proof, options.prefixes) : "It does not hold.\n";
  } else {
    const auto answer = explainer->WhyNot(parsed.query, 3);
    ASSERT_TRUE(answer.ok()) << answer.status();
    text = explain::ToText(*answer, options.prefixes);
  }
  golden::Compare(folder, text);
}

INSTANTIATE_TEST_SUITE_P(Cases, ExplainGolden, testing::ValuesIn(golden::Cases("explain")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent
