// What is wrong with a document: mistakes of the text at once, and what the server's check says a moment after the last key.
import { useEffect, useRef, useState } from "react";
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { type CawlDocument, partAt } from "../cawl/document";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";
import type { Diagnostic } from "../gen/docent/v1/term_pb";
import type { Session } from "./session";

export interface Finding {
  id: string;
  error: boolean;
  message: string;
  hint: string;
  rule: string;
  from: number;
  to: number;
  flow: string; // keys of what it is about; empty: none of these
  step: string;
  link: string;
  fix: { from: number; to: number; insert: string }[];
  remedy?: string; // what the fix does, in words
  of?: string; // the text that it was found in; absent: the one that was checked
}
export interface Findings {
  list: Finding[];
  conditions: CompiledCondition[];
  of: string; // the text that was checked
  checking: boolean;
  error: PlainError | undefined; // why the server could not check
}

// Index in UTF-16 units of an offset in UTF-8 bytes.
export function indexOfByte(text: string, byte: number): number {
  let bytes = 0;
  let index = 0;
  for (const character of text) {
    if (bytes >= byte) return index;
    const code = character.codePointAt(0) ?? 0;
    bytes += code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    index += character.length;
  }
  return index;
}

export function lineStarts(text: string): number[] {
  const starts = [0];
  for (let end = text.indexOf("\n"); end >= 0; end = text.indexOf("\n", end + 1)) starts.push(end + 1);
  return starts;
}

// Index of a line (from 1) and a column (from 1, in code points).
export function indexOfPlace(text: string, line: number, column: number, starts = lineStarts(text)): number {
  let index = starts[Math.min(line, starts.length) - 1] ?? 0;
  for (let at = 1; at < column && index < text.length && text[index] !== "\n"; at++)
    index += (text.codePointAt(index) ?? 0) > 0xffff ? 2 : 1;
  return index;
}

function endOfWord(text: string, from: number): number {
  const rest = text.slice(from, from + 200);
  const word = /^<[/!?]?[^\s>/]*|^[^\s"'<>=/]+/.exec(rest)?.[0] ?? "";
  return from + Math.max(1, word.length);
}

export function readFindings(document: CawlDocument, diagnostics: readonly Diagnostic[]): Finding[] {
  const { text } = document;
  const starts = lineStarts(text);
  const place = (from: number) => {
    const part = partAt(document, from);
    return { flow: part?.flow.key ?? "", step: part?.step?.key ?? "", link: part?.link?.key ?? "" };
  };
  const own = document.problems.map((p, i): Finding => ({
    id: `text ${i}`,
    error: true,
    message: p.message,
    hint: "",
    rule: "text",
    from: p.from,
    to: p.to,
    fix: [],
    ...place(p.from),
  }));
  if (own.length > 0) return own; // the server says the same, in other words
  return diagnostics.map((d, i): Finding => {
    const from = d.line > 0 ? indexOfPlace(text, d.line, Math.max(1, d.column), starts) : 0;
    const fix = d.fix.map((edit) => {
      const at = indexOfByte(text, Number(edit.offset));
      return { from: at, to: indexOfByte(text, Number(edit.offset + edit.length)), insert: edit.replacement };
    });
    return {
      id: `check ${i} ${d.rule}`,
      error: !d.warning,
      message: d.message,
      hint: d.hint,
      rule: d.rule,
      from,
      to: endOfWord(text, from),
      fix,
      ...place(from),
    };
  });
}

export function useFindings(session: Session): Findings {
  const version = session.versions.use();
  const [state, setState] = useState<Findings>(() => ({
    list: readFindings(session.shown, []),
    conditions: [],
    of: "",
    checking: true,
    error: undefined,
  }));
  const sequence = useRef(0);
  useEffect(() => {
    const abort = new AbortController();
    const mine = ++sequence.current;
    const document = session.shown;
    if (document.problems.length > 0) {
      setState((before) => ({
        ...before,
        list: readFindings(document, []),
        of: document.text,
        checking: false,
        error: undefined,
      }));
      return;
    }
    const ask = async () => {
      setState((before) => ({ ...before, checking: true }));
      try {
        const reply = await workflows.check(
          { name: `${document.name || "workflow"}.cawl.xml`, cawl: document.text },
          { signal: abort.signal },
        );
        if (mine === sequence.current)
          setState({
            list: readFindings(document, reply.diagnostics),
            conditions: reply.conditions,
            of: document.text,
            checking: false,
            error: undefined,
          });
      } catch (error) {
        const words = plain(error);
        if (mine === sequence.current && words.kind !== "cancelled")
          setState((before) => ({
            ...before,
            list: readFindings(document, []),
            checking: false,
            error: words,
          }));
      }
    };
    const timer = window.setTimeout(() => void ask(), 200);
    const again = window.setInterval(() => void ask(), 15_000); // what a document may name changes with robots and ontologies
    return () => {
      window.clearTimeout(timer);
      window.clearInterval(again);
      abort.abort();
    };
  }, [session, version]);
  return state;
}
