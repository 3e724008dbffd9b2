// The robot's own screen, served by its adapter: the page of the booth, and below it what the robot says, word for word.
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the robot's screen", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 2 }, "booth_guide.rsel.xml", "pictures.ttl");
  });
  afterAll(() => stage?.close());
  const invoke = (service: string) =>
    stage.processes.aside("services", "invoke", service, "--arg", `booth=${expo}B03`);

  it("follows the robot to the page of the booth, and marks the words as they are said", async () => {
    await stage.until(
      async () =>
        (await stage.call<{ robots?: { state: string }[] }>("Fleet/List")).robots?.[0]?.state === "standby",
    );
    const page = await stage.pages.page(await stage.processes.screen, { width: 1280, height: 720 });
    await page.getByText("May I guide you?").waitFor();
    expect(await invoke("displayInformation")).toBe(0);
    await page.getByRole("heading", { name: "Stairlark Robotics" }).waitFor();
    expect(
      await page
        .getByRole("img", { name: "Stairlark Carrier" })
        .evaluate((picture: HTMLImageElement) => picture.decode().then(() => picture.naturalWidth > 0)),
    ).toBe(true);
    const hall = await stage.page("/hall?at=expo:R01");
    expect(await hall.getByRole("link", { name: "Its screen" }).getAttribute("href")).toBe(
      await stage.processes.screen,
    );
    const speaks = invoke("briefInformation");
    await page.locator("#spoken .now").waitFor();
    await page.locator("#spoken .said").nth(5).waitFor();
    expect(await page.locator("#spoken").innerText()).toContain(
      "Welcome to booth B 3 of Stairlark Robotics.",
    );
    await stage.picture(page, "screen");
    expect(await seriousFindings(page)).toEqual([]);
    await page.locator("#spoken").waitFor({ state: "hidden" });
    expect(await speaks).toBe(0);
  });
  it("no page has thrown", () => stage.noFaults());
});
