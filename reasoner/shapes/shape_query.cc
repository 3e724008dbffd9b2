#include "reasoner/shapes/shape_query.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::shapes {
namespace {

using sparql::Algebra;
using sparql::AlgebraPtr;
using sparql::Expression;
using sparql::PatternTerm;

constexpr char kPathVariable[] = "PATH";

bool IsPath(const PatternTerm& term) {
  return term.IsVariable() && term.variable().name == kPathVariable;
}

// Visits every node of an algebra, also inside EXISTS, the outermost first.
template <typename Visit>
void ForEachNode(const Algebra& node, const Visit& visit) {
  visit(node);
  for (const AlgebraPtr& child : node.children) ForEachNode(*child, visit);
  sparql::ForEachExpression(node, [&](const Expression& e) {
    if (e.pattern) ForEachNode(*e.pattern, visit);
  });
}

class GivenCheck {
 public:
  explicit GivenCheck(const GivenVariables& given) : given_(given) {}

  Diagnostics Run(const sparql::Query& query) {
    // The outermost SELECT is not a sub-SELECT.
    const Algebra* outermost = query.algebra.get();
    while (outermost->kind != Algebra::Kind::kProject && outermost->children.size() == 1 &&
           (outermost->kind == Algebra::Kind::kSlice || outermost->kind == Algebra::Kind::kDistinct ||
            outermost->kind == Algebra::Kind::kReduced || outermost->kind == Algebra::Kind::kOrderBy)) {
      outermost = outermost->children[0].get();
    }
    ForEachNode(*query.algebra, [&](const Algebra& node) { Check(node, &node == outermost); });
    return std::move(found_);
  }

 private:
  void Error(const Algebra& node, std::string message, std::string hint) {
    found_.push_back({"", node.span, std::move(message), std::move(hint)});
  }

  void Check(const Algebra& node, bool outermost) {
    switch (node.kind) {
      case Algebra::Kind::kMinus:
        return Error(node, "MINUS is not allowed where variables are given before",
                     "write FILTER NOT EXISTS { … }");
      case Algebra::Kind::kValues:
        return Error(node, "VALUES is not allowed where variables are given before",
                     "write FILTER(?x IN (…))");
      case Algebra::Kind::kService:
        return Error(node, "SERVICE is not allowed where variables are given before", "load the data");
      case Algebra::Kind::kExtend:
        return CheckAssigned(node, node.variable.name);
      case Algebra::Kind::kGroup:
        for (const sparql::GroupKey& key : node.group_keys) {
          const bool itself =
              key.expression->kind == Expression::Kind::kVariable && key.expression->variable == key.variable;
          if (!itself) CheckAssigned(node, key.variable.name);
        }
        return;
      case Algebra::Kind::kProject:
        if (!outermost) CheckProjected(node);
        return;
      default:
        return;
    }
  }

  void CheckAssigned(const Algebra& node, const std::string& name) {
    if (!given_.Has(name)) return;
    Error(node, absl::StrCat("?", name, " is given before and must not be assigned"), "use another variable");
  }

  void CheckProjected(const Algebra& node) {
    for (const std::string& name : given_.required) {
      const bool projected = std::any_of(node.variables.begin(), node.variables.end(),
                                         [&](const sparql::Variable& v) { return v.name == name; });
      if (projected) continue;
      return Error(node, absl::StrCat("a sub-SELECT does not return ?", name, ", which is given before"),
                   absl::StrCat("add ?", name, " to its SELECT clause"));
    }
  }

  const GivenVariables& given_;
  Diagnostics found_;
};

sparql::Path ToSparql(const Path& path, const Dictionary& dictionary) {
  using Kind = sparql::Path::Kind;
  static constexpr Kind kKinds[] = {Kind::kIri,        Kind::kInverse,   Kind::kSequence, Kind::kAlternative,
                                    Kind::kZeroOrMore, Kind::kOneOrMore, Kind::kZeroOrOne};
  sparql::Path out;
  out.kind = kKinds[static_cast<size_t>(path.kind)];
  if (path.kind == Path::Kind::kPredicate) out.iri = dictionary.Decode(path.predicate);
  for (const Path& child : path.children) out.children.push_back(ToSparql(child, dictionary));
  return out;
}

class PathSubstitution {
 public:
  PathSubstitution(const Path& path, const Dictionary& dictionary) : path_(ToSparql(path, dictionary)) {}

  void Run(AlgebraPtr& node) {
    for (AlgebraPtr& child : node->children) Run(child);
    sparql::ForEachExpression(*node, [&](Expression& e) {
      if (e.pattern) Run(e.pattern);
    });
    if (node->kind == Algebra::Kind::kBgp) Replace(node);
  }

 private:
  void Replace(AlgebraPtr& bgp) {
    std::vector<sparql::TriplePattern> with_path;
    for (sparql::TriplePattern& triple : bgp->triples) {
      if (!IsPath(triple.predicate)) continue;
      if (path_.kind == sparql::Path::Kind::kIri) {
        triple.predicate.Set(path_.iri);
      } else {
        with_path.push_back(triple);
      }
    }
    if (with_path.empty()) return;
    std::erase_if(bgp->triples, [](const sparql::TriplePattern& t) { return IsPath(t.predicate); });
    auto join = std::make_unique<Algebra>(Algebra::Kind::kJoin, bgp->span);
    for (const sparql::TriplePattern& triple : with_path) {
      auto step = std::make_unique<Algebra>(Algebra::Kind::kPath, triple.predicate.span);
      step->subject = triple.subject;
      step->object = triple.object;
      step->path = path_;
      join->children.push_back(std::move(step));
    }
    if (!bgp->triples.empty()) join->children.push_back(std::move(bgp));
    bgp = join->children.size() == 1 ? std::move(join->children[0]) : std::move(join);
  }

  const sparql::Path path_;
};

template <typename Visit>
void ForEachTerm(const Algebra& node, const Visit& visit) {
  for (const sparql::TriplePattern& triple : node.triples) {
    visit(triple.subject, false);
    visit(triple.predicate, true);
    visit(triple.object, false);
  }
  for (const PatternTerm* term : {&node.subject, &node.object, &node.name}) visit(*term, false);
}

}  // namespace

bool GivenVariables::Has(std::string_view name) const {
  return std::find(required.begin(), required.end(), name) != required.end() ||
         std::find(optional.begin(), optional.end(), name) != optional.end();
}

Diagnostics CheckGiven(const sparql::Query& query, const GivenVariables& given) {
  return GivenCheck(given).Run(query);
}

std::vector<std::string> VariablesOf(const sparql::Query& query) {
  std::set<std::string> names;
  const auto note = [&names](const sparql::Variable& v) {
    if (!v.IsHidden()) names.insert(v.name);
  };
  for (const sparql::Variable& v : query.projection) note(v);
  ForEachNode(*query.algebra, [&](const Algebra& node) {
    ForEachTerm(node, [&](const PatternTerm& term, bool) {
      if (term.IsVariable()) note(term.variable());
    });
    if (node.kind == Algebra::Kind::kExtend) note(node.variable);
    for (const sparql::Variable& v : node.variables) note(v);
    for (const sparql::GroupKey& key : node.group_keys) note(key.variable);
    sparql::ForEachExpression(node, [&](const Expression& e) {
      if (e.kind == Expression::Kind::kVariable) note(e.variable);
    });
  });
  return {names.begin(), names.end()};
}

Diagnostics SubstitutePath(const Path& path, const Dictionary& dictionary, sparql::Query* query) {
  Diagnostics found;
  const auto error = [&found](const SourceSpan& at) {
    found.push_back({"", at, "$PATH is only allowed as a predicate", "write $this $PATH ?value"});
  };
  ForEachNode(*query->algebra, [&](const Algebra& node) {
    ForEachTerm(node, [&](const PatternTerm& term, bool predicate) {
      if (!predicate && IsPath(term)) error(term.span);
    });
    sparql::ForEachExpression(node, [&](const Expression& e) {
      if (e.kind == Expression::Kind::kVariable && e.variable.name == kPathVariable) error(e.span);
    });
  });
  if (found.empty()) PathSubstitution(path, dictionary).Run(query->algebra);
  return found;
}

std::string FillTemplate(std::string_view text,
                         const std::vector<std::pair<std::string, std::string>>& values) {
  std::string out;
  while (!text.empty()) {
    const size_t open = text.find('{');
    out += text.substr(0, open);
    if (open == std::string_view::npos) break;
    text.remove_prefix(open);
    const size_t close = text.find('}');
    const std::pair<std::string, std::string>* value = nullptr;
    if (close != std::string_view::npos && close > 2 && (text[1] == '?' || text[1] == '$')) {
      const std::string_view name = text.substr(2, close - 2);
      const auto found =
          std::find_if(values.begin(), values.end(), [&](const auto& each) { return each.first == name; });
      if (found != values.end()) value = &*found;
    }
    if (value == nullptr) {
      out += '{';
      text.remove_prefix(1);
      continue;
    }
    out += value->second;
    text.remove_prefix(close + 1);
  }
  return out;
}

}  // namespace docent::shapes
