// A librdf model over a graph in memory, and short helpers for the tests of this folder.
#ifndef DOCENT_TESTS_GRAPH_REDLAND_TEST_MODEL_H_
#define DOCENT_TESTS_GRAPH_REDLAND_TEST_MODEL_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graph/rdf/vocabulary.h"
#include "graph/redland/redland_nodes.h"
#include "graph/redland/redland_world.h"
#include "graph/redland/storage.h"
#include "graph/redland/version_store.h"

namespace docent::redland {

inline Term Ex(const std::string& name) {
  return Term::Iri("http://example.org/" + name);
}

// "a p b" or "a p b g": names of example.org; "_x" a blank node, a digit an integer, 'x a string.
inline Term Word(const std::string& word) {
  if (word[0] == '_') return Term::Blank(word.substr(1));
  if (word[0] == '\'') return Term::Literal(word.substr(1));
  if (std::isdigit(static_cast<unsigned char>(word[0]))) return Term::Integer(std::stoll(word));
  return Ex(word);
}

inline std::string Show(const Term& term) {
  const std::string ex = "http://example.org/";
  if (term.IsIri())
    return term.lexical.starts_with(ex) ? term.lexical.substr(ex.size()) : "<" + term.lexical + ">";
  if (term.IsBlank()) return "_" + term.lexical;
  return term.datatype.empty() && term.language.empty() ? "'" + term.lexical : ToNTriples(term);
}

class TestModel {
 public:
  explicit TestModel(bool merged = false) : TestModel(nullptr, merged) {}
  // Over `store`, or over a graph of its own.
  explicit TestModel(std::unique_ptr<QuadStore> store, bool merged = false) {
    if (!store) store = std::make_unique<WriterStore>(&dictionary_, &writer_, Revision(1));
    storage_.reset(OpenStorage(world_.get(), std::move(store), merged));
    model_.reset(librdf_new_model(world_.get(), storage_.get(), nullptr));
    EXPECT_TRUE(model_);
  }

  librdf_world* world() { return world_.get(); }
  librdf_model* model() { return model_.get(); }
  const std::vector<std::string>& errors() const { return world_.errors(); }
  void Close() {
    model_.reset();
    storage_.reset();
  }

  NodePtr Node(const std::string& word) { return word == "-" ? nullptr : ToNode(world(), Word(word)); }
  StatementPtr Statement(const std::string& s, const std::string& p, const std::string& o) {
    return StatementPtr(
        librdf_new_statement_from_nodes(world(), Node(s).release(), Node(p).release(), Node(o).release()));
  }
  int Add(const std::string& s, const std::string& p, const std::string& o, const std::string& g = "-") {
    return librdf_model_context_add_statement(model(), Node(g).get(), Statement(s, p, o).get());
  }
  int Remove(const std::string& s, const std::string& p, const std::string& o, const std::string& g = "-") {
    const StatementPtr statement = Statement(s, p, o);
    if (g == "-") return librdf_model_remove_statement(model(), statement.get());
    return librdf_model_context_remove_statement(model(), Node(g).get(), statement.get());
  }
  bool Contains(const std::string& s, const std::string& p, const std::string& o) {
    return librdf_model_contains_statement(model(), Statement(s, p, o).get()) != 0;
  }
  int Size() { return librdf_model_size(model()); }

  // "s p o g" each, "-" for no context, sorted.
  std::vector<std::string> Find(const std::string& s, const std::string& p, const std::string& o,
                                const std::string& g = "-") {
    const StatementPtr statement = Statement(s, p, o);
    return Lines(librdf_model_find_statements_in_context(model(), statement.get(), Node(g).get()));
  }
  std::vector<std::string> All() { return Lines(librdf_model_as_stream(model())); }
  std::vector<std::string> InContext(const std::string& g) {
    return Lines(librdf_model_context_as_stream(model(), Node(g).get()));
  }
  std::vector<std::string> Contexts() { return Nodes(librdf_model_get_contexts(model())); }

  std::vector<std::string> Lines(librdf_stream* raw) {
    const StreamPtr stream(raw);
    EXPECT_TRUE(stream);
    std::vector<std::string> lines;
    for (; stream && !librdf_stream_end(stream.get()); librdf_stream_next(stream.get())) {
      const TermQuad quad = FromStatement(librdf_stream_get_object(stream.get()), Term::Iri(""));
      const auto context = FromNode(librdf_stream_get_context2(stream.get()));
      lines.push_back(Show(quad.subject) + " " + Show(quad.predicate) + " " + Show(quad.object) + " " +
                      (context ? Show(*context) : "-"));
    }
    std::sort(lines.begin(), lines.end());
    return lines;
  }
  std::vector<std::string> Nodes(librdf_iterator* iterator) {
    EXPECT_NE(iterator, nullptr);
    std::vector<std::string> names;
    for (; iterator != nullptr && !librdf_iterator_end(iterator); librdf_iterator_next(iterator)) {
      names.push_back(Show(*FromNode(static_cast<librdf_node*>(librdf_iterator_get_object(iterator)))));
    }
    if (iterator != nullptr) librdf_free_iterator(iterator);
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  RedlandWorld world_;
  Dictionary dictionary_;
  GraphWriter writer_{nullptr};
  StoragePtr storage_;
  ModelPtr model_;
};

}  // namespace docent::redland

#endif  // DOCENT_TESTS_GRAPH_REDLAND_TEST_MODEL_H_
