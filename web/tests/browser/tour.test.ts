// A tour is made on the map, with a text of its own at one booth, and is carried out by a robot.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { draft, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);
const speed = 16;

describe.skipIf(why !== "")("a tour", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed }, "booth_guide.rsel.xml");
    await stage.until(
      async () =>
        (await stage.call<{ robots?: { state: string }[] }>("Fleet/List")).robots?.[0]?.state === "standby",
    );
  });
  afterAll(() => stage?.close());
  let estimate = 0; // minutes

  it("is made by clicks, with what is shown and said at each booth", async () => {
    page = await stage.page("/hall", { kept: true });
    await page.waitForSelector(".hall-robot");
    await page.keyboard.press("t");
    for (const booth of ["B10", "B09", "B03"])
      await page.locator(`.shape.booth[aria-label^="${booth},"]`).click();
    await page.locator(".tour-stop", { hasText: "B09" }).click();
    await page.getByRole("textbox", { name: "Say here" }).fill("It's the nets' booth");
    await page.locator(".tour-own").getByLabel("Display information").uncheck();
    expect(await page.locator(".tour-present input:checked").count()).toBe(2); // services, and not the operations that they are made of
    // It is there again after another view, and after the page was loaded again.
    await page.keyboard.press("Tab");
    await page.getByRole("link", { name: "Runs" }).click();
    await page.getByRole("heading", { name: "Runs" }).waitFor();
    await page.goBack();
    await page.locator(".tour-stop", { hasText: "It's the nets' booth" }).waitFor();
    await page.reload();
    await page.locator(".tour-stop", { hasText: "It's the nets' booth" }).click();
    await page.getByRole("button", { name: "Close", exact: true }).click();
    await page
      .locator(".toast", { hasText: "The tour is left" })
      .getByRole("button", { name: "Undo" })
      .click();
    await page.locator(".tour-stop", { hasText: "B09" }).click();
    await page.getByLabel("Wait until the visitor is there").uncheck();
    estimate = Number(/About (\d+) min/.exec(await page.locator(".hall-details").innerText())?.[1]);
    await stage.picture(page, "tour-own");
    expect(await seriousFindings(page)).toEqual([]);
    await page.getByRole("button", { name: "Make the workflow" }).click();
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
    await draft(page, "Tour").toContain("It\\'s the nets\\' booth");
    await page.locator('.react-flow__node[data-id="At B09"]').getByText("Say").waitFor();
  });
  it("is carried out to its end", async () => {
    await page.keyboard.press("Control+Enter");
    await page.locator("dialog").getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "is deployed" }).waitFor();
    const { run } = await stage.call<{ run: string }>("Workflows/Start", {
      workflow: "Tour",
      variables: [{ name: "user", value: { iri: `${expo}John` } }],
    });
    page = await stage.page(`/runs/${run}`, { kept: true });
    await page.locator(".head .tag", { hasText: "done" }).waitFor();
    const { startedUs, endedUs } = await stage.call<{ startedUs: string; endedUs: string }>("Workflows/Get", {
      run,
    });
    console.log(
      `estimated ${estimate} min; the simulated robot took ${((((Number(endedUs) - Number(startedUs)) / 1e6) * speed) / 60).toFixed(1)} min`,
    );
    await stage.picture(page, "tour-done");
  });
  it("no page has thrown", () => stage.noFaults());
});
