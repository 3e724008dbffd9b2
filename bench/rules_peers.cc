#include "bench/rules_peers.h"

#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "bench/peer_process.h"
#include "bench/worlds/university_data.h"

namespace docent::bench {
namespace {

constexpr int kTimeoutSeconds = 180;

// The ten rules as one tabled predicate; subjects, predicates and objects are atoms.
constexpr char kProlog[] = R"pl(
:- dynamic t/3.
:- table i/3.
i(S,P,O) :- t(S,P,O).
i(A,subClassOf,C) :- i(A,subClassOf,B), i(B,subClassOf,C).
i(X,type,B) :- i(A,subClassOf,B), i(X,type,A).
i(A,subPropertyOf,C) :- i(A,subPropertyOf,B), i(B,subPropertyOf,C).
i(X,Q,Y) :- i(P,subPropertyOf,Q), i(X,P,Y).
i(X,type,C) :- i(P,domain,C), i(X,P,_).
i(Y,type,C) :- i(P,range,C), i(_,P,Y).
i(X,P,Z) :- i(P,type,'TransitiveProperty'), i(X,P,Y), i(Y,P,Z).
i(Y,P,X) :- i(P,type,'SymmetricProperty'), i(X,P,Y).
i(Y,Q,X) :- i(P,inverseOf,Q), i(X,P,Y).
i(Y,P,X) :- i(P,inverseOf,Q), i(X,Q,Y).
go(File) :- load(File), statistics(cputime,A), aggregate_all(count, i(_,_,_), N), aggregate_all(count, t(_,_,_), M),
  statistics(cputime,B), T is B-A, I is N-M, format("inferred ~d~nseconds ~f~n", [I,T]).
load(File) :- open(File, read, In), repeat, read_term(In, X, []), ( X == end_of_file -> !, close(In) ; assertz(X), fail ).
main :- current_prolog_flag(argv, Argv), last(Argv, F), set_prolog_flag(table_space, 12000000000), go(F), halt.
:- initialization(main, main).
)pl";

constexpr char kEye[] = R"n3(
@prefix : <http://example.org/univ#> .
{?a :subClassOf ?b. ?b :subClassOf ?c} => {?a :subClassOf ?c}.
{?a :subClassOf ?b. ?x :type ?a} => {?x :type ?b}.
{?a :subPropertyOf ?b. ?b :subPropertyOf ?c} => {?a :subPropertyOf ?c}.
{?p :subPropertyOf ?q. ?x ?p ?y} => {?x ?q ?y}.
{?p :domain ?c. ?x ?p ?y} => {?x :type ?c}.
{?p :range ?c. ?x ?p ?y} => {?y :type ?c}.
{?p :type :TransitiveProperty. ?x ?p ?y. ?y ?p ?z} => {?x ?p ?z}.
{?p :type :SymmetricProperty. ?x ?p ?y} => {?y ?p ?x}.
{?p :inverseOf ?q. ?x ?p ?y} => {?y ?q ?x}.
{?p :inverseOf ?q. ?x ?q ?y} => {?y ?p ?x}.
)n3";

void Note(const std::string& system, size_t facts, double inferred, double seconds, const std::string& reason,
          std::vector<Measurement>& out, const char* rate = "closure rate") {
  const std::string name = absl::StrCat(facts, " facts, 10 rules");
  const auto add = [&](const char* metric, const char* unit, double value) {
    Measurement m{"rules", name, system, metric, unit, {}, reason};
    if (reason.empty()) m.runs.push_back(value);
    out.push_back(std::move(m));
  };
  add("inferred", "facts", inferred);
  add(rate, "facts/s", inferred / seconds);
}

template <typename Line>
void WriteFacts(const std::string& path, size_t facts, Line line) {
  std::ofstream file(path);
  const TripleSink sink = [&](const std::string& s, const std::string& p, const std::string& o) {
    file << line(s, p, o) << "\n";
  };
  UniversityOntology(sink);
  UniversityFacts(facts, sink);
}

void MeasureProlog(const std::string& folder, size_t facts, std::vector<Measurement>& out) {
  if (!Installed("swipl"))
    return Note("SWI-Prolog, one table", facts, 0, 1, "not installed: swi-prolog-nox", out);
  if (facts > 100000)
    return Note("SWI-Prolog, one table", facts, 0, 1, "not asked: minutes; see the smaller sizes", out);
  WriteFacts(folder + "/facts.pl", facts,
             [](const std::string& s, const std::string& p, const std::string& o) {
               return absl::StrCat("t('", s, "','", p, "','", o, "').");
             });
  std::ofstream(folder + "/rules.pl") << kProlog;
  const std::string text = RunAndRead(
      "swipl --stack-limit=8g -O '" + folder + "/rules.pl' -- '" + folder + "/facts.pl'", kTimeoutSeconds);
  const double inferred = NumberAfter(text, "inferred"), seconds = NumberAfter(text, "seconds");
  Note("SWI-Prolog, one table", facts, inferred, seconds,
       inferred < 0 || seconds < 0 ? "no answer in time" : "", out);
}

// Includes process start, parsing and printing: EYE reports only the total time.
void MeasureEye(const std::string& folder, size_t facts, std::vector<Measurement>& out) {
  const auto note = [&](double inferred, double seconds, const std::string& reason) {
    Note("EYE", facts, inferred, seconds, reason, out, "file to closure");
  };
  if (!Installed("eye.pvm")) return note(0, 1, "not installed: eye");
  if (facts > 100000)
    return note(0, 1, "not asked: over a minute, and its stack ends at 1 GB; see the smaller sizes");
  WriteFacts(folder + "/facts.n3", facts,
             [first = true](const std::string& s, const std::string& p, const std::string& o) mutable {
               const char* prefix =
                   std::exchange(first, false) ? "@prefix : <http://example.org/univ#> .\n" : "";
               return absl::StrCat(prefix, ":", s, " :", p, " :", o, ".");
             });
  std::ofstream(folder + "/rules.n3") << kEye;
  const auto start = std::chrono::steady_clock::now();
  const std::string text = RunAndRead(
      "eye.pvm --nope --pass-only-new '" + folder + "/facts.n3' '" + folder + "/rules.n3'", kTimeoutSeconds);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // the last line but one: #2026-… in=… out=NEW ent=…
  const size_t at = text.rfind(" out=");
  double inferred = -1;
  if (at == std::string::npos ||
      !absl::SimpleAtod(text.substr(at + 5, text.find(' ', at + 5) - at - 5), &inferred))
    return note(0, 1, "no answer in time");
  note(inferred, seconds, "");
}

}  // namespace

std::vector<Measurement> MeasureRulePeers(size_t facts) {
  std::vector<Measurement> out;
  const PeerFolder temporary;
  const std::string& folder = temporary.path();
  if (folder.empty()) return out;
  MeasureProlog(folder, facts, out);
  MeasureEye(folder, facts, out);
  return out;
}

}  // namespace docent::bench
