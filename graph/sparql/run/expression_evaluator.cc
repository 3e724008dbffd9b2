#include "graph/sparql/run/expression_evaluator.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <utility>

#include "graph/sparql/run/operators.h"
#include "graph/sparql/values/number.h"

namespace docent::sparql {

using Kind = Expression::Kind;

PlanExpression::PlanExpression() = default;
PlanExpression::~PlanExpression() = default;

namespace {

// Bytes of work that an operation counts as, so that a long expression looks at the clock however few rows it has.
constexpr size_t kWorkOfAnOperation = 32;
constexpr size_t kLongText = 4096;  // bytes; shorter texts are not counted one by one

// Bytes that a function makes of each byte of its arguments, with what it has on the way.
size_t MadeOfAByte(Builtin builtin) {
  switch (builtin) {
    case Builtin::kBnode:  // two digits, and a copy
      return 4;
    case Builtin::kEncodeForUri:
    case Builtin::kUcase:
    case Builtin::kLcase:
      return 3;
    case Builtin::kStrlen:
    case Builtin::kContains:
    case Builtin::kStrStarts:
    case Builtin::kStrEnds:
    case Builtin::kLangMatches:
    case Builtin::kRegex:
    case Builtin::kMd5:
    case Builtin::kSha1:
    case Builtin::kSha256:
    case Builtin::kSha384:
    case Builtin::kSha512:
      return 0;
    default:
      return 2;
  }
}

Value FromBool(std::optional<bool> value) {
  return value ? Value::Boolean(*value) : Value::Error();
}

// The operand, without a copy if it is a constant.
const Value& Operand(PlanExpression& e, const TermId* row, EvaluationContext& context, Value& scratch) {
  if (e.kind == Kind::kTerm) return e.constant;
  scratch = Evaluate(e, row, context);
  return scratch;
}

// kNone: the operand must be evaluated.
TermId IdOf(const PlanExpression& e, const TermId* row) {
  return e.kind == Kind::kVariable ? row[e.slot] : e.kind == Kind::kTerm ? e.constant.id() : TermId();
}

// Decides `=` by ids, without reading the terms, if possible: the same term (but not a literal, which may be
// NaN or invalid), or two different IRIs.
std::optional<bool> EqualByIds(const PlanExpression& a, const PlanExpression& b, const TermId* row) {
  const TermId x = IdOf(a, row), y = IdOf(b, row);
  if (x.IsIri() && y.IsIri()) return x == y;
  return std::nullopt;
}

// As EvaluationContext::Worked, for a comparison.
bool WorkedOn(const Value& a, const Value& b, EvaluationContext& context) {
  return context.Worked(std::min(a.text().size(), b.text().size()));
}

// The operand's number, if it is a constant or lies in the variable's id.
Number NumberOf(const PlanExpression& e, const TermId* row) {
  return e.kind == Kind::kVariable ? Number::Of(row[e.slot]) : Number::Of(e.constant);
}

// Compares two numbers that need no evaluation, the most common case; nullopt: one needs evaluation.
std::optional<std::partial_ordering> CompareByIds(const PlanExpression& a, const PlanExpression& b,
                                                  const TermId* row) {
  if (const auto order = CompareExact(IdOf(a, row), IdOf(b, row))) return *order;
  const Number x = NumberOf(a, row);
  if (x.IsNone()) return std::nullopt;
  const Number y = NumberOf(b, row);
  if (y.IsNone()) return std::nullopt;
  return Compare(x, y);
}

std::optional<bool> Equal(PlanExpression& a, PlanExpression& b, const TermId* row,
                          EvaluationContext& context) {
  if (const std::optional<bool> settled = EqualByIds(a, b, row)) return settled;
  if (const auto order = CompareByIds(a, b, row)) return *order == 0;
  Value x, y;
  const Value& left = Operand(a, row, context, x);
  const Value& right = Operand(b, row, context, y);
  if (!WorkedOn(left, right, context)) return std::nullopt;
  return ValuesEqual(left, right);
}

bool Holds(Kind kind, std::partial_ordering order) {
  switch (kind) {
    case Kind::kLess:
      return order < 0;
    case Kind::kGreater:
      return order > 0;
    case Kind::kLessOrEqual:
      return order <= 0;
    default:
      return order >= 0;
  }
}

std::optional<bool> Ordered(Kind kind, PlanExpression& a, PlanExpression& b, const TermId* row,
                            EvaluationContext& context) {
  if (const auto order = CompareByIds(a, b, row)) return Holds(kind, *order);
  Value x, y;
  bool unordered = false;
  const Value& left = Operand(a, row, context, x);
  const Value& right = Operand(b, row, context, y);
  if (!WorkedOn(left, right, context)) return std::nullopt;
  const std::optional<int> order = CompareValues(left, right, &unordered);
  if (unordered) return false;  // NaN is neither less nor greater
  if (!order) return std::nullopt;
  return Holds(kind, *order <=> 0);
}

// a = b || a = c …: true if one is, else an error if one comparison is an error
std::optional<bool> In(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  bool error = false;
  for (size_t i = 1; i < e.arguments.size(); ++i) {
    if (!context.Worked(kWorkOfAnOperation)) return std::nullopt;
    const std::optional<bool> equal = Equal(*e.arguments[0], *e.arguments[i], row, context);
    if (equal.value_or(false)) return true;
    error |= !equal.has_value();
  }
  if (error) return std::nullopt;
  return false;
}

// Section 17.2: an error beside a value that decides does not matter.
std::optional<bool> Connective(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  const bool deciding = e.kind == Kind::kOr;
  bool error = false;
  for (const PlanExpressionPtr& argument : e.arguments) {
    const std::optional<bool> value = EvaluateBoolean(*argument, row, context);
    if (!value) {
      error = true;
    } else if (*value == deciding) {
      return deciding;
    }
  }
  if (error) return std::nullopt;
  return !deciding;
}

bool Exists(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  if (!context.Worked(e.exists_base.size() * sizeof(TermId))) return false;
  for (size_t i = 0; i < e.exists_base.size(); ++i) e.exists_base[i] = row[i];
  e.exists_operator->Start(e.exists_base.data());
  return e.exists_operator->Next(e.exists_row.data()) && context.status.ok();
}

Value Negated(const Value& v) {
  if (v.IsExact()) {
    const Decimal negative{-v.decimal().mantissa, v.decimal().scale};
    return v.type() == Value::Type::kInteger ? Value::Integer(negative) : Value::OfDecimal(negative);
  }
  if (v.type() == Value::Type::kDouble) return Value::Double(-v.number());
  if (v.type() == Value::Type::kFloat) return Value::Float(-v.number());
  return Value::Error();
}

Value CallFunction(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  const FunctionEntry* entry = context.functions ? context.functions->Find(e.term.lexical) : nullptr;
  if (entry == nullptr) {  // the planner accepts casts only
    const Value value = Evaluate(*e.arguments[0], row, context);
    if (!context.Worked(value.text().size())) return Value::Error();
    if (value.text().size() > kLongText && !context.HasRoom(2 * value.text().size())) return Value::Error();
    return Cast(e.term.lexical, value).value_or(Value::Error());
  }
  MemoryPart texts = context.PartOfMemory();
  std::vector<Term> arguments;
  for (const PlanExpressionPtr& argument : e.arguments) {
    const Value value = Evaluate(*argument, row, context);
    if (value.IsError() || !context.Worked(value.text().size())) return Value::Error();
    const size_t text = value.text().size();
    if (text > kLongText && !texts.Add(3 * text) && !context.HasRoom(0)) return Value::Error();
    arguments.push_back(value.id().IsNone() ? value.ToTerm() : context.Decode(value.id()));
  }
  const absl::StatusOr<Term> result = entry->call(arguments);
  return result.ok() ? context.ValueOf(context.Encode(*result)) : Value::Error();
}

Value EvaluateBuiltin(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  switch (e.builtin) {
    case Builtin::kBound:
      return Value::Boolean(!row[e.arguments[0]->slot].IsNone());
    case Builtin::kIf: {
      const std::optional<bool> condition = EvaluateBoolean(*e.arguments[0], row, context);
      return condition ? Evaluate(*e.arguments[*condition ? 1 : 2], row, context) : Value::Error();
    }
    case Builtin::kCoalesce:
      for (const PlanExpressionPtr& argument : e.arguments) {
        Value value = Evaluate(*argument, row, context);
        if (!value.IsError()) return value;
      }
      return Value::Error();
    default: {
      if (e.values.size() != e.arguments.size()) {
        e.values.resize(e.arguments.size());
        for (size_t i = 0; i < e.values.size(); ++i) e.values[i] = e.arguments[i]->constant;
      }
      bool whole = true;
      size_t text = 0, held = 0;  // bytes of the arguments; of the long ones
      for (size_t i = 0; i < e.values.size() && whole; ++i) {
        if (e.arguments[i]->kind != Kind::kTerm) e.values[i] = Evaluate(*e.arguments[i], row, context);
        whole = !e.values[i].IsError();
        text += e.values[i].text().size();
        const size_t owned = e.arguments[i]->kind != Kind::kTerm ? e.values[i].owned_bytes() : 0;
        if (owned <= kLongText) continue;
        held += owned;
        whole = context.Charge(owned) && whole;
      }
      // No function except REPLACE, which counts for itself, makes more.
      const size_t made = text > kLongText ? MadeOfAByte(e.builtin) * text : 0;
      whole = context.Charge(made) && whole && context.Worked(text);
      Value result = whole ? CallBuiltin(e, e.values, context) : Value::Error();
      context.Release(held + made);
      if (held == 0) return result;
      for (size_t i = 0; i < e.values.size(); ++i) {
        if (e.arguments[i]->kind != Kind::kTerm) e.values[i] = Value();
      }
      return result;
    }
  }
}

}  // namespace

std::optional<bool> EvaluateBoolean(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  if (!context.Worked(kWorkOfAnOperation)) return std::nullopt;
  switch (e.kind) {
    case Kind::kOr:
    case Kind::kAnd:
      return Connective(e, row, context);
    case Kind::kNot: {
      const std::optional<bool> value = EvaluateBoolean(*e.arguments[0], row, context);
      if (!value) return std::nullopt;
      return !*value;
    }
    case Kind::kEqual:
      return Equal(*e.arguments[0], *e.arguments[1], row, context);
    case Kind::kNotEqual: {
      const std::optional<bool> equal = Equal(*e.arguments[0], *e.arguments[1], row, context);
      if (!equal) return std::nullopt;
      return !*equal;
    }
    case Kind::kLess:
    case Kind::kGreater:
    case Kind::kLessOrEqual:
    case Kind::kGreaterOrEqual:
      return Ordered(e.kind, *e.arguments[0], *e.arguments[1], row, context);
    case Kind::kIn:
      return In(e, row, context);
    case Kind::kNotIn: {
      const std::optional<bool> in = In(e, row, context);
      if (!in) return std::nullopt;
      return !*in;
    }
    case Kind::kBuiltin:
      if (e.builtin == Builtin::kContains || e.builtin == Builtin::kStrStarts ||
          e.builtin == Builtin::kStrEnds) {
        if (const std::optional<bool> holds = TestPlainTexts(e, row, context)) return holds;
      }
      return EffectiveBooleanValue(Evaluate(e, row, context));
    case Kind::kExists:
      return Exists(e, row, context);
    case Kind::kNotExists:
      return !Exists(e, row, context);
    default:
      return EffectiveBooleanValue(Evaluate(e, row, context));
  }
}

TermId EvaluateToId(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  if (e.kind == Kind::kVariable && row[e.slot] != kUnknownTerm) return row[e.slot];
  const Value value = Evaluate(e, row, context);
  return value.IsError() ? TermId() : context.Encode(value);
}

namespace {

Value OfVariable(const PlanExpression& e, const TermId* row, EvaluationContext& context) {
  const TermId id = row[e.slot];
  if (id.IsNone()) return Value::Error();
  Value value = context.ValueOf(id);
  if (id.tag() == TermId::Tag::kLocal && !context.Worked(value.text().size()))
    return Value::Error();  // it was copied
  return value;
}

Value OfArithmetic(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  Value x, y;
  const Value& a = Operand(*e.arguments[0], row, context, x);
  const Value& b = Operand(*e.arguments[1], row, context, y);
  return Compute(e.kind == Kind::kAdd        ? Arithmetic::kAdd
                 : e.kind == Kind::kSubtract ? Arithmetic::kSubtract
                 : e.kind == Kind::kMultiply ? Arithmetic::kMultiply
                                             : Arithmetic::kDivide,
                 a, b);
}

Value OfUnaryPlus(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  Value value = Evaluate(*e.arguments[0], row, context);
  return value.IsNumeric() ? value : Value::Error();
}

Value OfUnaryMinus(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  return Negated(Evaluate(*e.arguments[0], row, context));
}

Value OfBoolean(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  return FromBool(EvaluateBoolean(e, row, context));
}

}  // namespace

// A chain of operators nests as deep as it is long, so this has no variables of its own on the stack.
Value Evaluate(PlanExpression& e, const TermId* row, EvaluationContext& context) {
  if (e.kind == Kind::kVariable) return OfVariable(e, row, context);
  if (e.kind == Kind::kTerm) return e.constant;
  if (!context.Worked(kWorkOfAnOperation)) return Value::Error();
  switch (e.kind) {
    case Kind::kAdd:
    case Kind::kSubtract:
    case Kind::kMultiply:
    case Kind::kDivide:
      return OfArithmetic(e, row, context);
    case Kind::kUnaryPlus:
      return OfUnaryPlus(e, row, context);
    case Kind::kUnaryMinus:
      return OfUnaryMinus(e, row, context);
    case Kind::kBuiltin:
      return EvaluateBuiltin(e, row, context);
    case Kind::kFunction:
      return CallFunction(e, row, context);
    default:
      return OfBoolean(e, row, context);
  }
}

}  // namespace docent::sparql
