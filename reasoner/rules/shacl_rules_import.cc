#include "reasoner/rules/shacl_rules_import.h"

#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/sparql/algebra_printer.h"
#include "kb_server/sparql/parser.h"

namespace docent {
namespace {

constexpr std::string_view kShNs = "http://www.w3.org/ns/shacl#";

class Importer {
 public:
  Importer(const std::vector<TermQuad>& quads, std::string_view file) : file_(file) {
    for (const TermQuad& q : quads) values_[{Key(q.subject), q.predicate.lexical}].push_back(q.object);
  }

  ImportedRules Run() {
    for (const auto& [key, rules] : values_) {
      if (key.second != Sh("rule")) continue;
      shape_ = key.first;
      if (IsTrue(Values(shape_, Sh("deactivated")))) continue;
      for (const Term& rule : rules) Import(Key(rule));
    }
    if (by_class_) {
      result_.diagnostics.push_back({file_, {}, "a target class means its explicit instances here, those of its subclasses only where inferred",
                                     "put rdfs or owl2rl in use, too, if there are subclasses", Diagnostic::Severity::kWarning});
    }
    return std::move(result_);
  }

 private:
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
        {file_, {}, absl::StrCat("rule of the shape ", shape_, ": ", message), std::move(hint)});
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

  // What ?this stands for: one pattern for each target.
  std::vector<std::string> Targets() const {
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
    const std::string text = absl::StrCat(Prologue(rule), construct[0].lexical);
    sparql::ParseOptions options;
    options.file = file_;
    options.prefixes = sparql::WellKnownPrefixes();
    sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
    if (!parsed.ok())
      return Error("its sh:construct is not SPARQL: " + parsed.diagnostics[0].message,
                   parsed.diagnostics[0].hint);
    if (parsed.query.form != sparql::Query::Form::kConstruct)
      return Error("its sh:construct is no CONSTRUCT", "");
    const std::vector<std::string> targets = Targets();
    if (targets.empty())
      return Error("the shape has no target", "give it a sh:targetClass, or make it a class");
    const sparql::PrintOptions print;
    std::string head;
    for (const sparql::TriplePattern& triple : parsed.query.construct_template) {
      absl::StrAppend(&head, sparql::PrintTriple(triple, print), " . ");
    }
    // The target stands in the same group as the pattern, so that its filters see ?this.
    std::string where = sparql::PrintPattern(*parsed.query.algebra, print);
    where = where.substr(1, where.rfind('}') - 1);
    by_class_ = by_class_ || !Values(shape_, Sh("targetClass")).empty();
    for (const std::string& target : targets) {
      absl::StrAppend(&result_.text, rule.starts_with("_:") ? "RULE" : absl::StrCat("RULE <", rule, ">"),
                      " { ", head, "}\nWHERE { ", target, " ", where, "}\n");
      ++result_.rules;
    }
  }

  const std::string file_;
  std::map<std::pair<std::string, std::string>, std::vector<Term>> values_;
  std::string shape_;
  bool by_class_ = false;  // a rule whose target is a class
  ImportedRules result_;
};

}  // namespace

ImportedRules ImportShaclRules(const std::vector<TermQuad>& shapes, std::string_view file) {
  return Importer(shapes, file).Run();
}

}  // namespace docent
