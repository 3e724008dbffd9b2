#include "workflow/cawl/assignment_reader.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/syntax/lexer.h"
#include "graph/sparql/syntax/parser.h"
#include "workflow/cawl/expression_advice.h"

namespace docent::cawl {
namespace {

// The column of an expression.
constexpr char kValue[] = "value";

Text Given(const xml::Element& element, std::string_view name, xml::ElementReader* reader) {
  const Text plain = reader->Attribute(element, name);
  return plain.given() ? plain : reader->Extension(element, name);
}

// A sub-SELECT hides the variables that it does not project: $name in it would be another one.
template <typename Visit>
void ForEachSubSelect(const sparql::Algebra& algebra, bool inside, const Visit& visit) {
  const bool is_select = algebra.kind == sparql::Algebra::Kind::kProject;
  if (is_select && inside) visit(algebra);
  if (algebra.expression != nullptr && algebra.expression->pattern != nullptr)
    ForEachSubSelect(*algebra.expression->pattern, true, visit);
  for (const sparql::AlgebraPtr& child : algebra.children)
    ForEachSubSelect(*child, inside || is_select, visit);
}

// Expressions of the algebra and of what stands in it, without those that another server evaluates.
template <typename Visit>
void ForEachOwnExpression(const sparql::Algebra& algebra, const Visit& visit) {
  if (algebra.kind == sparql::Algebra::Kind::kService) return;
  sparql::ForEachExpression(algebra, [&](const sparql::Expression& e) {
    visit(e);
    if (e.pattern != nullptr) ForEachOwnExpression(*e.pattern, visit);
  });
  for (const sparql::AlgebraPtr& child : algebra.children) ForEachOwnExpression(*child, visit);
}

bool HasOrder(const sparql::Algebra& algebra) {
  using Kind = sparql::Algebra::Kind;
  if (algebra.kind == Kind::kOrderBy) return true;
  const bool modifies = algebra.kind == Kind::kSlice || algebra.kind == Kind::kProject ||
                        algebra.kind == Kind::kDistinct || algebra.kind == Kind::kReduced ||
                        algebra.kind == Kind::kExtend;
  return modifies && !algebra.children.empty() && HasOrder(*algebra.children[0]);
}

class ComputationReader {
 public:
  ComputationReader(const xml::Element& element, const Limits& limits, xml::ElementReader* reader,
                    Computation* out)
      : element_(element), reader_(*reader), out_(*out) {
    options_.limits = limits;
    options_.prefixes = sparql::WellKnownPrefixes();
    for (const auto& [prefix, iri] : *element.namespaces) {
      if (prefix.empty()) continue;
      std::erase_if(options_.prefixes, [&](const auto& known) { return known.first == prefix; });
      options_.prefixes.emplace_back(prefix, iri);
    }
  }

  // `output`: what its value is called.
  void ReadExpression(const Text& expression, const Text& output) {
    out_.text = expression;
    const std::string& text = out_.text.value;
    is_expression_ = true;
    if (!Report(sparql::ParseExpression(text, options_).diagnostics)) return;
    ReadInputs(text);
    constexpr std::string_view kBefore = "SELECT ((";
    sparql::ParsedQuery parsed =
        sparql::ParseQuery(Concat(kBefore, text, "\n) AS ?", kValue, ") {}"), options_);
    if (!parsed.ok()) {
      reader_.Error(out_.text.span, Concat("SPARQL: ", parsed.diagnostics[0].message),
                    "write one expression, e.g. $n + 1");
      return;
    }
    out_.outputs.push_back(output);
    ReadCalls(*parsed.query.algebra, kBefore.size());
    ReadValues(*parsed.query.algebra, kBefore.size());
    out_.query = std::make_shared<const sparql::Query>(std::move(parsed.query));
  }

  // The element's text. `variable`: what its only column is called, where it is given.
  void ReadSelect(const Text& variable) {
    out_.text = element_.text;
    const std::string& text = out_.text.value;
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options_);
    if (!Report(parsed.diagnostics)) return;
    if (parsed.query.form != sparql::Query::Form::kSelect) {
      reader_.Error(element_.text.span, "the query of <assign> is no SELECT",
                    "its columns are the variables that are set");
      return;
    }
    ReadInputs(text);
    for (const sparql::Variable& column : parsed.query.projection) {
      if (std::find(out_.inputs.begin(), out_.inputs.end(), column.name) != out_.inputs.end())
        reader_.Error(element_.text.span, Concat("the SELECT gives $", column.name, ", which it also takes"),
                      "give the column another name: (… AS ?name)");
      out_.outputs.push_back({column.name, element_.text.span});
    }
    if (variable.given() && out_.outputs.size() != 1) {
      reader_.Error(variable.span, "variable needs a SELECT of one column",
                    "leave it out: the columns are variables of their names");
    } else if (variable.given()) {
      out_.outputs = {variable};
    }
    for (const Text& output : out_.outputs) {
      if (!xml::IsVariableName(output.value))
        reader_.Error(output.span, Concat("?", output.value, " cannot be a variable of the run"),
                      "use letters (a-z), digits and _, beginning with a letter");
    }
    CheckSubSelects(*parsed.query.algebra);
    out_.ordered = HasOrder(*parsed.query.algebra);
    ReadCalls(*parsed.query.algebra, 0);
    out_.query = std::make_shared<const sparql::Query>(std::move(parsed.query));
  }

 private:
  // The place of bytes of the query's text.
  SourceSpan PlaceOf(const SourceSpan& in_text) const {
    const std::vector<size_t>& offsets = element_.text_offsets;
    if (!element_.text.given() || offsets.empty())
      return reader_.Within(out_.text, in_text.offset, in_text.length);
    const size_t first = std::min(in_text.offset, offsets.size() - 1);
    const size_t end = first + in_text.length < offsets.size()
                           ? offsets[first + in_text.length]
                           : element_.text.span.offset + element_.text.span.length;
    return reader_.Span(offsets[first], end - offsets[first]);
  }

  // True if there is no error.
  bool Report(const Diagnostics& diagnostics) {
    for (const Diagnostic& d : diagnostics) {
      if (d.severity != Diagnostic::Severity::kError) continue;
      const ExpressionAdvice advice = AdviceOn(out_.text.value, d, is_expression_, element_.name == "input");
      reader_.Error(PlaceOf(advice.span), advice.message, advice.hint);
    }
    return !HasErrors(diagnostics);
  }

  // $name is a variable of the run, ?name one of the query.
  void ReadInputs(const std::string& text) {
    std::set<std::string> own, reported;
    sparql::Lexer lexer(text);
    std::vector<std::pair<std::string, SourceSpan>> taken;
    for (sparql::Token token = lexer.Next(); token.kind != sparql::TokenKind::kEnd; token = lexer.Next()) {
      if (token.kind == sparql::TokenKind::kError) break;
      if (token.kind != sparql::TokenKind::kVariable) continue;
      if (text[token.span.offset] == '$')
        taken.emplace_back(std::string(token.text), token.span);
      else
        own.insert(std::string(token.text));
    }
    for (const auto& [name, span] : taken) {
      if (own.contains(name) && reported.insert(name).second)
        reader_.Error(PlaceOf(span), Concat("$", name, " and ?", name, " stand in one query"),
                      "in SPARQL they are one variable; give the free one another name");
      if (std::find(out_.inputs.begin(), out_.inputs.end(), name) != out_.inputs.end()) continue;
      out_.inputs.push_back(name);
      out_.input_places.push_back(PlaceOf(span));
    }
  }

  // `before`: bytes that stand before the text in what was parsed.
  void ReadCalls(const sparql::Algebra& algebra, size_t before) {
    ForEachOwnExpression(algebra, [&](const sparql::Expression& e) {
      if (e.kind != sparql::Expression::Kind::kFunction) return;
      SourceSpan in_text = e.span;
      in_text.offset -= before;
      out_.calls.push_back({e.term.lexical, e.arguments.size(), PlaceOf(in_text)});
    });
  }

  // What stands outside of patterns, which ask the graph.
  void ReadValues(const sparql::Algebra& algebra, size_t before) {
    sparql::ForEachExpression(algebra, [&](const sparql::Expression& e) {
      if (e.kind != sparql::Expression::Kind::kVariable || e.span.offset < before ||
          e.span.offset - before >= out_.text.value.size() || out_.text.value[e.span.offset - before] != '?')
        return;
      SourceSpan in_text = e.span;
      in_text.offset -= before;
      out_.without_value.emplace_back(e.variable.name, PlaceOf(in_text));
    });
    if (algebra.expression != nullptr && algebra.expression->kind == sparql::Expression::Kind::kTerm)
      out_.constant = algebra.expression->term;
    for (const sparql::AlgebraPtr& child : algebra.children) ReadValues(*child, before);
  }

  void CheckSubSelects(const sparql::Algebra& algebra) {
    ForEachSubSelect(algebra, false, [&](const sparql::Algebra& select) {
      for (const sparql::Variable* used : sparql::VariablesInScope(*select.children[0])) {
        const bool is_input =
            std::find(out_.inputs.begin(), out_.inputs.end(), used->name) != out_.inputs.end();
        const bool projected =
            std::find(select.variables.begin(), select.variables.end(), *used) != select.variables.end();
        if (is_input && !projected)
          reader_.Error(element_.text.span,
                        Concat("a SELECT inside uses $", used->name, " and does not give it"),
                        Concat("write $", used->name,
                               " in its projection, too: without that, it is another variable there"));
      }
    });
  }

  const xml::Element& element_;
  xml::ElementReader& reader_;
  Computation& out_;
  sparql::ParseOptions options_;
  bool is_expression_ = false;
};

void ReadNone(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const Text none = Given(element, "none", reader);
  const Text otherwise = Given(element, "default", reader);
  if (none.given() && otherwise.given())
    reader->Error(none.span, "<assign> has either none or default", "take one of them away");
  out->otherwise_text = otherwise;
  if (otherwise.given()) out->otherwise = reader->TermOf(element, otherwise);
  out->may_be_none = none.value == "unset";
  if (none.given() && !out->may_be_none && none.value != "fail")
    reader->Error(
        none.span, Concat("none is \"", none.value, "\""),
        "write fail (the node fails), unset (the variable has no value then), or default=\"…\" instead");
}

}  // namespace

void ReadAssignment(const xml::Element& element, const Limits& limits, xml::ElementReader* reader,
                    Action* out) {
  const std::vector<std::string> known = {"at", "variable", "expression", "none", "default"};
  reader->CheckAttributes(element, known, known);
  for (const auto& child : element.children) {
    if (child->name != "documentation" && !reader->IsForeign(*child))
      reader->UnknownChild(element, *child, {});
  }
  ReadNone(element, reader, out);
  const Text expression = Given(element, "expression", reader);
  const Text variable = Given(element, "variable", reader);
  if (expression.given() == element.text.given()) {
    reader->Error(element.name_span, "<assign> needs either a SELECT as its text or an expression",
                  "write <ext:assign>SELECT ?x WHERE { … }</ext:assign> or <ext:assign variable=\"x\" "
                  "expression=\"…\"/>");
    return;
  }
  if (variable.given() && !xml::IsVariableName(variable.value)) {
    reader->Error(variable.span, Concat("\"", variable.value, "\" is not a variable's name"),
                  "write it without $: letters (a-z), digits and _, beginning with a letter");
    return;
  }
  ComputationReader computation(element, limits, reader, &out->computed);
  if (!expression.given()) {
    computation.ReadSelect(variable);
  } else if (variable.given()) {
    computation.ReadExpression(expression, variable);
  } else {
    reader->Error(element.name_span, "<assign> with an expression needs the attribute variable");
  }
}

void ReadExpression(const xml::Element& element, const Text& expression, const Text& output,
                    const Limits& limits, xml::ElementReader* reader, Computation* out) {
  ComputationReader(element, limits, reader, out).ReadExpression(expression, output);
}

}  // namespace docent::cawl
