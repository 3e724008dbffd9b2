// The whole way, with a real server and a real robot: composed by dragging, deployed, started, watched to its end; reused in
// another workflow; a server that is killed and comes back.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { dragOnto } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("with a real server and robot", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 8 }, "booth_guide.rsel.xml");
    stage.processes.tell("--reading", "expo:DoorSensor=tag-17");
  });
  afterAll(() => stage?.close());
  const open = (path: string) => stage.page(path);
  const picture = (page: Page, name: string) => stage.picture(page, name);
  async function begin(page: Page, name: string) {
    await page.waitForSelector(".template");
    await page.getByRole("button", { name: "New workflow" }).click();
    await page.locator("#new-name").fill(name);
    await page.getByRole("button", { name: "Create" }).click();
    await page.waitForSelector(".first-steps");
  }
  const drag = async (page: Page, item: string, link: string) => {
    const steps = await page.locator(".react-flow__node").count();
    await dragOnto(page, page.locator(".palette-item", { hasText: item }).first(), link);
    await page.locator(".react-flow__node").nth(steps).waitFor();
  };
  async function deploy(page: Page) {
    await page.getByRole("button", { name: "Deploy" }).first().click();
    await page.locator("dialog").getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "is deployed" }).waitFor();
  }
  async function start(page: Page, values: Record<string, string>) {
    await page.keyboard.press("Escape");
    await page.getByRole("button", { name: "Run", exact: true }).click();
    for (const [name, value] of Object.entries(values)) {
      await page.locator(`dialog input[aria-label="${name}"]`).fill(value);
      await page.keyboard.press("Tab");
    }
    await page.locator("dialog").getByRole("button", { name: "Start" }).click();
    await page.waitForURL(/\/runs\/.+/);
  }

  it("BoothGuide is built by dragging alone, and runs to its end", async () => {
    const page = await open("/compose");
    await begin(page, "BoothGuide");
    await page.locator(".palette-item", { hasText: "Move to user" }).first().waitFor();
    await drag(page, "Move to user", "Begin → End");
    await drag(page, "Move to booth", "Move to user → End");
    await drag(page, "Display information", "Move to booth → End");
    await drag(page, "Brief information", "Display information → End");
    await picture(page, "built");
    expect(await page.locator(".react-flow__node").count()).toBe(6);
    await deploy(page);
    await start(page, { user: "expo:John", booth: "expo:B10" });
    const hall = await open("/hall");
    await hall.waitForSelector(".hall-robot.busy");
    await picture(hall, "hall");
    await page.locator(".head .tag", { hasText: "done" }).waitFor();
    await picture(page, "done");
  });

  it("John's Service is built by reusing BoothGuide", async () => {
    const page = await open("/compose");
    await begin(page, "John's Service");
    await page.locator(".palette-item", { hasText: "version 1.0" }).first().waitFor();
    await dragOnto(page, page.locator(".palette-item", { hasText: "version 1.0" }).first(), "Begin → End");
    await page.waitForSelector('.react-flow__node[data-id="Booth guide"]');
    await page.locator(".react-flow__pane").click({ position: { x: 30, y: 30 } });
    for (const name of ["user", "booth"]) await page.locator(`input[aria-label="Kind of ${name}"]`).waitFor(); // the values that the guide begins with come along
    expect(await page.locator('input[aria-label^="Kind of "]').count()).toBe(2);
    await page.locator('input[aria-label="Name of a new value"]').fill("user");
    expect(await page.locator("form.variable button").isDisabled()).toBe(true);
    await picture(page, "johns-service");
    await deploy(page);
    await start(page, { user: "expo:John", booth: "expo:B09" });
    await page.locator(".head .tag", { hasText: "done" }).waitFor();
    await page.locator(".runs-within li", { hasText: "BoothGuide-" }).waitFor();
    await picture(page, "johns-run");
    await page.getByRole("link", { name: "Runs" }).first().click();
    await page.locator("tbody tr", { hasText: "in John" }).waitFor();
    await picture(page, "runs");
  });

  it("a condition turns true soon after its fact is told elsewhere", async () => {
    const page = await open("/compose/BoothGuide");
    await page.locator(".template, .react-flow__node").first().waitFor();
    if ((await page.locator(".template").count()) > 0) await page.locator(".template").nth(1).click();
    await page
      .locator(".react-flow__node", { hasText: /Lead|Move to booth/ })
      .first()
      .click();
    if ((await page.locator(".constraint").count()) === 0)
      await page.getByRole("button", { name: "Wait for a situation" }).click();
    await page.locator('input[aria-label="Subject"]').first().fill("expo:John");
    await page.keyboard.press("Tab");
    await page.locator('input[aria-label="Verb"]').first().fill("docent:selected");
    await page.keyboard.press("Tab");
    await page.locator('input[aria-label="Object"]').first().fill("expo:B05");
    await page.keyboard.press("Tab");
    await page.locator(".constraint-state.none").first().waitFor();
    stage.processes.tell("expo:John docent:selected expo:B05");
    const told = Date.now();
    await page.locator(".constraint-state.some").first().waitFor();
    console.log(`the row turned ${Date.now() - told} ms after the fact was told`);
    await page.locator(".situation .tag.good").first().waitFor();
    await picture(page, "condition");
  });

  it("a tour is made on the map, and the check has nothing against it", async () => {
    const page = await open("/hall");
    await page.waitForSelector(".hall-robot");
    await page.getByRole("button", { name: "New tour" }).click();
    for (const booth of ["B03", "B05", "B07", "B10", "B09", "B01"])
      await page.locator(`.shape.booth[aria-label^="${booth},"]`).click();
    expect(await page.locator(".tour-stops li").count()).toBe(6);
    await picture(page, "tour");
    await page.getByRole("button", { name: "Make the workflow" }).click();
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
    expect(await page.locator(".react-flow__node").count()).toBe(14);
  });

  it("the server is killed and comes back: the tab goes on", async () => {
    const page = await open("/hall");
    await page.waitForSelector(".hall-robot");
    await stage.processes.killServer();
    await page.waitForSelector(".stale");
    expect(await page.locator(".hall-robot").count()).toBe(1);
    const connected = new Promise((done) =>
      page.on("websocket", (socket) => socket.once("framereceived", done)),
    );
    await stage.processes.startServer();
    await page.waitForSelector(".stale", { state: "detached" });
    await page.waitForSelector(".hall-robot.standby");
    await connected; // and is no longer asked by polling
  });

  it("no page has thrown", () => stage.noFaults());
});
