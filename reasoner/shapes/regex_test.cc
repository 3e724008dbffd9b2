#include "reasoner/shapes/regex_test.h"

#include <utility>

namespace docent::shapes {
namespace {

using sparql::Expression;
using sparql::ExpressionPtr;

ExpressionPtr Constant(const Term& term) {
  auto e = std::make_unique<Expression>(Expression::Kind::kTerm, SourceSpan{});
  e->term = term;
  return e;
}

ExpressionPtr Call(sparql::Builtin builtin, std::vector<ExpressionPtr> arguments) {
  auto e = std::make_unique<Expression>(Expression::Kind::kBuiltin, SourceSpan{});
  e->builtin = builtin;
  e->arguments = std::move(arguments);
  return e;
}

ExpressionPtr Regex(ExpressionPtr text, const Term& pattern, const Term& flags) {
  std::vector<ExpressionPtr> arguments;
  arguments.push_back(std::move(text));
  arguments.push_back(Constant(pattern));
  arguments.push_back(Constant(flags));
  return Call(sparql::Builtin::kRegex, std::move(arguments));
}

ExpressionPtr TextOfVariable() {
  auto variable = std::make_unique<Expression>(Expression::Kind::kVariable, SourceSpan{});
  variable->variable = {"value"};
  std::vector<ExpressionPtr> arguments;
  arguments.push_back(std::move(variable));
  return Call(sparql::Builtin::kStr, std::move(arguments));
}

}  // namespace

RegexTest::RegexTest(const Term& pattern, const Term& flags, const Dictionary& dictionary) {
  sparql::RunOptions run;
  run.version = &empty_;
  auto probe = sparql::PreparedExpression::Prepare(*Regex(Constant(Term::Literal("")), pattern, flags), {},
                                                   dictionary);
  if (!probe.ok()) return;
  auto answer = (*probe)->Evaluate(run, {});
  if (!answer.ok() || !answer->has_value()) return;
  auto expression =
      sparql::PreparedExpression::Prepare(*Regex(TextOfVariable(), pattern, flags), {"value"}, dictionary);
  if (!expression.ok()) return;
  expression_ = *std::move(expression);
  valid_ = true;
}

bool RegexTest::Matches(TermId value) {
  sparql::RunOptions run;
  run.version = &empty_;
  auto answer = expression_->Test(run, {&value, 1});
  return answer.ok() && *answer;
}

}  // namespace docent::shapes
