// What must not be: on the card of its step, in its row, and in a situation that is one of an expression.
import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, it } from "vitest";
import { seriousFindings } from "./pages";
import { Stage, usualAnswers } from "./stage";

const row = (name: string, verb: string, subject = "?patient") =>
  `<constraint name="${name}"><subject>${subject}</subject><verb>docent:${verb}</verb><object>true</object></constraint>`;
const ward = `<CAWL name="Ward" xmlns="urn:cawl" xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Ward">
    <source name="Begin"/>
    <node name="Look">
      <condition>
        <context name="awake"><rule name="r" expression="lies and not asleep">${row("lies", "lies")}${row("asleep", "asleep")}</rule></context>
      </condition>
    </node>
    <node name="Call">
      <condition expression="calls and not quiet">
        <context name="calls"><rule name="r" expression="bell or knock">${row("bell", "rang")}${row("knock", "knocked")}</rule></context>
        <context name="quiet"><rule name="r"><ext:time between="22:00-06:00"/>${row("night", "quiet", "docent:Ward")}</rule></context>
      </condition>
    </node>
    <sink name="End"/>
    <link from="Begin" to="Look"/><link from="Look" to="Call"/><link from="Call" to="End"/>
  </flow>
</CAWL>`;

let stage: Stage;
beforeAll(async () => {
  stage = await Stage.open();
  const ann = { iri: "https://w3id.org/docent/expo#Ann" };
  stage.answers = {
    ...usualAnswers(),
    "Workflows/List": () => ({ workflows: [{ name: "Ward", version: "1.0", flows: ["Ward"] }] }),
    "Workflows/ListVersions": () => ({ versions: [{ number: 1, version: "1.0", live: true, text: ward }] }),
    // Ann lies, and is asleep.
    "Context/Query": ({ query }) => [
      { header: { variables: /value_holds/.test(String(query)) ? ["patient"] : [] } },
      ...(/docent:(lies|asleep) true .*value_holds/.test(String(query)) ? [{ row: { values: [ann] } }] : []),
    ],
  };
});
afterAll(() => stage.close());

const cardRows = (page: Page, step: string) =>
  page.locator(`.react-flow__node[data-id="${step}"] .step-condition li`).allInnerTexts();

it("a card says what must not be, and what is one of several", async () => {
  const page = await stage.page("/compose/Ward");
  await page.waitForSelector('.react-flow__node[data-id="Call"]');
  expect(await cardRows(page, "Look")).toEqual(["patient lies true", "not (patient asleep true)"]);
  expect(await cardRows(page, "Call")).toEqual([
    "patient rang true or patient knocked true",
    "not (Ward quiet true and between 22:00-06:00)",
  ]);
  expect(await page.locator('.react-flow__node[data-id="Look"]').getAttribute("aria-label")).toContain(
    "opens when patient lies true and not (patient asleep true)",
  );
  await stage.picture(page, "negation-cards");
});

it("a row that must not be has no tick where it is", async () => {
  const page = await stage.page("/compose/Ward?step=Look", { height: 1000 });
  const rows = page.locator(".constraint");
  await rows.nth(0).locator(".constraint-state.some").waitFor();
  expect(await rows.nth(0).innerText()).not.toContain("must not be");
  expect(await rows.nth(1).locator(".constraint-state").innerText()).toBe(
    "must not be: 1 match: Ann asleep true",
  );
  expect(await rows.nth(1).locator(".constraint-state.some").count()).toBe(0);
  expect(await rows.nth(1).locator(".condition-sense").innerText()).toBe("must not be");
  await stage.picture(page, "negation-rows");
  expect(await seriousFindings(page)).toEqual([]);
});

it("a situation that must not be says it", async () => {
  const page = await stage.page("/compose/Ward?step=Call", { height: 1000 });
  const quiet = page.getByRole("region", { name: "Situation quiet" });
  await quiet.getByText("must not be", { exact: true }).waitFor();
  expect(
    await page
      .getByRole("region", { name: "Situation calls" })
      .getByText("must not be", { exact: true })
      .count(),
  ).toBe(0);
  expect(await quiet.getByText("between 22:00-06:00").count()).toBe(1);
  expect(await page.getByRole("region", { name: "All situations together" }).innerText()).toContain(
    "(patient rang true or patient knocked true) and not (",
  );
  await stage.picture(page, "negation-situations");
  expect(await seriousFindings(page)).toEqual([]);
  expect(stage.faults).toEqual([]);
});
