// The time bar: hall, runs and facts go back through the log together, and back to live.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { fitsTheWindow, patienceMs, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the time bar", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 16 }, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    await stage.guideJohn("expo:B03");
  });
  afterAll(() => stage?.close());
  const words = () => page.locator(".time-words").innerText();
  // To the moment in which a step of the run opened, by the key of the event before.
  const backTo = async (what: string) => {
    for (let i = 0; i < 20 && !(await words()).includes(what); i++) {
      const before = await words();
      await page.keyboard.press(",");
      await expect.poll(words, { timeout: patienceMs }).not.toBe(before);
    }
    expect(await words()).toContain(what);
  };
  const chip = (node: string, state: string) =>
    page.locator(`.react-flow__node[data-id="${node}"] .state-chip.${state}`);

  it("a run is seen as it was, step for step, and what it lacked then", async () => {
    page = await stage.page("/runs/BoothGuide-1", { kept: true });
    await page.locator(".time-marks span").first().waitFor();
    await chip("InfoBooth", "done").waitFor();
    await backTo("Move2User of BoothGuide-1 is done");
    await chip("Move2Booth", "waiting").waitFor();
    await chip("InfoBooth", "inactive").waitFor();
    await page.locator(".lack", { hasText: "selected" }).waitFor();
    expect(await page.getByRole("button", { name: "Cancel" }).count()).toBe(0); // the past can't be changed
    await page.waitForFunction(() => /[?&]t=2/.test(location.search));
    await stage.picture(page, "time-run");
  });
  it("what was waited for then is on the board, where nothing can be changed", async () => {
    await page.getByRole("link", { name: "Waiting" }).click();
    await page.waitForFunction(() => location.pathname === "/board" && /[?&]t=2/.test(location.search));
    await page.locator(".board-group", { hasText: "selected" }).waitFor();
    expect(await page.getByRole("button", { name: "Simulate or tell" }).count()).toBe(0);
    expect(await page.getByRole("button", { name: "Cancel" }).count()).toBe(0);
    await stage.picture(page, "time-board");
  });
  it("hall and facts go along, and the address restores it", async () => {
    await page.getByRole("link", { name: "Hall" }).click();
    await page.waitForFunction(() => location.pathname === "/hall" && /[?&]t=2/.test(location.search));
    await page.locator(".hall-row", { hasText: "R01" }).getByText("at Entrance").waitFor();
    await page.locator(".hall-person").waitFor();
    await page.locator(".hall-row", { hasText: "John" }).click();
    await page.locator(".hall-details").getByText("expo:Entrance").waitFor();
    expect(await page.locator(".hall-details").getByText("docent:selected").count()).toBe(0);
    await page
      .locator(".hall-details .fact", { hasText: "expo:Entrance" })
      .getByRole("button", { name: "Why?" })
      .click();
    await page.locator(".hall-details .proof", { hasText: "reading of" }).waitFor(); // as of then: John is elsewhere now
    await stage.picture(page, "time-hall");
    // The next event is asked for before the events are known: the time stays.
    let answer = () => {};
    const held = new Promise<void>((resolve) => (answer = resolve));
    await page.route("**/docent.v1.Context/Query", async (route) => {
      if (route.request().postDataBuffer()?.includes("docent:firedAt")) await held;
      await route.continue();
    });
    await page.reload();
    await page.locator(".hall-details").getByText("expo:Entrance").waitFor();
    const then = await page.evaluate(() => new URLSearchParams(location.search).get("t"));
    await page.keyboard.press(".");
    expect(await page.getByRole("button", { name: "The next event" }).isDisabled()).toBe(true);
    expect(await page.evaluate(() => new URLSearchParams(location.search).get("t"))).toBe(then);
    answer();
    await page.locator(".time-marks span").first().waitFor();
    await page.locator(".time-bar.past").waitFor();
    await page.keyboard.press("."); // Move2Booth opens: a booth is selected
    await page.locator(".hall-details").getByText("docent:selected").waitFor();
  });
  it("it is played, and live again by a key", async () => {
    await page.keyboard.press("Escape");
    const x = () => page.locator(".hall-robot").evaluate((e) => getComputedStyle(e).transform);
    const before = await x();
    await page.getByRole("combobox", { name: "Speed of playing" }).selectOption("16");
    await page.getByRole("button", { name: "Play the past" }).click();
    await expect.poll(x, { timeout: patienceMs }).not.toBe(before);
    await page.keyboard.press("l");
    await page.locator(".time-live.on").waitFor();
    await page.locator(".hall-row", { hasText: "R01" }).getByText("at B03").waitFor();
    await page.waitForFunction(() => !location.search.includes("t="));
  });
  it("a run that had not begun is said so", async () => {
    page = await stage.page("/runs/BoothGuide-1?t=2020-01-01T00:00:00.000Z", { kept: true });
    await page.getByText("BoothGuide-1 had not begun yet").waitFor();
    await stage.picture(page, "time-before");
  });
  it("the slider goes by keys, and says its time", async () => {
    page = await stage.page("/hall", { kept: true });
    const slider = page.getByRole("slider", { name: "Time that is shown" });
    await slider.focus();
    await page.keyboard.press("ArrowLeft");
    await page.locator(".time-bar.past").waitFor();
    expect(await slider.getAttribute("aria-valuetext")).toContain("ago");
    await page.keyboard.press("End");
    await page.locator(".time-live.on").waitFor();
  });
  for (const dark of [false, true])
    it(`no serious finding of axe, and it fits (${dark ? "dark" : "light"})`, async () => {
      const { nodes } = await stage.call<{ nodes: { sinceUs: string }[] }>("Workflows/Get", {
        run: "BoothGuide-1",
      });
      const path = `/runs/BoothGuide-1?t=${new Date(Number(nodes[0]?.sinceUs) / 1000 + 1).toISOString()}`;
      page = await stage.page(path, { dark, kept: true });
      await page.locator(".state-chip").first().waitFor();
      await page.locator(".time-words .faint").waitFor();
      await stage.picture(page, `time-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
      page = await stage.page(path.replace("/runs/BoothGuide-1", "/hall"), {
        dark,
        width: 390,
        height: 780,
        kept: true,
      });
      await page.locator(".hall-robot").waitFor();
      await stage.picture(page, `time-small-${dark ? "dark" : "light"}`);
      await fitsTheWindow(page);
    });
  it("no page has thrown", () => stage.noFaults());
});
