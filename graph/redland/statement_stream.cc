#include "graph/redland/statement_stream.h"

#include <utility>

#include "graph/rdf/vocabulary.h"

namespace docent::redland {
namespace {

class StatementStream {
 public:
  StatementStream(librdf_storage* storage, std::unique_ptr<QuadStream> quads, bool merged)
      : storage_(storage),
        world_(librdf_storage_get_world(storage)),
        quads_(std::move(quads)),
        merged_(merged) {
    librdf_storage_add_reference(storage_);
    Advance();
  }
  ~StatementStream() { librdf_storage_remove_reference(storage_); }

  bool at_end() const { return at_end_; }
  void Advance() {
    statement_.reset();
    context_.reset();
    TermQuad next;
    do {
      at_end_ = !quads_->Next(&next);
    } while (!at_end_ && merged_ && any_ && SameTriple(next, quad_));
    any_ = true;
    if (!at_end_) quad_ = std::move(next);
  }
  // Both are valid until Advance; null at the end.
  librdf_statement* statement() {
    if (!statement_ && !at_end_) statement_ = ToStatement(world_, quad_);
    return statement_.get();
  }
  librdf_node* context() {
    if (!context_ && !at_end_ && quad_.graph.lexical != kDefaultGraph) context_ = ToNode(world_, quad_.graph);
    return context_.get();
  }

 private:
  static bool SameTriple(const TermQuad& a, const TermQuad& b) {
    return a.subject == b.subject && a.predicate == b.predicate && a.object == b.object;
  }

  librdf_storage* const storage_;
  librdf_world* const world_;
  const std::unique_ptr<QuadStream> quads_;
  const bool merged_;
  TermQuad quad_;
  bool any_ = false;  // quad_ holds a quad of the stream
  bool at_end_ = false;
  StatementPtr statement_;
  NodePtr context_;
};

StatementStream& StreamOfContext(void* context) {
  return *static_cast<StatementStream*>(context);
}

class NodeIterator {
 public:
  explicit NodeIterator(std::vector<NodePtr> nodes) : nodes_(std::move(nodes)) {}
  bool at_end() const { return at_ >= nodes_.size(); }
  void Advance() { ++at_; }
  librdf_node* node() { return at_end() ? nullptr : nodes_[at_].get(); }

 private:
  std::vector<NodePtr> nodes_;
  size_t at_ = 0;
};

NodeIterator& IteratorOfContext(void* context) {
  return *static_cast<NodeIterator*>(context);
}

}  // namespace

librdf_stream* NewStatementStream(librdf_storage* storage, std::unique_ptr<QuadStream> quads, bool merged) {
  auto context = std::make_unique<StatementStream>(storage, std::move(quads), merged);
  librdf_stream* stream = librdf_new_stream(
      librdf_storage_get_world(storage), context.get(),
      [](void* context) -> int { return StreamOfContext(context).at_end(); },
      [](void* context) -> int {
        StreamOfContext(context).Advance();
        return StreamOfContext(context).at_end();
      },
      [](void* context, int what) -> void* {
        if (what == LIBRDF_STREAM_GET_METHOD_GET_OBJECT) return StreamOfContext(context).statement();
        if (what == LIBRDF_STREAM_GET_METHOD_GET_CONTEXT) return StreamOfContext(context).context();
        return nullptr;
      },
      [](void* context) { delete &StreamOfContext(context); });
  if (stream != nullptr) context.release();  // NOLINT: librdf owns it now
  return stream;
}

librdf_iterator* NewNodeIterator(librdf_world* world, const std::vector<Term>& terms) {
  std::vector<NodePtr> nodes;
  for (const Term& term : terms) nodes.push_back(ToNode(world, term));
  auto context = std::make_unique<NodeIterator>(std::move(nodes));
  librdf_iterator* iterator = librdf_new_iterator(
      world, context.get(), [](void* context) -> int { return IteratorOfContext(context).at_end(); },
      [](void* context) -> int {
        IteratorOfContext(context).Advance();
        return IteratorOfContext(context).at_end();
      },
      [](void* context, int what) -> void* {
        return what == LIBRDF_ITERATOR_GET_METHOD_GET_OBJECT ? IteratorOfContext(context).node() : nullptr;
      },
      [](void* context) { delete &IteratorOfContext(context); });
  if (iterator != nullptr) context.release();  // NOLINT: librdf owns it now
  return iterator;
}

}  // namespace docent::redland
