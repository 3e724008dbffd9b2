// Measures and prints; nothing fails by a number. npm run measure, after scripts/web and a build of docent.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Page } from "playwright-core";
import { it } from "vitest";
import { Pages } from "../browser/pages";
import { guide } from "../browser/stage";
import { lacking, Processes } from "../browser/processes";

const dist = join(import.meta.dirname, "../../dist");
const expo = "https://w3id.org/docent/expo#";
const docent = "https://w3id.org/docent#";
const tabs = 10;
const robots = 20; // that tell where they are four times a second
const events = 40;
const quantile = (values: number[], q: number) =>
  Math.round(
    values.slice().sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))] ?? 0,
  );
const robotName = (i: number) => `M${String(i + 1).padStart(2, "0")}`;

it("sizes, first view, event to screen", { timeout: 600_000 }, async () => {
  const index = readFileSync(join(dist, "index.html"), "utf8");
  const packed = (names: string[]) =>
    Math.round(
      names.reduce(
        (n, name) => n + gzipSync(readFileSync(join(dist, "assets", name)), { level: 9 }).length,
        0,
      ) / 1024,
    );
  const assets = readdirSync(join(dist, "assets")).filter((name) => /\.(js|css)$/.test(name));
  console.log(
    `shell ${packed(assets.filter((name) => index.includes(name)))} KiB packed; all scripts and styles ${packed(assets)} KiB`,
  );
  const why = lacking();
  if (why) return console.log(`not measured: ${why}`);
  const processes = new Processes();
  const { browser } = await Pages.open();
  let moving: ReturnType<typeof setInterval> | undefined;
  try {
    await processes.startServer();
    for (const name of ["docent", "place", "robot", "run", "sensor", "service"])
      processes.docent("load", "--as", "ontology", `ontology/${name}.ttl`);
    for (const name of ["hall.ttl", "world.ttl"])
      processes.docent("load", `scenarios/s01_booth_guide/${name}`);
    for (let i = 0; i < robots; i++) await processes.startAdapter(expo + robotName(i), ["driveTo"]);
    const tell = (i: number, x: number, y: number) =>
      fetch(`${processes.url}/docent.v1.Context/Assert`, {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({
          source: expo + robotName(i),
          rdf: `<${expo}${robotName(i)}> <${docent}x> ${x.toFixed(3)} ; <${docent}y> ${y.toFixed(3)} ; <${docent}heading> 0.0 .`,
        }),
      });
    for (let i = 0; i < robots; i++) await tell(i, 2 + (i % 10) * 3, 2 + i / 2);
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    for (const [path, wait] of [
      ["/compose", ".template"],
      ["/hall", ".hall-robot"],
      ["/runs", ".nothing"],
      ["/board", ".nothing"],
    ] as const) {
      const begin = Date.now();
      await page.goto(processes.url + path);
      await page.waitForSelector(wait);
      const paint = await page.evaluate(() =>
        Math.round(performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? 0),
      );
      console.log(`${path}: painted first after ${paint} ms, there after ${Date.now() - begin} ms`);
    }
    const others = await Promise.all(Array.from({ length: tabs - 1 }, () => context.newPage()));
    // As a browser tells tabs that are not in front; a headless one takes all for seen.
    await Promise.all(
      others.map((tab) =>
        tab.addInitScript(() => {
          Object.defineProperty(document, "visibilityState", { get: () => "hidden" });
          Object.defineProperty(document, "hidden", { get: () => true });
        }),
      ),
    );
    await Promise.all(
      others.map((tab, i) =>
        tab.goto(`${processes.url}${i % 2 ? "/hall" : "/runs"}`, { waitUntil: "commit" }),
      ),
    );
    page.setDefaultTimeout(120_000);
    let turn = 0;
    moving = setInterval(() => {
      turn++;
      for (let i = 1; i < robots; i++)
        void tell(i, 2 + (i % 10) * 3 + Math.sin(turn / 8 + i), 2 + i / 2 + Math.cos(turn / 8 + i)).catch(
          () => undefined,
        );
    }, 250);
    await page.goto(`${processes.url}/hall`, { waitUntil: "commit" });
    await page.bringToFront();
    await page.locator(`.hall-robot[data-iri="${expo}M01"]`).waitFor();
    const moved = await poseTimes(page);
    console.log(
      `a robot's move to the screen, ${robots} robots that move, ${tabs} tabs: p50 ${quantile(moved, 0.5)} ms, p95 ${quantile(moved, 0.95)} ms, from the call that tells it`,
    );
    await page.evaluate(
      (text) =>
        localStorage.setItem("docent.draft.BoothGuide", JSON.stringify({ text, base: "", savedMs: 1 })),
      guide.replace(
        '<subject>$user</subject>\n              <verb>docent:selected</verb>\n              <object type="docent:Booth">?booth</object>',
        "<subject>expo:John</subject><verb>docent:selected</verb><object>expo:B05</object>",
      ),
    );
    await page.goto(`${processes.url}/compose/BoothGuide?step=Move2Booth`, { waitUntil: "commit" });
    await page.locator(".constraint", { has: page.locator('input[value="expo:B05"]') }).waitFor();
    const chips = await conditionTimes(page);
    console.log(
      `a fact to the condition that it makes true, ${robots} robots that move, ${tabs} tabs: p50 ${quantile(chips, 0.5)} ms, p95 ${quantile(chips, 0.95)} ms, from the call that tells it`,
    );
    const frame = await page.evaluate(
      () =>
        new Promise<number>((done) => {
          const begin = performance.now();
          let frames = 0;
          const step = () =>
            ++frames === 60 ? done((performance.now() - begin) / 60) : requestAnimationFrame(step);
          requestAnimationFrame(step);
        }),
    );
    console.log(`a frame of the tab in front takes ${frame.toFixed(1)} ms`);
  } finally {
    clearInterval(moving);
    await browser.close();
    await processes.close();
  }
});

// Of each move of M01 that the page tells itself: until the drawing has it.
function poseTimes(page: Page): Promise<number[]> {
  return page.evaluate(
    async ({ expo, docent, events }) => {
      const robot = document.querySelector<HTMLElement>(`.hall-robot[data-iri="${expo}M01"]`);
      const times: number[] = [];
      for (let i = 0; robot && i < events; i++) {
        const x = (20 + i * 0.125).toFixed(3);
        const begin = performance.now();
        const seen = new Promise<number>((done) => {
          const observer = new MutationObserver(() => {
            if (!robot.style.transform.includes(`${Number(x)}px`)) return;
            observer.disconnect();
            done(performance.now() - begin);
          });
          observer.observe(robot, { attributes: true });
        });
        await fetch("/docent.v1.Context/Assert", {
          method: "POST",
          headers: { "Content-Type": "application/json" },
          body: JSON.stringify({ source: `${expo}M01`, rdf: `<${expo}M01> <${docent}x> ${x} .` }),
        });
        times.push(await seen);
        await new Promise((done) => setTimeout(done, 37 + (i % 7) * 29)); // at any moment of the others' turns
      }
      return times;
    },
    { expo, docent, events },
  );
}

// Of each selection that the page tells itself: until its row says that it matches.
function conditionTimes(page: Page): Promise<number[]> {
  return page.evaluate(
    async ({ expo, docent, events }) => {
      const row = [...document.querySelectorAll<HTMLElement>(".constraint")].find((r) =>
        r.querySelector('input[value="expo:B05"]'),
      );
      const tell = (booth: string) =>
        fetch("/docent.v1.Context/Assert", {
          method: "POST",
          headers: { "Content-Type": "application/json" },
          body: JSON.stringify({ rdf: `<${expo}John> <${docent}selected> <${expo}${booth}> .` }),
        });
      const until = (what: string) =>
        new Promise<void>((done) => {
          const look = () => (row?.querySelector(what) ? (observer.disconnect(), done()) : undefined);
          const observer = new MutationObserver(look);
          if (row) observer.observe(row, { subtree: true, childList: true, attributes: true });
          look();
        });
      const times: number[] = [];
      for (let i = 0; row && i < events; i++) {
        await tell("B01");
        await until(".constraint-state.none");
        await new Promise((done) => setTimeout(done, 61 + (i % 7) * 29));
        const begin = performance.now();
        await Promise.all([tell("B05"), until(".constraint-state.some")]);
        times.push(performance.now() - begin);
      }
      return times;
    },
    { expo, docent, events },
  );
}
