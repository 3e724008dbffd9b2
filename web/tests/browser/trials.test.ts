// A document tried on past runs, without robots: which steps would go otherwise, runs kept as tests, one step alone.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("trials", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 16 }, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    await stage.guideJohn("expo:B03");
  });
  afterAll(() => stage?.close());
  const open = async (options = {}) => {
    page = await stage.page("/compose/BoothGuide", { ...options, kept: true });
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
  };
  const row = () => page.locator(".trials li", { hasText: "BoothGuide-1" });

  it("a past run is lived again with the document, and goes the same", async () => {
    await open();
    await page.keyboard.press("Shift+R");
    await row().getByRole("button", { name: "Try", exact: true }).click();
    await row().getByText("goes the same").waitFor();
    await page.locator('.react-flow__node[data-id="InfoBooth"] .state-chip.done').waitFor();
    expect(await page.locator(".step-differs").count()).toBe(0);
    await stage.picture(page, "trial-same");
  });
  it("kept as a test, it is tried after each edit: exactly the changed step is marked", async () => {
    await page.getByRole("button", { name: "Keep BoothGuide-1 as a test" }).click();
    await page.getByRole("button", { name: "Drop the test BoothGuide-1" }).waitFor();
    await page.locator('.react-flow__node[data-id="InfoBooth"]').click();
    await page.getByRole("button", { name: "Remove briefInformation" }).click();
    await row().getByText("differs at InfoBooth").waitFor();
    await page.locator(".findings-bar", { hasText: "1 of 1 test would go differently" }).waitFor();
    await page.locator('.react-flow__node[data-id="InfoBooth"] .step-differs').waitFor();
    expect(await page.locator(".step-differs").count()).toBe(1);
    await page.locator(".difference").first().waitFor();
    await stage.picture(page, "trial-otherwise");
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.keyboard.press("Control+z");
    await row().locator(".tag.good", { hasText: "goes the same" }).waitFor();
    expect(await page.locator(".step-differs").count()).toBe(0);
  });
  it("another browser has the test, too; a run is saved as a file", async () => {
    await open();
    await page.locator(".findings-bar", { hasText: "1 test" }).click();
    await page.getByRole("button", { name: "Drop the test BoothGuide-1" }).waitFor();
    const download = page.waitForEvent("download");
    await page.getByRole("button", { name: "Save BoothGuide-1 as a file" }).click();
    expect((await download).suggestedFilename()).toBe("BoothGuide-1.run.json");
  });
  it("from the run's page it is kept and tried again by a touch each", async () => {
    const run = await stage.page("/runs/BoothGuide-1");
    await run.getByRole("button", { name: "Drop the test" }).click();
    await run.getByRole("button", { name: "Keep as a test" }).click();
    await run.getByRole("button", { name: "Drop the test" }).waitFor();
    await stage.picture(run, "trial-run");
    await run.getByRole("link", { name: "Try with changes" }).click();
    await run.locator(".trials li", { hasText: "goes the same" }).waitFor();
    await run.locator('.react-flow__node[data-id="InfoBooth"] .state-chip.done').waitFor();
  });
  it("one step is tried on the facts of then and of now, and no robot gets anything", async () => {
    const before = await stage.call<{ runs: unknown[] }>("Workflows/ListRuns");
    await page.locator('.react-flow__node[data-id="Move2Booth"]').click();
    await page.getByRole("button", { name: "Try without a robot" }).click();
    await page.locator(".try-step").first().waitFor();
    await page
      .locator(".try-step", { hasText: /It would (open|wait)/ })
      .first()
      .waitFor();
    await page
      .getByRole("combobox", { name: "On which facts the step is tried" })
      .selectOption("BoothGuide-1");
    await page.getByRole("button", { name: "Try this step" }).click();
    await page
      .locator(".try-step", { hasText: "R01 would get moveToBooth(booth = expo:B03)" })
      .first()
      .waitFor();
    await page
      .locator(".try-step", { hasText: "It opens on the facts of turn" })
      .first()
      .scrollIntoViewIfNeeded();
    await stage.picture(page, "trial-step");
    expect((await stage.call<{ runs: unknown[] }>("Workflows/ListRuns")).runs.length).toBe(
      before.runs.length,
    );
    const { robots } = await stage.call<{ robots: { state: string }[] }>("Fleet/List");
    expect(robots[0]?.state).toBe("standby");
  });
  for (const dark of [false, true])
    it(`no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
      await open({ dark });
      await page.keyboard.press("Shift+R");
      await row().getByRole("button", { name: "Details of BoothGuide-1" }).click();
      await page.locator(".differences").waitFor();
      await stage.picture(page, `trial-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
    });
  it("no page has thrown", () => stage.noFaults());
});
