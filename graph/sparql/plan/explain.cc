// Query plan as text for people: `docent query --explain`.
#include <cstdio>
#include <string>
#include <string_view>

#include "graph/sparql/plan/planner.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::sparql {
namespace {

constexpr size_t kShown = 160;  // bytes of an expression that are shown

// The text on one line, truncated if it is long.
std::string Short(std::string_view text) {
  std::string out = OnOneLine(text);
  if (out.size() <= kShown) return out;
  size_t end = kShown;
  while ((static_cast<unsigned char>(out[end]) & 0xC0) == 0x80) --end;  // whole code points
  return out.substr(0, end) + "…";
}

std::string Rounded(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, value < 10 ? "%.2g" : "%.0f", value);
  return buffer;
}

class Explainer {
 public:
  explicit Explainer(bool measured) : measured_(measured) { display_ = {WellKnownPrefixes(), false}; }

  void Node(const PlanNode& node, int depth) {
    static constexpr const char* kNames[] = {
        "patterns", "join (loop)",  "join (hash)",  "optional (loop)", "optional (hash)", "filter",
        "union",    "minus (loop)", "minus (hash)", "graph",           "extend",          "values",
        "group",    "order",        "project",      "distinct",        "slice",           "path"};
    Line(depth, kNames[static_cast<size_t>(node.kind)] + Details(node), node.estimate);
    if (measured_) {
      out_ += " | " + std::to_string(node.rows_made) + " rows";
      if (node.starts > 1) out_ += " in " + std::to_string(node.starts) + " starts";
      out_ += ", " + Rounded(node.seconds * 1000) + " ms";
    }
    out_ += '\n';
    for (const PlanPattern& p : node.patterns) {
      Line(depth + 1, PrintTriple(*p.source, display_), p.estimate);
      if (measured_)
        out_ += " | " + std::to_string(p.rows) + " rows" + (p.hashed ? ", by hash" : ", by index");
      out_ += '\n';
    }
    for (const PlanExpressionPtr& filter : node.filters) {
      out_ += std::string(static_cast<size_t>(depth + 1) * 2, ' ') + "if " + Text(*filter->source) + '\n';
    }
    for (const PlanNodePtr& child : node.children) Node(*child, depth + 1);
    for (const PlanExpressionPtr& filter : node.filters) Exists(*filter, depth + 1);
    if (node.expression) Exists(*node.expression, depth + 1);
  }
  std::string Take() { return std::move(out_); }

 private:
  std::string Text(const Expression& e) const { return Short(PrintExpression(e, display_)); }
  std::string Details(const PlanNode& node) const {
    std::string text;
    if (node.kind == PlanNode::Kind::kExtend) {
      text = " ?" + node.source->variable.name + " := " + Text(*node.source->expression);
    } else if (node.kind == PlanNode::Kind::kPath) {
      const std::string group = PrintPattern(*node.source, display_);
      text = " " + Short(group.substr(1, group.rfind('}') - 1));
    }
    if (!node.filters.empty()) {
      const size_t n = node.filters.size();
      text += ", " + std::to_string(n) + (n == 1 ? " condition" : " conditions");
    }
    if (node.kind == PlanNode::Kind::kOrderBy && node.limit) text += ", first " + std::to_string(*node.limit);
    return text;
  }
  void Line(int depth, const std::string& text, double estimate) {
    out_ += std::string(static_cast<size_t>(depth) * 2, ' ') + text + "  ~" + Rounded(estimate) + " rows";
  }
  void Exists(const PlanExpression& e, int depth) {
    for (const PlanExpressionPtr& argument : e.arguments) Exists(*argument, depth);
    if (!e.exists) return;
    out_ += std::string(static_cast<size_t>(depth) * 2, ' ') +
            (e.kind == Expression::Kind::kNotExists ? "not exists\n" : "exists\n");
    Node(*e.exists, depth + 1);
  }

  bool measured_;
  PrintOptions display_;
  std::string out_;
};

}  // namespace

std::string ExplainPlan(const PlanNode& node, bool measured) {
  Explainer explainer(measured);
  explainer.Node(node, 0);
  return explainer.Take();
}

}  // namespace docent::sparql
