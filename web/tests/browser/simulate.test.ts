// A document simulated before it is deployed, on a real server without any robot: played, stopped at breakpoints, with facts told in
// the simulation alone.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { draftNow, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);
const text = readFileSync(
  join(import.meta.dirname, "../../../scenarios/s01_booth_guide/booth_guide.cawl.xml"),
  "utf8",
);
// What a robot has left in the graph: it is away, and what it can do is known.
const leftByRobot = `
@prefix docent: <https://w3id.org/docent#> .
@prefix expo: <https://w3id.org/docent/expo#> .
@prefix op: <urn:docent:operation:> .
expo:R01 docent:localised true ; docent:x 9.6 ; docent:y 6.2 ; docent:isAt expo:RobotDock ;
  docent:offers op:moveToUser , op:moveToBooth , op:displayBoothInfo , op:briefBoothInfo .
op:moveToUser a docent:Operation ; docent:occupies "base" ; docent:input "user" ; docent:inputsKnown true .
op:moveToBooth a docent:Operation ; docent:occupies "base" ; docent:input "booth" ; docent:inputsKnown true .
expo:Entrance docent:x 5.6 ; docent:y 2.4 .
expo:B03 docent:x 15.0 ; docent:y 20.6 .
`;

describe.skipIf(why !== "")("simulation", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open(null, "booth_guide.rsel.xml");
    const file = join(stage.processes.folder, "left_by_robot.ttl");
    writeFileSync(file, leftByRobot);
    stage.processes.load(file);
  });
  afterAll(() => stage?.close());

  // The workflow as a draft of this browser, which the server does not have.
  const open = async (options = {}) => {
    page = await stage.page("/compose", { ...options, kept: true });
    await page.evaluate(
      (cawl) =>
        localStorage.setItem("docent.draft.BoothGuide", JSON.stringify({ text: cawl, base: "", savedMs: 1 })),
      text,
    );
    await page.goto(`${stage.processes.url}/compose/BoothGuide`);
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
  };
  const panel = () => page.getByRole("region", { name: "Simulate" });
  const list = () => page.locator(".simulate-events");
  const happened = (words: string | RegExp) =>
    page.locator(".simulate-events li:not(.to-come)", { hasText: words }).first();
  const step = (name: string) => page.locator(`.react-flow__node[data-id="${name}"]`);
  const clock = async () => Number((await page.getByRole("timer").innerText()).slice(3, 5));
  const simulate = async (user = "expo:John") => {
    await page.keyboard.press("Shift+S");
    await page.getByRole("button", { name: "Start values" }).click();
    await panel().getByRole("combobox", { name: "user" }).fill(user);
    await page.keyboard.press("Tab");
    await page.getByRole("button", { name: "Start values" }).click();
    await page.getByRole("button", { name: "Simulate", exact: true }).last().click();
    await list().waitFor();
  };
  // Fills the fields that are open and tells the fact.
  const tell = async (where: string, ...row: string[]) => {
    const form = panel().getByRole("region", { name: where });
    for (const [i, word] of row.entries()) {
      if (!word) continue;
      await form.getByRole("combobox").nth(i).fill(word);
      await form.getByRole("combobox").nth(i).press("Tab");
    }
    await form.locator("form button").click();
  };
  const toEnd = () => page.getByRole("slider", { name: "Simulated time" }).press("End");
  const known = async (pattern: string) =>
    (
      await stage.call<{ holds?: boolean }>("Context/Explain", {
        whyNot: `ASK { ${pattern} }`,
        prefixes: { expo, docent: "https://w3id.org/docent#" },
      })
    ).holds ?? false;

  it("an undeployed draft runs to where it waits for a fact, without any robot", async () => {
    await open();
    await simulate();
    await panel().getByText("Move2User waits for").waitFor();
    await panel().locator(".simulate-lack", { hasText: "expo:John docent:isAt ?userRegion" }).waitFor();
    await step("Move2User").locator(".state-chip.waiting").waitFor();
    await panel().getByText("OnChoice does not start a run on these facts").waitFor();
    await stage.picture(page, "simulate-waits");
  });
  it("what it lacks is told in the simulation, and it goes on to its end; the real graph knows nothing of it", async () => {
    await panel().getByRole("button", { name: "Tell it at 00:00" }).first().click();
    await tell("What is missing", "", "", "expo:Entrance");
    await list().getByText("R01 gets moveToUser(John)").waitFor();
    await toEnd();
    await panel().getByText("Move2Booth waits for").waitFor();
    await tell("Tell a fact", "expo:John", "docent:selected", "expo:B03");
    await tell("Tell a fact", "expo:R01", "docent:isAt", "expo:Entrance");
    await list().getByText("R01 gets moveToBooth(B03)").waitFor();
    await toEnd();
    await tell("Tell a fact", "expo:R01", "docent:isAt", "expo:B03");
    await tell("Tell a fact", "expo:John", "docent:isAt", "expo:B03");
    await list().getByText("the run is done").waitFor();
    await toEnd();
    await step("InfoBooth").locator(".state-chip.done").waitFor();
    await page.locator(".simulate-hall .hall-robot").waitFor({ state: "attached" });
    await stage.picture(page, "simulate-end");
    expect(await known("expo:R01 docent:isAt expo:RobotDock")).toBe(true);
    expect(await known("expo:John docent:selected expo:B03")).toBe(false);
    expect(await known("expo:John docent:isAt expo:B03")).toBe(false);
    expect((await stage.call<{ runs?: unknown[] }>("Workflows/ListRuns")).runs ?? []).toEqual([]);
  });
  it("a told fact can be taken away again; the clock stays where it was", async () => {
    const before = await page.getByRole("timer").innerText();
    expect(before).not.toContain("00:00");
    await panel().getByRole("button", { name: "Take back: told: expo:John docent:isAt expo:B03" }).click();
    await panel().getByText("InfoBooth waits for").waitFor();
    expect((await page.getByRole("timer").innerText()).slice(0, 5)).toBe(before.slice(0, 5));
    await panel()
      .locator(".simulate-lack", { hasText: "expo:John docent:isAt expo:B03" })
      .getByRole("button", { name: /Tell it at/ })
      .click();
    await list().getByText("the run is done").waitFor();
  });
  it("it plays ten times as fast, and each step shows its state at that moment", async () => {
    await page.emulateMedia({ reducedMotion: "no-preference" });
    await page.getByRole("slider", { name: "Simulated time" }).press("Home");
    expect(await clock()).toBe(0);
    const began = Date.now();
    await page.getByRole("button", { name: "Play", exact: true }).click();
    await expect.poll(clock, { interval: 50, timeout: 60_000 }).toBeGreaterThanOrEqual(4);
    const at = await clock();
    expect(at).toBeLessThanOrEqual((10 * (Date.now() - began)) / 1000 + 11);
    // A machine that is busy elsewhere may have played to the end by now: the moment to look at is chosen.
    await toEnd();
    await page.getByRole("slider", { name: "Simulated time" }).fill("40");
    await step("Move2User").locator(".state-chip.running").waitFor();
    await happened("R01 gets moveToUser(John)").waitFor();
    await stage.picture(page, "simulate-playing");
    const speed = page.getByRole("combobox", { name: "Speed of playing" });
    await speed.selectOption("1");
    await page.getByRole("button", { name: "Play", exact: true }).click();
    await page.getByRole("button", { name: "Pause" }).click();
    expect(await clock()).toBeGreaterThanOrEqual(4);
    await speed.selectOption("60");
    await page.getByRole("button", { name: "Play", exact: true }).click();
    await happened("the run is done").waitFor();
    await page.getByRole("button", { name: "Play", exact: true }).waitFor(); // it has come to its end
    await page.emulateMedia({ reducedMotion: "reduce" });
  });
  it("playing stops at a breakpoint, which survives a reload and is not in the text", async () => {
    await step("Move2Booth").click();
    await page.keyboard.press("b");
    await step("Move2Booth").locator('.step-breakpoint[aria-pressed="true"]').waitFor();
    await panel().getByRole("button", { name: "Simulate", exact: true }).last().click();
    const stopped = page.getByRole("status").filter({ hasText: "Stopped at Move2Booth" });
    await stopped.getByText("robot = expo:R01").waitFor();
    await stopped.getByText("Next, R01 would get moveToBooth(B03)").waitFor();
    await step("Move2Booth").locator(".state-chip.running").waitFor();
    expect(await page.locator(".simulate-events li.to-come").count()).toBeGreaterThan(0);
    await stage.picture(page, "simulate-stopped");
    await stopped.getByRole("button", { name: "Go on" }).click();
    await happened("the run is done").waitFor();
    expect(await draftNow(page, "BoothGuide")).not.toMatch(/breakpoint/i);
    await page.reload();
    await step("Move2Booth").locator('.step-breakpoint[aria-pressed="true"]').waitFor();
    await page.getByRole("button", { name: "Breakpoint at Move2Booth" }).click();
    await step("Move2Booth").locator('.step-breakpoint[aria-pressed="false"]').waitFor({ state: "attached" });
    await page.reload();
    await step("Move2Booth").locator('.step-breakpoint[aria-pressed="false"]').waitFor({ state: "attached" });
  });
  it("after an edit it is simulated again; with an error in the text it is not, and says so", async () => {
    await simulate();
    await panel().getByText("Move2User waits for").waitFor();
    await step("Move2User").click();
    await page.getByLabel("Properties of Move2User").getByRole("textbox", { name: "Name" }).fill("Fetch");
    await page.keyboard.press("Enter");
    await list().getByText("Fetch").first().waitFor();
    await panel().getByText("Fetch waits for").waitFor();
    await page.getByRole("button", { name: "Text", exact: true }).click();
    await page.locator(".cm-content").click();
    await page.keyboard.press("Control+Home");
    await page.keyboard.type("<");
    await panel().getByText("The text has errors").waitFor();
    await panel().getByText("before the edit", { exact: true }).waitFor();
    expect(await panel().getByRole("button", { name: "Simulate again" }).isDisabled()).toBe(true);
    await page.keyboard.press("Control+z");
    await panel().getByText("before the edit", { exact: true }).waitFor({ state: "detached" });
  });
  it("works by keyboard alone", async () => {
    await open();
    await page.keyboard.press("Shift+S");
    await page.waitForFunction(() => document.activeElement?.classList.contains("simulate-begin"));
    await page.keyboard.press("Enter");
    await panel().getByText("Move2User").first().waitFor();
    await page.waitForFunction(() => document.activeElement?.classList.contains("simulate-begin"));
    const current = () => page.locator('.simulate-events li[aria-current="true"]').innerText();
    await page.getByRole("button", { name: "Play", exact: true }).waitFor();
    for (let i = 0; i < 12; i++) await page.keyboard.press("ArrowLeft");
    expect(await page.locator(".simulate-events li:not(.to-come)").count()).toBe(0);
    await page.keyboard.press("ArrowRight");
    expect(await current()).toContain("the run begins");
    await page.keyboard.press("Tab"); // start values
    await page.keyboard.press("Tab"); // back
    await page.keyboard.press("Tab"); // play
    await page.keyboard.press("Space");
    await page.getByRole("button", { name: "Play", exact: true }).waitFor();
    await page.waitForFunction(() => document.querySelectorAll(".simulate-events li.to-come").length === 0);
    await page.keyboard.press("?");
    await page.getByText("In the panel of a simulation").waitFor();
    await page.keyboard.press("Escape");
  });
  for (const dark of [false, true])
    it(`no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
      await open({ dark });
      await step("Move2Booth").click();
      await page.keyboard.press("b");
      await simulate();
      await panel().getByText("Move2User waits for").waitFor();
      await panel().getByRole("button", { name: "Tell it at 00:00" }).first().click();
      await tell("What is missing", "", "", "expo:Entrance");
      await list().getByText("R01 gets moveToUser(John)").waitFor();
      await page.getByRole("button", { name: "Play", exact: true }).click();
      await page.getByText("Stopped at Move2Booth").waitFor();
      await stage.picture(page, `simulate-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
    });
  it("no page has thrown", () => stage.noFaults());
});
