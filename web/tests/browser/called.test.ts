// A workflow that runs another one as a step, on a real server: what the other one takes has a field, and a finding where nothing
// gives it. The visitor that the situation names is the one that is guided.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { draft, dragOnto, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { expo, RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);
const step = (name: string) => `.react-flow__node[data-id="${name}"]`;

describe.skipIf(why !== "")("a workflow that is a step", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 8 }, "booth_guide.rsel.xml", "booth_guide.cawl.xml");
    stage.processes.tell("expo:Mary a docent:Visitor");
    stage.processes.tell("expo:Mary docent:isAt expo:B09");
  });
  afterAll(() => stage?.close());
  const visitor = () => page.locator('.invoke-inputs input[aria-label="User"]');

  it("has a field for what the other one takes, given at the start where nothing starts it by itself", async () => {
    page = await stage.page("/compose", { kept: true });
    await page.waitForSelector(".template");
    await page.getByRole("button", { name: "New workflow" }).click();
    await page.locator("#new-name").fill("Service");
    await page.getByRole("button", { name: "Create" }).click();
    await dragOnto(page, page.locator(".palette-item", { hasText: /Booth guideversion/ }), "Begin → End");
    await dragOnto(page, page.locator(".palette-item", { hasText: /^Say/ }), "Booth guide → End");
    await page.click(step("Booth guide"));
    await visitor().waitFor();
    expect(await visitor().inputValue()).toBe("$user");
    await page.getByText("Given at the start of the run").waitFor();
    expect(await page.locator('.invoke-inputs input[aria-label="Booth"]').count()).toBe(0); // which it finds by itself
    await page.locator(step("Say")).click();
    await page.getByRole("combobox", { name: "Text to say" }).fill("Goodbye");
    await page.keyboard.press("Tab");
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
  });
  it("the situation that starts it finds the visitor", async () => {
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.getByRole("button", { name: "Start when something holds" }).click();
    await page.click(step("Booth guide"));
    await page.getByText("Found by the situation that starts the run").waitFor();
    expect(await visitor().inputValue()).toBe("$user");
  });
  it("by name and Enter it names one visitor, and then nothing gives the other one its visitor", async () => {
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    const slot = (label: string) => page.locator(`.constraint input[aria-label="${label}"]`);
    await slot("Subject").fill("John");
    await page.keyboard.press("Enter");
    await draft(page, "Service").toContain('<subject type="docent:Visitor">expo:John</subject>');
    await slot("Verb").click();
    await page.locator(".combo-item").nth(1).waitFor();
    expect((await page.locator(".combo-item .mono").allInnerTexts()).slice(0, 5)).toEqual([
      "a",
      "docent:isAt",
      "docent:isNear",
      "docent:selected",
      "docent:chose",
    ]);
    await stage.picture(page, "called-verbs");
    await slot("Verb").fill("comes");
    await page.locator(".combo-item", { hasText: "docent:isAt" }).click();
    await slot("Object").fill("B05");
    await page.keyboard.press("Enter");
    await draft(page, "Service").toContain("<object>expo:B05</object>");
    await page.locator(`${step("Booth guide")} .step-badge.wait`).waitFor();
    await page.locator(".findings-bar", { hasText: "1 to look at" }).waitFor();
    await page
      .locator(".property-findings", {
        hasText: "The value user is never set before: Booth guide then takes any Visitor.",
      })
      .waitFor();
    await stage.picture(page, "called-unset");
    await page.click(step("Booth guide"));
    expect(await visitor().inputValue()).toBe("");
    await page.getByText("Any that fits is taken").waitFor();
    await stage.picture(page, "called-unset-step");
    expect(await seriousFindings(page)).toEqual([]);
  });
  it("the remedy lets the run begin with the visitor who is named, and this one is guided", async () => {
    await page.locator(".property-findings").getByRole("button", { name: "Set user to John" }).click();
    await draft(page, "Service").toMatch(
      /<variable name="user" type="docent:Visitor">\s*<initialize>\s*<from expression="expo:John"\/>/,
    );
    await page.getByText("The run begins with John").waitFor();
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.getByRole("combobox", { name: "First value of user" }).waitFor();
    await stage.picture(page, "called-set");
    await page.getByRole("button", { name: "Deploy" }).first().click();
    await page.locator("dialog").getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "is deployed" }).waitFor();
    stage.processes.tell("expo:John docent:isAt expo:B05");
    const runs = () =>
      stage.call<{ runs: { id: string }[] }>("Workflows/ListRuns", {}).then((r) => r.runs ?? []);
    await stage.until(async () => (await runs()).some((r) => r.id.startsWith("BoothGuide")));
    const inner = await stage.call<unknown>("Workflows/Get", {
      run: (await runs()).find((r) => r.id.startsWith("BoothGuide"))?.id,
    });
    expect(JSON.stringify(inner)).toContain(`${expo}John`);
    expect(JSON.stringify(inner)).not.toContain(`${expo}Mary`);
  });
  it("a value of the step's own counts, too", async () => {
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.getByRole("combobox", { name: "First value of user" }).fill("");
    await page.keyboard.press("Tab");
    await page.locator(".findings-bar", { hasText: "1 to look at" }).waitFor();
    await page.click(step("Booth guide"));
    await visitor().fill("Mary");
    await page.keyboard.press("Enter");
    await draft(page, "Service").toContain('<ext:input part="user" expression="expo:Mary"/>');
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
  });
  it("no page has thrown", () => stage.noFaults());
});
