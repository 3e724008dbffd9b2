// Names in a document and in the expressions over them.

// `base`, or `base 2`, `base 3`… where it is taken.
export function uniqueName(taken: ReadonlySet<string>, base: string): string {
  if (!taken.has(base)) return base;
  const stem = base.replace(/ ?\d+$/, "");
  const gap = /\s/.test(stem) ? " " : "";
  for (let number = 2; ; number++) {
    const name = `${stem}${gap}${number}`;
    if (!taken.has(name)) return name;
  }
}

// "moveToUser" is "Move to user" for people; what has blanks is written for people already.
export function words(name: string): string {
  if (/\s/.test(name.trim())) return name;
  const spaced = name
    .replace(/[_-]+/g, " ")
    .replace(/([a-z0-9])([A-Z])/g, "$1 $2")
    .trim();
  return spaced === ""
    ? name
    : spaced.charAt(0).toUpperCase() + spaced.slice(1).replace(/ [A-Z](?=[a-z])/g, (c) => c.toLowerCase());
}

// The text as a part of a pattern that matches just it.
export function literally(text: string): string {
  return text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
}

const token = /'(?:\\.|[^'\\])*'|[()]|[^\s()']+|\s+/g;
const keywords = new Set(["and", "or", "not"]);

export function quoteName(name: string): string {
  return keywords.has(name) || /[\s()'\\]/.test(name) ? `'${name.replace(/[\\']/g, "\\$&")}'` : name;
}

// An expression with a name in the place of another; all else stays as it is written.
export function renameInExpression(expression: string, before: string, after: string): string {
  return expression.replace(token, (word) => {
    if (keywords.has(word)) return word;
    const name = word.startsWith("'") ? word.slice(1, -1).replace(/\\(.)/g, "$1") : word;
    return name === before ? quoteName(after) : word;
  });
}
