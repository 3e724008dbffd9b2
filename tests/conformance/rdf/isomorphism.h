// Isomorphism test of RDF datasets: equal except for the labels of blank nodes (RDF 1.1 Concepts, section
// 3.6).
#ifndef DOCENT_TESTS_CONFORMANCE_RDF_ISOMORPHISM_H_
#define DOCENT_TESTS_CONFORMANCE_RDF_ISOMORPHISM_H_

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "graph/rdf/term.h"

namespace docent {

// Colour refinement, then backtracking within colours. For the small documents of tests.
class Isomorphism {
 public:
  static bool Holds(std::vector<TermQuad> a, std::vector<TermQuad> b) {
    Normalise(&a);
    Normalise(&b);
    if (a.size() != b.size()) return false;
    return Isomorphism(a, b).Search({});
  }

 private:
  using Colours = std::map<std::string, std::string>;

  Isomorphism(const std::vector<TermQuad>& a, const std::vector<TermQuad>& b)
      : a_(a), b_(b), colours_a_(Refine(a)), colours_b_(Refine(b)) {
    for (const TermQuad& quad : b_)
      texts_b_.insert(Text(quad, [](const std::string& label) { return label; }));
  }

  static void Normalise(std::vector<TermQuad>* quads) {
    auto key = [](const TermQuad& q) { return Text(q, [](const std::string& label) { return label; }); };
    std::sort(quads->begin(), quads->end(), [&](const auto& x, const auto& y) { return key(x) < key(y); });
    quads->erase(std::unique(quads->begin(), quads->end()), quads->end());
  }

  static std::string Text(const TermQuad& quad, const std::function<std::string(const std::string&)>& label) {
    std::string text;
    for (const Term* term : {&quad.subject, &quad.predicate, &quad.object, &quad.graph}) {
      Term same = *term;  // language tags compare without case
      same.language = LowerLanguage(term->language);
      text += (term->IsBlank() ? "_:" + label(term->lexical) : ToNTriples(same)) + " ";
    }
    return text;
  }

  static Colours Refine(const std::vector<TermQuad>& quads) {
    Colours colours;
    for (const TermQuad& quad : quads) {
      for (const Term* term : {&quad.subject, &quad.object, &quad.graph}) {
        if (term->IsBlank()) colours[term->lexical] = "";
      }
    }
    for (int round = 0; round < 8; ++round) {
      Colours next;
      for (const auto& [node, colour] : colours) {
        std::vector<std::string> seen;
        for (const TermQuad& quad : quads) {
          std::string text = Text(quad, [&, &self = node](const std::string& label) {
            return label == self ? "self" : colours[label];
          });
          if (text.find("_:self ") != std::string::npos) seen.push_back(text);
        }
        std::sort(seen.begin(), seen.end());
        std::string all;
        for (const std::string& text : seen) all += text + "\n";
        next[node] = std::to_string(std::hash<std::string>()(all));
      }
      colours = next;
    }
    return colours;
  }

  bool Search(std::map<std::string, std::string> names) {
    for (const auto& [node, colour] : colours_a_) {
      if (names.contains(node)) continue;
      for (const auto& [other, other_colour] : colours_b_) {
        bool taken =
            std::any_of(names.begin(), names.end(), [&](const auto& n) { return n.second == other; });
        if (colour != other_colour || taken) continue;
        auto more = names;
        more[node] = other;
        if (Search(std::move(more))) return true;
      }
      return false;
    }
    return std::all_of(a_.begin(), a_.end(), [&](const TermQuad& quad) {
      return texts_b_.contains(Text(quad, [&](const std::string& label) { return names[label]; }));
    });
  }

  const std::vector<TermQuad>& a_;
  const std::vector<TermQuad>& b_;
  Colours colours_a_;
  Colours colours_b_;
  std::set<std::string> texts_b_;
};

}  // namespace docent

#endif  // DOCENT_TESTS_CONFORMANCE_RDF_ISOMORPHISM_H_
