// Functions on terms and numbers, and functions that make new terms (SPARQL 1.1 sections 17.4.2 and 17.4.4).
#include <cmath>
#include <cstdio>

#include "graph/rdf/iri.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/values/text.h"
#include "graph/store/read_trace.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

// fn:round of a float or double: half toward positive infinity; results of zero from below are negative zero
double RoundHalfUp(double x) {
  const double floor = std::floor(x);
  return std::copysign(x - floor >= 0.5 ? floor + 1 : floor, x);
}

Value Rounded(Builtin builtin, const Value& v) {
  if (v.IsExact()) {
    Decimal d = v.decimal();
    switch (builtin) {
      case Builtin::kAbs:
        d.mantissa = d.mantissa < 0 ? -d.mantissa : d.mantissa;
        break;
      case Builtin::kCeil:
        d = d.Ceiling();
        break;
      case Builtin::kFloor:
        d = d.Floor();
        break;
      default:
        d = d.Round();
        break;
    }
    return v.type() == Type::kInteger ? Value::Integer(d) : Value::OfDecimal(d);
  }
  if (!v.IsNumeric()) return Value::Error();
  const double x = v.number();
  const double y = builtin == Builtin::kAbs     ? std::abs(x)
                   : builtin == Builtin::kCeil  ? std::ceil(x)
                   : builtin == Builtin::kFloor ? std::floor(x)
                                                : RoundHalfUp(x);
  return v.type() == Type::kFloat ? Value::Float(y) : Value::Double(y);
}

// Version 4 (random) of RFC 4122, from the seed of the run
std::string Uuid(EvaluationContext& context) {
  const uint64_t high = (context.Random() & ~uint64_t{0xF000}) | 0x4000;
  const uint64_t low = (context.Random() >> 2) | (uint64_t{1} << 63);
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%08x-%04x-%04x-%04x-%012llx", static_cast<unsigned>(high >> 32),
                static_cast<unsigned>(high >> 16 & 0xFFFF), static_cast<unsigned>(high & 0xFFFF),
                static_cast<unsigned>(low >> 48), static_cast<unsigned long long>(low & 0xFFFFFFFFFFFFull));
  return buffer;
}

// The IRI of an argument of IRI(), which may be relative to the query's base.
Value MakeIri(const Value& v, EvaluationContext& context) {
  if (v.type() == Type::kIri) return v;
  if (v.type() != Type::kString) return Value::Error();
  if (!IsAbsoluteIri(v.text()) && context.base_iri.empty()) return Value::Error();
  std::string iri = ResolveIri(v.text(), context.base_iri);
  return IsValidTermIri(iri) ? Value::Iri(std::move(iri)) : Value::Error();
}

Value StrOf(const Value& v, EvaluationContext& context) {
  if (v.type() == Type::kBlank) return Value::Error();
  std::string scratch;
  return Value::String(std::string(context.LexicalOf(v, &scratch)));
}

Value DatatypeOf(const Value& v, EvaluationContext& context) {
  if (!v.IsLiteral()) return Value::Error();
  const TermId id = v.id();
  if (!id.IsNone() && v.type() != Type::kLangString) {
    const Term term = context.Decode(id);  // a type derived from xsd:integer keeps its name
    return Value::Iri(term.datatype.empty() ? std::string(kXsdString) : term.datatype);
  }
  return Value::Iri(std::string(v.DatatypeIri()));
}

Value NewBlank(const std::vector<Value>& arguments, EvaluationContext& context) {
  // Runs with different seeds never share a label, because an update may store it.
  std::string label = "q" + std::to_string(context.seed) + "x";
  if (arguments.empty()) {
    label += "r" + std::to_string(context.Random());
  } else {
    if (arguments[0].type() != Type::kString) return Value::Error();
    label += std::to_string(context.row_number) + "x";
    static constexpr char kHex[] = "0123456789abcdef";
    for (const char c : arguments[0].text()) {
      label.push_back(kHex[static_cast<unsigned char>(c) >> 4]);
      label.push_back(kHex[static_cast<unsigned char>(c) & 15]);
    }
  }
  return Value::Blank(label);
}

Value WithDatatype(const Value& text, const Value& datatype, EvaluationContext& context) {
  if (text.type() != Type::kString || datatype.type() != Type::kIri || datatype.text() == kRdfLangString) {
    return Value::Error();
  }
  return context.ValueOf(
      context.Encode(Term::Literal(std::string(text.text()), std::string(datatype.text()))));
}

Value WithLanguage(const Value& text, const Value& language) {
  if (text.type() != Type::kString || language.type() != Type::kString) return Value::Error();
  std::string tag(language.text());
  return IsLanguageTag(tag) ? Value::LangString(std::string(text.text()), std::move(tag)) : Value::Error();
}

}  // namespace

Value CallTermBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context) {
  const auto& a = arguments;
  switch (e.builtin) {
    case Builtin::kStr:
      return StrOf(a[0], context);
    case Builtin::kLang:
      if (!a[0].IsLiteral()) return Value::Error();
      return Value::String(a[0].type() == Type::kLangString ? std::string(a[0].language()) : "");
    case Builtin::kDatatype:
      return DatatypeOf(a[0], context);
    case Builtin::kIri:
      return MakeIri(a[0], context);
    case Builtin::kBnode:
      return NewBlank(a, context);
    case Builtin::kRand:
      return Value::Double(static_cast<double>(context.Random() >> 11) * 0x1p-53);
    case Builtin::kAbs:
    case Builtin::kCeil:
    case Builtin::kFloor:
    case Builtin::kRound:
      return Rounded(e.builtin, a[0]);
    case Builtin::kUuid:
      return Value::Iri("urn:uuid:" + Uuid(context));
    case Builtin::kStrUuid:
      return Value::String(Uuid(context));
    case Builtin::kStrLang:
      return WithLanguage(a[0], a[1]);
    case Builtin::kStrDt:
      return WithDatatype(a[0], a[1], context);
    case Builtin::kSameTerm:
      return Value::Boolean(context.Encode(a[0]) == context.Encode(a[1]));
    case Builtin::kIsIri:
      return Value::Boolean(a[0].type() == Type::kIri);
    case Builtin::kIsBlank:
      return Value::Boolean(a[0].type() == Type::kBlank);
    case Builtin::kIsLiteral:
      return Value::Boolean(a[0].IsLiteral());
    case Builtin::kIsNumeric:
      return Value::Boolean(a[0].IsNumeric());
    default:
      return Value::Error();
  }
}

Value CallBuiltin(PlanExpression& e, const std::vector<Value>& arguments, EvaluationContext& context) {
  switch (e.builtin) {
    case Builtin::kLangMatches:
    case Builtin::kConcat:
    case Builtin::kStrlen:
    case Builtin::kUcase:
    case Builtin::kLcase:
    case Builtin::kEncodeForUri:
    case Builtin::kContains:
    case Builtin::kStrStarts:
    case Builtin::kStrEnds:
    case Builtin::kStrBefore:
    case Builtin::kStrAfter:
    case Builtin::kSubstr:
      return CallStringBuiltin(e, arguments, context);
    case Builtin::kYear:
    case Builtin::kMonth:
    case Builtin::kDay:
    case Builtin::kHours:
    case Builtin::kMinutes:
    case Builtin::kSeconds:
    case Builtin::kTimezone:
    case Builtin::kTz:
      return CallTimeBuiltin(e.builtin, arguments[0]);
    case Builtin::kNow:
      ReadTrace::NoteAnything();
      return Value::DateTime(context.now_us);
    case Builtin::kMd5:
    case Builtin::kSha1:
    case Builtin::kSha256:
    case Builtin::kSha384:
    case Builtin::kSha512:
      return CallHashBuiltin(e.builtin, arguments[0]);
    case Builtin::kRegex:
    case Builtin::kReplace:
      return CallRegexBuiltin(e, arguments, context);
    default:
      return CallTermBuiltin(e, arguments, context);
  }
}

}  // namespace docent::sparql
