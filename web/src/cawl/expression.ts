// Boolean expressions over names, as rules, conditions and cases have them: "lies and not (asleep or away)". Pure functions.

export type Logic<Leaf> =
  { kind: "leaf"; leaf: Leaf } | { kind: "not"; of: Logic<Leaf> } | { kind: "and" | "or"; of: Logic<Leaf>[] }; // an empty "and" is true

const deepest = 100; // brackets and "not" inside each other
const token = /'(?:\\.|[^'\\])*'|[()]|[^\s()']\S*?(?=[\s()]|$)/g;

// Null: there is none, or it has a mistake, which the server's check tells.
export function readExpression(text: string): Logic<string> | null {
  const tokens = text.match(token) ?? [];
  if (tokens.length === 0 || text.replace(token, "").trim() !== "") return null;
  let at = 0;
  const word = () => (tokens[at] ?? "").toLowerCase();
  const sequence = (kind: "and" | "or"): Logic<string> | null => {
    const parts: Logic<string>[] = [];
    do {
      const part = kind === "or" ? sequence("and") : negation();
      if (!part) return null;
      parts.push(part);
    } while (word() === kind && ++at > 0);
    return joined(kind, parts);
  };
  let depth = 0;
  const deeper = <T>(inside: () => T | null): T | null => {
    const inner = ++depth > deepest ? null : inside();
    depth--;
    return inner;
  };
  const negation = (): Logic<string> | null => {
    const next = tokens[at++];
    if (next === undefined || next === ")") return null;
    if (next === "(") {
      const inner = deeper(() => sequence("or"));
      return inner && tokens[at++] === ")" ? inner : null;
    }
    if (next.toLowerCase() === "not") {
      const inner = deeper(negation);
      return inner && negated(inner);
    }
    if (next.toLowerCase() === "and" || next.toLowerCase() === "or") return null;
    return { kind: "leaf", leaf: next.startsWith("'") ? next.slice(1, -1).replace(/\\(.)/g, "$1") : next };
  };
  const whole = sequence("or");
  return at === tokens.length ? whole : null;
}

// Without layers that say nothing: "(a and b) and c" is "a and b and c".
export function joined<Leaf>(kind: "and" | "or", parts: readonly Logic<Leaf>[]): Logic<Leaf> {
  const of = parts.flatMap((part) => (part.kind === kind ? part.of : [part]));
  return of.length === 1 && of[0] ? of[0] : { kind, of };
}
// "not (a or b)" is "not a and not b". "not (a and b)" stays whole: no such thing exists, and its parts may share a thing.
export function negated<Leaf>(logic: Logic<Leaf>): Logic<Leaf> {
  if (logic.kind === "not") return logic.of;
  return logic.kind === "or" ? joined("and", logic.of.map(negated)) : { kind: "not", of: logic };
}

// Names replaced by what they stand for.
export function withLeaves<A, B>(logic: Logic<A>, of: (leaf: A) => Logic<B>): Logic<B> {
  if (logic.kind === "leaf") return of(logic.leaf);
  return logic.kind === "not"
    ? negated(withLeaves(logic.of, of))
    : joined(
        logic.kind,
        logic.of.map((part) => withLeaves(part, of)),
      );
}

// What must be, what must not be, what stands in both ways.
export type Sense = "must" | "must not" | "both";
export function senses<Leaf>(logic: Logic<Leaf>): Map<Leaf, Sense> {
  const found = new Map<Leaf, Sense>();
  const visit = (part: Logic<Leaf>, sense: Sense) => {
    if (part.kind === "leaf")
      found.set(part.leaf, (found.get(part.leaf) ?? sense) === sense ? sense : "both");
    else if (part.kind === "not") visit(part.of, sense === "must" ? "must not" : "must");
    else for (const one of part.of) visit(one, sense);
  };
  visit(logic, "must");
  return found;
}
