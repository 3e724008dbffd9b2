// What all tests in a browser share: the one browser, pages whose mistakes are collected, pictures, axe.
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { type Browser, chromium, type Locator, type Page } from "playwright-core";
import { expect, inject, onTestFinished } from "vitest";

const web = join(import.meta.dirname, "../..");
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
// For one thing that is waited for, which comes at once on an idle machine.
export const patienceMs = 1000 * Number(process.env["DOCENT_PATIENCE_S"] ?? 30);

export interface PageOptions {
  dark?: boolean;
  width?: number;
  height?: number;
  language?: string;
  script?: string; // runs in each page before its own
  kept?: boolean; // for the tests of this file that come after this one; others are closed, as a page that nobody looks at works on
}

export class Pages {
  faults: string[] = []; // what pages wrote to the console as errors, or threw
  private constructor(readonly browser: Browser) {}

  static async open(): Promise<Pages> {
    return new Pages(await chromium.connect(inject("browser"), { timeout: patienceMs }));
  }
  async page(url: string, options: PageOptions = {}): Promise<Page> {
    const context = await this.browser.newContext({
      viewport: { width: options.width ?? 1280, height: options.height ?? 800 },
      colorScheme: options.dark ? "dark" : "light",
      reducedMotion: "reduce",
      locale: options.language ?? "en-GB",
      permissions: ["clipboard-read", "clipboard-write"],
    });
    context.setDefaultTimeout(patienceMs);
    if (options.script) await context.addInitScript(options.script);
    const page = await context.newPage();
    page.on("pageerror", (error) => this.faults.push(error.message));
    page.on(
      "console",
      (message) =>
        message.type() === "error" &&
        !/Failed to load resource|WebSocket connection/.test(message.text()) &&
        this.faults.push(message.text()),
    );
    onTestFinished(async ({ task }) => {
      // What a test saw that failed.
      if (task.result?.state === "fail")
        await picture(
          page,
          `failed-${task.name.replace(/\W+/g, "-").slice(0, 60)}-${context.pages().indexOf(page)}`,
        ).catch(() => undefined);
      if (!options.kept) await context.close();
    });
    await page.goto(url);
    return page;
  }
  // Ends the pages of this file; the browser goes on.
  async close() {
    for (const context of this.browser.contexts()) await context.close();
    await this.browser.close();
  }
}

// Keeps a picture for people to look at.
export async function picture(page: Page, name: string) {
  const folder = join(web, "test-results");
  mkdirSync(folder, { recursive: true });
  await settled(page);
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

// Until the fonts are there, nothing moves, and what was changed is drawn.
export async function settled(page: Page) {
  await page.evaluate(async () => {
    await document.fonts.ready;
    const moves = () =>
      document
        .getAnimations()
        .filter((a) => a.playState === "running" && a.effect?.getComputedTiming().iterations !== Infinity);
    while (moves().length > 0) await Promise.allSettled(moves().map((a) => a.finished));
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  });
}

// Until a thing stands still: the canvas moves by itself after each step that comes.
export async function still(thing: Locator) {
  await thing.waitFor();
  await thing.evaluate(async (element) => {
    let last = "";
    for (let frames = 0; frames < 20;) {
      await new Promise((done) => requestAnimationFrame(done));
      const { x, y } = element.getBoundingClientRect();
      frames = `${x} ${y}` === last ? frames + 1 : 0;
      last = `${x} ${y}`;
    }
  });
}

// Drags something of the palette onto a link ("Begin → End").
export async function dragOnto(page: Page, item: Locator, link: string) {
  const target = page.locator(`[data-link="${link}"]`);
  await still(target);
  await item.dragTo(target, { force: true });
}

// Serious and critical findings of axe, in words.
export async function seriousFindings(page: Page): Promise<string[]> {
  await settled(page);
  return page.evaluate(
    `${axe}; axe.run(document, { resultTypes: ["violations"] }).then((r) => r.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => v.id + ": " + v.nodes.slice(0, 6).map((n) => n.target + " " + (n.any[0]?.message ?? "")).join(" | ")))`,
  );
}

export async function fitsTheWindow(page: Page) {
  await settled(page);
  expect(
    await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth),
  ).toBeLessThanOrEqual(0);
}

// What is kept in this browser under a key of a draft; it is kept a moment after an edit.
export function draftNow(page: Page, name: string): Promise<string> {
  return page.evaluate(
    (key) => (JSON.parse(localStorage.getItem(key) ?? '{"text":""}') as { text: string }).text,
    `docent.draft.${name}`,
  );
}
// To be followed by toBe, toContain or another of expect's: asked until it is so.
export function draft(page: Page, name: string) {
  return expect.poll(() => draftNow(page, name), { timeout: patienceMs, interval: 100 });
}
