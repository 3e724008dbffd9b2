// Names of classes are global: a modifier (".step.stale") that is also the name of a part of its own (".stale") would get its looks.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";

const source = join(import.meta.dirname, "../../src");
const sheets = readdirSync(source, { recursive: true, encoding: "utf8" }).filter((name) =>
  name.endsWith(".css"),
);
const harmless = new Set(["hall"]); // shapes of an SVG, to which the layout of a view means nothing
const helpers = "ui/base.css"; // small, quiet, row, cut: meant to be added to anything

function selectors(sheet: string): string[] {
  const css = readFileSync(join(source, sheet), "utf8").replace(
    /\/\*[\s\S]*?\*\/|:(?:is|has|not)\([^)]*\)/g,
    "",
  );
  return [...css.matchAll(/([^{};]+)\{/g)]
    .flatMap(([, list = ""]) => list.split(","))
    .map((s) => s.trim())
    .filter((s) => !s.startsWith("@"));
}
const classes = (part: string) => [...part.matchAll(/\.([A-Za-z][\w-]*)/g)].map(([, name = ""]) => name);

describe("class names", () => {
  it("of a modifier is not that of a part", () => {
    const parts = new Map(
      sheets
        .filter((s) => s !== helpers)
        .flatMap((sheet) =>
          selectors(sheet)
            .filter((s) => /^\.[\w-]+(::?[\w-]+)*$/.test(s))
            .map((s): [string, string] => [classes(s)[0] ?? "", sheet]),
        ),
    );
    const clashes = sheets.flatMap((sheet) =>
      selectors(sheet).flatMap((s) =>
        s.split(/[\s>+~]+/).flatMap((part) =>
          classes(part)
            .slice(1)
            .filter((name) => parts.has(name) && !harmless.has(name))
            .map((name) => `${sheet}: ${part} and .${name} of ${parts.get(name)}`),
        ),
      ),
    );
    expect([...new Set(clashes)]).toEqual([]);
  });
});
