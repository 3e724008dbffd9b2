// What is typed and pressed in compose gets where it is meant: fields that are left by Back, by a reload or by a button, keys after a
// click beside the steps; and what is seen of it in small windows, in forced colours and of a text with a mistake.
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, it } from "vitest";
import { draft, patienceMs, settled, still } from "./pages";
import { Stage, usualAnswers } from "./stage";

let stage: Stage;
beforeAll(async () => void (stage = await Stage.open()));
afterAll(() => stage.close());
afterEach(() => {
  stage.answers = usualAnswers();
  expect(stage.faults.splice(0)).toEqual([]);
});
const step = (name: string) => `.react-flow__node[data-id="${name}"]`;
const open = async (path: string, options = {}): Promise<Page> => {
  const page = await stage.page(path, options);
  await page.waitForSelector(step("InfoBooth"));
  return page;
};

it("a text with a mistake leaves the cards as they are", async () => {
  const page = await open("/compose/BoothGuide");
  const looks = () =>
    page
      .locator(".step.node")
      .evaluateAll((cards) =>
        cards.map((card) =>
          [
            getComputedStyle(card).display,
            Math.round(
              card.getBoundingClientRect().width / (card.parentElement?.getBoundingClientRect().width ?? 1),
            ),
          ].join(" "),
        ),
      );
  const before = await looks();
  await page.keyboard.press("t");
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+Home");
  await page.keyboard.type("<<");
  await page.locator(".step.unmended").first().waitFor();
  await settled(page);
  await stage.picture(page, "text-broken");
  expect(await looks()).toEqual(before);
  await page.locator(".findings-bar", { hasText: "to mend" }).waitFor();
});

it("a click beside the steps gives the canvas the keys", async () => {
  const page = await open("/compose/BoothGuide");
  await page.click(step("InfoBooth"));
  await page.keyboard.press("Control+c");
  await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
  await page.keyboard.press("Control+v");
  await page.waitForSelector(step("InfoBooth2"));
  await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
  await page.keyboard.press("Control+a");
  await page.waitForFunction(() => document.querySelectorAll(".react-flow__node.selected").length === 6);
  expect(await page.evaluate(() => String(document.getSelection()))).toBe("");
});

it("what is typed counts when Back leaves the view, and the view before is shown", async () => {
  const page = await stage.page("/runs");
  await page.getByRole("link", { name: "Compose", exact: true }).click();
  await page.locator(".document", { hasText: "BoothGuide" }).click();
  await page.locator(step("InfoBooth")).click();
  await page.locator('.properties-head input[aria-label="Name"]').fill("Show the booth");
  await page.goBack();
  await page.waitForURL(/\/compose$/);
  await page.waitForSelector(".template");
  await draft(page, "BoothGuide").toContain('<node name="Show the booth"');
  await page.goForward();
  await page.locator(step("Show the booth")).click();
  await page.locator('.constraint input[aria-label="Object"]').first().fill("expo:B07");
  await page.reload();
  await draft(page, "BoothGuide").toContain("<object>expo:B07</object>");
});

it("a run can be started with what is still being typed", async () => {
  stage.answers = { ...usualAnswers(), "Workflows/Start": () => ({ run: "BoothGuide-7" }) };
  const page = await open("/compose/BoothGuide");
  await page.getByRole("button", { name: "Run", exact: true }).click();
  const start = page.locator("dialog").getByRole("button", { name: "Start" });
  expect(await start.isDisabled()).toBe(true);
  await page.locator('dialog input[aria-label="user"]').pressSequentially("expo:John");
  expect(await start.isEnabled()).toBe(true);
  await page.locator('dialog input[aria-label="user"]').fill("<https://w3id.org/docent/expo#John>");
  await start.click();
  await page.waitForURL(/\/runs\/BoothGuide-7/);
  expect(JSON.stringify(stage.calls.findLast((c) => c.method === "Workflows/Start")?.request)).toContain(
    "https://w3id.org/docent/expo#John",
  );
});

it("a selected step has an outline in forced colours", async () => {
  const page = await open("/compose/BoothGuide");
  await page.emulateMedia({ forcedColors: "active" });
  await page.click(step("InfoBooth"));
  await page.locator(".step.selected").waitFor();
  await stage.picture(page, "forced-selected");
  expect(await page.locator(".step.selected").evaluate((card) => getComputedStyle(card).outlineStyle)).toBe(
    "solid",
  );
  expect(
    await page.locator(`${step("Move2User")} .step`).evaluate((card) => getComputedStyle(card).outlineStyle),
  ).toBe("none");
});

it("the step of the address is in view in a low window", async () => {
  const page = await open("/compose/BoothGuide?step=InfoBooth", { width: 720, height: 450 });
  await expect
    .poll(
      async () => {
        const [card, canvas] = [
          await page.locator(step("InfoBooth")).boundingBox(),
          await page.locator(".canvas").boundingBox(),
        ];
        return card && canvas
          ? card.y >= canvas.y && card.y + card.height <= canvas.y + canvas.height
          : false;
      },
      { timeout: patienceMs },
    )
    .toBe(true);
  await stage.picture(page, "step-low-window");
});

it("a window of 320 pixels has all buttons of the head, and messages leave those of the canvas free", async () => {
  const page = await open("/compose/BoothGuide", { width: 320, height: 700 });
  await page.click(step("InfoBooth"));
  await page.keyboard.press("Control+c");
  const toast = page.locator(".toast.good");
  await toast.waitFor();
  await still(toast);
  await stage.picture(page, "compose-320");
  const deploy = (await page.getByRole("button", { name: "Deploy" }).boundingBox())!;
  expect(320 - deploy.x - deploy.width).toBeGreaterThanOrEqual(8);
  const [message, controls] = [
    (await toast.boundingBox())!,
    (await page.locator(".react-flow__controls").boundingBox())!,
  ];
  expect(
    message.x + message.width <= controls.x ||
      message.y >= controls.y + controls.height ||
      message.y + message.height <= controls.y,
  ).toBe(true);
});

it("a draft that was never deployed asks for no versions, and its headings follow each other", async () => {
  const page = await stage.page("/compose");
  await page.waitForSelector(".template");
  await page.keyboard.press("n");
  await page.keyboard.type("Greeter");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".first-steps");
  const from = stage.calls.length;
  await page.keyboard.press("/");
  await page.keyboard.type("Bow");
  await page.keyboard.press("Enter");
  await page.waitForSelector(step("Bow"));
  await expect
    .poll(() => stage.calls.slice(from).filter((c) => c.method === "Workflows/List").length, {
      timeout: patienceMs,
    })
    .toBeGreaterThan(3);
  expect(
    stage.calls.filter((c) => c.method === "Workflows/ListVersions" && c.request["workflow"] === "Greeter"),
  ).toEqual([]);
  const levels = await page.evaluate(() =>
    [...document.querySelectorAll("h1, h2, h3, h4")].map((h) => Number(h.tagName[1])),
  );
  expect(levels.filter((level, i) => level > (levels[i - 1] ?? 0) + 1)).toEqual([]);
});
