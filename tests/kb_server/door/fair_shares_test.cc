#include "kb_server/door/fair_shares.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "kb_server/door/client.h"

namespace docent::server {
namespace {

constexpr absl::Duration kCredit = absl::Milliseconds(50);

TEST(FairSharesTest, WhoUsedLessGoesFirst) {
  Client a("a"), b("b");
  FairShares shares(kCredit);
  shares.Enter(&a);
  shares.Enter(&b);
  shares.Charge(&a, absl::Milliseconds(3));
  EXPECT_LT(shares.TimeOf(&b), shares.TimeOf(&a));
  shares.Charge(&b, absl::Milliseconds(4));
  EXPECT_LT(shares.TimeOf(&a), shares.TimeOf(&b));
}

TEST(FairSharesTest, WhoComesLaterPassesThoseWhoAreAlwaysThere) {
  Client busy("busy"), late("late");
  FairShares shares(kCredit);
  shares.Enter(&busy);
  shares.Charge(&busy, absl::Seconds(10));
  shares.Enter(&late);
  EXPECT_EQ(shares.TimeOf(&busy) - shares.TimeOf(&late), kCredit) << "and no more than the credit";
}

TEST(FairSharesTest, LeavingAndComingBackGainsNothing) {
  Client busy("busy"), sly("sly");
  FairShares shares(kCredit);
  shares.Enter(&busy);
  shares.Enter(&sly);
  shares.Charge(&sly, absl::Seconds(1));
  const absl::Duration before = shares.TimeOf(&sly);
  shares.Leave(&sly);
  shares.Enter(&sly);
  EXPECT_EQ(shares.TimeOf(&sly), before);
}

TEST(FairSharesTest, WhereNobodyHasWorkTheyBeginEqual) {
  Client a("a"), b("b");
  FairShares shares(kCredit);
  shares.Enter(&a);
  shares.Charge(&a, absl::Seconds(1));
  shares.Leave(&a);
  EXPECT_EQ(shares.active(), 0u);
  shares.Enter(&a);
  shares.Enter(&b);
  EXPECT_EQ(shares.TimeOf(&a), shares.TimeOf(&b));
}

// Random clients with random pieces on one processor with a clock of its own: pieces run in slices, the first in the order
// of the shares next. Whoever has work all the time gets its share of that time, but for the credit of each other client
// and a slice.
class Simulation {
 public:
  explicit Simulation(uint64_t seed) : random_(seed) {
    const size_t count = Draw(2, 40);
    for (size_t i = 0; i < count; ++i) clients_.push_back(std::make_unique<Simulated>(std::to_string(i)));
  }

  void Run() {
    shares_.Enter(&greedy_.client);
    for (int step = 0; step < 20000; ++step) {
      if (Draw(0, 3) == 0) Arrive(*clients_[Draw(0, clients_.size() - 1)]);
      RunSlice();
      ASSERT_GE(greedy_.served + Allowed(), greedy_.due) << "step " << step;
    }
  }

 private:
  static constexpr absl::Duration kSlice = absl::Milliseconds(2);
  struct Simulated {
    explicit Simulated(const std::string& name) : client(name) {}
    Client client;
    std::deque<absl::Duration> pieces;  // what each still needs
    absl::Duration served = absl::ZeroDuration(), due = absl::ZeroDuration();
  };

  size_t Draw(size_t least, size_t most) {
    return std::uniform_int_distribution<size_t>(least, most)(random_);
  }
  absl::Duration Allowed() const { return static_cast<int64_t>(clients_.size() + 1) * (kCredit + kSlice); }

  void Arrive(Simulated& to) {
    const bool small = Draw(0, 1) == 0;
    to.pieces.push_back(absl::Milliseconds(small ? Draw(1, 3) : Draw(10, 500)));
    shares_.Enter(&to.client);
  }

  void RunSlice() {
    Simulated* first = &greedy_;
    for (const auto& one : clients_) {
      if (!one->pieces.empty() && shares_.TimeOf(&one->client) < shares_.TimeOf(&first->client))
        first = one.get();
    }
    const absl::Duration used = first == &greedy_ ? kSlice : std::min(kSlice, first->pieces.front());
    greedy_.due += used / static_cast<int64_t>(shares_.active());
    first->served += used;
    shares_.Charge(&first->client, used);
    if (first == &greedy_) return;
    first->pieces.front() -= used;
    if (first->pieces.front() > absl::ZeroDuration()) return;
    first->pieces.pop_front();
    shares_.Leave(&first->client);
  }

  std::mt19937_64 random_;
  FairShares shares_{kCredit};
  Simulated greedy_{"always there"};
  std::vector<std::unique_ptr<Simulated>> clients_;
};

TEST(FairSharesTest, NobodyWaitsForMoreThanItsShare) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Simulation(seed).Run();
  }
}

}  // namespace
}  // namespace docent::server
