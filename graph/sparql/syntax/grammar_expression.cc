#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/builtins.h"
#include "graph/sparql/syntax/grammar.h"
#include "graph/sparql/syntax/regex_arguments.h"
#include "graph/sparql/values/function_registry.h"

namespace docent::sparql {

using Kind = Expression::Kind;

ExpressionPtr Grammar::Binary(Kind kind, ExpressionPtr left, ExpressionPtr right) {
  auto e = NewExpression(kind, left->span);
  if (right->span.offset >= left->span.offset) {
    e->span.length = right->span.offset + right->span.length - left->span.offset;
  }
  if (!CountElement(e->span)) return nullptr;
  e->arguments.push_back(std::move(left));
  e->arguments.push_back(std::move(right));
  return e;
}

// Expression ::= And ('||' And)*; the operands are siblings, so a long chain is not deep.
ExpressionPtr Grammar::ParseExpression() {
  Nested nested(this);
  if (!nested.ok()) return nullptr;
  ExpressionPtr first = AndExpression();
  if (!first || !At("||")) return first;
  auto e = NewExpression(Kind::kOr, first->span);
  e->arguments.push_back(std::move(first));
  while (Accept("||")) {
    ExpressionPtr next = AndExpression();
    if (!next || !CountListElement()) return nullptr;
    e->arguments.push_back(std::move(next));
  }
  return e;
}

ExpressionPtr Grammar::AndExpression() {
  ExpressionPtr first = RelationalExpression();
  if (!first || !At("&&")) return first;
  auto e = NewExpression(Kind::kAnd, first->span);
  e->arguments.push_back(std::move(first));
  while (Accept("&&")) {
    ExpressionPtr next = RelationalExpression();
    if (!next || !CountListElement()) return nullptr;
    e->arguments.push_back(std::move(next));
  }
  return e;
}

ExpressionPtr Grammar::RelationalExpression() {
  ExpressionPtr left = AdditiveExpression();
  if (!left) return nullptr;
  static constexpr std::pair<std::string_view, Kind> kOperators[] = {
      {"=", Kind::kEqual},   {"!=", Kind::kNotEqual},    {"<", Kind::kLess},
      {">", Kind::kGreater}, {"<=", Kind::kLessOrEqual}, {">=", Kind::kGreaterOrEqual},
  };
  for (const auto& [text, kind] : kOperators) {
    if (!Accept(text)) continue;
    ExpressionPtr right = AdditiveExpression();
    return right ? Binary(kind, std::move(left), std::move(right)) : nullptr;
  }
  const bool negated = AtWord("NOT") && AtWord("IN", 1);
  if (!negated && !AtWord("IN")) return left;
  if (negated) Take();
  Take();
  auto e = NewExpression(negated ? Kind::kNotIn : Kind::kIn, left->span);
  e->arguments.push_back(std::move(left));
  return ArgumentList(&e->arguments, nullptr) ? std::move(e) : nullptr;
}

ExpressionPtr Grammar::AdditiveExpression() {
  ExpressionPtr left = MultiplicativeExpression();
  while (left && (At("+") || At("-"))) {
    const Kind kind = Take().text == "+" ? Kind::kAdd : Kind::kSubtract;
    ExpressionPtr right = MultiplicativeExpression();
    if (!right) return nullptr;
    left = Binary(kind, std::move(left), std::move(right));
  }
  return left;
}

ExpressionPtr Grammar::MultiplicativeExpression() {
  ExpressionPtr left = UnaryExpression();
  while (left && (At("*") || At("/"))) {
    const Kind kind = Take().text == "*" ? Kind::kMultiply : Kind::kDivide;
    ExpressionPtr right = UnaryExpression();
    if (!right) return nullptr;
    left = Binary(kind, std::move(left), std::move(right));
  }
  return left;
}

ExpressionPtr Grammar::UnaryExpression() {
  const Token& token = Peek();
  const bool sign = token.Is("-") || token.Is("+");
  if (sign) {  // a sign directly before a number is part of the literal
    const Token& next = Peek(1);
    const bool number = next.kind == TokenKind::kInteger || next.kind == TokenKind::kDecimal ||
                        next.kind == TokenKind::kDouble;
    if (number && next.span.offset == Peek().span.offset + 1) return PrimaryExpression();
  }
  if (!sign && !token.Is("!")) return PrimaryExpression();
  Nested nested(this);
  if (!nested.ok()) return nullptr;
  const Token op = Take();
  const Kind kind = op.text == "!" ? Kind::kNot : op.text == "-" ? Kind::kUnaryMinus : Kind::kUnaryPlus;
  auto e = NewExpression(kind, op.span);
  // The grammar allows one sign before a primary; "!!a" and "--a" are read, too.
  ExpressionPtr inner = UnaryExpression();
  if (!inner) return nullptr;
  e->arguments.push_back(std::move(inner));
  return e;
}

ExpressionPtr Grammar::PrimaryExpression() {
  const Token& token = Peek();
  switch (token.kind) {
    case TokenKind::kVariable: {
      auto e = NewExpression(Kind::kVariable, token.span);
      e->variable = Variable{std::string(Take().text)};
      return e;
    }
    case TokenKind::kIri:
    case TokenKind::kPrefixedName:
      return IriOrFunction();
    case TokenKind::kWord:
      if (!token.IsWord("true") && !token.IsWord("false")) return BuiltinCall();
      break;
    case TokenKind::kPunctuation:
      if (token.Is("(")) return BracketedExpression();
      if (!token.Is("+") && !token.Is("-")) {
        Expected("an expression");
        return nullptr;
      }
      break;
    default:
      break;
  }
  const SourceSpan span = token.span;
  std::optional<Term> term = GroundTerm();
  if (!term) return nullptr;
  auto e = NewExpression(Kind::kTerm, span);
  e->term = *std::move(term);
  return e;
}

ExpressionPtr Grammar::BracketedExpression() {
  if (!Expect("(", "before an expression")) return nullptr;
  ExpressionPtr e = ParseExpression();
  if (!e || !Expect(")", "to close the expression")) return nullptr;
  return e;
}

ExpressionPtr Grammar::BuiltinCall() {
  const Token word = Peek();
  if (word.IsWord("EXISTS")) {
    Take();
    return ExistsCall(false);
  }
  if (word.IsWord("NOT") && AtWord("EXISTS", 1)) {
    Take();
    Take();
    return ExistsCall(true);
  }
  if (const auto aggregate = FindAggregate(word.text)) return AggregateCall(*aggregate);
  const BuiltinInfo* info = FindBuiltin(word.text);
  if (info == nullptr && word.IsWord("NOT")) {
    Error(word.span, Concat("'", word.text, "' is only allowed before EXISTS and IN"),
          "the opposite of an expression is written with '!'");
    return nullptr;
  }
  if (info == nullptr) {
    const std::string near = Nearest(word.text, BuiltinNames());
    Error(word.span, Concat("'", word.text, "' is not a function of SPARQL"),
          near.empty() ? "a variable begins with '?', a name needs a prefix and ':'"
                       : "did you mean " + near + "?");
    return nullptr;
  }
  Take();
  auto e = NewExpression(Kind::kBuiltin, word.span);
  e->builtin = info->builtin;
  if (!ArgumentList(&e->arguments, nullptr)) return nullptr;
  const int count = static_cast<int>(e->arguments.size());
  if (count < info->min_arguments || count > info->max_arguments) {
    Error(word.span, std::string(info->name) + " takes " + std::to_string(info->min_arguments) +
                         (info->max_arguments > info->min_arguments ? " or more" : "") + " arguments, not " +
                         std::to_string(count));
    return nullptr;
  }
  if (info->builtin == Builtin::kBound && e->arguments[0]->kind != Kind::kVariable) {
    Error(word.span, "BOUND takes a variable");
    return nullptr;
  }
  if (options_.check_patterns && !in_service_ && Look()) {  // an expression may take milliseconds
    if (auto mistake = FindRegexMistake(*e, text_)) {
      Error(mistake->span, std::move(mistake->message), std::move(mistake->hint));
    }
  }
  return e;
}

ExpressionPtr Grammar::ExistsCall(bool negated) {
  auto e = NewExpression(negated ? Kind::kNotExists : Kind::kExists, Peek().span);
  e->pattern = GroupGraphPattern();
  return e->pattern ? std::move(e) : nullptr;
}

ExpressionPtr Grammar::AggregateCall(Aggregate::Function function) {
  const Token word = Take();
  if (aggregates_ == nullptr || in_aggregate_) {
    Error(word.span,
          in_aggregate_ ? "an aggregate is not allowed inside another"
                        : Concat(word.text, " is not allowed here"),
          "aggregates are allowed in SELECT, HAVING and ORDER BY");
    return nullptr;
  }
  Charge(2 * sizeof(Aggregate));
  Aggregate a;
  a.function = function;
  a.span = word.span;
  if (!Expect("(", "after the aggregate")) return nullptr;
  a.distinct = AcceptWord("DISTINCT");
  if (function == Aggregate::Function::kCount && Accept("*")) {
    a.expression = nullptr;
  } else {
    in_aggregate_ = true;
    a.expression = ParseExpression();
    in_aggregate_ = false;
    if (!a.expression) return nullptr;
  }
  if (function == Aggregate::Function::kGroupConcat && Accept(";")) {
    if (!ExpectWord("SEPARATOR", "in GROUP_CONCAT") || !Expect("=", "after SEPARATOR")) return nullptr;
    std::optional<std::string> separator = String();
    if (!separator) return nullptr;
    a.separator = *std::move(separator);
  }
  if (!Expect(")", "to close the aggregate")) return nullptr;
  a.result = Variable{".a" + std::to_string(counter_++)};
  auto e = NewExpression(Kind::kVariable, word.span);
  e->variable = a.result;
  aggregates_->push_back(std::move(a));
  return e;
}

ExpressionPtr Grammar::IriOrFunction() {
  const SourceSpan span = Peek().span;
  std::optional<Term> iri = Iri();
  if (!iri) return nullptr;
  const bool call = At("(");
  auto e = NewExpression(call ? Kind::kFunction : Kind::kTerm, span);
  e->term = *std::move(iri);
  if (!call) return e;
  bool distinct = false;
  if (!ArgumentList(&e->arguments, &distinct)) return nullptr;
  if (distinct) {
    Error(span, "DISTINCT in a call of <" + e->term.lexical + ">: no function with that IRI is an aggregate");
    return nullptr;
  }
  if (options_.functions == nullptr || in_service_) return e;
  if (const auto mistake = FindCallMistake(options_.functions, e->term.lexical, e->arguments.size())) {
    Error(span, mistake->message, mistake->hint);
  }
  return e;
}

bool Grammar::ArgumentList(std::vector<ExpressionPtr>* out, bool* distinct) {
  if (!Expect("(", "before the arguments")) return false;
  Nested nested(this);
  if (!nested.ok()) return false;
  if (distinct != nullptr) *distinct = AcceptWord("DISTINCT");
  if (Accept(")")) return true;
  do {
    ExpressionPtr argument = ParseExpression();
    if (!argument || !CountListElement()) return false;
    out->push_back(std::move(argument));
  } while (Accept(","));
  return Expect(")", "to close the arguments");
}

ExpressionPtr Grammar::Constraint() {
  const Token& token = Peek();
  if (token.Is("(")) return BracketedExpression();
  if (token.kind == TokenKind::kWord) return BuiltinCall();
  if (token.kind == TokenKind::kIri || token.kind == TokenKind::kPrefixedName) {
    ExpressionPtr e = IriOrFunction();
    if (e && e->kind != Kind::kFunction) {
      Error(e->span, "an IRI is not a condition", "call it as a function, or write (?x = <iri>)");
      return nullptr;
    }
    return e;
  }
  Expected("'(' or a function", "write a condition in parentheses: FILTER (?x > 5)");
  return nullptr;
}

}  // namespace docent::sparql
