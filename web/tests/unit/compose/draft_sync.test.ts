// Drafts of one document in two tabs: what each writes comes to the other; nothing is lost without a word.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { keptIn } from "../../../src/api/storage";
import { DraftSync } from "../../../src/compose/draft_sync";
import { dropDraft, listDrafts, loadDraft } from "../../../src/flow/drafts";
import { baseAt, liveOf, type LiveVersion } from "../../../src/compose/load_document";
import type { Session } from "../../../src/compose/session";
import { Random } from "../random";

const name = "Tour";
const key = `docent.draft.${name}`;

// A browser: one storage for all tabs, which hear of it in their own time.
class Browser {
  readonly kept = new Map<string, string>();
  readonly tabs: Tab[] = [];
  install() {
    const kept = this.kept;
    const storage = {
      getItem: (k: string) => kept.get(k) ?? null,
      setItem: (k: string, v: string) => this.write(k, v),
      removeItem: (k: string) => this.write(k, null),
    };
    vi.stubGlobal(
      "localStorage",
      new Proxy(storage, {
        ownKeys: () => [...kept.keys()],
        getOwnPropertyDescriptor: (_, k) =>
          kept.has(String(k)) ? { enumerable: true, configurable: true, value: "" } : undefined,
      }),
    );
  }
  full = false;
  private write(k: string, v: string | null) {
    if (this.full && v !== null) throw new DOMException("full", "QuotaExceededError");
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
  private ask: (event: { preventDefault: () => void }) => void = () => undefined;
  constructor(browser: Browser, text: string, live: LiveVersion | null = null, base?: string | null) {
    this.written = text;
    vi.stubGlobal("window", {
      addEventListener: (what: string, listener: (event?: unknown) => void) =>
        void (what === "storage"
          ? (this.hear = listener)
          : what === "pagehide"
            ? (this.leave = listener)
            : (this.ask = listener)),
      removeEventListener: () => undefined,
      setTimeout,
      clearTimeout,
    });
    this.sync = new DraftSync(name, this as unknown as Session, live, base);
    browser.tabs.push(this);
  }
  versions = { subscribe: (listener: () => void) => ((this.changed = listener), () => undefined) };
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
  // Whether the browser asks before the page is left.
  asks(): boolean {
    let asked = false;
    this.ask({ preventDefault: () => (asked = true) });
    return asked;
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
    expect(
      listDrafts()
        .map((d) => d.draft.text)
        .sort(),
    ).toEqual(["a\nb\nONE\nd\ne", "a\nb\nTWO\nd\ne"]);
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

describe("a version that somebody else deploys meanwhile", () => {
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
  const live = (number: number, text: string): LiveVersion => ({
    number,
    version: `1.${number}`,
    timeUs: BigInt(number),
    text,
  });

  it("is followed where nothing was changed here, and nothing is kept as a draft", () => {
    const tab = new Tab(browser, base, live(1, base));
    tab.sync.sees(live(2, "A\nb\nc\nd\ne"));
    expect([tab.written, tab.sync.behind, loadDraft(name)]).toEqual(["A\nb\nc\nd\ne", false, null]);
    rest();
    tab.sync.sees(live(3, base)); // back again
    rest();
    expect([tab.written, loadDraft(name)]).toEqual([base, null]);
  });
  it("is said where something was changed here, also after the page was loaded again, and put together where that is possible", () => {
    const tab = new Tab(browser, base, live(1, base));
    tab.edit("a\nb\nc\nd\nMINE");
    rest();
    tab.sync.sees(live(2, "THEIRS\nb\nc\nd\ne"));
    expect([tab.written, tab.sync.behind]).toEqual(["a\nb\nc\nd\nMINE", true]);
    tab.edit("a\nb\nc\nd\nMINE\nmore");
    rest();
    tab.close();
    const kept = loadDraft(name)!;
    expect(kept.base).toBe(base);
    const again = new Tab(browser, kept.text, live(2, "THEIRS\nb\nc\nd\ne"), kept.base);
    expect(again.sync.behind).toBe(true);
    again.sync.putTogether();
    expect([again.written, again.sync.behind, loadDraft(name)?.base]).toEqual([
      "THEIRS\nb\nc\nd\nMINE\nmore",
      false,
      "THEIRS\nb\nc\nd\ne",
    ]);
  });
  it("at the same place is taken, or written over on purpose", () => {
    const tab = new Tab(browser, base, live(1, base));
    tab.edit("MINE\nb\nc\nd\ne");
    tab.sync.sees(live(2, "THEIRS\nb\nc\nd\ne"));
    expect([tab.sync.behind, tab.sync.together()]).toEqual([true, null]);
    tab.sync.isDeployed("MINE\nb\nc\nd\ne", "1.3");
    expect([tab.sync.behind, loadDraft(name)]).toEqual([false, null]);
    tab.edit("mine\nb\nc\nd\ne");
    tab.sync.sees(live(4, "theirs\nb\nc\nd\ne"));
    tab.sync.takeLive();
    rest();
    expect([tab.written, tab.sync.behind, loadDraft(name)]).toEqual(["theirs\nb\nc\nd\ne", false, null]);
  });
  it("is put together by one tab for the other one, too", () => {
    const [one, two] = [new Tab(browser, base, live(1, base)), new Tab(browser, base, live(1, base))];
    one.edit("a\nb\nc\nd\nMINE");
    rest();
    two.listen();
    for (const tab of [one, two]) tab.sync.sees(live(2, "THEIRS\nb\nc\nd\ne"));
    one.sync.putTogether();
    two.listen();
    rest();
    expect([one.written, two.written]).toEqual(Array(2).fill("THEIRS\nb\nc\nd\nMINE"));
    expect([one.sync.behind, two.sync.behind]).toEqual([false, false]);
  });
  it("is what a file or a new text of the same name did not begin from", () => {
    expect(new Tab(browser, "new", live(1, base), null).sync.behind).toBe(true);
    expect(new Tab(browser, base, live(1, base), null).sync.behind).toBe(false);
  });
  it("is the live one; of drafts that do not say it, the one that was deployed when they were saved is their base", () => {
    const versions = [live(1_000_000, "one"), live(2_000_000, "two"), live(3_000_000, "three")];
    expect(liveOf([{ ...versions[0]!, live: true }, versions[1]!])?.text).toBe("one");
    expect(liveOf(versions)?.text).toBe("three");
    expect(liveOf([])).toBe(null);
    expect([500, 1000, 2500].map((ms) => baseAt(versions, ms))).toEqual([null, "one", "two"]);
  });
});

describe("a browser whose storage is full or closed", () => {
  afterEach(() => {
    dropDraft(name);
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });
  it("has the draft as long as the page, says so, and asks before it is left", () => {
    vi.useFakeTimers();
    const browser = new Browser();
    browser.install();
    const tab = new Tab(browser, "a");
    expect([tab.sync.isKept, tab.asks()]).toEqual([true, false]);
    browser.full = true;
    tab.edit("b"); // just now: it was not tried yet
    expect(tab.asks()).toBe(true);
    expect([tab.sync.isKept, loadDraft(name)?.text, listDrafts().map((d) => d.name)]).toEqual([
      false,
      "b",
      [name],
    ]);
    browser.full = false;
    tab.edit("c");
    rest();
    expect([tab.sync.isKept, tab.asks(), browser.kept.size]).toEqual([true, false, 1]);
  });
  it("is asked without harm", () => {
    const closed = keptIn(() => {
      throw new DOMException("Access is denied for this document.", "SecurityError");
    });
    expect([
      closed.open(),
      closed.getItem("a"),
      closed.setItem("a", "1"),
      closed.getItem("a"),
      closed.keys(),
    ]).toEqual([false, null, false, "1", ["a"]]);
    closed.removeItem("a");
    expect(closed.getItem("a")).toBe(null);
  });
});
