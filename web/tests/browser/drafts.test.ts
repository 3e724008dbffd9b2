// Drafts on the server: saved in one browser, gone on with in another; two at the same time; gone when it is deployed.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { sparqlString } from "../../src/api/sparql";
import { draftIri, writeUpdate } from "../../src/compose/server_drafts";
import { draft, draftNow, patienceMs, seriousFindings } from "./pages";
import { lacking } from "./processes";
import { RealStage } from "./real_stage";

const why = lacking();
if (why) console.log(`skipped: ${why}`);

describe.skipIf(why !== "")("drafts on the server", () => {
  let stage: RealStage;
  beforeAll(async () => void (stage = await RealStage.open(null)));
  afterAll(() => stage?.close());
  const onServer = async (name: string) => {
    const answer = await fetch(`${stage.processes.url}/sparql`, {
      method: "POST",
      headers: { Accept: "application/sparql-results+json" },
      body: new URLSearchParams({
        query: `SELECT ?text { GRAPH <urn:docent:drafts> { <${draftIri(name)}> <https://w3id.org/docent#draftText> ?text } }`,
      }),
    });
    return (
      (await answer.json()) as { results: { bindings: { text: { value: string } }[] } }
    ).results.bindings.map((b) => b.text.value);
  };
  const save = async (page: Page) => {
    await page.keyboard.press("Control+Shift+S");
    await page.locator(".toast", { hasText: "draft" }).last().waitFor();
  };
  const add = async (page: Page, step: string) => {
    await page.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await page.keyboard.press("/");
    await page.keyboard.type(step);
    await page.keyboard.press("Enter");
    await page.locator(`.react-flow__node[data-id="${step}"]`).waitFor();
  };

  it("is saved in one browser and gone on with in another, which the first one hears of", async () => {
    const one = await stage.page("/compose");
    await one.waitForSelector(".template");
    await one.keyboard.press("n");
    await one.keyboard.type('Greeter\'s "round"');
    await one.keyboard.press("Enter");
    await one.waitForSelector(".first-steps");
    const name = 'Greeter\'s "round"';
    await add(one, "Wave");
    await draft(one, name).toContain('name="Wave"');
    await save(one);
    expect(await onServer(name)).toEqual([await draftNow(one, name)]);
    await stage.picture(one, "drafts-saved");
    const two = await stage.page("/compose");
    const row = two.locator(".document", { hasText: "on the server" });
    await row.waitFor();
    await stage.picture(two, "drafts-list");
    await row.click();
    await two.locator('.react-flow__node[data-id="Wave"]').waitFor();
    await add(two, "Bow");
    await save(two);
    await one.locator(".stale", { hasText: "Another browser has saved a draft" }).waitFor();
    await one.getByRole("button", { name: "Take its text" }).click();
    await one.locator('.react-flow__node[data-id="Bow"]').waitFor();
    await one.locator(".stale").waitFor({ state: "detached" });
    // Both go on at different places: what both did is put together.
    await add(one, "Hum");
    await two.locator(".react-flow__pane").click({ position: { x: 20, y: 20 } });
    await two.locator('input[aria-label="Name of a new value"]').fill("guest");
    await two.keyboard.press("Enter");
    await draft(two, name).toContain('name="guest"');
    await save(two);
    await one.getByRole("button", { name: "Put both together" }).click();
    await one.locator(".stale").waitFor({ state: "detached" });
    await draft(one, name).toContain('name="guest"');
    expect(await draftNow(one, name)).toContain('name="Hum"');
    await save(one);
    await two.getByRole("button", { name: "Take its text" }).click();
    await two.locator('.react-flow__node[data-id="Hum"]').waitFor();
    // Both go on at one place; who saves second is asked, and nothing is lost.
    await add(one, "Sing");
    await add(two, "Dance");
    await save(two);
    await one.locator(".stale", { hasText: "Another browser" }).waitFor();
    await one.keyboard.press("Control+Shift+S");
    await one.locator(".toast.bad", { hasText: "Somebody else has saved a draft" }).waitFor();
    expect((await onServer(name))[0]).toContain('name="Dance"');
    await stage.picture(one, "drafts-conflict");
    expect(await seriousFindings(one)).toEqual([]);
    await one.getByRole("button", { name: "Keep mine" }).click();
    await one.keyboard.press("Control+Shift+S");
    await expect
      .poll(async () => (await onServer(name))[0], { timeout: patienceMs })
      .toContain('name="Sing"');
    await two.locator(".stale", { hasText: "Another browser" }).waitFor();
    expect(await draftNow(two, name)).toContain('name="Dance"');
  });

  it("is gone when it is deployed", async () => {
    const page = await stage.page("/compose/Parting");
    await page.locator(".template").first().click();
    await page.waitForSelector(".first-steps");
    await save(page);
    expect(await onServer("Parting")).toHaveLength(1);
    await page.keyboard.press("Control+Enter");
    await page.locator("dialog").getByRole("button", { name: "Deploy" }).click();
    await page.locator(".toast.good", { hasText: "Parting is deployed" }).waitFor();
    await expect.poll(() => onServer("Parting"), { timeout: patienceMs }).toEqual([]);
  });

  const round = (version: string, first: string, last: string) => `<CAWL name="Round" version="${version}">
  <flow name="Round">
    <source name="Begin"/>
    <node name="Wave"><documentation>${first}</documentation></node>
    <node name="Hum"/>
    <node name="Bow"><documentation>${last}</documentation></node>
    <sink name="End"/>
    <link from="Begin" to="Wave"/>
    <link from="Wave" to="Hum"/>
    <link from="Hum" to="Bow"/>
    <link from="Bow" to="End"/>
  </flow>
</CAWL>
`;
  const deploy = (text: string) => stage.call("Workflows/Deploy", { name: "round.cawl.xml", cawl: text });
  const describeStep = async (page: Page, step: string, words: string) => {
    await page.locator(`.react-flow__node[data-id="${step}"]`).click();
    await page.locator('.dock-properties [aria-label="Description"]').fill(words);
    await page.keyboard.press("Tab");
    await draft(page, "Round").toContain(words);
  };

  it("a version that is deployed meanwhile is followed, or said, put together with the draft, and taken back on purpose alone", async () => {
    await deploy(round("1.0", "one", "two"));
    const page = await stage.page("/compose/Round");
    await page.locator('.react-flow__node[data-id="Wave"]').waitFor();
    await deploy(round("1.1", "one", "by hand").replace("Hum", "Sing").replaceAll('"Hum"', '"Sing"'));
    await page.locator(".toast.good", { hasText: "Version 1.1 is here" }).waitFor();
    await page.locator('.react-flow__node[data-id="Sing"]').waitFor();
    expect(await draftNow(page, "Round")).toBe("");
    // With changes of its own, and loaded again: the draft knows what it began from.
    await deploy(round("1.0", "one", "two"));
    await page.locator('.react-flow__node[data-id="Hum"]').waitFor();
    await describeStep(page, "Bow", "mine");
    await deploy(round("1.2", "theirs", "two"));
    await page
      .locator(".stale", {
        hasText:
          /Version 1\.2 was deployed at \d\d:\d\d after you began\. Deploying this text takes it back\./,
      })
      .waitFor();
    await page.reload();
    await page.locator(".stale", { hasText: "Version 1.2 was deployed" }).waitFor();
    await stage.picture(page, "drafts-behind");
    await page.getByRole("button", { name: "Deploy" }).first().click();
    const dialog = page.locator("dialog");
    await dialog.locator(".deploy-behind", { hasText: "Deploying takes it back." }).waitFor();
    expect(await dialog.locator(".deploy-diff .gone").allInnerTexts()).toContainEqual(
      expect.stringContaining("theirs"),
    );
    expect(await dialog.locator('input[aria-label="Version"]').inputValue()).toBe("1.3");
    expect(await dialog.locator(".sheet-foot .primary").isDisabled()).toBe(true);
    await stage.picture(page, "drafts-behind-deploy");
    expect(await seriousFindings(page)).toEqual([]);
    await dialog.getByRole("button", { name: "Put both together" }).click();
    await dialog.locator(".deploy-behind").waitFor({ state: "detached" });
    await dialog.locator(".sheet-foot .primary").click();
    await page.locator(".toast.good", { hasText: "Round is deployed" }).waitFor();
    const live = async () =>
      (
        await stage.call<{ versions: { version: string; text: string; live?: boolean }[] }>(
          "Workflows/ListVersions",
          { workflow: "Round", withTexts: true },
        )
      ).versions.find((v) => v.live)?.text;
    expect(await live()).toBe(round("1.3", "theirs", "mine"));
    // At one place: the deployed text, or one's own in its place.
    await describeStep(page, "Wave", "once more mine");
    await deploy(round("1.4", "once more theirs", "mine"));
    await page.locator(".stale", { hasText: "Version 1.4" }).waitFor();
    expect(await page.locator(".stale").getByRole("button").allInnerTexts()).toEqual([
      "Take the deployed text",
    ]);
    await page.getByRole("button", { name: "Deploy" }).first().click();
    await dialog.getByLabel("Deploy this text in its place").check();
    await dialog.locator(".sheet-foot .primary").click();
    await page.locator(".stale").waitFor({ state: "detached" });
    await expect.poll(live, { timeout: patienceMs }).toBe(round("1.5", "once more mine", "mine"));
    expect(await draftNow(page, "Round")).toBe("");
  });

  it("comes back byte for byte, and is written only over what was seen", async () => {
    const text = 'a\r\n"b" \\ \\n \t\b\f \'c\' """d""" \u{1F600} 한국어 } { # <urn:x> \u0001';
    const name = "<odd> %name/\u{1F600}' )";
    const write = async (content: string, saved: string, seen: string) =>
      (
        await stage.call<{ added?: string }>("Context/Update", {
          update: writeUpdate({ name, text: content, saved }, seen),
        })
      ).added ?? "0";
    expect(await write(text, "2026-01-01T00:00:00.001Z", "")).not.toBe("0");
    expect(await onServer(name)).toEqual([text]);
    expect(await write("other", "2026-01-01T00:00:00.002Z", "")).toBe("0");
    expect(await write("other", "2026-01-01T00:00:00.002Z", "2026-01-01T00:00:00Z")).toBe("0");
    expect(await onServer(name)).toEqual([text]);
    expect(await write("other", "2026-01-01T00:00:00.002Z", "2026-01-01T00:00:00.001Z")).not.toBe("0");
    expect(await onServer(name)).toEqual(["other"]);
    expect(sparqlString('"\\')).toBe('"\\"\\\\"');
  });

  it("no page has thrown", () => stage.noFaults());
});
