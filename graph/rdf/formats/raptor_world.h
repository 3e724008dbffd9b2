// A Raptor world borrowed from a pool. Included only by rdf_xml*.cc, the only files that use Raptor.
#ifndef DOCENT_GRAPH_RDF_FORMATS_RAPTOR_WORLD_H_
#define DOCENT_GRAPH_RDF_FORMATS_RAPTOR_WORLD_H_

#include <raptor2.h>

#include <functional>
#include <memory>

namespace docent {

// One thread at a time. Every message of the world is passed to `on_message`; nothing is printed.
class RaptorWorld {
 public:
  using OnMessage = std::function<void(const raptor_log_message&)>;

  explicit RaptorWorld(OnMessage on_message);
  ~RaptorWorld();  // back into the pool
  RaptorWorld(const RaptorWorld&) = delete;
  RaptorWorld& operator=(const RaptorWorld&) = delete;

  raptor_world* get() const { return world_; }

 private:
  raptor_world* world_;
  OnMessage on_message_;
};

template <auto Free>
struct RaptorDeleter {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using RaptorParser = std::unique_ptr<raptor_parser, RaptorDeleter<raptor_free_parser>>;
using RaptorSerializer = std::unique_ptr<raptor_serializer, RaptorDeleter<raptor_free_serializer>>;
using RaptorUri = std::unique_ptr<raptor_uri, RaptorDeleter<raptor_free_uri>>;
using RaptorStatement = std::unique_ptr<raptor_statement, RaptorDeleter<raptor_free_statement>>;
using RaptorStream = std::unique_ptr<raptor_iostream, RaptorDeleter<raptor_free_iostream>>;

inline const unsigned char* Bytes(const char* text) {
  return reinterpret_cast<const unsigned char*>(text);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_RAPTOR_WORLD_H_
