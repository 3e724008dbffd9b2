// The editor for CAWL text: colours by the app's tokens, completion by the language's elements, squiggles by the findings.
import {
  autocompletion,
  closeBrackets,
  closeBracketsKeymap,
  completionKeymap,
} from "@codemirror/autocomplete";
import { defaultKeymap, historyKeymap, indentWithTab } from "@codemirror/commands";
import { xml } from "@codemirror/lang-xml";
import {
  bracketMatching,
  foldGutter,
  foldKeymap,
  HighlightStyle,
  indentOnInput,
  syntaxHighlighting,
} from "@codemirror/language";
import { lintGutter, setDiagnostics, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import type { Extension } from "@codemirror/state";
import {
  drawSelection,
  dropCursor,
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Finding } from "./findings";

const colours = HighlightStyle.define([
  { tag: tags.tagName, color: "var(--service)" },
  { tag: tags.angleBracket, color: "var(--text-3)" },
  { tag: tags.attributeName, color: "var(--operation)" },
  { tag: tags.attributeValue, color: "var(--condition)" },
  { tag: tags.comment, color: "var(--text-3)", fontStyle: "italic" },
  { tag: [tags.processingInstruction, tags.documentMeta], color: "var(--text-3)" },
  { tag: tags.character, color: "var(--workflow)" },
  { tag: tags.invalid, color: "var(--bad)" },
]);

const theme = EditorView.theme({
  "&": { height: "100%", backgroundColor: "var(--surface)", color: "var(--text)", fontSize: "12.5px" },
  "&.cm-focused": { outline: "none" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.55", fontVariantLigatures: "none" },
  ".cm-content": { padding: "8px 0", caretColor: "var(--accent)" },
  ".cm-cursor": { borderLeftColor: "var(--accent)", borderLeftWidth: "2px" },
  ".cm-gutters": { backgroundColor: "var(--surface)", color: "var(--text-3)", border: "0" },
  ".cm-lineNumbers .cm-gutterElement": { padding: "0 4px 0 8px", minWidth: "28px" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--hover) 55%, transparent)" },
  ".cm-activeLineGutter": { backgroundColor: "transparent", color: "var(--text)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": {
    background: "color-mix(in srgb, var(--accent) 22%, transparent) !important",
  },
  ".cm-selectionMatch": { backgroundColor: "var(--wait-soft)" },
  ".cm-matchingBracket, &.cm-focused .cm-matchingBracket": {
    backgroundColor: "var(--accent-soft)",
    outline: "1px solid var(--accent)",
  },
  ".cm-foldPlaceholder": {
    background: "var(--hover)",
    border: "0",
    color: "var(--text-2)",
    padding: "0 6px",
  },
  ".cm-tooltip": {
    background: "var(--raised)",
    border: "1px solid var(--line)",
    borderRadius: "8px",
    boxShadow: "var(--shadow-l)",
    overflow: "hidden",
  },
  ".cm-tooltip-autocomplete > ul > li": { padding: "3px 10px !important" },
  ".cm-tooltip-autocomplete > ul > li[aria-selected]": {
    background: "var(--accent) !important",
    color: "var(--on-accent) !important",
  },
  ".cm-diagnostic": {
    padding: "8px 12px",
    fontFamily: "var(--font)",
    fontSize: "12px",
    maxWidth: "420px",
    borderLeftWidth: "3px",
  },
  ".cm-diagnostic-error": { borderLeftColor: "var(--bad)" },
  ".cm-diagnostic-warning": { borderLeftColor: "var(--wait)" },
  ".cm-diagnosticAction": {
    background: "var(--accent)",
    borderRadius: "5px",
    padding: "2px 8px",
    fontSize: "11.5px",
  },
  ".cm-lintRange": { backgroundImage: "none !important" },
  ".cm-lintRange-error": { textDecoration: "underline wavy var(--bad) 1.5px", textUnderlineOffset: "3px" },
  ".cm-lintRange-warning": { textDecoration: "underline wavy var(--wait) 1.5px", textUnderlineOffset: "3px" },
  ".cm-lint-marker": { width: "8px", height: "8px", marginTop: "6px", borderRadius: "50%" },
  ".cm-lint-marker-error": { content: "normal", background: "var(--bad)" },
  ".cm-lint-marker-warning": { content: "normal", background: "var(--wait)" },
  ".cm-panels": { background: "var(--sunken)", color: "var(--text)", borderColor: "var(--line) !important" },
  ".cm-textfield": {
    background: "var(--surface)",
    border: "1px solid var(--line-strong)",
    borderRadius: "5px",
  },
  ".cm-button": {
    background: "var(--surface)",
    backgroundImage: "none",
    border: "1px solid var(--line-strong)",
    borderRadius: "5px",
  },
});

const booleans = ["true", "false"];
const schema = xml({
  elements: [
    {
      name: "CAWL",
      top: true,
      attributes: ["version", "namespace"],
      children: [
        "message",
        "variable",
        "baseOntologies",
        "serviceProvider",
        "activator",
        "flow",
        "documentation",
      ],
    },
    { name: "activator", children: ["message", "variable", "activate", "condition", "documentation"] },
    { name: "activate", attributes: ["flow"] },
    { name: "flow", children: ["message", "variable", "source", "node", "sink", "link", "documentation"] },
    { name: "source" },
    { name: "sink" },
    {
      name: "node",
      attributes: [
        "state",
        "ext:timeout",
        "ext:retry",
        "ext:forEach",
        "ext:while-holds",
        { name: "ext:sequential", values: booleans },
      ],
      children: ["message", "wait", "condition", "ext:assign", "invoke", "documentation"],
    },
    { name: "ext:input", attributes: ["part", "variable", "expression"] },
    { name: "ext:assign", attributes: ["variable", "expression"] },
    { name: "wait", attributes: ["joinCondition"] },
    {
      name: "condition",
      attributes: ["expression", "ext:timeout"],
      children: ["case", "context", "documentation"],
    },
    { name: "context", attributes: ["priority"], children: ["rule", "documentation"] },
    { name: "rule", attributes: ["expression", "ext:for"], children: ["constraint", "documentation"] },
    { name: "constraint", children: ["subject", "verb", "object"] },
    { name: "subject", attributes: ["type"] },
    { name: "verb" },
    { name: "object", attributes: ["type"] },
    { name: "case", attributes: ["expression"], children: ["event"] },
    { name: "event", attributes: ["operation"] },
    {
      name: "invoke",
      attributes: ["operation", "subflow", "ext:timeout", "ext:retry"],
      children: ["ext:input"],
    },
    {
      name: "link",
      attributes: [
        "from",
        "to",
        "ext:while",
        { name: "ext:onFailure", values: ["true"] },
        { name: "ext:onInterrupt", values: ["true"] },
      ],
    },
    { name: "message", children: ["part"] },
    { name: "part", attributes: ["type", "element"] },
    { name: "variable", attributes: ["type"], children: ["initialize"] },
    { name: "initialize", attributes: ["part"], children: ["from"] },
    { name: "from", attributes: ["expression", "variable", "part"] },
    { name: "serviceProvider", attributes: ["location"], children: ["service"] },
    { name: "service", attributes: ["operation"] },
    { name: "baseOntologies", children: ["ontology"] },
    { name: "ontology", attributes: ["location", "namespace"] },
    { name: "documentation" },
  ],
  attributes: [{ name: "name", global: true }],
});

const nonce = document.querySelector<HTMLMetaElement>('meta[property="csp-nonce"]')?.nonce ?? "";

export const textSetup: Extension = [
  EditorView.cspNonce.of(nonce),
  lineNumbers(),
  foldGutter({ openText: "▾", closedText: "▸" }),
  highlightActiveLineGutter(),
  drawSelection(),
  dropCursor(),
  indentOnInput(),
  bracketMatching(),
  closeBrackets(),
  autocompletion({ icons: false }),
  highlightActiveLine(),
  highlightSelectionMatches({ minSelectionLength: 3 }),
  lintGutter({ hoverTime: 200 }),
  schema,
  syntaxHighlighting(colours),
  theme,
  EditorView.lineWrapping,
  EditorView.contentAttributes.of({ "aria-label": "CAWL text", spellcheck: "false", tabindex: "0" }),
  keymap.of([
    ...closeBracketsKeymap,
    ...defaultKeymap,
    ...searchKeymap,
    ...historyKeymap,
    ...foldKeymap,
    ...completionKeymap,
    indentWithTab,
  ]),
];

export function showFindings(
  view: EditorView,
  findings: readonly Finding[],
  onFix: (finding: Finding) => void,
) {
  const length = view.state.doc.length;
  const diagnostics = findings.map((f): Diagnostic => ({
    from: Math.min(f.from, length),
    to: Math.min(Math.max(f.to, f.from), length),
    severity: f.error ? "error" : "warning",
    message: f.hint ? `${f.message}\n${f.hint}` : f.message,
    ...(f.fix.length > 0 && { actions: [{ name: f.remedy ?? "Mend it", apply: () => onFix(f) }] }),
  }));
  view.dispatch(setDiagnostics(view.state, diagnostics));
}
