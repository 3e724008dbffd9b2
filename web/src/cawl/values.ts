// Values as a document writes them, and as people do: "Hello" in quotes is Hello.
const stringType = "http://www.w3.org/2001/XMLSchema#string";
const term =
  /^(?:<[^<>\s]+>|[A-Za-z][\w-]*:[\w.-]+|[+-]?\d+(?:\.\d+)?|true|false|(["']).*\1(?:@[\w-]+|\^\^\S+)?)$/s;
const variable = /^\$[A-Za-z]\w*$/;

// The words of a text in quotes; all else as it is written.
export function shownValue(expression: string): string {
  const written = expression.trim();
  if (!/^"(?:[^"\\]|\\.)*"$/s.test(written)) return written;
  try {
    return String(JSON.parse(written));
  } catch {
    return written;
  }
}

// What somebody typed as an expression of the language. `type`: IRI of the class or datatype that is wanted; empty: not known.
// Throws RangeError with what is wrong.
export function writtenValue(typed: string, type: string): string {
  const text = typed.trim();
  if (text === "" || variable.test(text)) return text;
  if (type === stringType) return JSON.stringify(text);
  if (term.test(text)) return text;
  if (type === "") return JSON.stringify(text);
  throw new RangeError(
    `${text} is no value here. Choose one of the list, or write a name with its prefix (expo:B03)${/XMLSchema#/.test(type) ? " or a number" : ""}.`,
  );
}

export function isText(input: { name: string; type: string }): boolean {
  return input.type === stringType || (input.type === "" && input.name === "text");
}
