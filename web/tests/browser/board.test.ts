// The board against a real server: runs that wait are grouped by what lacks; what is told there moves them on.
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { fitsTheWindow, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the board", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open(null, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    for (const fact of ["rdf:type docent:Robot", "docent:status docent:Busy", "docent:localised true"])
      stage.processes.tell(`expo:R07 ${fact}`);
    for (const visitor of ["John", "Guest1", "Guest2"])
      for (const fact of [
        "rdf:type docent:Visitor",
        "docent:isAt expo:Entrance",
        "docent:chose expo:BoothGuideService",
      ])
        stage.processes.tell(`expo:${visitor} ${fact}`);
  });
  afterAll(() => stage?.close());

  it("has a row for what several runs lack; what is told there moves them on, and a pause stands there", async () => {
    const page = await stage.page("/board");
    const lacks = page.locator(".board-group", { hasText: "status Standby" });
    await lacks.locator("li").nth(2).waitFor();
    expect(await lacks.locator(".board-count").innerText()).toBe("3");
    await stage.picture(page, "board");
    const { runs } = await stage.call<{ runs: { id: string }[] }>("Workflows/ListRuns", { liveOnly: true });
    await stage.call("Workflows/Pause", { run: runs[0]?.id, reason: "lunch" });
    const paused = page.locator(".board-group", { hasText: "lunch" });
    await paused.waitFor();
    await paused.locator("li").hover();
    await paused.getByRole("button", { name: "Go on" }).click();
    await paused.waitFor({ state: "detached" });
    await lacks.getByRole("button", { name: "Simulate or tell" }).click();
    const dialog = page.locator("dialog");
    await dialog.locator('input[aria-label="Subject"]').fill("expo:R07");
    await page.keyboard.press("Tab");
    await dialog.getByRole("button", { name: "Simulate" }).click();
    await dialog
      .getByText(/Move2User: waiting → running/)
      .first()
      .waitFor();
    await stage.picture(page, "board-simulated");
    await dialog.getByRole("button", { name: "Tell it" }).click();
    await page.locator(".board-group", { hasText: "A robot is needed" }).first().waitFor();
    await stage.picture(page, "board-told");
    for (const { id } of runs) {
      const row = page.locator("li", { has: page.getByRole("link", { name: id, exact: true }) }).first();
      await row.hover();
      await row.getByRole("button", { name: "Cancel" }).click();
      await dialog.getByRole("button", { name: "Cancel the run" }).click();
      await row.waitFor({ state: "detached" });
    }
    await page.getByText("Nothing waits").waitFor();
  });

  for (const dark of [false, true])
    it(`no serious finding of axe, and it fits (${dark ? "dark" : "light"})`, async () => {
      await stage.call("Workflows/Start", {
        workflow: "BoothGuide",
        variables: [{ name: "user", value: { iri: "https://w3id.org/docent/expo#John" } }],
      });
      const page = await stage.page("/board", { dark });
      await page.locator(".board-group").first().waitFor();
      expect(await seriousFindings(page)).toEqual([]);
      const small = await stage.page("/board", { dark, width: 390, height: 780 });
      await small.locator(".board-group").first().waitFor();
      await fitsTheWindow(small);
    });

  it("no page has thrown", () => stage.noFaults());
});
