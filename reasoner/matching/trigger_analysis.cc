#include "reasoner/matching/trigger_analysis.h"

#include <string_view>
#include <utility>

namespace docent::matching {
namespace {

using sparql::Algebra;
using sparql::Builtin;
using sparql::Expression;
using sparql::PatternTerm;
using sparql::TriplePattern;
using Names = absl::flat_hash_set<std::string>;

Polarity Flip(Polarity polarity) {
  if (polarity == Polarity::kPositive) return Polarity::kNegative;
  if (polarity == Polarity::kNegative) return Polarity::kPositive;
  return Polarity::kBoth;
}

void AddVariable(const PatternTerm& term, Names& names) {
  if (term.IsVariable()) names.insert(term.variable().name);
}

void AddVariables(const TriplePattern& triple, Names& names) {
  AddVariable(triple.subject, names);
  AddVariable(triple.predicate, names);
  AddVariable(triple.object, names);
}

// Context of the walk at a place in the query.
struct Place {
  Polarity polarity = Polarity::kPositive;
  bool required = true;
  // Which variables of a pattern here may be seeded: its own, those in `outer`, or none.
  enum class Seeds : uint8_t { kOwn, kOuter, kNone } seeds = Seeds::kOwn;
  const Names* outer = nullptr;
  PatternTerm graph = PatternTerm::Of(sparql::Variable{});
};

class Analyser {
 public:
  TriggerAnalysis Run(const Algebra& where) {
    Walk(where, Place{});
    for (const sparql::Variable& v : sparql::InScopeVariables(where)) {
      if (!blocked_.contains(v.name)) result_.seedable.insert(v.name);
    }
    for (const std::string& name : CertainVariables(where)) {
      if (!blocked_.contains(name)) result_.certain.insert(name);
    }
    for (TriggerSource& trigger : result_.triggers) {
      std::erase_if(trigger.seeds, [&](const std::string& name) { return blocked_.contains(name); });
    }
    return std::move(result_);
  }

 private:
  void AddTrigger(TriplePattern pattern, const Place& place) {
    TriggerSource trigger{std::move(pattern), place.graph, place.polarity, place.required, {}};
    if (place.seeds != Place::Seeds::kNone) {
      Names names;
      AddVariables(trigger.pattern, names);
      if (!place.graph.IsVariable() || !place.graph.variable().name.empty()) AddVariable(place.graph, names);
      for (const std::string& name : names) {
        if (place.seeds == Place::Seeds::kOwn || place.outer->contains(name)) trigger.seeds.push_back(name);
      }
    }
    result_.triggers.push_back(std::move(trigger));
  }

  // GRAPH ?g {} and the like: the graph exists as soon as it holds a triple.
  void AddGraphTrigger(Place place) {
    place.seeds = Place::Seeds::kNone;
    place.required = false;
    AddTrigger({AnyTerm("s"), AnyTerm("p"), AnyTerm("o")}, place);
  }

  // A unique variable. The names within one trigger differ, so no positions must be equal.
  static PatternTerm AnyTerm(std::string_view position) {
    return PatternTerm::Of(sparql::Variable{"." + std::string(position)});
  }

  // Blocks the `names` that are not certainly bound in `scope`: they may be unbound there, so they must not
  // be bound from outside.
  void BlockUnless(const Names& scope, const std::vector<sparql::Variable>& names) {
    for (const sparql::Variable& v : names) {
      if (!scope.contains(v.name)) blocked_.insert(v.name);
    }
  }

  void Walk(const Algebra& node, Place place) {
    switch (node.kind) {
      case Algebra::Kind::kBgp:
        for (const TriplePattern& triple : node.triples) AddTrigger(triple, place);
        return;
      case Algebra::Kind::kPath:
        return WalkPath(node, place);
      case Algebra::Kind::kJoin:
        for (const auto& child : node.children) Walk(*child, place);
        return;
      case Algebra::Kind::kUnion:
        place.required = false;
        for (const auto& child : node.children) Walk(*child, place);
        return;
      case Algebra::Kind::kLeftJoin:
        return WalkLeftJoin(node, place);
      case Algebra::Kind::kMinus:
        return WalkMinus(node, place);
      case Algebra::Kind::kFilter: {
        Walk(*node.children[0], place);
        return WalkExpressionIn(CertainVariables(*node.children[0]), *node.expression, place);
      }
      case Algebra::Kind::kExtend:
        blocked_.insert(node.variable.name);
        Walk(*node.children[0], place);
        return WalkExpressionIn(CertainVariables(*node.children[0]), *node.expression, place);
      case Algebra::Kind::kGraph:
        place.graph = node.name;
        if (!sparql::NeedsTripleOfGraph(*node.children[0])) AddGraphTrigger(place);
        return Walk(*node.children[0], place);
      case Algebra::Kind::kValues:
        for (const sparql::Variable& v : node.variables) blocked_.insert(v.name);
        return;
      case Algebra::Kind::kOrderBy:
      case Algebra::Kind::kDistinct:
      case Algebra::Kind::kReduced:
        return Walk(*node.children[0], place);
      case Algebra::Kind::kProject:
        if (const Algebra* group = GroupOf(node)) return WalkSelect(node, *group, place);
        return WalkClosed(node, place);
      case Algebra::Kind::kService:
      case Algebra::Kind::kGroup:
      case Algebra::Kind::kSlice:
        return WalkClosed(node, place);
    }
  }

  // Sub-SELECT, aggregates, LIMIT: no variable can be bound from outside, and more matches may give fewer
  // rows.
  void WalkClosed(const Algebra& node, Place place) {
    place.seeds = Place::Seeds::kNone;
    place.required = false;
    if (node.kind != Algebra::Kind::kProject) place.polarity = Polarity::kBoth;
    for (const sparql::Variable& v : sparql::InScopeVariables(node)) blocked_.insert(v.name);
    if (node.kind == Algebra::Kind::kGroup) {
      const Names scope = CertainVariables(*node.children[0]);
      for (const sparql::GroupKey& key : node.group_keys) {
        if (key.expression) WalkExpressionIn(scope, *key.expression, place);
      }
      for (const sparql::Aggregate& aggregate : node.aggregates) {
        if (aggregate.expression) WalkExpressionIn(scope, *aggregate.expression, place);
      }
    }
    for (const auto& child : node.children) Walk(*child, place);
  }

  // An aggregating sub-SELECT: a value for a projected key selects that group and changes no other group.
  void WalkSelect(const Algebra& project, const Algebra& group, Place place) {
    const Names inner = CertainVariables(*group.children[0]);
    Names shown, keys;
    for (const sparql::Variable& v : project.variables) shown.insert(v.name);
    for (const sparql::GroupKey& key : group.group_keys) {
      const bool plain = !key.expression || key.expression->kind == Expression::Kind::kVariable;
      if (plain && inner.contains(key.variable.name) && shown.contains(key.variable.name))
        keys.insert(key.variable.name);
    }
    for (const std::string& name : shown) {
      if (!keys.contains(name)) blocked_.insert(name);
    }
    const bool seedable = place.seeds == Place::Seeds::kOwn;
    place.seeds = seedable ? Place::Seeds::kOuter : Place::Seeds::kNone;
    place.outer = &keys;
    place.required = false;
    place.polarity = Polarity::kBoth;
    for (const Algebra* node = project.children[0].get(); node != &group; node = node->children[0].get()) {
      if (node->expression) WalkExpression(*node->expression, place);
    }
    for (const sparql::Aggregate& aggregate : group.aggregates) {
      if (aggregate.expression) WalkExpression(*aggregate.expression, place);
    }
    const Names blocked_outside = blocked_;  // names inside are local variables, except for the keys
    Walk(*group.children[0], place);
    Names blocked_inside = std::exchange(blocked_, blocked_outside);
    for (const std::string& name : keys) {
      if (blocked_inside.contains(name)) blocked_.insert(name);
    }
  }

  void WalkLeftJoin(const Algebra& node, const Place& place) {
    const Names left = CertainVariables(*node.children[0]);
    Walk(*node.children[0], place);
    BlockUnless(left, sparql::InScopeVariables(*node.children[1]));
    Place right = Inner(place, left);
    right.polarity = Polarity::kBoth;
    Walk(*node.children[1], right);
    if (node.expression) {
      Names both = left;
      for (const std::string& name : CertainVariables(*node.children[1])) both.insert(name);
      BlockUnless(both, sparql::MentionedVariables(*node.expression));
      right.outer = &both;
      WalkExpression(*node.expression, right);
    }
  }

  void WalkMinus(const Algebra& node, const Place& place) {
    const Names left = CertainVariables(*node.children[0]);
    Walk(*node.children[0], place);
    BlockUnless(left, sparql::InScopeVariables(*node.children[1]));
    Place right = Inner(place, left);
    right.polarity = Flip(place.polarity);
    if (place.outer != nullptr) right.seeds = Place::Seeds::kNone;  // MINUS inside EXISTS: no substitution
    Walk(*node.children[1], right);
  }

  void WalkExpressionIn(const Names& scope, const Expression& expression, const Place& place) {
    BlockUnless(scope, sparql::MentionedVariables(expression));
    Place inner = Inner(place, scope);
    WalkExpression(expression, inner);
  }

  // The context inside an EXISTS, OPTIONAL or MINUS beside the pattern that binds `scope`.
  Place Inner(const Place& place, const Names& scope) {
    Place inner = place;
    inner.required = false;
    if (place.seeds == Place::Seeds::kOwn) {
      inner.seeds = Place::Seeds::kOuter;
      inner.outer = &scope;
    }
    return inner;
  }

  void WalkExpression(const Expression& expression, Place place) {
    switch (expression.kind) {
      case Expression::Kind::kAnd:
      case Expression::Kind::kOr:
        break;
      case Expression::Kind::kExists:
        return Walk(*expression.pattern, place);
      case Expression::Kind::kNotExists:
        place.polarity = Flip(place.polarity);
        return Walk(*expression.pattern, place);
      case Expression::Kind::kNot:
        place.polarity = Flip(place.polarity);
        if (expression.arguments[0]->kind != Expression::Kind::kExists &&
            expression.arguments[0]->kind != Expression::Kind::kNotExists) {
          place.polarity = Polarity::kBoth;
        }
        break;
      case Expression::Kind::kBuiltin:
        if (expression.builtin == Builtin::kNow || expression.builtin == Builtin::kRand ||
            expression.builtin == Builtin::kUuid || expression.builtin == Builtin::kStrUuid ||
            expression.builtin == Builtin::kBnode) {
          result_.is_volatile = true;
        }
        place.polarity = Polarity::kBoth;
        break;
      default:
        place.polarity = Polarity::kBoth;
        break;
    }
    for (const auto& argument : expression.arguments) WalkExpression(*argument, place);
  }

  void WalkPath(const Algebra& node, Place place) {
    place.seeds = Place::Seeds::kNone;
    place.required = false;
    AddPathTriggers(node.path, place);
  }

  void AddPathTriggers(const sparql::Path& path, const Place& place) {
    using Kind = sparql::Path::Kind;
    if (path.kind == Kind::kIri) {
      AddTrigger({AnyTerm("s"), PatternTerm::Of(path.iri), AnyTerm("o")}, place);
      return;
    }
    if (path.kind == Kind::kZeroOrMore || path.kind == Kind::kZeroOrOne || path.kind == Kind::kNegatedSet) {
      // A path of length zero relates every term of the graph to itself.
      AddTrigger({AnyTerm("s"), AnyTerm("p"), AnyTerm("o")}, place);
      return;
    }
    for (const sparql::Path& child : path.children) AddPathTriggers(child, place);
  }

  TriggerAnalysis result_;
  Names blocked_;
};

}  // namespace

const Algebra* GroupOf(const Algebra& project) {
  if (project.kind != Algebra::Kind::kProject) return nullptr;
  const Algebra* node = project.children[0].get();
  while (node->kind == Algebra::Kind::kExtend || node->kind == Algebra::Kind::kFilter)
    node = node->children[0].get();
  return node->kind == Algebra::Kind::kGroup ? node : nullptr;
}

absl::flat_hash_set<std::string> CertainVariables(const Algebra& algebra) {
  Names names;
  switch (algebra.kind) {
    case Algebra::Kind::kBgp:
      for (const TriplePattern& triple : algebra.triples) AddVariables(triple, names);
      break;
    case Algebra::Kind::kPath:
      AddVariable(algebra.subject, names);
      AddVariable(algebra.object, names);
      break;
    case Algebra::Kind::kJoin:
      for (const auto& child : algebra.children) names.merge(CertainVariables(*child));
      break;
    case Algebra::Kind::kUnion: {
      names = CertainVariables(*algebra.children[0]);
      for (const auto& child : algebra.children) {
        const Names other = CertainVariables(*child);
        absl::erase_if(names, [&](const std::string& name) { return !other.contains(name); });
      }
      break;
    }
    case Algebra::Kind::kGraph:
      names = CertainVariables(*algebra.children[0]);
      AddVariable(algebra.name, names);
      break;
    case Algebra::Kind::kLeftJoin:
    case Algebra::Kind::kMinus:
    case Algebra::Kind::kFilter:
    case Algebra::Kind::kExtend:
    case Algebra::Kind::kOrderBy:
    case Algebra::Kind::kDistinct:
    case Algebra::Kind::kReduced:
    case Algebra::Kind::kSlice:
      names = CertainVariables(*algebra.children[0]);
      break;
    case Algebra::Kind::kProject: {
      const Names inner = CertainVariables(*algebra.children[0]);
      for (const sparql::Variable& v : algebra.variables) {
        if (inner.contains(v.name)) names.insert(v.name);
      }
      break;
    }
    case Algebra::Kind::kGroup: {
      const Names inner = CertainVariables(*algebra.children[0]);
      for (const sparql::GroupKey& key : algebra.group_keys) {
        if (inner.contains(key.variable.name)) names.insert(key.variable.name);
      }
      break;
    }
    case Algebra::Kind::kValues:
    case Algebra::Kind::kService:
      break;
  }
  return names;
}

const Algebra& WithoutModifiers(const Algebra& algebra) {
  switch (algebra.kind) {
    case Algebra::Kind::kProject:
      if (GroupOf(algebra) != nullptr) return algebra;
      return WithoutModifiers(*algebra.children[0]);
    case Algebra::Kind::kDistinct:
    case Algebra::Kind::kReduced:
    case Algebra::Kind::kOrderBy:
      return WithoutModifiers(*algebra.children[0]);
    default:
      return algebra;
  }
}

TriggerAnalysis AnalyseTriggers(const Algebra& where) {
  return Analyser().Run(where);
}

}  // namespace docent::matching
