// Which values a run needs at its beginning.
import { describe, expect, it } from "vitest";
import { readCawl } from "../../../src/cawl/document";
import { startVariables } from "../../../src/cawl/start_values";
import { readFileSync } from "node:fs";
import { join } from "node:path";

const needs = (text: string) =>
  Object.fromEntries(startVariables(readCawl(text), readCawl(text).flows[0]).map((v) => [v.name, v.need]));
const flow = (inner: string) =>
  `<CAWL name="A" xmlns:ext="https://w3id.org/docent/cawl-ext#"><variable name="hall"/><flow name="A">${inner}<sink name="End"/></flow></CAWL>`;

describe("the values that a run begins with", () => {
  it("of the booth guide: the visitor is needed, booth is found", () => {
    expect(
      needs(
        readFileSync(
          join(import.meta.dirname, "../../../../scenarios/s01_booth_guide/booth_guide.cawl.xml"),
          "utf8",
        ),
      ),
    ).toMatchObject({ user: "needed", robot: "any", booth: "found" });
  });
  it("are set, made by steps, or any", () => {
    expect(
      needs(
        flow(`<variable name="count"><initialize><from expression="1"/></initialize></variable><variable name="price"/><variable name="text"/><variable name="guests"/><variable name="robot"/><variable name="who"/>
      <node name="n"><invoke operation="say"><ext:input part="text" expression="'Hi'"/><ext:output part="x" variable="price"/></invoke><ext:assign>SELECT (COUNT(?g) AS ?guests) WHERE { ?g a $who }</ext:assign></node>`),
      ),
    ).toEqual({
      count: "set",
      price: "made",
      text: "made",
      guests: "made",
      robot: "any",
      who: "needed",
      hall: "found",
    });
    expect(
      needs(
        flow(
          '<variable name="text"/><node name="n"><invoke operation="say"><ext:input part="text" expression="$text"/></invoke></node>',
        ),
      ),
    ).toMatchObject({ text: "needed" });
  });
});
