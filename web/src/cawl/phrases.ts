// Conditions and links in words for people: "robot status Standby" for <subject>?robot</subject> and so on.
import { conditionLogic, type ConditionLogic, type ConditionPart } from "./condition_logic";
import type { Condition, Constraint, Time } from "./document";
import { words } from "./names";

// "docent:isAt" is "is at", "$user" is "user", "expo:B03" is "B03".
export function termWords(term: string): string {
  const text = term.trim();
  if (text === "a") return "is a";
  if (/^[?$]/.test(text)) return text.slice(1).replace(/^_/, "");
  const literal = /^(["'])([\s\S]*)\1(@\S+|\^\^\S+)?$/.exec(text);
  if (literal) return `“${literal[2]}”`;
  if (/^[<>=!]/.test(text) && !/^<[^ ]+>$/.test(text))
    return text.replace(/\S+$/, (value) => termWords(value));
  return text.replace(/^<(.*)>$/, "$1").replace(/^.*[#/:](?=[^#/:]+$)/, "");
}
export function verbWords(verb: string): string {
  const plain = termWords(verb);
  return plain === "is a" ? plain : words(plain).toLowerCase();
}
export function constraintWords(constraint: Constraint): string {
  return [
    termWords(constraint.subject.text),
    verbWords(constraint.verb.text),
    termWords(constraint.object.text),
  ]
    .filter(Boolean)
    .join(" ");
}
// <ext:time at="18:00" days="Mon-Fri"/> is "at 18:00 days Mon-Fri".
export function timeWords(time: Time): string {
  return time.attributes
    .filter(([name, value]) => !(name === "aligned" || name === "missed") && value)
    .map(([name, value]) => `${name} ${name === "open" ? termWords(value) : value}`)
    .join(" ");
}
function partWords(part: ConditionPart): string {
  switch (part.kind) {
    case "row":
      return constraintWords(part.row);
    case "event":
      return `event ${part.operation}`;
    case "time":
      return timeWords(part.time);
    case "unknown":
      return part.name;
  }
}
// "(near or called) and not (robot status Busy)"
export function logicWords(logic: ConditionLogic): string {
  if (logic.kind === "leaf") return partWords(logic.leaf);
  if (logic.kind === "not") return `not (${logicWords(logic.of)})`;
  return logic.of
    .map((part) => (logic.kind === "and" && part.kind === "or" ? `(${logicWords(part)})` : logicWords(part)))
    .join(` ${logic.kind} `);
}

export interface CardRow {
  words: string;
  isNot: boolean; // it must not be
}
// Rows of a condition for a card: one for each part of what has to hold together, or for each way to meet it.
export function conditionRows(condition: Condition): CardRow[] {
  const logic = conditionLogic(condition);
  const parts = logic.kind === "and" || logic.kind === "or" ? logic.of : [logic];
  return parts.map((part, i) => ({
    words: `${logic.kind === "or" && i > 0 ? "or " : ""}${logicWords(part)}`,
    isNot: part.kind === "not",
  }));
}
