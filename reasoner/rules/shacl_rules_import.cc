#include "reasoner/rules/shacl_rules_import.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "graph/sparql/syntax/parser.h"
#include "reasoner/matching/trigger_analysis.h"
#include "reasoner/rules/rule_parser.h"

namespace docent::rules {
namespace {

constexpr std::string_view kShNs = "http://www.w3.org/ns/shacl#";

void GiveOwnName(sparql::Variable& variable) {
  if (variable.name != "this" && !variable.name.empty())
    variable.name = absl::StrReplaceAll(absl::StrCat("target_", variable.name), {{".", "_"}});
}

// Renames all variables but ?this.
void GiveOwnNames(sparql::Algebra& node) {
  const auto rename = [](sparql::PatternTerm& term) {
    if (!term.IsVariable()) return;
    sparql::Variable variable = term.variable();
    GiveOwnName(variable);
    term.Set(std::move(variable));
  };
  for (sparql::TriplePattern& triple : node.triples) {
    for (sparql::PatternTerm* term : {&triple.subject, &triple.predicate, &triple.object}) rename(*term);
  }
  for (sparql::PatternTerm* term : {&node.subject, &node.object, &node.name}) rename(*term);
  GiveOwnName(node.variable);
  for (sparql::Variable& variable : node.variables) GiveOwnName(variable);
  sparql::ForEachExpression(node, [](sparql::Expression& e) {
    if (e.kind == sparql::Expression::Kind::kVariable) GiveOwnName(e.variable);
    if (e.pattern) GiveOwnNames(*e.pattern);
  });
  for (const sparql::AlgebraPtr& child : node.children) GiveOwnNames(*child);
}

class Importer {
 public:
  Importer(const LocatedRdf& document, std::string_view source, std::string_view file,
           const sparql::FunctionRegistry* functions)
      : source_(source), file_(file), functions_(functions) {
    for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
      const TermQuad& q = document.rdf.quads[i];
      values_[{Key(q.subject), q.predicate.lexical}].push_back(q.object);
      places_.try_emplace({Key(q.subject), q.predicate.lexical, Key(q.object)}, document.places[i].object);
    }
  }

  ImportedRules Run() {
    for (const auto& [key, rules] : values_) {
      if (key.second != Sh("rule")) continue;
      shape_ = key.first;
      if (IsTrue(Values(shape_, Sh("deactivated")))) continue;
      for (const Term& rule : rules) {
        place_ = PlaceOf(shape_, Sh("rule"), Key(rule));
        Import(Key(rule));
      }
    }
    Write();
    if (by_class_.line > 0) {
      result_.diagnostics.push_back(
          {file_, by_class_,
           "a target class means its explicit instances here, those of its subclasses only where inferred",
           "put rdfs or owl2rl in use, too, if there are subclasses", Diagnostic::Severity::kWarning});
    }
    return std::move(result_);
  }

 private:
  // A rule in the made rule document.
  struct Made {
    std::string name, head, target, where;
    size_t construct = 0;  // in ImportedRules::constructs
    // in the text: of the whole rule, and of the part without the target
    size_t begin = 0, target_begin = 0, target_end = 0, end = 0;
  };

  static std::string Sh(std::string_view local) {
    return absl::StrCat(std::string(kShNs), std::string(local));
  }
  static std::string Key(const Term& t) { return t.IsBlank() ? "_:" + t.lexical : t.lexical; }
  static bool IsTrue(const std::vector<Term>& values) {
    return !values.empty() && values[0].lexical == "true";
  }

  const std::vector<Term>& Values(const std::string& subject, const std::string& predicate) const {
    static const auto* nothing = new std::vector<Term>();
    const auto found = values_.find({subject, predicate});
    return found == values_.end() ? *nothing : found->second;
  }
  void Error(std::string message, std::string hint) {
    result_.diagnostics.push_back(
        {file_, place_, absl::StrCat("rule of the shape ", shape_, ": ", message), std::move(hint)});
  }
  SourceSpan PlaceOf(const std::string& subject, const std::string& predicate,
                     const std::string& object) const {
    const auto found = places_.find({subject, predicate, object});
    return found == places_.end() ? SourceSpan() : found->second;
  }

  // sh:prefixes → sh:declare [ sh:prefix "ex" ; sh:namespace "http://…" ].
  std::string Prologue(const std::string& rule) const {
    std::string text;
    for (const Term& holder : Values(rule, Sh("prefixes"))) {
      for (const Term& declaration : Values(Key(holder), Sh("declare"))) {
        const auto& prefix = Values(Key(declaration), Sh("prefix"));
        const auto& iri = Values(Key(declaration), Sh("namespace"));
        if (prefix.empty() || iri.empty()) continue;
        absl::StrAppend(&text, "PREFIX ", prefix[0].lexical, ": <", iri[0].lexical, ">\n");
      }
    }
    return text;
  }

  // The pattern of a target that a query selects; its other variables than ?this are not those of the rule. Empty:
  // ill-formed, and reported.
  std::string QueryTarget(const Term& target) {
    place_ = PlaceOf(shape_, Sh("target"), Key(target));
    const std::vector<Term>& selects = Values(Key(target), Sh("select"));
    const std::string name = absl::StrCat("its sh:target ", ToDisplay(target));
    if (target.IsLiteral() || selects.size() != 1) {
      Error(absl::StrCat(name, " has no sh:select"),
            "write sh:target [ a sh:SPARQLTarget ; sh:select \"SELECT ?this WHERE { … }\" ]");
      return "";
    }
    sparql::ParseOptions options;
    options.file = file_;
    options.prefixes = sparql::WellKnownPrefixes();
    sparql::ParsedQuery parsed = sparql::ParseQuery(Prologue(Key(target)) + selects[0].lexical, options);
    for (const Diagnostic& d : parsed.diagnostics) {
      if (d.severity == Diagnostic::Severity::kError)
        Error(absl::StrCat(name, " is not SPARQL: ", d.message), d.hint);
    }
    if (!parsed.ok()) return "";
    const std::vector<sparql::Variable>& shown = parsed.query.projection;
    const bool selects_this =
        parsed.query.form == sparql::Query::Form::kSelect &&
        std::any_of(shown.begin(), shown.end(), [](const sparql::Variable& v) { return v.name == "this"; });
    if (!selects_this || !parsed.query.from.empty() || !parsed.query.from_named.empty()) {
      Error(absl::StrCat(name, " is no SELECT of ?this from all facts"), "write SELECT ?this WHERE { … }");
      return "";
    }
    const sparql::AlgebraPtr where = matching::WithoutModifiers(*parsed.query.algebra).Clone();
    GiveOwnNames(*where);
    return WithoutLineBreaks(sparql::PrintPattern(*where));
  }

  // The patterns that bind ?this: one for each target. Mistakes are reported.
  std::vector<std::string> Targets() {
    std::vector<std::string> targets;
    const auto add = [&](const char* kind, const char* before, const char* after) {
      for (const Term& value : Values(shape_, Sh(kind))) {
        targets.push_back(absl::StrCat(before, ToNTriples(value), after));
      }
    };
    add("targetClass", "?this a ", " .");
    add("targetNode", "VALUES ?this { ", " }");
    add("targetSubjectsOf", "?this ", " ?targetObject .");
    add("targetObjectsOf", "?targetSubject ", " ?this .");
    for (const Term& type : Values(shape_, std::string(kRdfType))) {
      if (type.lexical == absl::StrCat(std::string(kRdfsNs), "Class") ||
          type.lexical == absl::StrCat(std::string(kOwlNs), "Class")) {
        targets.push_back(absl::StrCat("?this a <", shape_, "> ."));
      }
    }
    for (const Term& target : Values(shape_, Sh("target"))) {
      if (std::string query = QueryTarget(target); !query.empty()) targets.push_back(std::move(query));
    }
    return targets;
  }

  void Import(const std::string& rule) {
    if (IsTrue(Values(rule, Sh("deactivated")))) return;
    if (!Values(rule, Sh("condition")).empty()) {
      return Error("sh:condition is not supported", "write the condition into the WHERE of its CONSTRUCT");
    }
    const std::vector<Term>& construct = Values(rule, Sh("construct"));
    if (construct.empty())
      return Error("it has no sh:construct; only sh:SPARQLRule is read", "write it as a CONSTRUCT");
    const std::string prologue = Prologue(rule), text = absl::StrCat(prologue, construct[0].lexical);
    ImportedConstruct read;
    read.text = construct[0].lexical;
    read.prologue = prologue.size();
    read.literal = place_ = PlaceOf(rule, Sh("construct"), Key(construct[0]));
    read.quote = QuoteOf(read);
    sparql::ParseOptions options;
    options.file = file_;
    options.prefixes = sparql::WellKnownPrefixes();
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
    if (!parsed.ok()) {
      for (const Diagnostic& d : parsed.diagnostics) {
        place_ = read.InDocument(d.span);
        Error("its sh:construct is not SPARQL: " + d.message, d.hint);
      }
      return;
    }
    if (parsed.query.form != sparql::Query::Form::kConstruct)
      return Error("its sh:construct is not a CONSTRUCT", "");
    const SourceSpan place = place_;
    const std::vector<std::string> targets = Targets();
    place_ = place;
    if (targets.empty() && Values(shape_, Sh("target")).empty())
      return Error("the shape has no target", "give it a sh:targetClass or a sh:target, or make it a class");
    const sparql::PrintOptions print;
    std::string head;
    for (const sparql::TriplePattern& triple : parsed.query.construct_template) {
      absl::StrAppend(&head, sparql::PrintTriple(triple, print), " . ");
    }
    // The target is in the same group as the pattern, so that its filters see ?this.
    std::string where = sparql::PrintPattern(*parsed.query.algebra, print);
    where = where.substr(1, where.rfind('}') - 1);
    if (by_class_.line == 0 && !Values(shape_, Sh("targetClass")).empty()) by_class_ = place_;
    for (const std::string& target : targets) {
      made_.push_back({rule.starts_with("_:") ? "" : absl::StrCat("<", rule, "> "), WithoutLineBreaks(head),
                       target, WithoutLineBreaks(where), result_.constructs.size()});
    }
    read.query = std::move(parsed.query);
    result_.constructs.push_back(std::move(read));
  }

  // Printed text has line breaks only between its parts: those of literals are escaped.
  static std::string WithoutLineBreaks(std::string_view printed) {
    return absl::StrReplaceAll(std::string(printed), {{"\n", " "}});
  }

  // For a literal whose characters are in the document unchanged.
  size_t QuoteOf(const ImportedConstruct& read) const {
    if (read.literal.offset >= source_.size()) return 0;
    const std::string_view written = source_.substr(read.literal.offset);
    const size_t quote = written.starts_with("\"\"\"") || written.starts_with("'''") ? 3 : 1;
    const bool quoted = written[0] == '"' || written[0] == '\'';
    return quoted && written.size() > quote && written.substr(quote).starts_with(read.text) ? quote : 0;
  }

  // Writes the rule document, each rule in its line, and parses it.
  void Write() {
    const auto line = [this](const Made& rule) { return result_.constructs[rule.construct].literal.line; };
    std::stable_sort(made_.begin(), made_.end(),
                     [&](const Made& a, const Made& b) { return line(a) < line(b); });
    int at = 1;
    std::string& text = result_.text;
    for (Made& rule : made_) {
      if (!text.empty() && text.back() != '\n') text += ' ';
      for (; at < line(rule); ++at) text += '\n';
      rule.begin = text.size();
      absl::StrAppend(&text, "RULE ", rule.name, "{ ", rule.head, "} WHERE { ");
      rule.target_begin = text.size();
      absl::StrAppend(&text, rule.target, " ");
      rule.target_end = text.size();
      absl::StrAppend(&text, rule.where, "}");
      rule.end = text.size();
    }
    if (!text.empty()) text += '\n';
    result_.rules = made_.size();
    std::map<std::pair<size_t, std::string>, bool>
        told;  // place and message: a rule with two targets has its mistakes twice
    for (Diagnostic& d : ParseRules(text, file_, {}, functions_).diagnostics) {
      d.span = InDocument(d.span);
      if (told.emplace(std::pair(d.span.offset, d.message), true).second)
        result_.diagnostics.push_back(std::move(d));
    }
  }

  // The place in the document of the word at a place of `text`: the same occurrence, if both have the same
  // number of occurrences.
  SourceSpan InDocument(const SourceSpan& in_rules) const {
    const auto rule = std::find_if(made_.begin(), made_.end(), [&](const Made& m) {
      return m.begin <= in_rules.offset && in_rules.offset < m.end;
    });
    if (rule == made_.end()) return {};
    const ImportedConstruct& construct = result_.constructs[rule->construct];
    if (in_rules.offset >= rule->target_begin && in_rules.offset < rule->target_end) return construct.literal;
    const std::string_view text = result_.text;
    const std::string word = WordAt(text, in_rules.offset);
    const std::vector<size_t> there = Occurrences(construct.text, word);
    if (word.empty() || there.empty()) return construct.literal;
    size_t number = 0;
    for (const size_t offset : Occurrences(text.substr(rule->begin, in_rules.offset - rule->begin), word)) {
      const size_t place = rule->begin + offset;
      if (place < rule->target_begin || place >= rule->target_end) ++number;
    }
    const size_t offset = there[std::min(number, there.size() - 1)];
    return construct.InDocument({0, 0, construct.prologue + offset, word.size()});
  }

  static bool IsWordCharacter(char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '?';
  }
  static std::string Plain(std::string_view text) {
    return absl::AsciiStrToLower(absl::StrReplaceAll(std::string(text), {{"$", "?"}}));
  }
  static std::string WordAt(std::string_view text, size_t offset) {
    const std::string plain = Plain(text.substr(offset, 200));
    size_t end = 0;
    while (end < plain.size() && IsWordCharacter(plain[end])) ++end;
    return plain.substr(0, end);
  }
  static std::vector<size_t> Occurrences(std::string_view text, const std::string& word) {
    std::vector<size_t> out;
    const std::string plain = Plain(text);
    for (size_t at = plain.find(word); at != std::string::npos && !word.empty();
         at = plain.find(word, at + 1)) {
      const bool begins = at == 0 || !IsWordCharacter(plain[at - 1]);
      const size_t end = at + word.size();
      if (begins && (end == plain.size() || !IsWordCharacter(plain[end]))) out.push_back(at);
    }
    return out;
  }

  const std::string_view source_;
  const std::string file_;
  const sparql::FunctionRegistry* functions_;
  std::map<std::pair<std::string, std::string>, std::vector<Term>> values_;
  std::map<std::tuple<std::string, std::string, std::string>, SourceSpan> places_;  // of objects
  std::string shape_;
  SourceSpan place_;     // of the current node
  SourceSpan by_class_;  // of a rule with a class as target
  std::vector<Made> made_;
  ImportedRules result_;
};

}  // namespace

SourceSpan ImportedConstruct::InDocument(const SourceSpan& in_query) const {
  if (quote == 0 || in_query.offset < prologue || in_query.offset - prologue > text.size()) return literal;
  const size_t offset = in_query.offset - prologue;
  SourceSpan span = SpanAt(text, offset, in_query.length);
  if (span.line == 1) span.column += literal.column + static_cast<int>(quote) - 1;
  span.line += literal.line - 1;
  span.offset = literal.offset + quote + offset;
  return span;
}

ImportedRules ImportShaclRules(const LocatedRdf& shapes, std::string_view source, std::string_view file,
                               const sparql::FunctionRegistry* functions) {
  return Importer(shapes, source, file, functions).Run();
}

}  // namespace docent::rules
