#include "graph/sparql/run/update_evaluator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "graph/store/batch_applier.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A graph store to which updates are applied as by the writer.
class Store {
 public:
  explicit Store(const std::string& trig = "") : graph_(trig), writer_(graph_.version) {}

  absl::StatusOr<UpdateEffect> Evaluate(const std::string& text) {
    ParseOptions parse;
    parse.prefixes = WellKnownPrefixes();
    parse.prefixes.emplace_back("ex", "http://example.org/");
    const ParsedUpdate parsed = ParseUpdate(text, parse);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    RunOptions run = graph_.Run();
    run.version = &writer_.current();
    run.seed = ++seed_;
    return EvaluateUpdate(parsed.update, graph_.dictionary, run, options);
  }

  absl::Status Update(const std::string& text) {
    absl::StatusOr<UpdateEffect> effect = Evaluate(text);
    if (!effect.ok()) return effect.status();
    BatchApplier applier(graph_.dictionary, Limits{});
    WriteBatch batch;
    batch.mode = WriteBatch::Mode::kLoad;
    batch.operations = std::move(effect->operations);
    absl::Status status = applier.Apply(batch, writer_).status();
    writer_.Freeze(Revision(++revision_));
    return status;
  }

  // "s p o g" with local names, sorted; the default graph is "-".
  std::vector<std::string> Quads() {
    const auto name = [this](TermId id) {
      const Term t = graph_.dictionary.Decode(id);
      if (t.lexical == kDefaultGraph) return std::string("-");
      if (t.IsBlank()) return std::string("_");
      return t.IsIri() ? t.lexical.substr(t.lexical.find_last_of("/#") + 1) : t.lexical;
    };
    std::vector<std::string> out;
    writer_.current().ForEach({}, [&](const Quad& q) {
      out.push_back(name(q.subject) + " " + name(q.predicate) + " " + name(q.object) + " " + name(q.graph));
      return true;
    });
    std::sort(out.begin(), out.end());
    return out;
  }

  UpdateOptions options;

 private:
  TestGraph graph_;
  GraphWriter writer_;
  uint64_t seed_ = 0, revision_ = 100;
};

TEST(Update, DataGoesToTheDefaultGraphOrTheOneNamed) {
  Store store;
  ASSERT_TRUE(store.Update("INSERT DATA { ex:a ex:p 1 . GRAPH ex:g { ex:a ex:p 2 } }").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 1 -", "a p 2 g"));
  ASSERT_TRUE(store.Update("DELETE DATA { ex:a ex:p 1, 7 . GRAPH ex:g { ex:a ex:p 1 } }").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 2 g"));
}

TEST(Update, AnOperationSeesWhatTheOnesBeforeItDid) {
  Store store("ex:a ex:p 1 .");
  ASSERT_TRUE(store
                  .Update("INSERT DATA { ex:b ex:p 2 . ex:b ex:name \"new\"@en } ;"
                          "INSERT { ?s ex:q ?o } WHERE { ?s ex:p ?o } ;"
                          "DELETE WHERE { ?s ex:p ?o } ;"
                          "INSERT { ?s ex:hello ?n } WHERE { ?s ex:name ?n FILTER(lang(?n) = 'en') }")
                  .ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a q 1 -", "b hello new -", "b name new -", "b q 2 -"));
}

TEST(Update, RemovalsComeBeforeInsertions) {
  Store store("ex:a ex:p 1 . ex:b ex:p 2 .");
  ASSERT_TRUE(
      store.Update("DELETE { ?s ex:p ?o } INSERT { ?s ex:p ?n } WHERE { ?s ex:p ?o BIND(?o + 1 AS ?n) }")
          .ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 2 -", "b p 3 -"));
}

TEST(Update, WithNamesTheGraphOfPatternAndTemplates) {
  Store store("ex:a ex:p 1 . GRAPH ex:g { ex:a ex:p 2 } GRAPH ex:h { ex:a ex:p 3 }");
  ASSERT_TRUE(store
                  .Update("WITH ex:g DELETE { ?s ex:p ?o } INSERT { ?s ex:q ?o, ?h } "
                          "WHERE { ?s ex:p ?o GRAPH ex:h { ?s ex:p ?h } }")
                  .ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 1 -", "a p 3 h", "a q 2 g", "a q 3 g"));
  ASSERT_TRUE(
      store.Update("WITH ex:none INSERT { ex:x ex:y ex:z } WHERE { FILTER NOT EXISTS { ?s ?p ?o } }").ok());
  EXPECT_THAT(store.Quads(), testing::Contains("x y z none"));
}

TEST(Update, WithCoversTheServersDefaultGraphInStrictMode) {
  Store store("ex:a ex:p 1 . GRAPH ex:g { ex:a ex:p 2 }");
  store.options.prepare.default_graph = DefaultGraph::kStrict;
  ASSERT_TRUE(store.Update("WITH ex:g INSERT { ?g ex:seen ?o } WHERE { GRAPH ?g { ?s ex:p ?o } }").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 1 -", "a p 2 g", "g seen 2 g"));
}

TEST(Update, UsingReplacesTheDataSet) {
  Store store("ex:a ex:p 1 . GRAPH ex:g { ex:a ex:p 2 } GRAPH ex:h { ex:a ex:p 3 }");
  ASSERT_TRUE(store.Update("WITH ex:g INSERT { ?s ex:q ?o } USING ex:h WHERE { ?s ex:p ?o }").ok());
  EXPECT_THAT(store.Quads(), testing::Contains("a q 3 g"));
  EXPECT_THAT(store.Quads(), SizeIs(4));
}

TEST(Update, AGraphThatIsNotThereSelectsNothing) {
  Store store("ex:a ex:p 1 . ex:g { ex:a ex:p 2 }");
  const std::vector<std::string> before = store.Quads();
  for (const char* const where :
       {"GRAPH ex:none { BIND(1 AS ?x) }", "GRAPH ex:none { VALUES ?x { 1 } }",
        "GRAPH ex:none { ex:n ex:p* ?x }", "GRAPH ex:none { SELECT (COUNT(*) AS ?x) { ?s ?p ?o } }",
        "VALUES ?g { ex:none } GRAPH ?g { BIND(1 AS ?x) }"}) {
    ASSERT_TRUE(store.Update(std::string("INSERT { ex:new ex:p ?x } WHERE { ") + where + " }").ok());
    ASSERT_TRUE(store
                    .Update(std::string("DELETE WHERE { ?s ?p ?o } ; INSERT DATA { ex:a ex:p 1 } ; DELETE { "
                                        "ex:a ex:p 1 } WHERE { ") +
                            where + " }")
                    .ok());
    EXPECT_EQ(store.Quads(), before) << where;
  }
  for (const char* const dataset :
       {"USING NAMED ex:none", "USING ex:g", "USING NAMED ex:other USING NAMED ex:none"}) {
    ASSERT_TRUE(store
                    .Update(std::string("INSERT { ex:new ex:p 1 } ") + dataset +
                            " WHERE { GRAPH ex:g { BIND(1 AS ?x) } }")
                    .ok());
    ASSERT_TRUE(store
                    .Update(std::string("INSERT { ex:new ex:p 1 } ") + dataset +
                            " WHERE { GRAPH ?g { BIND(1 AS ?x) } }")
                    .ok());
    EXPECT_EQ(store.Quads(), before) << dataset;
  }
  ASSERT_TRUE(
      store.Update("INSERT { ex:new ex:p ?x } USING NAMED ex:g WHERE { GRAPH ex:g { BIND(1 AS ?x) } }").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 1 -", "a p 2 g", "new p 1 -"));
}

TEST(Update, BlankNodesAreNewForEachSolutionAndEachUpdate) {
  Store store("ex:a ex:p 1 . ex:b ex:p 2 .");
  const std::string text =
      "INSERT { ?s ex:card _:c . _:c ex:of ?s ; ex:id ?n } WHERE { ?s ex:p ?o BIND(BNODE(\"x\") AS ?n) }";
  ASSERT_TRUE(store.Update(text).ok());
  EXPECT_THAT(store.Quads(), SizeIs(2 + 6));
  ASSERT_TRUE(store.Update(text).ok());
  EXPECT_THAT(store.Quads(), SizeIs(2 + 12));
  ASSERT_TRUE(store.Update("INSERT DATA { _:x ex:k 1 . _:x ex:l 1 } ; INSERT DATA { [] ex:k 1 }").ok());
  EXPECT_THAT(store.Quads(), SizeIs(2 + 12 + 3));
}

TEST(Update, WhatIsNoTripleIsLeftOut) {
  Store store("ex:a ex:p 1 .");
  ASSERT_TRUE(
      store
          .Update("INSERT { ?o ex:q ?s . ?s ?o ?s . ?s ex:q ?none . GRAPH ?o { ?s ex:q ?o } . ?s ex:r ?o } "
                  "WHERE { ?s ex:p ?o }")
          .ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 1 -", "a r 1 -"));
}

TEST(Update, GraphsAreClearedCopiedMovedAndAdded) {
  const std::string data = "ex:d ex:p 0 . GRAPH ex:g { ex:a ex:p 1 } GRAPH ex:h { ex:b ex:p 2 }";
  const auto after = [&data](const std::string& text) {
    Store store(data);
    EXPECT_TRUE(store.Update(text).ok()) << text;
    return store.Quads();
  };
  EXPECT_THAT(after("CLEAR DEFAULT"), ElementsAre("a p 1 g", "b p 2 h"));
  EXPECT_THAT(after("DROP NAMED"), ElementsAre("d p 0 -"));
  EXPECT_THAT(after("CLEAR ALL"), IsEmpty());
  EXPECT_THAT(after("DROP GRAPH ex:g ; CLEAR GRAPH ex:none"), ElementsAre("b p 2 h", "d p 0 -"));
  EXPECT_THAT(after("COPY ex:g TO ex:h"), ElementsAre("a p 1 g", "a p 1 h", "d p 0 -"));
  EXPECT_THAT(after("MOVE ex:g TO DEFAULT"), ElementsAre("a p 1 -", "b p 2 h"));
  EXPECT_THAT(after("ADD DEFAULT TO ex:h"), ElementsAre("a p 1 g", "b p 2 h", "d p 0 -", "d p 0 h"));
  EXPECT_THAT(after("COPY ex:g TO ex:g"), SizeIs(3));
  EXPECT_THAT(after("CREATE GRAPH ex:new ; CREATE SILENT GRAPH ex:g"), SizeIs(3));
}

TEST(Update, FactsOfRunsAndOperatorsAreTakenAwayAndNoneIsAdded) {
  for (const char* name : {"<urn:docent:run:Tour-1>", "<urn:docent:operator>"}) {
    const std::string graph = name;
    Store store("ex:d ex:p 0 . GRAPH ex:g { ex:a ex:p 1 } GRAPH " + graph + " { ex:b ex:p 2 }");
    const std::vector<std::string> texts = {
        "INSERT DATA { GRAPH " + graph + " { ex:x ex:p 1 } }",
        "COPY ex:g TO " + graph,
        "ADD DEFAULT TO " + graph,
        "MOVE ex:g TO " + graph,
        "WITH " + graph + " INSERT { ex:x ex:p 1 } WHERE {}",
        std::string("INSERT { GRAPH ?g { ex:x ex:p 1 } } WHERE { GRAPH ?g { ex:b ?p ?o } }")};
    for (const std::string& text : texts) {
      const absl::Status status = store.Update(text);
      EXPECT_FALSE(status.ok()) << text;
      EXPECT_THAT(std::string(status.message()),
                  AllOf(HasSubstr("only the server writes"), HasSubstr("another graph")));
      EXPECT_THAT(store.Quads(), SizeIs(3)) << text;
    }
    EXPECT_TRUE(store.Update("ADD " + graph + " TO ex:g").ok());
    EXPECT_TRUE(store.Update("DELETE DATA { GRAPH " + graph + " { ex:b ex:p 2 } }").ok());
    EXPECT_THAT(store.Quads(), SizeIs(3)) << graph;
  }
}

TEST(Update, WhatCannotBeDoneLeavesEverythingUnlessSilent) {
  Store store("GRAPH ex:g { ex:a ex:p 1 } GRAPH docent:inferred { ex:a ex:p 2 }");
  for (const char* text :
       {"INSERT DATA { ex:x ex:y 1 } ; CREATE GRAPH ex:g", "COPY ex:none TO ex:g",
        "CLEAR GRAPH docent:inferred", "LOAD <http://d/>", "DELETE WHERE { GRAPH ?g { ?s ?p ?o } }",
        "MOVE docent:inferred TO ex:g", "INSERT DATA { GRAPH docent:runs { ex:a ex:p 1 } }",
        "INSERT DATA { \"lit\" ex:p 1 }"}) {
    const absl::Status status = store.Update(text);
    EXPECT_FALSE(status.ok()) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr("line 1, column ")) << text;
    EXPECT_THAT(store.Quads(), SizeIs(2)) << text;
  }
  EXPECT_TRUE(
      store.Update("CREATE SILENT GRAPH ex:g ; COPY SILENT ex:none TO ex:g ; LOAD SILENT <http://d/>").ok());
  EXPECT_TRUE(
      store.Update("INSERT DATA { GRAPH <https://w3id.org/docent/ontology/m.ttl> { ex:a ex:p 1 } }").ok());
  EXPECT_TRUE(store.Update("CLEAR ALL").ok());
  EXPECT_THAT(store.Quads(), SizeIs(2)) << "a module of ontology goes by its name";
  EXPECT_TRUE(store.Update("CLEAR GRAPH <https://w3id.org/docent/ontology/m.ttl>").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("a p 2 inferred"));
  EXPECT_TRUE(store.Update("COPY docent:inferred TO ex:h").ok());
}

TEST(Update, LoadTakesTheDocumentsQuads) {
  Store store;
  store.options.load = [](const std::string& iri) -> absl::StatusOr<DocumentQuads> {
    if (iri != "http://d/") return absl::NotFoundError(iri + " is not there");
    return std::make_shared<const std::vector<TermQuad>>(std::vector<TermQuad>{
        {Term::Blank("b1"), Term::Iri("http://example.org/p"), Term::Blank("b1"), Term{}}});
  };
  ASSERT_TRUE(store.Update("LOAD <http://d/> INTO GRAPH ex:g ; LOAD <http://d/>").ok());
  EXPECT_THAT(store.Quads(), ElementsAre("_ p _ -", "_ p _ g"));
  EXPECT_THAT(std::string(store.Update("LOAD <http://e/>").message()), HasSubstr("http://e/ is not there"));
}

TEST(Update, ItSaysWhatItRead) {
  Store store("ex:a ex:p 1 .");
  const auto reads = [&store](const std::string& text) {
    auto effect = store.Evaluate(text);
    EXPECT_TRUE(effect.ok()) << effect.status();
    return effect->reads;
  };
  const Term p = Term::Iri("http://example.org/p"), g = Term::Iri("http://example.org/g");
  EXPECT_THAT(reads("INSERT DATA { ex:a ex:p 1 } ; DELETE DATA { ex:a ex:p 1 }"), IsEmpty());
  EXPECT_THAT(reads("DELETE { ?s ex:p ?o } WHERE { ?s ex:p ?o OPTIONAL { ?s ex:p ?o } }"),
              ElementsAre(ReadPattern{{}, p, {}, {}}));
  EXPECT_THAT(reads("INSERT { ?s ex:q 1 } WHERE { ?s ex:p* ex:b }"), ElementsAre(ReadPattern{}));
  EXPECT_THAT(reads("INSERT { ?g ex:q 1 } WHERE { GRAPH ?g { } }"), ElementsAre(ReadPattern{}));
  EXPECT_THAT(reads("CLEAR GRAPH ex:g"), ElementsAre(ReadPattern{{}, {}, {}, g}));
  EXPECT_THAT(reads("CLEAR ALL"), testing::Contains(ReadPattern{}));
}

TEST(Update, MoreThanTheMemoryLimitIsRefused) {
  Store store("ex:a ex:p 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 .");
  store.options.prepare.memory_bytes = 20000;
  const absl::Status status = store.Update(
      "INSERT { ?a ex:p ?b . ?b2 ex:q [] } WHERE { ?a ex:p ?x, ?y . BIND(IRI(CONCAT('http://x/', STR(?x), "
      "STR(?y))) AS ?b2) BIND(?b2 AS ?b) }");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("query_memory_bytes"));
}

// Not only after all solutions are known.
TEST(Update, IsRefusedAsSoonAsItIsTooMuch) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += "ex:s" + std::to_string(i) + " ex:p 1 .\n";
  Store store(text);
  int solutions = 0;
  FunctionRegistry functions;
  ASSERT_TRUE(functions
                  .Register("http://example.org/counted", 1, 1,
                            [&](absl::Span<const Term> a) -> absl::StatusOr<Term> {
                              ++solutions;
                              return a[0];
                            })
                  .ok());
  store.options.prepare.functions = &functions;
  store.options.prepare.memory_bytes = 100000;
  for (const char* change : {"INSERT { ?a ex:q ?b }", "DELETE { ?a ex:q ?b }"}) {
    solutions = 0;
    const std::string text =
        std::string(change) + " WHERE { ?a ex:p ?x . ?c ex:p ?y BIND(ex:counted(?c) AS ?b) }";
    EXPECT_EQ(store.Update(text).code(), absl::StatusCode::kResourceExhausted) << change;
    EXPECT_GT(solutions, 100) << change;
    EXPECT_LT(solutions, 1000) << change;
  }
}

}  // namespace
}  // namespace docent::sparql
