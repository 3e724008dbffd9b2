// How the parts of a condition belong together: its expressions, with rows, events and times in the places of their names.
import type { Condition, Constraint, Context, Rule, Time } from "./document";
import { joined, type Logic, readExpression, type Sense, senses, withLeaves } from "./expression";

export type ConditionPart =
  | { kind: "row"; row: Constraint }
  | { kind: "event"; operation: string }
  | { kind: "time"; time: Time }
  | { kind: "unknown"; name: string };
export type ConditionLogic = Logic<ConditionPart>;

type Named = readonly [name: string, logic: ConditionLogic];
const leaf = (part: ConditionPart): ConditionLogic => ({ kind: "leaf", leaf: part });

// The children by the expression over their names; without one, or while it has a mistake, all of them.
function combined(expression: string, children: readonly Named[], otherwise: "and" | "or"): ConditionLogic {
  const read = expression ? readExpression(expression) : null;
  const byName = new Map([...children].reverse());
  if (!read)
    return joined(
      otherwise,
      children.map(([, logic]) => logic),
    );
  return withLeaves(read, (name) => byName.get(name) ?? leaf({ kind: "unknown", name }));
}

export function ruleLogic(rule: Rule): ConditionLogic {
  const rows = rule.constraints.map((row): Named => [row.name, leaf({ kind: "row", row })]);
  const times = rule.times.map((time): Named => [time.name, leaf({ kind: "time", time })]);
  return combined(rule.expression, [...rows, ...times], "and");
}
export function contextLogic(context: Context): ConditionLogic {
  return joined("and", [
    ...context.rules.map(ruleLogic),
    ...context.times.map((time) => leaf({ kind: "time", time })),
  ]);
}
export function conditionLogic(condition: Condition): ConditionLogic {
  const contexts = condition.contexts.map((context): Named => [context.name, contextLogic(context)]);
  const events = condition.events.map((operation): Named => [operation, leaf({ kind: "event", operation })]);
  const whole: Named[] = condition.caseElement
    ? [...contexts, [condition.caseName, combined(condition.caseExpression, events, "and")]]
    : contexts;
  if (whole.length === 0) return { kind: "and", of: [] };
  return combined(condition.expression, whole, "or");
}

function rowSenses(logic: ConditionLogic): ReadonlyMap<Constraint, Sense> {
  return new Map(
    [...senses(logic)].flatMap(([part, sense]) => (part.kind === "row" ? [[part.row, sense] as const] : [])),
  );
}
// Of a row in its rule. Undefined: the rule's expression does not name it, and it is not looked at.
export function senseInRule(rule: Rule, row: Constraint): Sense | undefined {
  return rowSenses(ruleLogic(rule)).get(row);
}
// Of a situation in its condition; undefined as above.
export function senseOfContext(condition: Condition, context: Context): Sense | undefined {
  const read = condition.expression ? readExpression(condition.expression) : null;
  return read ? senses(read).get(context.name) : "must";
}
// The rows that a condition needs, in some way to meet it. What must not be gives nothing a value.
export function neededRows(condition: Condition | null): Constraint[] {
  return condition
    ? [...rowSenses(conditionLogic(condition))]
        .filter(([, sense]) => sense !== "must not")
        .map(([row]) => row)
    : [];
}
// Whether each way to meet the condition has one of such rows.
export function eachWayHas(condition: Condition, is: (row: Constraint) => boolean): boolean {
  const has = (logic: ConditionLogic): boolean => {
    if (logic.kind === "leaf") return logic.leaf.kind === "row" && is(logic.leaf.row);
    if (logic.kind === "not") return false;
    return logic.kind === "and" ? logic.of.some(has) : logic.of.length > 0 && logic.of.every(has);
  };
  return has(conditionLogic(condition));
}
