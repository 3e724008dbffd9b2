#include "bench/worlds/constraint_world.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"

namespace docent::bench {
namespace {

constexpr size_t kRooms = 64;
constexpr size_t kVisitorsOfARoom = 64;
constexpr size_t kMostTold = 16;  // facts of a shape that are asserted at the same time

Term Named(const std::string& name) {
  return Term::Iri(absl::StrCat(kConstraintNs, name));
}
TermQuad Fact(const std::string& s, const std::string& p, Term object) {
  return {Named(s), Named(p), std::move(object), Term()};
}
TermQuad Fact(const std::string& s, const std::string& p, const std::string& o) {
  return Fact(s, p, Named(o));
}

Term Reading(size_t whole, uint64_t serial) {
  return Term::Literal(absl::StrCat(whole, ".", 100000000 + serial % 899999999), std::string(kXsdDecimal));
}

struct Place {
  ConstraintShape shape;
  size_t n;  // number within its shape
};

Place PlaceOf(size_t i) {
  switch (i % 6) {
    case 0:
    case 1:
      return {ConstraintShape::kThreshold, i / 6 * 2 + i % 6};
    case 2:
    case 3:
      return {ConstraintShape::kJoin, i / 6 * 2 + i % 6 - 2};
    case 4:
      return {ConstraintShape::kNegated, i / 6};
    default:
      return {ConstraintShape::kFree, i / 6};
  }
}

size_t NumberOf(ConstraintShape shape, size_t n) {
  switch (shape) {
    case ConstraintShape::kThreshold:
      return n / 2 * 6 + n % 2;
    case ConstraintShape::kJoin:
      return n / 2 * 6 + n % 2 + 2;
    case ConstraintShape::kNegated:
      return n * 6 + 4;
    case ConstraintShape::kFree:
      return n * 6 + 5;
  }
  return 0;
}

size_t FirstLevel(size_t count) {
  return count / 6;
}  // half of the thresholds hold

}  // namespace

const char* NameOf(ConstraintShape shape) {
  switch (shape) {
    case ConstraintShape::kThreshold:
      return "threshold";
    case ConstraintShape::kJoin:
      return "join";
    case ConstraintShape::kNegated:
      return "negated";
    case ConstraintShape::kFree:
      return "free variable";
  }
  return "";
}

StandingConstraint StandingConstraintNumber(size_t i) {
  const auto [shape, n] = PlaceOf(i);
  switch (shape) {
    case ConstraintShape::kThreshold:
      return {shape, absl::StrCat("ASK { ?s :reading ?value . FILTER(?value > ", n, ") }"), {}};
    case ConstraintShape::kJoin:
      return {shape, absl::StrCat("ASK { ?v :at :room", n % kRooms, " . ?v :wants :topic", n, " }"), {}};
    case ConstraintShape::kNegated:
      return {shape,
              absl::StrCat("ASK { :person", n, " :at ?r . FILTER NOT EXISTS { :person", n, " :badge ?b } }"),
              {}};
    case ConstraintShape::kFree:
      return {shape, absl::StrCat("ASK { ?v :carries ?item . ?item :ownedBy :owner", n, " }"), {"v"}};
  }
  return {};
}

std::vector<TermQuad> ConstraintBackground(size_t count) {
  std::vector<TermQuad> facts;
  for (size_t v = 0; v < kRooms * kVisitorsOfARoom; ++v) {
    facts.push_back(Fact(absl::StrCat("visitor", v), "at", absl::StrCat("room", v % kRooms)));
  }
  for (size_t n = 0; n <= count / 6; ++n) {
    facts.push_back(Fact(absl::StrCat("person", n), "at", absl::StrCat("hall", n % kRooms)));
    facts.push_back(Fact(absl::StrCat("item", n), "ownedBy", absl::StrCat("owner", n)));
  }
  facts.push_back(Fact("sensor", "reading", Reading(FirstLevel(count), 0)));
  return facts;
}

TermQuad FactThatFlips(ConstraintShape shape, size_t n, uint64_t draw, uint64_t serial) {
  switch (shape) {
    case ConstraintShape::kThreshold:
      return Fact("sensor", "reading", Reading(n, serial));
    case ConstraintShape::kJoin:
      return Fact(absl::StrCat("visitor", draw % kVisitorsOfARoom * kRooms + n % kRooms), "wants",
                  absl::StrCat("topic", n));
    case ConstraintShape::kNegated:
      return Fact(absl::StrCat("person", n), "badge",
                  Term::Literal(absl::StrCat(serial), std::string(kXsdInteger)));
    case ConstraintShape::kFree:
      return Fact(absl::StrCat("carrier", serial), "carries", absl::StrCat("item", n));
  }
  return {};
}

size_t ConstraintsOfShape(ConstraintShape shape, size_t count) {
  const size_t rounds = count / 6;
  return shape == ConstraintShape::kThreshold || shape == ConstraintShape::kJoin ? rounds * 2 : rounds;
}

ConditionUpdates::ConditionUpdates(size_t count, uint32_t seed)
    : count_(count), random_(seed), level_(FirstLevel(count)), told_(kConstraintShapes) {}

void ConditionUpdates::NewBatch() {
  batches_ = true;
  used_.clear();
}

bool ConditionUpdates::IsUsed(ConstraintShape shape, size_t n) const {
  return std::find(used_.begin(), used_.end(), NumberOf(shape, n)) != used_.end();
}

ConditionUpdates::Update ConditionUpdates::Next() {
  while (true) {
    const ConstraintShape shape = PlaceOf(random_() % 6).shape;
    const std::vector<Told>& told = told_[static_cast<size_t>(shape)];
    const size_t most = std::min(kMostTold, CountOf(shape) / 4);
    const bool add = told.empty() || (told.size() < most && random_() % 2 == 0);
    std::optional<Update> update = add ? Tell(shape) : Retract(shape);
    if (!update) continue;
    if (batches_) used_.push_back(update->constraint);
    return *std::move(update);
  }
}

std::optional<ConditionUpdates::Update> ConditionUpdates::Tell(ConstraintShape shape) {
  std::vector<Told>& told = told_[static_cast<size_t>(shape)];
  ++serial_;
  size_t n = 0;
  if (shape == ConstraintShape::kThreshold) {
    if (IsUsed(shape, level_ + 1)) return std::nullopt;
    n = ++level_;
  } else {
    const auto stands = [&](size_t at) {
      return std::any_of(told.begin(), told.end(), [at](const Told& t) { return t.n == at; });
    };
    do {
      n = random_() % CountOf(shape);
    } while (stands(n) || IsUsed(shape, n));
  }
  TermQuad fact = FactThatFlips(shape, n, random_(), serial_);
  told.push_back({n, fact});
  return Update{shape, true, std::move(fact), NumberOf(shape, n)};
}

std::optional<ConditionUpdates::Update> ConditionUpdates::Retract(ConstraintShape shape) {
  std::vector<Told>& told = told_[static_cast<size_t>(shape)];
  // for readings the highest one: removing a lower one flips nothing
  const size_t at = shape == ConstraintShape::kThreshold ? told.size() - 1 : random_() % told.size();
  if (IsUsed(shape, told[at].n)) return std::nullopt;
  std::swap(told[at], told.back());
  Told gone = std::move(told.back());
  told.pop_back();
  if (shape == ConstraintShape::kThreshold) --level_;
  return Update{shape, false, std::move(gone.fact), NumberOf(shape, gone.n)};
}

}  // namespace docent::bench
