// Element tree of an XML text with the place of every part, also of a text that is broken: what is well-formed is read, and
// each mistake is a range with words. Built on the error-tolerant parser @lezer/xml. Nothing here knows CAWL.
import { type SyntaxNode, type Tree, TreeFragment, type ChangedRange } from "@lezer/common";
import { parser } from "@lezer/xml";

export interface Range {
  from: number; // offset in UTF-16 units
  to: number; // one past the last
}

export interface TextProblem extends Range {
  message: string;
}

export interface XmlAttribute extends Range {
  name: string;
  value: string; // references decoded
  valueFrom: number; // inside the quotes
  valueTo: number;
  quote: '"' | "'";
}

export interface XmlElement extends Range {
  name: string; // as written, with its prefix
  local: string;
  namespace: string; // IRI; empty: none
  attributes: XmlAttribute[];
  children: XmlElement[];
  parent: XmlElement | null;
  nameTo: number;
  openTo: number; // end of the open tag
  closeFrom: number; // start of the close tag; openTo where there is none
  selfClosing: boolean;
  whole: boolean; // closed, and no mistake in its tags
  texts: Range[]; // runs of text, references and CDATA among its children
  scope: ReadonlyMap<string, string>; // prefix to IRI; "" is the default namespace
}

export interface XmlText {
  text: string;
  tree: Tree;
  fragments: readonly TreeFragment[];
  root: XmlElement | null;
  problems: TextProblem[];
}

const entities: Record<string, string> = { amp: "&", lt: "<", gt: ">", quot: '"', apos: "'" };

// Text with its references replaced; an unknown reference stays as it is written.
export function decode(written: string): string {
  return written.replace(
    /&(?:#(\d+)|#x([0-9a-fA-F]+)|(\w+));/g,
    (whole, decimal?: string, hex?: string, name?: string) => {
      if (name !== undefined) return entities[name] ?? whole;
      const code = decimal !== undefined ? parseInt(decimal, 10) : parseInt(hex ?? "", 16);
      return code > 0 && code <= 0x10ffff ? String.fromCodePoint(code) : whole;
    },
  );
}

export function encodeText(value: string): string {
  return value.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/\]\]>/g, "]]&gt;");
}

export function encodeAttribute(value: string, quote: '"' | "'" = '"'): string {
  const escaped = value
    .replace(/&/g, "&amp;")
    .replace(/</g, "&lt;")
    .replace(/\t/g, "&#9;")
    .replace(/\n/g, "&#10;")
    .replace(/\r/g, "&#13;");
  return quote === '"' ? escaped.replace(/"/g, "&quot;") : escaped.replace(/'/g, "&apos;");
}

// Parses `text`; with the last parse and what changed since, only around the change.
export function parseXml(text: string, before?: XmlText, changed?: readonly ChangedRange[]): XmlText {
  const fragments = before && changed ? TreeFragment.applyChanges(before.fragments, changed) : undefined;
  const tree = parser.parse(text, fragments);
  const problems: TextProblem[] = [];
  const root = new TreeReader(text, problems).document(tree.topNode);
  return { text, tree, fragments: TreeFragment.addTree(tree, fragments), root, problems };
}

const noScope: ReadonlyMap<string, string> = new Map([["xml", "http://www.w3.org/XML/1998/namespace"]]);

class TreeReader {
  constructor(
    private readonly text: string,
    private readonly problems: TextProblem[],
  ) {}

  document(top: SyntaxNode): XmlElement | null {
    let root: XmlElement | null = null;
    for (let child = top.firstChild; child; child = child.nextSibling) {
      if (child.name === "Element") {
        const element = this.element(child, null);
        if (!root) root = element;
        else this.problem(child, "A document has one root element; this is another one. Remove it.");
      } else if (child.type.isError) {
        this.problem(child, "This is not XML: an element, a comment or nothing is expected here.");
      } else if (child.name === "Text" && this.slice(child).trim() !== "") {
        this.problem(child, "Text outside of the root element. Remove it, or make it a comment.");
      }
    }
    if (!root && this.problems.length === 0)
      this.problems.push({ from: 0, to: this.text.length, message: "The document is empty." });
    return root;
  }

  private slice(node: Range): string {
    return this.text.slice(node.from, node.to);
  }

  private problem(node: Range, message: string) {
    const to = Math.max(node.to, Math.min(node.from + 1, this.text.length));
    this.problems.push({ from: Math.min(node.from, Math.max(0, to - 1)), to, message });
  }

  private element(node: SyntaxNode, parent: XmlElement | null): XmlElement {
    const element: XmlElement = {
      from: node.from,
      to: node.to,
      name: "",
      local: "",
      namespace: "",
      attributes: [],
      children: [],
      parent,
      nameTo: node.from,
      openTo: node.from,
      closeFrom: node.to,
      selfClosing: false,
      whole: true,
      texts: [],
      scope: parent?.scope ?? noScope,
    };
    for (let child = node.firstChild; child; child = child.nextSibling) this.part(child, element);
    if (element.selfClosing) element.closeFrom = element.openTo;
    return element;
  }

  private part(child: SyntaxNode, element: XmlElement) {
    switch (child.name) {
      case "OpenTag":
      case "SelfClosingTag":
        element.selfClosing = child.name === "SelfClosingTag";
        element.openTo = child.to;
        this.tag(child, element);
        this.resolve(element);
        break;
      case "Element":
        element.children.push(this.element(child, element));
        break;
      case "CloseTag":
        element.closeFrom = child.from;
        if (child.lastChild?.type.isError)
          this.broken(child, element, `</${element.name} has no ">" at its end.`);
        break;
      case "MismatchedCloseTag":
        this.broken(
          child,
          element,
          `${this.slice(child)} closes nothing that is open here; <${element.name}> is open.`,
        );
        break;
      case "MissingCloseTag":
        element.closeFrom = child.from;
        this.broken(
          { from: element.from, to: element.openTo },
          element,
          `<${element.name}> is never closed. Add </${element.name}>.`,
        );
        break;
      case "Text":
      case "EntityReference":
      case "CharacterReference":
      case "Cdata":
        this.textRun(child, element);
        break;
      default:
        if (child.type.isError && child.to >= this.text.length && child.from === child.to) {
          element.closeFrom = child.from;
          this.broken(
            { from: element.from, to: element.openTo },
            element,
            `<${element.name}> is never closed. Add </${element.name}>.`,
          );
        } else if (child.type.isError || child.name === "InvalidEntity") {
          this.broken(
            child,
            element,
            `${JSON.stringify(this.slice(child))} is not allowed here. Write "&" as &amp; and "<" as &lt;.`,
          );
        }
    }
  }

  private broken(range: Range, element: XmlElement, message: string) {
    element.whole = false;
    this.problem(range, message);
  }

  private textRun(child: Range, element: XmlElement) {
    const last = element.texts.at(-1);
    if (last && last.to === child.from) last.to = child.to;
    else element.texts.push({ from: child.from, to: child.to });
  }

  private tag(tag: SyntaxNode, element: XmlElement) {
    for (let part = tag.firstChild; part; part = part.nextSibling) {
      if (part.name === "TagName") {
        element.name = this.slice(part);
        element.nameTo = part.to;
      } else if (part.name === "Attribute") {
        this.attribute(part, element);
      } else if (part.type.isError) {
        this.broken(
          { from: part.from, to: Math.max(part.to, part.from) },
          element,
          `The tag of <${element.name}> is not complete here.`,
        );
      }
    }
  }

  private attribute(node: SyntaxNode, element: XmlElement) {
    const name = node.getChild("AttributeName");
    const value = node.getChild("AttributeValue");
    const quote = value ? this.text[value.from] : undefined;
    const complete = value !== null && value.lastChild?.type.isError !== true && value.to - value.from >= 2;
    if (!name || !complete || (quote !== '"' && quote !== "'")) {
      this.broken(node, element, `The attribute ${name ? this.slice(name) : ""} needs a value in quotes.`);
      return;
    }
    if (element.attributes.some((a) => a.name === this.slice(name)))
      this.broken(node, element, `The attribute ${this.slice(name)} is there twice.`);
    const valueFrom = value.from + 1;
    const valueTo = value.to - 1;
    element.attributes.push({
      name: this.slice(name),
      from: node.from,
      to: node.to,
      valueFrom,
      valueTo,
      quote,
      value: decode(this.text.slice(valueFrom, valueTo).replace(/[\t\n\r]/g, " ")),
    });
  }

  private resolve(element: XmlElement) {
    const declared = element.attributes.filter((a) => a.name === "xmlns" || a.name.startsWith("xmlns:"));
    if (declared.length > 0) {
      const scope = new Map(element.scope);
      for (const a of declared) scope.set(a.name === "xmlns" ? "" : a.name.slice(6), a.value);
      element.scope = scope;
    }
    const colon = element.name.indexOf(":");
    element.local = element.name.slice(colon + 1);
    element.namespace = element.scope.get(colon < 0 ? "" : element.name.slice(0, colon)) ?? "";
  }
}

export function attribute(element: XmlElement, name: string): XmlAttribute | undefined {
  return element.attributes.find((a) => a.name === name);
}

// An attribute by its namespace, whatever prefix the text has for it.
export function attributeNs(element: XmlElement, namespace: string, local: string): XmlAttribute | undefined {
  return element.attributes.find((a) => {
    const colon = a.name.indexOf(":");
    return (
      colon > 0 &&
      a.name.slice(colon + 1) === local &&
      element.scope.get(a.name.slice(0, colon)) === namespace
    );
  });
}

// The element's own text, decoded, without blanks at its ends.
export function ownText(text: string, element: XmlElement): string {
  return element.texts
    .map((run) => decodeRun(text.slice(run.from, run.to)))
    .join("")
    .trim();
}

function decodeRun(written: string): string {
  return written
    .split(/(<!\[CDATA\[[\s\S]*?\]\]>)/)
    .map((part) => (part.startsWith("<![CDATA[") ? part.slice(9, -3) : decode(part)))
    .join("");
}
