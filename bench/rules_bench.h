// `docent-bench rules`: closure of generated university data, one fact added and removed, a subclass axiom
// removed and added; compared with SWI-Prolog and EYE if they are installed. In process, one core.
#ifndef DOCENT_BENCH_RULES_BENCH_H_
#define DOCENT_BENCH_RULES_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code: 0 measured, 1 a target is missed, 2 bad usage.
int RunRulesBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_RULES_BENCH_H_
