// What a step gives to the operation that it invokes, with a real server and robot: each step says its own sentence.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { draft, dragOnto, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);
const step = (name: string) => `.react-flow__node[data-id="${name}"]`;

describe.skipIf(why !== "")("inputs of a step", () => {
  let stage: RealStage;
  let page: Page;
  beforeAll(async () => {
    stage = await RealStage.open({ speed: 8 });
  });
  afterAll(() => stage?.close());

  it("a Say step has a field for its sentence, and the edit is one step of undo", async () => {
    page = await stage.page("/compose", { kept: true });
    await page.waitForSelector(".template");
    await page.getByRole("button", { name: "New workflow" }).click();
    await page.locator("#new-name").fill("Greeter");
    await page.getByRole("button", { name: "Create" }).click();
    await page.locator(".palette-item", { hasText: "takes text" }).first().waitFor();
    await dragOnto(page, page.locator(".palette-item", { hasText: /^Say/ }), "Begin → End");
    await page.click(step("Say"));
    await draft(page, "Greeter").toContain('<variable name="text" type="xsd:string"/>');
    await page.getByRole("combobox", { name: "Text to say" }).fill("Good morning, John");
    await page.keyboard.press("Tab");
    await draft(page, "Greeter").toContain(`<ext:input part="text" expression='"Good morning, John"'/>`);
    await page.locator('.head button[aria-label="Undo"]').click();
    await draft(page, "Greeter").not.toContain("ext:input");
    await page.locator('.head button[aria-label="Redo"]').click();
    await page.waitForFunction(
      () =>
        document.querySelector<HTMLInputElement>('input[aria-label="Text to say"]')?.value ===
        "Good morning, John",
    );
  });
  it("two steps say two things", async () => {
    await dragOnto(page, page.locator(".palette-item", { hasText: /^Say/ }), "Say → End");
    await page.click(step("Say2"));
    await page.getByRole("combobox", { name: "Text to say" }).fill("Goodbye");
    await page.keyboard.press("Tab");
    await page.locator(".findings-bar", { hasText: "Nothing to mend" }).waitFor();
    await stage.picture(page, "inputs-say");
    expect(await seriousFindings(page)).toEqual([]);
    await page.getByRole("button", { name: "Deploy" }).first().click();
    await page.locator("dialog").getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "is deployed" }).waitFor();
    await stage.call("Workflows/Start", { workflow: "Greeter" });
    await stage.until(
      async () =>
        (await stage.call<{ state: string }>("Workflows/Get", { run: "Greeter-1" })).state === "done",
    );
    const run = await stage.page("/runs/Greeter-1");
    await run.getByRole("tab", { name: "History" }).click();
    for (const words of ["Good morning, John", "Goodbye"])
      await run.locator(".timeline li", { hasText: `say(text="${words}")` }).waitFor(); // what the robot got
  });
  it("a step that drives is offered booths, and no walls", async () => {
    await dragOnto(page, page.locator(".palette-item", { hasText: /^Move to booth/ }), "Begin → Say");
    await page.click(step("Move to booth"));
    await page.locator('.properties input[aria-label="Booth"]').click();
    await page.locator(".combo-item", { hasText: "expo:B03" }).waitFor();
    expect(await page.locator(".combo-item", { hasText: /Wall|Counter/ }).count()).toBe(0);
    await stage.picture(page, "inputs-booth");
    await page.locator(".combo-item", { hasText: "expo:B03" }).click();
    await draft(page, "Greeter").toContain('<ext:input part="booth" expression="expo:B03"/>');
  });
  it("the situation that starts a workflow is asked, also where its activator has no name", async () => {
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.getByRole("button", { name: "Start when something holds" }).click();
    await draft(page, "Greeter").toContain('<activator name="OnStart">');
    await page.locator(".situation .tag", { hasText: "not now" }).waitFor();
    await page.locator(".situation").getByRole("button", { name: "Simulate or tell" }).waitFor();
    await stage.picture(page, "starts-by-itself");
    await page.evaluate(() => {
      const text = (JSON.parse(localStorage.getItem("docent.draft.Greeter") ?? "{}") as { text: string })
        .text;
      localStorage.setItem(
        "docent.draft.Nameless",
        JSON.stringify({
          text: text.replace(' name="OnStart"', "").replace('name="Greeter"', 'name="Nameless"'),
          base: "",
          savedMs: 1,
        }),
      );
    });
    await page.goto(page.url().replace(/\/compose\/.*/, "/compose/Nameless"));
    await page.locator(".situation .tag", { hasText: "not now" }).waitFor();
  });
  it("no page has thrown", () => stage.noFaults());
});
