// Drafts of one document in two tabs: what each writes comes to the other; nothing is lost without a word.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { DraftSync } from "../../src/compose/draft_sync";
import { listDrafts, loadDraft } from "../../src/compose/drafts";
import type { Session } from "../../src/compose/session";
import { Random } from "./random";

const name = "Tour";
const key = `docent.draft.${name}`;

// A browser: one storage for all tabs, which hear of it in their own time.
class Browser {
  readonly kept = new Map<string, string>();
  readonly tabs: Tab[] = [];
  install() {
    const kept = this.kept;
    const storage = { getItem: (k: string) => kept.get(k) ?? null, setItem: (k: string, v: string) => this.write(k, v), removeItem: (k: string) => this.write(k, null) };
    vi.stubGlobal("localStorage", new Proxy(storage, { ownKeys: () => [...kept.keys()], getOwnPropertyDescriptor: (_, k) => (kept.has(String(k)) ? { enumerable: true, configurable: true, value: "" } : undefined) }));
  }
  private write(k: string, v: string | null) {
    if (v === null) this.kept.delete(k);
    else this.kept.set(k, v);
    for (const tab of this.tabs) tab.unheard++; // also of its own, which does no harm
  }
}
class Tab {
  unheard = 0;
  written: string;
  version = 0;
  readonly sync: DraftSync;
  private changed: () => void = () => undefined;
  private hear: (event: { key: string }) => void = () => undefined;
  private leave: () => void = () => undefined;
  constructor(browser: Browser, text: string) {
    this.written = text;
    vi.stubGlobal("window", {
      addEventListener: (what: string, listener: (event?: unknown) => void) => (what === "storage" ? (this.hear = listener) : (this.leave = listener)), removeEventListener: () => undefined,
      setTimeout, clearTimeout,
    });
    this.sync = new DraftSync(name, this as unknown as Session, null);
    browser.tabs.push(this);
  }
  subscribe = (listener: () => void) => ((this.changed = listener), () => undefined);
  mergeIn(text: string) {
    this.edit(text);
  }
  replaceAll(text: string) {
    this.edit(text);
  }
  edit(text: string) {
    this.written = text;
    this.version++;
    this.changed();
  }
  listen() {
    if (this.unheard > 0) this.hear({ key });
    this.unheard = 0;
  }
  close() {
    this.leave();
  }
}

const rest = () => vi.advanceTimersByTime(400); // the timers of both tabs

describe("drafts in two tabs", () => {
  let browser: Browser;
  beforeEach(() => {
    vi.useFakeTimers();
    browser = new Browser();
    browser.install();
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });
  const base = "a\nb\nc\nd\ne";

  it("what the one writes comes to the other", () => {
    const [one, two] = [new Tab(browser, base), new Tab(browser, base)];
    one.edit("A\nb\nc\nd\ne");
    rest();
    two.listen();
    expect(two.written).toBe("A\nb\nc\nd\ne");
    two.edit("A\nb\nc\nd\ne\nf");
    rest();
    one.listen();
    expect(one.written).toBe("A\nb\nc\nd\ne\nf");
  });
  it("both write before they hear of each other: both keep both", () => {
    const [one, two] = [new Tab(browser, base), new Tab(browser, base)];
    one.edit("A\nb\nc\nd\ne");
    two.edit("a\nb\nc\nd\nE");
    rest(); // the second finds what the first has written
    one.listen();
    two.listen();
    rest();
    one.listen();
    two.listen();
    expect([one.written, two.written, loadDraft(name)?.text]).toEqual(Array(3).fill("A\nb\nc\nd\nE"));
  });
  it("both write at one place: nothing is written until somebody has chosen", () => {
    const [one, two] = [new Tab(browser, base), new Tab(browser, base)];
    one.edit("a\nb\nONE\nd\ne");
    rest();
    two.edit("a\nb\nTWO\nd\ne");
    two.listen();
    expect(two.sync.conflict).toBe("a\nb\nONE\nd\ne");
    rest();
    expect(loadDraft(name)?.text).toBe("a\nb\nONE\nd\ne");
    two.sync.keep();
    expect(two.sync.conflict).toBe(null);
    one.listen();
    expect(one.written).toBe("a\nb\nTWO\nd\ne");
  });
  it("a tab that is closed over a conflict leaves its text under another name", () => {
    const [one, two] = [new Tab(browser, base), new Tab(browser, base)];
    one.edit("a\nb\nONE\nd\ne");
    rest();
    two.edit("a\nb\nTWO\nd\ne");
    two.close();
    expect(listDrafts().map((d) => d.draft.text).sort()).toEqual(["a\nb\nONE\nd\ne", "a\nb\nTWO\nd\ne"]);
  });
  it("200 random edits in two tabs: all are in both, or a conflict is shown", () => {
    const random = new Random(11);
    let [edits, conflicts] = [0, 0];
    const long = Array.from({ length: 30 }, (_, i) => `line ${i}`).join("\n");
    const [one, two] = [new Tab(browser, long), new Tab(browser, long)];
    const written: string[] = [];
    while (edits < 200) {
      for (const tab of [one, two]) {
        const lines = tab.written.split("\n");
        const words = `edit ${edits++}`;
        written.push(words);
        lines.splice(random.below(lines.length), 0, words);
        tab.edit(lines.join("\n"));
        if (random.below(2)) tab.listen();
      }
      for (let k = 0; k < 4; k++) {
        rest();
        one.listen();
        two.listen();
        for (const tab of [one, two]) {
          if (tab.sync.conflict === null) continue;
          conflicts++;
          const gone = written.filter((w) => !tab.sync.conflict!.split("\n").includes(w));
          for (const w of gone) written.splice(written.indexOf(w), 1); // by choice
          tab.sync.take();
        }
      }
      expect(one.written).toBe(two.written);
      for (const words of written) expect(one.written.split("\n")).toContain(words);
    }
    expect(conflicts).toBeLessThan(60);
    expect(written.length).toBeGreaterThan(140);
  });
});
