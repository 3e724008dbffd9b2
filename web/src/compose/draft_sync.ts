// Keeps the draft of an open document in this browser, a moment after each change, and takes in what another tab writes of it
// meanwhile. Where both changed the same place, nothing is written until somebody has chosen.
import { uniqueName } from "../cawl/names";
import { toast } from "../ui/toasts";
import { dropDraft, listDrafts, loadDraft, saveDraft, watchDraft } from "./drafts";
import { mergeTexts } from "./merge";
import type { Session } from "./session";

const restMs = 300;

export class DraftSync {
  conflict: string | null = null; // the other tab's text
  private shared: string; // that both tabs had last
  private timer = 0;
  private full = false;
  private readonly stops: (() => void)[];
  private readonly listeners = new Set<() => void>();

  constructor(
    private readonly name: string,
    private readonly session: Session,
    private deployed: string | null,
  ) {
    this.shared = session.written;
    const leave = () => this.leave();
    window.addEventListener("pagehide", leave);
    this.stops = [
      session.subscribe(() => this.later()),
      watchDraft(name, (draft) => draft && this.takeIn(draft.text)),
      () => window.removeEventListener("pagehide", leave),
    ];
  }
  subscribe = (listener: () => void) => {
    this.listeners.add(listener);
    return () => void this.listeners.delete(listener);
  };
  getConflict = () => this.conflict;

  // Where both changed the same place: one of the two is taken whole. Undo brings mine back.
  take() {
    const other = this.conflict;
    if (other === null) return;
    this.become(null);
    this.shared = other;
    this.session.replaceAll(other);
  }
  keep() {
    this.shared = this.conflict ?? this.shared;
    this.become(null);
    this.write();
  }

  // From now on the draft is what differs from this.
  isDeployed(text: string) {
    this.deployed = text;
    this.save();
  }

  private become(conflict: string | null) {
    this.conflict = conflict;
    for (const listener of this.listeners) listener();
  }
  private later() {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.save(), restMs);
  }
  private takeIn(other: string) {
    const mine = this.session.written;
    if (other === mine) {
      this.shared = other;
      return this.become(null);
    }
    const merged = mergeTexts(this.shared, mine, other);
    if (merged === null) return this.become(other);
    const both = merged !== other; // the other tab has yet to hear of mine
    this.shared = other;
    this.become(null);
    if (merged !== mine) {
      this.session.mergeIn(merged);
      toast("good", both ? "Another tab’s changes are put together with yours" : "Another tab’s changes are here");
    }
  }
  private save() {
    window.clearTimeout(this.timer);
    if (this.conflict !== null) return;
    const stored = loadDraft(this.name)?.text;
    if (stored !== undefined && stored !== this.shared) this.takeIn(stored); // written since, and not heard of yet
    if (this.conflict === null) this.write();
  }
  private write() {
    const text = this.session.written;
    const saved = text === this.deployed ? (dropDraft(this.name), true) : saveDraft(this.name, text, this.deployed ?? "");
    if (saved) this.shared = text;
    else if (!this.full) toast("bad", "The draft can't be kept", "The browser's storage is full. Save the text as a file (Ctrl-S).");
    this.full = !saved;
  }
  // A conflict that nobody has settled: mine is kept under another name.
  private leave() {
    if (this.session.version === 0) return;
    this.save();
    if (this.conflict !== null) saveDraft(uniqueName(new Set(listDrafts().map((d) => d.name)), this.name), this.session.written, "");
  }
  close() {
    this.leave();
    for (const stop of this.stops) stop();
  }
}
