// Random graphs, changes, rules and queries over a small vocabulary, so that collisions, cycles and shared
// support are common. Everything depends on one seed.
#ifndef DOCENT_TESTS_PROPERTY_REASONER_RANDOM_H_
#define DOCENT_TESTS_PROPERTY_REASONER_RANDOM_H_

#include <random>
#include <set>
#include <string>
#include <vector>

namespace docent {

// One batch in the short text of TestWorld.
struct RandomBatch {
  std::vector<std::string> add;
  std::vector<std::string> remove;
};

class RandomWorld {
 public:
  explicit RandomWorld(unsigned seed) : random_(seed) {}

  int Pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool Chance(int percent) { return Pick(100) < percent; }
  std::string Node() { return "n" + std::to_string(Pick(5)); }
  std::string Predicate() { return std::string("p") + std::to_string(Pick(4)); }
  std::string Value() {
    if (!Chance(numbers_percent)) return Node();
    static const std::vector<std::string> kSpecial = {"2.0", "2f",  "2.5",  "3.0f",
                                                      "'2",  "0.1", "0.1f", "9007199254740993"};
    return Chance(30) ? kSpecial[static_cast<size_t>(Pick(static_cast<int>(kSpecial.size())))]
                      : std::to_string(Pick(6));
  }

  std::string SchemaQuad() {
    static const std::vector<std::string> kProperties = {"rdfs:domain", "rdfs:range"};
    static const std::vector<std::string> kClassPairs = {
        "rdfs:subClassOf", "rdfs:subClassOf", "owl:someValuesFrom", "owl:allValuesFrom", "owl:disjointWith"};
    switch (Pick(7)) {
      case 0:
        return Predicate() + " " + kProperties[static_cast<size_t>(Pick(2))] + " " + Node();
      case 1:
        return Predicate() + (Chance(50) ? " rdfs:subPropertyOf " : " owl:inverseOf ") + Predicate();
      case 2:
        return Predicate() + " a " + (Chance(50) ? "owl:TransitiveProperty" : "owl:FunctionalProperty");
      case 3:
        return Node() + " " + kClassPairs[static_cast<size_t>(Pick(5))] + " " + Node();
      case 4:
        return Node() + " owl:onProperty " + Predicate();
      case 5:
        return Chance(80) ? Node() + " owl:sameAs " + Node() : Predicate() + " owl:sameAs " + Predicate();
      default:
        return Node() + " a " + Node();
    }
  }

  std::string Quad() {
    if (Chance(schema_percent)) return SchemaQuad();
    std::string quad = Node() + " " + Predicate() + " " + Value();
    if (Chance(30)) quad += " @g" + std::to_string(Pick(2));
    return quad;
  }

  // A change of `told`, which is updated. Also removes absent facts and adds existing ones.
  RandomBatch Batch(std::set<std::string>& told) {
    RandomBatch batch;
    std::set<std::string> used;
    const int count = 1 + Pick(Chance(15) ? 12 : 3);
    for (int i = 0; i < count; ++i) {
      const bool remove = Chance(told.size() > 14 ? 65 : 40);
      std::string quad = Quad();
      if (remove && !told.empty() && Chance(90)) {
        auto it = told.begin();
        std::advance(it, Pick(static_cast<int>(told.size())));
        quad = *it;
      }
      if (!used.insert(quad).second) continue;
      (remove ? batch.remove : batch.add).push_back(quad);
      if (remove) {
        told.erase(quad);
      } else {
        told.insert(quad);
      }
    }
    return batch;
  }

  int numbers_percent = 25;  // of objects
  int schema_percent = 0;    // of quads

 private:
  std::mt19937 random_;
};

}  // namespace docent

#endif  // DOCENT_TESTS_PROPERTY_REASONER_RANDOM_H_
