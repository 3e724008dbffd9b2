// A golden case for each rule of the OWL 2 RL/RDF tables: asserted facts, consequences, and that these
// disappear when any one of the asserted triples is retracted.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_parser.h"
#include "reasoner/rules/rule_sets.h"

namespace docent::rules {
namespace {

struct Case {
  const char* rule;
  const char* told;     // Turtle; the lines that say how a list looks are one triple a line, too
  const char* follows;  // Turtle; empty: an inconsistency
};

constexpr char kPrefixes[] =
    "@prefix : <http://example.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
    "@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .\n"
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: "
    "<http://www.w3.org/2001/XMLSchema#> .\n";

const Case kCases[] = {
    {"list", ":d owl:unionOf :l1 . :l1 rdf:rest :l2 .", ":l1 <https://w3id.org/docent#listNode> :l2 ."},
    {"eq-sym", ":a owl:sameAs :b .", ":b owl:sameAs :a ."},
    {"eq-trans", ":a owl:sameAs :b . :b owl:sameAs :c .", ":a owl:sameAs :c ."},
    {"eq-rep-s", ":a owl:sameAs :b . :a :p :o .", ":b :p :o ."},
    {"eq-rep-p", ":p owl:sameAs :q . :s :p :o .", ":s :q :o ."},
    {"eq-rep-o", ":a owl:sameAs :b . :s :p :a .", ":s :p :b ."},
    {"eq-diff1", ":a owl:sameAs :b . :a owl:differentFrom :b .", ""},
    {"eq-diff1", ":a owl:differentFrom :a .", ""},
    {"eq-diff2",
     ":x a owl:AllDifferent . :x owl:members :l1 . :l1 rdf:first :a . :l1 rdf:rest :l2 . :l2 rdf:first :a .",
     ""},
    {"eq-diff3",
     ":x a owl:AllDifferent . :x owl:distinctMembers :l1 . :l1 rdf:first :a . :l1 rdf:rest :l2 . :l2 "
     "rdf:first :a .",
     ""},
    {"eq-diff2",
     ":x a owl:AllDifferent . :x owl:members :l1 . :l1 rdf:first :a . :l1 rdf:rest :l2 . :l2 rdf:first :b . "
     ":a "
     "owl:sameAs :b .",
     ""},
    {"eq-diff3",
     ":x a owl:AllDifferent . :x owl:distinctMembers :l1 . :l1 rdf:first :a . :l1 rdf:rest :l2 . :l2 "
     "rdf:first :b . "
     ":b owl:sameAs :a .",
     ""},
    {"prp-ap", "", "rdfs:label a owl:AnnotationProperty . owl:versionInfo a owl:AnnotationProperty ."},
    {"prp-dom", ":p rdfs:domain :C . :x :p :y .", ":x a :C ."},
    {"prp-rng", ":p rdfs:range :C . :x :p :y .", ":y a :C ."},
    {"prp-fp", ":p a owl:FunctionalProperty . :x :p :y1 . :x :p :y2 .", ":y1 owl:sameAs :y2 ."},
    {"prp-ifp", ":p a owl:InverseFunctionalProperty . :x1 :p :y . :x2 :p :y .", ":x1 owl:sameAs :x2 ."},
    {"prp-irp", ":p a owl:IrreflexiveProperty . :x :p :x .", ""},
    {"prp-symp", ":p a owl:SymmetricProperty . :x :p :y .", ":y :p :x ."},
    {"prp-asyp", ":p a owl:AsymmetricProperty . :x :p :y . :y :p :x .", ""},
    {"prp-trp", ":p a owl:TransitiveProperty . :x :p :y . :y :p :z .", ":x :p :z ."},
    {"prp-spo1", ":p rdfs:subPropertyOf :q . :x :p :y .", ":x :q :y ."},
    {"prp-spo2",
     ":p owl:propertyChainAxiom :l1 . :l1 rdf:first :p1 . :l1 rdf:rest :l2 . :l2 rdf:first :p2 . :l2 "
     "rdf:rest "
     "rdf:nil . :a :p1 :b . :b :p2 :c .",
     ":a :p :c ."},
    {"prp-eqp1", ":p owl:equivalentProperty :q . :x :p :y .", ":x :q :y ."},
    {"prp-eqp2", ":p owl:equivalentProperty :q . :x :q :y .", ":x :p :y ."},
    {"prp-pdw", ":p owl:propertyDisjointWith :q . :x :p :y . :x :q :y .", ""},
    {"prp-adp",
     ":a a owl:AllDisjointProperties . :a owl:members :l1 . :l1 rdf:first :p . :l1 rdf:rest :l2 . :l2 "
     "rdf:first :q "
     ". :x :p :y . :x :q :y .",
     ""},
    {"prp-inv1", ":p owl:inverseOf :q . :x :p :y .", ":y :q :x ."},
    {"prp-inv2", ":p owl:inverseOf :q . :x :q :y .", ":y :p :x ."},
    {"prp-key",
     ":C owl:hasKey :l1 . :l1 rdf:first :p . :l1 rdf:rest rdf:nil . :x a :C . :y a :C . :x :p :z . :y :p :z "
     ".",
     ":x owl:sameAs :y ."},
    {"prp-npa1",
     ":n owl:sourceIndividual :a . :n owl:assertionProperty :p . :n owl:targetIndividual :b . :a :p :b .",
     ""},
    {"prp-npa2",
     ":n owl:sourceIndividual :a . :n owl:assertionProperty :p . :n owl:targetValue 5 . :a :p 5 .", ""},
    {"cls-thing", "", "owl:Thing a owl:Class ."},
    {"cls-nothing1", "", "owl:Nothing a owl:Class ."},
    {"cls-nothing2", ":x a owl:Nothing .", ""},
    {"cls-int1",
     ":C owl:intersectionOf :l1 . :l1 rdf:first :A . :l1 rdf:rest :l2 . :l2 rdf:first :B . :l2 rdf:rest "
     "rdf:nil . :y "
     "a :A . :y a :B .",
     ":y a :C ."},
    {"cls-int2", ":C owl:intersectionOf :l1 . :l1 rdf:rest :l2 . :l2 rdf:first :B . :y a :C .", ":y a :B ."},
    {"cls-uni", ":C owl:unionOf :l1 . :l1 rdf:rest :l2 . :l2 rdf:first :B . :y a :B .", ":y a :C ."},
    {"cls-com", ":A owl:complementOf :B . :x a :A . :x a :B .", ""},
    {"cls-svf1", ":R owl:someValuesFrom :C . :R owl:onProperty :p . :u :p :v . :v a :C .", ":u a :R ."},
    {"cls-svf2", ":R owl:someValuesFrom owl:Thing . :R owl:onProperty :p . :u :p 5 .", ":u a :R ."},
    {"cls-avf", ":R owl:allValuesFrom :C . :R owl:onProperty :p . :u a :R . :u :p :v .", ":v a :C ."},
    {"cls-hv1", ":R owl:hasValue :v . :R owl:onProperty :p . :u a :R .", ":u :p :v ."},
    {"cls-hv2", ":R owl:hasValue 5 . :R owl:onProperty :p . :u :p 5 .", ":u a :R ."},
    {"cls-maxc1",
     ":R owl:maxCardinality \"0\"^^xsd:nonNegativeInteger . :R owl:onProperty :p . :u a :R . :u :p :v .", ""},
    {"cls-maxc2",
     ":R owl:maxCardinality \"1\"^^xsd:nonNegativeInteger . :R owl:onProperty :p . :u a :R . :u :p :v . :u "
     ":p :w .",
     ":v owl:sameAs :w ."},
    {"cls-maxqc1",
     ":R owl:maxQualifiedCardinality 0 . :R owl:onProperty :p . :R owl:onClass :C . :u a :R . :u :p :v . :v "
     "a :C .",
     ""},
    {"cls-maxqc2",
     ":R owl:maxQualifiedCardinality 0 . :R owl:onProperty :p . :R owl:onClass owl:Thing . :u a :R . :u :p "
     ":v .",
     ""},
    {"cls-maxqc3",
     ":R owl:maxQualifiedCardinality 1 . :R owl:onProperty :p . :R owl:onClass :C . :u a :R . :u :p :v . :v "
     "a :C . :u "
     ":p :w . :w a :C .",
     ":v owl:sameAs :w ."},
    {"cls-maxqc4",
     ":R owl:maxQualifiedCardinality 1 . :R owl:onProperty :p . :R owl:onClass owl:Thing . :u a :R . :u :p "
     ":v . :u :p "
     ":w .",
     ":v owl:sameAs :w ."},
    {"cls-oo", ":C owl:oneOf :l1 . :l1 rdf:rest :l2 . :l2 rdf:first :y .", ":y a :C ."},
    {"cax-sco", ":A rdfs:subClassOf :B . :x a :A .", ":x a :B ."},
    {"cax-eqc1", ":A owl:equivalentClass :B . :x a :A .", ":x a :B ."},
    {"cax-eqc2", ":A owl:equivalentClass :B . :x a :B .", ":x a :A ."},
    {"cax-dw", ":A owl:disjointWith :B . :x a :A . :x a :B .", ""},
    {"cax-adc",
     ":d a owl:AllDisjointClasses . :d owl:members :l1 . :l1 rdf:first :A . :l1 rdf:rest :l2 . :l2 rdf:first "
     ":B . :x "
     "a :A . :x a :B .",
     ""},
    {"dt-type1", "", "xsd:integer a rdfs:Datatype . xsd:dateTime a rdfs:Datatype ."},
    {"dt-diff", ":p a owl:FunctionalProperty . :x :p 5 . :x :p 6 .", ""},
    {"dt-diff",
     ":R owl:maxCardinality \"1\"^^xsd:nonNegativeInteger . :R owl:onProperty :p . :u a :R . :u :p \"a\" . "
     ":u "
     ":p \"b\" .",
     ""},
    {"dt-not-type", ":p rdfs:range xsd:integer . :x :p \"five\" .", ""},
    {"dt-not-type", ":R owl:allValuesFrom xsd:byte . :R owl:onProperty :p . :u a :R . :u :p 128 .", ""},
    {"scm-cls", ":C a owl:Class .", ":C rdfs:subClassOf :C , owl:Thing . :C owl:equivalentClass :C ."},
    {"scm-cls", ":C a owl:Class .", "owl:Nothing rdfs:subClassOf :C ."},
    {"scm-sco", ":A rdfs:subClassOf :B . :B rdfs:subClassOf :C .", ":A rdfs:subClassOf :C ."},
    {"scm-eqc1", ":A owl:equivalentClass :B .", ":A rdfs:subClassOf :B . :B rdfs:subClassOf :A ."},
    {"scm-eqc2", ":A rdfs:subClassOf :B . :B rdfs:subClassOf :A .", ":A owl:equivalentClass :B ."},
    {"scm-op", ":p a owl:ObjectProperty .", ":p rdfs:subPropertyOf :p . :p owl:equivalentProperty :p ."},
    {"scm-dp", ":p a owl:DatatypeProperty .", ":p rdfs:subPropertyOf :p . :p owl:equivalentProperty :p ."},
    {"scm-spo", ":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :r .", ":p rdfs:subPropertyOf :r ."},
    {"scm-eqp1", ":p owl:equivalentProperty :q .", ":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :p ."},
    {"scm-eqp2", ":p rdfs:subPropertyOf :q . :q rdfs:subPropertyOf :p .", ":p owl:equivalentProperty :q ."},
    {"scm-dom1", ":p rdfs:domain :A . :A rdfs:subClassOf :B .", ":p rdfs:domain :B ."},
    {"scm-dom2", ":q rdfs:domain :A . :p rdfs:subPropertyOf :q .", ":p rdfs:domain :A ."},
    {"scm-rng1", ":p rdfs:range :A . :A rdfs:subClassOf :B .", ":p rdfs:range :B ."},
    {"scm-rng2", ":q rdfs:range :A . :p rdfs:subPropertyOf :q .", ":p rdfs:range :A ."},
    {"scm-hv",
     ":R owl:hasValue :i . :R owl:onProperty :p . :S owl:hasValue :i . :S owl:onProperty :q . :p "
     "rdfs:subPropertyOf "
     ":q .",
     ":R rdfs:subClassOf :S ."},
    {"scm-svf1",
     ":R owl:someValuesFrom :A . :R owl:onProperty :p . :S owl:someValuesFrom :B . :S owl:onProperty :p . :A "
     "rdfs:subClassOf :B .",
     ":R rdfs:subClassOf :S ."},
    {"scm-svf2",
     ":R owl:someValuesFrom :A . :R owl:onProperty :p . :S owl:someValuesFrom :A . :S owl:onProperty :q . :p "
     "rdfs:subPropertyOf :q .",
     ":R rdfs:subClassOf :S ."},
    {"scm-avf1",
     ":R owl:allValuesFrom :A . :R owl:onProperty :p . :S owl:allValuesFrom :B . :S owl:onProperty :p . :A "
     "rdfs:subClassOf :B .",
     ":R rdfs:subClassOf :S ."},
    {"scm-avf2",
     ":R owl:allValuesFrom :A . :R owl:onProperty :p . :S owl:allValuesFrom :A . :S owl:onProperty :q . :p "
     "rdfs:subPropertyOf :q .",
     ":S rdfs:subClassOf :R ."},
    {"scm-int", ":C owl:intersectionOf :l1 . :l1 rdf:rest :l2 . :l2 rdf:first :B .",
     ":C rdfs:subClassOf :B ."},
    {"scm-uni", ":C owl:unionOf :l1 . :l1 rdf:rest :l2 . :l2 rdf:first :B .", ":B rdfs:subClassOf :C ."},
};

class World {
 public:
  World() {
    const std::string text = BuiltInRuleSet("owl2rl");
    const Diagnostics diagnostics = engine_.PutRules("owl2rl", text);
    EXPECT_TRUE(diagnostics.empty()) << Render(diagnostics, text);
    Change({}, {});
  }

  std::vector<Quad> Read(const char* turtle) {
    const ParsedRdf parsed = ParseRdf(std::string(kPrefixes) + turtle, RdfFormat::kTurtle, {});
    EXPECT_TRUE(parsed.ok()) << turtle << Render(parsed.diagnostics, turtle);
    std::vector<Quad> quads;
    for (const TermQuad& q : parsed.quads) {
      quads.push_back({dictionary_.Intern(q.subject), dictionary_.Intern(q.predicate),
                       dictionary_.Intern(q.object), graph_});
    }
    return quads;
  }
  void Change(const std::vector<Quad>& add, const std::vector<Quad>& remove) {
    const auto delta = engine_.Update(writer_, writer_.Apply(add, remove));
    ASSERT_TRUE(delta.ok()) << delta.status();
    engine_.Commit();
  }
  bool Holds(const std::vector<Quad>& quads) const {
    for (const Quad& q : quads) {
      if (!writer_.current().Scan({q.subject, q.predicate, q.object, TermId()}).Valid()) return false;
    }
    return true;
  }
  size_t Reports(const std::string& rule) {
    return writer_.current().Count({TermId(), dictionary_.InternIri(DocentIri("rule")),
                                    dictionary_.Intern(Term::Literal(rule)), TermId()});
  }
  bool Reported(const std::string& rule) { return Reports(rule) > 0; }
  uint64_t size() const { return writer_.current().size(); }

 private:
  Dictionary dictionary_;
  GraphWriter writer_{nullptr};
  RuleEngine engine_{dictionary_};
  const TermId graph_ = dictionary_.InternIri(kDefaultGraph);
};

TEST(Owl2Rl, EachRuleInfersAndNothingWithoutEachOfItsPremises) {
  World world;
  const uint64_t axioms = world.size();
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.rule);
    const std::vector<Quad> told = world.Read(c.told), follows = world.Read(c.follows);
    const auto holds = [&] { return follows.empty() ? world.Reported(c.rule) : world.Holds(follows); };
    world.Change(told, {});
    EXPECT_TRUE(holds()) << c.told;
    for (const Quad& premise : told) {
      world.Change({}, {premise});
      EXPECT_FALSE(holds()) << "without " << premise.predicate.bits();
      world.Change({premise}, {});
      EXPECT_TRUE(holds());
    }
    world.Change({}, told);
    EXPECT_EQ(world.size(), axioms) << "nothing is left when all is retracted";
  }
}

TEST(Owl2Rl, EveryRuleHasACase) {
  std::set<std::string> tested;
  for (const Case& c : kCases) tested.insert(c.rule);
  const ParsedRules parsed = ParseRules(BuiltInRuleSet("owl2rl"), "owl2rl");
  ASSERT_TRUE(parsed.ok());
  for (const Rule& rule : parsed.rules) {
    const std::string name = rule.name.substr(rule.name.find('#') + 1);
    EXPECT_TRUE(tested.contains(name)) << name;
  }
}

TEST(Owl2Rl, ListsAsLongAsTheLimits) {
  World world;
  std::string classes = ":C owl:intersectionOf (", types, chain = ":p owl:propertyChainAxiom (", steps;
  for (int i = 0; i < kIntersectionClasses; ++i) {
    absl::StrAppend(&classes, " :A", i);
    absl::StrAppend(&types, ":y a :A", i, " . ");
  }
  for (int i = 0; i < kChainProperties; ++i) {
    absl::StrAppend(&chain, " :q", i);
    absl::StrAppend(&steps, ":n", i, " :q", i, " :n", i + 1, " . ");
  }
  world.Change(world.Read(absl::StrCat(classes, ") . ", types, chain, ") . ", steps).c_str()), {});
  EXPECT_TRUE(world.Holds(world.Read(":y a :C .")));
  EXPECT_TRUE(world.Holds(world.Read(absl::StrCat(":n0 :p :n", kChainProperties, " .").c_str())));
}

TEST(Owl2Rl, AnIntersectionOfAnyNumberOfClasses) {
  World world;
  const uint64_t axioms = world.size();
  for (const int classes : {kIntersectionClasses + 1, 40}) {
    std::string list = ":C owl:intersectionOf (", types;
    for (int i = 0; i < classes; ++i) {
      absl::StrAppend(&list, " :A", i);
      absl::StrAppend(&types, ":y a :A", i, " . :z a :A", i, " . ");
    }
    const std::vector<Quad> told = world.Read((list + ") . " + types).c_str());
    world.Change(told, {});
    EXPECT_TRUE(world.Holds(world.Read(":y a :C . :z a :C ."))) << classes;
    for (const int i : {0, classes / 2, classes - 1}) {
      const std::vector<Quad> one = world.Read(absl::StrCat(":y a :A", i, " .").c_str());
      world.Change({}, one);
      EXPECT_FALSE(world.Holds(world.Read(":y a :C ."))) << i << " of " << classes;
      EXPECT_TRUE(world.Holds(world.Read(":z a :C ."))) << i << " of " << classes;
      world.Change(one, {});
      EXPECT_TRUE(world.Holds(world.Read(":y a :C ."))) << i << " of " << classes;
    }
    world.Change({}, told);
    EXPECT_EQ(world.size(), axioms) << "nothing is left when all is retracted";
  }
}

TEST(Owl2Rl, LiteralsOutsideTheDatatypeThatTheirPropertyAsksFor) {
  struct Value {
    const char* datatype;
    const char* literal;
    bool outside;
  };
  const Value kValues[] = {
      {"xsd:integer", "5", false},
      {"xsd:integer", "5.0", false},
      {"xsd:integer", "5.5", true},
      {"xsd:integer", "5.0e0", true},
      {"xsd:integer", "\"5\"", true},
      {"xsd:integer", "\"five\"^^xsd:integer", true},
      {"xsd:integer", ":five", false},
      {"xsd:decimal", "5", false},
      {"xsd:decimal", "-0.25", false},
      {"xsd:decimal", "true", true},
      {"xsd:nonNegativeInteger", "0", false},
      {"xsd:nonNegativeInteger", "-1", true},
      {"xsd:positiveInteger", "0", true},
      {"xsd:nonPositiveInteger", "0", false},
      {"xsd:negativeInteger", "0", true},
      {"xsd:byte", "-128", false},
      {"xsd:byte", "-129", true},
      {"xsd:unsignedShort", "65535", false},
      {"xsd:unsignedShort", "65536", true},
      {"xsd:int", "2147483648", true},
      {"xsd:long", "9223372036854775807", false},
      {"xsd:long", "9223372036854775808", true},
      {"xsd:unsignedLong", "18446744073709551615", false},
      {"xsd:double", "5.0e0", false},
      {"xsd:double", "5", true},
      {"xsd:double", "\"x\"^^xsd:double", true},
      {"xsd:float", "\"5\"^^xsd:float", false},
      {"xsd:string", "\"text\"", false},
      {"xsd:string", "\"token\"^^xsd:token", false},
      {"xsd:string", "\"Text\"@en", true},
      {"rdf:langString", "\"Text\"@en", false},
      {"xsd:string", "5", true},
      {"xsd:boolean", "true", false},
      {"xsd:boolean", "\"maybe\"^^xsd:boolean", true},
      {"xsd:boolean", "1", true},
      {"xsd:dateTime", "\"2026-11-22T02:00:00Z\"^^xsd:dateTime", false},
      {"xsd:dateTime", "\"2026-13-22T02:00:00Z\"^^xsd:dateTime", true},
      {"xsd:dateTimeStamp", "\"2026-11-22T02:00:00\"^^xsd:dateTime", true},
      {"xsd:dateTime", "\"yesterday\"", true},
      {"xsd:anyURI", "\"urn:x\"^^xsd:anyURI", false},
      {"rdfs:Literal", "5", false},
      {":Class", "5", false},
  };
  World world;
  for (const Value& value : kValues) {
    const std::vector<Quad> told =
        world.Read(absl::StrCat(":p rdfs:range ", value.datatype, " . :x :p ", value.literal, " .").c_str());
    world.Change(told, {});
    EXPECT_EQ(world.Reported("dt-not-type"), value.outside) << value.datatype << " " << value.literal;
    world.Change({}, told);
  }
}

TEST(Owl2Rl, TwoLiteralsWhereThereMayBeOneValue) {
  const char* const kDifferent[] = {
      "5 , 6",
      "5 , 5.5",
      "5 , 5.0e0",
      "5.0e0 , \"5\"^^xsd:float",
      "\"a\" , \"b\"",
      "\"a\"@en , \"a\"",
      "\"a\"@en , \"a\"@de",
      "\"a\"@en , \"b\"@en",
      "\"a\"^^xsd:token , \"b\"",
      "1 , \"1\"",
      "true , \"true\"",
      "true , false",
      "1 , true",
      "\"http://a\"^^xsd:anyURI , \"http://b\"^^xsd:anyURI",
      "\"http://a\"^^xsd:anyURI , \"http://a\"",
      "\"0A\"^^xsd:hexBinary , \"0B\"^^xsd:hexBinary",
      "\"AQ==\"^^xsd:base64Binary , \"Ag==\"^^xsd:base64Binary",
      "\"AQ==\"^^xsd:base64Binary , \"01\"^^xsd:hexBinary",
      "\"2026-11-22T02:00:00Z\"^^xsd:dateTime , \"2026-11-22T03:00:00Z\"^^xsd:dateTime",
      "\"2026-11-22T02:00:00Z\"^^xsd:dateTime , \"2026-11-22T02:00:00Z\"",
      "\"2026-11-22\"^^xsd:date , \"2026-11-23\"^^xsd:date",
  };
  const char* const kPerhapsOne[] = {
      "5 , 5.0",
      "5 , \"5\"^^xsd:int",
      "5 , \"05\"^^xsd:integer",
      "1.0e0 , 1e0",
      "true , \"1\"^^xsd:boolean",
      "\"a\" , \"a\"^^xsd:token",
      "\"a\"@en , \"a\"@EN",
      "\"a\" , :b",
      "\"0a\"^^xsd:hexBinary , \"0A\"^^xsd:hexBinary",
      "\"AQID BAUG\"^^xsd:base64Binary , \"AQIDBAUG\"^^xsd:base64Binary",
      "\"2026-11-22T02:00:00Z\"^^xsd:dateTime , \"2026-11-22T03:00:00+01:00\"^^xsd:dateTime",
      // ill-typed, or of an unknown datatype
      "\"five\"^^xsd:integer , \"six\"^^xsd:integer",
      "\"five\"^^xsd:integer , 5",
      "\"300\"^^xsd:byte , 5",
      "\"maybe\"^^xsd:boolean , true",
      "\"0G\"^^xsd:hexBinary , \"0H\"^^xsd:hexBinary",
      "\"A\"^^xsd:base64Binary , \"AQ==\"^^xsd:base64Binary",
      "\" a\"^^xsd:token , \"a\"",
      "\"yesterday\"^^xsd:dateTime , \"2026-11-22T02:00:00Z\"^^xsd:dateTime",
      "\"a\"^^:t , \"b\"^^:t",
      "\"a\"^^:t , \"a\"^^:u",
      "\"a\"^^:t , \"a\"",
      "\"a\"^^:t , 5",
  };
  World world;
  for (const char* axiom :
       {":p a owl:FunctionalProperty", ":R owl:maxCardinality 1 ; owl:onProperty :p . :x a :R"}) {
    const auto reports = [&](const char* values) {
      const std::vector<Quad> told = world.Read(absl::StrCat(axiom, " . :x :p ", values, " .").c_str());
      world.Change(told, {});
      const size_t count = world.Reports("dt-diff");
      world.Change({}, told);
      return count;
    };
    for (const char* values : kDifferent) EXPECT_EQ(reports(values), 1u) << values;
    for (const char* values : kPerhapsOne) EXPECT_EQ(reports(values), 0u) << values;
  }
}

TEST(Owl2Rl, AReportOfAThingThatIsEqualToAnotherForATimeStays) {
  World world;
  world.Change(world.Read(":A owl:disjointWith :B . :x a :A , :B ."), {});
  const uint64_t before = world.size();
  EXPECT_TRUE(world.Reported("cax-dw"));
  for (const char* equal : {":x owl:sameAs :y .", ":A owl:sameAs :C ."}) {
    world.Change(world.Read(equal), {});
    EXPECT_GT(world.size(), before);
    world.Change({}, world.Read(equal));
    EXPECT_EQ(world.size(), before) << equal;
  }
}

TEST(Owl2Rl, AChainOfEqualThingsIsCutInTheMiddle) {
  World world;
  std::string chain;
  for (int i = 0; i < 8; ++i) absl::StrAppend(&chain, ":e", i, " owl:sameAs :e", i + 1, " . ");
  world.Change(world.Read((chain + ":e0 :p :o . :s :q :e8 .").c_str()), {});
  EXPECT_TRUE(world.Holds(world.Read(":e8 :p :o . :e8 owl:sameAs :e0 . :s :q :e0 .")));
  world.Change({}, world.Read(":e4 owl:sameAs :e5 ."));
  EXPECT_TRUE(world.Holds(world.Read(":e4 :p :o . :s :q :e5 . :e4 owl:sameAs :e0 . :e8 owl:sameAs :e5 .")));
  EXPECT_FALSE(world.Holds(world.Read(":e5 :p :o .")));
  EXPECT_FALSE(world.Holds(world.Read(":s :q :e4 .")));
  EXPECT_FALSE(world.Holds(world.Read(":e8 owl:sameAs :e0 .")));
}

TEST(Rdfs, TheSetIsReadAndInfers) {
  EXPECT_TRUE(ParseRules(BuiltInRuleSet("rdfs"), "rdfs").ok())
      << Render(ParseRules(BuiltInRuleSet("rdfs"), "rdfs").diagnostics, BuiltInRuleSet("rdfs"));
  EXPECT_EQ(BuiltInRuleSets().size(), 2u);
  EXPECT_EQ(BuiltInRuleSet("nothing"), "");
}

}  // namespace
}  // namespace docent::rules
