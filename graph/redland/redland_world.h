// A librdf world borrowed from the pool, with its Raptor and Rasqal worlds. Only the .cc files of this folder
// include it.
#ifndef DOCENT_GRAPH_REDLAND_REDLAND_WORLD_H_
#define DOCENT_GRAPH_REDLAND_REDLAND_WORLD_H_

#include <redland.h>

#include <string>
#include <vector>

namespace docent::redland {

// One thread at a time. Worlds are created one after the other and never freed: creating and freeing them
// touches globals of libxml2 and libxslt (helgrind sees 63 races if that happens in parallel). Messages that
// librdf would print are kept here instead.
class RedlandWorld {
 public:
  RedlandWorld();
  ~RedlandWorld();  // back into the pool
  RedlandWorld(const RedlandWorld&) = delete;
  RedlandWorld& operator=(const RedlandWorld&) = delete;

  librdf_world* get() const { return world_; }
  // The errors since the world was borrowed, in order.
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  librdf_world* world_;
  std::vector<std::string> errors_;
};

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_REDLAND_WORLD_H_
