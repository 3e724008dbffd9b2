// PrintAlgebra: the tree as an S-expression on one line.
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/builtins.h"

namespace docent::sparql {

using Kind = Algebra::Kind;

namespace {

std::string NameOf(const Variable& v) {
  return "?" + v.name;
}

std::string Children(const Algebra& a) {
  std::string out;
  for (const AlgebraPtr& child : a.children) out += " " + PrintAlgebra(*child);
  return out;
}

std::string NameList(const std::vector<Variable>& variables) {
  std::string out = "(";
  for (size_t i = 0; i < variables.size(); ++i) out += (i ? " " : "") + NameOf(variables[i]);
  return out + ")";
}

// The expression, with EXISTS as its algebra.
std::string Text(const Expression& e) {
  if (e.kind == Expression::Kind::kExists) return "(exists " + PrintAlgebra(*e.pattern) + ")";
  if (e.kind == Expression::Kind::kNotExists) return "(notexists " + PrintAlgebra(*e.pattern) + ")";
  if (e.kind == Expression::Kind::kVariable) return NameOf(e.variable);
  if (e.kind == Expression::Kind::kAnd || e.kind == Expression::Kind::kOr) {
    std::string out = e.kind == Expression::Kind::kAnd ? "(&&" : "(||";
    for (const ExpressionPtr& argument : e.arguments) out += " " + Text(*argument);
    return out + ")";
  }
  return PrintExpression(e);
}

}  // namespace

std::string PrintAlgebra(const Algebra& a) {
  switch (a.kind) {
    case Kind::kBgp: {
      std::string out = "(bgp";
      for (const TriplePattern& t : a.triples) out += " (" + PrintTriple(t) + ")";
      return out + ")";
    }
    case Kind::kPath: {
      std::string text = PrintPattern(a);
      text = text.substr(4, text.find(" .\n") - 4);  // "{\n  s path o .\n}"
      return "(path " + text + ")";
    }
    case Kind::kJoin:
      return "(join" + Children(a) + ")";
    case Kind::kLeftJoin:
      return "(leftjoin" + Children(a) + (a.expression ? " " + Text(*a.expression) : "") + ")";
    case Kind::kFilter:
      return "(filter " + Text(*a.expression) + Children(a) + ")";
    case Kind::kUnion:
      return "(union" + Children(a) + ")";
    case Kind::kMinus:
      return "(minus" + Children(a) + ")";
    case Kind::kGraph:
      return "(graph " + (a.name.IsVariable() ? NameOf(a.name.variable()) : ToNTriples(a.name.term())) +
             Children(a) + ")";
    case Kind::kService:
      return std::string("(service") + (a.silent ? " silent" : "") + Children(a) + ")";
    case Kind::kExtend:
      return "(extend " + NameOf(a.variable) + " " + Text(*a.expression) + Children(a) + ")";
    case Kind::kValues: {
      std::string out = "(table " + NameList(a.variables);
      for (const auto& row : a.rows) {
        out += " (row";
        for (const auto& term : row) out += " " + (term ? ToNTriples(*term) : std::string("UNDEF"));
        out += ")";
      }
      return out + ")";
    }
    case Kind::kGroup: {
      std::string out = "(group (";
      for (const GroupKey& key : a.group_keys)
        out += "(" + NameOf(key.variable) + " " + Text(*key.expression) + ")";
      out += ")";
      for (const Aggregate& aggregate : a.aggregates) {
        out += " (" + NameOf(aggregate.result) + " (" + std::string(NameOf(aggregate.function)) +
               (aggregate.distinct ? " distinct" : "") +
               (aggregate.expression ? " " + Text(*aggregate.expression) : " *") + "))";
      }
      return out + Children(a) + ")";
    }
    case Kind::kOrderBy: {
      std::string out = "(order (";
      for (const OrderCondition& o : a.order)
        out += (o.descending ? "(desc " : "(asc ") + Text(*o.expression) + ")";
      return out + ")" + Children(a) + ")";
    }
    case Kind::kProject:
      return "(project " + NameList(a.variables) + Children(a) + ")";
    case Kind::kDistinct:
      return "(distinct" + Children(a) + ")";
    case Kind::kReduced:
      return "(reduced" + Children(a) + ")";
    case Kind::kSlice:
      return "(slice " + std::to_string(a.offset) + " " + (a.limit ? std::to_string(*a.limit) : "_") +
             Children(a) + ")";
  }
  return "";
}

}  // namespace docent::sparql
