// Missing facts that people may tell.
import { iriOf, quadOf } from "../api/terms";
import type { MissingSet } from "../gen/docent/v1/context_pb";
import type { Quad } from "../gen/docent/v1/term_pb";
import { isOwnFact, type Known } from "./no_robot";

const isOwn = (quad: Quad, robots: readonly Known[]) =>
  isOwnFact(iriOf(quad.subject), iriOf(quad.predicate), robots);
// Of what a set adds, what is not for the robots alone to tell.
export function tellable(set: Pick<MissingSet, "add">, robots: readonly Known[]): Quad[] {
  return set.add.filter((quad) => !isOwn(quad, robots)).map(quadOf);
}
