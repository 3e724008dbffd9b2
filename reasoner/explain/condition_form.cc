#include "reasoner/explain/condition_form.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::explain {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;
using Clauses = std::vector<Clause>;

template <typename T>
void Append(std::vector<T>& to, std::vector<T> from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

// Renaming of variables inside an EXISTS or a sub-SELECT.
struct Scope {
  std::string prefix;           // of local names; empty: the outermost scope
  std::set<std::string> outer;  // names that are not renamed
  const Scope* parent = nullptr;

  std::string NameOf(const std::string& name) const {
    if (prefix.empty() || outer.contains(name)) return parent == nullptr ? name : parent->NameOf(name);
    return absl::StrCat(prefix, name);
  }
};

int Variable(Clause& clause, const std::string& name, const std::string& written) {
  const int known = clause.Find(name);
  if (known >= 0) return known;
  clause.names.push_back(name);
  clause.written.push_back(!written.empty() && written[0] != '.' ? written.substr(0, written.find(kCopyMark))
                                                                 : "");
  return static_cast<int>(clause.names.size()) - 1;
}

// The conjunction of `to` and `from`; variables of the same name are one variable.
Clause Merge(const Clause& to, const Clause& from) {
  Clause out = to;
  std::vector<int> place(from.names.size());
  for (size_t i = 0; i < from.names.size(); ++i) {
    place[i] = Variable(out, from.names[i], from.written[i]);
  }
  const auto move_all = [&](std::vector<int>& variables) {
    for (int& v : variables) v = place[v];
  };
  for (Atom atom : from.atoms) {
    for (AtomTerm& term : atom.terms) {
      if (term.variable >= 0) term.variable = place[term.variable];
    }
    out.atoms.push_back(atom);
  }
  for (Test test : from.tests) {
    move_all(test.variables);
    out.tests.push_back(std::move(test));
  }
  for (Assignment assignment : from.assignments) {
    move_all(assignment.variables);
    assignment.variable = place[assignment.variable];
    out.assignments.push_back(std::move(assignment));
  }
  for (Table table : from.tables) {
    move_all(table.variables);
    out.tables.push_back(std::move(table));
  }
  for (Part part : from.parts) {
    move_all(part.variables);
    if (part.graph.variable >= 0) part.graph.variable = place[part.graph.variable];
    out.parts.push_back(std::move(part));
  }
  out.absences.insert(out.absences.end(), from.absences.begin(), from.absences.end());
  return out;
}

class Builder {
 public:
  Builder(const Algebra& whole, Dictionary& dictionary, TermId default_graph, PathForm paths)
      : whole_(whole), dictionary_(dictionary), paths_(paths) {
    graph_.constant = default_graph;
  }

  absl::StatusOr<Clauses> Expand(const Algebra& node, const Scope& scope) {
    if (IsOfGroup(node)) return Whole(node, scope);
    switch (node.kind) {
      case Algebra::Kind::kBgp:
        return ExpandBgp(node, scope);
      case Algebra::Kind::kPath:
        return ExpandPath(node, scope);
      case Algebra::Kind::kJoin:
        return ExpandJoin(node, scope);
      case Algebra::Kind::kUnion:
        return ExpandUnion(node, scope);
      case Algebra::Kind::kFilter:
        return ExpandFilter(node, scope);
      case Algebra::Kind::kLeftJoin:
        return ExpandLeftJoin(node, scope);
      case Algebra::Kind::kMinus:
        return ExpandMinus(node, scope);
      case Algebra::Kind::kGraph:
        return ExpandGraph(node, scope);
      case Algebra::Kind::kExtend:
        return ExpandExtend(node, scope);
      case Algebra::Kind::kValues:
        return ExpandValues(node, scope);
      case Algebra::Kind::kOrderBy:
      case Algebra::Kind::kDistinct:
      case Algebra::Kind::kReduced:
        return Expand(*node.children[0], scope);
      case Algebra::Kind::kProject:
        return ExpandProject(node, scope);
      case Algebra::Kind::kService:
      case Algebra::Kind::kGroup:
      case Algebra::Kind::kSlice:
        return Whole(node, scope);
    }
    return Whole(node, scope);
  }

 private:
  // Also true for the expressions of SELECT and HAVING over a group: they belong to the query as written.
  static bool IsOfGroup(const Algebra& node) {
    const Algebra* at = &node;
    while (at->kind == Algebra::Kind::kProject || at->kind == Algebra::Kind::kExtend ||
           at->kind == Algebra::Kind::kFilter || at->kind == Algebra::Kind::kOrderBy)
      at = at->children[0].get();
    return at->kind == Algebra::Kind::kGroup;
  }

  AtomTerm Make(Clause& clause, const PatternTerm& term, const Scope& scope) {
    if (!term.IsVariable()) return {dictionary_.Intern(term.term()), AtomTerm::kConstant};
    const std::string& name = term.variable().name;
    return {TermId(), Variable(clause, scope.NameOf(name), name)};
  }

  Atom MakeAtom(Clause& clause, const PatternTerm& s, const PatternTerm& p, const PatternTerm& o,
                const Scope& scope) {
    Atom atom;
    atom.terms[0] = Make(clause, s, scope);
    atom.terms[1] = Make(clause, p, scope);
    atom.terms[2] = Make(clause, o, scope);
    atom.terms[3] = graph_;
    if (!graph_name_.empty()) atom.terms[3] = {TermId(), Variable(clause, graph_name_, graph_written_)};
    return atom;
  }

  // Any fact of the current graph.
  Atom AnyFact(Clause& clause) {
    const std::string prefix = absl::StrCat(".s", ++fresh_, ".");
    const Scope own{prefix, {}, nullptr};
    const auto any = [](const char* name) { return PatternTerm::Of(sparql::Variable{name}); };
    return MakeAtom(clause, any("s"), any("p"), any("o"), own);
  }

  Clauses ExpandBgp(const Algebra& node, const Scope& scope) {
    Clause clause;
    for (const sparql::TriplePattern& t : node.triples) {
      clause.atoms.push_back(MakeAtom(clause, t.subject, t.predicate, t.object, scope));
    }
    return {std::move(clause)};
  }

  // Sequences, alternatives and inverses become triple patterns with variables between them.
  absl::StatusOr<Clauses> ExpandPath(const Algebra& node, const Scope& scope) {
    if (!IsPlain(node.path) && paths_ == PathForm::kWhole) return Whole(node, scope);
    return PathClauses(node.path, node.subject, node.object, scope);
  }

  static bool IsPlain(const sparql::Path& path) {
    using Kind = sparql::Path::Kind;
    if (path.kind == Kind::kIri) return true;
    if (path.kind != Kind::kInverse && path.kind != Kind::kSequence && path.kind != Kind::kAlternative)
      return false;
    return std::all_of(path.children.begin(), path.children.end(), IsPlain);
  }

  absl::StatusOr<Clauses> PathClauses(const sparql::Path& path, const PatternTerm& from,
                                      const PatternTerm& to, const Scope& scope) {
    using Kind = sparql::Path::Kind;
    if (path.kind == Kind::kIri) {
      Clause clause;
      clause.atoms.push_back(MakeAtom(clause, from, PatternTerm::Of(path.iri), to, scope));
      return Clauses{std::move(clause)};
    }
    if (path.kind == Kind::kInverse) return PathClauses(path.children[0], to, from, scope);
    if (path.kind == Kind::kAlternative) {
      Clauses all;
      for (const sparql::Path& child : path.children) {
        auto one = PathClauses(child, from, to, scope);
        if (!one.ok()) return one;
        Append(all, *std::move(one));
      }
      return Checked(std::move(all));
    }
    if (path.kind != Kind::kSequence) return WithGap(path, from, to, scope);
    Clauses all = {Clause()};
    PatternTerm at = from;
    for (size_t i = 0; i < path.children.size(); ++i) {
      const bool last = i + 1 == path.children.size();
      PatternTerm next = last ? to : PatternTerm::Of(sparql::Variable{absl::StrCat(".way", ++fresh_)});
      auto one = PathClauses(path.children[i], at, next, scope);
      if (!one.ok()) return one;
      auto product = Cross(all, *one);
      if (!product.ok()) return product;
      all = *std::move(product);
      at = next;
    }
    return all;
  }

  // path* and path+ as described at PathForm::kWithGap, path? as nothing or one step.
  absl::StatusOr<Clauses> WithGap(const sparql::Path& path, const PatternTerm& from, const PatternTerm& to,
                                  const Scope& scope) {
    using Kind = sparql::Path::Kind;
    const auto part = [&](const sparql::Path& of, const PatternTerm& start, const PatternTerm& end) {
      Algebra node(Algebra::Kind::kPath);
      node.path = of;
      node.subject = start;
      node.object = end;
      Clauses whole = Whole(node, scope);
      whole[0].parts[0].beside_gap = path.kind != Kind::kNegatedSet;
      return whole;
    };
    if (path.kind == Kind::kNegatedSet) return part(path, from, to);
    auto all = PathClauses(path.children[0], from, to, scope);
    if (!all.ok()) return all;
    if (path.kind != Kind::kOneOrMore) Append(*all, part(path, from, to));
    if (path.kind == Kind::kZeroOrOne) return Checked(*std::move(all));
    sparql::Path any = path;
    any.kind = Kind::kZeroOrMore;
    const auto place = [&] { return PatternTerm::Of(sparql::Variable{absl::StrCat(".way", ++fresh_)}); };
    const PatternTerm before = place(), after = place();
    auto step = PathClauses(path.children[0], before, after, scope);
    if (!step.ok()) return step;
    auto joined = Cross(part(any, from, before), *step);
    if (joined.ok()) joined = Cross(*joined, part(any, after, to));
    if (!joined.ok()) return joined;
    Append(*all, *std::move(joined));
    return Checked(*std::move(all));
  }

  absl::StatusOr<Clauses> ExpandJoin(const Algebra& node, const Scope& scope) {
    Clauses all = {Clause()};
    for (const auto& child : node.children) {
      auto one = Expand(*child, scope);
      if (!one.ok()) return one;
      auto product = Cross(all, *one);
      if (!product.ok()) return product;
      all = *std::move(product);
    }
    return all;
  }

  absl::StatusOr<Clauses> ExpandUnion(const Algebra& node, const Scope& scope) {
    Clauses all;
    for (const auto& child : node.children) {
      auto one = Expand(*child, scope);
      if (!one.ok()) return one;
      Append(all, *std::move(one));
    }
    return Checked(std::move(all));
  }

  absl::StatusOr<Clauses> ExpandFilter(const Algebra& node, const Scope& scope) {
    // A filter of an inner group sees that group's variables only.
    std::set<std::string> visible;
    for (const sparql::Variable& v : sparql::InScopeVariables(*node.children[0])) visible.insert(v.name);
    if (&node != OutermostFilter(whole_, node) && MentionsOthers(*node.expression, visible)) {
      return Whole(node, scope);
    }
    auto all = Expand(*node.children[0], scope);
    if (!all.ok()) return all;
    return Filter(*std::move(all), *node.expression, scope, visible);
  }

  // `node` itself if only modifiers and filters are around it.
  static const Algebra* OutermostFilter(const Algebra& whole, const Algebra& node) {
    const Algebra* at = &whole;
    while (at != &node) {
      switch (at->kind) {
        case Algebra::Kind::kFilter:
        case Algebra::Kind::kProject:
        case Algebra::Kind::kDistinct:
        case Algebra::Kind::kReduced:
        case Algebra::Kind::kOrderBy:
          at = at->children[0].get();
          break;
        default:
          return nullptr;
      }
    }
    return at;
  }

  static bool MentionsOthers(const Expression& e, const std::set<std::string>& visible) {
    if (e.kind == Expression::Kind::kVariable) return !visible.contains(e.variable.name);
    return std::any_of(e.arguments.begin(), e.arguments.end(),
                       [&](const auto& argument) { return MentionsOthers(*argument, visible); });
  }

  absl::StatusOr<Clauses> Filter(Clauses all, const Expression& e, const Scope& scope,
                                 const std::set<std::string>& visible) {
    if (e.kind == Expression::Kind::kAnd) {
      for (const auto& argument : e.arguments) {
        auto one = Filter(std::move(all), *argument, scope, visible);
        if (!one.ok()) return one;
        all = *std::move(one);
      }
      return all;
    }
    const bool negated = e.kind == Expression::Kind::kNot;
    const Expression& inner = negated ? *e.arguments[0] : e;
    if (inner.kind == Expression::Kind::kExists || inner.kind == Expression::Kind::kNotExists) {
      const Scope local{absl::StrCat(".e", ++fresh_, "."), visible, &scope};
      const bool present = (inner.kind == Expression::Kind::kExists) != negated;
      auto pattern = present ? Expand(*inner.pattern, local) : ExpandAbsent(*inner.pattern, local);
      if (!pattern.ok()) return pattern;
      if (present) return Cross(all, *pattern);
      for (Clause& clause : all) clause.absences.push_back({*pattern, Share(*inner.pattern)});
      return all;
    }
    for (Clause& clause : all) {
      Test test{Renamed(e, scope), {}};
      for (const sparql::Variable& v : sparql::MentionedVariables(e)) {
        test.variables.push_back(Variable(clause, scope.NameOf(v.name), v.name));
      }
      clause.tests.push_back(std::move(test));
    }
    return all;
  }

  // Each match of the forbidden pattern must come once.
  absl::StatusOr<Clauses> ExpandAbsent(const Algebra& node, const Scope& scope) {
    const PathForm paths = std::exchange(paths_, PathForm::kWhole);
    auto clauses = Expand(node, scope);
    paths_ = paths;
    return clauses;
  }

  absl::StatusOr<Clauses> ExpandLeftJoin(const Algebra& node, const Scope& scope) {
    std::set<std::string> beside;
    MentionedBeside(whole_, &node, beside);
    std::set<std::string> left;
    for (const sparql::Variable& v : sparql::InScopeVariables(*node.children[0])) left.insert(v.name);
    for (const sparql::Variable& v : sparql::InScopeVariables(*node.children[1])) {
      if (!left.contains(v.name) && beside.contains(v.name) && !IsOnlyShown(v.name))
        return Whole(node, scope);
    }
    return Expand(*node.children[0], scope);
  }

  // True if only an outermost SELECT list uses the variable; MentionedBeside counts that as well.
  bool IsOnlyShown(const std::string& name) const {
    const Algebra& where = matching::WithoutModifiers(whole_);
    if (&where == &whole_) return false;
    std::set<std::string> names;
    const Algebra* inner = &where;
    // the OPTIONAL at the outside of the pattern
    while (inner->kind == Algebra::Kind::kFilter) {
      for (const sparql::Variable& v : sparql::MentionedVariables(*inner->expression)) names.insert(v.name);
      inner = inner->children[0].get();
    }
    return inner->kind == Algebra::Kind::kLeftJoin && !names.contains(name);
  }

  absl::StatusOr<Clauses> ExpandMinus(const Algebra& node, const Scope& scope) {
    auto all = Expand(*node.children[0], scope);
    if (!all.ok()) return all;
    std::set<std::string> left;
    for (const sparql::Variable& v : sparql::InScopeVariables(*node.children[0])) left.insert(v.name);
    const auto right = sparql::InScopeVariables(*node.children[1]);
    const bool shares = std::any_of(right.begin(), right.end(),
                                    [&](const sparql::Variable& v) { return left.contains(v.name); });
    if (!shares) return all;  // section 8.3.2: MINUS removes nothing
    const Scope local{absl::StrCat(".m", ++fresh_, "."), left, &scope};
    auto pattern = ExpandAbsent(*node.children[1], local);
    if (!pattern.ok()) return pattern;
    for (Clause& clause : *all) clause.absences.push_back({*pattern, Share(*node.children[1])});
    return all;
  }

  absl::StatusOr<Clauses> ExpandGraph(const Algebra& node, const Scope& scope) {
    const AtomTerm graph = graph_;
    const std::string name = graph_name_, written = graph_written_;
    if (node.name.IsVariable()) {
      graph_name_ = scope.NameOf(node.name.variable().name);
      graph_written_ = node.name.variable().name;
    } else {
      graph_name_.clear();
      graph_ = {dictionary_.Intern(node.name.term()), AtomTerm::kConstant};
    }
    auto all = Expand(*node.children[0], scope);
    if (all.ok() &&
        !sparql::NeedsTripleOfGraph(*node.children[0])) {  // a fact of the graph shows that it exists
      for (Clause& clause : *all) clause.atoms.push_back(AnyFact(clause));
    }
    graph_ = graph;
    graph_name_ = name;
    graph_written_ = written;
    return all;
  }

  absl::StatusOr<Clauses> ExpandExtend(const Algebra& node, const Scope& scope) {
    auto all = Expand(*node.children[0], scope);
    if (!all.ok()) return all;
    for (Clause& clause : *all) {
      Assignment assignment{Renamed(*node.expression, scope), {}, 0};
      for (const sparql::Variable& v : sparql::MentionedVariables(*node.expression)) {
        assignment.variables.push_back(Variable(clause, scope.NameOf(v.name), v.name));
      }
      assignment.variable = Variable(clause, scope.NameOf(node.variable.name), node.variable.name);
      clause.assignments.push_back(std::move(assignment));
    }
    return all;
  }

  Clauses ExpandValues(const Algebra& node, const Scope& scope) {
    Clause clause;
    Table table;
    for (const sparql::Variable& v : node.variables) {
      table.variables.push_back(Variable(clause, scope.NameOf(v.name), v.name));
    }
    for (const auto& row : node.rows) {
      std::vector<TermId>& ids = table.rows.emplace_back();
      for (const auto& term : row) ids.push_back(term ? dictionary_.Intern(*term) : TermId());
    }
    clause.tables.push_back(std::move(table));
    return {std::move(clause)};
  }

  // A sub-SELECT: variables that it does not project are local.
  absl::StatusOr<Clauses> ExpandProject(const Algebra& node, const Scope& scope) {
    if (&node == &whole_ || IsOutermost(node)) return Expand(*node.children[0], scope);
    std::set<std::string> shown;
    for (const sparql::Variable& v : node.variables) shown.insert(v.name);
    const Scope local{absl::StrCat(".s", ++fresh_, "."), shown, &scope};
    return Expand(*node.children[0], local);
  }

  bool IsOutermost(const Algebra& node) const {
    const Algebra* at = &whole_;
    while (at != &node) {
      if (at->kind != Algebra::Kind::kDistinct && at->kind != Algebra::Kind::kReduced &&
          at->kind != Algebra::Kind::kOrderBy && at->kind != Algebra::Kind::kProject)
        return false;
      at = at->children[0].get();
    }
    return true;
  }

  Clauses Whole(const Algebra& node, const Scope& scope) {
    Clause clause;
    Part part;
    for (const sparql::Variable& v : sparql::InScopeVariables(node)) {
      part.variables.push_back(Variable(clause, scope.NameOf(v.name), v.name));
    }
    sparql::AlgebraPtr pattern = node.Clone();
    // a step between two paths is a variable that the evaluator shows, under a unique name
    for (PatternTerm* end : {&pattern->subject, &pattern->object}) {
      if (!end->IsVariable() || !end->variable().IsHidden()) continue;
      end->Set(sparql::Variable{absl::StrCat("_", end->variable().name.substr(1), "_between_paths")});
    }
    part.pattern = std::move(pattern);
    part.graph = graph_;
    if (!graph_name_.empty()) part.graph = {TermId(), Variable(clause, graph_name_, graph_written_)};
    clause.parts.push_back(std::move(part));
    return {std::move(clause)};
  }

  static std::shared_ptr<const Algebra> Share(const Algebra& node) { return node.Clone(); }

  std::shared_ptr<const Expression> Renamed(const Expression& e, const Scope& scope) {
    sparql::ExpressionPtr copy = e.Clone();
    Rename(*copy, scope);
    return copy;
  }
  static void Rename(Expression& e, const Scope& scope) {
    if (e.kind == Expression::Kind::kVariable) e.variable.name = scope.NameOf(e.variable.name);
    for (const auto& argument : e.arguments) Rename(*argument, scope);
  }

  static absl::StatusOr<Clauses> Checked(Clauses clauses) {
    if (clauses.size() <= kMaxClauses) return clauses;
    return absl::ResourceExhaustedError(
        absl::StrCat("the pattern has more than ", kMaxClauses,
                     " alternatives; ask about one alternative of its UNIONs at a time"));
  }
  static absl::StatusOr<Clauses> Cross(const Clauses& a, const Clauses& b) {
    Clauses all;
    if (a.size() * b.size() > kMaxClauses) all.resize(kMaxClauses + 1);
    if (!all.empty()) return Checked(std::move(all));
    for (const Clause& left : a) {
      for (const Clause& right : b) all.push_back(Merge(left, right));
    }
    return all;
  }

  const Algebra& whole_;
  Dictionary& dictionary_;
  PathForm paths_;
  AtomTerm graph_;
  std::string graph_name_, graph_written_;  // GRAPH ?g
  int fresh_ = 0;
};

}  // namespace

sparql::AlgebraPtr InItsGraph(const Part& part, const Dictionary& dictionary, const std::string& graph_name) {
  const bool named = part.graph.variable >= 0;
  if (!named && part.graph.constant.IsNone()) return part.pattern->Clone();
  auto all = std::make_unique<Algebra>(Algebra::Kind::kGraph);
  all->name = named ? PatternTerm::Of(sparql::Variable{graph_name})
                    : PatternTerm::Of(dictionary.Decode(part.graph.constant));
  all->children.push_back(part.pattern->Clone());
  return all;
}

void MentionedBeside(const Algebra& node, const Algebra* except, std::set<std::string>& names) {
  if (&node == except) return;
  const auto add = [&names](const std::string& name) {
    if (!name.empty()) names.insert(name);
  };
  const auto term = [&add](const PatternTerm& t) {
    if (t.IsVariable()) add(t.variable().name);
  };
  for (const sparql::TriplePattern& triple : node.triples) {
    term(triple.subject);
    term(triple.predicate);
    term(triple.object);
  }
  term(node.subject);
  term(node.object);
  term(node.name);
  add(node.variable.name);
  for (const sparql::Variable& v : node.variables) add(v.name);
  ForEachExpression(node, [&](const Expression& e) {
    if (e.kind == Expression::Kind::kVariable) add(e.variable.name);
    if (e.pattern) MentionedBeside(*e.pattern, except, names);
  });
  for (const auto& child : node.children) MentionedBeside(*child, except, names);
}

int Clause::Find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

absl::StatusOr<std::vector<Clause>> ToClauses(const sparql::Algebra& where, Dictionary& dictionary,
                                              TermId default_graph, PathForm paths) {
  return Builder(where, dictionary, default_graph, paths).Expand(where, Scope());
}

}  // namespace docent::explain
