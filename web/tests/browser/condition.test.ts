// Conditions in the editor against a real server: the state of each row and of the whole, one match in words, the nearest miss
// with what lacks and what is there instead; simulated, then told.
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the condition editor", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open(null, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    for (const fact of ["rdf:type docent:Robot", "docent:status docent:Busy", "docent:localised true"])
      stage.processes.tell(`expo:R07 ${fact}`);
  });
  afterAll(() => stage?.close());
  const open = (options = {}) =>
    stage.page("/compose/BoothGuide?step=Move2User", { height: 1000, ...options });

  it("says of each row and the whole what is so now, and what lacks of the nearest", async () => {
    const page = await open();
    const row = (verb: string) =>
      page.locator(".constraint", { has: page.locator(`input[aria-label="Verb"][value="${verb}"]`) });
    await row("docent:localised").locator(".constraint-state.some").waitFor();
    expect(await row("docent:localised").locator(".constraint-state").innerText()).toBe(
      "1 match: R07 localised true",
    );
    expect(await row("docent:status").locator(".constraint-state").innerText()).toBe(
      "no match now: R07 status Busy",
    );
    expect(await row("docent:isAt").locator(".constraint-state").innerText()).toMatch(/^no match now/);
    const lacks = page.locator(".situation-lacks");
    await lacks.getByText("Nearest: ").waitFor();
    const words = await lacks.innerText();
    expect(words).toContain("robot = R07");
    expect(words).toContain("missing: R07 status Standby, now Busy");
    expect(words).toMatch(/missing: John is at/);
    expect(await page.locator(".dock-properties").evaluate((box) => box.scrollWidth - box.clientWidth)).toBe(
      0,
    );
    await stage.picture(page, "condition-lacks");
    // The visitor comes: one thing lacks less.
    stage.processes.tell("--reading", "expo:DoorSensor=tag-17");
    await row("docent:isAt").locator(".constraint-state.some").waitFor();
    expect(await row("docent:isAt").locator(".constraint-state").innerText()).toBe(
      "1 match: John is at Entrance",
    );
    await lacks.getByText(/missing: John/).waitFor({ state: "detached" });
    // What lacks is simulated, then told: the whole is true.
    await lacks.getByRole("button", { name: "Simulate or tell" }).click();
    expect(await page.locator('dialog input[aria-label="Subject"]').inputValue()).toBe("expo:R07");
    await page.locator("dialog").getByRole("button", { name: "Simulate" }).click();
    await page.getByText("If it were told:").waitFor();
    expect(await page.locator(".situation .tag.wait").count()).toBe(1);
    await stage.picture(page, "condition-simulated");
    await page.locator("dialog").getByRole("button", { name: "Tell it" }).click();
    await page.locator(".situation.holds .situation-witness").waitFor();
    const witness = await page.locator(".situation-witness").innerText();
    expect(witness).toMatch(/^1 match now: /);
    for (const one of ["robot = R07", "user = John", "userRegion = Entrance"]) expect(witness).toContain(one);
    await stage.picture(page, "condition-holds");
  });

  it("follows edits: another verb is asked at once", async () => {
    const page = await open();
    const object = page.locator('.constraint input[aria-label="Object"]').first();
    await object.waitFor();
    await object.fill("docent:Charging");
    await page.keyboard.press("Tab");
    await page.locator(".situation-lacks").getByText("status Charging").waitFor();
    await page.keyboard.press("Control+z");
    await page.locator(".situation.holds").waitFor();
  });

  for (const dark of [false, true])
    it(`no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
      const page = await open({ dark });
      await page.locator('.constraint input[aria-label="Object"]').first().fill("docent:Charging");
      await page.keyboard.press("Tab");
      await page.locator(".situation-lacks").waitFor();
      await stage.picture(page, `condition-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
    });

  it("no page has thrown", () => stage.noFaults());
});
