// Names of the kinds of findings about CAWL documents (Diagnostic::rule). They do not change: programs go by them, and
// docs/reference/findings.md explains each. Constants.
#ifndef DOCENT_WORKFLOW_CAWL_RULE_NAMES_H_
#define DOCENT_WORKFLOW_CAWL_RULE_NAMES_H_

namespace docent::cawl {

inline constexpr char kActivatorFeedsItself[] = "activator-feeds-itself";
inline constexpr char kActivatorNeverRises[] = "activator-never-rises";
inline constexpr char kAlwaysTrue[] = "always-true-condition";
inline constexpr char kLoopWithoutWait[] = "loop-without-wait";
inline constexpr char kMaxWithoutEffect[] = "max-without-effect";
inline constexpr char kNoWayToSink[] = "no-way-to-sink";
inline constexpr char kReleaseBeforeUse[] = "release-before-use";
inline constexpr char kRobotRace[] = "robot-race";
inline constexpr char kSharedStart[] = "shared-start";
inline constexpr char kTimeoutWithoutEffect[] = "timeout-without-effect";
inline constexpr char kTypeClash[] = "type-clash";
inline constexpr char kUndefinedTerm[] = "undefined-term";
inline constexpr char kUnknownInput[] = "unknown-input";
inline constexpr char kUnknownOperation[] = "unknown-operation";
inline constexpr char kUnknownOutput[] = "unknown-output";
inline constexpr char kUnreachableNode[] = "unreachable-node";
inline constexpr char kUnsatisfiable[] = "unsatisfiable-condition";
inline constexpr char kUnsetVariable[] = "unset-variable";
inline constexpr char kVariableRace[] = "variable-race";
inline constexpr char kWhileHoldsWithoutEffect[] = "while-holds-without-effect";

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_RULE_NAMES_H_
