// The canvas by mouse: links that are drawn from a step's dot, and what stays when a view stops.
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, it } from "vitest";
import { draft, still } from "./pages";
import { Stage, usualAnswers } from "./stage";

let stage: Stage;
beforeAll(async () => void (stage = await Stage.open()));
afterAll(() => stage.close());
afterEach(() => void (stage.answers = usualAnswers()));

const step = (name: string) => `.react-flow__node[data-id="${name}"]`;
async function dragFromDot(page: Page, name: string, x: number, y: number) {
  const dot = page.locator(`${step(name)} .react-flow__handle.source`);
  await still(dot);
  const box = (await dot.boundingBox())!;
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(x, y, { steps: 8 });
  await page.mouse.up();
}

it("a step is added by dragging from the dot of the beginning, and a link is drawn from it", async () => {
  const page = await stage.page("/compose/BoothGuide");
  await page.waitForSelector(step("InfoBooth"));
  const free = (await page.locator(".canvas").boundingBox())!;
  await dragFromDot(page, "Arrived", free.x + 60, free.y + free.height - 90);
  await page.locator(".picker").waitFor();
  await page.keyboard.type("Wave");
  await page.keyboard.press("Enter");
  await page.waitForSelector(step("Wave"));
  const target = page.locator(`${step("InfoBooth")} .react-flow__handle.target`);
  await still(target);
  const box = (await target.boundingBox())!;
  await dragFromDot(page, "Arrived", box.x + box.width / 2, box.y + box.height / 2);
  await draft(page, "BoothGuide").toContain('<link from="Arrived" to="InfoBooth"/>');
  expect(await page.getByText("This view has stopped").count()).toBe(0);
  expect(stage.faults.splice(0)).toEqual([]);
});

it("a view that stops is opened again with its undo", async () => {
  const page = await stage.page("/compose");
  await page.waitForSelector(".template");
  await page.keyboard.press("n");
  await page.keyboard.type("Greeter");
  await page.keyboard.press("Enter");
  await page.getByRole("button", { name: "Add a step" }).click();
  await page.keyboard.type("Wave");
  await page.keyboard.press("Enter");
  await page.waitForSelector(step("Wave"));
  // The browser fails as soon as the name of the document changes.
  await page.evaluate(() =>
    Object.defineProperty(document, "title", {
      configurable: true,
      set: () => {
        throw new Error("a broken part");
      },
    }),
  );
  if (!(await page.locator(".cm-content").isVisible())) await page.keyboard.press("t");
  await page.locator(".cm-line", { hasText: '<CAWL name="Greeter"' }).click();
  await page.keyboard.press("Home");
  for (let i = 0; i < '<CAWL name="'.length; i++) await page.keyboard.press("ArrowRight");
  await page.keyboard.type("X");
  await page.getByText("This view has stopped").waitFor();
  await stage.picture(page, "view-stopped");
  await page.evaluate(() => Reflect.deleteProperty(document, "title"));
  await page.getByRole("button", { name: "Open the view again" }).click();
  await page.waitForSelector(step("Wave"));
  await page.locator('.head button[aria-label="Undo"]').click();
  await draft(page, "Greeter").toContain('<CAWL name="Greeter"');
  await page.locator('.head button[aria-label="Undo"]').click();
  await page.locator(step("Wave")).waitFor({ state: "detached" });
  stage.faults.splice(0);
});

it("keys for steps act where the focus is on the canvas or nowhere, and no text is selected", async () => {
  const page = await stage.page("/compose/BoothGuide");
  const steps = () => page.locator(".react-flow__node").count();
  await page.locator(step("InfoBooth")).click();
  const all = await steps();
  await page.locator('.dock-properties button[aria-label="Remove this row"]').first().focus();
  for (const key of ["Delete", "Backspace", "Control+x"]) await page.keyboard.press(key);
  await page.locator(".head").getByRole("button", { name: "Deploy" }).focus();
  await page.keyboard.press("Delete");
  expect(await steps()).toBe(all);
  // Selected text is copied, and not the step.
  await page.evaluate(() => navigator.clipboard.writeText("before"));
  const label = page.locator(".dock-properties .property > span").first();
  await label.click({ clickCount: 3 });
  await page.evaluate(() => (document.activeElement as HTMLElement | null)?.blur());
  const selected = await page.evaluate(() => getSelection()?.toString().trim() ?? "");
  expect(selected).not.toBe("");
  for (const key of ["Control+c", "Control+x", "Delete", "Control+v"]) await page.keyboard.press(key);
  expect(await steps()).toBe(all);
  expect((await page.evaluate(() => navigator.clipboard.readText())).trim()).toBe(selected);
  await page.locator(step("InfoBooth")).click();
  await page.keyboard.press("Control+x");
  await page.locator(step("InfoBooth")).waitFor({ state: "detached" });
  expect(await page.evaluate(() => navigator.clipboard.readText())).toContain('<node name="InfoBooth"');
  await page.keyboard.press("Control+v");
  await page.waitForSelector(step("InfoBooth"));
  expect(stage.faults.splice(0)).toEqual([]);
});

it("a step that undo took away is no longer selected, also when it comes back", async () => {
  const page = await stage.page("/compose/BoothGuide");
  await page.waitForSelector(step("InfoBooth"));
  await page.keyboard.press("/");
  await page.keyboard.type("Wave");
  await page.keyboard.press("Enter");
  await page.waitForSelector(`${step("Wave")}.selected`);
  await page.keyboard.press("Control+z");
  await page.locator(step("Wave")).waitFor({ state: "detached" });
  await page.keyboard.press("Control+y");
  await page.waitForSelector(step("Wave"));
  expect(await page.locator(`${step("Wave")}.selected`).count()).toBe(0);
  expect(stage.faults.splice(0)).toEqual([]);
});

it("a refused name does not stay in its field; the keys are listed also where no step has a use for them", async () => {
  const page = await stage.page("/compose/BoothGuide");
  await page.locator(step("InfoBooth")).click();
  const name = page.locator('.properties-head input[aria-label="Name"]');
  await name.fill("Move2User");
  await page.keyboard.press("Enter");
  await page.locator(".toast.bad", { hasText: "There is a step Move2User already" }).waitFor();
  await expect.poll(() => name.inputValue()).toBe("InfoBooth");
  await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
  await page.keyboard.press("?");
  const keys = page.locator(".keys-list");
  for (const words of [
    "Open the flow that the step runs",
    "Back to the flow that it was opened from",
    "Set or remove a breakpoint",
  ])
    await keys.getByText(words).waitFor();
  expect(stage.faults.splice(0)).toEqual([]);
});
