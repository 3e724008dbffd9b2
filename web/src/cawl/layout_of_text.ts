// How a text is laid out, and how a piece is put in or taken out so that the rest keeps its bytes and the piece looks as if
// the author had written it.
import { encodeAttribute, encodeText, type XmlElement } from "./xml";

export interface Change {
  from: number;
  to: number;
  insert: string;
}

// An element to be written.
export interface Piece {
  name: string; // local name, before which the document's prefix is put; or a name with a prefix of another namespace
  attributes?: readonly (readonly [name: string, value: string])[];
  text?: string;
  children?: readonly Piece[];
}

export class TextLayout {
  readonly newline: string;
  readonly unit: string; // one level of indentation
  private readonly prefix: string;
  private readonly opened = new Map<XmlElement, { change: Change; tail: string }>(); // self-closing ones that have got children

  constructor(
    private readonly text: string,
    root: XmlElement,
  ) {
    this.newline = text.includes("\r\n") ? "\r\n" : "\n";
    const first = root.children.find((child) => this.startsLine(child.from));
    const outer = this.indentAt(root.from);
    const inner = first ? this.indentAt(first.from) : "";
    this.unit = inner.length > outer.length && inner.startsWith(outer) ? inner.slice(outer.length) : "  ";
    this.prefix = root.name.includes(":") ? root.name.slice(0, root.name.indexOf(":") + 1) : "";
  }

  // Blanks between the line's beginning and `offset`; what else stands there ends them.
  indentAt(offset: number): string {
    const line = this.lineStart(offset);
    return /^[ \t]*/.exec(this.text.slice(line, offset))?.[0] ?? "";
  }
  startsLine(offset: number): boolean {
    return this.text.slice(this.lineStart(offset), offset).trim() === "";
  }
  private lineStart(offset: number): number {
    return this.text.lastIndexOf("\n", offset - 1) + 1;
  }
  // Whether an empty line stands before the line of `offset`.
  private emptyLineBefore(offset: number): boolean {
    const line = this.lineStart(offset);
    return line > 0 && this.text.slice(this.lineStart(line - 1), line).trim() === "";
  }

  render(piece: Piece, indent: string): string {
    const name = piece.name.includes(":") ? piece.name : this.prefix + piece.name;
    const attributes = (piece.attributes ?? [])
      .map(([key, value]) => {
        const quote = value.includes('"') && !value.includes("'") ? "'" : '"';
        return ` ${key}=${quote}${encodeAttribute(value, quote)}${quote}`;
      })
      .join("");
    if (piece.text !== undefined) return `<${name}${attributes}>${encodeText(piece.text)}</${name}>`;
    if (!piece.children || piece.children.length === 0) return `<${name}${attributes}/>`;
    const inner = piece.children
      .map((child) => this.newline + indent + this.unit + this.render(child, indent + this.unit))
      .join("");
    return `<${name}${attributes}>${inner}${this.newline}${indent}</${name}>`;
  }

  // After `sibling`, in the way that it is laid out itself. `spaced`: with an empty line where the sibling has one.
  insertAfter(sibling: XmlElement, content: (indent: string) => string, spaced = false): Change {
    const indent = this.indentAt(sibling.from);
    if (!this.startsLine(sibling.from)) return { from: sibling.to, to: sibling.to, insert: content(indent) };
    const gap = spaced && this.emptyLineBefore(sibling.from) ? this.newline + this.newline : this.newline;
    return { from: sibling.to, to: sibling.to, insert: gap + indent + content(indent) };
  }

  insertBefore(sibling: XmlElement, content: (indent: string) => string): Change {
    const indent = this.indentAt(sibling.from);
    const insert = this.startsLine(sibling.from) ? content(indent) + this.newline + indent : content(indent);
    return { from: sibling.from, to: sibling.from, insert };
  }

  // As the first child; into an element that is opened for it already, as the last. Null: it is a part of that change.
  insertFirst(parent: XmlElement, content: (indent: string) => string): Change | null {
    const outer = this.indentAt(parent.from);
    const indent = outer + this.unit;
    const piece = this.newline + indent + content(indent);
    if (parent.selfClosing) {
      const opened = this.opened.get(parent);
      if (opened) {
        opened.change.insert = opened.change.insert.slice(0, -opened.tail.length) + piece + opened.tail;
        return null;
      }
      const slash = this.text.lastIndexOf("/", parent.to - 1);
      const from = this.text.slice(0, slash).trimEnd().length;
      const tail = `${this.newline}${outer}</${parent.name}>`;
      const change = { from, to: parent.to, insert: `>${piece}${tail}` };
      this.opened.set(parent, { change, tail });
      return change;
    }
    const after = this.text.slice(parent.openTo, parent.closeFrom);
    const closesLine = /^[ \t]*\r?\n/.test(after);
    return {
      from: parent.openTo,
      to: parent.openTo,
      insert: closesLine ? piece : piece + this.newline + (after.trim() === "" ? outer : indent),
    };
  }

  // Takes the element out with its line, if it has one for itself, and with an empty line where two would be left.
  remove(element: XmlElement): Change {
    let from = element.from;
    let to = element.to;
    const restOfLine = /^[ \t]*(?=\r?\n|$)/.exec(this.text.slice(to));
    if (!this.startsLine(from) || !restOfLine) return { from, to, insert: "" };
    const line = this.lineStart(from);
    if (line === 0) return { from, to, insert: "" };
    from = line - (this.text[line - 2] === "\r" ? 2 : 1);
    to += restOfLine[0].length;
    const next = /^\r?\n[ \t]*(\r?\n|<\/|$)/.test(this.text.slice(to));
    if (next && this.emptyLineBefore(line)) {
      const before = this.lineStart(line - 1);
      if (before > 0) from = before - (this.text[before - 2] === "\r" ? 2 : 1);
    }
    return { from, to, insert: "" };
  }

  // Its parent closes itself where nothing else stands in it.
  removeAndClose(element: XmlElement): Change {
    const parent = element.parent;
    const around = parent
      ? this.text.slice(parent.openTo, element.from) + this.text.slice(element.to, parent.closeFrom)
      : "";
    if (!parent || !parent.whole || around.trim() !== "") return this.remove(element);
    return { from: parent.openTo - 1, to: parent.to, insert: "/>" };
  }

  setAttribute(element: XmlElement, name: string, value: string | null): Change | null {
    const index = element.attributes.findIndex((a) => a.name === name);
    const found = element.attributes[index];
    if (found) {
      if (value === null)
        return {
          from: index > 0 ? (element.attributes[index - 1]?.to ?? found.from) : element.nameTo,
          to: found.to,
          insert: "",
        };
      return found.value === value
        ? null
        : { from: found.valueFrom, to: found.valueTo, insert: encodeAttribute(value, found.quote) };
    }
    if (value === null) return null;
    const last = element.attributes.at(-1);
    const at = last ? last.to : element.nameTo;
    const ownLine = last !== undefined && name.startsWith("xmlns") && this.startsLine(last.from);
    return {
      from: at,
      to: at,
      insert: `${ownLine ? this.newline + this.indentAt(last.from) : " "}${name}="${encodeAttribute(value)}"`,
    };
  }

  // The text of an element; blanks and comments around it stay.
  setText(element: XmlElement, value: string): Change[] {
    if (element.selfClosing) {
      const slash = this.text.lastIndexOf("/", element.to - 1);
      const from = this.text.slice(0, slash).trimEnd().length;
      return [{ from, to: element.to, insert: `>${encodeText(value)}</${element.name}>` }];
    }
    const runs = element.texts
      .map((run) => this.trimmed(run.from, run.to))
      .filter((run) => run.to > run.from);
    const [first, ...rest] = runs;
    if (!first) return [{ from: element.openTo, to: element.openTo, insert: encodeText(value) }];
    return [{ ...first, insert: encodeText(value) }, ...rest.map((run) => ({ ...run, insert: "" }))];
  }

  private trimmed(from: number, to: number): { from: number; to: number } {
    const run = this.text.slice(from, to);
    return { from: from + run.length - run.trimStart().length, to: to - (run.length - run.trimEnd().length) };
  }
}

// The text after the changes, which are of one text and do not overlap.
export function applyChanges(text: string, changes: readonly Change[]): string {
  const sorted = changes
    .map((change, index) => ({ change, index }))
    .sort((a, b) => a.change.from - b.change.from || a.index - b.index);
  let result = "";
  let at = 0;
  for (const { change } of sorted) {
    if (change.from < at) throw new RangeError(`changes overlap at ${change.from}`);
    result += text.slice(at, change.from) + change.insert;
    at = change.to;
  }
  return result + text.slice(at);
}
