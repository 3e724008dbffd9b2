// How many runs a deployment would start at once.
import { create } from "@bufbuild/protobuf";
import { expect, it } from "vitest";
import { countKeys, keyQueries, startsWords } from "../../../src/compose/starts_now";
import { CompiledConditionSchema } from "../../../src/gen/docent/v1/workflows_pb";

const condition = (place: string, ask = "PREFIX d: <urn:d#>\nASK {\n  ?user d:chose ?service .\n}") =>
  create(CompiledConditionSchema, { place, ask });

it("the activator's situations are asked for their keys", () => {
  const conditions = [condition("activator OnChoice / context A"), condition("flow F / node N / context A")];
  expect(keyQueries(conditions, { variables: [] })).toEqual([
    "PREFIX d: <urn:d#>\nSELECT DISTINCT * WHERE {\n  ?user d:chose ?service .\n} LIMIT 1000",
  ]);
  expect(keyQueries(conditions, { variables: [{ name: "user" }] as never })[0]).toContain(
    "SELECT DISTINCT ?user WHERE",
  );
});
it("one that fits in two situations counts once", () => {
  const [john, ann] = [
    { user: { kind: "iri" as const, text: "urn:John" } },
    { user: { kind: "iri" as const, text: "urn:Ann" } },
  ];
  expect(countKeys([[john, ann], [ann]])).toBe(2);
  expect([startsWords(1, false), startsWords(4, false), startsWords(4, true)]).toEqual([
    "One fits now: Deploy starts one run at once.",
    "4 fit now: Deploy starts 4 runs at once.",
    "4 fit now: Deploy starts a run at once for each that has started none before.",
  ]);
});
