// What a conjunction of constraints needs its variables and resources to be. For condition_checks.cc; one thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_CLASS_NEEDS_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_CLASS_NEEDS_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/iri_names.h"
#include "workflow/cawl/ast.h"
#include "workflow/cawl/check/schema.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {

// Two needs that nothing can meet both.
struct NeedClash {
  SourceSpan span;  // of the word where the second need arises
  std::string message;
  bool of_declaration = false;  // one of them is a variable's declared type
};

class ClassNeeds {
 public:
  // `scope` sees the variables' declarations.
  ClassNeeds(const Schema& schema, const Scope& scope, const IriNames& names)
      : schema_(schema), scope_(scope), names_(names) {}

  void Add(const Constraint& constraint);
  // The first clash of each thing.
  std::vector<NeedClash> Clashes() const;

 private:
  struct Need {
    std::string cls;  // empty: no class, but a literal or a resource
    bool literal = false;
    std::string why;  // "the subject of docent:chose"
    SourceSpan span;
    bool of_declaration = false;
  };
  struct Thing {
    std::string shown;  // "?robot", "docent:Standby"
    std::vector<Need> needs;
  };

  Thing* Of(const Word& word);
  // Once for each class and kind.
  static void Push(Thing* thing, Need need);
  void NeedClass(Thing* thing, const std::string& cls, std::string why, const SourceSpan& span);
  std::optional<NeedClash> ClashOf(const Thing& thing) const;

  const Schema& schema_;
  const Scope& scope_;
  const IriNames& names_;
  std::map<std::string, Thing> things_;
};

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_CLASS_NEEDS_H_
