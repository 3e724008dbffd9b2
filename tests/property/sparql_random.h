// Random queries over small random graphs, and a shrinker of failing cases: it leaves out pieces of the query
// and quads as long as the case still fails. The same seed gives the same case on every machine.
#ifndef DOCENT_TESTS_PROPERTY_SPARQL_RANDOM_H_
#define DOCENT_TESTS_PROPERTY_SPARQL_RANDOM_H_

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "graph/rdf/vocabulary.h"

namespace docent::sparql {

// A part of a query's text, with the parts inside it that may be left out.
struct Piece {
  std::string before;
  std::vector<Piece> inner;
  std::string after;

  std::string Text() const {
    std::string out = before;
    for (const Piece& piece : inner) out += piece.Text();
    return out + after;
  }
};

struct RandomQuad {
  std::string subject, predicate, object, graph;
  int step;  // the version that has it first
};

class RandomQueries {
 public:
  RandomQueries(uint32_t seed, bool wide) : random_(seed), wide_(wide) {}

  // uniform_int_distribution differs between libraries; the bias here is negligible
  size_t Below(size_t n) { return random_() % n; }
  static constexpr size_t kNodes = 6;
  std::string Node() { return "<urn:n" + std::to_string(Below(kNodes)) + ">"; }
  std::string Predicate() { return "<urn:p" + std::to_string(Below(3)) + ">"; }
  std::string Variable() { return "?v" + std::to_string(Below(5)); }

  Piece Group(int depth) {
    Piece group{"{ ", {}, "} "};
    const size_t elements = 1 + Below(3);
    for (size_t i = 0; i < elements; ++i) group.inner.push_back(Element(depth));
    return group;
  }

 private:
  static Piece Of(std::string text) { return {std::move(text), {}, ""}; }
  static Piece Around(std::string before, Piece inner, std::string after = "") {
    inner.before = before + inner.before;
    inner.after += after;
    return inner;
  }
  Piece Element(int depth) {
    switch (depth > 0 ? Below(wide_ ? 14 : 10) : 0) {
      case 0:
      case 1:
      case 2:
        return Of(Triple());
      case 3:
        return Around("OPTIONAL ", Group(depth - 1));
      case 4: {
        Piece both{"", {}, ""};
        both.inner.push_back(Group(depth - 1));
        both.inner.push_back(Around("UNION ", Group(depth - 1)));
        return both;
      }
      case 5:
        return Around("MINUS ", Group(depth - 1));
      case 6:
        return Of("FILTER(" + Condition() + ") ");
      case 7:
        return Group(depth - 1);
      case 9: {
        static const char* const kNames[] = {"<urn:g>", "<urn:h>", "<urn:none>", "<urn:g>"};
        const std::string name = Below(2) ? Variable() : kNames[Below(4)];
        return Around("GRAPH " + name + " ", Group(depth - 1));
      }
      case 11:
        return Around(Below(2) ? "FILTER EXISTS " : "FILTER NOT EXISTS ", Group(depth - 1));
      case 10: {
        std::string path = Variable() + " " + Path(2) + " ";
        path += (Below(3) ? Variable() : Node()) + " . ";
        return Of(path);
      }
      case 12: {
        std::string select = "{ SELECT DISTINCT " + Variable() + " ";
        select += Variable() + " ";
        return Around(select, Group(depth - 1), "} ");
      }
      case 13: {
        const std::string key = Variable();
        if (Below(3) == 0) return Around("{ SELECT (COUNT(*) AS ?n) ", Group(depth - 1), "} ");
        return Around("{ SELECT " + key + " (COUNT(*) AS ?n) ", Group(depth - 1), "GROUP BY " + key + " } ");
      }
      default: {
        std::string values = "VALUES " + Variable() + " { ";
        values += Node() + " ";
        return Of(values + Node() + " } ");
      }
    }
  }
  std::string Triple() {
    std::string out = (Below(4) ? Variable() : Node()) + " ";
    out += (Below(6) ? Predicate() : Variable()) + " ";
    return out + (Below(4) ? Variable() : Node()) + " . ";
  }
  std::string Condition() {
    const std::string variable = Variable();
    switch (Below(4)) {
      case 0:
        return variable + " = " + Variable();
      case 1:
        return variable + " != " + Node();
      case 2:
        return "BOUND(" + variable + ")";
      default: {
        const std::string other = Variable();
        return "!BOUND(" + variable + ") || " + other + " = " + Node();
      }
    }
  }
  std::string Path(int depth) {
    switch (depth > 0 ? Below(7) : 0) {
      case 0:
      case 1:
        return Predicate();
      case 2: {
        const std::string inner = Path(depth - 1);
        return "(" + inner + ")" + (Below(2) ? "*" : "+");
      }
      case 3:
        return "(" + Path(depth - 1) + ")?";
      case 4: {
        const std::string first = Path(depth - 1);
        return "(" + first + "|" + Path(depth - 1) + ")";
      }
      case 5: {
        const std::string first = Path(depth - 1);
        return "(" + first + "/" + Path(depth - 1) + ")";
      }
      default:
        return Below(2) ? "^" + Predicate() : "!" + Predicate();
    }
  }

  std::mt19937 random_;
  bool wide_;
};

// A query and the quads of three versions of a graph.
struct RandomCase {
  static constexpr int kSteps = 3;
  Piece query;
  std::vector<RandomQuad> quads;
  bool wide = false;  // the query may hold paths, EXISTS and sub-SELECTs

  static RandomCase Of(uint32_t seed) {
    RandomCase c;
    c.wide = seed % 2 == 0;
    RandomQueries random(seed, c.wide);
    c.query = random.Group(3);
    const auto bare = [](const std::string& bracketed) { return bracketed.substr(1, bracketed.size() - 2); };
    for (int i = 0; i < kSteps * 12; ++i) {
      RandomQuad quad;
      quad.subject = bare(random.Node());
      quad.predicate = bare(random.Predicate());
      quad.object = bare(random.Node());
      quad.graph = random.Below(3) ? std::string(kDefaultGraph) : random.Below(8) ? "urn:g" : "urn:h";
      quad.step = i / 12;
      c.quads.push_back(std::move(quad));
    }
    return c;
  }
  std::string Text() const {
    std::string out = "SELECT * " + query.Text() + "\n";
    for (const RandomQuad& q : quads) {
      out += "  version " + std::to_string(q.step + 1) + ": " + q.subject + " " + q.predicate + " " +
             q.object + " " + q.graph + "\n";
    }
    return out;
  }
};

// Removes pieces, largest first, while `fails` says that the case still fails.
inline void Shrink(RandomCase* c, const std::function<bool(const RandomCase&)>& fails) {
  const auto trim = [&](auto& list, size_t i) {
    auto kept = list;
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    if (fails(*c)) return true;
    list = std::move(kept);
    return false;
  };
  const auto pieces = [&](Piece& piece, const auto& self) -> bool {
    bool smaller = false;
    for (size_t i = piece.inner.size(); i-- > 0;) {
      // without it; else with its content in its place; else parts of its content
      if (trim(piece.inner, i)) {
        smaller = true;
        continue;
      }
      const Piece whole = piece.inner[i];
      if (!whole.inner.empty()) {
        auto kept = piece.inner;
        piece.inner.erase(piece.inner.begin() + static_cast<std::ptrdiff_t>(i));
        piece.inner.insert(piece.inner.begin() + static_cast<std::ptrdiff_t>(i), whole.inner.begin(),
                           whole.inner.end());
        if (fails(*c)) return true;  // start again: positions have moved
        piece.inner = std::move(kept);
      }
      smaller = self(piece.inner[i], self) || smaller;
    }
    return smaller;
  };
  for (bool again = true; again;) {
    again = pieces(c->query, pieces);
    for (size_t i = c->quads.size(); i-- > 0;) again = trim(c->quads, i) || again;
  }
}

}  // namespace docent::sparql

#endif  // DOCENT_TESTS_PROPERTY_SPARQL_RANDOM_H_
