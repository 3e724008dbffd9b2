// Random graphs and random queries: the planned query gives what the query gives as written, also when prepared once and
// run on several versions. And, but for paths, EXISTS, GRAPH and sub-SELECTs, a naive evaluator of section 18 (every operand
// on its own, rows joined pair by pair) gives the same, which holds the index joins to the bottom-up semantics.
// DOCENT_PLANNER_QUERIES: how many queries (500); DOCENT_PLANNER_SEED: the first one's seed (1).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>

#include "kb_server/rdf/vocabulary.h"
#include "kb_server/sparql/algebra_printer.h"
#include "kb_server/sparql/evaluator.h"
#include "kb_server/sparql/parser.h"
#include "kb_server/store/graph_writer.h"

namespace docent::sparql {
namespace {

using Solution = std::map<std::string, TermId>;

class RandomQueries {
 public:
  explicit RandomQueries(uint32_t seed) : random_(seed) {}

  size_t Below(size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); }
  std::string Node() { return "<urn:n" + std::to_string(Below(6)) + ">"; }
  std::string Predicate() { return "<urn:p" + std::to_string(Below(3)) + ">"; }
  std::string Variable() { return "?v" + std::to_string(Below(5)); }
  std::string Triple() {
    return (Below(4) ? Variable() : Node()) + " " + (Below(6) ? Predicate() : Variable()) + " " +
           (Below(4) ? Variable() : Node());
  }
  std::string Condition() {
    switch (Below(4)) {
      case 0:
        return Variable() + " = " + Variable();
      case 1:
        return Variable() + " != " + Node();
      case 2:
        return "BOUND(" + Variable() + ")";
      default:
        return "!BOUND(" + Variable() + ") || " + Variable() + " = " + Node();
    }
  }
  std::string Group(int depth) {
    std::string out = "{ ";
    const size_t elements = 1 + Below(3);
    for (size_t i = 0; i < elements; ++i) {
      switch (depth > 0 ? Below(wide_ ? 14 : 9) : 0) {
        case 0:
        case 1:
        case 2:
          out += Triple() + " . ";
          break;
        case 3:
          out += "OPTIONAL " + Group(depth - 1) + " ";
          break;
        case 4:
          out += Group(depth - 1) + " UNION " + Group(depth - 1) + " ";
          break;
        case 5:
          out += "MINUS " + Group(depth - 1) + " ";
          break;
        case 6:
          out += "FILTER(" + Condition() + ") ";
          break;
        case 7:
          out += Group(depth - 1) + " ";
          break;
        case 9:
          out += std::string("FILTER ") + (Below(2) ? "EXISTS " : "NOT EXISTS ") + Group(depth - 1) + " ";
          break;
        case 10:
          out += Variable() + " " + Path(2) + " " + (Below(3) ? Variable() : Node()) + " . ";
          break;
        case 11:
          out += "GRAPH " + (Below(2) ? Variable() : std::string("<urn:g>")) + " " + Group(depth - 1) + " ";
          break;
        case 12:
          out += "{ SELECT DISTINCT " + Variable() + " " + Variable() + " " + Group(depth - 1) + " } ";
          break;
        case 13: {
          const std::string key = Variable();
          out += "{ SELECT " + key + " (COUNT(*) AS ?n) " + Group(depth - 1) + " GROUP BY " + key + " } ";
          break;
        }
        default:
          out += "VALUES " + Variable() + " { " + Node() + " " + Node() + " } ";
          break;
      }
    }
    return out + "}";
  }

  // Whether the query may hold what the naive evaluator does not know.
  void SetWide(bool wide) { wide_ = wide; }

 private:
  std::string Path(int depth) {
    switch (depth > 0 ? Below(7) : 0) {
      case 0:
      case 1:
        return Predicate();
      case 2:
        return "(" + Path(depth - 1) + ")" + (Below(2) ? "*" : "+");
      case 3:
        return "(" + Path(depth - 1) + ")?";
      case 4:
        return "(" + Path(depth - 1) + "|" + Path(depth - 1) + ")";
      case 5:
        return "(" + Path(depth - 1) + "/" + Path(depth - 1) + ")";
      default:
        return Below(2) ? "^" + Predicate() : "!" + Predicate();
    }
  }
  std::mt19937 random_;
  bool wide_ = false;
};

// Section 18.5 by the letter.
class Naive {
 public:
  Naive(const Dictionary& dictionary, const GraphVersion& version)
      : dictionary_(dictionary), version_(version) {}

  std::vector<Solution> Evaluate(const Algebra& a) {
    switch (a.kind) {
      case Algebra::Kind::kBgp:
        return Bgp(a);
      case Algebra::Kind::kJoin: {
        std::vector<Solution> out = {{}};
        for (const AlgebraPtr& child : a.children) out = Join(out, Evaluate(*child));
        return out;
      }
      case Algebra::Kind::kLeftJoin:
        return LeftJoin(Evaluate(*a.children[0]), Evaluate(*a.children[1]), a.expression.get());
      case Algebra::Kind::kFilter: {
        std::vector<Solution> out;
        for (const Solution& s : Evaluate(*a.children[0])) {
          if (Test(*a.expression, s)) out.push_back(s);
        }
        return out;
      }
      case Algebra::Kind::kUnion: {
        std::vector<Solution> out;
        for (const AlgebraPtr& child : a.children) {
          for (Solution& s : Evaluate(*child)) out.push_back(std::move(s));
        }
        return out;
      }
      case Algebra::Kind::kMinus: {
        const std::vector<Solution> right = Evaluate(*a.children[1]);
        std::vector<Solution> out;
        for (const Solution& s : Evaluate(*a.children[0])) {
          const bool removed = std::any_of(right.begin(), right.end(), [&](const Solution& r) {
            const bool shares =
                std::any_of(r.begin(), r.end(), [&](const auto& cell) { return s.contains(cell.first); });
            return shares && Merge(s, r).has_value();
          });
          if (!removed) out.push_back(s);
        }
        return out;
      }
      case Algebra::Kind::kValues: {
        std::vector<Solution> out;
        for (const auto& row : a.rows) {
          Solution s;
          for (size_t i = 0; i < row.size(); ++i) s[a.variables[i].name] = Id(*row[i]);
          out.push_back(std::move(s));
        }
        return out;
      }
      default:
        ADD_FAILURE() << "not in the random queries";
        return {};
    }
  }

 private:
  TermId Id(const Term& t) const { return dictionary_.Find(t).value_or(TermId()); }

  static std::optional<Solution> Merge(const Solution& a, const Solution& b) {
    Solution out = a;
    for (const auto& [name, id] : b) {
      const auto [it, added] = out.emplace(name, id);
      if (!added && it->second != id) return std::nullopt;
    }
    return out;
  }
  static std::vector<Solution> Join(const std::vector<Solution>& a, const std::vector<Solution>& b) {
    std::vector<Solution> out;
    for (const Solution& x : a) {
      for (const Solution& y : b) {
        if (auto merged = Merge(x, y)) out.push_back(*std::move(merged));
      }
    }
    return out;
  }
  std::vector<Solution> LeftJoin(const std::vector<Solution>& a, const std::vector<Solution>& b,
                                 const Expression* e) {
    std::vector<Solution> out;
    for (const Solution& x : a) {
      bool any = false;
      for (const Solution& y : b) {
        auto merged = Merge(x, y);
        if (!merged || (e != nullptr && !Test(*e, *merged))) continue;
        any = true;
        out.push_back(*std::move(merged));
      }
      if (!any) out.push_back(x);
    }
    return out;
  }
  std::vector<Solution> Bgp(const Algebra& a) {
    std::vector<Solution> out = {{}};
    for (const TriplePattern& t : a.triples) {
      std::vector<Solution> matches;
      Quad last;
      version_.ForEach({}, [&](const Quad& q) {
        const bool copy =
            q.subject == last.subject && q.predicate == last.predicate && q.object == last.object;
        last = q;
        if (copy) return true;
        Solution s;
        const auto fits = [&](const PatternTerm& p, TermId id) {
          if (!p.IsVariable()) return Id(p.term) == id;
          const auto [it, added] = s.emplace(p.variable->name, id);
          return added || it->second == id;
        };
        if (fits(t.subject, q.subject) && fits(t.predicate, q.predicate) && fits(t.object, q.object))
          matches.push_back(s);
        return true;
      });
      out = Join(out, matches);
    }
    return out;
  }
  bool Test(const Expression& e, const Solution& s) {
    std::vector<std::string> names;
    std::vector<TermId> row;
    for (const auto& [name, id] : s) {
      names.push_back(name);
      row.push_back(id);
    }
    auto prepared = PreparedExpression::Prepare(e, names, dictionary_);
    return *(*prepared)->Test({}, row);
  }

  const Dictionary& dictionary_;
  const GraphVersion& version_;
};

constexpr size_t kMaxRows = 200000;  // of one answer

std::vector<std::string> Sorted(std::vector<std::string> rows) {
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<std::string> RowsOf(PreparedQuery& query, const GraphVersion& version) {
  std::vector<std::string> rows;
  const absl::Status status = query.Select({&version, nullptr, 0, 0}, {}, [&](absl::Span<const TermId> row) {
    std::string text;
    for (const TermId id : row) text += id.IsNone() ? "- " : query.Decode(id).lexical + " ";
    rows.push_back(text);
    return rows.size() < kMaxRows;
  });
  EXPECT_TRUE(status.ok()) << status;
  if (rows.size() >= kMaxRows) return {"too many to compare"};
  return Sorted(rows);
}

uint32_t FromEnvironment(const char* name, uint32_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<uint32_t>(std::strtoul(text, nullptr, 10));
}

// What the naive evaluator says, as RowsOf does.
std::vector<std::string> NaiveRows(const Query& query, const PreparedQuery& names, const Dictionary& dictionary,
                                   const GraphVersion& version) {
  std::vector<std::string> rows;
  for (const Solution& s : Naive(dictionary, version).Evaluate(*query.algebra->children[0])) {
    std::string row;
    for (const std::string& name : names.variables()) {
      const auto it = s.find(name);
      row += it == s.end() || it->second.IsNone() ? "- " : dictionary.Decode(it->second).lexical + " ";
    }
    rows.push_back(row);
  }
  return Sorted(rows);
}

void Check(uint32_t seed) {
  RandomQueries random(seed);
  const bool wide = seed % 2 == 0;
  random.SetWide(wide);
  Dictionary dictionary;
  GraphWriter writer(nullptr);
  std::vector<GraphVersionPtr> versions;
  const std::string text = "SELECT * " + random.Group(3);
  SCOPED_TRACE("DOCENT_PLANNER_SEED=" + std::to_string(seed) + " DOCENT_PLANNER_QUERIES=1\n" + text);
  const ParsedQuery parsed = ParseQuery(text);
  if (!parsed.ok() && wide) return;  // e.g. two sub-SELECTs that both make ?n
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  auto planned = *PreparedQuery::Prepare(parsed.query, dictionary, {});
  PrepareOptions as_written;
  as_written.reorder_joins = false;
  auto plain = *PreparedQuery::Prepare(parsed.query, dictionary, as_written);
  for (int step = 0; step < 3; ++step) {
    for (int i = 0; i < 12; ++i) {
      const auto id = [&](const std::string& bracketed) {
        return dictionary.InternIri(bracketed.substr(1, bracketed.size() - 2));
      };
      writer.Add({id(random.Node()), id(random.Predicate()), id(random.Node()),
                  random.Below(3) ? dictionary.InternIri(kDefaultGraph) : dictionary.InternIri("urn:g")});
    }
    versions.push_back(writer.Freeze(Revision(static_cast<uint64_t>(step) + 1)));
  }
  for (const GraphVersionPtr& version : {versions[2], versions[0], versions[1]}) {
    const std::vector<std::string> with_plan = RowsOf(*planned, *version);
    ASSERT_EQ(with_plan, RowsOf(*plain, *version)) << planned->Explain(*version);
    if (wide || with_plan.size() > 3000) continue;  // the naive way would take long
    ASSERT_EQ(with_plan, NaiveRows(parsed.query, *planned, dictionary, *version)) << planned->Explain(*version);
  }
}

TEST(SparqlPlanner, PlannedQueriesGiveWhatTheAlgebraSays) {
  const uint32_t first = FromEnvironment("DOCENT_PLANNER_SEED", 1);
  const uint32_t count = FromEnvironment("DOCENT_PLANNER_QUERIES", 500);
  for (uint32_t seed = first; seed < first + count && !testing::Test::HasFailure(); ++seed) Check(seed);
}

}  // namespace
}  // namespace docent::sparql
