// One open document: its text in an editor, the model read from it, and the way in for edits of the canvas. The editor's state
// is the only truth and its history the only undo stack, whether an edit was typed or drawn.
import { history, isolateHistory, redo, redoDepth, undo, undoDepth } from "@codemirror/commands";
import { EditorState, type Extension, Text, Transaction } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { createStore } from "../api/store";
import { type CawlDocument, flowOf, type Flow, readCawl } from "../cawl/document";
import { EditRefused, Edits } from "../cawl/edits";
import { announce, toast } from "../ui/toasts";
import { hunksOf } from "./text_diff";

const large = 150_000; // characters

export class Session {
  readonly view: EditorView;
  private model: CawlDocument;
  private pending = 0; // timer of a text that is not read yet
  private revealing = 0; // timer of a place that is shown
  good: CawlDocument | null; // the newest without mistakes of the text
  readonly versions = createStore(0); // another one with each text
  refreshed = 0; // changes when the whole text was replaced, and the canvas should show all of it

  constructor(text: string, extensions: Extension) {
    this.view = new EditorView({
      state: EditorState.create({
        doc: text,
        extensions: [
          history({ minDepth: 500 }),
          // Every byte comes back: with CR LF alone these are the line ends, else CR is a character like others.
          EditorState.lineSeparator.of(/\r\n/.test(text) && !/[^\r]\n|\r[^\n]/.test(text) ? "\r\n" : "\n"),
          extensions,
          EditorView.updateListener.of((update) => {
            if (!update.docChanged) return;
            const ranges: { fromA: number; toA: number; fromB: number; toB: number }[] = [];
            update.changes.iterChangedRanges((fromA, toA, fromB, toB) =>
              ranges.push({ fromA, toA, fromB, toB }),
            );
            // Of a large text that is typed in, the model follows when the keys rest.
            const typed = update.transactions.every((t) => t.isUserEvent("input") || t.isUserEvent("delete"));
            if (typed && update.state.doc.length > large) {
              window.clearTimeout(this.pending);
              this.pending = window.setTimeout(() => this.read(this.view.state.doc.toString()), 250);
            } else if (this.pending) this.read(update.state.doc.toString());
            else this.read(update.state.doc.toString(), ranges);
          }),
        ],
      }),
    });
    for (const what of ["wheel", "pointerdown", "keydown"])
      this.view.scrollDOM.addEventListener(what, this.leaveThere, { passive: true });
    this.model = readCawl(this.view.state.doc.toString());
    this.good = this.model.problems.length === 0 ? this.model : null;
  }

  get version(): number {
    return this.versions.get();
  }

  // The model of the text as it is now.
  get document(): CawlDocument {
    if (this.pending) this.read(this.view.state.doc.toString());
    return this.model;
  }
  // The newest model that was read; while somebody types in a large text, it may be a moment old.
  get shown(): CawlDocument {
    return this.model;
  }
  get text(): string {
    return this.document.text;
  }
  // The text as it goes to a file or the server: with the line ends that it came with.
  get written(): string {
    return this.view.state.sliceDoc();
  }

  private read(text: string, changed?: { fromA: number; toA: number; fromB: number; toB: number }[]) {
    window.clearTimeout(this.pending);
    this.pending = 0;
    this.model = readCawl(text, changed ? this.model : undefined, changed);
    if (this.model.problems.length === 0) this.good = this.model;
    this.versions.set(this.version + 1);
  }

  // Makes an edit of the flow as one step of undo. What can't be done is said, and nothing changes. Returns what `make` gives.
  edit<T>(flowKey: string, make: (edits: Edits, flow: Flow) => T, said = ""): T | undefined {
    try {
      const flow = flowOf(this.document, flowKey) ?? this.document.flows[0];
      if (!flow) throw new EditRefused("The text has no <flow> to edit.");
      const edits = new Edits(this.document);
      const result = make(edits, flow);
      if (edits.changes.length > 0) this.change(edits.changes, "canvas");
      if (said) announce(said);
      return result;
    } catch (error) {
      if (!(error instanceof EditRefused)) throw error;
      toast("bad", "That can't be done", error.message);
      return undefined;
    }
  }

  // Replaces pieces of the text, as one step of undo.
  change(changes: readonly { from: number; to: number; insert: string }[], event = "fix") {
    this.view.dispatch({
      changes: changes.map((c) => ({ from: c.from, to: c.to, insert: Text.of(c.insert.split("\n")) })),
      annotations: [isolateHistory.of("full"), Transaction.userEvent.of(event)],
    });
  }

  replaceAll(text: string) {
    this.view.dispatch({
      changes: { from: 0, to: this.view.state.doc.length, insert: Text.of(text.split(/\r?\n/)) },
      annotations: isolateHistory.of("full"),
    });
    this.refreshed++;
  }

  // Takes in what somebody else has changed: it is no step of undo here, and the selection stays where it was.
  mergeIn(text: string) {
    const lines = this.view.state.doc.toString().split("\n");
    const starts = [0];
    for (const line of lines) starts.push((starts.at(-1) ?? 0) + line.length + 1);
    const end = this.view.state.doc.length;
    const whole = text
      .split("\n")
      .map((line) => (this.view.state.lineBreak === "\r\n" ? line.replace(/\r$/, "") : line));
    const changes = hunksOf(lines, whole).map((hunk) => {
      // Lines at the end have no line end of their own: the one before them goes or comes along.
      const last = hunk.to === lines.length;
      const from = last && hunk.from > 0 ? (starts[hunk.from] ?? 0) - 1 : (starts[hunk.from] ?? 0);
      const to = last ? end : (starts[hunk.to] ?? end);
      const insert = last
        ? hunk.from > 0
          ? ["", ...hunk.lines]
          : hunk.lines
        : hunk.lines.length > 0
          ? [...hunk.lines, ""]
          : [];
      return { from, to, insert: insert.length > 0 ? Text.of(insert) : Text.empty };
    });
    this.view.dispatch({
      changes,
      annotations: [Transaction.addToHistory.of(false), Transaction.remote.of(true)],
    });
  }

  get canUndo(): boolean {
    return undoDepth(this.view.state) > 0;
  }
  get canRedo(): boolean {
    return redoDepth(this.view.state) > 0;
  }
  undo = () => {
    if (undo(this.view)) announce("Undone");
  };
  redo = () => {
    if (redo(this.view)) announce("Done again");
  };

  // Shows a range in the text, without taking the focus.
  reveal(from: number, to: number) {
    const place = () => Math.min(from, this.view.state.doc.length);
    const scroll = () => EditorView.scrollIntoView(place(), { y: "start", yMargin: 60 });
    this.view.dispatch({
      selection: { anchor: place(), head: Math.min(to, this.view.state.doc.length) },
      effects: scroll(),
    });
    // Lines that were not drawn yet have heights that the editor guesses: once they are drawn, the place is another one.
    this.leaveThere();
    let times = 25;
    let seen = 0; // how often it has been in view, one after the other
    const again = () => {
      const at = this.view.coordsAtPos(place());
      const box = this.view.scrollDOM.getBoundingClientRect();
      const there = at !== null && at.top >= box.top && at.bottom <= box.bottom;
      seen = there ? seen + 1 : 0;
      if (!there) this.view.dispatch({ effects: scroll() });
      if (--times > 0 && (seen < 4 || document.fonts.status !== "loaded"))
        this.revealing = window.setTimeout(again, 120);
    };
    this.revealing = window.setTimeout(again, 60);
  }

  // Somebody scrolls or types: the text stays where they have it.
  private readonly leaveThere = () => window.clearTimeout(this.revealing);

  destroy() {
    this.leaveThere();
    this.view.destroy();
  }
}
