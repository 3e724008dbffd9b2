// Conditions and links in words for people: "robot status Standby" for <subject>?robot</subject> and so on.
import type { Condition, Constraint } from "./document";
import { words } from "./names";

// "docent:isAt" is "is at", "$user" is "user", "expo:B03" is "B03".
export function termWords(term: string): string {
  const text = term.trim();
  if (text === "a") return "is a";
  if (/^[?$]/.test(text)) return text.slice(1).replace(/^_/, "");
  const literal = /^(["'])([\s\S]*)\1(@\S+|\^\^\S+)?$/.exec(text);
  if (literal) return `“${literal[2]}”`;
  if (/^[<>=!]/.test(text) && !/^<[^ ]+>$/.test(text)) return text.replace(/\S+$/, (value) => termWords(value));
  return text.replace(/^<(.*)>$/, "$1").replace(/^.*[#/:](?=[^#/:]+$)/, "");
}
export function verbWords(verb: string): string {
  const plain = termWords(verb);
  return plain === "is a" ? plain : words(plain).toLowerCase();
}
export function constraintWords(constraint: Constraint): string {
  return [termWords(constraint.subject.text), verbWords(constraint.verb.text), termWords(constraint.object.text)].filter(Boolean).join(" ");
}
// Rows of a condition for a card, one a constraint.
export function conditionRows(condition: Condition): string[] {
  const rows = condition.contexts.flatMap((context) => context.rules.flatMap((rule) => rule.constraints.map(constraintWords)));
  return [...condition.events.map((event) => `event ${event}`), ...rows];
}
