#include "graph/sparql/syntax/algebra_printer.h"

#include <algorithm>
#include <map>
#include <set>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/builtins.h"

namespace docent::sparql {

using Kind = Algebra::Kind;

namespace {

bool IsPlainLocalName(std::string_view name) {
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool digit = c >= '0' && c <= '9';
    if (!letter && !digit && !(c == '-' && i > 0)) return false;
  }
  return true;
}

class Printer {
 public:
  explicit Printer(const PrintOptions& options) : options_(options) {}

  const std::set<std::string>& used() const { return used_; }

  std::string Iri(const std::string& iri) {
    for (const auto& [prefix, ns] : options_.prefixes) {
      if (iri.size() < ns.size() || iri.compare(0, ns.size(), ns) != 0) continue;
      const std::string_view local = std::string_view(iri).substr(ns.size());
      if (!IsPlainLocalName(local)) continue;
      used_.insert(prefix);
      return Concat(prefix, ":", local);
    }
    return ToNTriples(docent::Term::Iri(iri));
  }

  std::string TermText(const Term& t) {
    if (t.IsIri()) return Iri(t.lexical);
    if (t.IsBlank()) return t.lexical[0] == '.' ? "_:anon" + t.lexical.substr(1) : "_:" + t.lexical;
    const bool number = t.datatype == kXsdInteger || t.datatype == kXsdDecimal || t.datatype == kXsdDouble;
    if (number && IsNumberToken(t.lexical, t.datatype)) return t.lexical;
    if (t.datatype == kXsdBoolean && (t.lexical == "true" || t.lexical == "false")) return t.lexical;
    if (t.datatype.empty() || !t.language.empty()) return ToNTriples(t);
    return ToNTriples(docent::Term::Literal(t.lexical)) + "^^" + Iri(t.datatype);
  }

  // Prints a blank node of one basic graph pattern as a blank node; other hidden variables (steps of paths,
  // aggregates, blank nodes that path translation spread over several patterns) as ?_name.
  std::string VariableText(const Variable& v) {
    if (!v.IsHidden()) return "?" + v.name;
    if (v.name.starts_with(".b") && !spread_.contains(v.name)) {
      return v.name.starts_with(".b.") ? "_:anon" + v.name.substr(3) : "_:" + v.name.substr(2);
    }
    std::string name = "?_" + v.name.substr(1);
    for (char& c : name) {
      if (c == '.' || c == '-') c = '_';
    }
    return name;
  }

  // Call it before printing: finds the hidden variables that occur in more than one basic graph pattern.
  void Scan(const Algebra& a) {
    const auto note = [&](const PatternTerm& t) {
      if (!t.IsVariable() || !t.variable().IsHidden()) return;
      const auto [it, added] = home_.emplace(t.variable().name, &a);
      if (!added && it->second != &a) spread_.insert(t.variable().name);
    };
    for (const TriplePattern& t : a.triples) {
      for (const PatternTerm* term : {&t.subject, &t.predicate, &t.object}) note(*term);
    }
    note(a.subject);
    note(a.object);
    if (a.expression) Scan(*a.expression);
    for (const AlgebraPtr& child : a.children) Scan(*child);
  }
  void Scan(const Expression& e) {
    for (const ExpressionPtr& argument : e.arguments) Scan(*argument);
    if (e.pattern) Scan(*e.pattern);
  }

  std::string Text(const PatternTerm& t) {
    return t.IsVariable() ? VariableText(t.variable()) : TermText(t.term());
  }

  std::string Triple(const TriplePattern& t) {
    const bool type = !t.predicate.IsVariable() && t.predicate.term().lexical == kRdfType;
    return Concat(Text(t.subject), " ", type ? "a" : Text(t.predicate), " ", Text(t.object));
  }

  std::string PathText(const Path& p) {
    const auto list = [&](std::string_view separator) {
      std::string out = "(";
      for (size_t i = 0; i < p.children.size(); ++i)
        out += (i ? std::string(separator) : "") + PathText(p.children[i]);
      return out + ")";
    };
    switch (p.kind) {
      case Path::Kind::kIri:
        return Iri(p.iri.lexical);
      case Path::Kind::kInverse:
        return "^" + PathText(p.children[0]);
      case Path::Kind::kSequence:
        return list("/");
      case Path::Kind::kAlternative:
        return list("|");
      case Path::Kind::kZeroOrMore:
        return "(" + PathText(p.children[0]) + ")*";
      case Path::Kind::kOneOrMore:
        return "(" + PathText(p.children[0]) + ")+";
      case Path::Kind::kZeroOrOne:
        return "(" + PathText(p.children[0]) + ")?";
      case Path::Kind::kNegatedSet:
        return "!" + list("|");
    }
    return "";
  }

  std::string Expr(const Expression& e, const std::vector<Aggregate>* aggregates = nullptr);
  std::string AggregateText(const Aggregate& a);
  // The condition of a FILTER: in parentheses unless it has its own or is a call.
  std::string Condition(const Expression& e, int depth) {
    depth_ = depth;
    const std::string text = Expr(e);
    const bool bare = e.kind == Expression::Kind::kVariable || e.kind == Expression::Kind::kTerm;
    return bare ? "(" + text + ")" : text;
  }
  // The elements of a group, each line indented.
  std::string Elements(const Algebra& a, int depth);
  std::string Group(const Algebra& a, int depth);
  // As Elements, in a group of its own if later elements would change its meaning (a filter) or could not
  // follow it (a sub-SELECT).
  std::string Part(const Algebra& a, int depth);
  std::string Select(const Algebra& a, int depth, bool is_select);

 private:
  static std::string Indent(int depth) { return std::string(static_cast<size_t>(depth) * 2, ' '); }
  static bool IsNumberToken(const std::string& text, const std::string& datatype) {
    size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    if (i >= text.size()) return false;
    bool point = false, exponent = false, digits = false;
    for (; i < text.size(); ++i) {
      const char c = text[i];
      if (c >= '0' && c <= '9') {
        digits = true;
      } else if (c == '.' && !point && !exponent && i + 1 < text.size() && text[i + 1] >= '0' &&
                 text[i + 1] <= '9') {
        point = true;
      } else if ((c == 'e' || c == 'E') && digits && !exponent && i + 1 < text.size()) {
        exponent = true;
        if ((text[i + 1] == '-' || text[i + 1] == '+') && i + 2 < text.size()) ++i;
      } else {
        return false;
      }
    }
    if (datatype == kXsdInteger) return !point && !exponent;
    if (datatype == kXsdDecimal) return point && !exponent;
    return exponent;
  }

  const PrintOptions& options_;
  std::set<std::string> used_;
  std::map<std::string, const Algebra*> home_;
  std::set<std::string> spread_;
  int depth_ = 0;  // of the element whose expression is being printed
};

std::string Printer::AggregateText(const Aggregate& a) {
  std::string out = Concat(NameOf(a.function), "(", a.distinct ? "DISTINCT " : "");
  out += a.expression ? Expr(*a.expression) : "*";
  if (a.function == Aggregate::Function::kGroupConcat && a.separator != " ") {
    out += " ; SEPARATOR = " + ToNTriples(docent::Term::Literal(a.separator));
  }
  return out + ")";
}

std::string Printer::Expr(const Expression& e, const std::vector<Aggregate>* aggregates) {
  using E = Expression::Kind;
  const auto sub = [&](size_t i) { return Expr(*e.arguments[i], aggregates); };
  const auto list = [&](size_t from, std::string_view separator) {
    std::string out;
    for (size_t i = from; i < e.arguments.size(); ++i)
      out += (i > from ? std::string(separator) : "") + sub(i);
    return out;
  };
  const auto binary = [&](std::string_view op) { return Concat("(", sub(0), " ", op, " ", sub(1), ")"); };
  switch (e.kind) {
    case E::kVariable:
      for (size_t i = 0; aggregates && i < aggregates->size(); ++i) {
        if ((*aggregates)[i].result == e.variable) return AggregateText((*aggregates)[i]);
      }
      return VariableText(e.variable);
    case E::kTerm:
      return TermText(e.term);
    case E::kOr:
      return "(" + list(0, " || ") + ")";
    case E::kAnd:
      return "(" + list(0, " && ") + ")";
    case E::kNot:
      return "(! " + sub(0) + ")";
    case E::kEqual:
      return binary("=");
    case E::kNotEqual:
      return binary("!=");
    case E::kLess:
      return binary("<");
    case E::kGreater:
      return binary(">");
    case E::kLessOrEqual:
      return binary("<=");
    case E::kGreaterOrEqual:
      return binary(">=");
    case E::kIn:
      return "(" + sub(0) + " IN (" + list(1, ", ") + "))";
    case E::kNotIn:
      return "(" + sub(0) + " NOT IN (" + list(1, ", ") + "))";
    case E::kAdd:
      return binary("+");
    case E::kSubtract:
      return binary("-");
    case E::kMultiply:
      return binary("*");
    case E::kDivide:
      return binary("/");
    case E::kUnaryPlus:
      return "(+ " + sub(0) + ")";
    case E::kUnaryMinus:
      return "(- " + sub(0) + ")";
    case E::kBuiltin:
      return Concat(NameOf(e.builtin), "(", list(0, ", "), ")");
    case E::kFunction:
      return Iri(e.term.lexical) + "(" + list(0, ", ") + ")";
    case E::kExists:
      return "EXISTS " + Group(*e.pattern, depth_);
    case E::kNotExists:
      return "NOT EXISTS " + Group(*e.pattern, depth_);
  }
  return "";
}

std::string Printer::Group(const Algebra& a, int depth) {
  return "{\n" + Elements(a, depth + 1) + Indent(depth) + "}";
}

std::string Printer::Part(const Algebra& a, int depth) {
  switch (a.kind) {
    case Kind::kFilter:
    case Kind::kGroup:
    case Kind::kOrderBy:
    case Kind::kProject:
    case Kind::kDistinct:
    case Kind::kReduced:
    case Kind::kSlice:
      return Indent(depth) + Group(a, depth) + "\n";
    default:
      return Elements(a, depth);
  }
}

std::string Printer::Elements(const Algebra& a, int depth) {
  const std::string in = Indent(depth);
  switch (a.kind) {
    case Kind::kBgp: {
      std::string out;
      for (const TriplePattern& t : a.triples) out += in + Triple(t) + " .\n";
      return out;
    }
    case Kind::kPath:
      return in + Text(a.subject) + " " + PathText(a.path) + " " + Text(a.object) + " .\n";
    case Kind::kJoin: {
      std::string out;
      bool open = false;  // further triples would continue the last ones, over paths between them
      for (const AlgebraPtr& child : a.children) {
        const bool bgp = child->kind == Kind::kBgp;
        const bool beside = bgp || child->kind == Kind::kPath || child->kind == Kind::kGraph ||
                            child->kind == Kind::kService || child->kind == Kind::kUnion ||
                            child->kind == Kind::kValues || child == a.children[0];
        const bool group = !beside || (bgp && (open || child->triples.empty()));
        out += group ? in + Group(*child, depth) + "\n" : Part(*child, depth);
        if (child->kind != Kind::kPath) open = bgp && !group;
      }
      return out;
    }
    case Kind::kLeftJoin: {
      const std::string left = Part(*a.children[0], depth);
      // Otherwise its own filter would become the condition of the OPTIONAL.
      const bool alone = a.children[1]->kind != Kind::kFilter && !a.expression;
      std::string right = alone ? Elements(*a.children[1], depth + 1) : Part(*a.children[1], depth + 1);
      if (a.expression) right += in + "  FILTER " + Condition(*a.expression, depth + 1) + "\n";
      return left + in + "OPTIONAL {\n" + right + in + "}\n";
    }
    case Kind::kFilter: {
      return Part(*a.children[0], depth) + in + "FILTER " + Condition(*a.expression, depth) + "\n";
    }
    case Kind::kUnion: {
      std::string out = in;
      for (size_t i = 0; i < a.children.size(); ++i)
        out += (i ? " UNION " : "") + Group(*a.children[i], depth);
      return out + "\n";
    }
    case Kind::kMinus: {
      const std::string left = Part(*a.children[0], depth);
      return left + in + "MINUS " + Group(*a.children[1], depth) + "\n";
    }
    case Kind::kGraph:
      return in + "GRAPH " + Text(a.name) + " " + Group(*a.children[0], depth) + "\n";
    case Kind::kService:
      return in + "SERVICE " + (a.silent ? "SILENT " : "") + Text(a.name) + " " +
             Group(*a.children[0], depth) + "\n";
    case Kind::kExtend: {
      const std::string left = Part(*a.children[0], depth);
      depth_ = depth;
      return left + in + "BIND (" + Expr(*a.expression) + " AS " + VariableText(a.variable) + ")\n";
    }
    case Kind::kValues: {
      std::string out = in + "VALUES (";
      for (size_t i = 0; i < a.variables.size(); ++i) out += (i ? " " : "") + VariableText(a.variables[i]);
      out += ") {\n";
      for (const auto& row : a.rows) {
        out += in + "  (";
        for (size_t i = 0; i < row.size(); ++i)
          out += (i ? " " : "") + (row[i] ? TermText(*row[i]) : "UNDEF");
        out += ")\n";
      }
      return out + in + "}\n";
    }
    default:
      return Select(a, depth, true);
  }
}

// SELECT … WHERE { … } modifiers, from the modifier operators at the top of `a`. Not `is_select` (ASK,
// CONSTRUCT): WHERE and the modifiers; a SELECT at the top is then the only sub-SELECT of the group.
std::string Printer::Select(const Algebra& a, int depth, bool is_select) {
  const std::string in = Indent(depth);
  const Algebra* at = &a;
  std::string tail, head = "SELECT ", order, having, values;
  std::vector<const Algebra*> extends;
  std::vector<Variable> variables;
  const auto is_sub_select = [](const Algebra& node) {
    return node.kind == Kind::kProject || node.kind == Kind::kDistinct || node.kind == Kind::kReduced;
  };
  if (at->kind == Kind::kSlice && (is_select || !is_sub_select(*at->children[0]))) {
    if (at->limit) tail += " LIMIT " + std::to_string(*at->limit);
    if (at->offset > 0) tail += " OFFSET " + std::to_string(at->offset);
    at = at->children[0].get();
  }
  if (is_select && (at->kind == Kind::kDistinct || at->kind == Kind::kReduced)) {
    head += at->kind == Kind::kDistinct ? "DISTINCT " : "REDUCED ";
    at = at->children[0].get();
  }
  if (is_select && at->kind == Kind::kProject) {
    variables = at->variables;
    at = at->children[0].get();
  }
  const Algebra* ordered = nullptr;
  if (at->kind == Kind::kOrderBy) {
    ordered = at;
    at = at->children[0].get();
  }
  // (expression AS ?v) of SELECT and a BIND at the end of WHERE are the same; over a group only the first is
  // possible.
  const Algebra* below = at;
  while (below->kind == Kind::kExtend || below->kind == Kind::kFilter ||
         (below->kind == Kind::kJoin && below->children[0]->kind == Kind::kGroup)) {
    below = below->children[0].get();
  }
  const std::vector<Aggregate>* aggregates = nullptr;
  std::string group;
  if (below->kind == Kind::kGroup) {
    aggregates = &below->aggregates;
    for (; at != below; at = at->children[0].get()) {
      if (at->kind == Kind::kExtend) extends.push_back(at);
      if (at->kind == Kind::kFilter) having = " (" + Expr(*at->expression, aggregates) + ")" + having;
      if (at->kind == Kind::kJoin) values = Elements(*at->children[1], depth);
    }
    for (const GroupKey& key : below->group_keys) {
      const bool plain =
          key.expression->kind == Expression::Kind::kVariable && key.expression->variable == key.variable;
      group += plain ? " " + VariableText(key.variable)
               : key.variable.IsHidden()
                   ? " (" + Expr(*key.expression) + ")"
                   : " (" + Expr(*key.expression) + " AS " + VariableText(key.variable) + ")";
    }
    if (!group.empty()) group = " GROUP BY" + group;
    if (!having.empty()) having = " HAVING" + having;
    at = below->children[0].get();
  }
  if (ordered != nullptr) {
    order = " ORDER BY";
    for (const OrderCondition& o : ordered->order) {
      order += Concat(o.descending ? " DESC(" : " ASC(", Expr(*o.expression, aggregates), ")");
    }
  }
  if (is_select) {
    if (variables.empty()) head += "*";
    for (const Variable& v : variables) {
      const auto it =
          std::find_if(extends.begin(), extends.end(), [&](const Algebra* e) { return e->variable == v; });
      head += it == extends.end()
                  ? VariableText(v) + " "
                  : "(" + Expr(*(*it)->expression, aggregates) + " AS " + VariableText(v) + ") ";
    }
    if (head.back() != ' ') head += ' ';
  }
  std::string out = in + (is_select ? head : "") + "WHERE " + Group(*at, depth);
  out += group + having + order + tail + "\n";
  if (!values.empty()) out += values;
  return out;
}

}  // namespace

std::string PrintQuery(const Query& query, const PrintOptions& options) {
  Printer printer(options);
  printer.Scan(*query.algebra);
  std::string body;
  std::string dataset;
  for (const Term& g : query.from) dataset += "FROM " + printer.TermText(g) + "\n";
  for (const Term& g : query.from_named) dataset += "FROM NAMED " + printer.TermText(g) + "\n";
  const std::string where = printer.Select(*query.algebra, 0, query.form == Query::Form::kSelect);
  switch (query.form) {
    case Query::Form::kAsk:
      // ASK { … } without modifiers is written without WHERE.
      body = dataset.empty() && where.starts_with("WHERE ") ? "ASK " + where.substr(6)
                                                            : "ASK\n" + dataset + where;
      break;
    case Query::Form::kSelect: {
      const size_t at = where.find("WHERE {");
      body = dataset.empty() || at == std::string::npos
                 ? where
                 : where.substr(0, at) + "\n" + dataset + where.substr(at);
      break;
    }
    case Query::Form::kConstruct:
      body = "CONSTRUCT {\n";
      for (const TriplePattern& t : query.construct_template) body += "  " + printer.Triple(t) + " .\n";
      body += "}\n" + dataset + where;
      break;
    case Query::Form::kDescribe:
      body = "DESCRIBE";
      for (const PatternTerm& t : query.describe) body += " " + printer.Text(t);
      body += "\n" + dataset + where;
      break;
  }
  std::string head;
  if (options.declare_prefixes) {
    for (const auto& [prefix, iri] : options.prefixes) {
      if (printer.used().contains(prefix)) head += "PREFIX " + prefix + ": <" + iri + ">\n";
    }
  }
  return head + body;
}

std::string PrintPattern(const Algebra& algebra, const PrintOptions& options) {
  Printer printer(options);
  printer.Scan(algebra);
  return printer.Group(algebra, 0);
}

std::string PrintExpression(const Expression& expression, const PrintOptions& options) {
  Printer printer(options);
  printer.Scan(expression);
  return printer.Expr(expression);
}

std::string PrintTriple(const TriplePattern& triple, const PrintOptions& options) {
  return Printer(options).Triple(triple);
}

std::string OnOneLine(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n' || c == '\t';
    if (!space) {
      out += c;
    } else if (!out.empty() && out.back() != ' ') {
      out += ' ';
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace docent::sparql
