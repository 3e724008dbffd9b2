// The front desk, with a real server and robots: favourites that are added, asked for what they need, started by one touch,
// handed on by a link; what runs, fails and is settled.
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { fitsTheWindow, patienceMs, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("the front desk", () => {
  let stage: RealStage;
  beforeAll(async () => {
    stage = await RealStage.open(null, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    const docent = "https://w3id.org/docent#";
    await stage.processes.startAdapter(
      `${expo}R01`,
      ["moveToUser:user", "moveToBooth:booth", "displayBoothInfo:booth", "briefBoothInfo:booth"],
      "--take-ms",
      "300",
      "--fact",
      `isAt=${expo}B05`,
      "--fact",
      `status=${docent}Standby`,
    );
    stage.processes.tell("--reading", "expo:DoorSensor=tag-17");
  });
  afterAll(() => stage?.close());
  const open = (path: string, options = {}) => stage.page(path, options);
  const runs = async () =>
    (await stage.call<{ runs?: { id: string; workflow: string; state: string }[] }>("Workflows/ListRuns"))
      .runs ?? [];

  it("a favourite is added, asks for what it needs, and starts", async () => {
    const page = await open("/desk");
    await page.getByText("No favourites yet").waitFor();
    await page.keyboard.press("a");
    await page.keyboard.type("move to booth");
    await page.getByRole("option", { name: "Move to booth" }).waitFor(); // once the robot has joined
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Keep it" }).click();
    await page.locator(".desk-start").click();
    const start = page.locator("dialog").getByRole("button", { name: "Start" });
    await page.waitForFunction(() => document.activeElement?.getAttribute("aria-label") === "Booth"); // what is asked first
    expect(await start.isDisabled()).toBe(true);
    await page.locator('dialog input[aria-label="Booth"]').fill("B05");
    await stage.picture(page, "desk-asks");
    await page.keyboard.press("ArrowDown");
    await page.keyboard.press("Enter");
    await start.click();
    await page.locator(".toast.good", { hasText: "has begun" }).waitFor();
    await page.locator(".desk-runs li", { hasText: "done" }).waitFor();
    expect(await page.locator(".desk-runs li").count()).toBe(1);
    await page.getByRole("heading", { name: "Just finished" }).waitFor();
    await page.getByText("Nothing runs.").waitFor();
  });

  it("one with all its values starts by one touch, a double one starts it once, and its link shows it in another browser", async () => {
    const page = await open("/desk");
    await page.getByRole("button", { name: "Add", exact: true }).click();
    await page.keyboard.type("brief information");
    await page.keyboard.press("Enter");
    await page.getByLabel("Text on the button").fill("Tell about B05");
    await page.locator('dialog input[aria-label="Booth"]').fill("expo:B05");
    await page.keyboard.press("Tab");
    await page.getByRole("button", { name: "Keep it" }).click();
    const before = (await runs()).length;
    await page.locator(".desk-start", { hasText: "starts at once" }).dblclick();
    await page.locator(".toast.good", { hasText: "Tell about B05 has begun" }).waitFor();
    await page.locator(".desk-runs li", { hasText: "done" }).first().waitFor();
    expect(await runs()).toHaveLength(before + 1);
    await page.reload();
    await page.locator(".desk-start", { hasText: "Tell about B05" }).waitFor();
    await page.getByRole("button", { name: "Copy the link" }).click();
    await page.locator(".toast.good", { hasText: "The link is copied" }).waitFor();
    const link = await page.evaluate(() => navigator.clipboard.readText());
    expect(new URL(link).search).toBe(
      "?f=service%3AbriefInformation%3Btitle%3DTell+about+B05%3B%24booth%3Dexpo%3AB05",
    );
    const other = await open(new URL(link).pathname + new URL(link).search);
    await other.getByText("These favourites come by a link").waitFor();
    await stage.picture(other, "desk-linked");
    await other.getByRole("button", { name: "Keep them here" }).click();
    await other.waitForURL(/\/desk$/);
    await other.locator(".desk-start", { hasText: "Tell about B05" }).waitFor();
    await other.keyboard.press("1");
    await other.locator(".toast.good", { hasText: "has begun" }).waitFor();
    await other.getByRole("button", { name: "Open it" }).click();
    await other.waitForURL(/\/runs\/.+/);
  });

  it("a workflow starts with its values; what runs shows its state and is ended here", async () => {
    const page = await open("/desk?f=workflow:BoothGuide;title=Guide+John;$user=expo:John");
    await page.locator(".desk-start", { hasText: "starts at once" }).click();
    await page.locator(".desk-runs li", { hasText: "Move2User waits" }).waitFor();
    await stage.picture(page, "desk-running");
    await page
      .locator(".desk-runs li", { hasText: "Move2User waits" })
      .getByRole("button", { name: "Cancel" })
      .click();
    await page.getByRole("button", { name: "Cancel the run" }).click();
    await page.locator(".desk-runs li", { hasText: "cancelled" }).waitFor();
  });

  it("one whose workflow is gone says so, and a refused start says why", async () => {
    const page = await open("/desk?f=workflow:Gone&f=service:moveToBooth;$booth=no+value");
    await page.getByText("No workflow of this name is here now").waitFor();
    await page.locator(".desk-start", { hasText: "Move to booth" }).click();
    await page.locator(".toast.bad", { hasText: "no value" }).waitFor();
    expect(await page.locator(".desk-start").first().isDisabled()).toBe(true);
  });

  it("the server is killed and comes back: the desk goes on", async () => {
    const page = await open("/desk?f=service:briefInformation;$booth=expo:B05");
    await page.locator(".desk-start", { hasText: "starts at once" }).waitFor();
    await stage.processes.killServer();
    await page.locator(".stale").waitFor();
    await stage.processes.startServer();
    await page.locator(".stale").waitFor({ state: "detached" });
    await expect
      .poll(
        async () => (await stage.call<{ robots?: { state?: string }[] }>("Fleet/List")).robots?.[0]?.state,
        { timeout: patienceMs },
      )
      .toBe("standby");
    await page.locator(".desk-start").click();
    await page.locator(".toast.good", { hasText: "has begun" }).waitFor();
  });

  for (const dark of [false, true])
    it(`no serious finding of axe, and it fits (${dark ? "dark" : "light"})`, async () => {
      const page = await open(
        "/desk?f=workflow:BoothGuide&f=service:moveToBooth&f=service:briefInformation;title=Tell+about+B05;$booth=expo:B05&f=workflow:Gone",
        { dark },
      );
      await page.locator(".desk-start", { hasText: "starts at once" }).waitFor();
      await page.locator(".desk-runs li").first().waitFor();
      await page.getByRole("button", { name: "Change" }).click();
      await stage.picture(page, `desk-${dark ? "dark" : "light"}`);
      expect(await seriousFindings(page)).toEqual([]);
      const small = await open("/desk?f=workflow:BoothGuide&f=service:moveToBooth", {
        dark,
        width: 390,
        height: 780,
      });
      await small.locator(".desk-start").first().waitFor();
      await stage.picture(small, `desk-small-${dark ? "dark" : "light"}`);
      await fitsTheWindow(small);
    });

  it("no page has thrown", () => stage.noFaults());
});
