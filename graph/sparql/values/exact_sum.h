// Exact sum of doubles, rounded once. It is the same for any order of the doubles, so a recomputed sum is the
// same term. (Exception: if a partial sum is beyond the largest double, one order may overflow and another
// not.) Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997 (growing an expansion of parts that do
// not overlap). Value; one thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_EXACT_SUM_H_
#define DOCENT_GRAPH_SPARQL_VALUES_EXACT_SUM_H_

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace docent::sparql {

class ExactSum {
 public:
  void Add(double x) {
    if (!std::isfinite(x)) {
      special_ += x;
      return;
    }
    size_t kept = 0;
    for (double part : parts_) {
      if (std::fabs(x) < std::fabs(part)) std::swap(x, part);
      const double high = x + part;
      const double low = part - (high - x);
      if (low != 0) parts_[kept++] = low;
      x = high;
    }
    parts_.resize(kept);
    parts_.push_back(x);
    if (!std::isfinite(x)) {  // beyond the largest double
      special_ += x;
      parts_.clear();
    }
  }

  double Result() const {
    if (special_ != 0) return special_;  // infinite or no number
    if (parts_.empty()) return 0;
    size_t i = parts_.size() - 1;  // the largest stands last
    double high = parts_[i], low = 0;
    while (i > 0 && low == 0) {
      const double x = high, part = parts_[--i];
      high = x + part;
      low = part - (high - x);
    }
    // Half way between two doubles: the lower parts decide.
    if (i > 0 && ((low < 0 && parts_[i - 1] < 0) || (low > 0 && parts_[i - 1] > 0))) {
      const double twice = low * 2, up = high + twice;
      if (up - high == twice) high = up;
    }
    return high;
  }

 private:
  std::vector<double> parts_;  // without overlap, growing
  double special_ = 0;         // sum of the values that are not finite
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_EXACT_SUM_H_
