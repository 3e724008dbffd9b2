// Composing in a real browser: by keys alone, by dragging, in the text; and what must not go wrong with it.
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { draft, draftNow, dragOnto, fitsTheWindow, seriousFindings } from "./pages";
import { guide, Stage, usualAnswers } from "./stage";

let stage: Stage;
beforeAll(async () => void (stage = await Stage.open()));
afterAll(() => stage.close());
afterEach(() => {
  stage.answers = usualAnswers();
  expect(stage.faults.splice(0)).toEqual([]);
});

async function newGreeter(): Promise<Page> {
  const page = await stage.page("/compose");
  await page.waitForSelector(".template");
  await page.keyboard.press("n");
  await page.keyboard.type("Greeter");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".first-steps");
  return page;
}
async function add(page: Page, words: string) {
  await page.keyboard.press("/");
  await page.keyboard.type(words);
  await page.keyboard.press("Enter");
  await page.locator(".picker").waitFor({ state: "detached" });
}
// The text is closed at first.
async function openText(page: Page) {
  await page.waitForSelector(".react-flow__node");
  if (!(await page.locator(".cm-content").isVisible())) await page.keyboard.press("t");
  await page.waitForSelector(".cm-content");
}
const step = (name: string) => `.react-flow__node[data-id="${name}"]`;

describe("without a mouse", () => {
  it("a workflow is made, connected, undone 200 times and done again", async () => {
    const page = await newGreeter();
    await draft(page, "Greeter").toContain("</CAWL>");
    const empty = await draftNow(page, "Greeter");
    await add(page, "move to us");
    await add(page, "brief");
    await page.keyboard.press("c");
    await page.keyboard.type("move");
    await page.keyboard.press("Enter");
    await stage.picture(page, "compose-by-keys");
    await draft(page, "Greeter").toMatch(/<link from="Brief information" to="Move to user" ext:while=/);
    const built = await draftNow(page, "Greeter");
    expect(built).toContain('<node name="Brief information">');
    expect(built).toContain('<variable name="user" type="docent:Visitor"/>');
    await page.waitForFunction(() => document.activeElement?.getAttribute("data-id") === "Brief information");
    await page.keyboard.press("Escape");
    for (let i = 0; i < 100; i++) await page.keyboard.press("Control+z");
    await draft(page, "Greeter").toBe(empty);
    for (let i = 0; i < 100; i++) await page.keyboard.press("Control+y");
    await draft(page, "Greeter").toBe(built);
    await page.keyboard.press("Control+Enter");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".toast.good");
    expect(stage.calls.find((c) => c.method === "Workflows/Deploy")?.request["cawl"]).toBe(built);
    await page.locator("a.crumb").first().click();
    await page.waitForSelector(".template");
    expect(await page.getByText("draft of").count()).toBe(0); // what is deployed is no draft
  });
  it("steps are moved by arrows, copied, pasted and removed", async () => {
    const page = await newGreeter();
    await add(page, "move to us");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    await draft(page, "Greeter").toMatch(/<node name="Move to user" view:x="\d+" view:y="\d+">/);
    await page.keyboard.press("Control+c");
    await page.keyboard.press("Control+v");
    await page.waitForSelector(step("Move to user 2"));
    await page.keyboard.press("Delete");
    await page.waitForSelector(step("Move to user 2"), { state: "detached" });
    await draft(page, "Greeter").not.toContain("Move to user 2");
    await draft(page, "Greeter").toContain('name="Move to user"');
  });
});

describe("canvas and text", () => {
  it("a step is dragged onto a link", async () => {
    const page = await newGreeter();
    await dragOnto(page, page.locator(".palette-item", { hasText: "Move to booth" }), "Begin → End");
    await page.waitForSelector(step("Move to booth"));
    await draft(page, "Greeter").toContain(
      '<link from="Begin" to="Move to booth"/>\n    <link from="Move to booth" to="End"/>',
    );
  });
  it("what is typed shows on the canvas, and comments stay", async () => {
    const page = await stage.page("/compose/BoothGuide");
    await page.waitForSelector(step("Move2Booth"));
    await page.click(step("Move2Booth"));
    await page.locator('.properties-head input[aria-label="Name"]').fill("Lead the way");
    await page.keyboard.press("Enter");
    await page.waitForSelector(step("Lead the way"));
    await draft(page, "BoothGuide").toBe(guide.replace(/(name|to|from)="Move2Booth"/g, '$1="Lead the way"'));
    await openText(page);
    await page.click(".cm-content");
    await page.keyboard.press("Control+End");
    await page.keyboard.type("<!-- the end -->");
    await draft(page, "BoothGuide").toContain("<!-- the end -->");
  });
  it("broken text keeps the last good canvas", async () => {
    const page = await stage.page("/compose/BoothGuide");
    await page.waitForSelector(step("InfoBooth"));
    await openText(page);
    await page.click(".cm-content");
    await page.keyboard.press("Control+Home");
    await page.keyboard.type("<");
    await page.waitForSelector(".broken");
    expect(await page.locator(".react-flow__node").count()).toBe(5);
    await page.locator(".finding, .findings-bar .bad").first().waitFor();
    await stage.picture(page, "compose-broken-text");
    await page.keyboard.press("Backspace");
    await page.waitForSelector(".broken", { state: "detached" });
  });
  it("completion offers what has an effect in a step, and no variable", async () => {
    const page = await stage.page("/compose/BoothGuide?step=InfoBooth");
    await openText(page);
    await page.locator(".cm-line", { hasText: '<node name="InfoBooth"' }).click();
    await page.keyboard.press("End");
    await page.keyboard.type("<");
    await page.locator(".cm-tooltip-autocomplete li", { hasText: "invoke" }).waitFor();
    expect(await page.locator(".cm-tooltip-autocomplete li", { hasText: "ext:assign" }).count()).toBe(1);
    expect(await page.locator(".cm-tooltip-autocomplete li", { hasText: "variable" }).count()).toBe(0);
  });
  it("a misspelt verb is mended by the offered remedy", async () => {
    const page = await stage.page("/compose/BoothGuide");
    await page.click(step("InfoBooth"));
    await page.locator('input[aria-label="Verb"]').first().fill("docent:isAtt");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".step-badge.wait");
    await stage.picture(page, "compose-finding");
    await page.locator(".property-findings .button", { hasText: "Mend it" }).click();
    await page.waitForSelector(".step-badge", { state: "detached" });
    await draft(page, "BoothGuide").not.toContain("isAtt");
  });
  it("the address restores what was selected, and the text shows it", async () => {
    const page = await stage.page("/compose/BoothGuide?step=Move2Booth");
    const seen = (name: string) =>
      page.waitForFunction((text) => {
        const box = document.querySelector(".cm-scroller")?.getBoundingClientRect();
        const line = [...document.querySelectorAll(".cm-line")]
          .find((l) => l.textContent?.includes(text))
          ?.getBoundingClientRect();
        return box && line && line.top >= box.top && line.bottom <= box.bottom;
      }, `<node name="${name}"`);
    await page.waitForSelector(`${step("Move2Booth")} .step.selected`);
    expect(await page.locator(".cm-content").isVisible()).toBe(false); // closed at first
    await openText(page);
    await seen("Move2Booth");
    await page.click(step("Move2User"));
    await page.waitForFunction(() => location.search === "?step=Move2User");
    await seen("Move2User");
    await page.reload();
    await page.waitForSelector(`${step("Move2User")} .step.selected`);
    await seen("Move2User");
  });
});

describe("what is not usual", () => {
  it("without a server, the palette says why and composing goes on", async () => {
    stage.answers = null;
    const page = await stage.page("/compose");
    await page.waitForSelector(".stale");
    await page.waitForSelector(".template");
    await page.keyboard.press("n");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".palette .notice");
    expect(await page.locator(".palette .notice").innerText()).toContain("goes on by itself");
    await add(page, "Wave");
    await page.waitForSelector(step("Wave"));
    await stage.picture(page, "compose-without-server");
    stage.answers = usualAnswers();
    await page.waitForSelector(".stale", { state: "detached" });
  });
  it("markup in names and literals stays text", async () => {
    const page = await newGreeter();
    await add(page, "<img src=x onerror=document.title=1>");
    await page.waitForSelector(".step header");
    expect(await page.locator(".step header").first().innerText()).toContain("<img src=x");
    expect(await page.locator(".canvas img").count()).toBe(0);
    await draft(page, "Greeter").toContain('name="&lt;img src=x onerror=document.title=1>"');
  });
  it("two tabs on one document: what each does comes to the other, and undo takes back one's own alone", async () => {
    const page = await newGreeter();
    await add(page, "Wave");
    await page.waitForSelector(step("Wave"));
    const other = await page.context().newPage();
    await other.goto(page.url());
    await other.waitForSelector(step("Wave"));
    await other.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await other.locator('input[aria-label="Name of a new value"]').fill("guest");
    await other.keyboard.press("Enter");
    await draft(page, "Greeter").toContain('name="guest"');
    await page.locator(".toast", { hasText: "Another tab" }).waitFor();
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.locator('input[aria-label="Kind of guest"]').waitFor();
    await add(page, "Bow");
    await other.waitForSelector(step("Bow"));
    await stage.picture(other, "two-tabs");
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.keyboard.press("Control+z");
    await other.locator(step("Bow")).waitFor({ state: "detached" });
    expect(await page.locator('input[aria-label="Kind of guest"]').count()).toBe(1);
    expect(await other.locator(".stale").count()).toBe(0);
  });
  it("a text of 2,000 steps is open, and a key is answered at once", async () => {
    const page = await stage.page("/compose");
    const nodes = Array.from(
      { length: 2000 },
      (_, i) => `    <node name="n${i}"><invoke operation="say"/></node>`,
    ).join("\n");
    const links = Array.from({ length: 1999 }, (_, i) => `    <link from="n${i}" to="n${i + 1}"/>`).join(
      "\n",
    );
    await page.evaluate(
      (text) => localStorage.setItem("docent.draft.Big", JSON.stringify({ text, base: "", savedMs: 1 })),
      `<CAWL name="Big">\n  <flow name="F">\n    <source name="s"/>\n${nodes}\n    <sink name="t"/>\n    <link from="s" to="n0"/>\n${links}\n    <link from="n1999" to="t"/>\n  </flow>\n</CAWL>`,
    );
    await page.goto(`${stage.url}/compose/Big`);
    await page.waitForSelector(".react-flow__node");
    await page.keyboard.press("/");
    await page.waitForSelector(".picker");
  });
});

describe("for everybody", () => {
  for (const dark of [false, true])
    for (const [name, path, wait] of [
      ["workflows", "/compose", ".template"],
      ["compose", "/compose/BoothGuide?step=Move2Booth", ".constraint"],
    ] as const)
      it(`${name} has no serious finding of axe (${dark ? "dark" : "light"})`, async () => {
        const page = await stage.page(path, { dark });
        await page.waitForSelector(wait);
        await stage.picture(page, `${name}-${dark ? "dark" : "light"}`);
        expect(await seriousFindings(page)).toEqual([]);
      });
  it("fits a small window", async () => {
    const page = await stage.page("/compose/BoothGuide", { width: 390, height: 780 });
    await page.waitForSelector(step("InfoBooth"));
    await stage.picture(page, "compose-small");
    expect(await page.getByRole("button", { name: "Run", exact: true }).isVisible()).toBe(true);
    await page.getByRole("tab", { name: "Text" }).click();
    await page.waitForSelector(".cm-content");
    await fitsTheWindow(page);
  });
});

it("a start by hand says what it needs and what it finds, and waits for what is missing", async () => {
  const page = await stage.page("/compose/BoothGuide");
  await page.getByRole("button", { name: "Run", exact: true }).click();
  await page.getByText("It needs user. Booth is found by its conditions, where nothing is given.").waitFor();
  const start = page.locator("dialog").getByRole("button", { name: "Start" });
  expect([await start.isDisabled(), await start.getAttribute("title")]).toEqual([true, "User is missing"]);
  await stage.picture(page, "start-dialog");
  await page.locator('dialog input[aria-label="user"]').fill("<https://w3id.org/docent/expo#John>");
  await page.keyboard.press("Tab");
  expect(await start.isEnabled()).toBe(true);
});

describe("a browser that keeps nothing", () => {
  const closed =
    'Object.defineProperty(window, "localStorage", { get() { throw new DOMException("Access is denied for this document.", "SecurityError"); } }); Object.defineProperty(window, "sessionStorage", { get() { throw new DOMException("Access is denied for this document.", "SecurityError"); } });';
  const full =
    'Storage.prototype.setItem = function () { throw new DOMException("full", "QuotaExceededError"); };';
  it("shows all views; composing says that drafts are not kept, and a new workflow is there as long as the page", async () => {
    const page = await stage.page("/hall", { script: closed });
    for (const [path, words] of [
      ["/hall", "Robots"],
      ["/runs", "Runs"],
      ["/board", "Waiting"],
      ["/desk", "Front desk"],
      ["/visit", "Docent"],
    ] as const) {
      await page.goto(stage.url + path);
      await page.getByText(words).first().waitFor();
    }
    await page.goto(`${stage.url}/compose`);
    await page.getByText("drafts are not kept").waitFor();
    await page.keyboard.press("n");
    await page.keyboard.type("Greeter");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".first-steps");
    await add(page, "move to us");
    await page.locator(".stale", { hasText: "This browser keeps nothing: drafts are not kept." }).waitFor();
    await stage.picture(page, "compose-keeps-nothing");
    await page.locator("a.crumb").first().click();
    await page.locator(".document", { hasText: "Greeter" }).click();
    await page.waitForSelector(step("Move to user"));
    await page.keyboard.press("Shift+T");
  });
  it("asks before the page is left", async () => {
    const page = await stage.page("/compose/BoothGuide", { script: full });
    await page.locator(step("InfoBooth")).click();
    await page.keyboard.press("Delete");
    await page.locator(".stale", { hasText: "The browser’s storage is full" }).waitFor();
    const asked = new Promise<string>((resolve) =>
      page.on("dialog", (dialog) => (resolve(dialog.type()), void dialog.dismiss())),
    );
    void page.close({ runBeforeUnload: true });
    expect(await asked).toBe("beforeunload");
    await page.locator(".stale", { hasText: "The browser’s storage is full" }).waitFor();
  });
});
