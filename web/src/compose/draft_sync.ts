// Keeps the draft of an open document in this browser, a moment after each change, and takes in what another tab writes of it
// meanwhile. Where both changed the same place, nothing is written until somebody has chosen. Knows also which deployed version
// the text began from: a text without changes follows the live one, another one is behind it until somebody has chosen.
import { uniqueName } from "../cawl/names";
import { toast } from "../ui/toasts";
import { kept } from "../api/storage";
import { createStore } from "../api/store";
import {
  askBeforeLeaving,
  type Draft,
  dropDraft,
  isUnkept,
  listDrafts,
  loadDraft,
  saveDraft,
  watchDraft,
} from "../flow/drafts";
import type { LiveVersion } from "./load_document";
import { mergeTexts } from "./merge";
import type { Session } from "./session";

const restMs = 300;

export class DraftSync {
  readonly conflicts = createStore<string | null>(null); // the other tab's text
  private shared: string; // that both tabs had last
  private timer = 0;
  readonly turns = createStore(0); // another one with what is told below
  private readonly stops: (() => void)[];

  constructor(
    private readonly name: string,
    private readonly session: Session,
    private shownLive: LiveVersion | null,
    public base: string | null = shownLive?.text ?? null, // the deployed text that this one began from; null: none was deployed
  ) {
    this.shared = session.written;
    const leave = () => this.leave();
    const ask = (event: Event) => (session.version > 0 && this.save(), askBeforeLeaving(event)); // what was typed just now may not be kept either
    window.addEventListener("beforeunload", ask);
    window.addEventListener("pagehide", leave);
    this.stops = [
      session.versions.subscribe(() => this.later()),
      watchDraft(name, (draft) => draft && this.takeIn(draft)),
      () => window.removeEventListener("beforeunload", ask),
      () => window.removeEventListener("pagehide", leave),
    ];
  }
  get conflict(): string | null {
    return this.conflicts.get();
  }

  // The version that the server runs, as far as it is known.
  get live(): LiveVersion | null {
    return this.shownLive;
  }
  // Somebody has deployed another version than the one that this text began from.
  get behind(): boolean {
    return (
      this.shownLive !== null &&
      this.shownLive.text !== this.base &&
      this.shownLive.text !== this.session.written
    );
  }
  // The browser keeps the text.
  get isKept(): boolean {
    return kept.open() && !isUnkept(this.name);
  }

  // The server runs this version now. A text without changes of its own becomes it.
  sees(live: LiveVersion) {
    this.catchUp();
    const before = this.shownLive;
    this.shownLive = live;
    if (
      this.conflict === null &&
      this.base !== null &&
      this.session.written === this.base &&
      live.text !== this.base
    ) {
      this.base = live.text;
      this.session.mergeIn(live.text);
      this.save();
      toast("good", `${versionWords(live)} is here`, "Somebody has deployed it. You had changed nothing.");
    } else if (before?.text === live.text && before.number === live.number && before.timeUs === live.timeUs)
      return;
    this.told();
  }
  // Both the live version and what was changed here; null: both changed the same place.
  together(): string | null {
    return this.shownLive && this.base !== null
      ? mergeTexts(this.base, this.session.written, this.shownLive.text)
      : null;
  }
  putTogether() {
    const both = this.together();
    if (both === null || !this.shownLive) return;
    this.base = this.shownLive.text;
    this.session.mergeIn(both);
    this.save();
    this.told();
  }
  // Undo brings mine back.
  takeLive() {
    if (!this.shownLive) return;
    this.base = this.shownLive.text;
    this.session.replaceAll(this.shownLive.text);
    this.save();
    this.told();
  }

  // Where both changed the same place: one of the two is taken whole. Undo brings mine back.
  take() {
    const other = this.conflict;
    if (other === null) return;
    this.become(null);
    this.shared = other;
    this.base = loadDraft(this.name)?.base || this.base;
    this.session.replaceAll(other);
  }
  keep() {
    this.shared = this.conflict ?? this.shared;
    this.become(null);
    this.write();
  }

  // From now on the draft is what differs from this.
  isDeployed(text: string, version: string) {
    this.shownLive = {
      number: this.shownLive?.number ?? 0,
      version,
      timeUs: BigInt(Date.now()) * 1000n,
      text,
    };
    this.base = text;
    this.save();
    this.told();
  }

  private become(conflict: string | null) {
    this.conflicts.set(conflict);
    this.told();
  }
  private told() {
    this.turns.set(this.turns.get() + 1);
  }
  private later() {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.save(), restMs);
  }
  private takeIn({ text: other, base }: Draft) {
    const mine = this.session.written;
    if (other === mine) {
      this.shared = other;
      this.base = base || this.base;
      return this.become(null);
    }
    const merged = mergeTexts(this.shared, mine, other);
    if (merged === null) return this.become(other);
    const both = merged !== other; // the other tab has yet to hear of mine
    this.shared = other;
    this.base = base || this.base; // the other tab may have put a newer version in
    this.become(null);
    if (merged !== mine) {
      this.session.mergeIn(merged);
      toast(
        "good",
        both ? "Another tab’s changes are put together with yours" : "Another tab’s changes are here",
      );
    }
  }
  private save() {
    window.clearTimeout(this.timer);
    this.catchUp();
    if (this.conflict === null) this.write();
  }
  // What another tab has written since, and was not heard of yet.
  private catchUp() {
    const stored = this.conflict === null ? loadDraft(this.name) : null;
    if (stored && stored.text !== this.shared) this.takeIn(stored);
  }
  private write() {
    const text = this.session.written;
    const before = this.isKept;
    if (text === this.shownLive?.text) {
      dropDraft(this.name);
      this.base = text;
    } else saveDraft(this.name, text, this.base ?? "");
    this.shared = text;
    if (this.isKept !== before) this.told();
  }
  // A conflict that nobody has settled: mine is kept under another name.
  private leave() {
    if (this.session.version === 0) return;
    this.save();
    if (this.conflict !== null)
      saveDraft(uniqueName(new Set(listDrafts().map((d) => d.name)), this.name), this.session.written, "");
  }
  close() {
    this.leave();
    for (const stop of this.stops) stop();
  }
}

// "Version 1.2"
export function versionWords(live: Pick<LiveVersion, "version">): string {
  return live.version ? `Version ${live.version}` : "Another version";
}
