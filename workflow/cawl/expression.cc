#include "workflow/cawl/expression.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::cawl {
namespace {

constexpr char kQuote = '\'';
constexpr char kOperators[] = "write and, or and not in place of &&, || and !";

// Of another language.
bool HasOperator(std::string_view word) {
  for (const std::string_view sign : {"&&", "||", "&", "|", "!"}) {
    if (word == sign || (sign.size() == 2 && word.find(sign) != std::string_view::npos)) return true;
  }
  return false;
}

class Parser {
 public:
  Parser(const xml::Text& text, int max_nesting, xml::ElementReader* reader)
      : text_(text), nesting_left_(max_nesting), reader_(reader) {
    Advance();
  }

  std::optional<Expression> Whole() {
    std::optional<Expression> out = Sequence(Expression::Kind::kOr);
    if (out && !token_.empty()) {
      return Fail(token_ == ")" ? "a ) without its ("
                                : absl::StrCat("`and` or `or` is missing before ", std::string(token_)),
                  HasOperator(token_) ? kOperators : "");
    }
    return out;
  }

 private:
  bool IsWord(std::string_view word) const {
    return !quoted() && absl::AsciiStrToLower(ToAbsl(token_)) == std::string(word);
  }

  void Advance() {
    at_ = end_;
    while (at_ < text_.value.size() && absl::ascii_isspace(text_.value[at_])) ++at_;
    end_ = at_;
    if (at_ < text_.value.size() && (text_.value[at_] == '(' || text_.value[at_] == ')')) {
      ++end_;
    } else if (at_ < text_.value.size() && text_.value[at_] == kQuote) {
      SkipQuoted();
    } else {
      while (end_ < text_.value.size() && !absl::ascii_isspace(text_.value[end_]) &&
             text_.value[end_] != '(' && text_.value[end_] != ')') {
        ++end_;
      }
    }
    token_ = std::string_view(text_.value).substr(at_, end_ - at_);
  }

  bool quoted() const { return !token_.empty() && token_[0] == kQuote; }

  // Past the closing quote, or to the end.
  void SkipQuoted() {
    for (++end_; end_ < text_.value.size() && text_.value[end_] != kQuote; ++end_) {
      if (text_.value[end_] == '\\' && end_ + 1 < text_.value.size()) ++end_;
    }
    if (end_ < text_.value.size()) ++end_;
  }

  // What stands in the quotes of the token; nullopt: the closing one is missing.
  std::optional<std::string> Unquoted() const {
    std::string out;
    size_t i = 1;
    for (; i < token_.size() && token_[i] != kQuote; ++i) {
      if (token_[i] == '\\' && i + 1 < token_.size()) ++i;
      out += token_[i];
    }
    if (i >= token_.size()) return std::nullopt;
    return out;
  }

  std::optional<Expression> Fail(std::string message, std::string hint = "") {
    reader_->Error(reader_->Within(text_, at_, token_.size()), std::move(message), std::move(hint));
    return std::nullopt;
  }

  // kOr: conjunctions joined by "or"; kAnd: negations joined by "and".
  std::optional<Expression> Sequence(Expression::Kind kind) {
    bool is_or = kind == Expression::Kind::kOr;
    Expression out;
    out.kind = kind;
    for (;;) {
      std::optional<Expression> next = is_or ? Sequence(Expression::Kind::kAnd) : Negation();
      if (!next) return std::nullopt;
      out.children.push_back(std::move(*next));
      if (!IsWord(is_or ? "or" : "and")) break;
      Advance();
    }
    if (out.children.size() > 1) return out;
    Expression only = std::move(out.children[0]);
    return only;
  }

  std::optional<Expression> Negation() {
    if (token_.empty()) return Fail("the expression ends where a name is expected");
    if (IsWord("and") || IsWord("or") || token_ == ")") {
      return Fail(Concat("a name is expected instead of `", token_, "`"), "NAME, not NAME or ( … )");
    }
    if (IsWord("not") || token_ == "(") {
      if (nesting_left_ == 0) return Fail("the expression is nested deeper than the limit query_nesting");
      --nesting_left_;
      std::optional<Expression> out = IsWord("not") ? Not() : Parenthesised();
      ++nesting_left_;
      return out;
    }
    Expression name;
    name.name = token_;
    if (quoted()) {
      std::optional<std::string> text = Unquoted();
      if (!text) return Fail(Concat("the closing quote is missing after ", token_), "write 'NAME'");
      name.name = *std::move(text);
    }
    name.span = reader_->Within(text_, at_, token_.size());
    Advance();
    return name;
  }

  std::optional<Expression> Not() {
    Advance();
    std::optional<Expression> child = Negation();
    if (!child) return std::nullopt;
    Expression out;
    out.kind = Expression::Kind::kNot;
    out.children.push_back(std::move(*child));
    return out;
  }

  std::optional<Expression> Parenthesised() {
    Advance();
    std::optional<Expression> out = Sequence(Expression::Kind::kOr);
    if (!out) return std::nullopt;
    if (token_ != ")") {
      return Fail(token_.empty() ? "a ( without its )"
                                 : Concat("`and`, `or` or ) is expected instead of `", token_, "`"));
    }
    Advance();
    return out;
  }

  const xml::Text& text_;
  int nesting_left_;
  xml::ElementReader* reader_;
  size_t at_ = 0, end_ = 0;  // of the token
  std::string_view token_;   // empty: the end
};

int Strength(Expression::Kind kind) {
  switch (kind) {
    case Expression::Kind::kOr:
      return 0;
    case Expression::Kind::kAnd:
      return 1;
    case Expression::Kind::kNot:
      return 2;
    case Expression::Kind::kName:
      return 3;
  }
  return 3;
}

void Collect(const Expression& expression, std::vector<const Expression*>* out) {
  if (expression.kind == Expression::Kind::kName) out->push_back(&expression);
  for (const Expression& child : expression.children) Collect(child, out);
}

std::string NameText(const std::string& name) {
  const std::string lower = absl::AsciiStrToLower(name);
  const bool plain = !name.empty() && name[0] != kQuote && lower != "and" && lower != "or" &&
                     lower != "not" && std::none_of(name.begin(), name.end(), [](char c) {
                       return absl::ascii_isspace(c) || c == '(' || c == ')';
                     });
  if (plain) return name;
  std::string out(1, kQuote);
  for (const char c : name) {
    if (c == kQuote || c == '\\') out += '\\';
    out += c;
  }
  return out + kQuote;
}

}  // namespace

std::optional<Expression> ParseExpression(const xml::Text& text, int max_nesting,
                                          xml::ElementReader* reader) {
  return Parser(text, max_nesting, reader).Whole();
}

bool Evaluate(const Expression& expression, const std::function<bool(const std::string&)>& value_of) {
  switch (expression.kind) {
    case Expression::Kind::kName:
      return value_of(expression.name);
    case Expression::Kind::kNot:
      return !Evaluate(expression.children[0], value_of);
    case Expression::Kind::kAnd:
      for (const Expression& child : expression.children) {
        if (!Evaluate(child, value_of)) return false;
      }
      return true;
    case Expression::Kind::kOr:
      for (const Expression& child : expression.children) {
        if (Evaluate(child, value_of)) return true;
      }
      return false;
  }
  return false;
}

std::vector<const Expression*> NamesIn(const Expression& expression) {
  std::vector<const Expression*> out;
  Collect(expression, &out);
  return out;
}

xml::Advice AdviceOnName(const Expression& name, const std::vector<std::string>& known,
                         const std::string& otherwise, const xml::ElementReader& reader) {
  const std::string& word = name.name;
  const bool negated = word.size() > 1 && word[0] == '!';
  if (negated && std::find(known.begin(), known.end(), word.substr(1)) != known.end()) {
    const std::string right = NameText(word.substr(1));
    return xml::Advice(Concat("write not ", right), word, Concat("not ", right));
  }
  if (negated || HasOperator(word)) return kOperators;
  xml::Advice advice = reader.DidYouMean(word, known, otherwise);
  if (NameText(advice.wrong) != advice.wrong || NameText(advice.right) != advice.right) advice.right.clear();
  return advice;
}

std::string ToText(const Expression& expression) {
  if (expression.kind == Expression::Kind::kName) return NameText(expression.name);
  std::string out = expression.kind == Expression::Kind::kNot ? "not " : "";
  std::string_view between = expression.kind == Expression::Kind::kAnd ? " and " : " or ";
  for (size_t i = 0; i < expression.children.size(); ++i) {
    const Expression& child = expression.children[i];
    if (i > 0) out += between;
    bool weaker = Strength(child.kind) < Strength(expression.kind);
    out += weaker ? "(" + ToText(child) + ")" : ToText(child);
  }
  return out;
}

}  // namespace docent::cawl
