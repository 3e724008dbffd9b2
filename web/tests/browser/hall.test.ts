// The hall with a real robot: what it can do, for whom it is kept, its way.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the hall", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 1 }, "booth_guide.rsel.xml", "booth_guide.cawl.xml"); // so that its way is seen
  });
  afterAll(() => stage?.close());

  it("says what a robot can do; it is reserved and released", async () => {
    page = await stage.page("/hall", { kept: true });
    await page.locator(".hall-row", { hasText: "R01" }).click();
    await page.locator(".hall-details .tag", { hasText: "Navigation" }).waitFor();
    await page.locator(".hall-details .tag", { hasText: "Speech synthesis" }).waitFor();
    await page.getByRole("button", { name: "Reserve" }).click();
    await page.getByRole("combobox", { name: "For which workflow or run" }).fill("BoothGuide");
    await page.getByRole("textbox", { name: "Why" }).fill("the guided tour at noon");
    await stage.picture(page, "reserve");
    expect(await seriousFindings(page)).toEqual([]);
    await page.locator("dialog").getByRole("button", { name: "Reserve" }).click();
    await page.locator(".reservation", { hasText: "for workflow BoothGuide" }).waitFor();
    await page.locator(".reservation", { hasText: "the guided tour at noon" }).waitFor();
    await stage.picture(page, "reserved");
    await page.getByRole("button", { name: "Release the reservation for workflow BoothGuide" }).click();
    await page.locator(".reservation").waitFor({ state: "detached" });
  });
  it("a reservation that can't be made says why", async () => {
    await page.getByRole("button", { name: "Reserve" }).click();
    await page.getByRole("combobox", { name: "For which workflow or run" }).fill("Nonsense");
    await page.locator("dialog").getByRole("button", { name: "Reserve" }).click();
    await page.locator("dialog [role=alert]", { hasText: "Nonsense" }).waitFor();
    await page.keyboard.press("Escape");
    await page.locator("dialog").waitFor({ state: "detached" });
  });
  it("shows the way of a robot that drives, and how sure it is of its place", async () => {
    page = await stage.page("/hall?at=expo:R01", { kept: true });
    await page.locator(".hall-robot").waitFor();
    await stage.call("Workflows/Start", {
      workflow: "BoothGuide",
      variables: [{ name: "user", value: { iri: "https://w3id.org/docent/expo#John" } }],
    });
    stage.processes.tell("--reading", "expo:DoorSensor=tag-17");
    await page.locator(".hall-way polyline").waitFor();
    expect(Number(await page.locator(".hall-deviation").getAttribute("r"))).toBeGreaterThan(0);
    expect(await page.locator(".hall-details").innerText()).toMatch(/± 0\.\d\d m/);
    await stage.picture(page, "way");
    await page.locator(".hall-way").waitFor({ state: "detached" }); // it has arrived
    await page.locator(".lately li", { hasText: "BoothGuide-1" }).waitFor();
  });
  for (const dark of [false, true])
    it(`no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
      await stage.call("Fleet/Reserve", {
        robots: ["https://w3id.org/docent/expo#R01"],
        keptFor: "BoothGuide",
        lastingMs: "60000",
      });
      page = await stage.page("/hall?at=expo:R01", { dark, kept: true });
      await page.locator(".reservation").first().waitFor();
      await stage.picture(page, `robot-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
    });
  it("where somebody is, is told in the panel that Ctrl-K leads to, and so is any other fact", async () => {
    page = await stage.page("/hall", { kept: true });
    await page.locator(".hall-row", { hasText: "John" }).waitFor();
    await page.keyboard.press("Control+k");
    await page.keyboard.type("John is at");
    await page.keyboard.press("Enter");
    const place = page.getByRole("combobox", { name: "John is at" });
    await place.selectOption({ label: "West aisle" });
    await page.locator(".tell-place").getByRole("button", { name: "Tell it" }).click();
    await page.locator(".toast.good", { hasText: "John is at West aisle" }).waitFor();
    await page.locator(".fact", { hasText: "expo:WestAisle" }).waitFor();
    await stage.picture(page, "tell-place");
    await page.getByRole("button", { name: "Tell another fact" }).click();
    expect(await page.locator('dialog input[aria-label="Subject"]').inputValue()).toBe("expo:John");
    await page.keyboard.press("Escape");
    await page.locator("dialog").waitFor({ state: "detached" });
    await page.keyboard.press("Control+k");
    await page.keyboard.type("Tell a fact");
    await page.keyboard.press("Enter");
    await page.locator('dialog input[aria-label="Verb"]').waitFor();
    await stage.picture(page, "tell-fact");
    expect(await seriousFindings(page)).toEqual([]);
  });
  it("what is chosen in the list comes into view; names are as large however near the hall is, and can be read on a phone", async () => {
    for (const options of [
      { width: 1280, height: 800 },
      { width: 390, height: 844 },
    ]) {
      page = await stage.page("/hall", { ...options, kept: true });
      const robot = page.locator(".hall-robot");
      await robot.waitFor();
      const name = page.locator(".shape-label.booth text").first();
      const far = await name.evaluate((text) => text.getBoundingClientRect().height);
      expect(far).toBeGreaterThan(12);
      expect(await page.getByRole("heading", { level: 1 }).innerText()).toBe("Hall");
      await stage.picture(page, `hall-names-${options.width}`);
      for (let i = 0; i < 7; i++) await page.getByRole("button", { name: "Nearer" }).click();
      await expect
        .poll(() => name.evaluate((text) => text.getBoundingClientRect().height))
        .toBeCloseTo(far, -1);
      await stage.picture(page, `hall-near-${options.width}`);
      await page.locator(".hall-row", { hasText: "R01" }).click();
      const map = (await page.locator(".hall-svg").boundingBox())!;
      await expect
        .poll(async () => {
          const box = (await robot.locator(".hall-body").boundingBox())!;
          return (
            box.x > map.x &&
            box.y > map.y &&
            box.x + box.width < map.x + map.width &&
            box.y + box.height < map.y + map.height
          );
        })
        .toBe(true);
    }
  });
  it("no page has thrown", () => stage.noFaults());
});
