#include "tests/conformance/sparql/result_files.h"

#include <gtest/gtest.h>
#include <libxml/parser.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/value.h"
#include "tests/conformance/rdf/isomorphism.h"

namespace docent {
namespace {

constexpr char kRs[] = "http://www.w3.org/2001/sw/DataAccess/tests/result-set#";

std::string Attribute(xmlNode* node, const char* name) {
  for (xmlAttr* a = node->properties; a != nullptr; a = a->next) {
    if (std::string(reinterpret_cast<const char*>(a->name)) != name) continue;
    xmlChar* value = xmlNodeGetContent(a->children);
    std::string out = value ? reinterpret_cast<char*>(value) : "";
    xmlFree(value);
    return out;
  }
  return "";
}

std::string Content(xmlNode* node) {
  xmlChar* value = xmlNodeGetContent(node);
  std::string out = value ? reinterpret_cast<char*>(value) : "";
  xmlFree(value);
  return out;
}

std::vector<xmlNode*> Elements(xmlNode* parent, const std::string& name) {
  std::vector<xmlNode*> out;
  for (xmlNode* n = parent->children; n != nullptr; n = n->next) {
    if (n->type == XML_ELEMENT_NODE && (name.empty() || reinterpret_cast<const char*>(n->name) == name))
      out.push_back(n);
  }
  return out;
}

Term MakeTerm(const std::string& kind, const std::string& text, const std::string& datatype,
              const std::string& language) {
  if (kind == "uri") return Term::Iri(text);
  if (kind == "bnode") return Term::Blank(text);
  return language.empty() ? Term::Literal(text, datatype) : Term::LangString(text, language);
}

// Parser of the JSON that results use.
class Json {
 public:
  enum class Kind { kNull, kBoolean, kString, kArray, kObject };
  Kind kind = Kind::kNull;
  bool boolean = false;
  std::string string;
  std::vector<Json> items;
  std::map<std::string, Json> members;

  const Json& operator[](const std::string& name) const {
    static const Json kNone;
    const auto it = members.find(name);
    return it == members.end() ? kNone : it->second;
  }
  static Json Parse(const std::string& text) {
    size_t at = 0;
    return Value(text, &at);
  }

 private:
  static void Space(const std::string& t, size_t* at) {
    while (*at < t.size() && std::string(" \t\r\n,:").find(t[*at]) != std::string::npos) ++*at;
  }
  static std::string String(const std::string& t, size_t* at) {
    std::string out;
    for (++*at; *at < t.size() && t[*at] != '"'; ++*at) {
      if (t[*at] != '\\') {
        out += t[*at];
        continue;
      }
      const char c = t[++*at];
      if (c == 'u') {
        const unsigned code = static_cast<unsigned>(std::stoul(t.substr(*at + 1, 4), nullptr, 16));
        *at += 4;
        if (code < 0x80) {
          out += static_cast<char>(code);
        } else if (code < 0x800) {
          out += static_cast<char>(0xC0 | code >> 6);
          out += static_cast<char>(0x80 | (code & 63));
        } else {
          out += static_cast<char>(0xE0 | code >> 12);
          out += static_cast<char>(0x80 | (code >> 6 & 63));
          out += static_cast<char>(0x80 | (code & 63));
        }
      } else {
        out += c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c;
      }
    }
    ++*at;
    return out;
  }
  static Json Value(const std::string& t, size_t* at) {
    Space(t, at);
    Json out;
    if (*at >= t.size()) return out;
    if (t[*at] == '"') {
      out.kind = Kind::kString;
      out.string = String(t, at);
    } else if (t[*at] == '{') {
      out.kind = Kind::kObject;
      for (++*at, Space(t, at); *at < t.size() && t[*at] != '}'; Space(t, at)) {
        const std::string name = String(t, at);
        out.members[name] = Value(t, at);
      }
      ++*at;
    } else if (t[*at] == '[') {
      out.kind = Kind::kArray;
      for (++*at, Space(t, at); *at < t.size() && t[*at] != ']'; Space(t, at))
        out.items.push_back(Value(t, at));
      ++*at;
    } else {
      out.kind = t[*at] == 'n' ? Kind::kNull : Kind::kBoolean;
      out.boolean = t[*at] == 't';
      while (*at < t.size() && t[*at] >= 'a' && t[*at] <= 'z') ++*at;
    }
    return out;
  }
};

// Numbers by value: the suites' files write 2, 2.0 and 2.00 for one decimal.
Term Canonical(const Term& t) {
  if (!t.IsLiteral()) return t;
  const sparql::Value value = sparql::Value::OfTerm(t);
  if (value.IsNumeric() && t.datatype == value.CanonicalDatatype())
    return Term::Literal(value.CanonicalText(), t.datatype);
  return t;
}

// The solutions as a graph, so that graph isomorphism finds the blank node mapping.
std::vector<TermQuad> AsGraph(const Answer& answer, bool ordered, bool lax) {
  std::vector<TermQuad> out;
  std::set<std::string> seen;
  for (size_t i = 0; i < answer.rows.size(); ++i) {
    const Term row = Term::Blank("row" + std::to_string(i));
    std::string text;
    std::vector<TermQuad> quads = {
        {row, Term::Iri("urn:row"), Term::Literal(ordered ? std::to_string(i) : ""), Term{}}};
    for (const auto& [name, term] : answer.rows[i]) {
      const Term value = Canonical(term);
      text += name + "=" + ToNTriples(value) + " ";
      quads.push_back({row, Term::Iri("urn:var:" + name),
                       value.IsBlank() ? Term::Blank("v" + value.lexical) : value, Term{}});
    }
    if (lax && !seen.insert(text).second) continue;
    out.insert(out.end(), quads.begin(), quads.end());
  }
  return out;
}

}  // namespace

Answer ReadXmlResult(const std::string& text) {
  Answer answer;
  xmlDoc* doc =
      xmlReadMemory(text.data(), static_cast<int>(text.size()), "result.srx", nullptr, XML_PARSE_NONET);
  EXPECT_NE(doc, nullptr);
  if (doc == nullptr) return answer;
  xmlNode* root = xmlDocGetRootElement(doc);
  for (xmlNode* head : Elements(root, "head")) {
    for (xmlNode* v : Elements(head, "variable")) answer.variables.push_back(Attribute(v, "name"));
  }
  for (xmlNode* b : Elements(root, "boolean")) answer.boolean = Content(b) == "true";
  for (xmlNode* results : Elements(root, "results")) {
    for (xmlNode* result : Elements(results, "result")) {
      std::map<std::string, Term> row;
      for (xmlNode* binding : Elements(result, "binding")) {
        for (xmlNode* value : Elements(binding, "")) {
          row[Attribute(binding, "name")] =
              MakeTerm(reinterpret_cast<const char*>(value->name), Content(value),
                       Attribute(value, "datatype"), Attribute(value, "lang"));
        }
      }
      answer.rows.push_back(std::move(row));
    }
  }
  xmlFreeDoc(doc);
  return answer;
}

Answer ReadJsonResult(const std::string& text) {
  Answer answer;
  const Json root = Json::Parse(text);
  for (const Json& v : root["head"]["vars"].items) answer.variables.push_back(v.string);
  if (root["boolean"].kind == Json::Kind::kBoolean) answer.boolean = root["boolean"].boolean;
  for (const Json& result : root["results"]["bindings"].items) {
    std::map<std::string, Term> row;
    for (const auto& [name, value] : result.members) {
      row[name] = MakeTerm(value["type"].string, value["value"].string, value["datatype"].string,
                           value["xml:lang"].string);
    }
    answer.rows.push_back(std::move(row));
  }
  return answer;
}

Answer ReadTsvResult(const std::string& text) {
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == '\t') {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    return cells;
  };
  Answer answer;
  std::istringstream in(text);
  std::string line;
  const auto next = [&in, &line] {
    if (!std::getline(in, line)) return false;
    if (line.ends_with('\r')) line.pop_back();
    return true;
  };
  if (!next()) return answer;
  for (const std::string& name : split(line)) {
    if (!name.empty()) answer.variables.push_back(name.substr(1));
  }
  while (next()) {
    std::map<std::string, Term> row;
    const std::vector<std::string> cells = split(line);
    for (size_t i = 0; i < cells.size() && i < answer.variables.size(); ++i) {
      if (cells[i].empty()) continue;
      const ParsedRdf parsed = ParseRdf("<s:> <p:> " + cells[i] + " .", RdfFormat::kTurtle);
      EXPECT_TRUE(parsed.ok()) << cells[i];
      if (parsed.ok()) row[answer.variables[i]] = parsed.quads[0].object;
    }
    answer.rows.push_back(std::move(row));
  }
  return answer;
}

Answer ReadRdfResult(const std::vector<TermQuad>& quads) {
  Answer answer;
  const std::string rs = kRs;
  const auto objects = [&](const Term& s, const std::string& p) {
    std::vector<Term> out;
    for (const TermQuad& q : quads) {
      if (q.subject == s && q.predicate.lexical == rs + p) out.push_back(q.object);
    }
    return out;
  };
  const TermQuad* set = nullptr;
  for (const TermQuad& q : quads) {
    if (q.predicate.lexical == kRdfType && q.object.lexical == rs + "ResultSet") set = &q;
  }
  if (set == nullptr) {
    answer.graph = quads;
    return answer;
  }
  for (const Term& b : objects(set->subject, "boolean")) answer.boolean = b.lexical == "true";
  for (const Term& v : objects(set->subject, "resultVariable")) answer.variables.push_back(v.lexical);
  std::vector<std::pair<int, std::map<std::string, Term>>> rows;
  for (const Term& solution : objects(set->subject, "solution")) {
    std::map<std::string, Term> row;
    int index = 0;
    for (const Term& i : objects(solution, "index")) {
      index = std::stoi(i.lexical);
      answer.ordered = true;
    }
    for (const Term& binding : objects(solution, "binding")) {
      row[objects(binding, "variable").at(0).lexical] = objects(binding, "value").at(0);
    }
    rows.emplace_back(index, std::move(row));
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [index, row] : rows) answer.rows.push_back(std::move(row));
  return answer;
}

bool SameAnswer(const Answer& a, const Answer& b, bool lax) {
  if (a.boolean || b.boolean) return a.boolean == b.boolean;
  if (a.graph.has_value() != b.graph.has_value()) return false;
  if (a.graph) return Isomorphism::Holds(*a.graph, *b.graph);
  if (std::set(a.variables.begin(), a.variables.end()) != std::set(b.variables.begin(), b.variables.end()))
    return false;
  const bool ordered = a.ordered && b.ordered;
  return Isomorphism::Holds(AsGraph(a, ordered, lax), AsGraph(b, ordered, lax));
}

std::string ToText(const Answer& answer) {
  if (answer.boolean) return *answer.boolean ? "true" : "false";
  std::string out;
  if (answer.graph) {
    for (const TermQuad& q : *answer.graph) {
      out += "  " + ToNTriples(q.subject) + " " + ToNTriples(q.predicate) + " " + ToNTriples(q.object) + "\n";
    }
    return out;
  }
  for (const std::string& v : answer.variables) out += "?" + v + " ";
  out += "\n";
  for (const auto& row : answer.rows) {
    out += "  ";
    for (const auto& [name, term] : row) out += name + "=" + ToNTriples(term) + "  ";
    out += "\n";
  }
  return out;
}

}  // namespace docent
