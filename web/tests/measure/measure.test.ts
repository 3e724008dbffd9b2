// Measures and prints; nothing fails by a number. npm run measure, after scripts/web and a build of docent.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { it } from "vitest";
import { Pages } from "../browser/pages";
import { guide } from "../browser/stage";
import { lacking, Processes } from "../browser/processes";

const dist = join(import.meta.dirname, "../../dist");
const tabs = 10;
const events = 20;
const quantile = (values: number[], q: number) => Math.round(values.slice().sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))] ?? 0);

it("sizes, first view, event to screen", { timeout: 300_000 }, async () => {
  const index = readFileSync(join(dist, "index.html"), "utf8");
  const packed = (names: string[]) => Math.round(names.reduce((n, name) => n + gzipSync(readFileSync(join(dist, "assets", name)), { level: 9 }).length, 0) / 1024);
  const assets = readdirSync(join(dist, "assets")).filter((name) => /\.(js|css)$/.test(name));
  console.log(`shell ${packed(assets.filter((name) => index.includes(name)))} KiB packed; all scripts and styles ${packed(assets)} KiB`);
  const why = lacking();
  if (why) return console.log(`not measured: ${why}`);
  const processes = new Processes();
  const { browser } = await Pages.open();
  try {
    await processes.startServer();
    for (const name of ["docent", "place", "robot", "run", "sensor", "service"]) processes.docent("load", "--as", "ontology", `ontology/${name}.ttl`);
    for (const name of ["hall.ttl", "world.ttl"]) processes.docent("load", `scenarios/s01_booth_guide/${name}`);
    processes.startRobot(4);
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    const page = await context.newPage();
    for (const [path, wait] of [["/compose", ".template"], ["/hall", ".shape"], ["/runs", ".nothing"], ["/board", ".nothing"]] as const) {
      const begin = Date.now();
      await page.goto(processes.url + path);
      await page.waitForSelector(wait);
      console.log(`${path} is there after ${Date.now() - begin} ms`);
    }
    await page.evaluate((text) => localStorage.setItem("docent.draft.BoothGuide", JSON.stringify({ text, base: "", savedMs: 1 })), guide.replace("<subject>$user</subject>\n              <verb>docent:selected</verb>\n              <object type=\"docent:Booth\">?booth</object>", "<subject>expo:John</subject><verb>docent:selected</verb><object>expo:B05</object>"));
    const others = await Promise.all(Array.from({ length: tabs - 1 }, () => context.newPage()));
    await Promise.all(others.map((tab, i) => tab.goto(`${processes.url}${i % 2 ? "/hall" : "/runs"}`, { waitUntil: "commit" })));
    page.setDefaultTimeout(120_000);
    await page.goto(`${processes.url}/compose/BoothGuide?step=Move2Booth`, { waitUntil: "commit" });
    await page.bringToFront();
    const row = page.locator(".constraint", { has: page.locator('input[value="expo:B05"]') });
    const times: number[] = [];
    for (let i = 0; i < events; i++) {
      await row.locator(".constraint-state.none").waitFor();
      const seen = row.locator(".constraint-state.some").waitFor().then(() => Date.now());
      processes.tell("expo:John docent:selected expo:B05");
      const told = Date.now();
      times.push(Math.max(0, (await seen) - told));
      processes.tell("expo:John docent:selected expo:B01");
    }
    console.log(`event to screen with ${tabs} tabs open: p50 ${quantile(times, 0.5)} ms, p95 ${quantile(times, 0.95)} ms, from the end of the command that told it`);
  } finally {
    await browser.close();
    await processes.close();
  }
});
