#include "graph/redland/storage.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "graph/redland/buffered_store.h"
#include "tests/graph/redland/test_model.h"

namespace docent::redland {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(StorageTest, ContextsAreNamedGraphsAndTheDefaultGraphIsNone) {
  TestModel model;
  EXPECT_EQ(model.Add("a", "p", "b"), 0);
  EXPECT_EQ(model.Add("a", "p", "b", "g1"), 0);
  EXPECT_EQ(model.Add("a", "p", "c", "g2"), 0);
  EXPECT_EQ(model.Add("a", "p", "b"), 0) << "a set";
  EXPECT_EQ(model.Size(), 3);
  EXPECT_THAT(model.All(), ElementsAre("a p b -", "a p b g1", "a p c g2"));
  EXPECT_THAT(model.Contexts(), ElementsAre("g1", "g2"));
  EXPECT_THAT(model.InContext("g1"), ElementsAre("a p b g1"));
  EXPECT_THAT(model.Find("a", "-", "-", "g2"), ElementsAre("a p c g2"));
  EXPECT_THAT(model.Find("a", "p", "b"), ElementsAre("a p b -", "a p b g1"));
  EXPECT_THAT(model.Find("x", "p", "-"), IsEmpty());

  const NodePtr name = ToNode(model.world(), Term::Iri(std::string(kDefaultGraph)));
  EXPECT_THAT(model.Lines(librdf_model_context_as_stream(model.model(), name.get())), ElementsAre("a p b -"))
      << "its IRI names the default graph as well";
}

TEST(StorageTest, SaysThatItHasContexts) {
  TestModel model;
  const UriPtr feature(
      librdf_new_uri(model.world(), reinterpret_cast<const unsigned char*>(LIBRDF_MODEL_FEATURE_CONTEXTS)));
  const NodePtr value(librdf_model_get_feature(model.model(), feature.get()));
  ASSERT_TRUE(value);
  EXPECT_EQ(FromNode(value.get())->lexical, "1");
  EXPECT_EQ(librdf_model_sync(model.model()), 0);
}

TEST(StorageTest, MergedGivesEachStatementOnceButSerialisesAll) {
  TestModel model(/*merged=*/true);
  model.Add("a", "p", "b", "g1");
  model.Add("a", "p", "b", "g2");
  model.Add("a", "p", "c", "g2");
  EXPECT_EQ(model.Find("-", "-", "-").size(), 2u);
  EXPECT_EQ(model.Find("-", "-", "b").size(), 1u);
  EXPECT_EQ(model.Find("a", "p", "b", "g2").size(), 1u);
  EXPECT_EQ(model.All().size(), 3u);
}

TEST(StorageTest, NodesAreFoundByArcs) {
  TestModel model;
  model.Add("a", "p", "b");
  model.Add("a", "q", "'text");
  model.Add("_x", "p", "b", "g");
  librdf_model* m = model.model();
  const NodePtr a = model.Node("a"), p = model.Node("p"), q = model.Node("q"), b = model.Node("b"),
                text = model.Node("'text");
  EXPECT_THAT(model.Nodes(librdf_model_get_sources(m, p.get(), b.get())), ElementsAre("_x", "a"));
  EXPECT_THAT(model.Nodes(librdf_model_get_targets(m, a.get(), q.get())), ElementsAre("'text"));
  EXPECT_THAT(model.Nodes(librdf_model_get_arcs(m, a.get(), text.get())), ElementsAre("q"));
  EXPECT_THAT(model.Nodes(librdf_model_get_arcs_out(m, a.get())), ElementsAre("p", "q"));
  EXPECT_THAT(model.Nodes(librdf_model_get_arcs_in(m, b.get())), ElementsAre("p", "p"));
  EXPECT_TRUE(librdf_model_has_arc_in(m, b.get(), p.get()));
  EXPECT_FALSE(librdf_model_has_arc_out(m, b.get(), p.get()));
}

TEST(StorageTest, TermsComeBackAsTheyWent) {
  TestModel model;
  const std::vector<Term> objects = {Term::Literal("a\"b\\c\n\u00e9\U0001F600"),
                                     Term::LangString("hallo", "de-at"),
                                     Term::Literal("1.50", std::string(kXsdDecimal)),
                                     Term::Literal("x", "http://example.org/type"),
                                     Term::Blank("b1"),
                                     Term::Literal(""),
                                     Term::Literal("99999999999999999999", std::string(kXsdInteger))};
  for (const Term& object : objects) {
    const StatementPtr statement = ToStatement(model.world(), {Ex("a"), Ex("p"), object, Ex("g")});
    ASSERT_EQ(librdf_model_add_statement(model.model(), statement.get()), 0);
    EXPECT_TRUE(librdf_model_contains_statement(model.model(), statement.get())) << ToNTriples(object);
    EXPECT_EQ(FromNode(librdf_statement_get_object(statement.get())), object);
  }
  EXPECT_EQ(model.Size(), static_cast<int>(objects.size()));
  for (const std::string& line : model.All()) EXPECT_THAT(line, HasSubstr("a p "));
}

TEST(StorageTest, RemovesWhatIsMeantOrSaysWhereItIs) {
  TestModel model;
  model.Add("a", "p", "b");
  model.Add("a", "p", "b", "g1");
  EXPECT_EQ(model.Remove("a", "p", "b"), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p b g1"));
  EXPECT_NE(model.Remove("a", "p", "b"), 0) << "it can still be seen";
  EXPECT_THAT(model.errors(), Contains(HasSubstr("<http://example.org/g1>")));
  EXPECT_NE(
      librdf_model_context_remove_statement(model.model(), nullptr, model.Statement("a", "p", "b").get()), 0)
      << "no context is the same, whichever function is called";
  EXPECT_EQ(model.Remove("a", "p", "b", "g1"), 0);
  EXPECT_FALSE(model.Contains("a", "p", "b"));
  EXPECT_EQ(model.Remove("a", "p", "b"), 0) << "what is not there needs no removing";

  model.Add("a", "p", "b", "g1");
  model.Add("a", "p", "c", "g1");
  model.Add("a", "p", "c", "g2");
  EXPECT_EQ(librdf_model_context_remove_statements(model.model(), model.Node("g1").get()), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p c g2"));
}

TEST(StorageTest, AStreamIsAddedWholeOrNotAtAll) {
  TestModel source, model;
  source.Add("a", "p", "b");
  source.Add("a", "p", "c", "g");
  source.Add("a", "p", "b", "g");
  StreamPtr stream(librdf_model_as_stream(source.model()));
  EXPECT_EQ(librdf_model_context_add_statements(model.model(), model.Node("h").get(), stream.get()), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p b h", "a p c h"));

  // A store refuses relative IRIs.
  const StatementPtr bad = ToStatement(source.world(), {Ex("a"), Ex("p"), Term::Iri("relative"), Ex("g")});
  Dictionary dictionary;
  VersionStore empty(&dictionary, std::make_shared<const GraphVersion>());
  TestModel anything(std::make_unique<BufferedStore>(&empty));  // checks nothing
  ASSERT_EQ(librdf_model_add_statement(anything.model(), bad.get()), 0);
  anything.Add("new", "p", "b");
  stream.reset(librdf_model_as_stream(anything.model()));
  EXPECT_NE(librdf_model_add_statements(model.model(), stream.get()), 0);
  EXPECT_THAT(model.errors(), Contains(HasSubstr("relative")));
  EXPECT_FALSE(model.Contains("new", "p", "b"));
}

TEST(StorageTest, ATransactionShowsInsideAndIsMadeOrDroppedWhole) {
  TestModel model;
  model.Add("a", "p", "b");
  ASSERT_EQ(librdf_model_transaction_start(model.model()), 0);
  EXPECT_NE(librdf_model_transaction_start(model.model()), 0);
  EXPECT_EQ(model.Add("a", "p", "c", "g"), 0);
  EXPECT_EQ(model.Remove("a", "p", "b"), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p c g"));
  EXPECT_THAT(model.Contexts(), ElementsAre("g"));
  EXPECT_EQ(model.Size(), 1);
  EXPECT_EQ(librdf_model_transaction_rollback(model.model()), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p b -"));
  EXPECT_NE(librdf_model_transaction_commit(model.model()), 0) << "none is under way";

  ASSERT_EQ(librdf_model_transaction_start(model.model()), 0);
  model.Add("a", "p", "d");
  model.Remove("a", "p", "b");
  EXPECT_EQ(librdf_model_transaction_commit(model.model()), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p d -"));

  ASSERT_EQ(librdf_model_transaction_start(model.model()), 0);
  model.Add("a", "p", "e");
  const StatementPtr bad = ToStatement(model.world(), {Ex("a"), Ex("p"), Term::Iri("relative"), Ex("g")});
  librdf_model_add_statement(model.model(), bad.get());
  EXPECT_NE(librdf_model_transaction_commit(model.model()), 0);
  EXPECT_THAT(model.All(), ElementsAre("a p d -")) << "refused whole";
}

TEST(StorageTest, AVersionIsReadOnly) {
  Dictionary dictionary;
  GraphWriter writer(nullptr);
  const Quad quad = {dictionary.Intern(Ex("a")), dictionary.Intern(Ex("p")), dictionary.Intern(Ex("b")),
                     dictionary.InternIri(kDefaultGraph)};
  writer.Add(quad);
  TestModel model(std::make_unique<VersionStore>(&dictionary, writer.Freeze(Revision(7))));
  EXPECT_TRUE(model.Contains("a", "p", "b"));
  EXPECT_NE(model.Add("a", "p", "c"), 0);
  EXPECT_THAT(model.errors(), ElementsAre(HasSubstr("revision 7 of the graph is read only")));
}

TEST(StorageTest, AStreamIsOfTheGraphAsItWasAsked) {
  TestModel model;
  for (int i = 0; i < 20; ++i) model.Add("a", "p", std::to_string(i));
  const StatementPtr all = model.Statement("a", "p", "-");
  const StreamPtr stream(librdf_model_find_statements(model.model(), all.get()));
  int seen = 0;
  for (; !librdf_stream_end(stream.get()); librdf_stream_next(stream.get()), ++seen) {
    model.Remove("a", "p", std::to_string(seen));
    model.Add("a", "p", std::to_string(100 + seen));
  }
  EXPECT_EQ(seen, 20);
  EXPECT_EQ(model.Size(), 20);
}

// Any sequence of changes, in and out of transactions, gives the same results as a set of quads.
TEST(StorageTest, RandomChangesFindWhatASetFinds) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto pick = [&random](const std::vector<std::string>& from) {
      return from[random() % from.size()];
    };
    const std::vector<std::string> subjects = {"a", "b", "_x"}, predicates = {"p", "q"},
                                   objects = {"a", "_x", "'t", "7"}, graphs = {"-", "g1", "g2"};
    using Key = std::array<std::string, 4>;
    std::set<Key> truth, before;
    TestModel model;
    bool transaction = false;
    for (int step = 0; step < 120; ++step) {
      const Key key = {pick(subjects), pick(predicates), pick(objects), pick(graphs)};
      switch (random() % 8) {
        case 0:
          if (!transaction) {
            ASSERT_EQ(librdf_model_transaction_start(model.model()), 0);
            before = truth;
          } else if (random() % 2 == 0) {
            ASSERT_EQ(librdf_model_transaction_commit(model.model()), 0);
          } else {
            ASSERT_EQ(librdf_model_transaction_rollback(model.model()), 0);
            truth = before;
          }
          transaction = !transaction;
          break;
        case 1:
        case 2:
          if (truth.erase(key) > 0) {
            ASSERT_EQ(model.Remove(key[0], key[1], key[2], key[3]), 0);
          }
          break;
        default:
          ASSERT_EQ(model.Add(key[0], key[1], key[2], key[3]), 0);
          truth.insert(key);
      }
      const auto maybe = [&](const std::string& word) { return random() % 2 == 0 ? word : std::string("-"); };
      const Key wanted = {maybe(key[0]), maybe(key[1]), maybe(key[2]), maybe(key[3])};
      std::vector<std::string> expected;
      for (const Key& k : truth) {
        bool matches = true;
        for (size_t i = 0; i < 4; ++i) matches = matches && (wanted[i] == "-" || wanted[i] == k[i]);
        const std::string object = k[2] == "7" ? ToNTriples(Term::Integer(7)) : k[2];
        if (matches) expected.push_back(k[0] + " " + k[1] + " " + object + " " + k[3]);
      }
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(model.Find(wanted[0], wanted[1], wanted[2], wanted[3]), expected) << "step " << step;
      ASSERT_EQ(model.Size(), static_cast<int>(truth.size()));
    }
  }
}

}  // namespace
}  // namespace docent::redland
